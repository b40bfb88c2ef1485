"""What is wrong with an implementation that follows one reading now and another later."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.spec import Spec
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.phrases import rules_in_words
from missionfsm.tools.check.verdict import Allowed, Side, Violation


def inconsistent(spec: Spec, ambiguity: Ambiguity, evidence: Mapping[str, Judge]) -> Violation:
    """The violation of an implementation of which no reading of an ambiguity is left.

    Args:
        evidence: those of the ambiguity's letters that conversations ruled out, each to the judge of one.
    """
    expected, notes, rules = [], [], list[str]()
    last: Judge | None = None
    shown: dict[int, tuple[Judge, list[str]]] = {}
    for letter, answer in ambiguity.readings.items():
        judge = evidence.get(letter)
        ruling = judge.rulings.found.get((ambiguity.id, letter)) if judge else None
        expected.append(Allowed(f"{ambiguity.id}={letter}: {answer}"))
        if ruling is None:
            notes.append(f"{letter} is ruled out: another reading had to be followed")
            continue
        rules += ruling.rules
        notes.append(f"{letter} is ruled out: {ruling}")
        last = judge
        assert judge is not None, "an event was ruled on by a judge"  # noqa: S101
        shown.setdefault(id(judge), (judge, []))[1].append(f"not {letter}: {ruling}")
    sides = tuple(Side("; ".join(says), judge.history) for judge, says in shown.values())
    return Violation(
        rules_in_words(spec, rules),
        f"{ambiguity.question} The implementation follows no single reading of {ambiguity.id}",
        tuple(expected),
        tuple(notes),
        last.history if last else (),
        sides=sides if len(sides) > 1 else (),
    )
