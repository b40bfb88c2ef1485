// What a request asks for. Whatever is wrong with it by itself, or for this robot's family and map, is
// INVALID_ARGUMENT; whether the robot may do it now is decided later (AM-01 a).

import { MISSION_KINDS, WORKFLOW_KINDS } from './kinds.mjs';
import { decode, malformed } from './protojson.mjs';

const COMMANDS = ['COMMAND_CANCEL', 'COMMAND_PAUSE', 'COMMAND_RESUME', 'COMMAND_FINISH'];

/**
 * Reads requests for a robot in that world. A mission becomes a plan:
 * `{goals, route, missionType, feedbackField}`.
 */
export class RequestReader {
  constructor(world) {
    this.world = world;
  }

  nothing(params) {
    decode('Empty', params);
  }

  /** The plan in a CreateMissionRequest or an AppendMissionRequest. */
  mission(type, params) {
    return this.wrappedMission(decode(type, params));
  }

  /** The plans in a batch request, of which every one must be valid. */
  batch(type, params) {
    return this.plans(decode(type, params).missions ?? []);
  }

  workflow(params) {
    const { missionWorkflow } = decode('CreateMissionWorkflowRequest', params);
    return this.plan('mission_workflow', missionWorkflow, WORKFLOW_KINDS);
  }

  command(params) {
    const { missionCommand = {} } = decode('UpdateMissionRequest', params);
    const { missionId, command } = missionCommand;
    if (!missionId) {
      throw malformed('mission_id is missing');
    }
    if (!COMMANDS.includes(command)) {
      throw malformed('command is missing or not a command');
    }
    return { missionId, command };
  }

  plans(wrappers) {
    if (wrappers.length === 0) {
      throw malformed('missions is empty');
    }
    return wrappers.map((wrapper) => this.wrappedMission(wrapper));
  }

  wrappedMission({ mission }) {
    return this.plan('mission', mission, MISSION_KINDS);
  }

  plan(what, wrapper, kinds) {
    const outer = onlyMember(what, wrapper, kinds);
    const { families, members, typeField, feedbackField } = kinds[outer];
    if (!families.includes(this.world.family)) {
      throw malformed(`${outer} is not for a robot of the family ${this.world.family}`);
    }
    const inner = onlyMember(outer, wrapper[outer], members);
    const [type, route, goalField] = members[inner];
    return {
      goals: this.goals(wrapper[outer][inner], goalField),
      route,
      missionType: { [typeField]: type },
      feedbackField,
    };
  }

  goals(body, field) {
    const goals = [body[field] ?? []].flat();
    if (goals.length === 0) {
      throw malformed(`${field} is missing or empty`);
    }
    return goals.map((goal) => this.goal(goal));
  }

  goal(goal) {
    return onlyMember('goal', goal, { destinationId: null, pose: null }) === 'pose'
      ? { pose: pose(goal.pose) }
      : { destinationId: this.destination(goal.destinationId) };
  }

  destination(name) {
    if (!this.world.destinations.includes(name)) {
      throw malformed(`"${name}" is not a destination on the map`);
    }
    return name;
  }
}

function onlyMember(what, message = {}, members) {
  const set = Object.keys(members).filter((member) => member in message);
  if (set.length !== 1) {
    throw malformed(`${what} needs exactly one of ${Object.keys(members).join(', ')}`);
  }
  return set[0];
}

function pose({ xMeters = 0, yMeters = 0, headingRadians = 0 }) {
  const numbers = { xMeters, yMeters, headingRadians };
  if (!Object.values(numbers).every(Number.isFinite)) {
    throw malformed('a pose needs finite numbers');
  }
  return numbers;
}
