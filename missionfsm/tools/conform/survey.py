"""Everything that is wrong with an implementation, not only what is found first: the search goes on after each."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen

from missionfsm.kernel.spec import Spec
from missionfsm.kernel.subject import Subject
from missionfsm.kernel.system import System
from missionfsm.tools.check.narrate import story
from missionfsm.tools.check.suspects import with_suspects
from missionfsm.tools.check.verdict import Verdict, Violation
from missionfsm.tools.conform.conform import search
from missionfsm.tools.conform.finding import verdict_of
from missionfsm.tools.conform.plan import Plan
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.shortening import shortened


@frozen
class Finding:
    """A violation with its story, and the places of the specification that it is about: operations and groups of rules.

    One that is about none of them has no places.
    """

    violation: Violation
    story: str
    places: frozenset[str]

    def __str__(self) -> str:
        return "\n\n".join(filter(None, (self.story, self.violation.explanation)))


@frozen
class Survey:
    """What a whole search came to."""

    verdict: Verdict
    findings: tuple[Finding, ...]

    def at(self, place: str) -> tuple[Finding, ...]:
        """What was found about an operation or a group of rules."""
        return tuple(one for one in self.findings if place in one.places)

    def reached(self, place: str) -> bool:
        """Whether any rule of an operation or a group was exercised."""
        return any(place_of(rule) == place for rule, times in self.verdict.exercised.items() if times)


def place_of(rule: str) -> str:
    """The operation or the group that a rule belongs to, by its id."""
    return rule.split("/")[1]


def places(spec: Spec) -> tuple[str, ...]:
    """All operations and groups of rules, in the order of the rules."""
    return tuple(dict.fromkeys(place_of(rule.id) for rule in spec.all_rules))


def survey(
    system: System,
    subject: Subject,
    *,
    plan: Plan = Plan.sharing(120, 30),  # noqa: B008 - a value
    seed: int = 0,
    readings: Mapping[str, str] | None = None,
) -> Survey:
    """Have all conversations, whatever is found; of each kind of violation the first is made short and kept.

    Args:
        plan: how many conversations to have, of which kind.
        seed, readings: as for `missionfsm.tools.conform.conform.conform`.

    Raises:
        SubjectError: the adapter failed.
        ValueError: `readings` names something that does not exist.
    """
    run = Run.against(system, subject, readings)
    findings: dict[frozenset[str], Finding] = {}

    def keep(violation: Violation) -> bool:
        about_places = frozenset(place_of(rule.id) for rule in violation.rules)
        if about_places not in findings:
            findings[about_places] = _finding(run, violation, about_places)
        return True

    run.expects = keep
    search(run, plan, seed)
    return Survey(verdict_of(run, seed, advice=False), tuple(findings.values()))


def _finding(run: Run, violation: Violation, about: frozenset[str]) -> Finding:
    if run.ledger.contradiction is not None or run.last is None:
        return Finding(violation, story(run.system, violation.history), about)
    shown = shortened(run, run.last, known=lambda _: False).judge.violation or violation
    return Finding(with_suspects(run.system, shown, run.narrowing.asked_for), story(run.system, shown.history), about)
