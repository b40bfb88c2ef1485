"""Judge a live implementation: a Hypothesis state machine made from the spec drives it and shrinks what it finds."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Callable, Mapping
from typing import Any

from attrs import define, field, frozen
from hypothesis import HealthCheck, Phase, Verbosity, seed as with_seed, settings
from hypothesis import strategies as st
from hypothesis.reporting import with_reporter
from hypothesis.stateful import RuleBasedStateMachine, initialize, rule, run_state_machine_as_test

from missionfsm.kernel.alphabet import ANY_NAME, Alphabet, Bounds, Prompt
from missionfsm.kernel.belief import Automaton
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import constrain
from missionfsm.kernel.subject import Exchange, Notification, Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.kernel.transcript import Head
from missionfsm.tools.check import Judge, flagged, uncovered
from missionfsm.tools.verdict import Outcome, Verdict

PROTOCOL = 1
DEFAULT_EXAMPLES = 100
DEFAULT_STEPS = 40


@frozen
class Introduced:
    """What an adapter said of itself."""

    name: str
    drives: tuple[str, ...]


def introduce(system: System, subject: Subject) -> Introduced:
    """Initialize an adapter. Raises SubjectError if what it says is not of the protocol."""
    exchange = subject.exchange("initialize", {"protocolVersion": PROTOCOL, "system": system.name})
    result = exchange.result if isinstance(exchange.result, dict) else {}
    about = result.get("implementation")
    drives = result.get("drives", [])
    if not isinstance(about, dict) or not isinstance(about.get("name"), str):
        message = f"the adapter answered initialize without an implementation name: {exchange.result!r:.80}"
        raise SubjectError(message)
    if not isinstance(drives, list) or not all(isinstance(one, str) for one in drives):
        message = f"the adapter answered initialize with drives {drives!r:.80}"
        raise SubjectError(message)
    known = tuple(one for one in drives if one in system.spec.drives)
    version = about.get("version")
    return Introduced(about["name"] + (f" {version}" if isinstance(version, str) else ""), known)


class Conversation:
    """One conversation with a subject, from a reset on, judged as it goes.

    Args:
        names: told of every name that the subject gave out.
    """

    def __init__(self, system: System, subject: Subject, about: Introduced, world: JSON, automaton: Automaton) -> None:
        self.system = system
        self.subject = subject
        self.judge = Judge(system, Head(system.name, world, about.drives), automaton, keep=100_000)
        self.serial = 0
        self.names: list[str] = []
        self._ask("reset", {"world": world})

    @property
    def right(self) -> bool:
        """Whether everything so far is explained."""
        return self.judge.violation is None and not self.judge.exhausted

    def call(self, method: str, params: JSON) -> None:
        """Make a documented call."""
        self.serial += 1
        number = self.serial
        self._note({"call": number, "method": method, "params": params})
        exchange = self.subject.exchange(method, params)
        self._notifications(exchange.before)
        if exchange.error is None:
            self._note({"return": number, "result": exchange.result})
            self._learn(method, exchange.result)
        else:
            self._note({"return": number, "error": exchange.error})
        self._notifications(exchange.after)

    def drive(self, event: JSON) -> bool:
        """Make something happen; whether it applied."""
        exchange = self._expect_result("drive", event)
        result = exchange.result if isinstance(exchange.result, dict) else {}
        happened = result.get("happened")
        if not isinstance(happened, bool):
            message = f"the adapter answered drive with {exchange.result!r:.80}, not with happened true or false"
            raise SubjectError(message)
        self._notifications(exchange.before)
        if happened:
            self._note({"drive": event})
        self._notifications(exchange.after)
        return happened

    def settle(self) -> None:
        """Wait until all that was caused has been seen."""
        exchange = self._expect_result("settle", {})
        self._notifications(exchange.before)
        self._note({"settled": True})
        self._notifications(exchange.after)

    def _expect_result(self, method: str, params: JSON) -> Exchange:
        exchange = self.subject.exchange(method, params)
        if exchange.error is not None:
            message = f"the adapter answered {method} with {exchange.error.get('status')}"
            raise SubjectError(message)
        return exchange

    def _ask(self, method: str, params: JSON) -> None:
        # What was still under way before a reset belongs to nobody.
        self._expect_result(method, params)

    def _notifications(self, notifications: tuple[Notification, ...]) -> None:
        for one in notifications:
            if one.method == "message":
                self._note({"stream": one.params["stream"], "message": one.params["message"]})
            elif one.method == "closed":
                error = one.params.get("error")
                closed = {"stream": one.params["stream"], "closed": True}
                self._note({**closed, "error": error} if error else closed)
            else:
                self._note({"connection": one.params.get("connection", 1), "line": one.params["line"]})

    def _note(self, line: JSON) -> None:
        if self.right:
            self.judge.feed(line)

    def _learn(self, method: str, result: JSON) -> None:
        _, names = self.system.codec.answer(method, result)
        self.names += (name for name in names if isinstance(name, str) and name not in self.names)


class _ViolatedError(Exception):
    """Something was found; Hypothesis shrinks it."""


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
    worlds: tuple[JSON, ...]
    progress: Callable[[], None]
    last: Conversation | None = None
    events: int = 0
    examples: int = 0
    readings: dict[str, tuple[str, ...]] = field(factory=dict)
    succeeded: int = 0


def conform(  # noqa: PLR0913 - every one has a default
    system: System,
    subject: Subject,
    *,
    examples: int = DEFAULT_EXAMPLES,
    steps: int = DEFAULT_STEPS,
    seed: int | None = None,
    readings: Mapping[str, str] | None = None,
    bounds: Bounds | None = None,
    progress: Callable[[], None] = lambda: None,
) -> Verdict:
    """Judge an implementation.

    Args:
        examples: conversations, each from a reset on.
        steps: calls and drives in a conversation, at most.
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
    worlds = system.alphabet({}, bounds).worlds
    run = _Run(system, subject, about, automaton, bounds, worlds, progress)
    machine = with_seed(chosen)(_machine(run))
    options = settings(
        max_examples=examples,
        stateful_step_count=steps,
        deadline=None,
        database=None,
        print_blob=False,
        report_multiple_bugs=False,
        verbosity=Verbosity.quiet,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
    )
    try:
        with with_reporter(lambda _: None), contextlib.suppress(_ViolatedError):
            run_state_machine_as_test(machine, settings=options)
    except _Broke as broke:
        raise broke.error from None
    return _verdict(run, chosen)


