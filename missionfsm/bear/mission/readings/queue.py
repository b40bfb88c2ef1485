"""What joins the queue and what becomes of it (AM-06, AM-07, AM-09 to AM-13)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import APPENDING, CREATING, WAITING
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AM_06 = Ambiguity(
    "AM-06",
    "Does a paused mission forbid CreateMissionBatch?",
    {"a": "yes, paused counts as running", "b": "no, the batch waits behind it"},
    flagged="b",
)
AM_07 = asked_of_each(
    "AM-07",
    "Do waiting missions alone forbid CreateMissionWorkflow where {}?",
    {
        "a": "yes, as for CreateMission",
        "b": "no, the workflow joins the queue",
        "o": "no, it is begun first, though it is listed behind them",
        "r": "no, the workflow replaces the queue",
        "v": "yes, with INVALID_ARGUMENT: it does not fit the robot's state",
    },
    WAITING,
    flagged="v",
)
AM_07_AFTER = Ambiguity(
    "AM-07.after",
    "Does a halted queue go on after a workflow of one mission that came first?",
    {"a": "yes, the workflow sets it going", "s": "no, it stays halted"},
)
_QUEUE_AFTER_CANCEL = {
    "a": "the next mission starts",
    "b": "the queue halts",
    "c": "the waiting missions are cancelled too",
    "d": "the waiting missions vanish",
}
AM_09 = Ambiguity(
    "AM-09",
    "What becomes of the queue when the active mission is cancelled?",
    _QUEUE_AFTER_CANCEL,
    flagged="d",
    alike="AM-09",
)
AM_09_SKIP = Ambiguity(
    "AM-09.skip",
    "What becomes of the queue when skipping the last goal cancels the active mission?",
    _QUEUE_AFTER_CANCEL,
    flagged="d",
    alike="AM-09",
)
_QUEUE_AFTER_FAILURE = {**_QUEUE_AFTER_CANCEL, "e": "the waiting missions fail too"}
AM_10 = Ambiguity(
    "AM-10",
    "What becomes of the queue when the active mission fails?",
    _QUEUE_AFTER_FAILURE,
    flagged="d",
    alike="AM-10",
)
AM_10_START = Ambiguity(
    "AM-10.start",
    "What becomes of the queue when a mission fails as it is to start?",
    _QUEUE_AFTER_FAILURE,
    flagged="d",
    alike="AM-10",
)
AM_11 = asked_of_each(
    "AM-11",
    "May {} be called when all listed missions have ended?",
    {"a": "yes, and what it appends starts", "b": "no, FAILED_PRECONDITION"},
    APPENDING,
)
AM_12_PAUSED = asked_of_each(
    "AM-12.paused",
    "May {} be called while the active mission is paused?",
    {"a": "yes", "b": "no, FAILED_PRECONDITION"},
    APPENDING,
    flagged="b",
)
AM_12_HALTED = asked_of_each(
    "AM-12.halted",
    "What does {} do to a halted queue?",
    {"a": "the mission waits with the others", "b": "FAILED_PRECONDITION", "c": "it sets the queue going again"},
    APPENDING,
    flagged="b",
)
AM_13 = asked_of_each(
    "AM-13",
    "What becomes of ended missions when {} creates new ones?",
    {"a": "they stay listed", "b": "the new ones replace them"},
    (*CREATING, "ChargeRobot"),
)
