"""What the commands of `UpdateMission` do (AM-29 to AM-31, AM-64)."""

from __future__ import annotations

from missionfsm.kernel.readings import Ambiguity, asked_of_each

AM_29 = asked_of_each(
    "AM-29",
    "What does {} answer?",
    {"a": "FAILED_PRECONDITION", "b": "OK, and nothing changes"},
    {"pause": "pausing a paused mission", "resume": "resuming a running mission"},
    flagged="b",
)
AM_30 = Ambiguity(
    "AM-30",
    "When does a finished mission succeed?",
    {"a": "at once", "b": "at its current goal"},
    flagged="b",
)
AM_31 = Ambiguity(
    "AM-31",
    "May a paused mission be finished?",
    {"a": "yes", "b": "no, FAILED_PRECONDITION"},
    flagged="b",
)
AM_64 = Ambiguity(
    "AM-64.goals",
    "Where does a resumed mission go on?",
    {"a": "at its goal", "b": "at its first goal"},
    flagged="b",
)
AM_64_AUTOMATIC = Ambiguity(
    "AM-64.automatic",
    "Where does a resumed NavigateAuto mission go on?",
    {"a": "at its goal", "c": "it selects again"},
)
