"""Judge a live implementation: a Hypothesis state machine made from the spec drives it and shrinks what it finds."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from attrs import define, field
from hypothesis import HealthCheck, Phase, Verbosity, seed as with_seed, settings
from hypothesis import strategies as st
from hypothesis.reporting import with_reporter
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule, run_state_machine_as_test

from missionfsm.kernel.alphabet import ANY_NAME, Alphabet, Bounds, Prompt
from missionfsm.kernel.belief import Automaton
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import constrain
from missionfsm.kernel.subject import Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.tools.check import flagged, uncovered
from missionfsm.tools.conversation import Action, Conversation, Given, Introduced, introduce
from missionfsm.tools.guide import Guide
from missionfsm.tools.shrink import shrink
from missionfsm.tools.verdict import Outcome, Verdict

DEFAULT_EXAMPLES = 100
DEFAULT_STEPS = 40
DEFAULT_TOURS = 60
CHOICES = 12
"""Among how many of the least walked edges a guided step draws."""

SETTLED = 0.6
"""How often a tour waits for everything to settle after a step."""


class _Found(BaseException):  # noqa: N818 - no error of the run: it passes through Hypothesis as an interrupt does
    """A conversation that cannot be explained: the search is over."""


class _Broke(BaseException):  # noqa: N818 - no error of the run: it passes through Hypothesis as an interrupt does
    """The adapter failed: the run is over."""

    def __init__(self, error: SubjectError) -> None:
        self.error = error


@define
class _Run:
    """What one run of `conform` gathers."""

    system: System
    subject: Subject
    about: Introduced
    automaton: Automaton
    bounds: Bounds
    guide: Guide
    progress: Callable[[], None]
    last: Conversation | None = None
    events: int = 0
    examples: int = 0
    readings: dict[str, tuple[str, ...]] = field(factory=dict)
    succeeded: int = 0

    def talk(self, world: JSON) -> Conversation:
        """A new conversation in a world."""
        return Conversation(self.system, self.subject, self.about, world, self.automaton)

    def attempt(self, world: JSON, actions: tuple[Action, ...]) -> Conversation:
        """These actions in a new conversation, until it cannot be explained any more."""
        conversation = self.talk(world)
        for action in actions:
            if not conversation.perform(action):
                break
        return conversation

    def simpler(self, world: JSON, method: str) -> tuple[Prompt, ...]:
        """Prompts that are simple, for calls of a method."""
        return tuple(one for one in self.system.alphabet(world, self.bounds).plain if one.method == method)


def conform(  # noqa: PLR0913 - every one has a default
    system: System,
    subject: Subject,
    *,
    examples: int = DEFAULT_EXAMPLES,
    steps: int = DEFAULT_STEPS,
    tours: int = DEFAULT_TOURS,
    seed: int | None = None,
    readings: Mapping[str, str] | None = None,
    bounds: Bounds | None = None,
    progress: Callable[[], None] = lambda: None,
) -> Verdict:
    """Judge an implementation.

    Args:
        examples: conversations, each from a reset on.
        steps: calls and drives in a conversation, at most.
        tours: conversations before those that walk systematically where the run has been least.
        seed: the same seed asks the same of the same implementation.
        readings: readings that the implementation has to follow; the others are found out.
        progress: called after every conversation.

    Raises:
        SubjectError: the adapter failed.
        ValueError: `readings` names something that does not exist.
    """
    chosen = random.SystemRandom().getrandbits(32) if seed is None else seed
    about = introduce(system, subject)
    automaton = Automaton(system.spec, about.drives, constrain(system.spec.ambiguities, readings or {}))
    bounds = bounds or Bounds(goals=3)
    guide = Guide(system, system.alphabet({}, bounds).worlds, bounds, about.drives)
    run = _Run(system, subject, about, automaton, bounds, guide, progress)
    machine = with_seed(chosen)(_machine(run))
    options = settings(
        max_examples=examples,
        stateful_step_count=steps,
        deadline=None,
        database=None,
        print_blob=False,
        report_multiple_bugs=False,
        verbosity=Verbosity.quiet,
        # What is found is made short by `missionfsm.tools.shrink`, which knows what an action is.
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    try:
        with with_reporter(lambda _: None), contextlib.suppress(_Found):
            _tour(run, random.Random(chosen), tours, steps)
            run_state_machine_as_test(machine, settings=options)
    except _Broke as broke:
        raise broke.error from None
    if run.last and not run.last.judge.exhausted and not run.last.right and _does_anything(run):
        run.last = shrink(run.last, run.attempt, run.simpler)
    return _verdict(run, chosen)


def _tour(run: _Run, draw: random.Random, conversations: int, steps: int) -> None:
    """Systematic conversations: every step walks the edge that was walked least, with the stream watched."""
    streams = run.system.codec.streams
    for number in range(conversations):
        world = number % len(run.guide.worlds)
        with _stopping():
            run.last = run.talk(run.guide.worlds[world])
            opening = [(streams[0], {})] if len(streams) == 1 and number % 4 != 3 else []
            for method, params in opening:
                _act(run, method, params)
            for _ in range(steps):
                proposals = run.guide.proposals(run.last, world)
                if not proposals:
                    break
                best = run.guide.walked[proposals[0].edge]
                equal = [one for one in proposals if run.guide.walked[one.edge] == best]
                proposal = equal[draw.randrange(len(equal))]
                run.guide.note(proposal)
                _act(run, proposal.method, proposal.params, proposal.name)
                if draw.random() < SETTLED:
                    _act(run, "settle")
            _act(run, "settle")
        _gather(run, run.last)
        run.progress()


def _act(run: _Run, method: str, params: JSON = None, name: Given | str | None = None) -> None:
    assert run.last is not None, "a conversation has begun"  # noqa: S101 - whoever calls has begun one
    if not run.last.perform(Action(len(run.last.actions) + 1, method, params, name)):
        _gather(run, run.last)
        raise _Found


def _verdict(run: _Run, chosen: int) -> Verdict:
    judge = run.last.judge if run.last else None
    exercised = run.automaton.exercised
    outcome, because, violation = Outcome.CONFORMS, "", judge.violation if judge and not judge.exhausted else None
    if not _does_anything(run):
        outcome, because, violation = Outcome.INCONCLUSIVE, "it refuses every call", None
    elif violation is not None:
        outcome = Outcome.VIOLATES
    elif judge is not None and judge.exhausted:
        outcome, because = Outcome.INCONCLUSIVE, "an event had too many explanations to decide"
    spec = run.system.spec
    followed = judge.belief.readings if violation and judge else run.readings
    return Verdict(
        outcome,
        run.system.name,
        run.about.name,
        chosen,
        run.examples,
        run.events,
        followed,
        exercised,
        uncovered(spec, exercised, followed),
        violation,
        because,
        flagged(spec, followed),
    )


def _does_anything(run: _Run) -> bool:
    """Whether any call but a subscription succeeds in a fresh instance."""
    if run.succeeded:
        return True
    world = run.guide.worlds[0]
    for prompt in run.system.alphabet(world, run.bounds).plain:
        if prompt.method in run.system.codec.streams:
            continue
        run.subject.exchange("reset", {"world": world})
        if run.subject.exchange(prompt.method, prompt.params).error is None:
            return True
    return False


def _machine(run: _Run) -> type[RuleBasedStateMachine]:
    """The state machine: a rule for each operation and each drive of the adapter, one to settle, one that is guided."""

    class Machine(RuleBasedStateMachine):
        conversation: Conversation
        world: int

        @property
        def alphabet(self) -> Alphabet:
            return run.guide.alphabets[self.world]

        @initialize(world=st.integers(0, len(run.guide.worlds) - 1), watched=st.booleans())
        def start(self, world: int, watched: bool) -> None:  # noqa: FBT001 - drawn
            self.world = world
            with _stopping():
                self.conversation = run.last = run.talk(run.guide.worlds[world])
            streams = run.system.codec.streams
            if watched and len(streams) == 1:
                self.act(streams[0], {})

        def act(self, method: str, params: JSON = None, name: Given | str | None = None) -> None:
            with _stopping():
                _act(run, method, params, name)

        @rule()
        def settle(self) -> None:
            self.act("settle")

        @rule(data=st.data())
        def walk_what_was_walked_least(self, data: st.DataObject) -> None:
            proposals = run.guide.proposals(self.conversation, self.world)
            if proposals:
                proposal = proposals[data.draw(st.integers(0, min(len(proposals), CHOICES) - 1))]
                run.guide.note(proposal)
                self.act(proposal.method, proposal.params, proposal.name)
                if data.draw(st.booleans()):
                    self.act("settle")

        def teardown(self) -> None:
            if hasattr(self, "conversation") and self.conversation.right:
                self.act("settle")
                _gather(run, self.conversation)
                run.progress()

    for method in run.system.codec.methods:
        setattr(Machine, f"call_{method}", _call_rule(method))
    for name in run.about.drives:
        setattr(Machine, f"drive_{name}", _drive_rule(name))
    return Machine


def _gather(run: _Run, done: Conversation) -> None:
    """Add what a conversation came to."""
    run.events += done.judge.events
    run.examples += 1
    run.succeeded += done.succeeded
    if done.right:
        for name, letters in done.judge.belief.readings.items():
            known = run.readings.get(name, letters)
            run.readings[name] = tuple(one for one in known if one in letters)


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
        self.act(method, prompt.params, name)
        if data.draw(st.booleans()):
            self.act("settle")

    call.__name__ = f"call_{method}"
    return rule(data=st.data())(call)


def _drive_rule(name: str) -> Any:  # noqa: ANN401 - a rule of Hypothesis
    def drive(self: Any, data: st.DataObject) -> None:  # noqa: ANN401 - the machine
        events = [one for one in self.alphabet.drives if one["event"] == name]
        if not events:
            return
        self.act("drive", data.draw(st.sampled_from(events)))
        if data.draw(st.booleans()):
            self.act("settle")

    drive.__name__ = f"drive_{name}"
    return rule(data=st.data())(drive)
