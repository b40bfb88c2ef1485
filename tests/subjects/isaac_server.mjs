// A mission server, after the Mission Submission page: it queues missions per robot, sends each when its upstream
// missions have succeeded and its robot is free, and follows it by the robot's status messages. Its clock is virtual.
//
// node isaac_server.mjs [--break NAME | --list-breaks]

import { serveInstances } from './instance.mjs';
import { deadline, isDoomed, isReady, isUnderWay, missionFrom } from './isaac/mission.mjs';
import { broken } from './isaac/server_breaks.mjs';
import { decode, encode, isSameUuid, microseconds, MISSION_PROTO, uuidFrom } from './isaac/wire.mjs';
import { lineAsSent } from './isaac/wire_breaks.mjs';

/** Mission statuses come by name, in either case, or by number (AI-28). */
const REPORTED_STATUSES = ['RUNNING', 'SUCCESS', 'FAILURE'];

class MissionServer {
  #now = 0;
  #missions = [];
  #connections = new Map();
  #connectionCount = 0;
  #nameChannel;
  #notify;
  #isDeaf = false;

  constructor({ nameChannel = 'name' }, notify) {
    this.#nameChannel = nameChannel;
    this.#notify = notify;
  }

  submit({ mission: submission }) {
    const mission = missionFrom(submission, this.#missions);
    mission.isForgotten = broken('late-submission-unsent') && this.#connectionsOf(mission).length > 0;
    this.#missions.push(mission);
    this.#schedule();
    return { mission: mission.handle };
  }

  statuses() {
    return { missions: Object.fromEntries(this.#missions.map(({ handle, status }) => [handle, shownStatus(status)])) };
  }

  connect() {
    const number = ++this.#connectionCount;
    this.#connections.set(number, { number, name: null });
    this.#schedule();
    return { connection: number };
  }

  /** The mission under way on the connection has failed; what is queued waits for the robot to come back (AI-15). */
  disconnect({ connection: number }) {
    const connection = this.#connections.get(number);
    if (!this.#connections.delete(number)) return false;
    const lost = this.#missionUnderWayOn(connection);
    if (lost !== undefined) lost.status = 'FAILED_DISCONNECTED';
    if (broken('queue-lost-on-disconnect')) this.#forgetQueueOf(connection.name);
    this.#schedule();
    return true;
  }

  #forgetQueueOf(robot) {
    const queue = this.#missions.filter((mission) => mission.robot === robot && mission.status === 'QUEUED');
    for (const mission of queue) mission.isForgotten = true;
  }

  /** Lines that are no messages, and messages on channels that nobody listens to, are skipped. */
  line({ connection: number, line }) {
    const connection = this.#connections.get(number);
    if (connection === undefined) return false;
    const message = decode(line);
    this.#isDeaf ||= message === null && broken('bad-line-deafens');
    if (message !== null && !this.#isDeaf) this.#receive(connection, message);
    return true;
  }

  #receive(connection, { header, payload }) {
    if (this.#isName(header, payload)) this.#identify(connection, payload.text);
    else this.#takeStatus(connection, header, payload);
    this.#schedule();
  }

  #isName(header, { text }) {
    if (typeof text !== 'string' || text === '') return false;
    return header.channel === this.#nameChannel || broken('any-channel-names');
  }

  /** The first name counts: robots repeat it periodically, and another one would be a mistake (AI-17). */
  #identify(connection, name) {
    if (connection.name !== null) {
      if (broken('name-resends')) this.#resend(this.#missionUnderWayOn(connection), connection);
      return;
    }
    connection.name = name;
    if (broken('finished-resent')) this.#resend(this.#lastSuccessOf(name), connection);
  }

  #resend(mission, connection) {
    if (mission !== undefined) this.#sendLine(mission, connection);
  }

  #lastSuccessOf(robot) {
    return this.#missions.findLast((mission) => mission.robot === robot && mission.status === 'SUCCESS');
  }

