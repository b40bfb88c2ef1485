"""A search through calls alone: where nothing but requests and answers was recorded, and nothing else can happen.

Then an explanation is a state and which of the calls in flight have taken effect. A depth-first search with a memo of
these decides a window as a linearizability checker does: a call takes effect only once an answer asks for it, and what
later answers say is known beforehand. Of calls that are never answered and ask for the same, any stands for all.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable, Iterator, Sequence

from attrs import define, field

from missionfsm.kernel.history import Answer, Called, Returned
from missionfsm.kernel.step import Step
from missionfsm.kernel.terms import State
from missionfsm.oracle.explanation import Explanation, InFlight
from missionfsm.oracle.kinds import Kind, Kinds, OtherwiseError
from missionfsm.oracle.successors import Successors
from missionfsm.oracle.symbols import Symbol

FEW = 12
"""How many explanations an event may cost where it can wait to be explained with others, all of them calls."""

MAX_STATES = 256
"""How many states are looked at to find out which calls never change anything."""

LostCounts = tuple[int, ...]
"""Of each kind of lost calls, how many have not taken effect."""


SENT, ANSWERED, LOST = range(3)
"""What becomes of a call in an event: it is sent, it is answered, it is sent and will never be answered."""

Moment = tuple[int, int, Kind]
"""An event: what becomes of a call, its bit among those in flight (of a lost one the number of its kind), its kind."""

Pending = tuple[tuple[int, Kind], ...]
"""The calls in flight, as they were sent: the bit of each and its kind."""


@define(eq=False, slots=True)
class Standing:
    """Where the search stands before an event that leaves a choice.

    Attributes:
        at: how many events are explained.
        state: that of the system.
        done: the bits of the calls in flight that have taken effect.
        ready: those of the others that could have been answered without effect at some moment since they were sent.
        before: where it stood before the choice that led here.
        since: how many events were explained then.
        by: the bit of the call that has taken effect by that choice, or the kind of a lost one, below 0.
        step: the step that it took.
    """

    at: int
    state: State
    done: int
    ready: int
    lost: LostCounts
    before: Standing | None = field(default=None, repr=False)
    since: int = 0
    by: int = 0
    step: Step | None = None


def are_calls_alone(successors: Successors, symbols: Sequence[Symbol], starts: Sequence[Explanation]) -> bool:
    """Whether a window has calls and answers alone, without a name or a channel."""
    spec = successors.spec
    if spec.anywhere or spec.others or spec.transport or not all(map(is_of_calls_alone, starts)):
        return False
    sent = set.intersection(*({call.name for call in start.calls} for start in starts)) if starts else set()
    for symbol in symbols:
        if symbol[0] is Called:
            if symbol[2]:
                return False
            if not symbol[3]:
                sent.add(symbol[4])
        elif symbol[0] is not Returned or symbol[2] or symbol[3] not in sent:
            return False
    return True


def is_of_calls_alone(start: Explanation) -> bool:
    """Whether an explanation has no name and no channel, so that calls alone may follow it."""
    if start.names or start.channels or start.gone or any(args for _, args, _ in start.lost):
        return False
    if any(call.args or (call.done and call.done.names) for call in start.calls):
        return False
    return not any(ready.assumes or ready.names for call in start.calls for ready in call.ready)


class CallSearch:
    """Looks for an order in which the calls of a window took effect.

    Args:
        kinds: what calls may do.
        symbols: the events; see `are_calls_alone`.
        horizon: how many of them are to be explained.
        start: the explanation of what was before.

    Attributes:
        moments: the events.
        reached: how many of them were explained.

    Raises:
        OtherwiseError: something else can happen after all.
    """

    def __init__(self, kinds: Kinds, symbols: Sequence[Symbol], horizon: int, start: Explanation) -> None:
        self.kinds = kinds
        self.start = start
        self.symbols = symbols[:horizon]
        self.reached = 0
        self.lost: list[Kind] = []
        self.moments: list[Moment] = []
        self._pending: list[Pending] = []
        self.before = self._read()
        met = dict.fromkeys([*(one[-1] for one in self.before), *(one[-1] for one in self.moments), *self.lost])
        self._changing = kinds.changing(start.state, met)

    def _read(self) -> Pending:
        """Tell of each event what becomes of which call, and which calls are in flight before it.

        It gives back those that are before all of them. A call that is answered leaves its bit to another one.
        """
        answers: dict[int, Answer] = {one[3]: one[1] for one in self.symbols if one[0] is Returned}
        lost = dict.fromkeys(request for request, *_ in self.start.lost)
        lost.update(dict.fromkeys(one[1] for one in self.symbols if one[0] is Called and one[3]))
        numbers = {request: number for number, request in enumerate(lost)}
        kind_of, moments = self.kinds.kind, self.moments
        self.lost = [kind_of(request, None) for request in lost]
        flying: dict[int, tuple[int, Kind]] = {}
        free: list[int] = []
        for call in self.start.calls:
            flying[call.name] = 1 << len(flying), kind_of(call.request, answers.get(call.name))
        pending = before = tuple(flying.values())
        for symbol in self.symbols:
            self._pending.append(pending)
            if symbol[0] is Returned:
                bit, kind = flying.pop(symbol[3])
                free.append(bit)
                moments.append((ANSWERED, bit, kind))
            elif symbol[3]:
                number = numbers[symbol[1]]
                moments.append((LOST, number, self.lost[number]))
                continue
            else:
                kind = kind_of(symbol[1], answers.get(symbol[4]))
                bit = free.pop() if free else 1 << len(flying)
                flying[symbol[4]] = bit, kind
                moments.append((SENT, bit, kind))
            pending = tuple(flying.values())
        return before

    def path(self) -> Standing | None:
        """Where the search stands behind all events; None where nothing explains them.

        Raises:
            ExhaustedError: it costs more than the budget.
        """
        if not all(map(self._may_be_answered, self.start.calls, self.before)):
            return None
        forks = [iter((self._first(),))]
        tried: dict[Hashable, list[tuple[int, LostCounts]]] = {}
        spend, end = self.kinds.successors.spend, len(self.moments)
        while forks:
            following = next(forks[-1], None)
            if following is None:
                forks.pop()
                continue
            self._walk(following)
            if following.at == end:
                return following
            spend()
            if not self._outdone(tried, following):
                forks.append(self._forks(following))
        return None

    def _outdone(self, tried: dict[Hashable, list[tuple[int, LostCounts]]], here: Standing) -> bool:
        """Whether it leads nowhere since another at the same point, with as many ways to go on, does not.

        It is noted otherwise.
        """
        key, ready, lost = (here.at, here.state, here.done), here.ready, here.lost
        others = tried.get(key)
        if others is None:
            tried[key] = [(ready, lost)]
            return False
        if any(not ready & ~known and all(map(int.__le__, lost, left)) for known, left in others):
            return True
        others.append((ready, lost))
        return False

    def _may_be_answered(self, call: InFlight, pending: tuple[int, Kind]) -> bool:
        """Whether a call of the start that has taken effect may be answered as it is.

        Raises:
            OtherwiseError: it may be answered without effect as well.
        """
        if call.done is None:
            return True
        _, kind = pending
        if self.kinds.ready(call, kind):
            raise OtherwiseError
        return kind.answer is None or bool(self.kinds.successors.agreements(call.done.answer, kind.answer))

    def _first(self) -> Standing:
        """Where the search stands before all events."""
        done = ready = 0
        for call, (bit, kind) in zip(self.start.calls, self.before, strict=True):
            done |= bit if call.done else 0
            ready |= bit if self.kinds.ready(call, kind) else 0
        ready |= self._noticed(self.start.state, self.before, done | ready)
        left = {request: times for request, _, times in self.start.lost}
        return Standing(0, self.start.state, done, ready, tuple(left.get(kind.request, 0) for kind in self.lost))

    def _noticed(self, state: State, pending: Pending, besides: int) -> int:
        """The bits of those calls that a state lets be answered without effect."""
        effects, noticed = self.kinds.effects, 0
        for bit, kind in pending:
            if not besides & bit and (kind.effects.get(state) or effects(state, kind)).idle:
                noticed |= bit
        return noticed

    def _walk(self, here: Standing) -> None:
        """Go on behind all events that leave no choice."""
        at, state, done, ready = here.at, here.state, here.done, here.ready
        moments, changing, effects, end = self.moments, self._changing, self.kinds.effects, len(self.moments)
        while at < end:
            event, bit, kind = moments[at]
            if event == ANSWERED:
                if not done & bit and (not ready & bit or kind in changing):
                    break
                done, ready = done & ~bit, ready & ~bit
            elif event == LOST:
                here.lost = (*here.lost[:bit], here.lost[bit] + 1, *here.lost[bit + 1 :])
            elif (kind.effects.get(state) or effects(state, kind)).idle:
                ready |= bit
            at += 1
        here.at, here.done, here.ready = at, done, ready
        self.reached = max(self.reached, at)

    def _forks(self, here: Standing) -> Iterator[Standing]:
        """Where it can go on before an answer of a call that has not taken effect; the likeliest first."""
        at, state, done, ready, lost = here.at, here.state, here.done, here.ready, here.lost
        pending, effects = self._pending[at], self.kinds.effects
        _, call, asked = self.moments[at]
        if ready & call:
            yield Standing(at + 1, state, done, ready & ~call, lost, here, at)
        passed = done
        for bit, kind in itertools.chain(((call, asked),), reversed(pending)):
            for step in () if passed & bit else reversed((kind.effects.get(state) or effects(state, kind)).steps):
                taken, left = done | bit, ready & ~bit
                left |= self._noticed(step.after, pending, taken | left)
                yield Standing(at, step.after, taken, left, lost, here, at, bit, step)
            passed |= bit
        for number in reversed([number for number, left in enumerate(lost) if left]):
            kind = self.lost[number]
            for step in reversed((kind.effects.get(state) or effects(state, kind)).steps):
                fewer = (*lost[:number], lost[number] - 1, *lost[number + 1 :])
                more = ready | self._noticed(step.after, pending, done | ready)
                yield Standing(at, step.after, done, more, fewer, here, at, -1 - number, step)


__all__ = ["FEW", "CallSearch", "OtherwiseError", "Standing", "are_calls_alone", "is_of_calls_alone"]
