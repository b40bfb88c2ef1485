"""Judge a live implementation: a Hypothesis state machine made from the spec drives it and shrinks what it finds."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from hypothesis import HealthCheck, Phase, Verbosity, settings
from hypothesis import seed as with_seed
from hypothesis import strategies as st
from hypothesis.reporting import with_reporter
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule, run_state_machine_as_test

from missionfsm.kernel.alphabet import ANY_NAME, Alphabet, Bounds, Prompt
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.tools.check.baseline import Expected, held_against
from missionfsm.tools.check.eliminations import by_ambiguity
from missionfsm.tools.check.narrate import story
from missionfsm.tools.check.scope import flagged, held_to_the_text, unchecked, uncovered, untested
from missionfsm.tools.check.suspects import with_suspects
from missionfsm.tools.check.verdict import Outcome, Verdict
from missionfsm.tools.conform.conversation import Conversation, Given, Picks
from missionfsm.tools.conform.coverage import rare
from missionfsm.tools.conform.distinguish import distinguish as tell_apart
from missionfsm.tools.conform.distinguish import proposed
from missionfsm.tools.conform.run import BOUNDS, Run, some
from missionfsm.tools.placeholders import is_template, kind_of, slots

DEFAULT_EXAMPLES = 100
DEFAULT_STEPS = 40
DEFAULT_TOURS = 60
AGAIN = 0.6
"""How often what the surroundings did happens once more at once: goal after goal, say."""

CHOICES = 12
"""Among how many of the least walked edges a guided step draws."""


class _Found(BaseException):
    """Something that cannot be explained: the search is over."""


class _Enough(BaseException):
    """No more is to be done: the search is over."""


class _Broke(BaseException):
    """The adapter failed: the run is over."""

    def __init__(self, error: SubjectError) -> None:
        self.error = error


def conform(  # noqa: PLR0913 - every one has a default
    system: System,
    subject: Subject,
    *,
    examples: int = DEFAULT_EXAMPLES,
    steps: int = DEFAULT_STEPS,
    tours: int = DEFAULT_TOURS,
    seed: int = 0,
    readings: Mapping[str, str] | None = None,
    bounds: Bounds | None = None,
    no_flagged: bool = False,
    expected: Iterable[str] = (),
    distinguish: bool = False,
    advice: bool = True,
    enough: Callable[[], bool] = lambda: False,
    progress: Callable[[Run], None] = lambda _: None,
) -> Verdict:
    """Judge an implementation.

    Args:
        examples: conversations that are drawn, each from a reset on.
        steps: calls and drives in a conversation, at most.
        tours: conversations before those that walk systematically where the run has been least. Before both, at most
            as many are had that the system's alphabet has written down.
        seed: the same seed asks the same of the same implementation.
        readings: readings that the implementation has to follow; the others are found out.
        no_flagged: whether nothing may depart from the letter of the text, nor from itself.
        expected: ids of rules that are known to be broken: such a violation does not end the search, and one that is
            not met any more makes the verdict a bad one.
        distinguish: whether to try at the end what would tell readings apart that are still open.
        advice: whether to think at the end about what the search did not come to: experiments that would tell open
            readings apart, and why some rules came up seldom.
        enough: asked before every step: whether to end the search.
        progress: told of the run after every conversation.

    Raises:
        SubjectError: the adapter failed.
        ValueError: `readings` names something that does not exist.
    """
    known = Expected(expected)
    run = Run.of(
        system,
        subject,
        readings,
        bounds or BOUNDS,
        no_flagged=no_flagged,
        progress=progress,
        expects=known,
        enough=enough,
    )
    ended = search(run, examples, steps, tours, seed)
    if distinguish and ended and run.found is None and run.contradiction is None:
        tell_apart(run)
    notes = () if ended else (f"it was stopped after {run.examples} conversations",)
    verdict = verdict_of(run, seed, known, notes, advice=advice)
    return held_to_the_text(verdict) if no_flagged else verdict


def planned(system: System, examples: int = DEFAULT_EXAMPLES, tours: int = DEFAULT_TOURS) -> int:
    """How many conversations a run has that finds nothing."""
    return len(some(system.alphabet({}, BOUNDS).scripts, examples + tours)) + tours + examples


def search(run: Run, examples: int, steps: int, tours: int, seed: int) -> bool:
    """Have all conversations, or until something is found; False if it was stopped before."""
    machine = with_seed(seed)(_machine(run))
    options = settings(
        max_examples=examples,
        stateful_step_count=steps,
        deadline=None,
        database=None,
        print_blob=False,
        report_multiple_bugs=False,
        verbosity=Verbosity.quiet,
        # What is found is made short by `missionfsm.tools.conform.shrink`, which knows what an action is.
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    if not (run.play(examples + tours) and run.tour(random.Random(seed), tours, steps, again=AGAIN)):  # noqa: S311 - no secret
        return True
    try:
        with with_reporter(lambda _: None), contextlib.suppress(_Found):
            run_state_machine_as_test(machine, settings=options)
    except _Enough:
        return False
    except _Broke as broke:
        raise broke.error from None
    return True


def verdict_of(
    run: Run, seed: int, known: Expected | None = None, notes: tuple[str, ...] = (), *, advice: bool = True
) -> Verdict:
    """What a run came to.

    Args:
        known: what was expected of it.
        notes: what else there is to know of it.
        advice: see `conform`.
    """
    known = known or Expected()
    advice = advice and run.found is None and run.contradiction is None
    outcome, because, violation, followed = Outcome.CONFORMS, "", None, run.readings
    exercised = run.exercised()
    idle = _idle(run, exercised)
    if idle:
        outcome, because = Outcome.INCONCLUSIVE, idle
    elif run.found is not None and run.found.judge.exhausted:
        outcome, because = Outcome.INCONCLUSIVE, "an event had too many explanations to decide"
    elif run.found is not None:
        run.shorten()
        judge = run.found.judge
        assert judge.violation is not None, "what was found was not explained"  # noqa: S101 - shorten keeps it so
        outcome, followed = Outcome.VIOLATES, judge.belief.readings
        violation = with_suspects(run.system, judge.violation)
    elif run.contradiction is not None:
        outcome, violation = Outcome.VIOLATES, run.inconsistency()
    spec = run.system.spec
    left_out = uncovered(spec, exercised, followed)
    used = (name for name, codes in run.answers.items() if codes)
    verdict = Verdict(
        outcome,
        run.system.name,
        run.about.name,
        seed,
        run.examples,
        run.events,
        followed,
        exercised,
        left_out,
        violation,
        because,
        (*flagged(spec, followed, run.rulings), *run.oddities),
        unchecked(spec, (*used, *run.about.drives)),
        untested(spec, run.answers, run.about.drives, left_out),
        story(run.system, violation.history) if violation and run.found is not None else "",
        by_ambiguity(spec.ambiguities, run.rulings),
        tuple(trial.told(run.system) for trial in proposed(run)) if advice and not run.enough() else (),
        rare=rare(run.system, exercised, run.steps, followed) if advice else {},
        known={rule: times for rule, times in known.met.items() if times},
        notes=notes,
    )
    # A search that was stopped says nothing of what it did not come to.
    return verdict if run.enough() else held_against(verdict, known.stale)


def _idle(run: Run, exercised: Mapping[str, int]) -> str:
    """Why nothing can be said of an implementation that does nothing; empty for one that does something."""
    if not run.system.codec.methods:
        silent = run.found is None and run.contradiction is None and not exercised
        return "nothing was exercised" if silent else ""
    return "" if run.succeeded or _can_be_called(run) else "it refuses every call"


def _can_be_called(run: Run) -> bool:
    """Whether any call but a subscription succeeds in a fresh instance."""
    world = run.guide.worlds[0]
    for prompt in run.system.alphabet(world, run.bounds).plain:
        if prompt.method in run.system.codec.streams:
            continue
        run.subject.exchange("reset", {"world": world})
        if run.subject.exchange(prompt.method, prompt.params).error is None:
            return True
    return False


def _machine(run: Run) -> type[RuleBasedStateMachine]:
    """The state machine: a rule for each operation and each drive of the adapter, one to settle, one that is guided."""

    class Machine(RuleBasedStateMachine):
        world: int

        @property
        def conversation(self) -> Conversation:
            assert run.last is not None, "a conversation has begun"  # noqa: S101 - it begins with `start`
            return run.last

        @property
        def alphabet(self) -> Alphabet:
            return run.guide.alphabets[self.world]

        @initialize(world=st.integers(0, len(run.guide.worlds) - 1), watched=st.booleans())
        def start(self, world: int, watched: bool) -> None:  # noqa: FBT001 - drawn
            self.world = world
            with _stopping():
                if run.enough():
                    raise _Enough
                run.start(run.guide.worlds[world])
            streams = run.system.codec.streams
            if watched and len(streams) == 1:
                self.act(streams[0], {})

        def act(self, method: str, params: JSON = None, name: Given | str | None = None, picks: Picks = ()) -> None:
            with _stopping():
                if run.enough():
                    raise _Enough
                if not run.act(method, params, name, picks):
                    raise _Found

        @rule()
        def settle(self) -> None:
            self.act("settle")

        @rule(data=st.data())
        def walk_what_was_walked_least(self, data: st.DataObject) -> None:
            # What is drawn must not depend on other conversations, so the guide does not learn from these.
            proposals = run.guide.proposals(self.conversation, self.world)
            choice = data.draw(st.integers(0, CHOICES - 1))
            if proposals:
                proposal = proposals[choice % len(proposals)]
                with _stopping():
                    if not run.take_up(proposal, counts=False):
                        raise _Found
                if data.draw(st.booleans()):
                    self.act("settle")

        def teardown(self) -> None:
            # Where nothing was begun, what was begun last has been gathered before.
            if hasattr(self, "world") and run.last is not None and (run.over or self.conversation.right):
                self.act("settle")
                if not run.gather():
                    raise _Found

    for method in run.system.codec.methods:
        setattr(Machine, f"call_{method}", _call_rule(method))
    for name in run.about.drives:
        setattr(Machine, f"drive_{name}", _drive_rule(name))
    return Machine


@contextlib.contextmanager
def _stopping() -> Iterator[None]:
    try:
        yield
    except SubjectError as error:
        raise _Broke(error) from None


def _call_rule(method: str) -> Any:  # noqa: ANN401 - a rule of Hypothesis
    def call(self: Any, data: st.DataObject) -> None:  # noqa: ANN401 - the machine
        prompts: list[Prompt] = [one for one in self.alphabet.prompts if one.method == method]
        if not prompts:
            return
        prompt = data.draw(st.sampled_from(prompts))
        name: Given | str | None = None
        if ANY_NAME in repr(prompt.params):
            texts = [given for given, one in self.conversation.given.items() if isinstance(one, str)]
            name = data.draw(st.sampled_from([*reversed(texts), *self.alphabet.wrong_names]))
        self.act(method, prompt.params, name, _picks(self.conversation, prompt.params, data))
        if data.draw(st.booleans()):
            self.act("settle")

    call.__name__ = f"call_{method}"
    return rule(data=st.data())(call)


def _picks(conversation: Conversation, params: JSON, data: st.DataObject) -> Picks:
    """For each slot of params a name of its kind that was given, the latest first, or none."""
    picks = []
    for slot, kind in slots(params).items() if is_template(params) else ():
        known = [given for given, name in conversation.given.items() if kind_of(name) == kind]
        choice = data.draw(st.integers(0, len(known)))
        if choice < len(known):
            picks.append((slot, known[-1 - choice]))
    return tuple(picks)


def _drive_rule(name: str) -> Any:  # noqa: ANN401 - a rule of Hypothesis
    def drive(self: Any, data: st.DataObject) -> None:  # noqa: ANN401 - the machine
        events = [one for one in self.alphabet.drives if one["event"] == name]
        if not events:
            return
        event = data.draw(st.sampled_from(events))
        self.act("drive", event, None, _picks(self.conversation, event, data))
        if data.draw(st.booleans()):
            self.act("settle")

    drive.__name__ = f"drive_{name}"
    return rule(data=st.data())(drive)
