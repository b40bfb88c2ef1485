"""Judge a live implementation: have conversations with it, make what is found short, say what it all came to."""

from __future__ import annotations

import random
from collections.abc import Callable, Collection, Iterable, Mapping

from attrs import evolve, frozen

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.subject import Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.tools.check.baseline import Baseline, with_stale
from missionfsm.tools.check.basis import NOT_THERE, Untested
from missionfsm.tools.check.eliminations import by_ambiguity
from missionfsm.tools.check.narrate import story_of
from missionfsm.tools.check.scope import flagged_in_all, held_to_the_text, unchecked, uncovered, untested
from missionfsm.tools.check.suspects import with_suspects
from missionfsm.tools.check.verdict import Outcome, Verdict, Violation
from missionfsm.tools.conform.coverage import rare
from missionfsm.tools.conform.distinguish import distinguish as tell_apart
from missionfsm.tools.conform.distinguish import proposed
from missionfsm.tools.conform.drawn import draw
from missionfsm.tools.conform.run import BOUNDS, Run
from missionfsm.tools.conform.shortening import beside_others, shorten, shorten_evidence
from missionfsm.tools.conform.tour import fill, play, some, tour, written
from missionfsm.tools.explore.undriven import Missed, missed_without

DRAWN, TOURS, STEPS = 100, 60, 40
"""Conversations that are drawn, conversations before those that walk where the run has been least, and the calls and
drives in each, at most, unless a run is told otherwise."""

FILLS, LED = 500, 0.4
"""Where a system says what its situations are: conversations that go where it was asked too seldom, at most; and the
part of the tours that is left, since those are led and need not find it."""

AGAIN = 0.6
"""How often what the surroundings did happens once more at once: goal after goal, say."""

EXPERIMENTS, ADVICE = "telling open readings apart", "what would decide open readings and why rules came up seldom"
MISSED = "which rules could not be tested for want of drives"
"""What a run that is stopped may not come to, besides conversations."""

LONGEST_SUSPECTED = 60
"""Lines of a history in which suspects are looked for although the time is up."""

NOT_CARRIED = 'nobody sends this in binary protobuf: an adapter that declares "requests": "binary" is not asked it'
"""What is told where an answer is wrong to a request that only JSON can carry."""


