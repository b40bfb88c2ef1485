// Breaks of what calls may be made when, and of what they answer.

import { randomUUID } from 'node:crypto';
import { isDeepStrictEqual } from 'node:util';
import { FAMILIES, MISSION_KINDS, ROUTE, WORKFLOW_KINDS } from '../kinds.mjs';
import { OPERATIONS, mustBeAbleToStart, mustBeIdle } from '../operations.mjs';
import { malformed } from '../protojson.mjs';
import { RequestReader } from '../requests.mjs';
import { COMMANDS, FINAL_STATES, Robot, STATE } from '../robot.mjs';
import { Subject } from '../subject.mjs';
import { allowing, allowingAlso, answering, recoding, refusingAlso, replace } from './alter.mjs';

/** What a careless robot makes of a request without a mission. */
const EMPTY_PLAN = {
  goals: [],
  route: ROUTE.ONCE,
  missionType: { baseType: 'BASE_TYPE_NAVIGATE' },
  feedbackField: 'baseFeedback',
};

const isFinished = ({ state }) => FINAL_STATES.includes(state);
const allAreFinished = (robot) => robot.missions.length > 0 && robot.missions.every(isFinished);
const isRunning = (robot) => robot.running() !== undefined;
const isPaused = (robot) => robot.current()?.state === STATE.PAUSED;
const withoutLast = ({ missionIds }) => ({ missionIds: missionIds.slice(0, -1) });

function reading(operation, read) {
  replace(OPERATIONS[operation], 'read', (original) => (reader, params) => read(original, reader, params));
}

function acceptingEmpty(operation) {
  reading(operation, (read, reader, params) => (isDeepStrictEqual(params, {}) ? EMPTY_PLAN : read(reader, params)));
}

function acceptingEmptyBatch(operation) {
  reading(operation, (read, reader, params) => (params?.missions?.length === 0 ? [] : read(reader, params)));
}

function isValid(reader, wrapper) {
  try {
    return Boolean(reader.wrappedMission(wrapper));
  } catch {
    return false;
  }
}

