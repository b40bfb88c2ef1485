// The ways in which the mission server can be told to deviate.

import { breaksFrom } from '../breaks.mjs';
import { WIRE_BREAKS } from './wire_breaks.mjs';

const CATALOGUE = {
  ...WIRE_BREAKS,

  // Submission
  'negative-upstream-accepted': 'Sample Usage › upstream: -1 is taken as the mission submitted last',
  'unknown-upstream-dropped': 'Mission Dependencies: an upstream that does not exist is no obstacle to running',
  'own-upstream-dropped': 'Mission Dependencies (a DAG): a mission that names itself as upstream is run',
  'failed-upstream-dropped': 'Mission Dependencies: an upstream that had failed before the submission is no obstacle',

  // Dependencies
  'downstream-early': 'Mission Dependencies: a mission is sent while its upstream is still running',
  'any-upstream-suffices': 'Mission Dependencies: one completed upstream of several is enough to be sent',
  'first-upstream-suffices': 'Mission Dependencies: only the upstream that is named first is waited for',
  'failed-upstream-counts': 'Mission Dependencies: a mission is sent though its upstream failed',
  'timed-out-upstream-counts': 'Mission Dependencies: a mission is sent though its upstream was aborted',
  'cancelled-upstream-counts': 'Mission Dependencies: a mission is sent though its upstream was cancelled',
  'cancel-missing': 'Mission Dependencies: a mission whose upstream failed stays queued for ever',
  'cancelled-as-success': 'Mission Dependencies: a cancelled mission is reported as SUCCESS',
  'other-robots-upstream-unseen': 'Mission Dependencies: the success of an upstream on another robot goes unnoticed',

  // Identification
  'unnamed-served': 'Robot Identification: a mission is sent on a connection that has not named its robot',
  'any-channel-names': 'Robot Identification: a text on any channel is taken as the name',
  'name-beginning-suffices': 'Robot Identification: carter-0 gets the missions of carter-01',
  'name-case-ignored': 'Robot Identification: Carter-01 gets the missions of carter-01',
  'wrong-robot': 'Robot Identification: missions go to the newest connection that has a name, whosever it is',
  'namesakes-both-served': 'Robot Identification: of two connections with one name both get the mission',
  'name-resends': 'Robot Identification: when a robot repeats its name, its current mission is sent again',
  'finished-resent': 'Robot Identification: when a robot comes back, its last successful mission is sent again',
  'queue-lost-on-disconnect': 'Robot Identification: what was queued when its robot disconnected is never sent',
  'late-submission-unsent': 'MissionServer Class: a mission submitted while its robot is connected is never sent',

  // Sending
  'sent-twice': 'MissionServer Class: each mission is sent twice',
  'two-at-once': "Mission Codelet › preemption: a mission is sent while the robot's last one is under way",
  'sent-on-status-channel': 'Sample Usage › channel: the mission is sent on its status channel',
  'channel-ignored': 'Sample Usage › channel: every mission is sent on "mission"',
  'config-empty': 'Sample Usage › config: {} is sent in its place',
  'config-of-first': 'Sample Usage › config: every mission carries the first one\'s',
  'config-numbers-as-text': 'Sample Usage › config: numbers arrive as strings',
  'failure-stops-queue': 'Mission Dependencies: after a failure, missions that do not depend on it stay queued',

  // Statuses
  'status-channel-ignored': 'Sample Usage › status_channel: statuses are heard on "mission_status" alone',
  'uuid-ignored': 'Mission Codelet: a status about an earlier mission is credited to the current one',
  'any-robot-reports': 'Robot Identification: a status of one robot is credited to the mission of another',
  'running-unreported': 'Sample Usage › Mission.Status: a mission is RUNNING as soon as it is sent',
  'status-falls-back': 'Sample Usage › Mission.Status: a second RUNNING takes the mission back to STARTED',
  'success-ignored': 'Mission Codelet: a SUCCESS goes unnoticed',
  'success-as-failed': 'Mission Codelet: a SUCCESS counts as failure',
  'failure-as-success': 'Mission Codelet: a FAILURE counts as success',
  'failure-overwritten': 'Mission Codelet (one final status): a later SUCCESS replaces a FAILURE',
  'terminal-overwritten': 'Mission Codelet (one final status): a later final status replaces the first',
  'terminal-revived': 'Mission Codelet (one final status): RUNNING revives a mission that had ended',
  'bad-line-deafens': 'JsonTcpServer Class: after one line that is not JSON no client is heard any more',

  // Timeouts
  'start-timeout-never': 'Sample Usage › start_timeout: a mission that is never acknowledged is not aborted',
  'start-timeout-halved': 'Sample Usage › start_timeout: strikes after half of its time',
  'start-timeout-fixed': 'Sample Usage › start_timeout: is 5 seconds for every mission',
  'start-timeout-despite-acknowledgement': 'Sample Usage › start_timeout: aborts a mission that was acknowledged',
  'timeout-never': 'Sample Usage › timeout: a mission that does not complete is not aborted',
  'timeout-restarts': 'Sample Usage › timeout: every RUNNING gives the mission its whole time again',
  'timeout-halved': 'Sample Usage › timeout: strikes after half of its time',
  'aborted-resent': 'Sample Usage › start_timeout: a mission that was aborted is sent once more',
  'abort-as-success': 'Sample Usage › timeout: an aborted mission is reported as SUCCESS',
};

export const broken = breaksFrom(CATALOGUE);
