"""The faults: each contradicts a definite statement of the page."""

from __future__ import annotations

from variants import Variant as V

_GET = "RobotStatus › GetRobotStatus"
_GET_ERRORS = f"{_GET} › Errors"
_BATTERY = "RobotStatus › SubscribeBatteryStatus"
_CODES = "RobotStatus › SubscribeErrorCodes"
_NAVIGATION = "RobotStatus › SubscribeNavigationStatus"
_NETWORK = "RobotStatus › SubscribeNetworkStatus"
_ONLINE = "RobotStatus › SubscribeOnlineStatus"
_STATUS = "RobotStatus › SubscribeRobotStatus"
_NUMBERS = f"{_BATTERY} › Response › EventMetadata"

ACCESS_BUGS: tuple[V, ...] = (
    V("get-empty-id-denied", "An empty robot_id is PERMISSION_DENIED, not INVALID_ARGUMENT.", _GET_ERRORS),
    V("get-missing-id-first", "Without robot_id the first own robot is shown.", f"{_GET} › Request"),
    V("get-foreign-served", "A foreign robot's state is shown.", _GET_ERRORS),
    V("get-foreign-not-found", "A foreign robot is NOT_FOUND.", _GET_ERRORS),
    V("get-unknown-not-found", "An id that no robot has is NOT_FOUND, which this call does not have.", _GET_ERRORS),
    V("get-offline-denied", "An own robot that is disconnected is denied.", _GET_ERRORS),
    V("get-fault-as-precondition", "A failed communication is FAILED_PRECONDITION.", _GET_ERRORS),
    V("get-fault-as-empty", "A failed communication gives an empty state.", _GET_ERRORS),
    V("get-fault-ignored", "A failed communication is passed over, as if the robot had answered.", _GET_ERRORS),
    V("selector-missing-means-all", "Without a selector all own robots are selected.", f"{_BATTERY} › Errors"),
    V("ids-empty-means-all", "An empty list of ids selects all own robots.", f"{_BATTERY} › Errors"),
    V("ids-empty-silent", "SubscribeNetworkStatus takes an empty list and shows nothing.", f"{_NETWORK} › Errors"),
    V("two-ids-refused", "SubscribeBatteryStatus refuses a list of more than one robot.", f"{_BATTERY} › Request"),
    V("ids-first-only", "SubscribeErrorCodes follows only the first robot of a list.", f"{_CODES} › Request"),
    V("foreign-id-skipped", "Foreign robots in a list are passed over.", f"{_BATTERY} › Errors"),
    V("foreign-after-first-unchecked", "Only the first id of a list is checked for its owner.", f"{_BATTERY} › Errors"),
    V("status-foreign-id-served", "SubscribeRobotStatus shows foreign robots.", f"{_STATUS} › Errors"),
    V("unknown-id-silent", "Ids that no robot has are passed over, even if nothing is left.", f"{_BATTERY} › Errors"),
    V("online-foreign-not-found", "SubscribeOnlineStatus says NOT_FOUND of foreign ids.", f"{_ONLINE} › Errors"),
    V("location-blank-not-found", "An empty location_id is NOT_FOUND.", f"{_BATTERY} › Errors"),
    V("foreign-location-served", "A foreign location is not refused.", f"{_BATTERY} › Errors"),
    V(
        "foreign-location-not-found",
        "SubscribeBatteryStatus and SubscribeErrorCodes say NOT_FOUND of a foreign location.",
        f"{_CODES} › Errors",
    ),
    V("empty-location-accepted", "A location without robots gives a silent stream.", f"{_BATTERY} › Errors"),
    V("empty-location-denied", "An own location without robots is PERMISSION_DENIED.", f"{_BATTERY} › Errors"),
    V(
        "navigation-empty-location-accepted",
        "SubscribeNavigationStatus alone takes a location without robots.",
        f"{_NAVIGATION} › Errors",
    ),
    V("offline-location-not-found", "A location whose robots are all offline is NOT_FOUND.", f"{_BATTERY} › Errors"),
    V("location-ignored", "A location selects all own robots, wherever they are.", f"{_BATTERY} › Request"),
    V("location-index-stale", "A location selects the robots that were there at the start.", f"{_BATTERY} › Request"),
    V(
        "location-first-robot-only",
        "SubscribeOnlineStatus and SubscribeNetworkStatus follow one robot of a location.",
        f"{_ONLINE} › Request",
    ),
)

