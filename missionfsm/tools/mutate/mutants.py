"""The mutants of a system: for every rule, implementations that break just that rule.

They are the reference with one thing changed: a condition is dropped or always true, a code is swapped, an effect is
left out, a message is missing, a value in a message is altered.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer
from missionfsm.kernel.mutations import turned, unshown, without_effect
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
from missionfsm.kernel.subject import Exchange
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import State
from missionfsm.tools.mutate.equivalent import unchanged_message
from missionfsm.tools.reference.model import StepMutator, unchanged_step
from missionfsm.tools.reference.subject import ReferenceSubject

_OTHER_CODES = (FAILED_PRECONDITION, INVALID_ARGUMENT, NOT_FOUND, PERMISSION_DENIED, "OUT_OF_RANGE")


@frozen
class Mutant:
    """An implementation with one rule broken.

    Attributes:
        rule: the id of the rule.
        kind: how it is broken, in words.
        choice: the readings that it follows, so that the rule is in force.
        favour: the operation in which it shows, if it shows in one.
        spec: its specification.
        mutate_step, mutate_message: how it changes steps and messages.
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
        """The implementation, as a subject; `seconds` are its timestamps, see `ReferenceSubject`."""
        return BrokenSubject(
            evolve(system, spec=self.spec), self.choice, self.mutate_step, self.mutate_message, seconds
        )


class BrokenSubject(ReferenceSubject):
    """The reference with a rule broken. What it cannot answer any more, it answers with an empty result.

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


def _reversed(state: State, step: Step) -> Step:
    return turned(state, step) or step
