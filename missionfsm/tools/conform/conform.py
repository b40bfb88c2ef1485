"""Judges a live implementation: has conversations with it, shortens what is found, and says what it all came to."""

from __future__ import annotations

import random
from collections.abc import Callable, Collection, Iterable, Mapping

from attrs import evolve

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.subject import Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.tools.check.baseline import Baseline
from missionfsm.tools.check.scope import held_to_the_text
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.distinguish import distinguish as tell_apart
from missionfsm.tools.conform.drawn import draw
from missionfsm.tools.conform.finding import has_found, verdict_of
from missionfsm.tools.conform.plan import DRAWN, STEPS, TOURS, Plan
from missionfsm.tools.conform.run import BOUNDS, Run
from missionfsm.tools.conform.tour import fill_gaps, play, tour

AGAIN = 0.6
"""How likely a drive is to be repeated at once: goal after goal, say."""

EXPERIMENTS, ADVICE = "telling open readings apart", "what would decide open readings and why rules came up seldom"
MISSED = "which rules could not be tested for want of drives"
"""What a stopped run may not come to besides conversations, in words."""


def conform(  # noqa: PLR0913 - every one has a default
    system: System,
    subject: Subject,
    *,
    drawn: int = DRAWN,
    steps: int = STEPS,
    tours: int = TOURS,
    plan: Plan | None = None,
    seed: int = 0,
    readings: Mapping[str, str] | None = None,
    bounds: Bounds | None = None,
    no_flagged: bool = False,
    expected: Iterable[str] = (),
    only: Collection[str] = (),
    without: Collection[str] = (),
    distinguish: bool = False,
    advice: bool = True,
    enough: Callable[[], bool] = lambda: False,
    progress: Callable[[Run], None] = lambda _: None,
) -> Verdict:
    """Judge an implementation.

    Args:
        system: the system.
        subject: the implementation.
        drawn, steps, tours: how many conversations to have (`Plan.beside`), unless there is a plan.
        plan: how many conversations to have.
        seed: the same seed asks the same of the same implementation.
        readings: readings that the implementation has to follow; the others are found out.
        bounds: how large states may become.
        no_flagged: whether nothing may depart from the letter of the text, and alike questions have to be read alike.
        expected: ids of rules that are known to be broken. Such a violation does not end the search; if it is not met
            any more, the verdict is not good.
        only: the calls to make; all if there are none.
        without: calls and drives to leave out.
        distinguish: whether to try at the end what would tell open readings apart.
        advice: whether to compute at the end which experiments would tell open readings apart, and why some rules came
            up seldom.
        enough: asked before every step: whether to stop. The verdict tells what was found until then.
        progress: given the run after every conversation.

    Raises:
        SubjectError: the adapter failed, and nothing was found before.
        ValueError: `readings` names something that does not exist.
    """
    known = Baseline(expected)
    plan = plan or Plan.beside(drawn, tours, steps)
    run = Run.against(
        system,
        subject,
        readings,
        bounds or BOUNDS,
        no_flagged=no_flagged,
        only=only,
        without=without,
        progress=progress,
        expects=known,
        enough=enough,
    )
    left = [what for what, wanted in ((EXPERIMENTS, distinguish), (ADVICE, advice)) if wanted]
    try:
        search(run, plan, seed)
        if distinguish and not has_found(run):
            tell_apart(run)
            if not run.enough():
                left.remove(EXPERIMENTS)
    except SubjectError as error:
        if not enough():
            raise
        run.ledger.note(f"the adapter had not answered when it was stopped: {error}")
    verdict = verdict_of(run, seed, known, advice=advice)
    if run.enough() and not has_found(run):
        done = f"it was stopped after {run.ledger.examples} of {plan.conversations(run.system)} conversations"
        verdict = evolve(verdict, notes=(*verdict.notes, done + _unreached(verdict, left)))
    return held_to_the_text(verdict) if no_flagged else verdict


def _unreached(verdict: Verdict, left: list[str]) -> str:
    """What a stopped run did not come to, in words.

    Args:
        verdict: its verdict.
        left: what it still had to do.
    """
    told = [one for one in left if not (one == ADVICE and verdict.rare)]  # it was stopped only after that
    if verdict.untested.drives:
        told.append(MISSED)
    return f"; it did not come to {', nor to '.join(told)}" if told else ""


def search(run: Run, plan: Plan, seed: int) -> None:
    """Have all conversations of a plan, or until something is found, or the run is to stop."""
    chance = random.Random(seed)  # noqa: S311 - no secret
    tours, fills = plan.led(run.system)
    if (
        play(run, plan.scripts)
        and tour(run, chance, tours, plan.steps, repeats=AGAIN)
        and fill_gaps(run, chance, fills, plan.steps)
        and plan.drawn
    ):
        draw(run, plan.drawn, plan.steps, seed)
