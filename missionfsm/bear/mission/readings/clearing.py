"""What `ClearMissionStatus` answers (AM-33, AM-34)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import HALTED, WAITING
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AM_33 = asked_of_each(
    "AM-33",
    "What does ClearMissionStatus answer {}?",
    {"a": "OK without ids", "b": "FAILED_PRECONDITION", "c": "INVALID_ARGUMENT"},
    {"fresh": "a robot that never had a mission", "cleared": "when nothing is listed any more"},
    flagged="c",
)
AM_34 = {
    where: Ambiguity(
        f"AM-34.{where}",
        f"What does ClearMissionStatus do when nothing is active and {words}?",
        {"a": "it clears everything", "b": "it clears the ended missions", "c": "FAILED_PRECONDITION"},
        default="a" if where == HALTED else "c",
    )
    for where, words in WAITING.items()
}
