"""What the oracle noticed of broken implementations, as a page."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen

from missionfsm.kernel.rules import Rule
from missionfsm.kernel.system import System
from missionfsm.pages.render import rendered
from missionfsm.tools.mutate.teeth import MutantResult, MutationReport


@frozen
class Bitten:
    """A rule with what came of every implementation that breaks it."""

    rule: Rule
    results: tuple[tuple[str, MutantResult], ...]

    @property
    def killed(self) -> int:
        """How many were noticed."""
        return sum(result.killed for _, result in self.results)

    @property
    def allowed(self) -> int:
        """How many do nothing that the documents forbid."""
        return sum(bool(result.because) for _, result in self.results)

    @property
    def survived(self) -> int:
        """How many were not noticed though they should have been."""
        return len(self.results) - self.killed - self.allowed

    @property
    def slug(self) -> str:
        """The name that the style sheet knows its standing by."""
        if self.survived or not self.results:
            return "violated"
        return "exercised" if self.killed else "otherwise"


def teeth_page(system: System, teeth: MutationReport, made: str = "") -> str:
    """The page on all mutants of a system."""
    by_rule: dict[str, list[tuple[str, MutantResult]]] = {}
    for result in teeth.results:
        by_rule.setdefault(result.rule, []).append((result.mutant.removeprefix(result.rule).strip(), result))
    topics: dict[str, list[Bitten]] = {}
    for rule in system.spec.all_rules:
        if rule.id in by_rule or rule.id in teeth.untested:
            bitten = Bitten(rule, tuple(by_rule.get(rule.id, ())))
            topics.setdefault(rule.id.split("/")[1], []).append(bitten)
    return rendered("teeth.html", teeth=teeth, spec=system.spec, topics=topics, scores=_scores(topics), made=made)


def _scores(topics: Mapping[str, list[Bitten]]) -> Mapping[str, tuple[int, int]]:
    """Of each topic how many mutants were noticed, and how many break something."""
    return {
        name: (sum(one.killed for one in some), sum(one.killed + one.survived for one in some))
        for name, some in topics.items()
    }
