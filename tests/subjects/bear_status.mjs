// A cloud API for the status of a fleet, after the Robot Status page: one account's view of its robots.
//
// node bear_status.mjs [--break NAME | --list-breaks]

import { broken } from './bear_status/breaks.mjs';
import { Fleet, TOPICS } from './bear_status/fleet.mjs';
import { isByLocation, robotToGet, selectRobots } from './bear_status/selection.mjs';
import { snapshotAsSent, updateAsSent } from './bear_status/tampering.mjs';
import { serveInstances } from './instance.mjs';
import { Refusal } from './jsonrpc.mjs';

/** Stream numbers are never used twice in a process, so a reset does not start them over. */
let streamCount = 0;

class StatusService {
  #fleet;
  #notify;
  #streams = new Map();
  #fault = null;

  constructor(world, notify) {
    this.#fleet = new Fleet(world);
    this.#notify = notify;
  }

  getRobotStatus(request) {
    const robot = robotToGet(request, this.#fleet);
    this.#meetFault();
    return { robotState: this.#stateToAnswer(robot) };
  }

  #meetFault() {
    const status = this.#fault;
    this.#fault = null;
    if (status !== null) throw new Refusal(status, 'the robot cannot be reached');
  }

  #stateToAnswer(robot) {
    const { state } = robot;
    if (broken('get-wrong-robot')) return (this.#fleet.owned.find((other) => other !== robot) ?? robot).state;
    if (broken('get-always-connected')) return { ...state, connection: { state: 'STATE_CONNECTED' } };
    if (broken('get-omits-emergency-stop')) return { ...state, emergencyStop: undefined };
    if (broken('get-stale')) return robot.events('robot').first.content.robotState;
    return state;
  }

  subscribe(topic, request) {
    const robots = selectRobots(request, this.#fleet);
    const stream = { number: ++streamCount, topic, robots, byLocation: isByLocation(request), updates: 0 };
    if (broken('second-subscription-silences-first')) this.#silence(topic);
    this.#streams.set(stream.number, stream);
    if (!broken(`${topic}-first-message-missing`)) this.#sendSnapshot(stream);
    return { stream: stream.number };
  }

  #silence(topic) {
    for (const stream of this.#streams.values()) {
      if (stream.topic === topic) this.#streams.delete(stream.number);
    }
  }

  cancel(number) {
    this.#streams.delete(number);
    return {};
  }

  /** The latest known state of each selected robot: in one message where messages are maps, else in one per robot. */
  #sendSnapshot(stream) {
    const robots = robotsToShow(stream).filter((robot) => robot.events(stream.topic) !== undefined);
    const entries = robots.map((robot) => [robot, snapshotAsSent(robot.events(stream.topic))]);
    if (TOPICS[stream.topic].map !== undefined && entries.length > 0) this.#send(stream, entries);
    else entries.forEach((entry) => this.#send(stream, [entry]));
  }

  #send(stream, entries) {
    this.#notify('message', { stream: stream.number, message: messageOf(stream, entries) });
  }

  report({ robotId, part, value }) {
    const robot = this.#fleet.robot(robotId);
    const topics = robot?.report(part, value) ?? null;
    if (topics === null) return false;
    this.#publish(robot, topics);
    return true;
  }

  restart({ robotId }) {
    const robot = this.#fleet.robot(robotId);
    if (robot === undefined) return false;
    this.#publish(robot, robot.restart());
    return true;
  }

  /** GetRobotStatus is the only unary RPC, and INTERNAL the only code of its table that comes unprovoked. */
  fault({ status }) {
    if (status !== 'INTERNAL') return false;
    this.#fault = status;
    return true;
  }

  #publish(robot, topics) {
    for (const stream of [...this.#streams.values()]) {
      if (topics.includes(stream.topic) && isFollowed(robot, stream)) this.#sendUpdate(stream, robot);
    }
  }

  #sendUpdate(stream, robot) {
    const event = updateAsSent(robot.events(stream.topic));
    stream.updates += 1;
    if (isSwallowed(stream, event.content)) return;
    this.#send(stream, [[robot, event]]);
    if (broken('stream-closes-cleanly')) this.#close(stream);
  }

  #close(stream) {
    this.#streams.delete(stream.number);
    this.#notify('closed', { stream: stream.number });
  }
}

function robotsToShow({ topic, robots }) {
  if (broken('first-message-lacks-robot') && robots.length > 1) return robots.slice(0, -1);
  if (broken('online-first-message-hides-offline') && topic === 'online') return robots.filter(isOnline);
  return robots;
}

function isOnline(robot) {
  return robot.state.connection?.state === 'STATE_CONNECTED';
}

function isFollowed(robot, { robots, byLocation }) {
  if (broken('unselected-robot-leaks')) return robot.owned;
  if (broken('location-update-lost') && byLocation) return robot === robots[0];
  return robots.includes(robot);
}

/** The breaks that withhold an update. */
function isSwallowed({ topic, updates }, content) {
  if (broken(`${topic}-update-missing`)) return true;
  if (broken('every-second-update-lost')) return updates % 2 === 0;
  if (broken('cleared-codes-missing')) return content.codes?.length === 0;
  if (broken('navigation-recovery-missing')) return content.navigationState?.stuckState?.state === 'STATE_NOT_STUCK';
  if (broken('network-loss-missing')) return topic === 'network' && content.connectedWifi === undefined;
  if (broken('online-disconnect-missing')) return content.connection?.state === 'STATE_DISCONNECTED';
  return false;
}

/** One message about the given robots: a map by robot id, or, always about one robot, its id beside its content. */
function messageOf({ topic, robots }, entries) {
  const { map } = TOPICS[topic];
  const named = entries.map(([robot, { metadata, content }]) => [
    broken('wrong-robot-id') ? robots[0].id : robot.id,
    { metadata, ...content },
  ]);
  if (map !== undefined) return { [map]: Object.fromEntries(named) };
  const [[robotId, { metadata, ...content }]] = named;
  return { metadata, robotId, ...content };
}

const subscription = (topic) => (service, request) => service.subscribe(topic, request);

await serveInstances('bear.status', {
  implementation: { name: 'bear_status.mjs', version: '1' },
  create: (world, notify) => new StatusService(world, notify),
  calls: {
    GetRobotStatus: (service, request) => service.getRobotStatus(request),
    SubscribeBatteryStatus: subscription('battery'),
    SubscribeErrorCodes: subscription('errors'),
    SubscribeNavigationStatus: subscription('navigation'),
    SubscribeNetworkStatus: subscription('network'),
    SubscribeOnlineStatus: subscription('online'),
    SubscribeRobotStatus: subscription('robot'),
    cancel: (service, { stream }) => service.cancel(stream),
  },
  drives: {
    report: (service, event) => service.report(event),
    restart: (service, event) => service.restart(event),
    fault: (service, event) => service.fault(event),
  },
});
