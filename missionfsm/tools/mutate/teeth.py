"""Does the oracle notice? For every rule an implementation that breaks just that rule, judged as any other would be.

The implementations are the reference with one thing changed: a condition dropped or always true, a code swapped, an
effect left out, a message missing, a value in a message altered. One that is judged right is a *survivor*: either what
it does is allowed by the documents under some reading (every conversation within bounds can be explained, which is
shown by exploring it together with the oracle), or the oracle lacks a tooth.
"""

from __future__ import annotations

import functools
import math
import random
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer
from missionfsm.kernel.mutations import unshown, without_effect
from missionfsm.kernel.rules import (
    FAILED_PRECONDITION,
    INVALID_ARGUMENT,
    NOT_FOUND,
    OK,
    PERMISSION_DENIED,
    Operation,
    Rule,
)
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Step
from missionfsm.kernel.subject import Exchange, GibberishError
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import State
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.conform.guide import Guide
from missionfsm.tools.conform.handshake import handshake, offered
from missionfsm.tools.conform.run import BOUNDS, Run
from missionfsm.tools.conform.tour import play, tour
from missionfsm.tools.mutate.equivalent import ReferenceSteps, allowed_under, unchanged_message
from missionfsm.tools.reference.model import Reference, StepMutator, unchanged_step
from missionfsm.tools.reference.subject import ReferenceSubject

FIRST, ROUNDS, STEPS = 16, (64, 64, 64), 40
"""Conversations before it is asked whether an implementation is allowed; after it, until it survives; steps of each."""
BLOCK = 8
"""How many mutants are judged one after the other in the same part: those of a rule share what they remember."""

_OTHER_CODES = (FAILED_PRECONDITION, INVALID_ARGUMENT, NOT_FOUND, PERMISSION_DENIED, "OUT_OF_RANGE")


@frozen
class Mutant:
    """An implementation with one rule broken.

    Attributes:
        rule: the id of the rule; `kind`: how it is broken.
        choice: the readings that it follows, so that the rule is in force.
        favour: the operation in which it shows, if it is one.
    """

    rule: str
    kind: str
    choice: Mapping[str, str]
    favour: str | None
    spec: Spec
    mutate_step: StepMutator = unchanged_step
    mutate_message: Callable[[JSON], JSON] = unchanged_message

    @property
    def name(self) -> str:
        """The rule and how it is broken."""
        return f"{self.rule} {self.kind}"

    def subject(self, system: System, seconds: Callable[[int], float] = float) -> BrokenSubject:
        """The implementation, to be asked; `seconds` are its timestamps, see `ReferenceSubject`."""
        return BrokenSubject(
            evolve(system, spec=self.spec), self.choice, self.mutate_step, self.mutate_message, seconds
        )


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
        """Survivors that nothing excuses."""
        return tuple(result for result in self.results if not result.killed and not result.because)

    @property
    def percent(self) -> int:
        """The score in whole per cent, rounded down: 100 is all and nothing less."""
        return math.floor(100 * self.score)

    @property
    def score(self) -> float:
        """Noticed, of those that break something; 1.0 is all."""
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
        only: part of the names of the mutants to judge; all by default.
        every: of those only every so many-th, from the first on.
        part: which part of them, of how many that go side by side; `joined` puts them together again.
        progress: told of every mutant when it has been judged.
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
    """Every so many-th of the mutants with this in their names, from the first on."""
    return [mutant for mutant in mutants(system) if only in mutant.name][::every]


def joined(system: System, parts: Iterable[MutationReport]) -> MutationReport:
    """What came of all mutants, from what came of each part of them, in the order of the rules."""
    parts = tuple(parts)
    found = {result.mutant: result for part in parts for result in part.results}
    ordered = tuple(found[mutant.name] for mutant in mutants(system) if mutant.name in found)
    return MutationReport(system.name, ordered, parts[0].untested)


class BrokenSubject(ReferenceSubject):
    """The reference with a rule broken: what it cannot answer any more, it answers with nothing.

    Attributes:
        speechless: whether there was anything that it could not answer.
    """

    speechless = False

    def _call(self, method: str, params: JSON) -> Exchange:
        try:
            return super()._call(method, params)
        except (LookupError, AssertionError, AttributeError, TypeError, ValueError, StopIteration):
            self.speechless = True
            return Exchange({})


def _result(system: System, mutant: Mutant, automaton: Automaton, guide: Guide, seed: int) -> MutantResult:
    broken = mutant.subject(system)
    because = ""
    for fresh, conversations in enumerate((FIRST, *ROUNDS)):
        info = handshake(system, broken)
        run = Run.with_guide(offered(system, info), broken, info, automaton, guide.fresh())
        try:
            # Every round is a run of its own: what was walked least in the last one has been walked by now.
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
    """Both the first tour and what is written down, the cheaper one first: with clocks, tours are dear."""
    return play(run) and toured() if system.spec.abstraction.canonical else toured() and play(run)


