// A mission as the server keeps it: what a submission must look like, and when its time is up.

import { Refusal } from '../jsonrpc.mjs';
import { broken } from './server_breaks.mjs';
import { isObject, microseconds, newUuid } from './wire.mjs';


/**
 * A queued mission, from a submission and the missions before it. A null field counts as left out. The documented
 * default of `robot` names nobody, so a mission without one could never run and is refused (AI-19). An upstream must
 * have been submitted already, which rules cycles out (AI-21).
 */
export function missionFrom(submission, earlier) {
  if (!isObject(submission)) throw invalid('a mission is an object');
  const { robot, channel, status_channel, config, start_timeout, timeout, upstream } = submission;
  return {
    handle: earlier.length + 1,
    uuid: newUuid(),
    robot: filledText('robot', robot),
    channel: filledText('channel', channel ?? 'mission'),
    statusChannel: filledText('status_channel', status_channel ?? 'mission_status'),
    config: configFrom(config ?? {}),
    startTimeout: duration('start_timeout', broken('start-timeout-fixed') ? 5 : start_timeout ?? 5),
    timeout: duration('timeout', timeout ?? Infinity),
    upstream: upstreamFrom(upstream ?? [], earlier),
    status: 'QUEUED',
    connection: null,
    clockStarted: null,
    isForgotten: false,
  };
}

function filledText(field, value) {
  if (typeof value !== 'string' || value === '') throw invalid(`${field} must be a text that is not empty`);
  return value;
}

function configFrom(value) {
  if (!isObject(value)) throw invalid('config must be a JSON object');
  return value;
}

/** Zero is a timeout that elapses at once; a negative one makes no sense (AI-24). */
function duration(field, value) {
  if (typeof value !== 'number' || !(value >= 0)) throw invalid(`${field} must be a number of seconds, not below 0`);
  return microseconds(value);
}

function upstreamFrom(handles, earlier) {
  if (!Array.isArray(handles)) throw invalid('upstream must be a list of missions');
  return handles.map((handle) => upstreamMission(handle, earlier)).filter((mission) => mission !== null);
}

function upstreamMission(handle, earlier) {
  if (broken('negative-upstream-accepted') && handle < 0) return earlier.at(handle) ?? null;
  if (!Number.isInteger(handle) || handle < 0) throw invalid('upstream must list whole numbers, not below 0');
  if (broken('own-upstream-dropped') && handle === earlier.length + 1) return null;
  const mission = earlier[handle - 1];
  if (!mission && broken('unknown-upstream-dropped')) return null;
  if (!mission) throw invalid(`upstream ${handle} has not been submitted`);
  return broken('failed-upstream-dropped') && hasFailed(mission) ? null : mission;
}

export function isUnderWay({ status }) {
  return status === 'STARTED' || status === 'RUNNING';
}

function hasFailed({ status }) {
  return status.startsWith('FAILED');
}

/** Every upstream has completed successfully; completing alone is not enough (AI-01). */
export function isReady({ robot, upstream }) {
  if (broken('any-upstream-suffices') && upstream.length > 0) return upstream.some(isCompleted);
  if (broken('first-upstream-suffices')) return upstream.slice(0, 1).every(isCompleted);
  if (broken('other-robots-upstream-unseen') && upstream.some((mission) => mission.robot !== robot)) return false;
  return upstream.every(isCompleted);
}

/** An upstream has failed, was aborted or was cancelled (AI-03). */
export function isDoomed({ upstream }) {
  if (broken('cancel-missing')) return false;
  return upstream.some((mission) => hasFailed(mission) && !isCompleted(mission));
}

function isCompleted({ status }) {
  return (
    status === 'SUCCESS' ||
    (broken('downstream-early') && status === 'RUNNING') ||
    (broken('failed-upstream-counts') && status === 'FAILED') ||
    (broken('timed-out-upstream-counts') && status === 'FAILED_TIMEDOUT') ||
    (broken('cancelled-upstream-counts') && status === 'FAILED_UPSTREAM')
  );
}

/**
 * When the mission is aborted, if nothing else happens. Until the robot acknowledges it, the start timeout counts
 * from when it was sent (AI-05); from then on the run timeout counts (AI-06). The clock is set at both moments.
 */
export function deadline({ status, clockStarted, startTimeout, timeout }) {
  if (status === 'STARTED') return clockStarted + startTimeUsed(startTimeout);
  if (status === 'RUNNING') return clockStarted + runTimeUsed(startTimeout, timeout);
  return Infinity;
}

function startTimeUsed(startTimeout) {
  if (broken('start-timeout-never')) return Infinity;
  return broken('start-timeout-halved') ? Math.floor(startTimeout / 2) : startTimeout;
}

function runTimeUsed(startTimeout, timeout) {
  if (broken('timeout-never')) return Infinity;
  if (broken('start-timeout-despite-acknowledgement')) return startTimeout;
  return broken('timeout-halved') ? Math.floor(timeout / 2) : timeout;
}

function invalid(message) {
  return new Refusal('INVALID_ARGUMENT', message);
}
