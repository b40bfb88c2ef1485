"""Where the Robot Status page can be read in more than one way, entry by entry; ``specs/bear-status.md`` argues each.

Letters are those of the readings' list. An entry with several independent questions has an ambiguity for each, with a
word after its number. Readings that the list calls violations are not offered. `WAIVED` has the entries, or the parts
of entries, from which no rule follows, with the reason.
"""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.kernel.readings import Ambiguity

AS_01 = Ambiguity(
    "AS-01",
    "Some of the selected robots, though not all, belong to somebody else: what is answered?",
    {
        "a": "PERMISSION_DENIED",
        "b": "the account's own robots are served, the others left out",
        "c": "the account's own robots are served until the stream ends with PERMISSION_DENIED",
    },
    default="a",
    flagged=frozenset("bc"),
)
AS_02 = Ambiguity(
    "AS-02",
    "Which code does a robot id get that no robot has?",
    {"a": "PERMISSION_DENIED, as somebody else's", "b": "NOT_FOUND"},
    default="a",
    flagged=frozenset("b"),
)
AS_03_UNKNOWN = Ambiguity(
    "AS-03.unknown",
    "Which code does a location get that does not exist?",
    {"a": "NOT_FOUND", "b": "PERMISSION_DENIED"},
    default="a",
)
AS_03_EMPTY = Ambiguity(
    "AS-03.empty",
    "What is answered for an own location without a robot of the account?",
    {"c": "NOT_FOUND", "d": "a stream on which nothing comes"},
    default="c",
)
AS_03_FOREIGN = Ambiguity(
    "AS-03.foreign",
    "Which code does somebody else's location get?",
    {"e": "PERMISSION_DENIED", "f": "NOT_FOUND"},
    default="e",
    flagged=frozenset("f"),
)
AS_04 = Ambiguity(
    "AS-04",
    "A selector has robot ids and a location: what is answered?",
    {"a": "INVALID_ARGUMENT", "b": "the location is followed, the later field of the two"},
    default="a",
    flagged=frozenset("b"),
)
AS_05 = Ambiguity(
    "AS-05",
    "A selector names a robot twice: what is answered?",
    {"a": "the robot is selected once", "c": "INVALID_ARGUMENT"},
    default="a",
)
AS_06_EMPTY = Ambiguity(
    "AS-06.empty",
    "An id among the robot ids is empty: which code?",
    {"a": "INVALID_ARGUMENT", "b": "PERMISSION_DENIED, as any id that is not the account's"},
    default="a",
)
AS_06_ORDER = Ambiguity(
    "AS-06.order",
    "A request is invalid, and it names robots or a location that may not be seen: which code?",
    {"a": "INVALID_ARGUMENT: the form is checked first", "b": "the other: whose robots they are is checked first"},
    default="a",
)
AS_06_FIELD = Ambiguity(
    "AS-06.field",
    "Is a request with a field that is not documented an invalid one?",
    {"a": "no, the field is ignored", "b": "yes, INVALID_ARGUMENT"},
    default="a",
)
AS_07 = Ambiguity(
    "AS-07",
    "What does GetRobotStatus answer for a robot that is offline?",
    {
        "a": "DISCONNECTED and the last known values",
        "b": "INTERNAL",
        "c": "DISCONNECTED and nothing else",
    },
    default="a",
)
AS_08 = Ambiguity(
    "AS-08.update",
    "Does an update of a map bring the robots that have not changed as well?",
    {"c": "yes, with the numbers that they had", "d": "no"},
    default="d",
)
AS_09_OFFLINE = Ambiguity(
    "AS-09.offline",
    "What does a new stream show first of a robot that is offline?",
    {
        "a": "the last known values",
        "b": "nothing, until the robot is back",
        "c": "UNKNOWN values",
        "d": "INTERNAL is answered",
    },
    default="a",
    flagged=frozenset("cd"),
)
AS_09_UNKNOWN = Ambiguity(
    "AS-09.unknown",
    "What does a new stream with a single topic show first of a robot of which nothing is known?",
    {"b": "nothing, until something is known", "c": "UNKNOWN values", "d": "INTERNAL is answered"},
    default="b",
    flagged=frozenset("d"),
)
AS_09_STATE = Ambiguity(
    "AS-09.state",
    "What does a new stream of SubscribeRobotStatus show first of a robot of which nothing is known?",
    {"b": "nothing, until something is known", "c": "a state without parts", "d": "INTERNAL is answered"},
    default="b",
    flagged=frozenset("d"),
)
AS_09_PART = Ambiguity(
    "AS-09.part",
    "How does the state of a robot show a part that is not reported?",
    {"a": "it is left out", "c": "with UNKNOWN values"},
    default="a",
)
AS_09_UNSET = Ambiguity(
    "AS-09.unset",
    "What does a stream with a single topic show once the robot does not report it any more?",
    {"a": "what was known last stays", "b": "nothing", "c": "UNKNOWN values"},
    default="a",
)
AS_12_HYBRID = Ambiguity(
    "AS-12.hybrid",
    "What is the mode of SubscribeRobotStatus?",
    {
        "a": "changes, and messages from time to time in which nothing has changed",
        "b": "changes, and pose and velocity from time to time",
        "c": "changes alone, as with the event mode",
    },
    default="c",
)
AS_12_EVENT = Ambiguity(
    "AS-12.event",
    "May a stream in event mode repeat what it showed last, under a new number?",
    {"a": "no", "b": "yes"},
    default="a",
    flagged=frozenset("b"),
)
AS_13_FIELDS = Ambiguity(
    "AS-13.fields",
    "Which changes of a battery or a stuck state are streamed?",
    {"a": "those of every field", "b": "those of its field `state` for sure"},
    default="a",
    flagged=frozenset("b"),
)
AS_13_SKIP = Ambiguity(
    "AS-13.skip",
    "Is every change a message?",
    {"c": "no, only the latest state is sure to be sent", "d": "yes"},
    default="d",
)
AS_13_THROTTLE = Ambiguity(
    "AS-13.throttle",
    "Are changes of pose, velocity and Wi-Fi signal alone streamed?",
    {"a": "all of them", "b": "some of them"},
    default="a",
)
AS_15_FULL = Ambiguity(
    "AS-15.full",
    "What charge does a full battery have, in percent?",
    {"a": "100", "b": "95 or more"},
    default="a",
)
AS_17_ZERO = Ambiguity(
    "AS-17.zero",
    "Is the velocity of a robot that stands sent?",
    {"a": "yes, as zeros", "b": "no, it is left out"},
    default="a",
)
AS_17_OFFLINE = Ambiguity(
    "AS-17.offline",
    "Is the velocity of a robot that is offline sent?",
    {"c": "no", "d": "yes, the last one"},
    default="d",
)
AS_18 = Ambiguity(
    "AS-18",
    "May a stuck state be STATE_UNKNOWN?",
    {"a": "no", "b": "yes, of a robot of which nothing is known; the client is to treat it as an error"},
    default="a",
)
AS_19 = Ambiguity(
    "AS-19",
    "May a reserved reason come?",
    {"a": "no, they are not emitted at present", "z": "yes"},
    default="a",
    flagged=frozenset("z"),
)
AS_21 = Ambiguity(
    "AS-21",
    "What is the mission in the state of a robot that has none?",
    {"a": "left out", "b": "an empty one in STATE_DEFAULT or STATE_UNKNOWN"},
    default="a",
)
AS_22 = Ambiguity(
    "AS-22",
    "How do the goals of the mission in a robot's state look?",
    {"a": "as on the Mission page", "b": "each inside an object with the one field `goal`"},
    default="a",
)
AS_25 = Ambiguity(
    "AS-25",
    "Which robots does the stream of a location follow once robots have moved?",
    {"a": "those that were there at its start", "b": "those that are there"},
    default="a",
)
AS_27 = Ambiguity(
    "AS-27",
    "What does SubscribeNetworkStatus tell of a robot that is not known to be connected?",
    {"a": "its last known network", "b": "that it has none", "c": "nothing"},
    default="a",
)
AS_28 = Ambiguity(
    "AS-28",
    "What becomes of a reading of the robot that is out of its documented range?",
    {"a": "the nearest value in the range is sent", "b": "it is dropped"},
    default="a",
)
AS_29_EMPTY = Ambiguity(
    "AS-29.empty",
    "How does the state of a robot show that no error is active?",
    {"c": "an empty list of codes", "d": "the error codes are left out"},
    default="c",
)
AS_32 = Ambiguity(
    "AS-32",
    "Is the state that only the robot's type has always in its state?",
    {"a": "yes, if the robot reports it", "b": "it may be left out"},
    default="a",
)
AS_34 = Ambiguity(
    "AS-34",
    "May codes of the transport and of authentication come that no table lists?",
    {"a": "no", "b": "yes"},
    default="a",
    flagged=frozenset("b"),
)