@frozen
class Plan:
    """How many conversations a run has, of each kind.

    Attributes:
        drawn: that Hypothesis draws.
        tours: that walk where the run has been least.
        scripts: of those that the system's alphabet has written down, at most.
        steps: calls and drives in each, at most.
        fills: those that go where it was asked too seldom, at most, in a system that says what its situations are.
    """

    drawn: int = DRAWN
    tours: int = TOURS
    scripts: int = DRAWN + TOURS
    steps: int = STEPS
    fills: int = FILLS

    @classmethod
    def beside(cls, drawn: int, tours: int, steps: int) -> Plan:
        """So many that are drawn and so many tours; of the other kinds no more than fits them."""
        fills = FILLS if tours >= TOURS else tours - round(LED * tours)
        return cls(drawn, tours, drawn + tours, steps, fills)

    @classmethod
    def of(cls, conversations: int | None, steps: int = STEPS) -> Plan:
        """So many conversations in all; where nobody says how many, as many as usual."""
        return cls(steps=steps) if conversations is None else cls.sharing(conversations, steps)

    @classmethod
    def sharing(cls, conversations: int, steps: int = STEPS) -> Plan:
        """So many conversations in all, shared among the kinds as by default."""
        whole = cls()
        total = whole.scripts + whole.tours + whole.drawn
        scripts, drawn = (conversations * part // total for part in (whole.scripts, whole.drawn))
        tours = conversations - scripts - drawn
        return cls(drawn, tours, scripts, steps, tours - round(LED * tours))

    def led(self, system: System) -> tuple[int, int]:
        """How many tours there are of a system, and how many conversations go where it was asked too seldom."""
        return (self.tours, 0) if system.matrix is None else (round(LED * self.tours), self.fills)

    def conversations(self, system: System) -> int:
        """How many there are of a system at most, where nothing is found."""
        alphabets = [system.alphabet(world, BOUNDS) for world in system.alphabet({}, BOUNDS).worlds]
        return len(some(written(alphabets), self.scripts)) + sum(self.led(system)) + self.drawn


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
        drawn, steps, tours: how many conversations to have, see `Plan`; of those that are written down no more
            than of both others together.
        plan: the same, said whole.
        seed: the same seed asks the same of the same implementation.
        readings: readings that the implementation has to follow; the others are found out.
        no_flagged: whether nothing may depart from the letter of the text, nor from itself.
        expected: ids of rules that are known to be broken: such a violation does not end the search, and one that is
            not met any more makes the verdict a bad one.
        only, without: calls that are to be made, and calls and drives that are to be left out.
        distinguish: whether to try at the end what would tell readings apart that are still open.
        advice: whether to think at the end about what the search did not come to: experiments that would tell open
            readings apart, and why some rules came up seldom.
        enough: asked before every step: whether to end here. What was found until then is told.
        progress: told of the run after every conversation.

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
        if distinguish and not _has_found(run):
            tell_apart(run)
            if not enough():
                left.remove(EXPERIMENTS)
    except SubjectError as error:
        if not enough():
            raise
        run.ledger.note(f"the adapter had not answered when it was stopped: {error}")
    verdict = verdict_of(run, seed, known, advice=advice)
    if enough() and not _has_found(run):
        done = f"it was stopped after {run.ledger.examples} of {plan.conversations(run.system)} conversations"
        verdict = evolve(verdict, notes=(*verdict.notes, done + _unreached(verdict, left)))
    return held_to_the_text(verdict) if no_flagged else verdict


def _unreached(verdict: Verdict, left: list[str]) -> str:
    """What a run did not come to whose time was up, in words.

    Args:
        left: what it had yet to do.
    """
    told = [one for one in left if not (one == ADVICE and verdict.rare)]  # the time was up only after that
    if verdict.untested.drives:
        told.append(MISSED)
    return f"; it did not come to {', nor to '.join(told)}" if told else ""


def search(run: Run, plan: Plan, seed: int) -> None:
    """Have all conversations, or until something is found, or no more should be done."""
    chance = random.Random(seed)  # noqa: S311 - no secret
    tours, fills = plan.led(run.system)
    if (
        play(run, plan.scripts)
        and tour(run, chance, tours, plan.steps, repeats=AGAIN)
        and fill(run, chance, fills, plan.steps)
        and plan.drawn
    ):
        draw(run, plan.drawn, plan.steps, seed)


def _has_found(run: Run) -> bool:
    return run.found is not None or run.ledger.contradiction is not None


@frozen
class _Finding:
    """What was found, if anything.

    Attributes:
        followed: of each ambiguity the readings that are left.
        because: why nothing can be said.
    """

    outcome: Outcome
    followed: Mapping[str, tuple[str, ...]]
    violation: Violation | None = None
    because: str = ""


def verdict_of(
    run: Run, seed: int, known: Baseline | None = None, *, advice: bool = True, asks_again: bool = True
) -> Verdict:
    """What a run came to.

    Args:
        known: what was expected of it.
        advice: see `conform`.
        asks_again: whether the implementation is asked again, to make short what was found.
    """
    known, ledger = known or Baseline(), run.ledger
    advised = advice and _went_through(run)
    exercised = run.narrowing.exercised()
    finding = _finding(run, exercised, asks_again=asks_again)
    followed, violation = finding.followed, finding.violation
    spec = run.system.spec
    left_out = uncovered(spec, exercised, followed)
    used = (name for name, codes in ledger.answers.items() if codes)
    went_through = _went_through(run)
    verdict = Verdict(
        finding.outcome,
        run.system.name,
        run.partner.info.name,
        seed=seed,
        examples=ledger.examples,
        events=ledger.events,
        readings=followed,
        exercised=exercised,
        uncovered=left_out,
        violation=violation,
        because=finding.because,
        flagged=(*flagged_in_all(spec, followed, ledger.eliminations, ledger.departing), *ledger.oddities),
        unchecked=unchecked(spec, (*used, *run.partner.info.drives)),
        untested=_untested(run, left_out),
        story=story_of(run.system, violation) if violation else "",
        ruled_out=by_ambiguity(spec.ambiguities, ledger.eliminations),
        experiments=tuple(trial.experiment(run.system) for trial in proposed(run)) if advised else (),
        rare=rare(run.system, exercised, ledger.steps, followed, run.enough) if advised else {},
        known={rule: times for rule, times in known.met.items() if times},
        notes=tuple(ledger.notes),
        advised=advised,
        reach=run.reach.reached() if run.reach is not None and went_through else None,
    )
    # A search that was stopped says nothing of what it did not come to.
    return verdict if run.enough() else with_stale(verdict, known.stale)


def _went_through(run: Run) -> bool:
    """Whether a run neither found anything nor was stopped."""
    return not _has_found(run) and not run.enough()


def _finding(run: Run, exercised: Mapping[str, int], *, asks_again: bool) -> _Finding:
    ledger = run.ledger
    followed, idle = ledger.readings, _idle(run, exercised)
    if idle:
        return _Finding(Outcome.INCONCLUSIVE, followed, because=idle)
    if run.found is not None and run.found.judge.exhausted:
        return _Finding(Outcome.INCONCLUSIVE, followed, because="an event had too many explanations to decide")
    if run.found is not None:
        met = run.found.judge.violation
        if asks_again:
            shorten(run)
        judge = run.found.judge
        assert judge.violation is not None, "what was found was not explained"  # noqa: S101 - shorten keeps it so
        violation = judge.violation
        if len(violation.history) <= LONGEST_SUSPECTED or not run.enough():
            violation = with_suspects(run.system, violation, run.narrowing.asked_for)
        violation = beside_others(run, violation, asks_again=asks_again)
        if _about_what_binary_cannot_carry(run, violation):
            ledger.note(NOT_CARRIED)
        return _Finding(Outcome.VIOLATES, judge.belief.readings, _listed(violation, met))
    if ledger.contradiction is not None:
        met = ledger.inconsistency()
        if asks_again:
            shorten_evidence(run)
        return _Finding(Outcome.VIOLATES, followed, _listed(ledger.inconsistency(), met))
    return _Finding(Outcome.CONFORMS, followed)


def _about_what_binary_cannot_carry(run: Run, violation: Violation) -> bool:
    """Whether the answer that is wrong is one to a request that a robot behind protobuf never gets."""
    answered = violation.history[-1].get("return") if violation.history else None
    calls = [line for line in violation.history if answered is not None and line.get("call") == answered]
    return not run.partner.info.binary and any(
        not run.system.codec.carries(line["method"], line["params"]) for line in calls[-1:]
    )


def _listed(violation: Violation | None, met: Violation | None) -> Violation | None:
    """The violation, with the rules by which what was met first is known, before it was made short."""
    return violation if violation is None or met is None else evolve(violation, listed=met.known_by)


def _untested(run: Run, left_out: Iterable[str]) -> Untested:
    """What the run says nothing of: calls that the adapter does not declare are not there."""
    declared, drives = run.partner.info.methods, run.partner.info.drives
    found = untested(run.system.spec, run.ledger.answers, drives, left_out)
    absent = {} if declared is None else dict.fromkeys(set(found.calls) - set(declared), f"{NOT_THERE}: not declared")
    calls = {name: absent.get(name, why) for name, why in found.calls.items()}
    # Where a robot is in use, nothing is known of the state from which that would be explored.
    known = not run.system.spec.anywhere and not run.enough()
    missed = missed_without(run.system, frozenset(found.drives)) if known else Missed()
    # What is left out for this run was not commanded either, and the robot does not do it by itself.
    commanded = set(drives) - run.without
    missing = tuple(name for name in run.system.spec.drives if name not in commanded)
    return evolve(found, calls=calls, drives=missing, refusals=missed.refusals, promises=missed.promises)


def _idle(run: Run, exercised: Mapping[str, int]) -> str:
    """Why nothing can be said of an implementation that does nothing; empty for one that does something."""
    if not run.system.codec.methods:
        return "" if exercised or _has_found(run) else "nothing was exercised"
    if run.ledger.succeeded or _can_be_called(run):
        return ""
    return "no call had succeeded when it was stopped" if run.enough() else "it refuses every call"


def _can_be_called(run: Run) -> bool:
    """Whether any call but a subscription succeeds in a fresh instance, or nobody can ask any more what was found."""
    world = run.guide.worlds[0]
    try:
        for prompt in run.guide.alphabets[0].core_inputs:
            if run.enough():
                return _has_found(run)
            if prompt.method in run.system.codec.streams or prompt.method in run.partner.absent:
                continue
            run.partner.subject.exchange("reset", {"world": world})
            if run.partner.subject.exchange(prompt.method, prompt.params).error is None:
                return True
    except SubjectError:
        if not _has_found(run):
            raise
        return True
    return False
