"""Where the Robot Status page can be read in more than one way, entry by entry; ``specs/bear-status.md`` argues each.

Letters are those of its entries. An entry with several independent questions has an ambiguity for each, with a
word after its number; one that is asked in several calls has a part for each, with the name of the call at its end
(``AS-03.unknown.SubscribeBatteryStatus``): every call has a table of its own, and no sentence of the page says that two
calls answer alike. The parts of one question are marked as alike. Readings that would be violations are not
offered. `WAIVED` has the entries, or the parts of entries, from which no rule follows, with the reason.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from attrs import frozen

from missionfsm.bear.status.state import GET, Endpoint
from missionfsm.kernel.readings import Ambiguity

BATTERY, ERRORS, NAVIGATION, NETWORK, ONLINE, ROBOT = SUBSCRIPTIONS = tuple(one.value for one in Endpoint)
CALLS = (GET, *SUBSCRIPTIONS)
STATES = (GET, ROBOT)
"""The calls that show a whole state."""


@frozen(eq=False)
class Question:
    """A question that several calls ask, each by itself; the key is the name of the call."""

    parts: Mapping[str, Ambiguity]

    def __getitem__(self, call: str) -> Ambiguity:
        return self.parts[call]

    def __contains__(self, call: str) -> bool:
        return call in self.parts

    def __iter__(self) -> Iterator[Ambiguity]:
        return iter(self.parts.values())


def _asked(
    calls: tuple[str, ...],
    name: str,
    question: str,
    readings: Mapping[str, str],
    default: str,
    flagged: str = "",
    json_only: str = "",
) -> Question:
    """A question with a part for each of some calls."""
    return Question(
        {
            call: Ambiguity(
                f"{name}.{call}",
                f"{call}: {question}",
                readings,
                default,
                flagged=frozenset(flagged),
                alike=name,
                json_only=frozenset(json_only),
            )
            for call in calls
        }
    )


AS_01 = _asked(
    SUBSCRIPTIONS,
    "AS-01",
    "some of the selected robots, though not all, belong to somebody else: what is answered?",
    {
        "a": "PERMISSION_DENIED",
        "b": "the account's own robots are served, the others left out",
        "c": "the account's own robots are served until the stream ends with PERMISSION_DENIED",
    },
    "a",
    flagged="bc",
)
AS_02 = _asked(
    CALLS,
    "AS-02",
    "which code does a robot id get that no robot has?",
    {"a": "PERMISSION_DENIED, as somebody else's", "b": "NOT_FOUND"},
    "a",
    flagged="b",
)
AS_03_UNKNOWN = _asked(
    SUBSCRIPTIONS,
    "AS-03.unknown",
    "which code does a location get that does not exist?",
    {"a": "NOT_FOUND", "b": "PERMISSION_DENIED"},
    "a",
)
AS_03_EMPTY = _asked(
    SUBSCRIPTIONS,
    "AS-03.empty",
    "what is answered for an own location at which no robot is?",
    {"c": "NOT_FOUND", "d": "a stream on which nothing comes"},
    "c",
    flagged="d",
)
AS_03_OTHERS = _asked(
    SUBSCRIPTIONS,
    "AS-03.others",
    "what is answered for an own location at which only robots of somebody else are?",
    {"c": "NOT_FOUND", "d": "a stream on which nothing comes", "g": "PERMISSION_DENIED"},
    "c",
    flagged="d",
)
AS_03_MIXED = _asked(
    SUBSCRIPTIONS,
    "AS-03.mixed",
    "what is answered for an own location at which own robots are and some of somebody else?",
    {"h": "the account's own robots are served", "g": "PERMISSION_DENIED"},
    "h",
    flagged="g",
)
AS_03_SERVED = _asked(
    SUBSCRIPTIONS,
    "AS-03.served",
    "does the stream of an own location show somebody else's robots that are there?",
    {"h": "no, the account's own alone", "s": "yes, all robots at the location"},
    "h",
    flagged="s",
)
AS_03_FOREIGN = _asked(
    SUBSCRIPTIONS,
    "AS-03.foreign",
    "which code does somebody else's location get?",
    {"e": "PERMISSION_DENIED", "f": "NOT_FOUND"},
    "e",
    flagged="f",
)
AS_03_VACANT = _asked(
    SUBSCRIPTIONS,
    "AS-03.vacant",
    "which code does somebody else's location get at which no robot is?",
    {"e": "PERMISSION_DENIED", "f": "NOT_FOUND"},
    "e",
)
AS_04 = _asked(
    SUBSCRIPTIONS,
    "AS-04",
    "a selector has robot ids and a location: what is answered?",
    {
        "a": "INVALID_ARGUMENT",
        "b": "the location is followed, the later field of the two",
        "e": "the robot ids are followed, the earlier field of the two",
    },
    "a",
    flagged="be",
)
AS_04_BLANK: Mapping[str, Question] = {
    arm: _asked(
        SUBSCRIPTIONS,
        f"AS-04.blank-{arm}",
        f"a selector has {says}: what is answered?",
        {"a": "INVALID_ARGUMENT", "z": "the other one is followed, since what is empty is not set"},
        "a",
    )
    for arm, says in (
        ("ids", "no robot ids in its list and a location"),
        ("location", "robot ids and an empty location"),
    )
}
"""By the arm that is empty."""

AS_05 = _asked(
    SUBSCRIPTIONS,
    "AS-05",
    "a selector names a robot twice: what is answered?",
    {"a": "the robot is selected once", "c": "INVALID_ARGUMENT"},
    "a",
)
AS_06_EMPTY = _asked(
    SUBSCRIPTIONS,
    "AS-06.empty",
    "an id among the robot ids is empty: which code?",
    {"a": "INVALID_ARGUMENT", "b": "PERMISSION_DENIED, as any id that is not the account's"},
    "a",
)
_ORDERS: Mapping[str, tuple[tuple[str, ...], str]] = {
    "empty-first": (SUBSCRIPTIONS, "an empty robot id stands before one that may not be seen"),
    "empty-last": (SUBSCRIPTIONS, "an empty robot id stands behind one that may not be seen"),
    "twice": (SUBSCRIPTIONS, "a robot id is given twice, and one may not be seen"),
    "both": (SUBSCRIPTIONS, "robot ids and a location are given, and one of them may not be seen"),
    "list": (SUBSCRIPTIONS, "robot_ids is a bare list, and one of them may not be seen"),
    "field": (CALLS, "a field is not documented, and a robot or a location may not be seen"),
}
AS_06_ORDER: Mapping[str, Question] = {
    situation: _asked(
        calls,
        f"AS-06.order.{situation}",
        f"{says}: which code?",
        {"a": "INVALID_ARGUMENT: the form is checked first", "b": "the other: whose robots they are is checked first"},
        "a",
    )
    for situation, (calls, says) in _ORDERS.items()
}
"""By what is invalid about the request."""

_LEVELS: Mapping[str, tuple[tuple[str, ...], str]] = {
    "request": (CALLS, "the request"),
    "selector": (SUBSCRIPTIONS, "its selector"),
    "ids": (SUBSCRIPTIONS, "the selector's robot_ids"),
}
AS_06_FIELD: Mapping[str, Question] = {
    level: _asked(
        calls,
        f"AS-06.field.{level}",
        f"is a request invalid where {says} has a field that is not documented?",
        {"a": "no, the field is ignored", "b": "yes, INVALID_ARGUMENT"},
        "a",
    )
    for level, (calls, says) in _LEVELS.items()
}
"""By where the field stands."""

AS_06_LIST = _asked(
    SUBSCRIPTIONS,
    "AS-06.list",
    "robot_ids is a bare list of ids, as in the page's example: is such a request invalid?",
    {"a": "yes, INVALID_ARGUMENT: it is no RobotIDs", "b": "no, those are the ids"},
    "a",
)

AS_07 = Ambiguity(
    "AS-07.offline",
    "What does GetRobotStatus answer for a robot that is offline?",
    {
        "a": "DISCONNECTED and the last known values",
        "b": "INTERNAL",
        "c": "DISCONNECTED and nothing else",
    },
    default="a",
)
AS_07_UNKNOWN = Ambiguity(
    "AS-07.unknown",
    "What does GetRobotStatus answer for a robot of which nothing is known?",
    {"a": "a state without values", "b": "INTERNAL"},
    default="a",
)
AS_08 = _asked(
    (ERRORS, NETWORK, ONLINE),
    "AS-08.update",
    "does an update of a map bring the robots that have not changed as well?",
    {"c": "yes, with the numbers that they had", "d": "no"},
    "d",
)
AS_09_OFFLINE = _asked(
    (BATTERY, ERRORS, NAVIGATION, ROBOT),
    "AS-09.offline",
    "what does a new stream show first of a robot that is offline?",
    {
        "a": "the last known values",
        "b": "nothing, until the robot is back",
        "c": "UNKNOWN values",
    },
    "a",
    flagged="c",
)
_NOTHING_KNOWN = {"b": "nothing, until something is known", "c": "UNKNOWN values"}
AS_09_UNKNOWN = Question(
    {
        call: Ambiguity(
            f"AS-09.unknown.{call}",
            f"{call}: what does a new stream show first of a robot of which nothing is known that it could show?",
            {**_NOTHING_KNOWN, "e": "STATE_DISCONNECTED"} if call == ONLINE else _NOTHING_KNOWN,
            default="b",
        )
        for call in (BATTERY, ERRORS, NAVIGATION, ONLINE, ROBOT)
    }
)
AS_09_GONE = Question(
    {
        call: Ambiguity(
            f"AS-09.gone.{call}",
            f"{call}: what does a new stream show first of an offline robot of which nothing is known that it could "
            "show?",
            _NOTHING_KNOWN,
            default="b",
        )
        for call in (BATTERY, ERRORS, NAVIGATION, ROBOT)
    }
)
"""As with `AS_09_UNKNOWN`, what is shown of what was never reported may differ by topic: the calls are not alike."""
_UNREPORTED = {"a": "it is left out", "c": "with UNKNOWN values"}
AS_09_PART: Mapping[str, Question] = {
    part: _asked(
        STATES,
        f"AS-09.part.{part}",
        f"how does the state of a robot show its {part} if that is not reported?",
        {**_UNREPORTED, "e": "as STATE_DISCONNECTED"} if part == "connection" else _UNREPORTED,
        "a",
    )
    for part in ("connection", "battery", "emergency_stop", "error_codes", "navigation_state")
}
"""By the part of the state."""

_UNSET = {"a": "what was known last stays", "b": "nothing", "c": "UNKNOWN values"}
AS_09_UNSET = Question(
    {
        call: Ambiguity(
            f"AS-09.unset.{call}",
            f"{call}: what does a stream show once the robot does not report its topic any more?",
            {**_UNSET, "e": "STATE_DISCONNECTED"} if call == ONLINE else _UNSET,
            default="a",
            alike="AS-09.unset",
        )
        for call in (BATTERY, ERRORS, NAVIGATION, ONLINE)
    }
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
AS_12_EVENT = _asked(
    (BATTERY, ERRORS, NAVIGATION, NETWORK, ONLINE),
    "AS-12.event",
    "may a stream in event mode repeat what it showed last, under a new number?",
    {"a": "no", "b": "yes"},
    "a",
    flagged="b",
)
AS_13_FIELDS = _asked(
    (BATTERY, NAVIGATION),
    "AS-13.fields",
    "which changes are streamed?",
    {"a": "those of every field", "b": "those of its field `state` for sure"},
    "a",
    flagged="b",
)
AS_13_SKIP = _asked(
    SUBSCRIPTIONS,
    "AS-13.skip",
    "is every change a message?",
    {"c": "no, only the latest state is sure to be sent", "d": "yes"},
    "d",
)
AS_13_SIGNAL = Ambiguity(
    "AS-13.signal",
    f"{NETWORK}: are changes of the Wi-Fi signal alone streamed?",
    {"a": "all of them", "b": "some of them"},
    default="a",
    flagged=frozenset("b"),
)
AS_13_THROTTLE = _asked(
    ("pose", "twist"),
    "AS-13.throttle",
    f"does {ROBOT} stream a change of this part alone?",
    {"a": "always", "b": "sometimes"},
    "a",
)
AS_14 = _asked(
    SUBSCRIPTIONS,
    "AS-14.timestamp",
    "does every message say when it was recorded?",
    {"a": "yes", "b": "no, the timestamp may be absent"},
    "a",
    flagged="b",
)
AS_15_FULL = Ambiguity(
    "AS-15.full",
    "What charge does a full battery have, in percent?",
    {"a": "100", "b": "95 or more"},
    default="a",
)
AS_17_ZERO = _asked(
    STATES,
    "AS-17.zero",
    "is the velocity of a robot that stands sent?",
    {"a": "yes, as zeros", "b": "no, it is left out"},
    "a",
)
AS_17_OFFLINE = _asked(
    STATES,
    "AS-17.offline",
    "is the velocity of a robot that is offline sent?",
    {"c": "no", "d": "yes, the last one"},
    "d",
)
AS_18 = _asked(
    (GET, NAVIGATION, ROBOT),
    "AS-18",
    "may a stuck state be STATE_UNKNOWN?",
    {"a": "no", "b": "yes, of a robot of which nothing is known; the client is to treat it as an error"},
    "a",
)
AS_19 = _asked(
    (GET, NAVIGATION, ROBOT),
    "AS-19",
    "may a reserved reason come?",
    {"a": "no, they are not emitted at present", "z": "yes"},
    "a",
    flagged="z",
)
AS_21 = _asked(
    STATES,
    "AS-21",
    "what is the mission in the state of a robot that has none?",
    {"a": "left out", "b": "an empty one in STATE_DEFAULT or STATE_UNKNOWN"},
    "a",
)
AS_22 = _asked(
    STATES,
    "AS-22",
    "how do the goals of the mission in a robot's state look?",
    {"a": "as on the Mission page", "b": "each inside an object with the one field `goal`, which only JSON can say"},
    "a",
    json_only="b",
)
AS_25 = _asked(
    SUBSCRIPTIONS,
    "AS-25",
    "which robots does the stream of a location follow once robots have moved?",
    {
        "a": "those that were there at its start",
        "b": "those that are there",
        "c": "those that were there at its start, until they leave",
        "e": "those that were there at its start, until they leave; with the last one it ends, NOT_FOUND",
    },
    "a",
    flagged="e",
)
AS_26 = _asked(
    SUBSCRIPTIONS,
    "AS-26",
    "may a stream just end, without an error?",
    {"a": "no", "b": "yes"},
    "a",
    flagged="b",
)
_NETWORKS = {"a": "its last known network", "b": "that it has none", "c": "nothing"}
AS_27_OFFLINE = Ambiguity(
    "AS-27.offline",
    f"What does {NETWORK} tell of a robot that is offline?",
    _NETWORKS,
    default="a",
)
AS_27_UNKNOWN = Ambiguity(
    "AS-27.unknown",
    f"What does {NETWORK} tell of a robot whose connection is not known?",
    _NETWORKS,
    default="a",
)
AS_28 = _asked(
    ("battery", "wifi"),
    "AS-28",
    "what becomes of a reading of the robot that is out of its documented range?",
    {"a": "the nearest value in the range is sent", "b": "it is dropped"},
    "a",
)
AS_29_EMPTY = _asked(
    STATES,
    "AS-29.empty",
    "how does the state of a robot show that no error is active?",
    {"c": "an empty list of codes", "d": "the error codes are left out"},
    "c",
)
AS_32 = _asked(
    STATES,
    "AS-32",
    "is the state that only the robot's type has always in its state?",
    {"a": "yes, if the robot reports it", "b": "it may be left out"},
    "a",
    flagged="b",
)
AS_34 = _asked(
    CALLS,
    "AS-34",
    "may codes of the transport and of authentication come that no table lists?",
    {"a": "no", "b": "yes"},
    "a",
    flagged="b",
)


def _all(declared: object) -> Iterator[Ambiguity]:
    if isinstance(declared, Ambiguity):
        yield declared
    elif isinstance(declared, Question | Mapping):
        for one in declared.values() if isinstance(declared, Mapping) else declared:
            yield from _all(one)


AMBIGUITIES: tuple[Ambiguity, ...] = tuple(
    one for name, declared in tuple(globals().items()) if name.startswith("AS_") for one in _all(declared)
)
"""In the order of the list."""

WAIVED: Mapping[str, str] = {
    "AS-02 c": "an unknown id that is left out in silence: it would be a violation",
    "AS-04 c, d": "union and intersection of the two arms: they would be deviations",
    "AS-05 b": "each message twice under one number breaks the sequence rule",
    "AS-09 d": "INTERNAL may be answered to a subscription at any time",
    "AS-08 a, b": "a map is read entry by entry, so that one first message and several are the same",
    "AS-10": "numbers are compared within one stream and one robot alone, which is right in all three readings",
    "AS-11": "the first number after a restart is free on every stream; that none comes twice is the rule itself",
    "AS-13 latency": "no bound is documented; what has settled is judged",
    "AS-14 a, b": "the published definitions name the field, and protobuf JSON may leave out zeros",
    "AS-15 c to g": "combinations are the robot's own doing; where nobody drives it, those that last are reported",
    "AS-16": "what an emergency stop does to a mission or to wheels cannot be told from what is reported",
    "AS-17 e, f": "the sign of a rotation can be told only by somebody who sees the robot",
    "AS-19 a to c": "which reason stands in for an obstructed destination is the robot's own choice",
    "AS-20": "nothing follows from SEVERITY_HIGH alone: the examples show it with a running mission",
    "AS-21 c": "the mission is whatever the robot reports as such",
    "AS-22 c, d": "no verdict on current_goal_index beyond its range, -1 to the number of goals",
    "AS-23": "both kinds of stream are held to what was reported, so they agree once things have settled",
    "AS-24": "localization_state is not defined on the page: its content is not looked at",
    "AS-26 ownership": "nobody can drive that a robot changes its owner; INTERNAL may end a stream at any time",
    "AS-29 b": 'a list of changes is no reading of "currently active"',
    "AS-30": "what a stuck robot does is its own doing; that it goes on moving is reported once it lasts",
    "AS-31": "no bound for noticing that a robot is gone is documented; the sequence rule holds all the same",
    "AS-33": "robots of one stream are never ordered against one another",
    "AS-35": "how charging looks in the battery state is the robot's own doing",
}
"""Entries without a rule, and readings that are not offered, with the reason."""
