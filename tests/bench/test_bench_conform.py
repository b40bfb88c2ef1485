"""What a run of ``conform`` costs, and how soon it finds what is wrong. Nothing is asserted of times.

Run with ``pytest -o addopts= tests/bench/test_bench_conform.py -s``; skipped otherwise.
"""

from __future__ import annotations

import functools
import json
import random
import shutil
import statistics
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from combinations import Bench, combination, wrong

from missionfsm.adapters.stdio import Child
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange
from missionfsm.oracle.automaton import Automaton
from missionfsm.systems import names, system
from missionfsm.tools.conform.actions import length
from missionfsm.tools.conform.conform import conform, search
from missionfsm.tools.conform.plan import Plan
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.shortening import shorten
from missionfsm.tools.conform.shortest import everything
from missionfsm.tools.conform.tour import tour
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")
NODE = shutil.which("node")
SUBJECTS = Path(__file__).parent.parent / "subjects"
TIMES = 40


class _Recorded:
    """An implementation that answers what it answered before, for nothing: what is left is what the tester costs."""

    def __init__(self, exchanges: list[Exchange]) -> None:
        self._left: Iterator[Exchange] = iter(exchanges)

    def exchange(self, _: str, __: JSON) -> Exchange:
        return next(self._left)

    def close(self) -> None:
        """Nothing is held."""


def _recording(exchanges: list[Exchange]) -> Any:
    subject = ReferenceSubject(MISSION, {})
    ask = subject.exchange

    def exchange(method: str, params: JSON) -> Exchange:
        exchanges.append(ask(method, params))
        return exchanges[-1]

    subject.exchange = exchange  # type: ignore[method-assign]
    return subject


def _run(subject: Any, automaton: Automaton) -> Run:
    return Run.against(MISSION, subject, automaton=automaton)


def _seconds(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def test_bench_conform_steps_and_what_hypothesis_costs(benchmark: Any) -> None:
    """Steps a second with the reference in process; the same actions had again show what Hypothesis is of it."""
    automaton = Automaton(MISSION.spec, tuple(MISSION.spec.drives))
    search(
        _run(ReferenceSubject(MISSION, {}), automaton), Plan(TIMES, 0, TIMES, 30), 1
    )  # the automaton knows the way from here on
    had: list[tuple[Any, tuple[Any, ...]]] = []

    def note(run: Run) -> None:
        if run.last is not None:
            had.append((run.last.world, tuple(run.last.actions)))

    run = _run(ReferenceSubject(MISSION, {}), automaton)
    run.progress = note
    whole = benchmark.pedantic(lambda: _seconds(lambda: search(run, Plan(TIMES, 0, TIMES, 30), 1)), rounds=1)
    again = _run(ReferenceSubject(MISSION, {}), automaton)
    alone = _seconds(lambda: [again.replay(world, actions) for world, actions in had])
    exchanges: list[Exchange] = []
    recorder = _run(_recording(exchanges), automaton)
    exchanges.clear()
    for world, actions in had:
        recorder.replay(world, actions)
    player = _run(ReferenceSubject(MISSION, {}), automaton)
    player.partner.subject = _Recorded(exchanges)
    judging = _seconds(lambda: [player.replay(world, actions) for world, actions in had])
    print(
        f"\n{run.ledger.steps / whole:,.0f} steps a second with Hypothesis and the guide,"
        f" {run.ledger.steps / alone:,.0f} without;"
        f" Hypothesis and the guide are {1 - alone / whole:.0%}, the reference {(alone - judging) / whole:.0%},"
        f" the oracle {judging / whole:.0%}"
    )


def test_bench_conform_tours(benchmark: Any) -> None:
    """Steps a second of systematic conversations, which need no Hypothesis."""
    automaton = Automaton(MISSION.spec, tuple(MISSION.spec.drives))
    run = _run(ReferenceSubject(MISSION, {}), automaton)
    took = benchmark.pedantic(lambda: _seconds(lambda: tour(run, random.Random(1), TIMES, 30)), rounds=1)
    print(f"\n{run.ledger.steps / took:,.0f} steps a second")


@pytest.mark.skipif(NODE is None, reason="the subject is written for Node.js, which is not installed")
def test_bench_conform_time_to_the_first_violation(benchmark: Any) -> None:
    """How long it takes to find each fault of the Node.js subject, made short or not."""
    listed = subprocess.run(
        [str(NODE), str(SUBJECTS / "bear_mission.mjs"), "--list-breaks"], capture_output=True, check=True
    )
    lengths: dict[str, int] = {}
    first: dict[str, float] = {}
    whole: dict[str, float] = {}
    missed: list[str] = []

    def judge(name: str) -> None:
        child = Child([str(NODE), str(SUBJECTS / "bear_mission.mjs"), "--break", name])
        began = time.perf_counter()
        last = [began]
        verdict = conform(MISSION, child, seed=1, advice=False, progress=lambda run: _mark(run, last))
        child.close()
        if verdict.violation is None:
            missed.append(name)
            return
        first[name], whole[name] = last[0] - began, time.perf_counter() - began

    def look(name: str) -> None:
        child = Child([str(NODE), str(SUBJECTS / "bear_mission.mjs"), "--break", name])
        run = Run.against(MISSION, child)
        search(run, Plan(), 1)
        shorten(run)
        if run.found is not None:
            lengths[name] = length(run.found.actions)
            attempt = functools.partial(run.replay, run.found.world)
            alphabet = run.system.alphabet(run.found.world, run.bounds)
            assert everything(attempt, alphabet, lengths[name] - 1) is None, name
        child.close()

    benchmark.pedantic(lambda: [judge(name) for name in json.loads(listed.stdout)], rounds=1)
    for name in first:
        look(name)
    slowest = max(first, key=lambda name: first[name])
    print(
        f"\n{len(first)} faults found, {len(missed)} not ({', '.join(missed) or 'none'}):"
        f" median {statistics.median(first.values()):.2f} s to the first violation,"
        f" {statistics.median(whole.values()):.2f} s to a short story; slowest {slowest}, {first[slowest]:.2f} s;"
        f" {len(lengths)} stories of {statistics.median(lengths.values())} calls and drives, {max(lengths.values())} at"
        " most, none longer than the shortest"
    )


def _mark(run: Run, last: list[float]) -> None:
    if run.last is not None and (run.found is not None or run.ledger.contradiction is None):
        last[0] = time.perf_counter()


@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_bench_conform_two_hundred_combinations(name: str) -> None:
    """The reference under 200 random combinations of readings in 200 conversations each: no false alarm, ever."""
    bench = Bench.of(system(name))
    found = {seed: wrong(bench, combination(bench.system, seed), seed, 200, 10) for seed in range(200)}
    assert {seed: says for seed, says in found.items() if says} == {}