VALUE_BUGS: tuple[V, ...] = (
    V("get-cached", "GetRobotStatus keeps what it first answered for a robot.", _GET),
    V("get-cached-by-location", "GetRobotStatus mixes up the robots of one location.", f"{_GET} › Request"),
    V("restart-forgets-state", "After a restart the robot's last state is gone.", _GET),
    V("twist-of-zeros", "A velocity that is not reported is shown as zeros.", f"{_GET} › Response › Twist"),
    V("twist-kept", "A velocity that is no longer reported is still shown.", f"{_GET} › Response › Twist"),
    V("twist-sign-turned", "The rotation rate has the wrong sign.", f"{_GET} › Response › Twist"),
    V("reverse-as-forward", "SubscribeRobotStatus shows a reverse speed as positive.", f"{_GET} › Response › Twist"),
    V("pose-swapped", "SubscribeRobotStatus mixes up x and y of the pose.", f"{_STATUS} › Response › robot_state"),
    V(
        "estop-swapped",
        "The software stop and the button are mixed up.",
        f"{_GET} › Response › EmergencyStopState",
    ),
    V(
        "second-robot-shares-emergency",
        "The second robot shows the emergency stop of the first.",
        f"{_GET} › Response › EmergencyStopState",
    ),
    V("get-always-connected", "GetRobotStatus shows offline robots as connected.", f"{_GET} › Response"),
    V("both-types-set", "A Servi robot has a state of Carti as well.", f"{_GET} › Response › typed_status oneof"),
    V("carti-shown-as-servi", "A Carti robot has a state of Servi.", f"{_GET} › Response › typed_status oneof"),
    V("carti-missing", "A Carti robot has no state of its type.", f"{_GET} › Response › typed_status oneof"),
    V("navigation-missing", "GetRobotStatus leaves out the navigation state.", f"{_GET} › Response"),
    V("mission-missing", "GetRobotStatus leaves out the mission.", f"{_GET} › Response"),
    V("localization-missing", "SubscribeRobotStatus leaves out the localization.", f"{_STATUS} › Response"),
    V("charge-capped", "SubscribeBatteryStatus never says 100.", f"{_BATTERY} › Response › BatteryState"),
    V("charge-counted-down", "GetRobotStatus says how much charge is missing.", f"{_GET} › Response › BatteryState"),
    V("offline-battery-empty", "The battery of an offline robot is shown as empty.", _BATTERY),
    V("full-as-charging", "SubscribeBatteryStatus shows a full battery as charging.", f"{_BATTERY} › State enum"),
    V("contact-as-wired", "Charging by contact is shown as wired.", f"{_BATTERY} › ChargeMethod enum"),
    V(
        "no-charge-method-unset",
        "SubscribeBatteryStatus shows no active method as a field that was not returned.",
        f"{_BATTERY} › ChargeMethod enum",
    ),
    V("severity-from-code", "The severity is worked out from the code.", f"{_CODES} › Response › ErrorCode"),
    V("worst-code-only", "SubscribeErrorCodes lists the worst code alone.", f"{_CODES} › Response"),
    V("code-message-dropped", "SubscribeErrorCodes leaves out the messages.", f"{_CODES} › Response › ErrorCode"),
    V("codes-accumulate", "Codes that are no longer active stay listed.", f"{_GET} › Response › ErrorCodes"),
    V("link-quality-in-percent", "The link quality goes up to 100.", f"{_NETWORK} › Response › Wifi"),
    V("signal-without-sign", "The signal level has lost its sign.", f"{_NETWORK} › Response › Wifi"),
    V("signal-field-misnamed", "The signal level has another field name.", f"{_NETWORK} › Response › Wifi"),
    V("security-mixed-up", "Password and login networks are mixed up.", f"{_NETWORK} › Response › Security enum"),
    V("lost-wifi-kept", "A network that was lost is still shown.", f"{_NETWORK} › NetworkStateWithMetadata"),
    V("lost-wifi-as-empty", "No network is shown as a network of zeros.", f"{_NETWORK} › NetworkStateWithMetadata"),
    V("reason-without-stuck", "A robot that is not stuck has a reason.", f"{_GET} › Response › StuckState"),
    V("reason-lost", "SubscribeNavigationStatus never gives a reason.", f"{_GET} › Response › StuckState"),
    V("restricted-as-blocked", "A restricted area is shown as a blocked path.", f"{_GET} › (StuckState) Reason enum"),
    V("reserved-reason-used", "A blocked path is shown with a reserved reason.", f"{_GET} › (StuckState) Reason enum"),
    V(
        "not-stuck-as-unknown",
        "SubscribeNavigationStatus shows a robot that is not stuck as unknown.",
        f"{_GET} › (StuckState) State enum",
    ),
)

