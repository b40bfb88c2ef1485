"""What a run came to, as a verdict."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.subject import SubjectError
from missionfsm.tools.check.baseline import Baseline, with_stale
from missionfsm.tools.check.basis import NOT_THERE, Untested
from missionfsm.tools.check.eliminations import Elimination, by_ambiguity
from missionfsm.tools.check.narrate import story, story_of
from missionfsm.tools.check.phrases import described, name_words
from missionfsm.tools.check.scope import flagged_in_all, unchecked, uncovered, untested
from missionfsm.tools.check.suspects import with_suspects
from missionfsm.tools.check.verdict import Outcome, Verdict, Violation
from missionfsm.tools.conform.conversation import Conversation
from missionfsm.tools.conform.coverage import rare
from missionfsm.tools.conform.distinguish import proposed
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.shortening import beside_others, shorten, shorten_evidence
from missionfsm.tools.explore.undriven import Missed, missed_without

LONGEST_SUSPECTED = 60
"""How long a history may be, in lines, for suspects to be looked for although the time is up."""

NOT_CARRIED = 'nobody sends this in binary protobuf: an adapter that declares "requests": "binary" is not asked it'
"""A note on a wrong answer to a request that only JSON can carry."""

ADVICE = "another --seed has other conversations; what an adapter declares as drives does not have to be guessed"
"""What can be done where a conversation could not be decided."""


@frozen
class _Finding:
    """What a run found.

    Attributes:
        outcome: the outcome.
        followed: for each ambiguity, the readings that are left.
        violation: what is wrong, if anything is.
        because: why the outcome is inconclusive.
        undecided: the history that could not be decided, up to the event where that was given up.
    """

    outcome: Outcome
    followed: Mapping[str, tuple[str, ...]]
    violation: Violation | None = None
    because: str = ""
    undecided: tuple[JSON, ...] = ()


def has_found(run: Run) -> bool:
    """Whether a conversation was a violation, or several contradict one another."""
    return run.found is not None or run.ledger.contradiction is not None


def is_complete(run: Run) -> bool:
    """Whether a run had all its conversations: it found nothing and was not stopped."""
    return not has_found(run) and not run.enough()


def verdict_of(
    run: Run, seed: int, known: Baseline | None = None, *, advice: bool = True, asks_again: bool = True
) -> Verdict:
    """The verdict of a run.

    Args:
        run: the run.
        seed: the seed of its conversations.
        known: the violations that were expected.
        advice: see `conform`.
        asks_again: whether the implementation may be asked again, to shorten what was found.
    """
    known, ledger = known or Baseline(), run.ledger
    complete = is_complete(run)
    advised = advice and complete
    exercised = run.narrowing.exercised()
    finding = _finding(run, exercised, asks_again=asks_again)
    followed, violation = finding.followed, finding.violation
    spec = run.system.spec
    left_out = uncovered(spec, exercised, followed)
    used = (name for name, codes in ledger.answers.items() if codes)
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
        story=story_of(run.system, violation) if violation else story(run.system, finding.undecided),
        ruled_out=by_ambiguity(spec.ambiguities, _eliminations(run), followed),
        experiments=tuple(trial.experiment(run.system) for trial in proposed(run)) if advised else (),
        rare=rare(run.system, exercised, ledger.steps, followed, run.enough) if advised else {},
        known={rule: times for rule, times in known.met.items() if times},
        notes=ledger.remarks,
        advised=advised,
        reach=run.reach.reached() if run.reach is not None and complete else None,
    )
    # A run that was stopped cannot say that an expected violation does not occur any more.
    return verdict if run.enough() else with_stale(verdict, known.stale)


def _finding(run: Run, exercised: Mapping[str, int], *, asks_again: bool) -> _Finding:
    ledger = run.ledger
    followed, idle = ledger.readings, _idle(run, exercised)
    if idle:
        return _Finding(Outcome.INCONCLUSIVE, followed, because=idle)
    if run.found is not None and run.found.judge.exhausted:
        return _undecided(run, run.found)
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
        if asks_again:
            _note_what_was_in_vain(run, run.found)
        return _Finding(Outcome.VIOLATES, judge.belief.readings, _listed(violation, met))
    if ledger.contradiction is not None:
        met = ledger.inconsistency()
        if asks_again:
            shorten_evidence(run)
        return _Finding(Outcome.VIOLATES, followed, _listed(ledger.inconsistency(), met))
    return _Finding(Outcome.CONFORMS, followed)


def _undecided(run: Run, found: Conversation) -> _Finding:
    """What is said of a run that ended where one conversation more could not be decided."""
    run.ledger.note(ADVICE)
    because = f"in conversation {run.ledger.examples}, {found.judge.verdict().because}"
    return _Finding(Outcome.INCONCLUSIVE, run.ledger.readings, because=because, undecided=found.judge.history)


def _note_what_was_in_vain(run: Run, found: Conversation) -> None:
    """Say which drives are left in a conversation that was made short though the implementation denied each of them.

    No history has them, so that without this the story would be one that the implementation never plays.
    """
    for heard, event in found.in_vain:
        before = f"before line {heard + 2} of the history"  # its first line is the header
        says = f"the adapter answered the drive of {_drive_words(run, event)} with happened: false {before}"
        run.ledger.note(f"{says}: it should have changed nothing, and is part of what was done to see the violation")


def _drive_words(run: Run, event: JSON) -> str:
    try:
        read, names = run.system.codec.read_drive(event)
    except UnreadableError:
        return str(event["event"])
    about = f" ({', '.join(map(name_words, names))})" if names else ""
    return f"{event['event']}, '{described(run.system.spec, read)}'{about},"


def _eliminations(run: Run) -> Mapping[tuple[str, str], Elimination]:
    """What ruled readings out: in the conversation that was found, if one was, and else in any."""
    known = run.ledger.eliminations
    return known if run.found is None else {**known, **run.found.judge.eliminations.found}


def _about_what_binary_cannot_carry(run: Run, violation: Violation) -> bool:
    """Whether the wrong answer is to a request that a robot behind protobuf never gets."""
    answered = violation.history[-1].get("return") if violation.history else None
    calls = [line for line in violation.history if answered is not None and line.get("call") == answered]
    return not run.partner.info.binary and any(
        not run.system.codec.carries(line["method"], line["params"]) for line in calls[-1:]
    )


def _listed(violation: Violation | None, met: Violation | None) -> Violation | None:
    """The violation, known by the rules of the one that was met first, before it was shortened."""
    return violation if violation is None or met is None else evolve(violation, listed=met.known_by)


def _untested(run: Run, left_out: Iterable[str]) -> Untested:
    """What the run says nothing of. Calls that the adapter does not declare are not there."""
    declared, drives = run.partner.info.methods, run.partner.info.drives
    found = untested(run.system.spec, run.ledger.answers, drives, left_out)
    absent = {} if declared is None else dict.fromkeys(set(found.calls) - set(declared), f"{NOT_THERE}: not declared")
    calls = {name: absent.get(name, why) for name, why in found.calls.items()}
    # What missing drives would have reached is explored from the first state, which is unknown if the robot is in use.
    known = not run.system.spec.anywhere and not run.enough()
    missed = missed_without(run.system, frozenset(found.drives)) if known else Missed()
    # A drive that is left out of this run was not commanded either, and the robot does not do it by itself.
    commanded = set(drives) - run.without
    missing = tuple(name for name in run.system.spec.drives if name not in commanded)
    return evolve(found, calls=calls, drives=missing, refusals=missed.refusals, promises=missed.promises)


def _idle(run: Run, exercised: Mapping[str, int]) -> str:
    """Why nothing can be said of an implementation that does nothing; empty if it does something."""
    if not run.system.codec.methods:
        return "" if exercised or has_found(run) else "nothing was exercised"
    if run.ledger.succeeded or _can_be_called(run):
        return ""
    return "no call had succeeded when it was stopped" if run.enough() else "it refuses every call"


def _can_be_called(run: Run) -> bool:
    """Whether a call other than a subscription succeeds in a fresh instance.

    If the adapter fails, or the time is up, it is whether the run has found something.
    """
    world = run.guide.worlds[0]
    try:
        for prompt in run.guide.alphabets[0].core_inputs:
            if run.enough():
                return has_found(run)
            if prompt.method in run.system.codec.streams or prompt.method in run.partner.absent:
                continue
            run.partner.subject.exchange("reset", {"world": world})
            if run.partner.subject.exchange(prompt.method, prompt.params).error is None:
                return True
    except SubjectError:
        if not has_found(run):
            raise
        return True
    return False
