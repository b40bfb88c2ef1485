"""Several conversations in one file: each has to be explained, and all of them by one choice of readings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from attrs import evolve

from missionfsm.app.asked import judged_system
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.basis import NOT_TRIED
from missionfsm.tools.check.judge import MAX_LINES, Judge
from missionfsm.tools.check.narrate import story_of
from missionfsm.tools.check.verdict import Outcome, Verdict, Violation
from missionfsm.tools.conform.contradiction import MAX_KEPT, irreconcilable

Judgement = tuple[System, str | None, Judge, Verdict]
"""Of one conversation: the system, the robot that it is with, its judge and the verdict."""


class Conversations:
    """Judges one conversation after the other as their lines come: a first line begins the next one.

    The first conversation may last for days, so not all of its lines are kept. If others follow, it is judged together
    with them only if it was short.

    Args:
        readings: the readings to assume.
    """

    def __init__(self, readings: Mapping[str, str]) -> None:
        self._readings = readings
        self._judges: list[tuple[System, Judge]] = []
        self._before = self._heads = 0

    @property
    def read(self) -> int:
        """How many lines were taken into account."""
        return self._before + (self._judges[-1][1].read if self._judges else 0)

    def feed(self, line: JSON) -> bool:
        """Take a line into account. False once the verdict is known. Raises UnreadableError."""
        if not isinstance(line, dict) or "missionfsm" not in line:
            return self._judges[-1][1].feed(line)
        first = head(line)
        of = judged_system(first.system, strict=first.strict, anywhere=first.anywhere, others=first.others)
        automaton = None
        if self._judges:
            system, judge = self._judges[-1]
            right = judge.verdict().violation is None
            self._before += judge.read
            if not judge.read:
                self._judges.pop()
            elif not right:
                return False
            if system is of and judge.head.drives == first.drives:
                automaton = judge.automaton
        keep = MAX_KEPT if self._heads else MAX_LINES
        self._heads += 1
        self._judges.append((of, Judge(of, first, automaton, readings=self._readings, keep=keep, apart=True)))
        return True

    @property
    def violation(self) -> Violation | None:
        """What is wrong with the last conversation."""
        return self._judges[-1][1].violation

    def verdict(self) -> Verdict:
        """The verdict on all of them."""
        found = [(of, judge, judge.verdict()) for of, judge in self._judges]
        whole = [one for one in found if one[1].read <= (one[1].lines.maxlen or 0)] or found
        bad = [one for one in found if one[2].violation is not None]
        return _of_all(bad or whole) if len(found) > 1 else found[0][2]


def verdicts_by_robot(judgements: Iterable[Judgement]) -> list[tuple[str | None, Verdict]]:
    """The verdict for each robot on several conversations with it, which one choice of readings has to explain."""
    found: dict[str | None, list[tuple[System, Judge, Verdict]]] = {}
    for judged, robot, judge, verdict in judgements:
        found.setdefault(robot, []).append((judged, judge, verdict))
    return [(robot, _of_all(some)) for robot, some in found.items()]


def _of_all(found: Sequence[tuple[System, Judge, Verdict]]) -> Verdict:
    """One verdict on several conversations: that on the first one with a violation, or on all of them together."""
    verdicts = [verdict for _, _, verdict in found]
    bad = next((one for one in verdicts if one.outcome is Outcome.VIOLATES), None)
    if bad is not None:
        return bad
    if len({where.name for where, _, _ in found}) > 1:
        return verdicts[-1]
    where, judges = found[-1][0], [judge for _, judge, _ in found]
    undecided = next((verdict for _, judge, verdict in found if judge.exhausted), None)
    whole = _added_up(verdicts, undecided)
    violation = irreconcilable(where, judges)
    if violation is None:
        return whole
    return evolve(whole, outcome=Outcome.VIOLATES, violation=violation, story=story_of(where, violation))


def _added_up(verdicts: Sequence[Verdict], undecided: Verdict | None) -> Verdict:
    """The sum of verdicts without violations; if one is undecided, so is the sum."""
    exercised: Counter[str] = Counter()
    for one in verdicts:
        exercised.update(one.exercised)
    basis = undecided or next((one for one in verdicts if one.conforms), verdicts[-1])
    ruled_out: dict[str, Mapping[str, str]] = {}
    for one in verdicts:
        ruled_out |= {name: {**events, **ruled_out.get(name, {})} for name, events in one.ruled_out.items()}
    untested = evolve(
        basis.untested,
        calls=_in_all([one.untested.calls for one in verdicts]),
        rules=_in_all([one.untested.rules for one in verdicts]),
    )
    return evolve(
        basis,
        readings=_readings_of_all(verdicts),
        ruled_out=ruled_out,
        untested=untested,
        examples=len(verdicts),
        events=sum(one.events for one in verdicts),
        exercised=dict(exercised),
        uncovered=tuple(rule for rule in verdicts[-1].uncovered if rule not in exercised),
        flagged=tuple(dict.fromkeys(line for one in verdicts for line in one.flagged)),
    )


def _readings_of_all(verdicts: Sequence[Verdict]) -> dict[str, tuple[str, ...]]:
    """For each ambiguity that mattered somewhere, the readings that all conversations follow in which it did."""
    readings: dict[str, tuple[str, ...]] = {}
    for one in verdicts:
        for name, letters in one.readings.items():
            readings[name] = tuple(letter for letter in readings.get(name, letters) if letter in letters)
    return readings


def _in_all(found: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """What every conversation leaves out, with the reason that says most; that it was not tried says least."""
    common = [name for name in found[0] if all(name in one for one in found)]
    reasons = {name: [one[name] for one in found] for name in common}
    return {name: next((why for why in some if NOT_TRIED not in why), some[0]) for name, some in reasons.items()}