  #missionUnderWayOn(connection) {
    return this.#missions.find((mission) => mission.connection === connection && isUnderWay(mission));
  }

  #takeStatus(connection, header, payload) {
    const reported = reportedStatus(payload.missionStatus);
    const mission = this.#missionMeant(connection, header, payload);
    if (reported !== undefined && mission !== undefined) this.#apply(reported, mission);
  }

  /**
   * The mission that was sent on that connection, if the status came on its status channel and, where it says which
   * mission it is about, is about that one: the last word on a mission that was aborted must not end its successor
   * (AI-10).
   */
  #missionMeant(connection, { channel }, { uuid }) {
    const heard = this.#missions.filter((mission) => channelToHear(mission) === channel);
    if (broken('any-robot-reports')) return heard.find(isUnderWay);
    const sent = heard.filter((mission) => mission.connection === connection);
    if (broken('uuid-ignored')) return sent.find(isUnderWay);
    const meant = sent.filter((mission) => uuid == null || isSameUuid(uuidFrom(uuid), mission.uuid));
    return meant.find(isUnderWay) ?? meant.at(-1);
  }

  /** Any status acknowledges a mission; a final one ends it, whether or not RUNNING came before (AI-07). */
  #apply(reported, mission) {
    if (!isUnderWay(mission) && !canReopen(reported, mission)) return;
    if (reported === 'RUNNING') this.#run(mission);
    else if (!(reported === 'SUCCESS' && broken('success-ignored'))) mission.status = finalStatus(reported);
  }

  #run(mission) {
    if (mission.status !== 'RUNNING') {
      mission.status = 'RUNNING';
      mission.clockStarted = this.#now;
    } else if (broken('status-falls-back')) {
      mission.status = 'STARTED';
    } else if (broken('timeout-restarts')) {
      mission.clockStarted = this.#now;
    }
  }

  /** Time stops at each deadline on the way, since an abort lets the next mission go, whose time starts there. */
  advance({ seconds }) {
    if (!(seconds >= 0)) return false;
    const end = this.#now + microseconds(seconds);
    for (let next = this.#nextDeadline(); next <= end; next = this.#nextDeadline()) {
      this.#now = next;
      this.#schedule();
    }
    this.#now = end;
    return true;
  }

  #nextDeadline() {
    return Math.min(...this.#missions.map(deadline));
  }

  /** Cancels, aborts and sends until nothing more follows. */
  #schedule() {
    while (this.#cancelOne() || this.#abortOne() || this.#sendOne());
  }

  #cancelOne() {
    const mission = this.#missions.find((candidate) => candidate.status === 'QUEUED' && isDoomed(candidate));
    if (mission === undefined) return false;
    mission.status = 'FAILED_UPSTREAM';
    return true;
  }

  #abortOne() {
    const mission = this.#missions.find((candidate) => deadline(candidate) <= this.#now);
    if (mission === undefined) return false;
    mission.status = 'FAILED_TIMEDOUT';
    if (broken('aborted-resent')) this.#resend(mission, mission.connection);
    return true;
  }

  /** A mission that waits does not hold up those behind it that could go (AI-12). */
  #sendOne() {
    const mission = this.#missions.find((candidate) => this.#canBeSent(candidate));
    if (mission === undefined) return false;
    this.#send(mission, this.#connectionsOf(mission));
    return true;
  }

  #canBeSent(mission) {
    return (
      mission.status === 'QUEUED' &&
      isReady(mission) &&
      this.#isFree(mission.robot) &&
      this.#connectionsOf(mission).length > 0 &&
      !mission.isForgotten
    );
  }

  /** One mission at a time for a robot, since a second would preempt the first (AI-11). */
  #isFree(robot) {
    if (broken('two-at-once')) return true;
    const others = this.#missions.filter((mission) => mission.robot === robot);
    if (broken('failure-stops-queue') && others.some((mission) => mission.status === 'FAILED')) return false;
    return !others.some(isUnderWay);
  }

  /** The connections that the mission's robot has; the newest, which is the one to use, comes first (AI-16). */
  #connectionsOf({ robot }) {
    const newestFirst = [...this.#connections.values()].reverse();
    if (broken('wrong-robot')) return newestFirst.filter(({ name }) => name !== null);
    const own = newestFirst.filter(({ name }) => isNameOf(robot, name));
    return own.length === 0 && broken('unnamed-served') ? newestFirst.filter(({ name }) => name === null) : own;
  }

  #send(mission, [newest, ...namesakes]) {
    mission.connection = newest;
    mission.status = broken('running-unreported') ? 'RUNNING' : 'STARTED';
    mission.clockStarted = this.#now;
    this.#sendLine(mission, newest);
    if (broken('sent-twice')) this.#sendLine(mission, newest);
    if (broken('namesakes-both-served')) namesakes.forEach((connection) => this.#sendLine(mission, connection));
  }

  #sendLine(mission, connection) {
    const payload = { uuid: mission.uuid, config: { serialized: JSON.stringify(this.#configToSend(mission)) } };
    const line = encode({ channel: channelToUse(mission), proto: MISSION_PROTO, payload, now: this.#now });
    this.#notify('line', { connection: connection.number, line: lineAsSent(line, broken) });
  }

  #configToSend({ config }) {
    if (broken('config-empty')) return {};
    if (broken('config-of-first')) return this.#missions[0].config;
    if (broken('config-numbers-as-text')) return withNumbersAsText(config);
    return config;
  }
}

function isNameOf(robot, name) {
  if (broken('name-beginning-suffices')) return name && robot.startsWith(name);
  return broken('name-case-ignored') ? name?.toLowerCase() === robot.toLowerCase() : name === robot;
}

function reportedStatus(value) {
  if (typeof value === 'number') return REPORTED_STATUSES[value];
  return REPORTED_STATUSES.find((status) => status === String(value).toUpperCase());
}

function finalStatus(reported) {
  if (broken('success-as-failed')) return 'FAILED';
  if (broken('failure-as-success')) return 'SUCCESS';
  return reported === 'SUCCESS' ? 'SUCCESS' : 'FAILED';
}

/** A mission that has ended stays as it ended (AI-09). */
function canReopen(reported, { status }) {
  if (broken('failure-overwritten') && status === 'FAILED') return reported === 'SUCCESS';
  return reported === 'RUNNING' ? broken('terminal-revived') : broken('terminal-overwritten');
}

function shownStatus(status) {
  if (broken('cancelled-as-success') && status === 'FAILED_UPSTREAM') return 'SUCCESS';
  if (broken('abort-as-success') && status === 'FAILED_TIMEDOUT') return 'SUCCESS';
  return status;
}

function channelToHear({ statusChannel }) {
  return broken('status-channel-ignored') ? 'mission_status' : statusChannel;
}

function channelToUse({ channel, statusChannel }) {
  if (broken('channel-ignored')) return 'mission';
  return broken('sent-on-status-channel') ? statusChannel : channel;
}

function withNumbersAsText(value) {
  return JSON.parse(JSON.stringify(value, (_key, part) => (typeof part === 'number' ? String(part) : part)));
}

await serveInstances('isaac.server', {
  implementation: { name: 'isaac_server.mjs', version: '1' },
  create: (world, notify) => new MissionServer(world, notify),
  calls: {
    submit: (server, request) => server.submit(request),
    statuses: (server) => server.statuses(),
  },
  drives: {
    connect: (server) => server.connect(),
    line: (server, event) => server.line(event),
    disconnect: (server, event) => server.disconnect(event),
    advance: (server, event) => server.advance(event),
  },
});
