// A robot's mission client, after the Mission Submission page: the mission codelet, with the JSON connection and the
// name announcement around it. Its clock is virtual.
//
// node isaac_robot.mjs [--break NAME | --list-breaks]

import { serveInstances } from './instance.mjs';
import { broken } from './isaac/robot_breaks.mjs';
import { decode, encode, isObject, microseconds, MISSION_STATUS_PROTO, TEXT_PROTO, uuidFrom } from './isaac/wire.mjs';
import { lineAsSent } from './isaac/wire_breaks.mjs';

/** The page says "periodically" and names no period: short enough to be seen, long enough to read along. */
const RUNNING_PERIOD = microseconds(0.5);
const NAME_PERIOD = microseconds(1);

/** After this many RUNNING the break `success-spontaneous` loses patience. */
const PATIENCE = 3;

/** The channels are the page's. */
const DEFAULT_WORLD = { name: 'robot', channel: 'mission', statusChannel: 'mission_status', nameChannel: 'name' };

const NO_UUID = { lower: '0', upper: '0' };

class MissionClient {
  #now = 0;
  #mission = null;
  #nextRunning = Infinity;
  #nextName = 0;
  #world;
  #notify;
  #firstUuid = null;
  #lingering = null;
  #isDeaf = false;
  #isConnected = true;

  constructor(world, notify) {
    this.#world = { ...DEFAULT_WORLD, ...world };
    this.#notify = notify;
    if (broken('running-without-mission')) this.#report('running', NO_UUID);
    this.#tick();
  }

  /** Lines that are no messages, or whose channel is not that of missions, are skipped. */
  line({ line }) {
    if (!this.#isConnected) return false;
    const message = decode(line);
    if (message?.header.channel !== this.#world.channel) return true;
    const mission = missionFrom(message);
    if (mission !== null && !this.#isDeaf) this.#receive(mission);
    return true;
  }

  #receive(mission) {
    if (this.#mission === null) this.#start(mission);
    else if (!broken('preemption-ignored')) this.#preempt(mission);
  }

  /** The old mission has its FAILURE before the new one begins (AI-32). */
  #preempt(mission) {
    const old = this.#mission;
    this.#stop();
    if (broken('preempted-goes-on') || broken('preempted-ends-twice')) this.#lingering = old;
    if (broken('preempted-too-late')) this.#start(mission);
    this.#reportPreempted(old, mission);
    if (!broken('preempted-too-late') && !broken('preempting-mission-dropped')) this.#start(mission);
  }

  #reportPreempted(old, mission) {
    if (broken('preempted-silently')) return;
    const { uuid } = broken('preempted-under-new-uuid') ? mission : old;
    this.#report(broken('preempted-as-success') ? 'success' : 'failure', uuid);
  }

  /** A config that cannot be applied fails the mission before its behavior tree starts. */
  #start(mission) {
    this.#firstUuid ??= mission.uuid;
    if (mission.config === null || (broken('empty-config-refused') && isEmpty(mission.config))) {
      this.#report(broken('bad-config-succeeds') ? 'success' : 'failure', mission.uuid);
      return;
    }
    this.#mission = mission;
    this.#nextRunning = this.#now;
    this.#tick();
  }

