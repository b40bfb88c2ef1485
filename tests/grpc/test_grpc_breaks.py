"""Breaks that binary protobuf can carry are found on the wire, and readings accepted; tests/bench has all of them."""

from __future__ import annotations

import functools

import pytest
from commandline import CommandLine
from onwire import Searcher, breaks_carried, connected, readings_accepted

from missionfsm.app.serve import serve
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Violation
from missionfsm.tools.mutate.mutants import Mutant, mutants

BREAKS = (
    "bear.mission/CreateMission/INVALID_ARGUMENT/a-goal-occurs-twice-in-the-list holds always",
    "bear.mission/CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued is dropped",
    "bear.mission/UpdateMission/NOT_FOUND/the-mission-is-still-queued is answered FAILED_PRECONDITION",
    "bear.mission/lifecycle/goals-are-taken-up-in-order skips one",
    "bear.status/GetRobotStatus/PERMISSION_DENIED/the-robot-is-somebody-elses is dropped",
)
"""One of every kind."""
SYSTEMS = ("bear.mission", "bear.status")


@functools.cache
def searcher(name: str) -> Searcher:
    return Searcher(system(name))


def mutant(name: str) -> Mutant:
    return next(one for one in mutants(system(name.partition("/")[0])) if one.name == name)


@pytest.mark.parametrize("name", SYSTEMS)
def test_breaks_are_found_over_grpc_and_through_a_proxy(name: str) -> None:
    """What is served with a rule broken is judged wrong where it is in process; what stands between hides nothing."""
    found = breaks_carried(system(name), [mutant(one) for one in BREAKS if one.startswith(name)], 1)
    assert (found.hidden, found.wrong, found.shown) == ([], [], found.every)


@pytest.mark.long
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_sample_of_all_breaks_is_found_over_grpc(name: str) -> None:
    """So it is with every sixtieth of all breaks, where it shows in binary requests."""
    found = breaks_carried(system(name), mutants(system(name)), 60)
    assert found.wrong == []
    assert found.shown > 2


@pytest.mark.long
def test_a_break_that_only_several_conversations_show_is_found_over_grpc() -> None:
    """Each of them is explained by some reading, and no reading explains all."""
    found = breaks_carried(system("bear.mission"), [mutant("bear.mission/UpdateMission/finish has no effect")], 1)
    assert (found.hidden, found.wrong, found.shown) == ([], [], 1)


@pytest.mark.long
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_sample_of_all_readings_is_accepted_over_grpc(name: str) -> None:
    """The reference under every reading of every sixtieth ambiguity conforms, alone and through a proxy."""
    found = readings_accepted(system(name), 60)
    assert found.wrong == []
    assert found.shown > 1


def test_a_break_is_asked_for_by_its_rule() -> None:
    """A rule's id alone breaks it in the first way that there is."""
    broken, of = mutant(BREAKS[1]), system("bear.mission")
    had = searcher("bear.mission").break_shown(broken)
    assert had
    with serve("bear.mission", broken=broken.rule) as robot, connected(of, robot.target) as subject:
        violation = searcher("bear.mission").violation(subject, had)
    assert isinstance(violation, Violation)
    assert broken.rule in [rule.id for rule in violation.rules]


def test_a_break_that_does_not_exist_is_told_with_the_nearest(command_line: CommandLine) -> None:
    """A name that no break has is bad input, with one that has."""
    ended = command_line("serve", "bear.mission", "--grpc", "0", "--break", f"{BREAKS[1]}ped")
    assert (ended.status, ended.out) == (2, "")
    assert f"no break has that name; is {BREAKS[1]!r} meant?" in ended.err
