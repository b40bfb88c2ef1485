"""Which of two refusals is answered, and what an id gets that is not the active mission's (AM-01 to AM-04)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import APPENDING, CREATING, FIELDLESS
from missionfsm.kernel.readings import Ambiguity, asked_of_each

IDLE, BUSY = "idle", "busy"
_WHILE = {IDLE: "while no mission is active", BUSY: "while another mission is active"}
AM_01 = asked_of_each(
    "AM-01",
    "{}: a request is malformed and the state forbids the call as well: which code?",
    {
        "a": "INVALID_ARGUMENT: the format is checked first",
        "b": "FAILED_PRECONDITION: the state is checked first, of what can be decoded at all",
        "c": "shape, then state, then goals and map",
    },
    (*CREATING, *APPENDING, *FIELDLESS),
)
AM_01_BLOCKED = asked_of_each(
    "AM-01.blocked",
    "{}: a request is malformed and the robot unable to start a mission: which code?",
    AM_01["CreateMission"].readings,
    CREATING,
)
AM_02_QUEUED = Ambiguity(
    "AM-02.queued",
    "UpdateMission names a waiting mission while no mission is active: which code?",
    {"a": "NOT_FOUND", "b": "FAILED_PRECONDITION"},
    flagged="b",
)
AM_02_ENDED = asked_of_each(
    "AM-02.ended",
    "UpdateMission names a listed mission that has ended, {}: which code?",
    {"a": "FAILED_PRECONDITION", "b": "NOT_FOUND", "d": "INVALID_ARGUMENT"},
    _WHILE,
    alike=False,
)
AM_02_CLEARED = asked_of_each(
    "AM-02.cleared",
    "UpdateMission names a mission that is not listed any more, {}: which code?",
    {"a": "INVALID_ARGUMENT", "b": "NOT_FOUND", "e": "FAILED_PRECONDITION"},
    _WHILE,
    alike=False,
)
AM_02_UNKNOWN = {
    IDLE: Ambiguity(
        "AM-02.unknown.idle",
        f"UpdateMission names a mission that never was, {_WHILE[IDLE]}: which code?",
        AM_02_CLEARED[IDLE].readings,
        default="a",
    ),
    BUSY: Ambiguity(
        "AM-02.unknown.busy",
        f"UpdateMission names a mission that never was, {_WHILE[BUSY]}: which code?",
        AM_02_CLEARED[BUSY].readings,
        default="a",
        flagged="e",
    ),
}
AM_03 = asked_of_each(
    "AM-03",
    "UpdateMission, {}: which code?",
    {"a": "FAILED_PRECONDITION", "b": "NOT_FOUND", "c": "INVALID_ARGUMENT"},
    {
        "fresh": "on a robot that never had a mission",
        "unknown": "on a robot that lists no mission any more, of one that never was",
        "cleared": "on a robot that lists no mission any more, of one that was listed",
    },
    alike=False,
)
AM_04 = asked_of_each(
    "AM-04",
    "UpdateMission has an invalid command and {}: which is answered?",
    {"a": "the command", "b": "the id: the code that it gets with a valid command"},
    {
        f"{which}-{when}": f"names {whose} mission, {_WHILE[when]}"
        for which, whose in (("queued", "a waiting"), ("ended", "an ended"), ("cleared", "a past"), ("unknown", "no"))
        for when in (IDLE, BUSY)
    }
    | {part: f"is asked {one.question.partition(', ')[2].partition(':')[0]}" for part, one in AM_03.items()},
)
AM_04_NO_ID = Ambiguity(
    "AM-04.no-id",
    "UpdateMission does not say readably which mission it is about, and none is active: which is answered?",
    {"a": "the format: INVALID_ARGUMENT", "c": "the state: FAILED_PRECONDITION"},
)
