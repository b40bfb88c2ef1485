"""Breaks that binary protobuf can carry are found on the wire as they are in this process."""

from __future__ import annotations

import functools

import pytest
from brokenserver import Searcher
from commandline import CommandLine
from relay import Relay

from missionfsm.adapters.grpc.client import GrpcSubject
from missionfsm.adapters.grpc.target import Target
from missionfsm.app.serve import serve
from missionfsm.systems import system
from missionfsm.tools.mutate.teeth import Mutant, mutants

BREAKS = (
    "bear.mission/CreateMission/INVALID_ARGUMENT/a-goal-occurs-twice-in-the-list holds always",
    "bear.mission/CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued is dropped",
    "bear.mission/UpdateMission/NOT_FOUND/the-mission-is-still-queued is answered FAILED_PRECONDITION",
    "bear.mission/lifecycle/goals-are-taken-up-in-order skips one",
    "bear.status/GetRobotStatus/PERMISSION_DENIED/the-robot-is-somebody-elses is dropped",
)
"""One of every kind; tests/bench/test_bench_breaks.py has all of them."""


@functools.cache
def searcher(name: str) -> Searcher:
    return Searcher(system(name))


def mutant(name: str) -> Mutant:
    return next(one for one in mutants(system(name.partition("/")[0])) if one.name == name)


@pytest.mark.parametrize("name", BREAKS)
def test_a_break_is_found_over_grpc_as_in_process(name: str) -> None:
    """What is served with a rule broken is judged wrong, against the rules that it is judged by in process."""
    found, broken = searcher(name.partition("/")[0]), mutant(name)
    rules = found.in_process(broken)
    assert rules
    assert set(found.over_grpc(broken)) == set(rules)


def test_a_break_is_asked_for_by_its_rule() -> None:
    """A rule's id alone breaks it in the first way that there is."""
    broken = mutant(BREAKS[1])
    with serve("bear.mission", broken=broken.rule) as robot:
        subject = GrpcSubject("bear.mission", Target(robot.target, settle=0.02))
        assert broken.rule in searcher("bear.mission").search(broken, subject)
        subject.close()


def test_a_break_is_found_through_a_proxy() -> None:
    """What stands between the tester and a broken robot neither hides the break nor makes another of it."""
    broken = mutant(BREAKS[1])
    with serve("bear.mission", broken=broken.rule) as robot:
        relay = Relay(robot.target, lambda _: None)
        subject = GrpcSubject("bear.mission", Target(f"localhost:{relay.proxy.port}", settle=0.02))
        assert broken.rule in searcher("bear.mission").search(broken, subject)
        subject.close()
        relay.close()


def test_a_break_that_does_not_exist_is_told_with_the_nearest(command_line: CommandLine) -> None:
    """A name that no break has is bad input, with one that has."""
    ended = command_line("serve", "bear.mission", "--grpc", "0", "--break", f"{BREAKS[1]}ped")
    assert (ended.status, ended.out) == (2, "")
    assert f"no break has that name; is {BREAKS[1]!r} meant?" in ended.err
