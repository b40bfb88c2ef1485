"""What a violation accuses an implementation of that breaks one rule, and whether that is the rule."""

from __future__ import annotations

import random
from collections.abc import Iterator

from attrs import evolve, frozen
from combinations import Bench

from missionfsm.kernel.rules import Condition, Rule
from missionfsm.kernel.step import Step
from missionfsm.kernel.subject import GibberishError
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import State
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.suspects import with_suspects
from missionfsm.tools.check.verdict import Violation
from missionfsm.tools.conform.handshake import handshake, offered
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.shortening import shorten
from missionfsm.tools.conform.tour import tour
from missionfsm.tools.mutate.mutants import Mutant, mutants
from missionfsm.tools.reference.model import unchanged_step

EXCUSED = {
    "bear.status/SubscribeRobotStatus/INVALID_ARGUMENT/the-location-id-is-empty is dropped": "some reading serves "
    "such a stream, so that what is seen is that nothing comes on it",
    "isaac.server/connection/what-means-nothing-has-no-effect fails what is under way": "a mission that "
    "fails so looks like one that timed out, from which conversations conclude on different readings of when it counts",
    "isaac.robot/line/a-type-id-is-signed sends the type id of a mission": "a line is read as what its type id says, "
    "so that it is a mission without a configuration",
    "isaac.robot/codelet/a-mission-can-follow-another is not run": "that a mission was not run shows when its end is "
    "not reported, long after it came",
    "isaac.robot/codelet/an-unusable-configuration-fails-the-mission is not reported": "as before: the next mission is "
    "run, and what is missing is what has to come before it",
}
"""Mutants whose rule cannot be told from what is seen, each with the reason."""

SHORTENED = ("isaac.robot", "isaac.server")
"""Systems whose violations are made short first: where time passes, a long story has much that is not to the point."""


@frozen
class Accusation:
    """What is said of a mutant: the rules that a violation names, and whether the mutant had no answer at all."""

    mutant: Mutant
    violation: Violation
    speechless: bool

    def is_right(self, system: System) -> bool:
        """Whether the broken rule is named, or one that cannot be told apart from it.

        Of a refusal without a reason nobody can see which of the rows with its code was meant: what is seen is that the
        call was not done, and where another row is due, that it is not given. Of rows that differ in their code alone,
        by reading, any may have been broken. A mutant that could not answer any more breaks more than its rule.
        """
        rules = system.spec.rules_by_id
        own = rules[self.mutant.rule]
        place = self.mutant.rule.split("/")[1]
        beside = [rules[one.id] for one in self.violation.rules if one.id.split("/")[1] == place]
        due = {rule.id for one in self.violation.expected for rule in one.rules if rules[rule.id].code}
        seen = (own.code, None)
        return (
            own.id in [one.id for one in self.violation.rules]
            or (self.mutant.kind == "holds always" and any(one.code in seen or one.id in due for one in beside))
            or any(one.name == own.name for one in beside)
            or self.speechless
            or self.mutant.name in EXCUSED
        )

    def __str__(self) -> str:
        named = ", ".join(one.id.partition("/")[2] for one in self.violation.rules)
        return f"{self.mutant.name}: {self.violation.observed}: {named}: {self.violation.notes[:1]}"


def unneeded(system: System, violation: Violation) -> list[str]:
    """The accused rules that have no part in it, of those that can be told.

    A row of an Errors table has one if it is missed where the page does not say it: something else could have come. Or
    it is what would explain what came, if only it held. A rule about what is done that is named second or third has one
    if what came is explained where the rule may be broken, in one of the ways in which mutants break it.
    """
    if not violation.history:
        return []
    rules = [system.spec.rules_by_id[one.id] for one in violation.rules if one.id in system.spec.rules_by_id]
    rows = [one for one in rules if one.holds is not None]
    found = []
    if "return" in violation.history[-1] and system.spec.follows_operations:
        found = [one.id for one in rows if not _has_a_part(system, violation, one)]
    others = [one for one in rules if one.code is None and one.id in [named.id for named in violation.rules[1:]]]
    return [*found, *(one.id for one in others if not _explains(system, violation, one))]


def _explains(system: System, violation: Violation, rule: Rule) -> bool:
    """Whether all lines are explained where each step that a rule justifies may be one that breaks it."""
    breaks = [one.mutate_step for one in mutants(system) if one.rule == rule.id]
    breaks = [one for one in breaks if one is not unchanged_step]
    begins = [one.id for each in system.spec.operations.values() if each.streaming for one in each.promises]
    if not breaks or rule.id in [*begins, *(one.rule for one in system.message_mutations)]:
        return True  # it is about messages
    spec = system.spec

    def either(state: State, steps: tuple[Step, ...]) -> tuple[Step, ...]:
        wrong = [broken for one in steps for mutate in breaks if (broken := mutate(state, one)) is not None]
        return (*steps, *(one for one in wrong if one.names is None or len(one.names) == spec.names(one.after)))

    drives = {
        name: evolve(one, steps=lambda state, event, refs, one=one: either(state, one.steps(state, event, refs)))
        for name, one in spec.drives.items()
    }
    lenient = evolve(
        spec,
        outcomes=lambda state, request, refs: either(state, spec.outcomes(state, request, refs)),
        drives=drives,
        urgent=lambda state: either(state, spec.urgent(state)),
        spontaneous=lambda state: either(state, spec.spontaneous(state)),
        silent_for=None,
        decided=None,
        rebuilt=None,
        parting=None,
    )
    first, *lines = violation.history
    verdict = check(evolve(system, spec=lenient), head(first), lines)
    return verdict.violation is None


def _has_a_part(system: System, violation: Violation, rule: Rule) -> bool:
    try:
        without = _found(system, violation, rule, lambda _state, _request: False)
        if without is None or (without.at, without.expected) != (violation.at, violation.expected):
            return True
        return _found(system, violation, rule, lambda _state, _request: True) is None
    except (LookupError, AssertionError, AttributeError, TypeError, ValueError):
        return True  # what is refused cannot be done at all


def _found(system: System, violation: Violation, rule: Rule, holds: Condition) -> Violation | None:
    """What is wrong with the same lines if the condition of a row is another one."""
    operations = system.spec.operations
    name = rule.id.split("/")[1]
    changed = tuple(evolve(one, holds=holds) if one.id == rule.id else one for one in operations[name].refusals)
    spec = system.spec.with_operations({**operations, name: evolve(operations[name], refusals=changed)})
    first, *lines = violation.history
    return check(evolve(system, spec=spec), head(first), lines).violation


def accusations(system: System, *, every: int, first: int = 0, conversations: int = 8) -> Iterator[Accusation]:
    """What is said of every so many-th mutant, of those that are found out in a few conversations."""
    bench = Bench.of(system)
    for mutant in list(mutants(system))[first::every]:
        broken = mutant.subject(system)
        try:
            info = handshake(system, broken)
            given = offered(system, info)
            run = Run.with_guide(given, broken, info, bench.automaton, bench.guide.fresh())
            right = tour(run, random.Random(mutant.name), conversations, 40, mutant.favour)
        except GibberishError:
            continue  # what cannot be read is the adapter's failure, no violation
        if right or (run.found is not None and run.found.judge.exhausted):
            continue
        if system.name in SHORTENED:
            shorten(run)
        found = run.found.judge.violation if run.found is not None else run.ledger.inconsistency()
        assert found is not None, mutant.name
        yield Accusation(mutant, with_suspects(system, found), broken.speechless)
