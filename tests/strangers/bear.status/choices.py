"""The readings that differ from the base where the page is silent, ambiguous or at odds with itself."""

from __future__ import annotations

from variants import Variant as V

_ERRORS = "RobotStatus › SubscribeBatteryStatus › Errors (the same on every subscription)"
_SELECTOR = "RobotStatus › SubscribeBatteryStatus › Request (the same on every subscription)"
_NUMBERS = "RobotStatus › SubscribeBatteryStatus › Response › EventMetadata"
_EXAMPLES = "RobotStatus › JSON Response Examples"
_STATUS = "RobotStatus › SubscribeRobotStatus"
_GET = "RobotStatus › GetRobotStatus"

CHOICES: tuple[V, ...] = (
    V("unknown-location-not-found", "A location that does not exist is NOT_FOUND, not PERMISSION_DENIED.", _ERRORS),
    V("empty-foreign-location-not-found", "A foreign location without robots is NOT_FOUND.", _ERRORS),
    V("foreign-robot-at-location-denied", "A foreign robot at an own location makes the location denied.", _ERRORS),
    V("only-foreign-robots-denied", "An own location that holds only foreign robots is denied.", _ERRORS),
    V("foreign-robot-at-location-served", "An own location shows every robot there, foreign ones as well.", _SELECTOR),
    V("both-prefer-ids", "A selector with both ways of selecting goes by its ids.", _SELECTOR),
    V("both-prefer-location", "A selector with both ways of selecting goes by its location.", _SELECTOR),
    V("blank-location-beside-ids", "An empty location_id beside a list of ids counts as not set.", _SELECTOR),
    V("blank-id-denied", "An empty id within a list is a robot that is not owned.", _ERRORS),
    V("ownership-before-blanks", "Ownership of the other ids is checked before an empty id is complained of.", _ERRORS),
    V("blank-trimmed", "An id of blanks alone counts as empty.", _ERRORS),
    V("duplicate-ids-refused", "A list that names a robot twice is invalid.", _ERRORS),
    V("unknown-fields-refused", "A field that the request does not have makes it invalid.", _ERRORS),
    V("membership-frozen", "A location's stream keeps the robots that were there when it began.", _SELECTOR),
    V("membership-grows", "A location's stream takes in newcomers and keeps those that leave.", _SELECTOR),
    V("newcomer-waits", "A robot that comes to a location is first shown when its state changes.", _SELECTOR),
    V("emptied-location-ends", "A location's stream ends cleanly when its last robot has left.", _SELECTOR),
    V(
        "maps-one-robot-each",
        "Each map holds one robot, in the first messages as well.",
        "RobotStatus › SubscribeErrorCodes › Response › error_codes",
    ),
    V(
        "maps-whole",
        "Each map of an update holds all selected robots, the unchanged ones with their old metadata.",
        "RobotStatus › SubscribeErrorCodes › Response › error_codes",
    ),
    V(
        "unknown-snapshot-skipped",
        "A robot whose value was never reported is left out of the first messages.",
        "RobotStatus › SubscribeNavigationStatus (the latest known state)",
    ),
    V(
        "unset-not-streamed",
        "A value that becomes unset is no state to tell on the stream of its topic.",
        "RobotStatus › SubscribeErrorCodes (when updates are streamed)",
    ),
    V(
        "unknown-written-out",
        "A part of enums that was not reported is shown with its UNKNOWN names.",
        "RobotStatus › GetRobotStatus › Response › (RobotConnection) State enum",
    ),
    V("hybrid-repeats", "SubscribeRobotStatus repeats the state from time to time without a change.", _STATUS),
    V("hybrid-tells-every-report", "SubscribeRobotStatus tells every report, equal ones as well.", _STATUS),
    V("snapshot-numbered-anew", "A first message is an event of its own, with a new number and time.", _NUMBERS),
    V("counter-per-topic", "A robot counts the events of each topic apart.", _NUMBERS),
    V("counter-gaps", "Numbers go up by ten.", _NUMBERS),
    V("counter-from-zero", "The first number of a robot is 0.", _NUMBERS),
    V("counter-high", "The first number is larger than 2^53.", _NUMBERS),
    V("equal-report-renews", "A report of the same value is an event that only a later first message shows.", _NUMBERS),
    V("restart-shows-zero", "A robot that restarted shows its values once more, with number 0.", _NUMBERS),
    V("coarse-clock", "The clock has steps of a minute, so events share a time.", _NUMBERS),
    V("clocks-differ", "The clocks of the robots are years apart.", _NUMBERS),
    V("wall-clock", "Times are the time of day, to the millisecond.", _NUMBERS),
    V("numbers-as-numbers", "Sequence numbers are written as JSON numbers.", _EXAMPLES),
    V("enums-as-numbers", "Enums are written as their numbers.", _EXAMPLES),
    V("snake-names", "Fields are written with underscores, as the tables name them.", _EXAMPLES),
    V("defaults-omitted", "Fields with their default value are left out.", _EXAMPLES),
    V("defaults-written", "Fields of a message that is set are all written, also with default values.", _EXAMPLES),
    V("timestamps-as-objects", "Timestamps are objects of seconds and nanos.", _EXAMPLES),
    V("floats-rounded", "Floats have been through 32 bits.", "RobotStatus › GetRobotStatus › Response › Twist"),
    V(
        "codes-sorted",
        "Error codes are listed by their code.",
        "RobotStatus › SubscribeErrorCodes › Response › ErrorCodesWithMetadata",
    ),
    V("offline-internal", "GetRobotStatus of a disconnected robot is INTERNAL.", f"{_GET} › Errors"),
    V(
        "offline-twist-omitted",
        "A disconnected robot reports no velocity, so its twist is left out.",
        f"{_GET} › Response › Twist",
    ),
    V(
        "online-unknown-silent",
        "A connection that becomes unknown is neither a connect nor a disconnect, and is not told.",
        "RobotStatus › SubscribeOnlineStatus",
    ),
    V(
        "reserved-reason-unknown",
        "A reason that is reserved for the future is shown as REASON_UNKNOWN.",
        f"{_GET} › Response › (StuckState) Reason enum",
    ),
    V("late-delivery", "Messages wait until nothing else is asked.", "RobotStatus › SubscribeBatteryStatus"),
    V("newest-stream-first", "An update goes to the newest stream first.", "RobotStatus › SubscribeBatteryStatus"),
    V(
        "snapshots-by-name",
        "First messages come in the order of the robots' names.",
        "RobotStatus › SubscribeNavigationStatus",
    ),
)
