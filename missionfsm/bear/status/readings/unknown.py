"""What is told of a robot that is offline or of which nothing is known (AS-07, AS-09, AS-27)."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.bear.status.readings.scope import BATTERY, ERRORS, NAVIGATION, NETWORK, ONLINE, ROBOT, STATES
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AS_07 = Ambiguity(
    "AS-07.offline",
    "What does GetRobotStatus answer for a robot that is offline?",
    {
        "a": "DISCONNECTED and the last known values",
        "b": "INTERNAL",
        "c": "DISCONNECTED and nothing else",
    },
)
AS_07_UNKNOWN = Ambiguity(
    "AS-07.unknown",
    "What does GetRobotStatus answer for a robot of which nothing is known?",
    {"a": "a state without values", "b": "INTERNAL"},
)
AS_09_OFFLINE = asked_of_each(
    "AS-09.offline",
    "{}: what does a new stream show first of a robot that is offline?",
    {
        "a": "the last known values",
        "b": "nothing, until the robot is back",
        "c": "UNKNOWN values",
    },
    (BATTERY, ERRORS, NAVIGATION, ROBOT),
    flagged="c",
)
_NOTHING_KNOWN = {"b": "nothing, until something is known", "c": "UNKNOWN values"}
AS_09_UNKNOWN = {
    call: Ambiguity(
        f"AS-09.unknown.{call}",
        f"{call}: what does a new stream show first of a robot of which nothing is known that it could show?",
        {**_NOTHING_KNOWN, "e": "STATE_DISCONNECTED"} if call == ONLINE else _NOTHING_KNOWN,
        default="b",
    )
    for call in (BATTERY, ERRORS, NAVIGATION, ONLINE, ROBOT)
}
AS_09_CEASED = {
    call: Ambiguity(
        f"AS-09.ceased.{call}",
        f"{call}: what does a new stream show first of a robot whose topic is known to be reported no more?",
        AS_09_UNKNOWN[call].readings,
        default="b",
    )
    for call in (BATTERY, ERRORS, NAVIGATION, ONLINE)
}
AS_09_GONE = {
    call: Ambiguity(
        f"AS-09.gone.{call}",
        f"{call}: what does a new stream show first of an offline robot of which nothing is known that it could show?",
        _NOTHING_KNOWN,
    )
    for call in (BATTERY, ERRORS, NAVIGATION, ROBOT)
}
"""As with `AS_09_UNKNOWN`, what is shown of what was never reported may differ by topic: the calls are not alike."""

_UNREPORTED = {"a": "it is left out", "c": "with UNKNOWN values"}
AS_09_PART: Mapping[str, Mapping[str, Ambiguity]] = {
    part: asked_of_each(
        f"AS-09.part.{part}",
        f"{{}}: how does the state of a robot show its {part} if that is not reported?",
        {**_UNREPORTED, "e": "as STATE_DISCONNECTED"} if part == "connection" else _UNREPORTED,
        STATES,
    )
    for part in ("connection", "battery", "emergency_stop", "error_codes", "navigation_state")
}
"""By the part of the state."""

_UNSET = {"a": "what was known last stays", "b": "nothing", "c": "UNKNOWN values"}
AS_09_UNSET = {
    call: Ambiguity(
        f"AS-09.unset.{call}",
        f"{call}: what does a stream show once the robot does not report its topic any more?",
        {**_UNSET, "e": "STATE_DISCONNECTED"} if call == ONLINE else _UNSET,
        default="a",
        alike="AS-09.unset",
    )
    for call in (BATTERY, ERRORS, NAVIGATION, ONLINE)
}
_NETWORKS = {"a": "its last known network", "b": "that it has none", "c": "nothing"}
AS_27_OFFLINE = Ambiguity(
    "AS-27.offline",
    f"What does {NETWORK} tell of a robot that is offline?",
    _NETWORKS,
)
AS_27_UNKNOWN = Ambiguity(
    "AS-27.unknown",
    f"What does {NETWORK} tell of a robot whose connection is not known?",
    _NETWORKS,
)
