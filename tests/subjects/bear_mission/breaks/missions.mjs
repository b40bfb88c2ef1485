// Breaks of what becomes of missions: their order, their goals, their ends.

import { ROUTE } from '../kinds.mjs';
import { OPERATIONS } from '../operations.mjs';
import { FINAL_STATES, Robot, STATE } from '../robot.mjs';
import { allowingAlso, ignoring, obeyingWith, replace, routing } from './alter.mjs';

const isLast = ({ goals, goalIndex }) => goalIndex === goals.length - 1;

/** After the operation, `rearrange(robot, added, queuedBefore)` does something to the missions. */
function rearranging(operation, rearrange) {
  replace(OPERATIONS[operation], 'perform', (perform) => (robot, request) => {
    const queuedBefore = robot.queued();
    const answer = perform(robot, request);
    const added = robot.queued().filter((mission) => !queuedBefore.includes(mission));
    rearrange(robot, added, queuedBefore);
    return answer;
  });
}

function moveBehind(robot, moved, place) {
  robot.missions = robot.missions.filter((mission) => mission !== moved);
  robot.missions.splice(robot.missions.indexOf(place) + 1, 0, moved);
}

/** Every mission that the operation adds is marked as its own. */
function marking(operation, mark) {
  replace(OPERATIONS[operation], 'perform', (perform) => (robot, request) => {
    const before = [...robot.missions];
    const answer = perform(robot, request);
    robot.missions.filter((mission) => !before.includes(mission)).forEach((mission) => { mission[mark] = true; });
    return answer;
  });
}

/** Skipping goals of missions with several goals of which the current one is not the last. */
function skippingMidway(skipOtherwise) {
  replace(Robot.prototype, 'skip', (skip) => function (mission) {
    if (mission.route === ROUTE.SELECT || isLast(mission)) {
      skip.call(this, mission);
    } else {
      skipOtherwise(this, mission);
    }
  });
}

