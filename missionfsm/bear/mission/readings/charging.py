"""What `ChargeRobot` answers (AM-37, AM-38, AM-40)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import WAITING
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AM_37_PAUSED = Ambiguity(
    "AM-37.paused",
    "Does a paused mission forbid ChargeRobot?",
    {"a": "yes", "b": "no, charging waits behind it"},
    flagged="b",
)
AM_37_QUEUED = asked_of_each(
    "AM-37.queued",
    "Do waiting missions alone forbid ChargeRobot where {}?",
    {
        "a": "yes",
        "b": "no, charging joins the queue",
        "c": "no, charging comes first",
        "o": "no, charging comes first, though it is listed behind them",
    },
    WAITING,
)
AM_37_HALTED = Ambiguity(
    "AM-37.halted",
    "Does a halted queue go on after a charge that came first?",
    {"a": "yes, the charge sets it going", "s": "no, it stays halted"},
)
AM_38_DOCK = Ambiguity(
    "AM-38.dock",
    "What does ChargeRobot answer on a robot without a contact dock?",
    {
        "a": "NOT_FOUND",
        "b": "FAILED_PRECONDITION",
        "c": "INTERNAL",
        "d": "UNIMPLEMENTED",
        "g": "INVALID_ARGUMENT",
    },
    flagged="cdg",
)
DOCK, LOCATION = "dock", "location"
AM_38_BUSY = {
    state: asked_of_each(
        f"AM-38.{state}",
        f"{words} and {{}}: what does ChargeRobot answer?",
        {"e": "FAILED_PRECONDITION", "f": "what it answers for what is missing"},
        {DOCK: "the robot has no contact dock", LOCATION: "the map has no charging location"},
    )
    for state, words in (
        ("running", "A mission is running"),
        ("paused", "A mission is paused"),
    )
}
AM_40 = Ambiguity(
    "AM-40",
    "May charging be paused?",
    {"a": "yes, it is a mission like others", "c": "no, FAILED_PRECONDITION"},
)
