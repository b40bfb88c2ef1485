"""The reference under random combinations of readings, judged: what several tests and a benchmark need."""

from __future__ import annotations

import random
from collections.abc import Mapping

from attrs import frozen

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.system import System
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.conform.guide import Guide
from missionfsm.tools.conform.handshake import handshake
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.tour import play, tour
from missionfsm.tools.reference.subject import ReferenceSubject

BOUNDS = Bounds(4, goals=3)


@frozen(eq=False)
class Bench:
    """What judging many references of one system can share: a belief automaton and a prepared guide."""

    system: System
    automaton: Automaton
    guide: Guide

    @classmethod
    def of(cls, system: System) -> Bench:
        """A bench for a system."""
        drives = tuple(system.spec.drives)
        guide = Guide(system, system.alphabet({}, BOUNDS).worlds, BOUNDS)
        return cls(system, Automaton(system.spec, drives), guide)


def combination(system: System, seed: int) -> dict[str, str]:
    """A random reading of every ambiguity; the same seed gives the same."""
    draw = random.Random(f"{system.name} {seed}")
    return {one.id: draw.choice(sorted(one.readings)) for one in system.spec.ambiguities}


def wrong(bench: Bench, choice: Mapping[str, str], seed: int, examples: int, steps: int) -> str:
    """What is wrong with the judgement of a reference that follows a combination of readings; empty if nothing is."""
    system = bench.system
    subject = ReferenceSubject(system, choice)
    run = Run.with_guide(system, subject, handshake(system, subject), bench.automaton, bench.guide.fresh())
    if not (play(run) and tour(run, random.Random(seed), examples, steps)):
        if run.found is None:
            return f"no reading of {run.ledger.contradiction} is left"
        if run.found.judge.exhausted:
            return f"too many explanations after {len(run.found.actions)} actions"
        return f"false alarm: {run.found.judge.verdict()}"
    missing = [f"{name}={choice[name]}" for name, letters in run.ledger.readings.items() if choice[name] not in letters]
    return f"ruled out though followed: {', '.join(missing)}" if missing else ""
