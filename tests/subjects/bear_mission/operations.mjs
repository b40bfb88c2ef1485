// The unary operations. Each one reads its request, is allowed or refused in the robot's situation, and is performed;
// `failures` are the statuses that its Errors table lists for requests that fail for no fault of the caller.

import { Refusal } from '../jsonrpc.mjs';
import { CHARGE } from './kinds.mjs';
import { malformed } from './protojson.mjs';
import { COMMANDS, FINAL_STATES, STATE } from './robot.mjs';

const INTERNAL_ALONE = ['INTERNAL'];
const INTERNAL_OR_TIMEOUT = ['INTERNAL', 'DEADLINE_EXCEEDED'];

export function precondition(message) {
  return new Refusal('FAILED_PRECONDITION', message);
}

export function mustBeIdle(robot) {
  if (robot.isBusy()) {
    throw precondition('a mission is running, paused or queued');
  }
}

/** Every call that creates missions is refused by a robot that cannot start one (AM-53 a). */
export function mustBeAbleToStart(robot) {
  if (robot.world.blocked) {
    throw precondition('the robot is unable to start a mission');
  }
}

function mayCreate(robot) {
  mustBeIdle(robot);
  mustBeAbleToStart(robot);
}

/** The queue is what is listed, whatever has become of it (AM-11 a). */
function mayAppend(robot) {
  if (robot.missions.length === 0) {
    throw precondition('there is no mission in the queue');
  }
}

/** Of a busy robot without a charger the busyness is told (AM-38 e). A blocked robot charges later. */
function mayCharge(robot) {
  mustBeIdle(robot);
  if (!robot.canCharge()) {
    throw new Refusal('NOT_FOUND', 'there is no contact charger to go to');
  }
}

/** Missions that wait will still run, so they keep the listing (AM-34 c). */
function mayClear(robot) {
  mustBeIdle(robot);
}

function maySkip(robot) {
  const mission = robot.running();
  if (!mission) {
    throw precondition('no mission is running');
  }
  if (mission.goals.length === 0) {
    throw precondition('a charge has no goals to skip');
  }
}

/** Which code an id gets that is not the active mission's: AM-02 a, AM-03 a. */
function mayUpdate(robot, { missionId, command }) {
  if (robot.missions.length === 0) {
    throw precondition('there is no mission on the robot');
  }
  const mission = robot.find(missionId);
  if (!mission) {
    throw malformed(`there is no mission ${missionId}`);
  }
  if (mission.state === STATE.DEFAULT) {
    throw new Refusal('NOT_FOUND', `mission ${missionId} is still queued`);
  }
  if (FINAL_STATES.includes(mission.state) || !COMMANDS[command].from.includes(mission.state)) {
    throw precondition(`${command} is invalid in ${mission.state}`);
  }
}

function one(robot, plan) {
  return { missionId: robot.assign(plan).id };
}

function all(robot, plans) {
  return { missionIds: idsOf(robot.assignAll(plans)) };
}

function idsOf(missions) {
  return missions.map(({ id }) => id);
}

export const OPERATIONS = {
  CreateMission: {
    failures: INTERNAL_OR_TIMEOUT,
    read: (reader, params) => reader.mission('CreateMissionRequest', params),
    allow: mayCreate,
    perform: one,
  },
  CreateMissionBatch: {
    failures: INTERNAL_OR_TIMEOUT,
    read: (reader, params) => reader.batch('CreateMissionBatchRequest', params),
    allow: mayCreate,
    perform: all,
  },
  // A workflow is one mission here (AM-25 a), of the requested goals alone (AM-27 a).
  CreateMissionWorkflow: {
    failures: INTERNAL_OR_TIMEOUT,
    read: (reader, params) => reader.workflow(params),
    allow: mayCreate,
    perform: (robot, plan) => all(robot, [plan]),
  },
  AppendMission: {
    failures: INTERNAL_OR_TIMEOUT,
    read: (reader, params) => reader.mission('AppendMissionRequest', params),
    allow: mayAppend,
    perform: one,
  },
  AppendMissionBatch: {
    failures: INTERNAL_OR_TIMEOUT,
    read: (reader, params) => reader.batch('AppendMissionBatchRequest', params),
    allow: mayAppend,
    perform: all,
  },
  ChargeRobot: {
    failures: INTERNAL_OR_TIMEOUT,
    read: (reader, params) => reader.nothing(params),
    allow: mayCharge,
    perform: (robot) => one(robot, CHARGE),
  },
  ClearMissionStatus: {
    failures: INTERNAL_ALONE,
    read: (reader, params) => reader.nothing(params),
    allow: mayClear,
    perform: (robot) => ({ missionIds: idsOf(robot.clear()) }),
  },
  SkipGoal: {
    failures: INTERNAL_ALONE,
    read: (reader, params) => reader.nothing(params),
    allow: maySkip,
    perform(robot) {
      const mission = robot.running();
      robot.skip(mission);
      return { missionId: mission.id };
    },
  },
  UpdateMission: {
    failures: INTERNAL_OR_TIMEOUT,
    read: (reader, params) => reader.command(params),
    allow: mayUpdate,
    perform(robot, { missionId, command }) {
      robot.obey(robot.find(missionId), command);
      return {};
    },
  },
};