STREAM_BUGS: tuple[V, ...] = (
    V("no-battery-snapshot", "SubscribeBatteryStatus begins with the first change.", _BATTERY),
    V("no-network-snapshot", "SubscribeNetworkStatus begins with the first change.", _NETWORK),
    V("status-snapshot-waits", "SubscribeRobotStatus begins with the first change.", _STATUS),
    V("navigation-first-snapshot-only", "SubscribeNavigationStatus begins with the first robot alone.", _NAVIGATION),
    V("online-snapshot-connected-only", "SubscribeOnlineStatus begins without the disconnected robots.", _ONLINE),
    V("second-subscriber-without-snapshot", "A second stream of a topic has no first message.", _BATTERY),
    V("snapshot-to-everyone", "A new subscriber makes older streams repeat an event's number.", _NUMBERS),
    V("error-snapshot-from-start", "SubscribeErrorCodes begins with the codes of the start.", _CODES),
    V("status-snapshot-from-start", "SubscribeRobotStatus begins with the state of the start.", _STATUS),
    V("charge-method-silent", "A change of the charge method alone is not streamed.", _BATTERY),
    V("small-charge-steps-silent", "Charge steps of less than five are not streamed.", _BATTERY),
    V("battery-stops-after-three", "SubscribeBatteryStatus falls silent after three updates.", _BATTERY),
    V("cleared-codes-silent", "That the last error code is gone is not streamed.", _CODES),
    V("codes-counted", "Codes that give way to as many others are not streamed.", _CODES),
    V("error-map-blanks-others", "An update shows the other robots without their codes.", f"{_CODES} › Response"),
    V("reason-change-silent", "A change of the reason alone is not streamed.", _NAVIGATION),
    V(
        "navigation-update-to-everyone",
        "Updates go to streams that did not select the robot.",
        f"{_NAVIGATION} › Request",
    ),
    V("navigation-updates-without-id", "Updates do not say whose they are.", f"{_NAVIGATION} › Response › robot_id"),
    V("same-network-silent", "Changes within one network are not streamed.", _NETWORK),
    V("lost-wifi-silent", "The loss of the network is not streamed.", _NETWORK),
    V("network-update-one-behind", "An update shows the state before.", f"{_NETWORK} › Response"),
    V("reconnect-silent", "SubscribeOnlineStatus does not tell that a robot is back.", _ONLINE),
    V("second-robot-disconnect-silent", "That the second robot went offline is not streamed.", _ONLINE),
    V("online-updates-without-metadata", "Updates lack their metadata.", f"{_ONLINE} › RobotConnectionWithMetadata"),
    V("online-update-under-first-id", "Updates stand under the first selected robot.", f"{_ONLINE} › Response"),
    V("connection-not-in-status", "SubscribeRobotStatus does not stream a connect or disconnect.", _STATUS),
    V("localization-not-in-status", "SubscribeRobotStatus does not stream a change of localization.", _STATUS),
    V("emergency-button-silent", "SubscribeRobotStatus does not stream a change of the button alone.", _STATUS),
    V("standing-twist-silent", "SubscribeRobotStatus does not stream that the robot has stopped.", _STATUS),
    V("status-update-partial", "Updates hold the changed part alone.", f"{_STATUS} › Response › robot_state"),
    V("status-update-merged", "Updates show the other parts as at the start.", f"{_STATUS} › Response › robot_state"),
    V("location-id-as-robot-id", "With a location its id stands in robot_id.", f"{_STATUS} › Response › robot_id"),
    V("map-shares-metadata", "The robots of a map share the first one's metadata.", f"{_NETWORK} › Response"),
    V("update-doubled", "SubscribeBatteryStatus and SubscribeNetworkStatus send an event twice.", _NUMBERS),
    V("equal-report-resent", "A report of the same value sends the old event again.", _NUMBERS),
    V("updates-reversed", "Updates that come quickly arrive in the wrong order.", _NUMBERS),
    V("one-stream-per-topic", "Only the newest stream of a topic has updates.", _BATTERY),
    V("cancel-ends-topic", "The end of one stream silences all of its topic.", _BATTERY),
    V("later-ids-without-updates", "Updates come for the first robot of a list alone.", f"{_BATTERY} › Request"),
    V("moved-robot-lost", "A robot that was selected by id is lost when it moves.", f"{_BATTERY} › Request"),
    V("restart-cuts-updates", "A robot that restarted has no more updates.", _BATTERY),
    V(
        "reconnect-leaves-deaf",
        "A robot that was offline has updates of its connection and whole state alone.",
        _BATTERY,
    ),
    V("number-negative-after-restart", "Numbers begin below 0 after a restart.", _NUMBERS),
    V("restart-counter-stuck", "Numbers stand still after a restart.", _NUMBERS),
    V("number-repeats", "Every third event has the number of the one before.", _NUMBERS),
    V("second-robot-numbers-fall", "The numbers of the second robot go down.", _NUMBERS),
    V("snapshot-number-ahead", "First messages have a number that later ones do not reach.", _NUMBERS),
    V("counter-per-stream", "Numbers are counted by the stream and not by the robot.", _NUMBERS),
    V("timestamp-of-sending", "The time is that of sending and not that of the event.", _NUMBERS),
    V("battery-without-timestamp", "SubscribeBatteryStatus leaves out the time.", _NUMBERS),
)

BUGS: tuple[V, ...] = ACCESS_BUGS + VALUE_BUGS + STREAM_BUGS
