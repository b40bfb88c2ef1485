"""Which of the accused rules have a part in a violation: without them it would not have come about."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from attrs import evolve

from missionfsm.kernel.mutations import StepMutator, turned, unshown, without_effect
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.step import Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import State
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.verdict import CitedRule, Violation

Broken = tuple[tuple[str, StepMutator], ...]
"""Ways to break a rule: the id of the rule whose steps are taken wrongly, and how."""


def needed(system: System, violation: Violation, readings: Mapping[str, str] | None = None) -> tuple[CitedRule, ...]:
    """The first rule of a violation, and those of the others that have a part in it.

    A rule has a part in it if everything would be explained by a system that may break the rule. Refusals and rules
    about messages are not put to that test, and stay.
    """
    others = (one for one in violation.rules[1:] if _has_a_part(system, violation, one.id, readings))
    return *violation.rules[:1], *others


def _has_a_part(system: System, violation: Violation, rule: str, readings: Mapping[str, str] | None) -> bool:
    ways = ways_to_break(system, rule)
    if not ways:
        return True
    about, *lines = violation.history
    spec = disregarding(system.spec, ways)
    judge = Judge(evolve(system, spec=spec), head(about), readings=readings, waits=False)
    return all(judge.feed(line) for line in lines)


def ways_to_break(system: System, rule: str) -> Broken:
    """How steps may break a rule; empty for refusals, and for rules about messages that no step mutation breaks.

    A rule that the steps of another rule break, and no step of its own, is not broken by what is left undone.
    """
    broken = [one for one in system.step_mutations if one.rule == rule]
    own = tuple((one.at or rule, one.mutate_step) for one in broken)
    found = system.spec.rules_by_id.get(rule)
    in_messages = any(one.rule == rule for one in system.message_mutations) or _begins_a_stream(system.spec, rule)
    if found is None or found.code or in_messages or any(one.at for one in broken):
        return own
    return *own, (rule, without_effect), (rule, unshown), *([(rule, turned)] if found.names else [])


def _begins_a_stream(spec: Spec, rule: str) -> bool:
    """Whether a rule says how streams begin: what they show first, which no step does."""
    streaming = (one for one in spec.operations.values() if one.streaming)
    return any(one.id == rule for operation in streaming for one in operation.promises)


def disregarding(spec: Spec, ways: Broken) -> Spec:
    """The same system, in which each step may break a rule in any of these ways."""

    def both(state: State, steps: Iterable[Step]) -> tuple[Step, ...]:
        right = tuple(steps)
        wrong = (mutate(state, one) for one in right for at, mutate in ways if at in one.rules)
        return *right, *(one for one in wrong if one is not None and one not in right and _fits(spec, state, one))

    return evolve(
        spec.with_steps(both),
        outcomes=lambda state, request, refs: both(state, spec.outcomes(state, request, refs)),
        parting=None,
        decided=None,
        rebuilt=None,
    )


def _fits(spec: Spec, before: State, step: Step) -> bool:
    """Whether a step names as many things as the state after it has, and mentions no others."""
    there = {*range(spec.names(before)), *(step.names or ()), *(one.ref for one in step.opens)}
    return there.issuperset(step.refs) and (step.names is None or len(step.names) == spec.names(step.after))
