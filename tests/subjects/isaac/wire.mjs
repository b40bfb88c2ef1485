// Mission messages as lines of JSON: {"header": {…}, "payload": {…}}, 64-bit integers as decimal strings.

import { randomUUID } from 'node:crypto';

/** Type ids of the payloads, as the signed numbers that a header carries. */
export const MISSION_PROTO = '-9035847460398774087';
export const MISSION_STATUS_PROTO = '-8059665372481944188';
export const TEXT_PROTO = '-7485136457943612313';

/** One outgoing line, without its LF. `now` is in microseconds. */
export function encode({ channel, proto, payload, now }) {
  const nanoseconds = String(BigInt(now) * 1000n);
  const header = { channel, pubtime: nanoseconds, acqtime: nanoseconds, proto, uuid: newUuid() };
  return JSON.stringify({ header, payload });
}

/** The header and payload of an incoming line, or null where it is no message. */
export function decode(line) {
  const message = parsed(line);
  return isObject(message?.header) && isObject(message.payload) ? message : null;
}

function parsed(line) {
  try {
    return JSON.parse(withLongIntegersQuoted(line));
  } catch {
    return null;
  }
}

/** Senders may write a 64-bit integer bare, but beyond 2^53 JSON.parse would round it. */
function withLongIntegersQuoted(line) {
  const stringOrNumber = /"(?:[^"\\]|\\.)*"|-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?/g;
  return line.replace(stringOrNumber, (token) => (/^-?\d{16,}$/.test(token) ? `"${token}"` : token));
}

export function newUuid() {
  const hex = randomUUID().replaceAll('-', '');
  return { lower: String(BigInt(`0x${hex.slice(16)}`)), upper: String(BigInt(`0x${hex.slice(0, 16)}`)) };
}

/** A UUID with both halves as decimal strings, or null where it is none; an absent half is 0, as in any proto. */
export function uuidFrom(value) {
  if (!isObject(value)) return null;
  const { lower = '0', upper = '0' } = value;
  return isUnsigned(lower) && isUnsigned(upper) ? { lower: String(BigInt(lower)), upper: String(BigInt(upper)) } : null;
}

function isUnsigned(value) {
  return /^\d+$/.test(String(value));
}

export function isSameUuid(one, other) {
  return one !== null && other !== null && one.lower === other.lower && one.upper === other.upper;
}

export function isObject(value) {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/** Durations are kept in whole microseconds, so that sums of them meet a deadline exactly. */
export function microseconds(seconds) {
  return Math.round(seconds * 1e6);
}
