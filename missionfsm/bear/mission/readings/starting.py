"""How a mission starts, and what becomes of it where the robot is unable to start one (AM-53, AM-63)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import ADDING, APPENDING
from missionfsm.kernel.readings import Ambiguity, asked_of_each

_UNABLE = "{}: what is answered where the robot is unable to start a mission?"
_UNABLE_FIRST = {
    "a": "FAILED_PRECONDITION",
    "b": "OK",
    "i": "INTERNAL: that it cannot be started is a failure of the mission system",
    "t": "OK, or DEADLINE_EXCEEDED",
}
AM_53 = {
    **asked_of_each("AM-53", _UNABLE, _UNABLE_FIRST, ("CreateMission", "ChargeRobot"), flagged="i", alike=False),
    "CreateMissionWorkflow": Ambiguity(
        "AM-53.CreateMissionWorkflow",
        _UNABLE.format("CreateMissionWorkflow"),
        {**_UNABLE_FIRST, "v": "INVALID_ARGUMENT: the workflow does not fit the robot's state"},
        flagged="iv",
    ),
    **asked_of_each("AM-53", _UNABLE, {"b": "OK", "t": "OK, or DEADLINE_EXCEEDED"}, APPENDING, alike=False),
    "CreateMissionBatch": Ambiguity(
        "AM-53.CreateMissionBatch",
        _UNABLE.format("CreateMissionBatch"),
        {"a": "FAILED_PRECONDITION", "t": "FAILED_PRECONDITION, or DEADLINE_EXCEEDED"},
    ),
}
QUEUE = "queue"
AM_53_THEN = asked_of_each(
    "AM-53.then",
    "What becomes of {}, while the robot is unable to start a mission?",
    {"p": "it waits", "f": "it may fail", "s": "it starts all the same"},
    {QUEUE: "a mission whose turn it is", **{call: f"a first mission that {call} makes" for call in ADDING}},
)
AM_63 = asked_of_each(
    "AM-63",
    "Is the first mission that {} makes seen before it runs?",
    {"a": "no, it is running at once", "b": "yes, waiting at first"},
    ADDING,
    alike=False,
)
