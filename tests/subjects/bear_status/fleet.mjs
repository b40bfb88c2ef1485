// The robots: what they report, what is known of them, and how their events are numbered.

import { isDeepStrictEqual } from 'node:util';
import { broken } from './breaks.mjs';
import { partAsSent, stateAsSent } from './tampering.mjs';

/** The fields of RobotState, in lowerCamelCase. */
const STATE_PARTS = [
  'connection', 'battery', 'emergencyStop', 'mission', 'pose', 'errorCodes',
  'serviState', 'cartiState', 'twist', 'localizationState', 'navigationState',
];
const PARTS = [...STATE_PARTS, 'wifi'];

/** The members of a oneof replace one another. */
const TYPED_STATES = { serviState: 'cartiState', cartiState: 'serviState' };

/**
 * What the six subscriptions tell. `parts` are the reported parts whose change is an event of the topic; `content`
 * is what an event says, or undefined while nothing is known; `map` names the field of a topic whose messages map
 * robot ids to contents, where the others carry one robot each.
 */
export const TOPICS = {
  battery: {
    parts: ['battery'],
    content: ({ battery }) => battery && { batteryState: partAsSent('battery', battery) },
  },
  errors: {
    parts: ['errorCodes'],
    map: 'errorCodes',
    content: ({ errorCodes }) => errorCodes && { codes: partAsSent('errorCodes', errorCodes).codes ?? [] },
  },
  navigation: {
    parts: ['navigationState'],
    content: ({ navigationState }) =>
      navigationState && { navigationState: partAsSent('navigationState', navigationState) },
  },
  network: {
    parts: ['wifi'],
    map: 'networkStates',
    content: ({ wifi }) => withoutUnset({ connectedWifi: partAsSent('wifi', wifi ?? null) }),
  },
  online: {
    parts: ['connection'],
    map: 'onlineStates',
    content: ({ connection }) => connection && { connection: onlineAsSent(connection) },
  },
  robot: {
    parts: STATE_PARTS,
    content: ({ wifi, ...state }) => ({ robotState: stateAsSent(state) }),
  },
};

function onlineAsSent(connection) {
  if (broken('online-always-connected')) return { state: 'STATE_CONNECTED' };
  return partAsSent('connection', connection);
}

export class Fleet {
  #robots;
  #locations;

  constructor({ robots = [], locations = [] }) {
    this.#robots = new Map(robots.map((robot) => [robot.robotId, new Robot(robot)]));
    this.#locations = new Map(locations.map((location) => [location.locationId, location]));
  }

  get robots() {
    return [...this.#robots.values()];
  }

  get owned() {
    return this.robots.filter((robot) => robot.owned);
  }

  robot(id) {
    return this.#robots.get(id);
  }

  location(id) {
    return this.#locations.get(id);
  }
}

/**
 * One robot. A robot numbers its events with one counter for all topics, starting at 0 with the event of its start,
 * which announces all that it knows. For each topic the latest event is kept: it is what a new subscriber gets, and
 * it outlives the moment when the robot stops reporting a part, since it is still the latest that is known (AS-09).
 */
class Robot {
  #locationId;
  #reported;
  #eventCount = 0;
  #events = {};

  constructor({ robotId, locationId, owned, state, wifi }) {
    this.id = robotId;
    this.owned = owned;
    this.#locationId = locationId;
    const battery = inRange('battery', state.battery);
    this.#reported = withoutUnset({ ...state, battery, wifi: inRange('wifi', wifi) });
    this.#announceAll();
  }

  isAt(locationId) {
    return this.#locationId === locationId;
  }

  /** The current RobotState: what the robot does not report is left out. */
  get state() {
    const { wifi, ...state } = this.#reported;
    return stateAsSent(state);
  }

  /** The first, the last but one and the latest event of a topic; undefined while nothing is known. */
  events(topic) {
    return this.#events[topic];
  }

  /** Takes a report in; returns the topics that have a new event, or null where no robot could report that. */
  report(part, value) {
    if (!PARTS.includes(part) || isImpossible(part, value)) return null;
    const whole = inRange(part, value);
    const now = broken('reports-merged') && value ? { ...this.#reported[part], ...whole } : whole;
    const reported = withoutUnset({ ...this.#reported, ...replacedBy(part, now), [part]: now });
    if (isDeepStrictEqual(reported, this.#reported)) return [];
    this.#reported = reported;
    return this.#record(topicsOf(part));
  }

  /** Numbers start over, and the robot announces its whole state again as the first event. */
  restart() {
    this.#eventCount = broken('sequence-negative-after-restart') ? -1 : 0;
    return this.#announceAll();
  }

  #announceAll() {
    return this.#record(Object.keys(TOPICS));
  }

  /** One event for all the given topics that have something to say; returns those. */
  #record(topics) {
    const metadata = { timestamp: new Date().toISOString(), sequenceNumber: this.#nextSequenceNumber() };
    return topics.filter((topic) => this.#recordOne(topic, metadata));
  }

  #recordOne(topic, metadata) {
    const content = TOPICS[topic].content(this.#reported);
    if (content === undefined) return false;
    const latest = { metadata, content };
    const { first, latest: before } = this.#events[topic] ?? { first: latest, latest };
    this.#events[topic] = { first, before, latest };
    return true;
  }

  #nextSequenceNumber() {
    const count = this.#eventCount++;
    if (broken('sequence-constant')) return 7;
    if (broken('sequence-decreasing')) return 1000 - count;
    if (broken('sequence-negative')) return count - 5;
    if (broken('sequence-steps-back')) return count % 3 === 2 ? count + 7 : count + 10;
    if (broken('sequence-pairs')) return 1 + Math.floor(count / 2);
    if (broken('sequence-wraps-to-one')) return count < 4 ? count : 1 + (count % 4);
    return count;
  }
}

function topicsOf(part) {
  if (broken('robot-update-misses-mission') && part === 'mission') return [];
  if (broken('robot-update-misses-emergency-stop') && part === 'emergencyStop') return [];
  return Object.keys(TOPICS).filter((topic) => TOPICS[topic].parts.includes(part));
}

function replacedBy(part, value) {
  return value && part in TYPED_STATES ? { [TYPED_STATES[part]]: undefined } : {};
}

/** The page tells clients to treat an unknown stuck state as an error: no robot of ours sends one (AS-18). */
function isImpossible(part, value) {
  return part === 'navigationState' && value?.stuckState?.state === 'STATE_UNKNOWN';
}

/** Raw readings outside a documented range are clamped into it (AS-28). */
function inRange(part, value) {
  if (part === 'battery') return clamped(value, 'chargePercent', 100);
  if (part === 'wifi') return clamped(value, 'linkQuality', 70);
  return value;
}

function clamped(message, field, highest) {
  if (typeof message?.[field] !== 'number') return message;
  return { ...message, [field]: Math.min(Math.max(message[field], 0), highest) };
}

function withoutUnset(fields) {
  return Object.fromEntries(Object.entries(fields).filter(([, value]) => value !== undefined && value !== null));
}
