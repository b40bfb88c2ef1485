"""Judges an implementation in real time, with few conversations: each of them takes long.

The drawing of examples and the shortening of what was found are left to implementations whose time is not real.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping

from missionfsm.kernel.subject import Subject
from missionfsm.kernel.system import System
from missionfsm.tools.check.baseline import Baseline
from missionfsm.tools.check.scope import held_to_the_text
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.finding import verdict_of
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.tour import play, tour


def live(  # noqa: PLR0913 - every one but the first four has a default
    system: System,
    subject: Subject,
    conversations: int,
    steps: int,
    *,
    seed: int = 0,
    readings: Mapping[str, str] | None = None,
    no_flagged: bool = False,
    expected: tuple[str, ...] = (),
    enough: Callable[[], bool] = lambda: False,
    progress: Callable[[Run], None] = lambda _: None,
    notes: tuple[str, ...] = (),
) -> Verdict:
    """Judge an implementation in real time.

    Args:
        system: the system, with what is to be tried on it in real time.
        conversations: how many, those that are written down among them.
        steps: calls and drives in a conversation, at most.
        no_flagged: whether nothing may depart from the letter of the text, nor from itself.
        notes: what is to be said with the verdict.

    Raises:
        SubjectError: the implementation failed.
        ValueError: `readings` names something that does not exist.
    """
    known = Baseline(expected)
    run = Run.against(system, subject, readings, no_flagged=no_flagged, progress=progress, expects=known, enough=enough)
    run.ledger.notes += notes
    if play(run):
        tour(run, random.Random(seed), conversations - run.ledger.examples, steps)  # noqa: S311 - no secret
    verdict = verdict_of(run, seed, known, asks_again=False)
    return held_to_the_text(verdict) if no_flagged else verdict
