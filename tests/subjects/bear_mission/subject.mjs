// One robot in its world behind the adapter protocol.

import { Refusal, invalidParams } from '../jsonrpc.mjs';
import { Feed } from './feed.mjs';
import { OPERATIONS } from './operations.mjs';
import { RequestReader } from './requests.mjs';
import { Robot } from './robot.mjs';
import { changeWorld, newWorld } from './world.mjs';

const FAULTS = ['INTERNAL', 'DEADLINE_EXCEEDED'];

const DRIVES = {
  goalReached: (subject) => subject.robot.reachGoal(),
  missionSucceeded: (subject) => subject.robot.succeed(),
  missionFailed: (subject) => subject.robot.fail(),
  world(subject, fields) {
    changeWorld(subject.world, fields);
    return true;
  },
  fault: (subject, fields) => subject.arm(fields),
};

export class Subject {
  /** `send(stream, message)` delivers a stream message. */
  constructor(send) {
    this.send = send;
    this.streamsOpened = 0;
    this.reset({});
  }

  /** A fresh robot; streams are forgotten, but their numbers stay used. */
  reset(worldFields) {
    this.world = newWorld(worldFields);
    this.robot = new Robot(this.world);
    this.feed = new Feed(this.send, this.robot.report());
    this.fault = null;
    return {};
  }

  handlers() {
    const calls = Object.entries(OPERATIONS).map(([name, operation]) => [
      name,
      (params) => this.thenCatchUp(() => this.call(operation, params)),
    ]);
    return {
      reset: (params) => this.reset(params?.world ?? {}),
      drive: (params) => this.thenCatchUp(() => this.drive(params)),
      SubscribeMissionStatus: (params) => this.subscribe(params),
      cancel: (params) => this.cancel(params?.stream),
      ...Object.fromEntries(calls),
    };
  }

  /** Whatever a request has changed or not, the robot goes on from there and everybody hears of it. */
  thenCatchUp(action) {
    try {
      return action();
    } finally {
      this.robot.proceed();
      this.feed.record(this.robot.report());
    }
  }

  call({ failures, read, allow, perform }, params = {}) {
    const request = read(new RequestReader(this.world), params);
    allow(this.robot, request);
    const fault = this.takeFault(failures);
    if (fault === null) {
      return perform(this.robot, request);
    }
    if (this.takesEffect(fault)) {
      perform(this.robot, request);
    }
    throw new Refusal(fault.status, 'as the tester wished');
  }

  subscribe(params = {}) {
    new RequestReader(this.world).nothing(params);
    this.streamsOpened += 1;
    this.feed.subscribe(this.streamsOpened);
    return { stream: this.streamsOpened };
  }

  /** A stream that a reset has forgotten can still be canceled. */
  cancel(stream) {
    this.feed.cancel(stream);
    return {};
  }

  drive({ event, ...fields } = {}) {
    if (!Object.hasOwn(DRIVES, event)) {
      throw invalidParams(`there is no drive ${event}`);
    }
    return { happened: DRIVES[event](this, fields) };
  }

  /** A fault that comes before the last one was used replaces it. */
  arm({ status, applied = false }) {
    if (!FAULTS.includes(status)) {
      throw invalidParams(`a fault cannot have the status ${status}`);
    }
    this.fault = { status, applied };
    return true;
  }

  takeFault(failures) {
    const fault = this.fault;
    if (fault === null || !failures.includes(fault.status)) {
      return null;
    }
    this.fault = null;
    return fault;
  }

  takesEffect({ applied }) {
    return applied;
  }
}

export const DRIVE_NAMES = Object.keys(DRIVES);
