"""References with something broken on purpose, in this process."""

from __future__ import annotations

from typing import Any

from attrs import evolve

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer
from missionfsm.kernel.step import Step
from missionfsm.kernel.subject import Exchange, Subject
from missionfsm.systems import system
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")
BUSY = "bear.mission/CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued"
EMPTY = "bear.mission/CreateMissionBatch/INVALID_ARGUMENT/the-request-is-empty"
NEVER = "bear.mission/SkipGoal/FAILED_PRECONDITION/the-robot-is-not-on-a-mission"


def answering(code: str, *rules: str) -> ReferenceSubject:
    """A reference that answers with a code wherever one of these rules refuses."""

    def mutate_step(_: Any, step: Step | None) -> Step | None:
        refuses = step is not None and step.answer is not None and set(rules) & set(step.rules)
        return evolve(step, answer=Answer(code)) if step is not None and refuses else step

    return ReferenceSubject(MISSION, mutate_step=mutate_step)


class Fickle:
    """Follows one reading of an ambiguity after one reset and another one after the next."""

    def __init__(self, name: str, letters: str) -> None:
        self._all: list[Subject] = [ReferenceSubject(MISSION, {name: letter}) for letter in letters]
        self._resets = 0

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Ask the one whose turn it is."""
        self._resets += method == "reset"
        return self._all[self._resets % len(self._all)].exchange(method, params)

    def close(self) -> None:
        """Nothing is held."""