def _verdict(run: _Run, chosen: int) -> Verdict:
    judge = run.last.judge if run.last else None
    exercised = run.automaton.exercised
    outcome, because, violation = Outcome.CONFORMS, "", judge.violation if judge else None
    if violation is not None and not _does_anything(run):
        outcome, because, violation = Outcome.INCONCLUSIVE, "it refuses every call", None
    elif violation is not None:
        outcome = Outcome.VIOLATES
    elif judge is not None and judge.exhausted:
        outcome, because = Outcome.INCONCLUSIVE, "an event had too many explanations to decide"
    elif not run.succeeded:
        outcome, because = Outcome.INCONCLUSIVE, "it refuses every call"
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
        uncovered(spec, exercised),
        violation,
        because,
        flagged(spec, followed),
    )


def _does_anything(run: _Run) -> bool:
    """Whether any call but a subscription succeeds in a fresh instance."""
    if run.succeeded:
        return True
    world = run.worlds[0]
    for prompt in run.system.alphabet(world, run.bounds).plain:
        if prompt.method in run.system.codec.streams:
            continue
        run.subject.exchange("reset", {"world": world})
        if run.subject.exchange(prompt.method, prompt.params).error is None:
            return True
    return False


def _filled(params: JSON, name: str) -> JSON:
    """A prompt's params with a name in place of every `ANY_NAME`."""
    if params == ANY_NAME:
        return name
    if isinstance(params, dict):
        return {key: _filled(value, name) for key, value in params.items()}
    return [_filled(value, name) for value in params] if isinstance(params, list) else params


def _machine(run: _Run) -> type[RuleBasedStateMachine]:
    """The state machine: one rule for each operation, one for each drive that the adapter has, one to settle."""
    alphabets = {index: run.system.alphabet(world, run.bounds) for index, world in enumerate(run.worlds)}

    class Machine(RuleBasedStateMachine):
        conversation: Conversation
        alphabet: Alphabet

        @initialize(world=st.integers(0, len(run.worlds) - 1), watched=st.booleans())
        def start(self, world: int, watched: bool) -> None:  # noqa: FBT001 - drawn
            self.alphabet = alphabets[world]
            with _stopping():
                self.conversation = Conversation(run.system, run.subject, run.about, run.worlds[world], run.automaton)
            run.last = self.conversation
            streams = run.system.codec.streams
            if watched and len(streams) == 1:
                self.act(lambda: self.conversation.call(streams[0], {}))

        def act(self, what: Callable[[], object]) -> None:
            with _stopping():
                what()
            self.judge()

        def judge(self) -> None:
            if not self.conversation.right:
                raise _ViolatedError

        @rule()
        def settle(self) -> None:
            self.act(self.conversation.settle)

        def teardown(self) -> None:
            if not hasattr(self, "conversation"):
                return
            done = self.conversation
            run.events += done.judge.events
            run.examples += 1
            run.succeeded += done.judge.succeeded - _subscriptions(done)
            if done.right:
                self.act(done.settle)
                for name, letters in done.judge.belief.readings.items():
                    known = run.readings.get(name, letters)
                    run.readings[name] = tuple(one for one in known if one in letters)
            run.progress()

    for method in run.system.codec.methods:
        setattr(Machine, f"call_{method}", _call_rule(method))
    for name in run.about.drives:
        setattr(Machine, f"drive_{name}", _drive_rule(name))
    return Machine


def _subscriptions(done: Conversation) -> int:
    return len({channel for channel in done.judge.belief.node.explanations[0].channels}) if done.right else 0


@contextlib.contextmanager
def _stopping() -> Any:  # noqa: ANN401 - a context manager
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
        known = [*reversed(self.conversation.names), *self.alphabet.wrong_names]
        name = data.draw(st.sampled_from(known)) if known else ""
        self.act(lambda: self.conversation.call(method, _filled(prompt.params, name)))
        if data.draw(st.booleans()):
            self.act(self.conversation.settle)

    call.__name__ = f"call_{method}"
    return rule(data=st.data())(call)


def _drive_rule(name: str) -> Any:  # noqa: ANN401 - a rule of Hypothesis
    def drive(self: Any, data: st.DataObject) -> None:  # noqa: ANN401 - the machine
        events = [one for one in self.alphabet.drives if one["event"] == name]
        if not events:
            return
        event = data.draw(st.sampled_from(events))
        self.act(lambda: self.conversation.drive(event))
        if data.draw(st.booleans()):
            self.act(self.conversation.settle)

    drive.__name__ = f"drive_{name}"
    return rule(data=st.data())(drive)
