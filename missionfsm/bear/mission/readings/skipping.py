"""What `SkipGoal` does (AM-16 to AM-19)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import missions_of
from missionfsm.bear.mission.state import AUTOMATIC, GOALLESS, PATROLS, Kind
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AM_16 = Ambiguity(
    "AM-16",
    "May a goal of a paused mission be skipped?",
    {"a": "no, FAILED_PRECONDITION", "b": "yes, and it stays paused"},
    flagged="b",
)
_AT_THE_LAST = {
    "a": "the mission succeeds",
    "b": "FAILED_PRECONDITION, no change",
    "c": "INTERNAL, no change",
    "d": "the mission is cancelled",
}
AM_17_LAST = asked_of_each(
    "AM-17.last",
    "What does skipping the last goal of {} do?",
    _AT_THE_LAST,
    missions_of(kind for kind in Kind if kind not in PATROLS | GOALLESS),
)
LOOPS = PATROLS - {Kind.SERVI_HOSTING_PATROL}
"""The patrols of which the page says that they loop, so that another goal follows the last."""

AM_17_PATROL = {
    part: one
    for kinds, flagged in ((LOOPS, "abcd"), (PATROLS - LOOPS, ""))
    for part, one in asked_of_each(
        "AM-17.patrol",
        "What does skipping the last goal of {} do?",
        {**_AT_THE_LAST, "f": "it goes on at the first goal"},
        missions_of(kind for kind in Kind if kind in kinds),
        flagged,
        default="f",
    ).items()
}
AM_18 = asked_of_each(
    "AM-18",
    "What does skipping the goal of {} do?",
    {"a": "it takes the next free goal", "b": "it takes the next goal, free or not", "c": "it was the last goal"},
    missions_of(kind for kind in Kind if kind in AUTOMATIC),
)
AM_19 = Ambiguity("AM-19.charge", "What does skipping do while charging?", _AT_THE_LAST, default="b")
AM_19_RETURN = Ambiguity(
    "AM-19.return",
    "What does skipping do to the return mission of a workflow?",
    {**_AT_THE_LAST, "g": "it goes on to its next goal; the last is skipped as in another reading"},
    default="b",
)