export const CALL_BREAKS = {
  'create-while-running': [
    'Mission › CreateMission › Errors: a mission is created behind one that is running or paused',
    () => allowing('CreateMission', mustBeAbleToStart),
  ],
  'create-while-queued': [
    'Mission › CreateMission › Errors: a mission is created once another one is queued',
    () => allowingAlso('CreateMission', (robot) => robot.queued().length > 0),
  ],
  'create-refused-when-finished': [
    'Mission › CreateMission › Errors: a robot whose missions are all finished refuses a new one',
    () => refusingAlso('CreateMission', allAreFinished),
  ],
  'create-busy-invalid-argument': [
    'Mission › CreateMission › Errors: a good request to a busy robot is INVALID_ARGUMENT',
    () => recoding('CreateMission', 'allow', 'FAILED_PRECONDITION', 'INVALID_ARGUMENT'),
  ],
  'create-malformed-failed-precondition': [
    'Mission › CreateMission › Errors: a bad request to an idle robot is FAILED_PRECONDITION',
    () => recoding('CreateMission', 'read', 'INVALID_ARGUMENT', 'FAILED_PRECONDITION'),
  ],
  'create-empty-accepted': [
    'Mission › CreateMission › Errors: an empty request creates a mission',
    () => acceptingEmpty('CreateMission'),
  ],
  'create-navigate-without-goal-accepted': [
    'Mission › NavigateMission: a mission that must have one goal is created with none',
    () => replace(RequestReader.prototype, 'goals', (goals) => function (body, field) {
      return field === 'goal' && body.goal === undefined ? [] : goals.call(this, body, field);
    }),
  ],
  'create-pose-refused': [
    'Mission › CreateMission › Errors: a goal that is a good pose is refused as invalid',
    () => replace(RequestReader.prototype, 'goal', (goal) => function (message) {
      if (message.pose) {
        throw malformed('poses are not supported');
      }
      return goal.call(this, message);
    }),
  ],
  'create-other-family-accepted': [
    'Mission › CreateMission › Request: a mission for one family runs on a robot of another',
    () => Object.values(MISSION_KINDS).forEach((kind) => Object.assign(kind, { families: FAMILIES })),
  ],
  'create-refused-but-listed': [
    'Mission › CreateMission › Errors: a refused call leaves its mission in the queue',
    () => replace(OPERATIONS.CreateMission, 'allow', (allow) => (robot, plan) => {
      try {
        allow(robot, plan);
      } catch (refusal) {
        robot.assign(plan);
        throw refusal;
      }
    }),
  ],
  'create-answers-other-id': [
    'Mission › CreateMission › Response: the id is not the one that the mission is listed under',
    () => answering('CreateMission', () => ({ missionId: randomUUID() })),
  ],
  'mission-id-constant': [
    'Mission › MissionState: every mission of a robot has the same id',
    () => replace(Robot.prototype, 'newId', () => function () {
      this.onlyId ??= randomUUID();
      return this.onlyId;
    }),
  ],
  'mission-id-reused-after-clear': [
    'Mission › MissionState: after a clear the ids are given to other missions',
    () => replace(Robot.prototype, 'newId', (newId) => function () {
      this.idsByPosition ??= [];
      return (this.idsByPosition[this.missions.length] ??= newId.call(this));
    }),
  ],

  'batch-while-running': [
    'Mission › CreateMissionBatch › Errors: a batch is created while a mission runs',
    () => allowing('CreateMissionBatch', mustBeAbleToStart),
  ],
  'batch-while-unable-to-start': [
    'Mission › CreateMissionBatch › Errors: a batch is created on a robot that cannot start a mission',
    () => allowing('CreateMissionBatch', mustBeIdle),
  ],
  'batch-refused-when-finished': [
    'Mission › CreateMissionBatch › Errors: a robot whose missions are all finished refuses a batch',
    () => refusingAlso('CreateMissionBatch', allAreFinished),
  ],
  'batch-empty-accepted': [
    'Mission › CreateMissionBatch › Errors: an empty list of missions is accepted',
    () => acceptingEmptyBatch('CreateMissionBatch'),
  ],
  'batch-keeps-valid-prefix': [
    'Mission › CreateMissionBatch, AppendMissionBatch: a refused batch leaves the missions before its bad entry',
    () => {
      replace(RequestReader.prototype, 'plans', (plans) => function (wrappers) {
        try {
          return plans.call(this, wrappers);
        } catch (refusal) {
          const end = wrappers.findIndex((wrapper) => !isValid(this, wrapper));
          refusal.remainder = wrappers.slice(0, Math.max(end, 0)).map((wrapper) => this.wrappedMission(wrapper));
          throw refusal;
        }
      });
      replace(Subject.prototype, 'call', (call) => function (operation, params) {
        try {
          return call.call(this, operation, params);
        } catch (refusal) {
          this.robot.assignAll(refusal.remainder ?? []);
          throw refusal;
        }
      });
    },
  ],
  'batch-drops-invalid': [
    'Mission › CreateMissionBatch, AppendMissionBatch › Errors: bad entries are left out and the rest is accepted',
    () => replace(RequestReader.prototype, 'plans', (plans) => function (wrappers) {
      return plans.call(this, wrappers.filter((wrapper) => isValid(this, wrapper)));
    }),
  ],
  'batch-reversed': [
    'Mission › CreateMissionBatch, AppendMissionBatch: missions are queued in the reverse of the requested order',
    () => replace(Robot.prototype, 'assignAll', (assignAll) => function (plans) {
      return assignAll.call(this, plans.toReversed()).toReversed();
    }),
  ],
  'batch-ids-reversed': [
    'Mission › CreateMissionBatch › Response: the ids come in the reverse of the requested order',
    () => answering('CreateMissionBatch', ({ missionIds }) => ({ missionIds: missionIds.toReversed() })),
  ],
  'batch-loses-last': [
    'Mission › CreateMissionBatch, AppendMissionBatch: the last of several missions gets an id but is not queued',
    () => replace(Robot.prototype, 'assignAll', (assignAll) => function (plans) {
      const assigned = assignAll.call(this, plans);
      if (assigned.length > 1) {
        this.missions.pop();
      }
      return assigned;
    }),
  ],
  'batch-ids-incomplete': [
    'Mission › AppendMissionBatch › Response: the id of the last mission is left out',
    () => answering('AppendMissionBatch', withoutLast),
  ],

  'workflow-while-running': [
    'Mission › CreateMissionWorkflow › Errors: a workflow is created while a mission runs',
    () => allowing('CreateMissionWorkflow', mustBeAbleToStart),
  ],
  'workflow-empty-accepted': [
    'Mission › CreateMissionWorkflow › Errors: a request without a workflow is accepted',
    () => acceptingEmpty('CreateMissionWorkflow'),
  ],
  'workflow-other-family-accepted': [
    'Mission › CreateMissionWorkflow › Errors: a workflow of another family is accepted',
    () => Object.values(WORKFLOW_KINDS).forEach((kind) => Object.assign(kind, { families: FAMILIES })),
  ],
  'workflow-creates-nothing': [
    'Mission › CreateMissionWorkflow › Response: no mission is created and no id answered',
    () => replace(OPERATIONS.CreateMissionWorkflow, 'perform', () => () => ({ missionIds: [] })),
  ],

  'append-to-empty-accepted': [
    'Mission › AppendMission › Errors: a mission is appended where none is listed',
    () => allowing('AppendMission'),
  ],
  'append-batch-to-empty-accepted': [
    'Mission › AppendMissionBatch › Errors: a batch is appended where no mission is listed',
    () => allowing('AppendMissionBatch'),
  ],
  'append-to-empty-invalid-argument': [
    'Mission › AppendMission › Errors: a good request where no mission is listed is INVALID_ARGUMENT',
    () => recoding('AppendMission', 'allow', 'FAILED_PRECONDITION', 'INVALID_ARGUMENT'),
  ],
  'append-refused-while-running': [
    'Mission › AppendMission › Errors: nothing can be appended while a mission runs',
    () => refusingAlso('AppendMission', isRunning),
  ],
  'append-batch-empty-accepted': [
    'Mission › AppendMissionBatch › Errors: an empty list of missions is accepted',
    () => acceptingEmptyBatch('AppendMissionBatch'),
  ],

  'charge-while-running': [
    'Mission › ChargeRobot › Errors: a charge is queued while a mission runs',
    () => allowingAlso('ChargeRobot', (robot) => isRunning(robot) && robot.canCharge()),
  ],
  'charge-without-dock': [
    'Mission › ChargeRobot: a robot without a contact dock goes charging',
    () => replace(Robot.prototype, 'canCharge', () => function () {
      return this.world.chargingLocation;
    }),
  ],
  'charge-without-location': [
    'Mission › ChargeRobot › Errors: a robot goes charging though its map has no place for it',
    () => replace(Robot.prototype, 'canCharge', () => function () {
      return this.world.contactDock;
    }),
  ],
  'charge-without-location-failed-precondition': [
    'Mission › ChargeRobot › Errors: an idle robot whose map has no charger answers FAILED_PRECONDITION',
    () => recoding('ChargeRobot', 'allow', 'NOT_FOUND', 'FAILED_PRECONDITION'),
  ],
  'charge-always-not-found': [
    'Mission › ChargeRobot › Errors: a charger that is there is not found',
    () => replace(Robot.prototype, 'canCharge', () => () => false),
  ],
  'charge-not-listed': [
    'Mission › ChargeRobot › Response: the charge has an id but is never reported',
    () => replace(OPERATIONS.ChargeRobot, 'perform', () => () => ({ missionId: randomUUID() })),
  ],

  'clear-while-running': [
    'Mission › ClearMissionStatus › Errors: a running mission is cleared away',
    () => allowingAlso('ClearMissionStatus', isRunning),
  ],
  'clear-while-paused': [
    'Mission › ClearMissionStatus › Errors: a paused mission is cleared away',
    () => allowingAlso('ClearMissionStatus', isPaused),
  ],
  'clear-running-invalid-argument': [
    'Mission › ClearMissionStatus › Errors: clearing a running mission is INVALID_ARGUMENT',
    () => recoding('ClearMissionStatus', 'allow', 'FAILED_PRECONDITION', 'INVALID_ARGUMENT'),
  ],
  'clear-refused-when-finished': [
    'Mission › ClearMissionStatus › Errors: finished missions cannot be cleared',
    () => refusingAlso('ClearMissionStatus', allAreFinished),
  ],
  'clear-omits-id': [
    'Mission › ClearMissionStatus › Response: the last cleared mission is not named',
    () => answering('ClearMissionStatus', withoutLast),
  ],
  'clear-answers-other-ids': [
    'Mission › ClearMissionStatus › Response: the ids are of no mission that was cleared',
    () => answering('ClearMissionStatus', ({ missionIds }) => ({ missionIds: missionIds.map(() => randomUUID()) })),
  ],
  'clear-removes-nothing': [
    'Mission › ClearMissionStatus: the missions are named as cleared and stay listed',
    () => replace(Robot.prototype, 'clear', () => function () {
      return this.missions;
    }),
  ],
  'clear-leaves-last': [
    'Mission › ClearMissionStatus: the last mission stays listed',
    () => replace(Robot.prototype, 'clear', () => function () {
      return this.missions.splice(0, this.missions.length - 1);
    }),
  ],

  'skip-on-idle-accepted': [
    'Mission › SkipGoal › Errors: a robot that is on no mission skips a goal',
    () => replace(OPERATIONS, 'SkipGoal', (skip) => ({
      ...skip,
      allow: (robot, request) => robot.current() && skip.allow(robot, request),
      perform: (robot) => (robot.current() ? skip.perform(robot) : { missionId: robot.missions.at(-1)?.id ?? '' }),
    })),
  ],
  'skip-refused-while-running': [
    'Mission › SkipGoal › Errors: no goal of a running mission can be skipped',
    () => refusingAlso('SkipGoal', isRunning),
  ],
  'skip-answers-other-id': [
    'Mission › SkipGoal › Response: the id is not that of the mission whose goal was skipped',
    () => answering('SkipGoal', () => ({ missionId: randomUUID() })),
  ],

  'update-unknown-command-pauses': [
    'Mission › Command enum: a command that is not set pauses the mission',
    () => reading('UpdateMission', (read, reader, params) => {
      const missionCommand = params?.missionCommand;
      const isUnset = missionCommand && [undefined, null, 0, 'COMMAND_UNKNOWN'].includes(missionCommand.command);
      return read(reader, isUnset ? { missionCommand: { ...missionCommand, command: 'COMMAND_PAUSE' } } : params);
    }),
  ],
  'update-unknown-id-accepted': [
    'Mission › UpdateMission › Errors: a command for a mission that is not there goes to the active one',
    () => replace(Robot.prototype, 'find', (find) => function (id) {
      return find.call(this, id) ?? this.current();
    }),
  ],
  'update-queued-failed-precondition': [
    'Mission › UpdateMission › Errors: a command for a queued mission is FAILED_PRECONDITION',
    () => recoding('UpdateMission', 'allow', 'NOT_FOUND', 'FAILED_PRECONDITION'),
  ],
  'update-cancels-queued': [
    'Mission › UpdateMission › Errors: a queued mission can be canceled',
    () => allowingAlso('UpdateMission', (robot, { missionId, command }) =>
      command === 'COMMAND_CANCEL' && robot.find(missionId)?.state === STATE.DEFAULT),
  ],
  'update-cancels-finished': [
    'Mission › UpdateMission › Errors: a mission that has ended can be canceled',
    () => allowingAlso('UpdateMission', (robot, { missionId, command }) =>
      command === 'COMMAND_CANCEL' && FINAL_STATES.includes(robot.find(missionId)?.state)),
  ],
  'update-resumes-finished': [
    'Mission › UpdateMission › Errors: on an idle robot a mission that has ended can be resumed, and runs again',
    () => allowingAlso('UpdateMission', (robot, { missionId, command }) =>
      command === 'COMMAND_RESUME' && !robot.isBusy() && robot.find(missionId) !== undefined),
  ],
  'update-cancel-refused-while-paused': [
    'Mission › UpdateMission › Errors: a paused mission cannot be canceled',
    () => refusingAlso('UpdateMission', (robot, { command }) => command === 'COMMAND_CANCEL' && isPaused(robot)),
  ],
  'update-pause-refused-while-running': [
    'Mission › UpdateMission › Errors: a running mission cannot be paused',
    () => Object.assign(COMMANDS.COMMAND_PAUSE, { from: [] }),
  ],

  'fault-internal-takes-effect': [
    'Mission › Errors › INTERNAL: a request that failed has been executed all the same',
    () => replace(Subject.prototype, 'takesEffect', () => ({ status, applied }) => applied || status === 'INTERNAL'),
  ],
  'fault-splits-batch': [
    'Mission › CreateMissionBatch, AppendMissionBatch: of a batch that fails the first mission stays',
    () => {
      replace(Subject.prototype, 'takesEffect', () => function () {
        this.robot.isSplitting = true;
        return true;
      });
      replace(Robot.prototype, 'assignAll', (assignAll) => function (plans) {
        const { isSplitting } = this;
        this.isSplitting = false;
        return assignAll.call(this, isSplitting ? plans.slice(0, 1) : plans);
      });
    },
  ],
  'fault-applied-lost': [
    'adapter.md › bear.mission › fault: a request that should take effect in spite of its answer does not',
    () => replace(Subject.prototype, 'takesEffect', () => () => false),
  ],
};
