"""Robots that let one form of a wrong request pass, though they refuse others that are wrong for the same reason."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from attrs import define

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange
from missionfsm.systems import system
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.tour import play
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")


@define
class Lenient:
    """A reference that hears requests as somebody else makes them of what was said."""

    reference: ReferenceSubject
    heard: Callable[[str, JSON], JSON]

    def exchange(self, method: str, params: JSON) -> Exchange:
        """What the reference answers to what was heard; OK where nothing was."""
        heard = self.heard(method, params)
        return Exchange({}) if heard is None else self.reference.exchange(method, heard)

    def close(self) -> None:
        """Nothing is held."""


def without_empty_goals(_: str, params: JSON) -> JSON:
    """Goals without content are passed over where a list has others."""
    if isinstance(params, dict):
        return {name: without_empty_goals(_, one) for name, one in params.items()}
    if isinstance(params, list):
        return [without_empty_goals(_, one) for one in params if one != {} or len(params) == 1]
    return params


def with_a_table_for_birthdays(_: str, params: JSON) -> JSON:
    """A birthday without a goal is held at the first table."""
    if params == {"missionWorkflow": {"serviWorkflow": {"birthday": {}}}}:
        return {"missionWorkflow": {"serviWorkflow": {"birthday": {"goal": {"destinationId": "table-1"}}}}}
    return params


def without_unset_commands(method: str, params: JSON) -> JSON:
    """A command that is not set is nothing to do."""
    unset = method == "UpdateMission" and params.get("missionCommand", {}).get("command") == "COMMAND_UNKNOWN"
    return None if unset else params


@pytest.mark.parametrize(
    ("heard", "rule"),
    [
        (without_empty_goals, "CreateMission/INVALID_ARGUMENT/a-goal-is-invalid"),
        (with_a_table_for_birthdays, "CreateMissionWorkflow/INVALID_ARGUMENT/the-goals-do-not-match-the-mission-type"),
        (without_unset_commands, "UpdateMission/INVALID_ARGUMENT/the-command-is-not-set"),
    ],
)
def test_every_form_of_a_wrong_request_is_tried(heard: Callable[[str, JSON], JSON], rule: str) -> None:
    """The conversations that are written down find a robot that lets one form pass, and say which rule forbids it."""
    run = Run.against(MISSION, Lenient(ReferenceSubject(MISSION), heard))
    assert not play(run)
    assert run.found is not None
    violation = run.found.judge.violation
    assert violation is not None
    assert f"bear.mission/{rule}" in [one.id for one in violation.rules]