AMBIGUITIES: tuple[Ambiguity, ...] = (
    AS_01,
    AS_02,
    AS_03_UNKNOWN,
    AS_03_EMPTY,
    AS_03_FOREIGN,
    AS_04,
    AS_05,
    AS_06_EMPTY,
    AS_06_ORDER,
    AS_06_FIELD,
    AS_07,
    AS_08,
    AS_09_OFFLINE,
    AS_09_UNKNOWN,
    AS_09_STATE,
    AS_09_PART,
    AS_09_UNSET,
    AS_12_HYBRID,
    AS_12_EVENT,
    AS_13_FIELDS,
    AS_13_SKIP,
    AS_13_THROTTLE,
    AS_15_FULL,
    AS_17_ZERO,
    AS_17_OFFLINE,
    AS_18,
    AS_19,
    AS_21,
    AS_22,
    AS_25,
    AS_27,
    AS_28,
    AS_29_EMPTY,
    AS_32,
    AS_34,
)
"""In the order of the list."""

WAIVED: Mapping[str, str] = {
    "AS-02 c": "an unknown id that is left out in silence: the list calls it a violation",
    "AS-04 c, d": "union and intersection of the two arms: the list calls them deviations",
    "AS-05 b": "each message twice under one number breaks the sequence rule",
    "AS-08 a, b": "a map is read entry by entry, so that one first message and several are the same",
    "AS-10": "numbers are compared within one stream and one robot alone, which is right in all three readings",
    "AS-11": "the first number after a restart is free on every stream; that none comes twice is the rule itself",
    "AS-13 latency": "no bound is documented; what has settled is judged",
    "AS-14": "the published definitions name the field, and protobuf JSON may leave out zeros",
    "AS-15 c to g": "combinations are the robot's own doing; where nobody drives it, those that last are reported",
    "AS-16": "what an emergency stop does to a mission or to wheels cannot be told from what is reported",
    "AS-17 e, f": "the sign of a rotation can be told only by somebody who sees the robot",
    "AS-19 a to c": "which reason stands in for an obstructed destination is the robot's own choice",
    "AS-20": "nothing follows from SEVERITY_HIGH alone: the examples show it with a running mission",
    "AS-21 c": "the mission is whatever the robot reports as such",
    "AS-22 c, d": "no verdict on current_goal_index beyond its range, -1 to the number of goals",
    "AS-23": "both kinds of stream are held to what was reported, so they agree once things have settled",
    "AS-24": "localization_state is not defined on the page: its content is not looked at",
    "AS-26": "INTERNAL may end a stream at any time; one that just ends is a violation; nobody can drive ownership",
    "AS-29 b": 'a list of changes is no reading of "currently active"',
    "AS-30": "what a stuck robot does is its own doing; that it goes on moving is reported once it lasts",
    "AS-31": "no bound for noticing that a robot is gone is documented; the sequence rule holds all the same",
    "AS-33": "robots of one stream are never ordered against one another",
    "AS-35": "how charging looks in the battery state is the robot's own doing",
}
"""Entries without a rule, and readings that are not offered, with the reason."""
