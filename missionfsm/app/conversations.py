"""Several conversations in one file: each is explained or not, and then all of them by one choice of readings."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from attrs import evolve

from missionfsm.kernel.system import System
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.narrate import story_of
from missionfsm.tools.check.verdict import Outcome, Verdict
from missionfsm.tools.conform.contradiction import together

Judgement = tuple[System, str | None, Judge, Verdict]
"""Of one conversation: the system, the robot that it is with, its judge and the verdict."""


def joined(judgements: Iterable[Judgement]) -> list[tuple[str | None, Verdict]]:
    """The verdict for each robot on several conversations with it, which one choice of readings has to explain."""
    found: dict[str | None, list[tuple[System, Judge, Verdict]]] = {}
    for judged, robot, judge, verdict in judgements:
        found.setdefault(robot, []).append((judged, judge, verdict))
    return [(robot, _of_all(some)) for robot, some in found.items()]


def _of_all(found: Sequence[tuple[System, Judge, Verdict]]) -> Verdict:
    """One verdict on several conversations: the first that is bad, or what they come to together."""
    verdicts = [verdict for _, _, verdict in found]
    bad = next((one for one in verdicts if one.outcome is Outcome.VIOLATES), None)
    if bad is not None:
        return bad
    if len({where.name for where, _, _ in found}) > 1:
        return verdicts[-1]
    where, judges = found[-1][0], [judge for _, judge, _ in found]
    whole = _added_up(verdicts)
    violation = together(where, judges)
    if violation is None:
        return whole
    return evolve(whole, outcome=Outcome.VIOLATES, violation=violation, story=story_of(where, violation))


def _added_up(verdicts: Sequence[Verdict]) -> Verdict:
    """What conversations come to of which none is bad."""
    exercised: Counter[str] = Counter()
    for one in verdicts:
        exercised.update(one.exercised)
    return evolve(
        next((one for one in verdicts if one.conforms), verdicts[-1]),
        examples=len(verdicts),
        events=sum(one.events for one in verdicts),
        exercised=dict(exercised),
        uncovered=tuple(rule for rule in verdicts[-1].uncovered if rule not in exercised),
        flagged=tuple(dict.fromkeys(line for one in verdicts for line in one.flagged)),
    )
