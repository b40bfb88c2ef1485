"""When a message comes, what of, and how a stream ends (AS-08, AS-12, AS-13, AS-25, AS-26)."""

from __future__ import annotations

from missionfsm.bear.status.readings.scope import BATTERY, ERRORS, NAVIGATION, NETWORK, ONLINE, ROBOT, SUBSCRIPTIONS
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AS_08 = asked_of_each(
    "AS-08.update",
    "{}: does an update of a map bring the robots that have not changed as well?",
    {"c": "yes, with the numbers that they had", "d": "no"},
    (ERRORS, NETWORK, ONLINE),
    default="d",
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
AS_12_EVENT = asked_of_each(
    "AS-12.event",
    "{}: may a stream in event mode repeat what it showed last, under a new number?",
    {"a": "no", "b": "yes"},
    (BATTERY, ERRORS, NAVIGATION, NETWORK, ONLINE),
    flagged="b",
)
AS_13_FIELDS = asked_of_each(
    "AS-13.fields",
    "{}: which changes are streamed?",
    {"a": "those of every field", "b": "those of its field `state` for sure"},
    (BATTERY, NAVIGATION),
    flagged="b",
)
AS_13_SKIP = asked_of_each(
    "AS-13.skip",
    "{}: is every change a message?",
    {"c": "no, only the latest state is sure to be sent", "d": "yes"},
    SUBSCRIPTIONS,
    default="d",
)
AS_13_SIGNAL = Ambiguity(
    "AS-13.signal",
    f"{NETWORK}: are changes of the Wi-Fi signal alone streamed?",
    {"a": "all of them", "b": "some of them"},
    flagged="b",
)
AS_13_THROTTLE = asked_of_each(
    "AS-13.throttle",
    f"{{}}: does {ROBOT} stream a change of this part alone?",
    {"a": "always", "b": "sometimes"},
    ("pose", "twist"),
)
AS_25 = asked_of_each(
    "AS-25",
    "{}: which robots does the stream of a location follow once robots have moved?",
    {
        "a": "those that were there at its start",
        "b": "those that are there",
        "c": "those that were there at its start, until they leave",
        "d": "those that were there at its start, and perhaps those that have come since",
        "e": "those that were there at its start, until they leave; with the last one it ends, NOT_FOUND",
    },
    SUBSCRIPTIONS,
    flagged="de",
)
AS_26 = asked_of_each(
    "AS-26", "{}: may a stream just end, without an error?", {"a": "no", "b": "yes"}, SUBSCRIPTIONS, flagged="b"
)
