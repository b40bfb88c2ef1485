// The ways in which this subject can be told to deviate. Each violates its page under every reading that is
// tolerated; where two readings could have explained a deviation, it was made blunter until neither does.

import { breaksFrom } from '../breaks.mjs';

const GET = 'GetRobotStatus';
const EVERY = 'every subscription';

const CATALOGUE = {
  // GetRobotStatus
  'get-foreign-served': `${GET} › Errors: a robot of another account is served instead of PERMISSION_DENIED`,
  'get-foreign-invalid-argument': `${GET} › Errors: a foreign or unknown id is answered INVALID_ARGUMENT`,
  'get-unknown-served': `${GET} › Errors: an id that no robot has is answered with an empty state`,
  'get-empty-id-served': `${GET} › Errors: an empty robot_id is answered with the first robot's state`,
  'get-stale': `${GET}: answers the state in which the robot started, not the latest`,
  'get-wrong-robot': `${GET} › Response: answers the state of another robot of the account`,
  'get-always-connected': `${GET} › RobotConnection: an offline robot is said to be connected`,
  'get-omits-emergency-stop': `${GET} › Response: the reported emergency stop is left out`,

  'reports-merged': `${GET} › Response: what a report leaves out stays what it was before`,

  // Selectors
  'null-selector-served': `${EVERY} › Errors: a request without a selector gets every owned robot`,
  'empty-ids-accepted': `${EVERY} › Errors: an empty list of robot_ids opens a silent stream`,
  'empty-element-skipped': `${EVERY} › Errors: an empty id among the robot_ids is skipped and the rest served`,
  'empty-location-not-found': `${EVERY} › Errors: an empty location_id is NOT_FOUND, not INVALID_ARGUMENT`,
  'both-arms-united': `${EVERY} › Request: robot_ids and location_id together select the union`,
  'foreign-id-served': `${EVERY} › Errors: a foreign robot among the robot_ids is served`,
  'foreign-id-invalid-argument': `${EVERY} › Errors: a foreign or unknown id is answered INVALID_ARGUMENT`,
  'unknown-id-accepted': `${EVERY} › Errors: an id that no robot has is dropped in silence`,
  'foreign-location-served': `${EVERY} › Errors: a location of another account is served`,
  'foreign-location-invalid-argument': `${EVERY} › Errors: a foreign location is answered INVALID_ARGUMENT`,
  'unknown-location-accepted': `${EVERY} › Errors: a location that does not exist opens a silent stream`,
  'location-leaks-foreign-robot': `${EVERY} › Errors: a location stream carries a foreign robot that is there`,
  'location-leaks-other-location': `${EVERY} › Request: a location stream carries robots of other locations`,

  // The first message
  'battery-first-message-missing': 'SubscribeBatteryStatus: the latest state is not sent upon subscription',
  'errors-first-message-missing': 'SubscribeErrorCodes: the latest codes are not sent upon subscription',
  'navigation-first-message-missing': 'SubscribeNavigationStatus: the latest state is not sent upon subscription',
  'network-first-message-missing': 'SubscribeNetworkStatus: the latest states are not sent upon subscription',
  'online-first-message-missing': 'SubscribeOnlineStatus: the latest states are not sent upon subscription',
  'robot-first-message-missing': 'SubscribeRobotStatus: the latest state is not sent upon subscription',
  'first-message-stale': `${EVERY}: the first message tells what the robot reported when it started`,
  'first-message-lacks-robot': `${EVERY}: the last of several selected robots is missing at first`,
  'online-first-message-hides-offline': 'SubscribeOnlineStatus: offline robots are left out of the first message',

  // Updates
  'battery-update-missing': 'SubscribeBatteryStatus: changes are not streamed',
  'errors-update-missing': 'SubscribeErrorCodes: changes are not streamed',
  'navigation-update-missing': 'SubscribeNavigationStatus: changes are not streamed',
  'network-update-missing': 'SubscribeNetworkStatus: changes are not streamed',
  'online-update-missing': 'SubscribeOnlineStatus: changes are not streamed',
  'robot-update-missing': 'SubscribeRobotStatus: changes are not streamed',
  'robot-update-misses-mission': 'SubscribeRobotStatus: a change of the mission alone is not streamed',
  'robot-update-misses-emergency-stop': 'SubscribeRobotStatus: a change of the emergency stop alone is not streamed',
  'robot-update-keeps-old-battery': 'SubscribeRobotStatus: the battery stays what it was when the robot started',
  'cleared-codes-missing': 'SubscribeErrorCodes: that no error is left is never streamed',
  'navigation-recovery-missing': 'SubscribeNavigationStatus: that a robot is no longer stuck is never streamed',
  'network-loss-missing': 'SubscribeNetworkStatus: that a robot has lost its Wi-Fi is never streamed',
  'online-disconnect-missing': 'SubscribeOnlineStatus: that a robot has disconnected is never streamed',
  'update-one-behind': `${EVERY}: each update carries the state before the change`,
  'every-second-update-lost': `${EVERY}: every other change is not streamed, even if it is the last`,
  'location-update-lost': `${EVERY} › RobotSelector: of a location's robots only the first is followed`,
  'unselected-robot-leaks': `${EVERY} › RobotSelector: changes of owned robots that were not selected are streamed`,
  'wrong-robot-id': `${EVERY} › robot_id: everything is filed under the first selected robot`,
  'second-subscription-silences-first': `${EVERY}: a new stream of the same kind takes the updates of the old one`,
  'stream-closes-cleanly': `${EVERY} › Errors: the stream ends without an error after its first update`,

  // Sequence numbers
  'sequence-constant': 'EventMetadata › sequence_number: is 7 in every event',
  'sequence-decreasing': 'EventMetadata › sequence_number: counts down',
  'sequence-negative': 'EventMetadata › sequence_number: starts at -5',
  'sequence-steps-back': 'EventMetadata › sequence_number: every third event is numbered below the one before',
  'sequence-pairs': 'EventMetadata › sequence_number: two successive events share a number',
  'sequence-wraps-to-one': 'EventMetadata › sequence_number: wraps around to 1, not to 0',
  'sequence-negative-after-restart': 'EventMetadata › sequence_number: the first one after a restart is -1',

  // Values: battery
  'battery-in-bytes': 'BatteryState › charge_percent: runs from 0 to 255',
  'battery-rounded': 'BatteryState › charge_percent: is rounded down to tens',
  'battery-charging-without-method': 'ChargeMethod: NONE is sent while the battery is charging',
  'battery-full-as-charging': '(BatteryState) State enum: a full battery is said to be charging',
  'battery-short-enum': '(BatteryState) State enum: names go without their STATE_ prefix',

  // Values: error codes
  'severity-raised': 'Severity enum: LOW is sent as MEDIUM',
  'severity-invented': 'Severity enum: HIGH is sent as SEVERITY_CRITICAL, which the enum lacks',
  'error-code-shifted': 'ErrorCode › code: is one too high',
  'error-message-blank': 'ErrorCode › message: is sent empty',
  'codes-first-only': 'ErrorCodes › codes: only the first active code is sent',
  'codes-accumulate': 'SubscribeErrorCodes: codes that are no longer active stay in the list',
  'codes-delta': 'SubscribeErrorCodes: an update lists only the codes that are new',

  // Values: Wi-Fi
  'link-quality-in-percent': 'Wifi › link_quality: runs from 0 to 100',
  'wifi-security-downgraded': '(Wifi) Security enum: a secured network is said to be unsecured',
  'wifi-invented': 'NetworkStateWithMetadata › connected_wifi: is set though the robot has no Wi-Fi',
  'wifi-omitted': 'NetworkStateWithMetadata › connected_wifi: is unset though the robot has Wi-Fi',

  // Values: navigation
  'reason-while-not-stuck': 'StuckState › reason: PATH_BLOCKED is sent with NOT_STUCK',
  'stuck-state-unknown': '(StuckState) State enum: UNKNOWN is sent for NOT_STUCK',
  'stuck-reason-swapped': '(StuckState) Reason enum: INSIDE_RESTRICTED_AREA is sent as PATH_BLOCKED',
  'stuck-always': 'StuckState › state: STUCK is sent for a robot that is not',

  // Values: connection and the rest of the robot's state
  'online-always-connected': '(RobotConnection) State enum: SubscribeOnlineStatus says CONNECTED of offline robots',
  'connection-unknown': '(RobotConnection) State enum: DISCONNECTED is sent as UNKNOWN',
  'emergency-fields-swapped': 'EmergencyStopState: software stop and button are swapped',
  'mission-running-as-succeeded': 'RobotState › mission: a running mission is said to have succeeded',
  'twist-invented': 'Twist: is sent, at 0.25 m/s, though the robot reports no velocity',
  'twist-sign-flipped': 'Twist › angular_velocity: positive is counter-clockwise',
  'both-typed-states': 'typed_status oneof: servi_state and carti_state are both set',
  'typed-state-swapped': "typed_status oneof: a Servi's state is sent as carti_state, and the reverse",
};

export const broken = breaksFrom(CATALOGUE);
