"""How a value looks (AS-14, AS-15, AS-17 to AS-22, AS-28, AS-29, AS-32)."""

from __future__ import annotations

from missionfsm.bear.status.readings.scope import NAVIGATION, ROBOT, STATES, SUBSCRIPTIONS
from missionfsm.bear.status.state import GET
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AS_14 = asked_of_each(
    "AS-14.timestamp",
    "{}: does every message say when it was recorded?",
    {"a": "yes", "b": "no, the timestamp may be absent"},
    SUBSCRIPTIONS,
    flagged="b",
)
AS_15_FULL = Ambiguity(
    "AS-15.full",
    "What charge does a full battery have, in percent?",
    {"a": "100", "b": "95 or more"},
)
AS_17_ZERO = asked_of_each(
    "AS-17.zero",
    "{}: is the velocity of a robot that stands sent?",
    {"a": "yes, as zeros", "b": "no, it is left out"},
    STATES,
)
AS_17_OFFLINE = asked_of_each(
    "AS-17.offline",
    "{}: is the velocity of a robot that is offline sent?",
    {"c": "no", "d": "yes, the last one"},
    STATES,
    default="d",
)
AS_18 = asked_of_each(
    "AS-18",
    "{}: may a stuck state be STATE_UNKNOWN?",
    {"a": "no", "b": "yes, of a robot of which nothing is known; the client is to treat it as an error"},
    (GET, NAVIGATION, ROBOT),
    flagged="b",
)
AS_19 = asked_of_each(
    "AS-19",
    "{}: may a reserved reason come?",
    {"a": "no, they are not emitted at present", "z": "yes"},
    (GET, NAVIGATION, ROBOT),
    flagged="z",
)
AS_21 = asked_of_each(
    "AS-21",
    "{}: what is the mission in the state of a robot that has none?",
    {"a": "left out", "b": "an empty one in STATE_DEFAULT or STATE_UNKNOWN"},
    STATES,
)
AS_22 = {
    call: Ambiguity(
        f"AS-22.{call}",
        f"{call}: how do the goals of the mission in a robot's state look?",
        {
            "a": "as on the Mission page",
            "b": "each inside an object with the one field `goal`, which only JSON can say",
        },
        alike="AS-22",
        json_only="b",
    )
    for call in STATES
}
AS_28 = asked_of_each(
    "AS-28",
    "{}: what becomes of a reading of the robot that is out of its documented range?",
    {"a": "the nearest value in the range is sent", "b": "it is dropped"},
    ("battery", "wifi"),
)
AS_29_EMPTY = asked_of_each(
    "AS-29.empty",
    "{}: how does the state of a robot show that no error is active?",
    {"c": "an empty list of codes", "d": "the error codes are left out"},
    STATES,
)
AS_32 = asked_of_each(
    "AS-32",
    "{}: is the state that only the robot's type has always in its state?",
    {"a": "yes, if the robot reports it", "b": "it may be left out"},
    STATES,
    flagged="b",
)
