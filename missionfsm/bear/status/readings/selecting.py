"""Which robots a request selects, and which code it gets (AS-01 to AS-06, AS-34)."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.bear.status.readings.scope import CALLS, SUBSCRIPTIONS
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AS_01 = asked_of_each(
    "AS-01",
    "{}: some of the selected robots, though not all, belong to somebody else: what is answered?",
    {
        "a": "PERMISSION_DENIED",
        "b": "the account's own robots are served, the others left out",
        "c": "the account's own robots are served until the stream ends with PERMISSION_DENIED",
    },
    SUBSCRIPTIONS,
    flagged="bc",
)
AS_02 = asked_of_each(
    "AS-02",
    "{}: which code does a robot id get that no robot has?",
    {"a": "PERMISSION_DENIED, as somebody else's", "b": "NOT_FOUND"},
    CALLS,
    flagged="b",
)
AS_03_UNKNOWN = asked_of_each(
    "AS-03.unknown",
    "{}: which code does a location get that does not exist?",
    {"a": "NOT_FOUND", "b": "PERMISSION_DENIED"},
    SUBSCRIPTIONS,
)
AS_03_EMPTY = asked_of_each(
    "AS-03.empty",
    "{}: what is answered for an own location at which no robot is?",
    {"c": "NOT_FOUND", "d": "a stream on which nothing comes"},
    SUBSCRIPTIONS,
    flagged="d",
)
AS_03_OTHERS = asked_of_each(
    "AS-03.others",
    "{}: what is answered for an own location at which only robots of somebody else are?",
    {"c": "NOT_FOUND", "d": "a stream on which nothing comes", "g": "PERMISSION_DENIED"},
    SUBSCRIPTIONS,
    flagged="d",
)
AS_03_MIXED = asked_of_each(
    "AS-03.mixed",
    "{}: what is answered for an own location at which own robots are and some of somebody else?",
    {"h": "the account's own robots are served", "g": "PERMISSION_DENIED"},
    SUBSCRIPTIONS,
    flagged="g",
)
AS_03_SERVED = asked_of_each(
    "AS-03.served",
    "{}: does the stream of an own location show somebody else's robots that are there?",
    {"h": "no, the account's own alone", "s": "yes, all robots at the location"},
    SUBSCRIPTIONS,
    flagged="s",
)
AS_03_FOREIGN = asked_of_each(
    "AS-03.foreign",
    "{}: which code does somebody else's location get?",
    {"e": "PERMISSION_DENIED", "f": "NOT_FOUND"},
    SUBSCRIPTIONS,
    flagged="f",
)
AS_03_VACANT = asked_of_each(
    "AS-03.vacant",
    "{}: which code does somebody else's location get at which no robot is?",
    {"e": "PERMISSION_DENIED", "f": "NOT_FOUND"},
    SUBSCRIPTIONS,
)
AS_04 = asked_of_each(
    "AS-04",
    "{}: a selector has robot ids and a location: what is answered?",
    {
        "a": "INVALID_ARGUMENT",
        "b": "the location is followed, the later field of the two",
        "e": "the robot ids are followed, the earlier field of the two",
    },
    SUBSCRIPTIONS,
    flagged="be",
)
AS_04_BLANK: Mapping[str, Mapping[str, Ambiguity]] = {
    arm: asked_of_each(
        f"AS-04.blank-{arm}",
        f"{{}}: a selector has {says}: what is answered?",
        {"a": "INVALID_ARGUMENT", "z": "the other one is followed, since what is empty is not set"},
        SUBSCRIPTIONS,
    )
    for arm, says in (
        ("ids", "no robot ids in its list and a location"),
        ("location", "robot ids and an empty location"),
    )
}
"""By the arm that is empty."""

AS_05 = asked_of_each(
    "AS-05",
    "{}: a selector names a robot twice: what is answered?",
    {"a": "the robot is selected once", "c": "INVALID_ARGUMENT"},
    SUBSCRIPTIONS,
)
AS_06_EMPTY = asked_of_each(
    "AS-06.empty",
    "{}: an id among the robot ids is empty: which code?",
    {"a": "INVALID_ARGUMENT", "b": "PERMISSION_DENIED, as any id that is not the account's"},
    SUBSCRIPTIONS,
)
_ORDERS: Mapping[str, tuple[tuple[str, ...], str]] = {
    "empty-first": (SUBSCRIPTIONS, "an empty robot id stands before one that may not be seen"),
    "empty-last": (SUBSCRIPTIONS, "an empty robot id stands behind one that may not be seen"),
    "twice": (SUBSCRIPTIONS, "a robot id is given twice, and one may not be seen"),
    "both": (SUBSCRIPTIONS, "robot ids and a location are given, and one of them may not be seen"),
    "list": (SUBSCRIPTIONS, "robot_ids is a bare list, and one of them may not be seen"),
    "field": (CALLS, "a field is not documented, and a robot or a location may not be seen"),
}
AS_06_ORDER: Mapping[str, Mapping[str, Ambiguity]] = {
    situation: asked_of_each(
        f"AS-06.order.{situation}",
        f"{{}}: {says}: which code?",
        {"a": "INVALID_ARGUMENT: the form is checked first", "b": "the other: whose robots they are is checked first"},
        calls,
    )
    for situation, (calls, says) in _ORDERS.items()
}
"""By what is invalid about the request."""

_LEVELS: Mapping[str, tuple[tuple[str, ...], str]] = {
    "request": (CALLS, "the request"),
    "selector": (SUBSCRIPTIONS, "its selector"),
    "ids": (SUBSCRIPTIONS, "the selector's robot_ids"),
}
AS_06_FIELD: Mapping[str, Mapping[str, Ambiguity]] = {
    level: asked_of_each(
        f"AS-06.field.{level}",
        f"{{}}: is a request invalid where {says} has a field that is not documented?",
        {"a": "no, the field is ignored", "b": "yes, INVALID_ARGUMENT"},
        calls,
    )
    for level, (calls, says) in _LEVELS.items()
}
"""By where the field stands."""

AS_06_LIST = asked_of_each(
    "AS-06.list",
    "{}: robot_ids is a bare list of ids, as in the page's example: is such a request invalid?",
    {"a": "yes, INVALID_ARGUMENT: it is no RobotIDs", "b": "no, those are the ids"},
    SUBSCRIPTIONS,
)
AS_34 = asked_of_each(
    "AS-34",
    "{}: may codes of the transport and of authentication come that no table lists?",
    {"a": "no", "b": "yes"},
    CALLS,
    flagged="b",
)
