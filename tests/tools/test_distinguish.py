"""Readings that are still open are told apart by experiments, and tried on the implementation where that is wanted."""

from __future__ import annotations

import functools

import pytest
from combinations import Bench

from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.handshake import handshake
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.trials import Lab, Trial
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")
ALTERNATIVES = {
    (one.id.split(".")[0], letter): (one.id, letter)
    for one in reversed(MISSION.spec.ambiguities)
    for letter in one.readings
    if letter != one.default
}.values()
"""Every reading of every question, in one of the situations in which it is asked."""


@functools.cache
def bench() -> Bench:
    return Bench.of(MISSION)


@functools.cache
def trials(name: str) -> tuple[Trial, ...]:
    """The experiments on an ambiguity before anything else has been decided."""
    ambiguity = next(one for one in MISSION.spec.ambiguities if one.id == name)
    lab = Lab(bench().guide, handshake(MISSION, ReferenceSubject(MISSION, {})), bench().automaton, {}, 4_000)
    return lab.trials(ambiguity, tuple(ambiguity.readings))


@pytest.mark.parametrize("name", ["AM-08", "AM-09", "AM-14.ended", "AM-17.last.base-navigate", "AM-33.fresh", "AM-36"])
def test_an_experiment_tells_what_it_says(name: str) -> None:
    """The reference under the reading that it follows is explained; with one that it is against, it is not."""
    found = trials(name)
    readings = next(one for one in MISSION.spec.ambiguities if one.id == name).readings
    told = {(trial.follows, other) for trial in found for other in trial.against}
    assert told == {(one, other) for one in readings for other in readings if one != other}
    for trial in found:
        first, *lines = trial.history
        assert check(MISSION, head(first), lines, readings={name: trial.follows}).conforms
        for other in trial.against:
            assert check(MISSION, head(first), lines, readings={name: other}).violation is not None


def test_nothing_can_be_left_out_of_an_experiment() -> None:
    """Without any one of its actions it tells less."""
    (trial,) = [one for one in trials("AM-09") if one.follows == "b"]
    lab = Lab(bench().guide, handshake(MISSION, ReferenceSubject(MISSION, {})), bench().automaton, {})
    for at in range(len(trial.actions)):
        actions = (*trial.actions[:at], *trial.actions[at + 1 :])
        shorter = lab.play(("AM-09", "b"), trial.world, actions)
        left = shorter.judge.belief.readings.get("AM-09", tuple(trial.ambiguity.readings))
        assert not shorter.right or set(trial.against) & set(left)


@pytest.mark.long
def test_a_verdict_tells_the_experiments_for_what_is_open() -> None:
    """With few conversations much is open; what would tell it apart is in the verdict, as text and as JSON."""
    verdict = conform(MISSION, ReferenceSubject(MISSION, {}), drawn=1, tours=2, steps=10, seed=1)
    left = {name for name, letters in verdict.readings.items() if len(letters) > 1}
    names = {one.ambiguity for one in verdict.experiments}
    assert (len(names) > 0, names - left) == (True, set())
    one = verdict.experiments[0]
    assert f"{one.ambiguity}: {one.follows}, and not {' or '.join(one.against)}, would show in" in str(verdict)
    assert verdict.to_json()["experiments"][0] == one.to_json()


@pytest.mark.long
@pytest.mark.parametrize(("name", "letter"), ALTERNATIVES, ids=str)
def test_what_can_be_told_apart_is_decided(name: str, letter: str) -> None:
    """The reference under each single alternative reading: every other reading that any experiment tells is ruled out.

    Which ones no experiment tells is what the search came to, and nobody's list.
    """
    told = {other for trial in trials(name) if trial.follows == letter for other in trial.against}
    subject = ReferenceSubject(MISSION, {name: letter})
    automaton = Automaton(MISSION.spec, bench().automaton.successors.driven)
    run = Run.with_guide(MISSION, subject, handshake(MISSION, subject), automaton, bench().guide.fresh())
    ambiguity = next(one for one in MISSION.spec.ambiguities if one.id == name)
    run.ledger.readings[name] = tuple(ambiguity.readings)
    for trial in trials(name):
        if trial.follows in run.ledger.readings[name] and set(trial.against) & set(run.ledger.readings[name]):
            assert run.converse(trial.world, trial.actions), str(run.found and run.found.judge.verdict())
    assert letter in run.ledger.readings[name]
    assert told & set(run.ledger.readings[name]) == set()


@pytest.mark.long
@pytest.mark.parametrize(("name", "letter"), [("AM-09", "b"), ("AM-17.patrol.servi-delivery-patrol", "b")])
def test_a_run_decides_what_it_can(name: str, letter: str) -> None:
    """After a whole run with experiments nothing is open that one for the reading really followed would decide."""
    verdict = conform(
        MISSION, ReferenceSubject(MISSION, {name: letter}), drawn=1, tours=10, steps=14, seed=1, distinguish=True
    )
    assert verdict.conforms, str(verdict)
    followed = {one.id: one.default for one in MISSION.spec.ambiguities} | {name: letter}
    assert [one for one, letters in verdict.readings.items() if followed[one] not in letters] == []
    assert verdict.readings.get(name, (letter,)) == (letter,)
    assert [str(one) for one in verdict.experiments if one.follows == followed[one.ambiguity]] == []
