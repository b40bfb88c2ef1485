// Which robots a request is about, and why it is refused. Whether a request is well formed is decided before
// whose robots it names, since the former needs no look at the fleet.

import { Refusal } from '../jsonrpc.mjs';
import { broken } from './breaks.mjs';

/** The robot of a GetRobotStatus request. */
export function robotToGet(request, fleet) {
  const { robotId } = request;
  if (broken('get-empty-id-served') && robotId === '') return fleet.owned[0];
  if (!isFilledText(robotId)) throw invalid('robot_id is empty');
  const robot = fleet.robot(robotId);
  if (robot?.owned || (robot && broken('get-foreign-served'))) return robot;
  if (!robot && broken('get-unknown-served')) return { state: {} };
  if (broken('get-foreign-invalid-argument')) throw invalid(`robot_id is ${robotId}`);
  throw notYours(`robot ${robotId}`);
}

/**
 * The robots of a subscription, each once. On the wire the selector's two arms are a oneof, so JSON that sets both
 * is malformed (AS-04).
 */
export function selectRobots(request, fleet) {
  const { selector } = request;
  if (broken('null-selector-served') && !isSet(selector)) return fleet.owned;
  if (!isObject(selector)) throw invalid('selector is missing');
  const byIds = isSet(selector.robotIds);
  const byLocation = isSet(selector.locationId);
  if (broken('both-arms-united') && byIds && byLocation) return unitedArms(selector, fleet);
  if (byIds === byLocation) throw invalid('selector needs exactly one of robot_ids and location_id');
  return byIds ? robotsByIds(selector.robotIds, fleet) : robotsByLocation(selector.locationId, fleet);
}

/** Whether the selection was made by location; only breaks want to know later. */
export function isByLocation(request) {
  return isSet(request.selector?.locationId);
}

function unitedArms({ robotIds, locationId }, fleet) {
  return unique([...robotsByIds(robotIds, fleet), ...robotsByLocation(locationId, fleet)]);
}

function robotsByIds(robotIds, fleet) {
  return unique(wellFormedIds(robotIds).flatMap((id) => robotsById(id, fleet)));
}

function wellFormedIds(robotIds) {
  const ids = robotIds.ids ?? [];
  if (!Array.isArray(ids)) throw invalid('robot_ids is not a list');
  if (broken('empty-element-skipped')) return ids.filter(isFilledText);
  if (ids.length === 0 && !broken('empty-ids-accepted')) throw invalid('robot_ids is empty');
  if (!ids.every(isFilledText)) throw invalid('robot_ids contains an empty id');
  return ids;
}

/** An unknown id is refused like a foreign one, so that nobody learns which ids exist (AS-02). */
function robotsById(id, fleet) {
  const robot = fleet.robot(id);
  if (robot?.owned || (robot && broken('foreign-id-served'))) return [robot];
  if (!robot && broken('unknown-id-accepted')) return [];
  if (broken('foreign-id-invalid-argument')) throw invalid(`robot_ids names ${id}`);
  throw notYours(`robot ${id}`);
}

function robotsByLocation(locationId, fleet) {
  if (broken('empty-location-not-found') && locationId === '') throw nothingAt(locationId);
  if (!isFilledText(locationId)) throw invalid('location_id is empty');
  const location = fleet.location(locationId);
  if (!location && broken('unknown-location-accepted')) return [];
  if (!location) throw nothingAt(locationId);
  return location.owned ? robotsAtOwn(locationId, fleet) : robotsAtForeign(locationId, fleet);
}

/** Robots of other accounts that stand at an owned location are not the caller's to see, nor a reason to refuse. */
function robotsAtOwn(locationId, fleet) {
  if (broken('location-leaks-foreign-robot')) return fleet.robots.filter((robot) => robot.isAt(locationId));
  if (broken('location-leaks-other-location')) return fleet.owned;
  const robots = fleet.owned.filter((robot) => robot.isAt(locationId));
  if (robots.length === 0) throw nothingAt(locationId);
  return robots;
}

function robotsAtForeign(locationId, fleet) {
  if (broken('foreign-location-served')) return fleet.robots.filter((robot) => robot.isAt(locationId));
  if (broken('foreign-location-invalid-argument')) throw invalid(`location_id is ${locationId}`);
  throw notYours(`location ${locationId}`);
}

/** In protobuf JSON null is the same as leaving a field out. */
function isSet(value) {
  return value !== undefined && value !== null;
}

function isObject(value) {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

function isFilledText(value) {
  return typeof value === 'string' && value !== '';
}

function unique(robots) {
  return [...new Set(robots)];
}

function invalid(message) {
  return new Refusal('INVALID_ARGUMENT', message);
}

function notYours(what) {
  return new Refusal('PERMISSION_DENIED', `${what} is not one of yours`);
}

function nothingAt(locationId) {
  return new Refusal('NOT_FOUND', `there is no robot at location "${locationId}"`);
}
