"""What would explain a line that nothing explains: that the log begins in the middle, or that others use the system."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from attrs import evolve

from missionfsm.app.asked import Asked
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.tools.check.explain import NOBODYS
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.verdict import Violation

JudgeOf = Callable[[Asked], Judge]
"""A new judge of a log, as it is asked to judge it."""


def with_advice(violation: Violation, asked: Asked, lines: Sequence[JSON], judge_of: JudgeOf) -> Violation:
    """The violation, with the option under which its line is explained, where the log looks as if that were true.

    Args:
        violation: the violation.
        asked: how the log was judged.
        lines: the lines of the log without its first, up to the one that nothing explains.
        judge_of: makes a judge; raises UnreadableError where the system cannot be judged so.
    """
    for option, otherwise in _options(violation, asked, lines):
        if _explained(judge_of, otherwise, lines):
            return evolve(violation, notes=(*violation.notes, f"{option} explains this line"))
    return violation


def _options(violation: Violation, asked: Asked, lines: Sequence[JSON]) -> Iterator[tuple[str, Asked]]:
    """What the log looks like: its first message is wrong already, or one shows what nobody in it has asked for."""
    shows = [any(key in line for key in ("message", "line")) for line in lines]
    if shows and shows[-1] and not any(shows[:-1]) and not asked.anywhere:
        yield "if the log begins while the system is in use, --begins anywhere", evolve(asked, anywhere=True)
    if any(note.startswith(NOBODYS) for note in violation.notes) and not asked.others:
        yield "if others use the system as well, --others", evolve(asked, others=True)


def _explained(judge_of: JudgeOf, asked: Asked, lines: Sequence[JSON]) -> bool:
    try:
        judge = judge_of(asked)
    except UnreadableError:
        return False
    return all(judge.feed(line) for line in lines) and judge.verdict().violation is None
