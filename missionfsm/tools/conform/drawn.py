"""Conversations that are drawn: a Hypothesis state machine made from the spec.

Hypothesis draws the same again and counts on it that the same can then be drawn. What an implementation has answered is
not the same every time, so what is drawn, and from how much, depends on what was drawn before and on nothing else.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Protocol

from hypothesis import HealthCheck, Phase, Verbosity, settings
from hypothesis import seed as with_seed
from hypothesis import strategies as st
from hypothesis.errors import Flaky
from hypothesis.reporting import with_reporter
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule, run_state_machine_as_test

from missionfsm.kernel.alphabet import ANY_NAME, Input
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import SubjectError
from missionfsm.tools.conform.actions import CANCEL, SETTLE, Bindings, NameRef
from missionfsm.tools.conform.run import Run
from missionfsm.tools.placeholders import is_template, kind_of, slots

CHOICES = 12
"""Among how many of the least walked edges a guided step draws."""
NAMES = 1 << 16
"""From how many numbers a name is drawn, however many names were given."""


class _Talking(Protocol):
    """What the rules need of the machine."""

    world: int

    def do(self, method: str, params: JSON = None, name: NameRef | str | None = None, picks: Bindings = ()) -> None:
        """Call, drive or wait for silence."""


class _Over(BaseException):
    """The search is over: something cannot be explained, or no more is to be done."""


class _Broke(_Over):
    """The adapter failed: the run is over."""

    def __init__(self, error: SubjectError) -> None:
        self.error = error


def draw(run: Run, conversations: int, steps: int, seed: int) -> None:
    """Have conversations that are drawn, until something is found or no more should be done."""
    machine = with_seed(seed)(_machine(run))
    options = settings(
        max_examples=conversations,
        stateful_step_count=steps,
        deadline=None,
        database=None,
        print_blob=False,
        report_multiple_bugs=False,
        verbosity=Verbosity.quiet,
        # What is found is made short by `shrink`, which knows what an action is.
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    if run.enough():
        return
    try:
        with with_reporter(lambda _: None):
            run_state_machine_as_test(machine, settings=options)
    except (_Over, Flaky) as ended:
        # A conversation that is broken off where another that was drawn alike went on is flaky to Hypothesis.
        over = ended if isinstance(ended, _Over) else ended.__context__
        if isinstance(over, _Broke):
            raise over.error from None
        if not isinstance(over, _Over):
            raise


def _machine(run: Run) -> type[RuleBasedStateMachine]:
    """The state machine: a rule for each operation and each drive of the adapter, one to settle, one that is guided."""

    class Machine(RuleBasedStateMachine):
        world: int

        @initialize(world=st.integers(0, len(run.guide.worlds) - 1), watched=st.booleans())
        def start(self, world: int, watched: bool) -> None:  # noqa: FBT001 - drawn
            with _stopping():
                if run.enough():
                    raise _Over
                run.start(run.guide.worlds[world])
            self.world = world
            streams = run.system.codec.streams
            if watched and len(streams) == 1:
                self.do(streams[0], {})

        def do(self, method: str, params: JSON = None, name: NameRef | str | None = None, picks: Bindings = ()) -> None:
            with _stopping():
                if run.enough():
                    raise _Over
                if not run.do(method, params, name, picks):
                    raise _Over

        @rule()
        def settle(self) -> None:
            self.do(SETTLE)

        @rule(data=st.data())
        def walk_what_was_walked_least(self, data: st.DataObject) -> None:
            # What is drawn must not depend on other conversations, so the guide does not learn from these.
            proposals = run.guide.proposals(run.conversation, self.world)
            choice, settles = data.draw(st.integers(0, CHOICES - 1)), data.draw(st.booleans())
            if proposals:
                one = proposals[choice % len(proposals)]
                self.do(one.method, one.params, one.name, one.picks)
                if settles:
                    self.do(SETTLE)

        def teardown(self) -> None:
            # Where nothing was begun, what was begun last has been gathered before.
            if hasattr(self, "world") and (run.over or run.conversation.right) and not run.enough():
                self.do(SETTLE)
                if not run.record():
                    raise _Over

    for method in run.system.codec.methods:
        setattr(Machine, f"call_{method}", _call_rule(run, method))
    for name in run.guide.drives:
        setattr(Machine, f"drive_{name}", _drive_rule(run, name))
    if run.system.codec.streams:
        Machine.give_up_a_stream = _cancel_rule(run)
    return Machine


@contextlib.contextmanager
def _stopping() -> Iterator[None]:
    try:
        yield
    except SubjectError as error:
        raise _Broke(error) from None


def _call_rule(run: Run, method: str) -> object:
    def call(self: _Talking, data: st.DataObject) -> None:
        alphabet = run.guide.alphabets[self.world]
        prompts: list[Input] = [one for one in alphabet.inputs if one.method == method]
        if not prompts:
            return
        prompt = data.draw(st.sampled_from(prompts))
        name: NameRef | str | None = None
        if ANY_NAME in repr(prompt.params):
            texts = [given for given, one in run.conversation.given.items() if isinstance(one, str)]
            names: tuple[JSON, ...] = (*reversed(texts), *alphabet.wrong_names)
            name = names[data.draw(st.integers(0, NAMES)) % len(names)]
        self.do(method, prompt.params, name, _picks(run, prompt.params, data))
        if data.draw(st.booleans()):
            self.do(SETTLE)

    call.__name__ = f"call_{method}"
    return rule(data=st.data())(call)


def _picks(run: Run, params: JSON, data: st.DataObject) -> Bindings:
    """For each slot of params a name of its kind that was given, the latest first, or none."""
    picks = []
    for slot, kind in slots(params).items() if is_template(params) else ():
        known = [given for given, name in run.conversation.given.items() if kind_of(name) == kind]
        choice = data.draw(st.integers(0, NAMES)) % (len(known) + 1)
        if choice < len(known):
            picks.append((slot, known[-1 - choice]))
    return tuple(picks)


def _drive_rule(run: Run, name: str) -> object:
    def drive(self: _Talking, data: st.DataObject) -> None:
        events = [one for one in run.guide.alphabets[self.world].drives if one["event"] == name]
        if not events:
            return
        event = data.draw(st.sampled_from(events))
        self.do("drive", event, None, _picks(run, event, data))
        if data.draw(st.booleans()):
            self.do(SETTLE)

    drive.__name__ = f"drive_{name}"
    return rule(data=st.data())(drive)


def _cancel_rule(run: Run) -> object:
    def give_up_a_stream(self: _Talking, data: st.DataObject) -> None:
        picks = _picks(run, CANCEL.params, data)
        if picks:
            self.do(CANCEL.method, CANCEL.params, None, picks)

    return rule(data=st.data())(give_up_a_stream)
