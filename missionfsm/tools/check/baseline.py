"""Violations that are known: they do not fail a run, and one that is not met any more does."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from attrs import evolve

from missionfsm.kernel.spec import Spec
from missionfsm.tools.check.verdict import Outcome, Verdict, Violation


class Baseline:
    """Rules that an implementation is known to break, and how often it was seen to.

    Args:
        rules: their ids. A violation is expected if it breaks any of them.
    """

    def __init__(self, rules: Iterable[str] = ()) -> None:
        self.met = dict.fromkeys(rules, 0)

    def __call__(self, violation: Violation) -> bool:
        """Whether a violation is expected; it counts as met then."""
        broken = [rule.id for rule in violation.rules if rule.id in self.met]
        for rule in broken:
            self.met[rule] += 1
        return bool(broken)

    @property
    def stale(self) -> tuple[str, ...]:
        """The rules that were not broken after all."""
        return tuple(rule for rule, times in self.met.items() if not times)


def with_known(verdict: Verdict, known: Baseline) -> Verdict:
    """The verdict on something in which violations may be known: one whose violation is known is no bad one."""
    if verdict.violation is None or not known(verdict.violation):
        return verdict
    rules = {rule.id: 1 for rule in verdict.violation.rules if rule.id in known.met}
    note = f"{verdict.violation.where}a known violation: {verdict.violation.observed}; what follows was not judged"
    return evolve(verdict, outcome=Outcome.CONFORMS, violation=None, known=rules, notes=(*verdict.notes, note))


def with_stale(verdict: Verdict, stale: tuple[str, ...]) -> Verdict:
    """The verdict with the expectations that were not met: one that is good is inconclusive with any."""
    if not stale or not verdict.conforms:
        return verdict
    because = "a violation that was expected was not met"
    return evolve(verdict, outcome=Outcome.INCONCLUSIVE, because=because, stale=stale)


def read_expected(text: str, specs: Collection[Spec]) -> tuple[str, ...]:
    """The rule ids in a list of known violations: one a line; ``#`` begins a comment.

    Raises:
        ValueError: a line names no rule of any of the systems; the message says which line.
    """
    known = {rule.id for spec in specs for rule in spec.all_rules}
    found: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        rule = line.partition("#")[0].strip()
        if not rule:
            continue
        if rule not in known:
            names = ", ".join(spec.system for spec in specs)
            message = f"{number}: there is no rule {rule!r} in {names}; `missionfsm rules` lists them"
            raise ValueError(message)
        found.append(rule)
    return tuple(dict.fromkeys(found))
