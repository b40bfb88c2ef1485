// Breaks of what subscribers are told.

import { isDeepStrictEqual } from 'node:util';
import { Feed } from '../feed.mjs';
import { MISSION_KINDS, ROUTE } from '../kinds.mjs';
import { FINAL_STATES, STATE } from '../robot.mjs';
import { replace, reporting, reportingAll } from './alter.mjs';

const NOTHING = { missions: [], currentMissionIndex: -1 };

const isActive = ({ state }) => state === STATE.RUNNING || state === STATE.PAUSED;

function numbering(nextNumber) {
  replace(Feed.prototype, 'nextNumber', () => function () {
    return nextNumber(this.recorded);
  });
}

/** States for which `isConcealed(states, latest)` holds are neither sent nor remembered. */
function concealing(isConcealed) {
  replace(Feed.prototype, 'record', (record) => function (states) {
    if (!isConcealed(states, this.latest?.missionStates)) {
      record.call(this, states);
    }
  });
}

function retyping(change) {
  Object.values(MISSION_KINDS)
    .flatMap(({ members }) => Object.values(members))
    .forEach((member) => member.splice(0, 1, change(member[0])));
}

function listing(isListed) {
  reportingAll((report) => {
    const current = report.missions[report.currentMissionIndex];
    const missions = report.missions.filter(isListed);
    return { missions, currentMissionIndex: missions.indexOf(current) };
  });
}

/** The mission that has just started, if any. */
function started(states, before) {
  const isRunning = ({ state }) => state === STATE.RUNNING;
  const ranBefore = new Set(before?.missions.filter(isRunning).map(({ missionId }) => missionId));
  return states.missions.find((mission) => isRunning(mission) && !ranBefore.has(mission.missionId));
}