@functools.lru_cache(maxsize=2)
def _reference_steps(system: System, choice: tuple[tuple[str, str], ...]) -> ReferenceSteps:
    """The reference under some readings; the mutants of a rule follow each other and share it.

    Those with the readings of the reference come again and again, so that it is in nobody's way that two are kept.
    """
    return ReferenceSteps(Reference(system, dict(choice)))


def _excuse(system: System, mutant: Mutant, model: Reference, worlds: tuple[JSON, ...]) -> str:
    reference = _reference_steps(system, tuple(sorted(mutant.choice.items())))
    return allowed_under(reference, model, mutant.rule, mutant.favour, mutant.mutate_message, worlds)


# The mutants.


def mutants(system: System) -> Iterator[Mutant]:
    """Every implementation with one rule broken."""
    spec = system.spec
    for operation in spec.operations.values():
        for rule in operation.refusals:
            yield from _of_refusal(spec, operation, rule, _reaching(system, rule))
        for promised in operation.promises:
            yield from _of_promise(spec, promised, operation.name)
    own = {one.rule for one in system.message_mutations} | {one.rule for one in system.step_mutations if one.at}
    for rule in spec.rules:
        if rule.id not in own:
            yield from _of_promise(spec, rule, None)
    for mutation in system.message_mutations:
        yield Mutant(mutation.rule, mutation.says, {}, None, spec, mutate_message=mutation.mutate_message)
    for one in system.step_mutations:
        yield Mutant(
            one.rule,
            one.says,
            _in_force(spec, one.rule),
            _operation_of(spec, one.rule),
            spec,
            _where(one.at or one.rule, one.mutate_step),
        )


def _reaching(system: System, rule: Rule) -> Mapping[str, str]:
    return system.reaching.get(rule.id) or system.reaching.get(rule.name, {})


def _operation_of(spec: Spec, rule: str) -> str | None:
    name = rule.split("/")[1]
    return name if name in spec.operations else None


def _in_force(spec: Spec, rule_id: str) -> dict[str, str]:
    """A choice of readings under which a rule is in force."""
    rule = spec.rules_by_id.get(rule_id)
    if rule is None or rule.assumes is None or rule.assumes.ambiguity.default in rule.assumes.letters:
        return {}
    return {rule.assumes.ambiguity.id: rule.assumes.letters[0]}


def _of_refusal(spec: Spec, operation: Operation, rule: Rule, reaching: Mapping[str, str]) -> Iterator[Mutant]:
    choice = {**_in_force(spec, rule.id), **reaching}
    code = next(code for code in _OTHER_CODES if code != rule.code)
    if rule.holds is None or not spec.follows_operations:
        # Its condition is in the effect: what can be broken is what is answered.
        yield Mutant(
            rule.id, "is answered with another code", choice, operation.name, spec, _where(rule.id, _coded(code))
        )
        yield Mutant(rule.id, "is dropped", choice, operation.name, spec, _where(rule.id, _coded(OK)))
        return
    for kind, others in (
        ("is dropped", [one for one in operation.refusals if one is not rule]),
        ("holds always", [evolve(one, holds=_always) if one is rule else one for one in operation.refusals]),
        (f"is answered {code}", [evolve(one, code=code) if one is rule else one for one in operation.refusals]),
    ):
        changed = evolve(operation, refusals=tuple(others))
        broken = spec.with_operations({**spec.operations, operation.name: changed})
        yield Mutant(rule.id, kind, choice, operation.name, broken)


def _always(_: object, __: object) -> bool:
    return True


def _of_promise(spec: Spec, rule: Rule, operation: str | None) -> Iterator[Mutant]:
    for kind, mutate_step in (
        ("has no effect", without_effect),
        ("is not shown", unshown),
        ("answers its names in reverse", _reversed),
    ):
        yield Mutant(rule.id, kind, {}, operation, spec, _where(rule.id, mutate_step))


def _where(rule: str, mutate_step: Callable[[Any, Step], Step | None]) -> StepMutator:
    """A mutation of the steps that a rule justifies, and of no others."""
    return lambda state, step: mutate_step(state, step) if step is not None and rule in step.rules else step


def _coded(code: str) -> Callable[[Any, Step], Step]:
    return lambda _, step: evolve(step, answer=Answer(code)) if step.answer is not None else step


def _reversed(_: State, step: Step) -> Step:
    return evolve(step, refs=tuple(reversed(step.refs)))
