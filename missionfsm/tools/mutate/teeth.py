"""Does the oracle notice? Every mutant is judged as any other implementation would be.

A mutant that is judged right *survives*. Either the documents allow what it does under some reading: every conversation
within bounds can be explained, which is shown by exploring it together with the oracle. Or the oracle lacks a tooth.
"""

from __future__ import annotations

import functools
import math
import random
from collections.abc import Callable, Iterable

from attrs import frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import GibberishError
from missionfsm.kernel.system import System
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.conform.guide import Guide
from missionfsm.tools.conform.handshake import handshake, offered
from missionfsm.tools.conform.run import BOUNDS, Run
from missionfsm.tools.conform.tour import play, tour
from missionfsm.tools.mutate.equivalent import ReferenceSteps, allowed_under
from missionfsm.tools.mutate.mutants import Mutant, mutants
from missionfsm.tools.reference.model import Reference

FIRST = 16
"""How many conversations a mutant has before it is asked whether what it does is allowed."""

ROUNDS = (64, 64, 64)
"""How many conversations it has after that, in rounds, until it has survived."""

STEPS = 40
"""How many calls and drives each conversation has."""

BLOCK = 8
"""How many mutants are judged one after the other in the same part: those of a rule share what they remember."""


@frozen
class MutantResult:
    """What came of one mutant."""

    mutant: str
    rule: str
    killed: bool
    length: int = 0
    because: str = ""


@frozen
class MutationReport:
    """What came of all mutants."""

    system: str
    results: tuple[MutantResult, ...]
    untested: tuple[str, ...]

    @property
    def killed(self) -> int:
        """How many mutants were noticed."""
        return sum(result.killed for result in self.results)

    @property
    def allowed(self) -> tuple[MutantResult, ...]:
        """Survivors that do nothing that the documents forbid, within the bounds that were explored."""
        return tuple(result for result in self.results if not result.killed and result.because)

    @property
    def survived(self) -> tuple[MutantResult, ...]:
        """Survivors that do something forbidden."""
        return tuple(result for result in self.results if not result.killed and not result.because)

    @property
    def percent(self) -> int:
        """The score in whole per cent, rounded down: 100 is all and nothing less."""
        return math.floor(100 * self.score)

    @property
    def score(self) -> float:
        """Which part was noticed of the mutants that do something forbidden; 1.0 is all."""
        not_allowed = len(self.results) - len(self.allowed)
        return self.killed / not_allowed if not_allowed else 0.0

    def to_json(self) -> JSON:
        """The result as the command line writes it."""
        return {
            "system": self.system,
            "mutants": len(self.results),
            "killed": self.killed,
            "allowed": [{"mutant": result.mutant, "because": result.because} for result in self.allowed],
            "missed": [result.mutant for result in self.survived],
            "untested": list(self.untested),
            "score": self.score,
        }

    def __str__(self) -> str:
        lines = [
            f"{self.system}: {self.killed} of {len(self.results) - len(self.allowed)} mutants killed "
            f"({self.percent}%), {len(self.allowed)} more do nothing that is forbidden"
        ]
        lines += [f"missed: {result.mutant}" for result in self.survived]
        lines += [f"no mutant breaks: {rule}" for rule in self.untested]
        lines += [f"allowed: {result.mutant}: {result.because}" for result in self.allowed]
        return "\n".join(lines)


def teeth(
    system: System,
    *,
    seed: int = 0,
    only: str = "",
    every: int = 1,
    part: tuple[int, int] = (0, 1),
    progress: Callable[[MutantResult], None] = lambda _: None,
) -> MutationReport:
    """Judge every mutant of a system.

    Args:
        system: the system.
        seed: the seed of the conversations.
        only: a text in the names of the mutants to judge; all have the empty text.
        every: take only every so many-th of those, from the first on.
        part: which part of them, of how many that are judged side by side; `merged_reports` puts them together again.
        progress: given the result of every mutant.
    """
    automaton = Automaton(system.spec, tuple(system.spec.drives))
    guide = Guide(system, system.alphabet({}, BOUNDS).worlds, BOUNDS)
    results = []
    which, parts = part
    for number, mutant in enumerate(sampled(system, only, every)):
        if number // BLOCK % parts == which:
            results.append(_result(system, mutant, automaton, guide, seed))
            progress(results[-1])
    tested = {mutant.rule for mutant in mutants(system)}
    untested = tuple(rule.id for rule in system.spec.all_rules if rule.id not in tested)
    return MutationReport(system.name, tuple(results), untested)


def sampled(system: System, only: str, every: int) -> list[Mutant]:
    """Of the mutants with a text in their names, every so many-th from the first on."""
    return [mutant for mutant in mutants(system) if only in mutant.name][::every]


def merged_reports(system: System, parts: Iterable[MutationReport]) -> MutationReport:
    """The report on all mutants in the order of the rules, put together from the reports on parts of them."""
    parts = tuple(parts)
    found = {result.mutant: result for part in parts for result in part.results}
    ordered = tuple(found[mutant.name] for mutant in mutants(system) if mutant.name in found)
    return MutationReport(system.name, ordered, parts[0].untested)


def _result(system: System, mutant: Mutant, automaton: Automaton, guide: Guide, seed: int) -> MutantResult:
    broken = mutant.subject(system)
    because = ""
    for fresh, conversations in enumerate((FIRST, *ROUNDS)):
        info = handshake(system, broken)
        run = Run.with_guide(offered(system, info), broken, info, automaton, guide.fresh())
        try:
            # Every round is a run of its own, since a tour goes where its run has been least.
            draw = random.Random(seed + fresh)  # noqa: S311 - no secret
            toured = functools.partial(tour, run, draw, conversations, STEPS, mutant.favour)
            right = toured() if fresh else _at_first(system, run, toured)
        except GibberishError:  # it does not even speak the protocol any more
            return MutantResult(mutant.name, mutant.rule, killed=True)
        if not right:
            length = len(run.found.judge.history) - 1 if run.found else 0
            return MutantResult(mutant.name, mutant.rule, killed=True, length=length)
        if not fresh:
            because = _excuse(system, mutant, broken.model, guide.worlds)
        if because:
            break
    return MutantResult(mutant.name, mutant.rule, killed=False, because=because)


def _at_first(system: System, run: Run, toured: Callable[[], bool]) -> bool:
    """Have the first tour and the scripts, the cheaper of both first: with clocks, tours cost much."""
    return play(run) and toured() if system.spec.abstraction.canonical else toured() and play(run)


@functools.lru_cache(maxsize=2)
def _reference_steps(system: System, choice: tuple[tuple[str, str], ...]) -> ReferenceSteps:
    """The reference under some readings, which successive mutants share.

    Two are kept: that of the default readings, which most mutants follow, and one other.
    """
    return ReferenceSteps(Reference(system, dict(choice)))


def _excuse(system: System, mutant: Mutant, model: Reference, worlds: tuple[JSON, ...]) -> str:
    reference = _reference_steps(system, tuple(sorted(mutant.choice.items())))
    return allowed_under(reference, model, mutant.rule, mutant.favour, mutant.mutate_message, worlds)
