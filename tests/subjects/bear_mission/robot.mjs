// The robot: its listed missions, which of them is active, and how it goes through its goals.
//
// Nothing starts by itself in the middle of a change: `proceed` is called after every one of them.

import { randomUUID } from 'node:crypto';
import { ROUTE } from './kinds.mjs';

export const STATE = {
  DEFAULT: 'STATE_DEFAULT', // queued, not yet started (AM-08 a)
  RUNNING: 'STATE_RUNNING',
  PAUSED: 'STATE_PAUSED',
  CANCELED: 'STATE_CANCELED',
  SUCCEEDED: 'STATE_SUCCEEDED',
  FAILED: 'STATE_FAILED',
};

const { DEFAULT, RUNNING, PAUSED, CANCELED, SUCCEEDED, FAILED } = STATE;

export const ACTIVE_STATES = [RUNNING, PAUSED];
export const FINAL_STATES = [CANCELED, SUCCEEDED, FAILED];

/** Each command: the states that it is valid in, and the state that it leads to (AM-29 a, AM-30 a, AM-31 a). */
export const COMMANDS = {
  COMMAND_CANCEL: { from: ACTIVE_STATES, to: CANCELED },
  COMMAND_PAUSE: { from: [RUNNING], to: PAUSED },
  COMMAND_RESUME: { from: [PAUSED], to: RUNNING },
  COMMAND_FINISH: { from: ACTIVE_STATES, to: SUCCEEDED },
};

const NO_MISSION = -1;
const OWNER = 'api';

export class Robot {
  constructor(world) {
    this.world = world;
    this.missions = [];
  }

  // What there is.

  current() {
    return this.missions.find(({ state }) => ACTIVE_STATES.includes(state));
  }

  running() {
    return this.missions.find(({ state }) => state === RUNNING);
  }

  queued() {
    return this.missions.filter(({ state }) => state === DEFAULT);
  }

  isBusy() {
    return this.missions.some(({ state }) => !FINAL_STATES.includes(state));
  }

  find(id) {
    return this.missions.find((mission) => mission.id === id);
  }

  canCharge() {
    return this.world.contactDock && this.world.chargingLocation;
  }

  // What callers do.

  assign(plan) {
    const mission = { ...plan, id: this.newId(), state: DEFAULT, goalIndex: 0, hasSelected: false };
    this.missions.push(mission);
    return mission;
  }

  assignAll(plans) {
    return plans.map((plan) => this.assign(plan));
  }

  newId() {
    return randomUUID();
  }

  obey(mission, command) {
    mission.state = COMMANDS[command].to;
  }

  /** Only what is reported goes away: the robot has nothing else (AM-13 a, AM-59 a). */
  clear() {
    const cleared = this.missions;
    this.missions = [];
    return cleared;
  }

  /** Give up the current goal of a mission; where there is no other, the mission is done (AM-17 a, AM-18 a). */
  skip(mission) {
    const next = mission.route === ROUTE.SELECT
      ? this.firstFree(mission.goals, mission.goalIndex + 1)
      : this.following(mission);
    this.moveOn(mission, next);
  }

  // What the environment does. Each returns whether it applies now.

  reachGoal() {
    const mission = this.running();
    if (!mission || !isOnItsWay(mission)) {
      return false;
    }
    this.moveOn(mission, this.following(mission));
    return true;
  }

  succeed() {
    const mission = this.running();
    if (mission) {
      this.complete(mission);
    }
    return mission !== undefined;
  }

  fail() {
    const mission = this.current();
    if (mission) {
      mission.state = FAILED;
    }
    return mission !== undefined;
  }

  // What the robot does by itself.

  /** The next mission starts as soon as the one before is done, however it ended (AM-09 a, AM-10 a). */
  proceed() {
    const next = this.nextToStart();
    if (next && !this.current() && !this.world.blocked) {
      this.start(next);
    }
    const running = this.running();
    if (running?.route === ROUTE.SELECT && !running.hasSelected) {
      this.select(running);
    }
  }

  nextToStart() {
    return this.queued()[0];
  }

  start(mission) {
    mission.state = RUNNING;
  }

  /** Decided when the mission starts; where every goal is taken it waits for one, at index 0 (AM-45 a, i). */
  select(mission) {
    const index = this.firstFree(mission.goals, 0);
    if (index !== undefined) {
      mission.goalIndex = index;
      mission.hasSelected = true;
    }
  }

  firstFree(goals, from) {
    const index = goals.findIndex((goal, i) => i >= from && this.isFree(goal));
    return index === -1 ? undefined : index;
  }

  /** Nobody can be known to hold a mere pose. */
  isFree({ destinationId }) {
    return !this.world.occupied.includes(destinationId);
  }

  /** The index of the goal after the current one, or undefined after the last. */
  following({ route, goals, goalIndex }) {
    const next = goalIndex + 1;
    if (route === ROUTE.PATROL) {
      return next % goals.length;
    }
    return route === ROUTE.ONCE && next < goals.length ? next : undefined;
  }

  moveOn(mission, index) {
    if (index === undefined) {
      this.complete(mission);
    } else {
      mission.goalIndex = index;
    }
  }

  complete(mission) {
    mission.state = SUCCEEDED;
  }

  // What subscribers see.

  report() {
    return {
      missions: this.missions.map((mission) => this.reportOf(mission)),
      currentMissionIndex: this.currentIndex(),
    };
  }

  currentIndex() {
    const current = this.current();
    return current ? this.missions.indexOf(current) : NO_MISSION;
  }

  reportOf(mission) {
    return {
      missionId: mission.id,
      state: mission.state,
      goals: mission.goals,
      currentGoalIndex: mission.goalIndex,
      missionFeedback: feedback(mission),
      missionType: mission.missionType,
      owner: OWNER,
    };
  }
}

// A NavigateAuto mission without a goal waits, and a charge has no goal at all.
function isOnItsWay({ route, hasSelected }) {
  return route === ROUTE.SELECT ? hasSelected : route !== ROUTE.NONE;
}

/** Empty before there is anything to tell; kept after the end (AM-50 a, c, e). */
function feedback(mission) {
  return mission.state === DEFAULT || !isOnItsWay(mission)
    ? {}
    : { [mission.feedbackField]: { status: 'STATUS_NAVIGATING' } };
}