export const REPORT_BREAKS = {
  'first-message-missing': [
    'Mission › SubscribeMissionStatus: a subscriber hears nothing until something changes',
    () => replace(Feed.prototype, 'subscribe', () => function (stream) {
      this.streams.add(stream);
    }),
  ],
  'first-message-stale': [
    'Mission › SubscribeMissionStatus: a subscriber is first told that the robot never had a mission',
    () => replace(Feed.prototype, 'subscribe', () => function (stream) {
      this.streams.add(stream);
      this.send(stream, { ...this.latest, missionStates: NOTHING });
    }),
  ],
  'updates-missing': [
    'Mission › SubscribeMissionStatus: after the first message nothing comes',
    () => replace(Feed.prototype, 'deliver', () => () => {}),
  ],
  'updates-to-first-stream-alone': [
    'Mission › SubscribeMissionStatus: of several subscribers the first alone gets updates',
    () => replace(Feed.prototype, 'deliver', () => function () {
      const [first] = this.streams;
      if (first !== undefined) {
        this.send(first, this.latest);
      }
    }),
  ],
  'update-one-behind': [
    'Mission › SubscribeMissionStatus: an update tells the state before the change',
    () => replace(Feed.prototype, 'event', (event) => function (states) {
      const before = this.held ?? states;
      this.held = structuredClone(states);
      return event.call(this, before);
    }),
  ],
  'update-of-pause-missing': [
    'Mission › SubscribeMissionStatus: nobody hears of a pause',
    () => concealing(({ missions }) => missions.some(({ state }) => state === STATE.PAUSED)),
  ],
  'update-of-clear-missing': [
    'Mission › ClearMissionStatus: cleared missions are still reported, to new subscribers as well',
    () => concealing(({ missions }, before) => missions.length === 0 && before?.missions.length > 0),
  ],
  'update-of-goal-missing': [
    'Mission › SubscribeMissionStatus: nobody hears that a running mission has gone on to another goal',
    () => {
      const lifecycles = (states) => states?.missions.map(({ missionId, state }) => [missionId, state]);
      concealing((states, before) => isDeepStrictEqual(lifecycles(states), lifecycles(before)));
    },
  ],
  'phantom-failure': [
    'Mission › State enum: every mission that starts is reported as failed first',
    () => replace(Feed.prototype, 'publish', (publish) => function (states) {
      const mission = started(states, this.latest?.missionStates);
      if (mission) {
        const failed = { ...mission, state: STATE.FAILED };
        publish.call(this, { ...states, missions: states.missions.with(states.missions.indexOf(mission), failed) });
      }
      publish.call(this, states);
    }),
  ],

  'sequence-constant': [
    'Mission › EventMetadata: every event has the same number',
    () => numbering(() => 7),
  ],
  'sequence-decreasing': [
    'Mission › EventMetadata: numbers go down',
    () => numbering((recorded) => 1_000_000 - recorded),
  ],
  'sequence-negative': [
    'Mission › EventMetadata: numbers are negative',
    () => numbering((recorded) => recorded - 1_000_000),
  ],
  'sequence-wraps-to-one': [
    'Mission › EventMetadata: numbers start over at 1 instead of 0',
    () => numbering((recorded) => 1 + (recorded % 3)),
  ],

  'current-index-too-high': [
    'Mission › MissionStates: the index is one past the active mission',
    () => reportingAll((report) => ({
      ...report,
      currentMissionIndex: report.currentMissionIndex === -1 ? -1 : report.currentMissionIndex + 1,
    })),
  ],
  'current-index-always-first': [
    'Mission › MissionStates: the index of the first mission is given for whichever is active',
    () => reportingAll((report) => ({ ...report, currentMissionIndex: Math.min(report.currentMissionIndex, 0) })),
  ],
  'current-index-omitted-when-idle': [
    'Mission › MissionStates: -1 is left out, which means 0',
    () => reportingAll(({ missions, currentMissionIndex }) =>
      currentMissionIndex === -1 ? { missions } : { missions, currentMissionIndex }),
  ],
  'list-reversed': [
    'Mission › MissionStates: missions are listed from last to first',
    () => reportingAll(({ missions, currentMissionIndex }) => ({
      missions: missions.toReversed(),
      currentMissionIndex: currentMissionIndex === -1 ? -1 : missions.length - 1 - currentMissionIndex,
    })),
  ],
  'list-omits-queued': [
    'Mission › MissionStates: missions are not listed before they start',
    () => listing(({ state }) => state !== STATE.DEFAULT),
  ],
  'list-omits-finished': [
    'Mission › MissionStates: a mission is gone as soon as it ends, without a clear',
    () => listing(({ state }) => !FINAL_STATES.includes(state)),
  ],

  'goals-reversed': [
    'Mission › MissionState: goals are listed from last to first',
    () => reporting(({ goals }) => ({ goals: goals.toReversed() })),
  ],
  'goals-without-last': [
    'Mission › MissionState: the last of several goals is not listed',
    () => reporting(({ goals }) => ({ goals: goals.length > 1 ? goals.slice(0, -1) : goals })),
  ],
  'goals-without-reached': [
    'Mission › MissionState: goals are not listed any more once they are reached',
    () => reporting(({ goals, currentGoalIndex }, { route }) =>
      route === ROUTE.SELECT ? {} : { goals: goals.slice(currentGoalIndex), currentGoalIndex: 0 }),
  ],
  'goal-index-stuck': [
    'Mission › MissionState: the goal index stays 0 while the mission advances',
    () => reporting((report, { route }) => (route === ROUTE.SELECT ? {} : { currentGoalIndex: 0 })),
  ],
  'goal-index-negative': [
    'Mission › MissionState: an active mission has no active goal',
    () => reporting((report) => (isActive(report) && report.goals.length > 0 ? { currentGoalIndex: -1 } : {})),
  ],
  'goal-index-beyond-goals': [
    'Mission › MissionState: on its last goal a mission reports an index that no way of counting reaches',
    () => reporting((report) => {
      const { length } = report.goals;
      const isOnLast = isActive(report) && length > 0 && report.currentGoalIndex === length - 1;
      return isOnLast ? { currentGoalIndex: length + 1 } : {};
    }),
  ],

  'type-auto-as-navigate': [
    'Mission › MissionType: a NavigateAuto mission is reported as a Navigate mission',
    () => retyping((type) => type.replace('NAVIGATE_AUTO', 'NAVIGATE')),
  ],
  'type-bussing-as-serving': [
    'Mission › ServiType enum: a bussing mission is reported as a serving mission',
    () => retyping((type) => type.replace('BUSSING', 'SERVING')),
  ],
  'type-patrol-as-plain': [
    'Mission › ServiType enum, CartiType enum: a patrol is reported as the mission that goes through its goals once',
    () => retyping((type) => type.replace('_PATROL', '')),
  ],
  'feedback-of-other-family': [
    'Mission › MissionFeedback: feedback is that of a family which is neither the mission\'s nor the robot\'s',
    () => reporting(({ missionFeedback }, mission, { world }) => {
      const field = world.family === 'carti' ? 'serviFeedback' : 'cartiFeedback';
      const [feedback] = Object.values(missionFeedback);
      return feedback ? { missionFeedback: { [field]: feedback } } : {};
    }),
  ],
};
