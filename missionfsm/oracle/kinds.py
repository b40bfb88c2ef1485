"""What calls may do that ask for the same and are known to be answered the same: found out once for a whole window.

Where such calls do nothing else than change the state or leave it alone, `missionfsm.oracle.calls` searches for the
order in which they did.
"""

from __future__ import annotations

from collections.abc import Collection

from attrs import define, field

from missionfsm.kernel.history import Answer
from missionfsm.kernel.step import Step
from missionfsm.kernel.terms import Request, State
from missionfsm.kernel.values import value
from missionfsm.oracle.explanation import InFlight, Ready
from missionfsm.oracle.successors import Successors
from missionfsm.oracle.taking import changes

MAX_STATES = 256
"""How many states are looked at to find out which calls never change anything."""


class OtherwiseError(Exception):
    """Something besides calls can happen, or something is assumed: only a search that knows all of it can tell."""


@value
class Effects:
    """What calls of a kind may do in a state.

    Attributes:
        idle: whether they may be answered as they are without effect.
        rules: the rules by which they are answered so.
        steps: the steps that they may take if they are answered as they are.
        ready: all that they could be answered without effect.
    """

    idle: bool
    rules: tuple[str, ...]
    steps: tuple[Step, ...]
    ready: tuple[Ready, ...]


@define(eq=False, slots=True)
class Kind:
    """Calls that ask for the same and are known to be answered the same.

    Attributes:
        request: what they ask for.
        answer: what they are answered; None where that is not known.
        effects: what they may do in a state, as far as that was looked at.
    """

    request: Request
    answer: Answer | None
    effects: dict[State, Effects] = field(factory=dict, repr=False)


def _does_more_than_answer(step: Step) -> bool:
    """Whether a step of a call assumes something, names something or shows something on a channel."""
    return bool(step.assumes or step.names or step.refs or step.emits or step.opens or step.closes)


class Kinds:
    """The kinds of calls of a window.

    Args:
        successors: what the system does.
    """

    def __init__(self, successors: Successors) -> None:
        self.successors = successors
        self._known: dict[tuple[object, ...], Kind] = {}
        self._quiet: set[State] = set()

    def kind(self, request: Request, answer: Answer | None) -> Kind:
        """The one kind of calls that ask for this and are answered so.

        Raises:
            OtherwiseError: they may be answered so whatever the state is.
        """
        key = (request,) if answer is None else (request, answer.code, answer.shape, answer.unordered)
        found = self._known.get(key)
        if found is None:
            if answer is not None and any(self.successors.failures(InFlight(0, request, ()), answer.code)):
                raise OtherwiseError
            found = self._known[key] = Kind(request, answer)
        return found

    def effects(self, state: State, kind: Kind) -> Effects:
        """What calls of a kind may do in a state.

        Raises:
            OtherwiseError: they may do more than change the state.
        """
        found = kind.effects.get(state)
        if found is None:
            found = kind.effects[state] = self._found(state, kind.request, kind.answer)
        return found

    def _found(self, state: State, request: Request, answer: Answer | None) -> Effects:
        successors = self.successors
        self._expect_quiet(state)
        steps, idle, ready = [], [], []
        for step in successors.outcomes(state, request, ()):
            if step.answer is None or _does_more_than_answer(step):
                raise OtherwiseError
            agreements = () if answer is None else successors.agreements(step.answer, answer)
            if agreements and (not step.applied or any(match.assumes for match in agreements)):
                raise OtherwiseError
            if changes(state, step):
                steps += [step] if agreements or answer is None else []
                continue
            ready += [Ready(step.answer, (), (), step.rules)] if step.applied else []
            idle += [step.rules] if agreements else []
        return Effects(bool(idle), idle[0] if idle else (), tuple(steps), tuple(ready))

    def _expect_quiet(self, state: State) -> None:
        """Raises OtherwiseError where something happens in a state by itself."""
        if state not in self._quiet:
            if self.successors.urgent(state) or self.successors.unseen(state):
                raise OtherwiseError
            self._quiet.add(state)

    def ready(self, call: InFlight, kind: Kind) -> Ready | None:
        """What a call could have been answered as it is without effect, at some moment since it was sent."""
        if kind.answer is None:
            return None
        return next((one for one in call.ready if self.successors.agreements(one.answer, kind.answer)), None)

    def changing(self, start: State, kinds: Collection[Kind]) -> frozenset[Kind]:
        """Those kinds of calls that may change some state; all of them where there are too many states to tell."""
        changing: set[Kind] = set()
        seen, todo = {start}, [start]
        while todo:
            state = todo.pop()
            for kind in kinds:
                steps = self.effects(state, kind).steps
                changing.update((kind,) if steps else ())
                later = {step.after for step in steps} - seen
                seen |= later
                todo += later
            if len(seen) > MAX_STATES:
                return frozenset(kinds)
        return frozenset(changing)