  #stop() {
    this.#mission = null;
    this.#nextRunning = Infinity;
  }

  behaviorSucceeded() {
    if (this.#mission === null) return false;
    this.#isDeaf = broken('deaf-after-success');
    this.#finish(broken('success-as-failure') ? 'failure' : 'success', broken('success-missing'));
    return true;
  }

  behaviorFailed() {
    if (this.#mission === null) return false;
    this.#isDeaf = broken('deaf-after-failure');
    this.#finish(broken('failure-as-success') ? 'success' : 'failure', broken('failure-missing'));
    return true;
  }

  #finish(status, isSilent) {
    const { uuid } = this.#mission;
    this.#stop();
    if (isSilent) return;
    this.#report(status, uuid);
    if (broken('final-twice')) this.#report(status, uuid);
    if (broken('preempted-ends-twice') && this.#lingering !== null) this.#report(status, this.#lingering.uuid);
    if (broken('running-after-final')) this.#report('running', uuid);
  }

  /** Everything that is due on the way happens at its own time. */
  advance({ seconds }) {
    if (!(seconds >= 0)) return false;
    const end = this.#now + microseconds(seconds);
    while (this.#nextDue() <= end) {
      this.#now = this.#nextDue();
      this.#tick();
    }
    this.#now = end;
    return true;
  }

  /** What the robot would say while the connection is down is lost; its mission goes on. */
  disconnect() {
    if (!this.#isConnected) return false;
    this.#isConnected = false;
    return true;
  }

  connect() {
    if (this.#isConnected) return false;
    this.#isConnected = true;
    this.#announceName();
    return true;
  }

  #nextDue() {
    return Math.min(this.#nextRunning, this.#nextName);
  }

  #tick() {
    if (this.#nextName <= this.#now) this.#announceName();
    if (this.#nextRunning <= this.#now) this.#reportRunning();
  }

  #announceName() {
    this.#nextName = this.#now + NAME_PERIOD;
    this.#send(this.#world.nameChannel, TEXT_PROTO, { text: this.#world.name });
  }

  #reportRunning() {
    this.#nextRunning = this.#now + RUNNING_PERIOD;
    if (!broken('running-missing')) this.#report('running', this.#runningUuid());
    if (broken('preempted-goes-on') && this.#lingering !== null) this.#report('running', this.#lingering.uuid);
    this.#mission.reports += 1;
    if (broken('success-spontaneous') && this.#mission.reports === PATIENCE) this.#finish('success', false);
  }

  #runningUuid() {
    return broken('running-for-first-mission') ? this.#firstUuid : this.#mission.uuid;
  }

  #report(status, uuid) {
    const { channel, statusChannel } = this.#world;
    const missionStatus = status === 'success' && broken('status-invented') ? 'done' : status;
    const target = broken('status-on-mission-channel') ? channel : statusChannel;
    this.#send(target, MISSION_STATUS_PROTO, { uuid: uuidAsSent(uuid), missionStatus });
  }

  #send(channel, proto, payload) {
    if (!this.#isConnected) return;
    const line = encode({ channel, proto, payload, now: this.#now });
    this.#notify('line', { line: lineAsSent(line, broken) });
  }
}

/** The mission in a message, or null where it cannot be told which one it is. */
function missionFrom({ header, payload }) {
  const uuid = uuidFrom(broken('uuid-of-header') ? header.uuid : payload.uuid ?? NO_UUID);
  return uuid === null ? null : { uuid, config: configFrom(payload.config ?? {}), reports: 0 };
}

/**
 * The config, or null where it cannot be applied. It comes as JSON text in `serialized`, or as the object itself
 * (AI-28); text that is empty or "null" is the empty config (AI-33).
 */
function configFrom(config) {
  if (!isObject(config)) return null;
  const { serialized } = config;
  if (serialized === undefined || serialized === null || serialized === '') return config;
  const parsed = parsedConfig(serialized);
  return isObject(parsed) ? parsed : null;
}

function parsedConfig(serialized) {
  try {
    return JSON.parse(serialized) ?? {};
  } catch {
    return null;
  }
}

function isEmpty(config) {
  return Object.keys(config).length === 0;
}

function uuidAsSent({ lower, upper }) {
  if (broken('uuid-halves-swapped')) return { lower: upper, upper: lower };
  if (broken('uuid-rounded')) return { lower: rounded(lower), upper: rounded(upper) };
  return { lower, upper };
}

function rounded(half) {
  return String(BigInt(Number(half)));
}

await serveInstances('isaac.robot', {
  implementation: { name: 'isaac_robot.mjs', version: '1' },
  create: (world, notify) => new MissionClient(world, notify),
  calls: {},
  drives: {
    line: (client, event) => client.line(event),
    behaviorSucceeded: (client) => client.behaviorSucceeded(),
    behaviorFailed: (client) => client.behaviorFailed(),
    advance: (client, event) => client.advance(event),
    disconnect: (client) => client.disconnect(),
    connect: (client) => client.connect(),
  },
});
