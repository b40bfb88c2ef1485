// The ways in which a break alters the honest implementation. Its functions are the places where breaks take hold,
// so that its own text stays free of them.

import { Refusal } from '../../jsonrpc.mjs';
import { OPERATIONS, precondition } from '../operations.mjs';
import { Robot } from '../robot.mjs';

/** Puts `make(original)` in the place of a function. */
export function replace(holder, name, make) {
  holder[name] = make(holder[name]);
}

/** The operation is allowed whenever `allow` says nothing against it. */
export function allowing(operation, allow = () => {}) {
  OPERATIONS[operation].allow = allow;
}

/** The operation is allowed besides where `also(robot, request)` holds. */
export function allowingAlso(operation, also) {
  replace(OPERATIONS[operation], 'allow', (allow) => (robot, request) => {
    if (!also(robot, request)) {
      allow(robot, request);
    }
  });
}

/** The operation is refused besides where `when(robot, request)` holds. */
export function refusingAlso(operation, when, refusal = precondition('no')) {
  replace(OPERATIONS[operation], 'allow', (allow) => (robot, request) => {
    allow(robot, request);
    if (when(robot, request)) {
      throw refusal;
    }
  });
}

/** A refusal with one status is given another, in reading (`read`) or in judging the situation (`allow`). */
export function recoding(operation, phase, from, to) {
  replace(OPERATIONS[operation], phase, (original) => (...args) => {
    try {
      return original(...args);
    } catch (error) {
      throw error.status === from ? new Refusal(to, error.message) : error;
    }
  });
}

/** The answer goes through `change(answer, robot)`. */
export function answering(operation, change) {
  replace(OPERATIONS[operation], 'perform', (perform) => (robot, request) => change(perform(robot, request), robot));
}

/** The command leads to that state instead. */
export function obeyingWith(command, state) {
  replace(Robot.prototype, 'obey', (obey) => function (mission, given) {
    obey.call(this, mission, given);
    if (given === command) {
      mission.state = state;
    }
  });
}

/** The command is acknowledged, and that is all. */
export function ignoring(command) {
  replace(Robot.prototype, 'obey', (obey) => function (mission, given) {
    if (given !== command) {
      obey.call(this, mission, given);
    }
  });
}

/** The next goal of missions with that route is `next(mission)`; undefined ends the mission. */
export function routing(route, next) {
  replace(Robot.prototype, 'following', (following) => function (mission) {
    return mission.route === route ? next(mission, following.call(this, mission)) : following.call(this, mission);
  });
}

/** What is reported of a mission is overlaid with `change(report, mission, robot)`. */
export function reporting(change) {
  replace(Robot.prototype, 'reportOf', (reportOf) => function (mission) {
    const report = reportOf.call(this, mission);
    return { ...report, ...change(report, mission, this) };
  });
}

/** What is reported of the robot goes through `change(report)`. */
export function reportingAll(change) {
  replace(Robot.prototype, 'report', (report) => function () {
    return change(report.call(this), this);
  });
}
