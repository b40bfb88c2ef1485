"""The oracle notices broken rules, and `teeth` tells what it notices from what is allowed."""

from __future__ import annotations

import pytest

from missionfsm.systems import names, system
from missionfsm.tools.teeth import mutants, teeth


def test_every_rule_has_a_mutant() -> None:
    """No rule of bear.mission goes untested: each is broken by at least one mutant."""
    spec = system("bear.mission").spec
    assert {rule.id for rule in spec.all_rules} - {mutant.rule for mutant in mutants(system("bear.mission"))} == set()


@pytest.mark.parametrize(
    "only",
    [
        "CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued",
        "UpdateMission/NOT_FOUND/the-mission-is-still-queued",
        "lifecycle/goals-are-taken-up-in-order skips one",
        "SubscribeMissionStatus/sequence-numbers-grow",
    ],
)
def test_a_broken_rule_is_noticed(only: str) -> None:
    """Every mutant of these rules is killed."""
    found = teeth(system("bear.mission"), only=only)
    assert (len(found.bites) > 0, [bite.mutant for bite in found.bites if not bite.killed]) == (True, [])


def test_a_mutant_that_follows_another_reading_is_allowed() -> None:
    """Not refusing what only one reading refuses is no violation, and is told apart from one that was missed."""
    found = teeth(system("bear.mission"), only="ClearMissionStatus/FAILED_PRECONDITION/nothing-is-listed is dropped")
    assert (found.missed, [bite.mutant.split("/")[-1] for bite in found.allowed]) == (
        (),
        ["nothing-is-listed is dropped"],
    )


@pytest.mark.parametrize("name", names())
def test_every_mutant_can_be_made(name: str) -> None:
    """Mutants are found for every system, under names of their own."""
    found = [mutant.name for mutant in mutants(system(name))]
    assert (len(found) > 10, len(found) - len(set(found))) == (True, 0)
