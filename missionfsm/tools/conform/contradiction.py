"""What is wrong with an implementation that reads a question differently in different conversations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from attrs import evolve

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Driven, Received
from missionfsm.kernel.readings import UNCONSTRAINED, Ambiguity, meet
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.system import System
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief
from missionfsm.tools.check.eliminations import Elimination
from missionfsm.tools.check.explain import MAX_RULES
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.phrases import rules_in_words
from missionfsm.tools.check.verdict import Allowed, Side, Violation

MAX_KEPT = 1_000_000
"""How many lines of a conversation are kept to be judged again."""

MAX_LED = 1_000
"""How long a conversation may be, in lines, to be judged again without letting events wait."""

Evidence = Mapping[tuple[str, str], Judge]
"""For each ambiguity id and letter that was ruled out, the judge of a conversation that did it."""


def inconsistent(spec: Spec, ambiguity: Ambiguity, evidence: Mapping[str, Judge]) -> Violation:
    """The violation of an implementation that follows no single reading of an ambiguity.

    Args:
        spec: the system.
        ambiguity: the ambiguity.
        evidence: for each letter that was ruled out, the judge of a conversation that did it.
    """
    expected, notes, others, rules = [], [], [], list[str]()
    last: Judge | None = None
    ruled_out: list[tuple[Judge, str, str]] = []
    promised = spec.promised_about(ambiguity)
    for letter, answer in ambiguity.readings.items():
        judge = evidence.get(letter)
        elimination = judge.eliminations.found.get((ambiguity.id, letter)) if judge else None
        expected.append(Allowed(f"{ambiguity.id}={letter}: {answer}"))
        if judge is None or elimination is None:
            others.append(f"{letter} is ruled out: another reading had to be followed")
        else:
            rules += elimination.rules or promised or _exercised(judge, elimination)
            notes.append(f"{letter} is ruled out: {elimination}")
            last = judge
        if judge is not None:
            ruled_out.append((judge, letter, str(elimination or "")))
    sides = _sides(ruled_out)
    return Violation(
        rules_in_words(spec, list(dict.fromkeys(rules))[:MAX_RULES]),
        f"{ambiguity.question} The implementation follows no single reading of {ambiguity.id}",
        tuple(expected),
        # With several conversations, each says what it rules out.
        tuple(others if len(sides) > 1 else [*notes, *others]),
        last.history if last else (),
        sides=sides if len(sides) > 1 else (),
    )


def _sides(ruled_out: Iterable[tuple[Judge, str, str]]) -> tuple[Side, ...]:
    """Each conversation once, with the readings that each of its events rules out."""
    found: dict[int, tuple[Judge, dict[str, list[str]]]] = {}
    for judge, reading, event in ruled_out:
        found.setdefault(id(judge), (judge, {}))[1].setdefault(event, []).append(reading)
    return tuple(
        Side(
            "; ".join(f"not {', '.join(some)}" + (f": {event}" if event else "") for event, some in says.items()),
            judge.history,
        )
        for judge, says in found.values()
    )


def _exercised(judge: Judge, elimination: Elimination) -> tuple[str, ...]:
    """Ids of the rules that an eliminating message or drive exercised."""
    event = elimination.event
    content = event.content if isinstance(event, Received) else event.event if isinstance(event, Driven) else None
    for symbol, edge in elimination.before.next.items() if elimination.before and content is not None else ():
        if symbol[:2] == (type(event), content):
            return judge.automaton.numbers[edge.exercises]
    return ()


def _about(ambiguity: Ambiguity, evidence: Mapping[tuple[str, str], Judge]) -> dict[str, Judge]:
    """For each letter of an ambiguity that was ruled out, the judge of the conversation that did it."""
    return {letter: which for (name, letter), which in evidence.items() if name == ambiguity.id}


def irreconcilable(system: System, judges: Sequence[Judge]) -> Violation | None:
    """The violation of conversations that no choice of readings explains together, although each is explained."""
    judges = [_at_leisure(system, judge) for judge in judges]
    evidence: dict[tuple[str, str], Judge] = {}
    left: dict[str, tuple[str, ...]] = {}
    for judge in judges:
        for ambiguity in system.spec.ambiguities:
            letters = judge.belief.readings.get(ambiguity.id)
            if letters is None:
                continue
            before = left.get(ambiguity.id, tuple(ambiguity.readings))
            evidence.update({(ambiguity.id, one): judge for one in before if one not in letters})
            left[ambiguity.id] = tuple(one for one in before if one in letters)
            if not left[ambiguity.id]:
                return inconsistent(system.spec, ambiguity, _about(ambiguity, evidence))
    for judge in judges:
        again = under(system, judge, left)
        if again.violation is not None:
            needed = essential(system, judge, left)
            return beside(again.violation, needed, {key: one for key, one in evidence.items() if one is not judge})
    return None


def _at_leisure(system: System, judge: Judge) -> Judge:
    """A judge of the same conversation that knows what every event rules out, if that does not cost too much.

    A judge that let events wait found one explanation of them, and did not look for others.
    """
    whole = len(judge.lines) == judge.read
    if not judge.held_back or not whole or judge.read > MAX_LED or not isinstance(judge.belief, Belief):
        return judge
    again = _judged_again(system, judge, judge.automaton.assumed)
    return again if again.right else judge


def under(system: System, judge: Judge, readings: Mapping[str, tuple[str, ...]]) -> Judge:
    """A judge of the same conversation that allows only some readings of each ambiguity."""
    ambiguities = system.spec.ambiguities
    decided = meet(UNCONSTRAINED, (one[readings[one.id]] for one in ambiguities if readings.get(one.id)))
    return _judged_again(system, judge, decided or UNCONSTRAINED)


def _judged_again(system: System, judge: Judge, assumed: int) -> Judge:
    automaton = Automaton(system.spec, judge.head.drives, assumed)
    again = Judge(system, judge.head, automaton, keep=MAX_KEPT, apart=True, waits=False)
    for line in judge.lines:
        if not again.feed(line):
            break
    return again


def essential(system: System, judge: Judge, readings: Mapping[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
    """A smallest part of some readings under which the conversation cannot be explained either."""
    needed = {
        one.id: readings[one.id]
        for one in system.spec.ambiguities
        if readings.get(one.id) and len(readings[one.id]) < len(one.readings)
    }
    size = len(needed)
    while size:
        for names in [list(needed)[at : at + size] for at in range(0, len(needed), size)]:
            fewer = {name: letters for name, letters in needed.items() if name not in names}
            if under(system, judge, fewer).violation is not None:
                needed = fewer
        size //= 2
    return needed


def beside(violation: Violation, needed: Mapping[str, tuple[str, ...]], evidence: Evidence) -> Violation:
    """The violation, beside the conversations that rule out the readings which would explain it."""
    ruled_out: list[tuple[Judge, str, str]] = []
    for (name, letter), judge in evidence.items():
        if name in needed and letter not in needed[name]:
            elimination = judge.eliminations.found.get((name, letter))
            ruled_out.append((judge, f"{name}={letter}", str(elimination or "")))
    sides = _sides(ruled_out)
    if not sides:
        return violation
    return evolve(violation, sides=(*sides, Side(f"and yet {violation.observed}", violation.history)))


def recorded(violation: Violation) -> tuple[JSON, ...]:
    """The lines of a history that shows a violation: its conversations, one after the other.

    Calls are renumbered so that no two have the same number.
    """
    if not violation.sides:
        return violation.history
    lines: list[JSON] = []
    first = 0
    for side in violation.sides:
        numbers = [line["call"] for line in side.history if "call" in line]
        lines += (_renumbered(line, first) for line in side.history)
        first += max(numbers, default=0)
    return tuple(lines)


def _renumbered(line: JSON, first: int) -> JSON:
    return {key: value + first if key in ("call", "return") else value for key, value in line.items()}
