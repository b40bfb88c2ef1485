"""The oracle notices broken rules, and `teeth` tells what it notices from what is allowed."""

from __future__ import annotations

import contextlib
import itertools
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from missionfsm.app.parallel import teeth_on
from missionfsm.systems import names, system
from missionfsm.tools.mutate.mutants import mutants
from missionfsm.tools.mutate.teeth import teeth


def test_every_rule_has_a_mutant() -> None:
    """No rule of bear.mission goes untested: each is broken by at least one mutant."""
    spec = system("bear.mission").spec
    assert {rule.id for rule in spec.all_rules} - {mutant.rule for mutant in mutants(system("bear.mission"))} == set()


@pytest.mark.parametrize(
    "only",
    [
        "CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued",
        "UpdateMission/NOT_FOUND/the-mission-is-still-queued",
        pytest.param("lifecycle/goals-are-taken-up-in-order skips one", marks=pytest.mark.long),
        "SubscribeMissionStatus/sequence-numbers-grow",
    ],
)
def test_a_broken_rule_is_noticed(only: str) -> None:
    """Every mutant of these rules is killed."""
    found = teeth(system("bear.mission"), only=only)
    assert (len(found.results) > 0, [result.mutant for result in found.results if not result.killed]) == (True, [])


@pytest.mark.long
def test_a_mutant_that_follows_another_reading_is_allowed() -> None:
    """Not refusing what only one reading refuses is no violation, and is told apart from one that was missed."""
    found = teeth(system("bear.mission"), only="ClearMissionStatus/FAILED_PRECONDITION/nothing-is-listed is dropped")
    assert (found.survived, [result.mutant.split("/")[-1] for result in found.allowed]) == (
        (),
        ["nothing-is-listed is dropped"],
    )


@pytest.mark.long
def test_a_mutant_that_no_call_can_meet_is_allowed() -> None:
    """A rule that is due only where the next thing happens at once can be broken by nobody; one at rest can be."""
    only = "ClearMissionStatus/FAILED_PRECONDITION/a-mission-is-about-to-start"
    found = teeth(system("bear.mission"), only=only)
    assert found.survived == ()
    assert [one.mutant.split("/")[-1].partition(" ")[2] for one in found.allowed] == [
        "is dropped",
        "is answered INVALID_ARGUMENT",
    ]
    assert all("that do not last" in one.because for one in found.allowed)
    waits = "ClearMissionStatus/FAILED_PRECONDITION/a-mission-waits-in-a-halted-queue is answered INVALID_ARGUMENT"
    assert [one.because for one in teeth(system("bear.mission"), only=waits).results] == [""]


@pytest.mark.parametrize("name", names())
def test_every_mutant_can_be_made(name: str) -> None:
    """Mutants are found for every system, under names of their own."""
    found = [mutant.name for mutant in mutants(system(name))]
    assert (len(found) > 10, len(found) - len(set(found))) == (True, 0)


def test_processes_find_what_one_finds() -> None:
    """Two processes judge half of the mutants each; progress is told for every mutant."""
    only, progress = "a-line-is-one-message", itertools.count()
    several = teeth_on(2, "isaac.robot", seed=0, only=only, progress=lambda: next(progress))
    one = teeth(system("isaac.robot"), only=only)
    assert {result.mutant: result.killed for result in several.results} == {
        result.mutant: result.killed for result in one.results
    }
    assert next(progress) == len(one.results) > 1
    sample = teeth_on(1, "isaac.robot", seed=0, only=only, every=2, progress=lambda: None)
    assert [result.mutant for result in sample.results] == [result.mutant for result in one.results[::2]]


def children(process: int) -> list[int]:
    """The processes that one has started and that live, according to /proc."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            state, parent = path.read_text().rpartition(")")[2].split()[:2]
            if int(parent) == process and state != "Z":
                found.append(int(path.parent.name))
    return found


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="it is asked of /proc what lives")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_processes_end_with_the_one_that_started_them(number: int) -> None:
    """``teeth`` that is told to end, alone, leaves nobody behind."""
    command = [sys.executable, "-m", "missionfsm", "teeth", "bear.mission", "--jobs", "2"]
    judging = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    until = time.monotonic() + 30
    while len(started := children(judging.pid)) < 3 and time.monotonic() < until:  # two, and one that tracks
        time.sleep(0.05)
    judging.send_signal(number)
    try:
        assert judging.wait(10) == 130
    finally:
        judging.terminate()
    until = time.monotonic() + 5
    while (left := [one for one in started if Path(f"/proc/{one}").exists()]) and time.monotonic() < until:
        time.sleep(0.05)
    assert (len(started) > 1, left) == (True, [])
