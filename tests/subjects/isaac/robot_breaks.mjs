// The ways in which the mission client can be told to deviate.

import { breaksFrom } from '../breaks.mjs';
import { WIRE_BREAKS } from './wire_breaks.mjs';

const STEP = (number) => `Mission Codelet, step ${number}`;
const PREEMPTION = 'Mission Codelet › preemption';

const CATALOGUE = {
  ...WIRE_BREAKS,

  // A mission and its statuses
  'running-missing': `${STEP(3)}: RUNNING is never sent`,
  'running-without-mission': `${STEP(3)}: RUNNING is sent before there was any mission`,
  'running-after-final': `${STEP(4)}: RUNNING goes on after the final status`,
  'running-for-first-mission': `${STEP(3)}: RUNNING is always about the first mission`,
  'success-missing': `${STEP(4)}: no final status follows a reportSuccess`,
  'failure-missing': `${STEP(4)}: no final status follows a reportFailure`,
  'final-twice': `${STEP(4)}: the final status is sent twice`,
  'failure-as-success': `${STEP(4)}: a reportFailure is reported as SUCCESS`,
  'success-as-failure': `${STEP(4)}: a reportSuccess is reported as FAILURE`,
  'success-spontaneous': `${STEP(4)}: SUCCESS is sent after some time though the behavior tree still runs`,
  'status-invented': `${STEP(4)}: a success is reported as "done", which is no status`,
  'deaf-after-success': `${STEP(5)}: after a success no new mission is heard`,
  'deaf-after-failure': `${STEP(5)}: after a failure no new mission is heard`,
  'empty-config-refused': `${STEP(1)}: a mission whose config is {} fails at once`,
  'bad-config-succeeds': `${STEP(4)}: a config that is not JSON is answered SUCCESS though no behavior tree ran`,

  // Preemption
  'preempted-silently': `${PREEMPTION}: the mission that is preempted gets no final status`,
  'preempted-as-success': `${PREEMPTION}: the mission that is preempted gets SUCCESS`,
  'preempted-too-late': `${PREEMPTION}: the new mission is RUNNING before the old one has its FAILURE`,
  'preempted-under-new-uuid': `${PREEMPTION}: the FAILURE is about the new mission`,
  'preempted-goes-on': `${PREEMPTION}: after its FAILURE the old mission is still reported as RUNNING`,
  'preempted-ends-twice': `${PREEMPTION}: the old mission gets another final status when the new one ends`,
  'preemption-ignored': `${PREEMPTION}: a mission that arrives during another is dropped`,
  'preempting-mission-dropped': `${PREEMPTION}: the old mission is stopped but the new one is not run`,

  // Where a status goes and what it is about
  'status-on-mission-channel': 'Sample Usage › status_channel: statuses are sent on the channel of missions',
  'uuid-halves-swapped': 'JsonTcpClient Codelet: lower and upper half of the mission\'s UUID are swapped',
  'uuid-of-header': 'JsonTcpClient Codelet: a status is about the UUID of the message, not of the mission',
  'uuid-rounded': 'JsonTcpClient Codelet: the halves of the UUID pass through a double',
};

export const broken = breaksFrom(CATALOGUE);
