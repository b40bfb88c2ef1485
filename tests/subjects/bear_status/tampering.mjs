// The breaks that falsify a value on its way out. Honest values pass through untouched.

import { isDeepStrictEqual } from 'node:util';
import { broken } from './breaks.mjs';

const NO_WIFI = { ssid: '', signalLevelDbm: 0, linkQuality: 0, security: 'SECURITY_UNKNOWN' };

/** By part of a robot's report: the break, and what it does to that part. */
const PART_TAMPERINGS = {
  battery: {
    'battery-in-bytes': (battery) => ({ ...battery, chargePercent: Math.round((battery.chargePercent ?? 0) * 2.55) }),
    'battery-rounded': (battery) => ({ ...battery, chargePercent: 10 * Math.floor((battery.chargePercent ?? 0) / 10) }),
    'battery-charging-without-method': (battery) =>
      battery.state === 'STATE_CHARGING' ? { ...battery, chargeMethod: 'CHARGE_METHOD_NONE' } : battery,
    'battery-full-as-charging': (battery) => renamed(battery, 'state', 'STATE_FULL', 'STATE_CHARGING'),
    'battery-short-enum': (battery) => ({ ...battery, state: battery.state?.replace('STATE_', '') }),
  },
  errorCodes: {
    'severity-raised': eachCode((code) => renamed(code, 'severity', 'SEVERITY_LOW', 'SEVERITY_MEDIUM')),
    'severity-invented': eachCode((code) => renamed(code, 'severity', 'SEVERITY_HIGH', 'SEVERITY_CRITICAL')),
    'error-code-shifted': eachCode((code) => ({ ...code, code: (code.code ?? 0) + 1 })),
    'error-message-blank': eachCode((code) => ({ ...code, message: '' })),
    'codes-first-only': (errors) => ({ ...errors, codes: (errors.codes ?? []).slice(0, 1) }),
  },
  wifi: {
    'link-quality-in-percent': (wifi) => wifi && { ...wifi, linkQuality: Math.round((wifi.linkQuality ?? 0) / 0.7) },
    'wifi-security-downgraded': (wifi) => wifi && { ...wifi, security: 'SECURITY_UNSECURED' },
    'wifi-invented': (wifi) => wifi ?? NO_WIFI,
    'wifi-omitted': () => null,
  },
  navigationState: {
    'reason-while-not-stuck': whenNotStuck((stuck) => ({ ...stuck, reason: 'REASON_PATH_BLOCKED' })),
    'stuck-state-unknown': whenNotStuck((stuck) => ({ ...stuck, state: 'STATE_UNKNOWN' })),
    'stuck-always': whenNotStuck((stuck) => ({ ...stuck, state: 'STATE_STUCK' })),
    'stuck-reason-swapped': (navigation) => ({
      ...navigation,
      stuckState: renamed(navigation.stuckState, 'reason', 'REASON_INSIDE_RESTRICTED_AREA', 'REASON_PATH_BLOCKED'),
    }),
  },
  connection: {
    'connection-unknown': (connection) => renamed(connection, 'state', 'STATE_DISCONNECTED', 'STATE_UNKNOWN'),
  },
  emergencyStop: {
    'emergency-fields-swapped': (stop) => ({ emergency: stop.buttonPressed, buttonPressed: stop.emergency }),
  },
  mission: {
    'mission-running-as-succeeded': (mission) => renamed(mission, 'state', 'STATE_RUNNING', 'STATE_SUCCEEDED'),
  },
  twist: {
    'twist-sign-flipped': (twist) => ({ ...twist, angularVelocity: -(twist.angularVelocity ?? 0) }),
  },
};

/** Breaks that concern which fields of the whole state are set. */
const STATE_TAMPERINGS = {
  'twist-invented': (state) => ({ twist: { linearVelocity: 0.25, angularVelocity: 0 }, ...state }),
  'both-typed-states': (state) => ({ serviState: {}, cartiState: {}, ...state }),
  'typed-state-swapped': ({ serviState, cartiState, ...state }) => ({
    ...state,
    ...(serviState && { cartiState: {} }),
    ...(cartiState && { serviState: {} }),
  }),
};

/** Breaks that concern what an update says, given what the one before and the very first said. */
const UPDATE_TAMPERINGS = {
  'codes-delta': (content, before) =>
    content.codes ? { codes: codesNotIn(before.codes, content.codes) } : content,
  'codes-accumulate': (content, before) =>
    content.codes ? { codes: [...before.codes, ...codesNotIn(before.codes, content.codes)] } : content,
  'robot-update-keeps-old-battery': (content, _before, first) =>
    content.robotState ? { robotState: { ...content.robotState, battery: first.robotState.battery } } : content,
};

/** One reported part as it goes out; a part that is not known stays so. */
export function partAsSent(part, value) {
  return value === undefined ? value : applyBroken(PART_TAMPERINGS[part], value);
}

/** A whole robot state as it goes out. */
export function stateAsSent(state) {
  const parts = Object.entries(state).map(([part, value]) => [part, partAsSent(part, value)]);
  return applyBroken(STATE_TAMPERINGS, Object.fromEntries(parts));
}

/** What a new subscriber is told of one robot. */
export function snapshotAsSent({ first, latest }) {
  return broken('first-message-stale') ? { ...latest, content: first.content } : latest;
}

/** What an update tells of one robot. */
export function updateAsSent({ first, before, latest }) {
  if (broken('update-one-behind')) return { ...latest, content: before.content };
  return { ...latest, content: applyBroken(UPDATE_TAMPERINGS, latest.content, before.content, first.content) };
}

function applyBroken(tamperings = {}, value, ...context) {
  const active = Object.keys(tamperings).find(broken);
  return active === undefined ? value : tamperings[active](value, ...context);
}

function codesNotIn(other, codes) {
  return codes.filter((code) => !other.some((known) => isDeepStrictEqual(known, code)));
}

function renamed(message, field, from, to) {
  return message?.[field] === from ? { ...message, [field]: to } : message;
}

function eachCode(change) {
  return (errors) => ({ ...errors, codes: (errors.codes ?? []).map(change) });
}

function whenNotStuck(change) {
  return (navigation) =>
    navigation.stuckState?.state === 'STATE_NOT_STUCK'
      ? { ...navigation, stuckState: change(navigation.stuckState) }
      : navigation;
}