export const MISSION_BREAKS = {
  'append-jumps-queue': [
    'Mission › AppendMission: a mission is put before those that wait already',
    () => rearranging('AppendMission', (robot, [mission], [first]) => {
      if (first) {
        moveBehind(robot, first, mission);
      }
    }),
  ],
  'append-batch-interleaved': [
    'Mission › AppendMissionBatch: a mission that waits already ends up among those of the batch',
    () => rearranging('AppendMissionBatch', (robot, [first], queuedBefore) => {
      if (queuedBefore.length > 0) {
        moveBehind(robot, queuedBefore.at(-1), first);
      }
    }),
  ],
  'append-twice': [
    'Mission › AppendMission: one call queues its mission twice',
    () => rearranging('AppendMission', (robot, [mission]) => robot.assign(mission)),
  ],
  'append-starts-at-once': [
    'Mission › AppendMission: the appended mission runs beside the current one',
    () => rearranging('AppendMission', (robot, [mission]) => robot.start(mission)),
  ],
  'append-preempts': [
    'Mission › AppendMission: the appended mission runs at once and the running one is queued again',
    () => rearranging('AppendMission', (robot, [mission]) => {
      const running = robot.running();
      if (running) {
        running.state = STATE.DEFAULT;
        robot.start(mission);
      }
    }),
  ],
  'batch-starts-all': [
    'Mission › CreateMissionBatch: all missions of a batch run at the same time',
    () => rearranging('CreateMissionBatch', (robot, added) => added.forEach((mission) => robot.start(mission))),
  ],
  'queue-last-first': [
    'Mission › AppendMission: the mission that was queued last is executed first',
    () => replace(Robot.prototype, 'nextToStart', () => function () {
      return this.queued().at(-1);
    }),
  ],
  'queue-never-advances': [
    'Mission › AppendMission: a mission that had to wait never starts',
    () => {
      replace(Robot.prototype, 'assign', (assign) => function (plan) {
        const hadToWait = this.isBusy();
        return Object.assign(assign.call(this, plan), { hadToWait });
      });
      replace(Robot.prototype, 'nextToStart', () => function () {
        return this.queued().find(({ hadToWait }) => !hadToWait);
      });
    },
  ],
  'queue-canceled-by-success': [
    'Mission › AppendMission: a success cancels the missions that wait',
    () => replace(Robot.prototype, 'complete', (complete) => function (mission) {
      complete.call(this, mission);
      this.queued().forEach((waiting) => Object.assign(waiting, { state: STATE.CANCELED }));
    }),
  ],

  'pause-ignored': [
    'Mission › Command enum: PAUSE is acknowledged and the mission runs on',
    () => ignoring('COMMAND_PAUSE'),
  ],
  'pause-starts-next': [
    'Mission › Command enum: PAUSE lets the next mission run',
    () => replace(Robot.prototype, 'obey', (obey) => function (mission, command) {
      obey.call(this, mission, command);
      const next = this.nextToStart();
      if (command === 'COMMAND_PAUSE' && next) {
        this.start(next);
      }
    }),
  ],
  'resume-ignored': [
    'Mission › Command enum: RESUME is acknowledged and the mission stays paused',
    () => ignoring('COMMAND_RESUME'),
  ],
  'resume-restarts-running': [
    'Mission › UpdateMission › Errors: RESUME of a running mission is accepted and sends it back to its first goal',
    () => {
      allowingAlso('UpdateMission', (robot, { missionId, command }) =>
        command === 'COMMAND_RESUME' && robot.find(missionId)?.state === STATE.RUNNING);
      replace(Robot.prototype, 'obey', (obey) => function (mission, command) {
        if (command === 'COMMAND_RESUME' && mission.state === STATE.RUNNING) {
          mission.goalIndex = 0;
        }
        obey.call(this, mission, command);
      });
    },
  ],
  'cancel-ignored': [
    'Mission › Command enum: CANCEL is acknowledged and the mission goes on',
    () => ignoring('COMMAND_CANCEL'),
  ],
  'cancel-reported-succeeded': [
    'Mission › State enum: a canceled mission has succeeded',
    () => obeyingWith('COMMAND_CANCEL', STATE.SUCCEEDED),
  ],
  'cancel-reported-failed': [
    'Mission › State enum: a canceled mission has failed',
    () => obeyingWith('COMMAND_CANCEL', STATE.FAILED),
  ],
  'finish-reported-failed': [
    'Mission › Command enum: a mission that is marked as completed has failed',
    () => obeyingWith('COMMAND_FINISH', STATE.FAILED),
  ],
  'finish-reported-canceled': [
    'Mission › Command enum: a mission that is marked as completed is canceled',
    () => obeyingWith('COMMAND_FINISH', STATE.CANCELED),
  ],
  'failure-reported-succeeded': [
    'Mission › State enum: a mission that failed has succeeded',
    () => replace(Robot.prototype, 'fail', () => function () {
      const mission = this.current();
      if (mission) {
        this.complete(mission);
      }
      return mission !== undefined;
    }),
  ],
  'success-reported-failed': [
    'Mission › State enum: a mission that came to its good end has failed',
    () => replace(Robot.prototype, 'complete', () => (mission) => Object.assign(mission, { state: STATE.FAILED })),
  ],
  'ended-mission-rewritten': [
    'Mission › State enum: when a mission starts, those that were canceled or failed turn into successes',
    () => replace(Robot.prototype, 'start', (start) => function (mission) {
      start.call(this, mission);
      this.missions
        .filter(({ state }) => FINAL_STATES.includes(state))
        .forEach((ended) => Object.assign(ended, { state: STATE.SUCCEEDED }));
    }),
  ],

  'goals-skipped-by-two': [
    'Mission › MissionState: a mission with three goals never goes to the second',
    () => routing(ROUTE.ONCE, ({ goals, goalIndex }, next) => (goalIndex + 2 < goals.length ? goalIndex + 2 : next)),
  ],
  'goals-end-after-first': [
    'Mission › MissionState: a mission with several goals has succeeded at the first',
    () => routing(ROUTE.ONCE, () => undefined),
  ],
  'goals-start-over': [
    'Mission › ServiType enum: a mission that is no patrol starts over after its last goal',
    () => routing(ROUTE.ONCE, ({ goals, goalIndex }) => (goalIndex + 1) % goals.length),
  ],
  'patrol-ends-after-lap': [
    'Mission › ServiType enum, CartiType enum: a patrol has succeeded after its last goal',
    () => routing(ROUTE.PATROL, (mission, next) => (isLast(mission) ? undefined : next)),
  ],
  'patrol-never-wraps': [
    'Mission › MissionState: the goal index of a patrol leaves the list of goals',
    () => routing(ROUTE.PATROL, ({ goalIndex }) => goalIndex + 1),
  ],
  'patrol-wraps-to-second': [
    'Mission › ServiType enum, CartiType enum: after its first lap a patrol leaves out the first goal',
    () => routing(ROUTE.PATROL, (mission, next) => (isLast(mission) ? Math.min(1, mission.goalIndex) : next)),
  ],
  'patrol-of-workflow-ends-after-lap': [
    'Mission › ServiType enum, CartiType enum: a patrol that a workflow made has succeeded after its last goal',
    () => {
      marking('CreateMissionWorkflow', 'ofWorkflow');
      routing(ROUTE.PATROL, (mission, next) => (mission.ofWorkflow && isLast(mission) ? undefined : next));
    },
  ],
  'patrol-of-batch-ends-after-lap': [
    'Mission › ServiType enum, CartiType enum: a patrol that was created in a batch has succeeded after its last goal',
    () => {
      marking('CreateMissionBatch', 'ofBatch');
      routing(ROUTE.PATROL, (mission, next) => (mission.ofBatch && isLast(mission) ? undefined : next));
    },
  ],
  'goal-index-carried-over': [
    'Mission › MissionState: a mission starts at the goal index that the one before it had come to',
    () => replace(Robot.prototype, 'start', (start) => function (mission) {
      const before = this.missions[this.missions.indexOf(mission) - 1];
      if (mission.state === STATE.DEFAULT && before && mission.route !== ROUTE.SELECT) {
        mission.goalIndex = Math.min(before.goalIndex, mission.goals.length - 1);
      }
      start.call(this, mission);
    }),
  ],
  'auto-prefers-last': [
    'Mission › NavigateAutoMission: of the free goals the one with the highest index is selected',
    () => replace(Robot.prototype, 'firstFree', (firstFree) => function (goals, from) {
      return from === 0 ? lastFree(this, goals) : firstFree.call(this, goals, from);
    }),
  ],
  'auto-takes-occupied': [
    'Mission › NavigateAutoMission: the first goal is selected though it is occupied and another one is free',
    () => replace(Robot.prototype, 'isFree', () => () => true),
  ],
  'auto-visits-every-goal': [
    'Mission › NavigateAutoMission: the mission goes through its list instead of ending at the goal it selected',
    () => routing(ROUTE.SELECT, ({ goals, goalIndex }) => (goalIndex + 1 < goals.length ? goalIndex + 1 : undefined)),
  ],

  'skip-ignored': [
    'Mission › SkipGoal: a skip is acknowledged and the mission stays at its goal',
    () => skippingMidway(() => {}),
  ],
  'skip-ends-mission': [
    'Mission › SkipGoal: skipping a goal ends the mission though there are others',
    () => skippingMidway((robot, mission) => robot.complete(mission)),
  ],
  'skip-goes-back': [
    'Mission › SkipGoal: skipping the second goal of three leads to the first',
    () => skippingMidway((robot, mission) => {
      robot.moveOn(mission, mission.goalIndex === 0 ? 1 : mission.goalIndex - 1);
    }),
  ],
  'skip-resumes-paused': [
    'Mission › SkipGoal › Errors: a skip is accepted for a paused mission and makes it run',
    () => replace(OPERATIONS, 'SkipGoal', (skip) => ({
      ...skip,
      allow(robot, request) {
        robot.missions.filter(({ state }) => state === STATE.PAUSED).forEach((mission) => robot.start(mission));
        skip.allow(robot, request);
      },
    })),
  ],
};

function lastFree(robot, goals) {
  const index = goals.findLastIndex((goal) => robot.isFree(goal));
  return index === -1 ? undefined : index;
}
