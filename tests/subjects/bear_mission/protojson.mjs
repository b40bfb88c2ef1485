// Requests as protobuf JSON: which fields there are, and how JSON becomes a message.
//
// Only the form is judged here. What a well-formed request may ask for is the business of requests.mjs.

import { Refusal } from '../jsonrpc.mjs';

const LARGEST_FLOAT = 3.4028234663852886e38;
const JSON_NUMBER = /^-?(0|[1-9]\d*)(\.\d+)?([eE][+-]?\d+)?$/;
const NON_FINITE = ['NaN', 'Infinity', '-Infinity'];

const GOAL = { goal: 'Goal' };
const GOALS = { goals: ['Goal'] };

// A type in brackets is repeated.
const MESSAGES = {
  Empty: {},
  CreateMissionRequest: { mission: 'Mission' },
  CreateMissionBatchRequest: { missions: ['CreateMissionRequest'] },
  CreateMissionWorkflowRequest: { missionWorkflow: 'MissionWorkflow' },
  AppendMissionRequest: { mission: 'Mission' },
  AppendMissionBatchRequest: { missions: ['AppendMissionRequest'] },
  UpdateMissionRequest: { missionCommand: 'MissionCommand' },

  Mission: { baseMission: 'BaseMission', serviMission: 'servi.Mission', cartiMission: 'carti.Mission' },
  MissionWorkflow: { serviWorkflow: 'servi.MissionWorkflow', cartiWorkflow: 'carti.MissionWorkflow' },
  MissionCommand: { missionId: 'string', command: 'Command' },
  BaseMission: { navigateMission: 'OneGoal', navigateAutoMission: 'GoalList' },
  Goal: { destinationId: 'string', pose: 'Pose' },
  Pose: { xMeters: 'float', yMeters: 'float', headingRadians: 'float' },

  'servi.Mission': {
    deliveryMission: 'servi.DeliveryMission',
    bussingMission: 'GoalListWithParams',
    deliveryPatrolMission: 'GoalListWithParams',
    bussingPatrolMission: 'GoalListWithParams',
    navigateMission: 'OneGoal',
    navigateAutoMission: 'GoalList',
  },
  'servi.DeliveryMission': { ...GOALS, params: 'servi.DeliveryParams' },
  'servi.DeliveryParams': { trayMappings: ['servi.TrayMapping'] },
  'servi.TrayMapping': { trayName: 'string', ...GOAL },
  'servi.MissionWorkflow': {
    delivery: 'GoalList',
    deliveryPatrol: 'GoalList',
    bussing: 'GoalList',
    bussingPatrol: 'GoalList',
    birthday: 'OneGoal',
    hosting: 'GoalList',
    hostingPatrol: 'GoalList',
  },

  'carti.Mission': {
    traverseMission: 'GoalListWithParams',
    traversePatrolMission: 'GoalListWithParams',
    navigateMission: 'OneGoal',
    navigateAutoMission: 'GoalList',
  },
  'carti.MissionWorkflow': { traverse: 'GoalList', traversePatrol: 'GoalList' },

  // Many published messages have one of these three shapes; they differ in name alone.
  OneGoal: GOAL,
  GoalList: GOALS,
  GoalListWithParams: { ...GOALS, params: 'Empty' },
};

const ENUMS = {
  Command: ['COMMAND_UNKNOWN', 'COMMAND_CANCEL', 'COMMAND_PAUSE', 'COMMAND_RESUME', 'COMMAND_FINISH'],
};

const SCALARS = { string: decodeString, float: decodeFloat };

/** The message of that type which the JSON stands for, lowerCamelCase, without its unset fields. */
export function decode(type, json, path = type) {
  if (type in SCALARS) {
    return SCALARS[type](json, path);
  }
  return type in ENUMS ? decodeEnum(ENUMS[type], json, path) : decodeMessage(MESSAGES[type], json, path);
}

export function malformed(message) {
  return new Refusal('INVALID_ARGUMENT', message);
}

function decodeMessage(fields, json, path) {
  if (json === null || typeof json !== 'object' || Array.isArray(json)) {
    throw malformed(`${path} is not a message`);
  }
  const message = {};
  for (const [name, type] of Object.entries(fields)) {
    const value = fieldValue(json, name, path);
    if (value !== undefined) {
      message[name] = decodeField(type, value, `${path}.${name}`);
    }
  }
  return message;
}

function decodeField(type, value, path) {
  return Array.isArray(type) ? decodeList(type[0], value, path) : decode(type, value, path);
}

function decodeList(type, json, path) {
  if (!Array.isArray(json)) {
    throw malformed(`${path} is not a list`);
  }
  return json.map((element, index) => decode(type, element, `${path}[${index}]`));
}

// A parser of protobuf JSON takes a field by either of its names, and null for its absence.
function fieldValue(json, name, path) {
  const spellings = [...new Set([name, snakeCase(name)])];
  const values = spellings.filter((spelling) => Object.hasOwn(json, spelling)).map((spelling) => json[spelling]);
  if (values.length > 1) {
    throw malformed(`${path}.${name} is given twice`);
  }
  return values[0] ?? undefined;
}

function snakeCase(name) {
  return name.replace(/[A-Z]/g, (letter) => `_${letter.toLowerCase()}`);
}

function decodeString(json, path) {
  if (typeof json !== 'string') {
    throw malformed(`${path} is not a string`);
  }
  return json;
}

function decodeFloat(json, path) {
  if (NON_FINITE.includes(json)) {
    return Number(json);
  }
  const isNumber = typeof json === 'number' || (typeof json === 'string' && JSON_NUMBER.test(json));
  if (!isNumber || Math.abs(Number(json)) > LARGEST_FLOAT) {
    throw malformed(`${path} is not a float`);
  }
  return Number(json);
}

// Protobuf enums are open: a number without a name is well-formed, and stays a number.
function decodeEnum(names, json, path) {
  if (Number.isInteger(json)) {
    return names[json] ?? json;
  }
  if (!names.includes(json)) {
    throw malformed(`${path} is not one of ${names.join(', ')}`);
  }
  return json;
}
