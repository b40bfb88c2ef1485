"""A search through calls alone: where nothing but requests and answers was recorded, and nothing else can happen.

Then an explanation is a state and which of the calls in flight have taken effect. A depth-first search with a memo of
these decides a window as a linearizability checker does: a call takes effect only once an answer asks for it, and what
later answers say is known beforehand. Of calls that are never answered and ask for the same, any stands for all.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence

from attrs import define, field, frozen

from missionfsm.kernel.history import Answer, Called, Returned
from missionfsm.kernel.step import Step
from missionfsm.kernel.terms import Request, State
from missionfsm.oracle.explanation import Explanation, InFlight, Ready, with_lost, without_lost
from missionfsm.oracle.successors import Successors
from missionfsm.oracle.symbols import Symbol
from missionfsm.oracle.taking import changes

FEW = 20
"""How many explanations an event may cost where it can wait to be explained with others, all of them calls."""

MAX_STATES = 256
"""How many states are looked at to find out which calls never change anything."""

LostCounts = tuple[int, ...]
"""Of each kind of lost calls, how many have not taken effect."""


class OtherwiseError(Exception):
    """Something besides calls can happen, or something is assumed: only a search that knows all of it can tell."""


@frozen
class Effects:
    """What calls of a kind may do in a state: whether they may be answered without effect, and the steps they take."""

    idle: bool
    steps: tuple[Step, ...]


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


@define(eq=False, slots=True)
class Standing:
    """Where the search stands before an event.

    Attributes:
        at: how many events are explained.
        state: that of the system.
        done: the bits of the calls in flight that have taken effect.
        ready: those of the others that could have been answered without effect at some moment since they were sent.
        by: the call that has taken effect last since the node before, or the kind of a lost one, below 0.
        step: the step that it took.
    """

    at: int
    state: State
    done: int
    ready: int
    lost: LostCounts
    before: Standing | None = field(default=None, repr=False)
    by: int = 0
    step: Step | None = None


def are_calls_alone(successors: Successors, symbols: Sequence[Symbol], starts: Sequence[Explanation]) -> bool:
    """Whether a window has calls and answers alone, without a name or a channel."""
    spec = successors.spec
    if spec.anywhere or spec.others or spec.transport or not all(map(is_of_calls_alone, starts)):
        return False
    sent = set.intersection(*({call.name for call in start.calls} for start in starts)) if starts else set()
    for kind, *what in symbols:
        if kind not in (Called, Returned) or what[1] or (kind is Returned and what[2] not in sent):
            return False
        if kind is Called and not what[2]:
            sent.add(what[3])
    return True


def is_of_calls_alone(start: Explanation) -> bool:
    """Whether an explanation has no name and no channel, so that calls alone may follow it."""
    if start.names or start.channels or start.gone or any(args for _, args, _ in start.lost):
        return False
    if any(call.args or (call.done and call.done.names) for call in start.calls):
        return False
    return not any(ready.assumes or ready.names for call in start.calls for ready in call.ready)


def _does_more_than_answer(step: Step) -> bool:
    """Whether a step of a call assumes something, names something or shows something on a channel."""
    return bool(step.assumes or step.names or step.refs or step.emits or step.opens or step.closes)


class CallSearch:
    """Looks for an order in which the calls of a window took effect.

    Args:
        successors: what the system does.
        symbols: the events; see `are_calls_alone`.
        horizon: how many of them are to be explained.
        start: the explanation of what was before.

    Attributes:
        reached: how many events were explained.

    Raises:
        OtherwiseError: something else can happen after all.
    """

    def __init__(self, successors: Successors, symbols: Sequence[Symbol], horizon: int, start: Explanation) -> None:
        self._successors = successors
        self._symbols = symbols[:horizon]
        self._start = start
        self.reached = 0
        answers: dict[int, Answer] = {what[2]: what[0] for kind, *what in self._symbols if kind is Returned}
        self._place: dict[int, int] = {}
        self._kinds: list[Kind] = []
        self._known: dict[tuple[Request, Answer | None], Kind] = {}
        for call in start.calls:
            self._add(call.name, call.request, answers.get(call.name))
        for kind, *what in self._symbols:
            if kind is Called and not what[2]:
                self._add(what[3], what[0], answers.get(what[3]))
        lost = [request for request, *_ in start.lost]
        lost += [what[0] for kind, *what in self._symbols if kind is Called and what[2]]
        self._lost = [self._kind(request, None) for request in dict.fromkeys(lost)]
        self._pending = self._pending_before()
        self._changing = self._kinds_that_change()

    def _add(self, name: int, request: Request, answer: Answer | None) -> None:
        if answer is not None and any(self._successors.failures(InFlight(name, request, ()), answer.code)):
            raise OtherwiseError
        self._place[name] = len(self._kinds)
        self._kinds.append(self._kind(request, answer))

    def _kind(self, request: Request, answer: Answer | None) -> Kind:
        """The one kind of calls that ask for this and are answered so."""
        key = request, answer
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = Kind(request, answer)
        return found

    def _pending_before(self) -> list[tuple[int, ...]]:
        """Of each event, and of the end, the places of the calls that are in flight before it."""
        pending = [self._place[call.name] for call in self._start.calls]
        found = [tuple(pending)]
        for kind, *what in self._symbols:
            if kind is Returned:
                pending.remove(self._place[what[2]])
            elif not what[2]:
                pending.append(self._place[what[3]])
            found.append(tuple(pending))
        return found

    def effects(self, state: State, kind: Kind) -> Effects:
        """What calls of a kind may do in a state."""
        found = kind.effects.get(state)
        if found is None:
            found = kind.effects[state] = self._found(state, kind.request, kind.answer)
        return found

    def _found(self, state: State, request: Request, answer: Answer | None) -> Effects:
        successors = self._successors
        if successors.urgent(state) or successors.unseen(state):
            raise OtherwiseError
        idle, steps = False, []
        for step in successors.outcomes(state, request, ()):
            if step.answer is None or _does_more_than_answer(step):
                raise OtherwiseError
            agreements = () if answer is None else successors.agreements(step.answer, answer)
            if any(match.assumes for match in agreements) or (agreements and not step.applied):
                raise OtherwiseError
            if changes(state, step) and (agreements or answer is None):
                steps.append(step)
            elif agreements:
                idle = True
        return Effects(idle, tuple(steps))

    def _kinds_that_change(self) -> frozenset[Kind]:
        """The kinds of calls that may change some state; all of them where there are too many states to tell."""
        kinds = dict.fromkeys((*self._kinds, *self._lost))
        changing: set[Kind] = set()
        seen = {self._start.state}
        todo = [self._start.state]
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

    def path(self) -> Standing | None:
        """Where the search stands behind all events; None where nothing explains them.

        Raises:
            ExhaustedError: it costs more than the budget.
        """
        if not all(map(self._may_be_answered, self._start.calls)):
            return None
        forks = [iter((self._noticing(self._first()),))]
        tried: dict[Hashable, list[tuple[int, LostCounts]]] = {}
        while forks:
            following = next(forks[-1], None)
            if following is None:
                forks.pop()
                continue
            here = self._walked(following)
            if here.at == len(self._symbols):
                return here
            self._successors.spend()
            others = tried.setdefault((here.at, here.state, here.done), [])
            if any(not here.ready & ~ready and all(map(int.__le__, here.lost, lost)) for ready, lost in others):
                continue
            others.append((here.ready, here.lost))
            forks.append(self._forks(here))
        return None

    def _may_be_answered(self, call: InFlight) -> bool:
        """Whether a call of the start that has taken effect may be answered as it is.

        Raises:
            OtherwiseError: it may be answered without effect as well.
        """
        if call.done is None:
            return True
        if self._is_ready(call):
            raise OtherwiseError
        answer = self._kinds[self._place[call.name]].answer
        return answer is None or bool(self._successors.agreements(call.done.answer, answer))

    def _first(self) -> Standing:
        """Where the search stands before all events."""
        start, place = self._start, self._place
        done = sum(1 << place[call.name] for call in start.calls if call.done)
        ready = sum(1 << place[call.name] for call in start.calls if self._is_ready(call))
        lost = {request: times for request, _, times in start.lost}
        return Standing(0, start.state, done, ready, tuple(lost.get(kind.request, 0) for kind in self._lost))

    def _is_ready(self, call: InFlight) -> bool:
        """Whether a call of the start could have been answered as it is, without effect, before the start."""
        answer = self._kinds[self._place[call.name]].answer
        return answer is not None and any(self._successors.agreements(one.answer, answer) for one in call.ready)

    def _noticing(self, node: Standing) -> Standing:
        """The node with those calls ready that the state lets be answered without effect."""
        state, kinds = node.state, self._kinds
        for place in self._pending[node.at]:
            bit = 1 << place
            if not (node.done | node.ready) & bit and self.effects(state, kinds[place]).idle:
                node.ready |= bit
        return node

    def _walked(self, node: Standing) -> Standing:
        """The node behind all events that leave no choice."""
        at, state, done, ready, lost = node.at, node.state, node.done, node.ready, node.lost
        while at < len(self._symbols):
            kind, *what = self._symbols[at]
            if kind is Returned:
                bit = 1 << self._place[what[2]]
                if not done & bit and (not ready & bit or self._kinds[self._place[what[2]]] in self._changing):
                    break
                done, ready = done & ~bit, ready & ~bit
            elif what[2]:
                number = self._lost.index(self._kind(what[0], None))
                lost = (*lost[:number], lost[number] + 1, *lost[number + 1 :])
            elif self.effects(state, self._kinds[self._place[what[3]]]).idle:
                ready |= 1 << self._place[what[3]]
            at += 1
        self.reached = max(self.reached, at)
        return node if at == node.at else Standing(at, state, done, ready, lost, node, 0)

    def _forks(self, node: Standing) -> Iterator[Standing]:
        """Where it can go on before an answer of a call that has not taken effect; the likeliest first."""
        state, done, ready, lost = node.state, node.done, node.ready, node.lost
        call = self._place[self._symbols[node.at][3]]
        if ready & 1 << call:
            yield Standing(node.at + 1, state, done, ready & ~(1 << call), lost, node)
        for place in (call, *(one for one in reversed(self._pending[node.at]) if one != call)):
            own = 1 << place
            for step in () if done & own else reversed(self.effects(state, self._kinds[place]).steps):
                yield self._noticing(Standing(node.at, step.after, done | own, ready & ~own, lost, node, place, step))
        for number in reversed(range(len(lost))):
            left = (*lost[:number], lost[number] - 1, *lost[number + 1 :])
            for step in reversed(self.effects(state, self._lost[number]).steps) if lost[number] else ():
                yield self._noticing(Standing(node.at, step.after, done, ready, left, node, -1 - number, step))

    def explanations(self, end: Standing) -> list[tuple[Explanation, tuple[str, ...]]]:
        """The explanation of the first n events at position n, each with the rules that the event exercises."""
        steps: list[tuple[int, int, Step]] = []
        node: Standing | None = end
        while node is not None:
            if node.step is not None:
                steps.append((node.at, node.by, node.step))
            node = node.before
        names = list(self._place)
        here = self._start
        found: list[tuple[Explanation, tuple[str, ...]]] = [(here, ())]
        for at, (kind, *what) in enumerate(self._symbols):
            rules: tuple[str, ...] = ()
            while steps and steps[-1][0] == at:
                _, by, step = steps.pop()
                here = self._after(here, by, names, step)
                rules += step.rules
            if kind is Called and what[2]:
                here = here.replace(lost=with_lost(here.lost, what[0], ()))
            elif kind is Called:
                here = here.replace(calls=(*here.calls, InFlight(what[3], what[0], ())))
            else:
                answered = next(one for one in here.calls if one.name == what[2])
                rules += answered.done.rules if answered.done else self._idle_rules(here, answered, what[0])
                here = here.replace(calls=tuple(one for one in here.calls if one is not answered))
            found.append((here, rules))
        return found

    def _idle_rules(self, here: Explanation, call: InFlight, answer: Answer) -> tuple[str, ...]:
        """The rules by which a call is answered that takes no effect."""
        for ready in call.ready:
            if self._successors.agreements(ready.answer, answer):
                return ready.rules
        for step in self._successors.outcomes(here.state, call.request, ()):
            if step.answer is not None and self._successors.agreements(step.answer, answer):
                return step.rules
        return ()

    def _after(self, here: Explanation, by: int, names: Sequence[int], step: Step) -> Explanation:
        """The explanation after a call has taken effect, or a lost one of a kind."""
        if by < 0:
            request = self._lost[-1 - by].request
            position = next(at for at, (known, *_) in enumerate(here.lost) if known == request)
            here = here.replace(lost=without_lost(here.lost, position))
        late: tuple[Ready, ...] = ()
        if by >= 0:
            call = next(one for one in here.calls if one.name == names[by])
            late = tuple(self._successors.late_answers(here, call, ()))
        taken = self._successors.advance(here, step)
        assert taken is not None and step.answer is not None, "it assumes nothing"  # noqa: S101, PT018
        after = taken[0]
        if by < 0:
            return after
        done = Ready(step.answer, (), (), step.rules)
        return after.replace(
            calls=tuple(
                InFlight(one.name, one.request, (), late, done) if one.name == names[by] else one for one in after.calls
            )
        )


__all__ = ["FEW", "CallSearch", "OtherwiseError", "Standing", "are_calls_alone", "is_of_calls_alone"]
