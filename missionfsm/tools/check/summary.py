"""Many verdicts in a few lines: how many conform, what is broken how often and where first, what is flagged."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from attrs import frozen

from missionfsm.tools.check.basis import Flagged
from missionfsm.tools.check.verdict import Outcome, Verdict


@frozen
class Tally:
    """Something that several verdicts say.

    Attributes:
        what: the id of a rule or of a reading.
        times: how many verdicts say it.
        first: where it was said first: the file, the robot if there is one, the line if it is known.
    """

    what: str
    times: int
    first: str


@frozen
class Summary:
    """What many verdicts come to.

    Attributes:
        outcomes: how many there are of each outcome.
        events: how many events were judged altogether.
        broken, flagged: rules that are broken, and readings that are followed though they are flagged; those that
            most verdicts name come first.
        undecided: why verdicts are inconclusive, in the same order.
    """

    outcomes: dict[Outcome, int]
    events: int
    broken: tuple[Tally, ...]
    flagged: tuple[Tally, ...]
    undecided: tuple[Tally, ...]


def summed_up(verdicts: Iterable[tuple[str, str | None, Verdict]]) -> Summary:
    """What verdicts come to, each with its file and its robot."""
    outcomes: Counter[Outcome] = Counter()
    broken: Counter[str] = Counter()
    flagged: Counter[str] = Counter()
    undecided: Counter[str] = Counter()
    first: dict[str, str] = {}
    events = 0
    for path, robot, verdict in verdicts:
        outcomes[verdict.outcome] += 1
        events += verdict.events
        where = path if robot is None else f"{path}, {robot}"
        if verdict.violation is not None:
            at = where if verdict.violation.line is None else f"{where}, line {verdict.violation.line}"
            for rule in dict.fromkeys(rule.id for rule in verdict.violation.rules):
                broken[rule] += 1
                first.setdefault(rule, at)
        if verdict.outcome is Outcome.INCONCLUSIVE:
            undecided[verdict.because] += 1
            first.setdefault(verdict.because, where)
        for reading in dict.fromkeys(map(_reading, verdict.flagged)):
            flagged[reading] += 1
            first.setdefault(reading, where)
    return Summary(
        dict(outcomes), events, _tallied(broken, first), _tallied(flagged, first), _tallied(undecided, first)
    )


def _reading(line: Flagged) -> str:
    """What a flagged line is counted as: the reading that departs, or its first words."""
    return line.reading or line.partition(",")[0]


def _tallied(counted: Counter[str], first: dict[str, str]) -> tuple[Tally, ...]:
    return tuple(Tally(what, times, first[what]) for what, times in counted.most_common())


__all__ = ["Summary", "Tally", "summed_up"]
