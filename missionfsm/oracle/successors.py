"""What one explanation can become: by a step that is known, or unseen, when nobody has said anything.

A call in flight takes effect, a lost one does, the system and its surroundings act by themselves. `Successors` says so
for one explanation at a time; `missionfsm.oracle.said` remembers what the spec says of that, and
`missionfsm.oracle.transition` puts it together with what is observed.
"""

from __future__ import annotations

import itertools
import operator
from collections.abc import Callable, Hashable, Iterable, Iterator

from missionfsm.kernel.focus import Focus
from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import UNCONSTRAINED, Assumption, by_bit, meet
from missionfsm.kernel.spec import Failure, Spec
from missionfsm.kernel.step import ONCE_HAD, Step
from missionfsm.kernel.terms import Refs
from missionfsm.kernel.transport import MADE_BY_CLIENTS, MADE_UP
from missionfsm.kernel.values import value
from missionfsm.oracle.explanation import (
    GONE,
    Explanation,
    InFlight,
    Lost,
    Names,
    Ready,
    tidy,
    unify,
    within,
    without_lost,
)
from missionfsm.oracle.lookahead import Lookahead
from missionfsm.oracle.memory import MEMORY
from missionfsm.oracle.said import Said
from missionfsm.oracle.taking import take

Place = tuple[Hashable, ...]
Seen = dict[Place, list[tuple[int, Lost]]]
"""At each point: what was assumed there, with which lost calls left."""

LAG = 6
"""How many changes that nobody drove a channel may owe before the oracle stops to imagine further ones.

Messages that are known to come do not count."""

EVENT_BUDGET = 20_000
"""How many explanations one event may cost before the run is given up as inconclusive."""


class ExhaustedError(Exception):
    """An event has more explanations than the budget allows."""


@value
class Successor:
    """An explanation that an observation leaves, and the rules that were exercised on the way."""

    explanation: Explanation
    rules: tuple[str, ...] = ()


FocusOf = Callable[[Explanation], Focus]
"""What is observed next, seen from an explanation."""


class Successors(Said):
    """What a spec lets one explanation become, unseen or with a step.

    But for what it counts, and `ahead`, it holds nothing that could change an answer.

    Args:
        spec, driven, assumed, memory: see `Said`.
        budget: explanations that a single event may cost.
    """

    def __init__(
        self,
        spec: Spec,
        driven: Iterable[str] = (),
        assumed: int = UNCONSTRAINED,
        budget: int = EVENT_BUDGET,
        *,
        memory: int = MEMORY,
    ) -> None:
        super().__init__(spec, driven, assumed, memory)
        self.budget = budget
        self.groups = by_bit(spec.ambiguities)
        self.ahead: Lookahead | None = None
        self.spent = 0
        self.limit = budget

    def reset(self) -> None:
        """Start counting against the budget anew."""
        self.spent = 0

    def meet(self, assumed: int, assumptions: Iterable[Assumption]) -> int:
        """What is assumed once these are assumed as well; 0 when that is contradictory."""
        if self.ahead is None:
            return meet(assumed, assumptions)
        assumptions = tuple(assumptions)
        return self.ahead.meet(assumed, assumptions) if assumptions else assumed

    def rely(self) -> None:
        """Something is left out since something else assumes no more."""
        if self.ahead:
            self.ahead.rely()

    def advance(
        self, explanation: Explanation, step: Step, given: Names = (), besides: int | None = None
    ) -> tuple[Explanation, Names] | None:
        """The explanation after a step; calls in flight remember what they could have been answered before it.

        The call `besides` does not need to: whoever looks for its answer looks at every explanation on the way.
        """
        if self.ahead and step.assumes and not self.meet(explanation.assumed, step.assumes):
            return None
        if explanation.calls and step.after is not explanation.state and step.after != explanation.state:
            explanation = self._remember(explanation, besides)
        passing = bool(step.opens or (step.emits and explanation.channels)) and bool(self.urgent(step.after))
        return take(explanation, step, given, passing=passing, concerns=self.spec.concerns)

    def _remember(self, explanation: Explanation, besides: int | None) -> Explanation:
        if all(call.done or call.name == besides for call in explanation.calls):
            return explanation
        calls = []
        for call in explanation.calls:
            if call.done is None and call.name != besides:
                known = tuple(dict.fromkeys((*call.ready, *self._idle_answers(explanation, call))))
                if self.ahead and known:
                    known = tuple(one for one in known if self.meet(explanation.assumed, one.assumes))
                    if len(known) > 1:
                        self.ahead.rely()
                        known = _without_fussier(known, explanation.assumed)
                if known != call.ready:
                    call = InFlight(call.name, call.request, call.args, known, call.done)  # noqa: PLW2901 - the same call, knowing more
            calls.append(call)
        return explanation.replace(calls=tuple(calls))

    def _idle_answers(self, explanation: Explanation, call: InFlight) -> Iterator[Ready]:
        refs = self.refs(explanation, call.args)
        for step in self.idle(explanation.state, call.request, refs):
            names = tuple(explanation.names[ref] for ref in step.refs)
            if self.may_answer(call, step.answer, names):  # type: ignore[arg-type]  # an idle step has an answer
                yield Ready(step.answer, names, step.assumes, step.rules)  # type: ignore[arg-type]

    def may_answer(self, call: InFlight, answer: Answer, names: Names) -> bool:
        """Whether a call may come back with this answer, as far as it is known with which it does."""
        known = self.ahead.answer(call.name) if self.ahead else None
        if known is None:
            return True
        given, observed = known
        if len(names) != len(observed) or not self.agreements(answer, given):
            return False
        if answer.unordered:
            return all(name in observed for name in names if name > GONE)
        return all(name == other or name < GONE for name, other in zip(names, observed, strict=True))

    def late_answers(self, explanation: Explanation, call: InFlight, refs: Refs) -> Iterator[Ready]:
        """What a call may be answered that is given up although it takes effect, now or later."""
        for step in self.outcomes(explanation.state, call.request, refs):
            if step.answer is not None and not step.applied and self.may_answer(call, step.answer, ()):
                yield Ready(step.answer, (), step.assumes, step.rules)

    def may_fail(self, call: InFlight, code: str) -> Failure | None:
        """That a call may be answered with a code whatever the state is, without anybody's doing; None if not."""
        failure = self.spec.failing(call.request, code)
        if failure is None or failure.drive in self.driven:
            return None
        return failure

    def failures(self, call: InFlight, code: str) -> Iterator[Failure]:
        """What `may_fail` says of a code, and that a client or a gateway made it up: nobody knows how often they do."""
        failure = self.may_fail(call, code)
        if failure is not None:
            yield failure
        if self.spec.transport and code in MADE_BY_CLIENTS and not (failure and failure.open_ended):
            yield MADE_UP

    def refs(self, explanation: Explanation, args: Names) -> Refs:
        """The positions of a request's names, as `Spec.outcomes` takes them."""
        found = tuple(map(explanation.ref, args))
        if self.spec.recalls and None in found:
            return tuple(
                ONCE_HAD if ref is None and (arg == GONE or arg in explanation.gone) else ref
                for ref, arg in zip(found, args, strict=True)
            )
        return found

    def addressed(self, explanation: Explanation, args: Names) -> Iterator[tuple[Explanation, Refs]]:
        """The explanation with the positions of a request's names.

        A name that nothing has may be that of something whose name was not seen yet.
        """
        yield explanation, self.refs(explanation, args)
        for arg in args:
            if arg != GONE and explanation.ref(arg) is None:
                for own in explanation.names:
                    if own < GONE:
                        bound = unify(explanation, [(own, arg)])
                        if bound:
                            yield from self.addressed(bound, args)

    def silent(
        self, explanation: Explanation, besides: int | None = None, focus: FocusOf | None = None
    ) -> Iterator[Successor]:
        """Everything that an explanation can become next without anybody seeing it.

        Calls take effect, except the one with the name `besides`; the system and its surroundings act by themselves,
        as far as what is observed next can tell where `focus` says what that is.

        Calls that only open channels take effect once something else may: what is shown on other channels tells
        nothing of them, and they open with the same state later. So many that wait do not multiply.
        """
        waiting = [
            (at, call) for at, call in enumerate(explanation.calls) if call.done is None and call.name != besides
        ]
        if not waiting:
            yield from self._others(explanation, (), besides, focus)
            return
        opening = [at for at, call in waiting if self.only_opens(explanation, call)]
        others = [at for at, _ in waiting if at not in opening]
        yield from self._others(explanation, others, besides, focus)
        if opening and not self._waits(explanation, others, focus):
            for position in opening:
                yield from self._take_effect(explanation, position, besides)

    def _waits(self, explanation: Explanation, calls: Iterable[int], focus: FocusOf | None) -> bool:
        """Whether calls that only open channels may as well wait: nothing else can happen, and nothing tells of them.

        What leads to nothing that is known of later counts: where a channel is opened before it, it may.
        """
        if explanation.lost or focus is None or not focus(explanation).aside:
            return False
        in_flight = (explanation.calls[at] for at in calls)
        effects = (
            self.effects(where.state, call.request, refs)
            for call in in_flight
            for where, refs in self.addressed(explanation, call.args)
        )
        return not any(effects) and not any(True for _ in self._silent(explanation, focus))

    def _others(
        self, explanation: Explanation, calls: Iterable[int], besides: int | None, focus: FocusOf | None
    ) -> Iterator[Successor]:
        """What an explanation can become without a call that only opens a channel; `calls` are the other ones."""
        for step in self._silent(explanation, focus):
            yield from self._after(explanation, step, besides)
        for position, (request, args, _) in enumerate(explanation.lost):
            for where, refs in self.addressed(explanation, args):
                for step in self.effects(where.state, request, refs):
                    if not step.opens:
                        rest = where.replace(lost=without_lost(explanation.lost, position))
                        yield from self._after(rest, step, besides)
        for position in calls:
            yield from self._take_effect(explanation, position, besides)

    def only_opens(self, explanation: Explanation, call: InFlight) -> bool:
        """Whether all that a call may do is to open channels, which leaves the state and other channels alone."""
        if call.args:
            return False
        state = explanation.state
        effects = self.effects(state, call.request, ())
        return bool(effects) and all(
            step.opens and step.after is state and not (step.emits or step.closes or step.clears or step.withdraws)
            for step in effects
        )

    def _silent(self, explanation: Explanation, focus: FocusOf | None) -> Iterator[Step]:
        """What may happen without a call, as far as what is observed next can tell."""
        state = explanation.state
        if self.spec.silent_for is not None and focus is not None:
            yield from self.unseen_before(state, focus(explanation))
            return
        yield from self.urgent(state)
        if self._may_go_on(explanation):
            channels = explanation.channels
            shown = not channels or not all(channel.owed for channel in channels)
            for step in self.unseen(state):
                if shown or not step.alone:
                    yield step

    def _may_go_on(self, explanation: Explanation) -> bool:
        """Whether the subscribers, if there are any, are near enough to the state for more to be imagined.

        Where it is known what comes, or where that can be asked for, one of them suffices: a slow one hides nothing
        that a quick one shows. Live, all of them have to be: what each may come to show multiplies.

        Raises:
            ExhaustedError: they are not near enough, and what they show next can be asked for.
        """
        if self.ahead:
            channels = explanation.channels
            goes_on = not channels or any(self.ahead.lag(channel) < LAG for channel in channels)
            self.ahead.stopped |= not goes_on
            return goes_on
        near = (len(channel.owed) < LAG for channel in explanation.channels)
        if self.live:
            return all(near)
        if explanation.channels and not any(near):
            raise ExhaustedError
        return True

    def _after(self, explanation: Explanation, step: Step, besides: int | None = None) -> Iterator[Successor]:
        self.spend(weight(explanation) - 1)
        taken = self.advance(explanation, step, besides=besides)
        if taken:
            after = self.narrowed(taken[0])
            if after:
                yield Successor(tidy(after), step.rules)

    def narrowed(self, explanation: Explanation) -> Explanation | None:
        """The explanation, as far as it can lead to what is known of later; None where it cannot."""
        return self.ahead.narrowed(explanation) if self.ahead else explanation

    def _take_effect(self, explanation: Explanation, position: int, besides: int | None) -> Iterator[Successor]:
        for where, refs in self.addressed(explanation, explanation.calls[position].args):
            for step in self.effects(where.state, where.calls[position].request, refs):
                if step.answer is None:
                    continue
                self.spend(weight(where) - 1)
                taken = self.advance(where, step, besides=besides)
                if taken:
                    after, names = taken
                    call = after.calls[position]
                    done = Ready(step.answer, names, (), step.rules)
                    late = () if step.opens else tuple(self.late_answers(where, where.calls[position], refs))
                    calls = list(after.calls)
                    calls[position] = InFlight(call.name, call.request, (), late, done)
                    bound = self._foreseen(after.replace(calls=tuple(calls)), calls[position], done)
                    if bound:
                        yield Successor(tidy(bound), step.rules)

    def _foreseen(self, explanation: Explanation, call: InFlight, done: Ready) -> Explanation | None:
        """The explanation in which a call has taken effect, with the names that it is known to be answered with.

        None where it is known to come back with something else, or where what is known of later is out of reach.
        """
        ahead = self.ahead
        if ahead is None:
            return explanation
        known = ahead.answer(call.name)
        if known:
            answer, names = known
            if self.may_answer(call, done.answer, done.names):
                if not done.answer.unordered:
                    bound = unify(explanation, zip(done.names, names, strict=True))
                    if bound is None:
                        return None
                    explanation = bound
            elif not call.ready and not any(one.open_ended for one in self.failures(call, answer.code)):
                return None
        return ahead.narrowed(explanation)

    def closure(
        self, starts: Iterable[Explanation], besides: int | None = None, focus: FocusOf | None = None
    ) -> Iterator[Successor]:
        """Explanations and everything that they can silently become, nearest first; `focus` as in `silent`.

        One that has used up more lost calls than another at the same point is left out, and so is all that follows.
        What follows is worked out as it is looked at: of what is too dear nobody looks at most.
        """
        seen: Seen = {}
        todo: Iterable[Successor] = [Successor(start) for start in starts]
        while todo:
            later: list[Iterator[Successor]] = []
            for successor in todo:
                if self.outdone(seen, successor.explanation):
                    continue
                yield successor
                later.append(self._following(successor, besides, focus))
            todo = itertools.chain.from_iterable(later) if later else ()

    def _following(self, successor: Successor, besides: int | None, focus: FocusOf | None) -> Iterator[Successor]:
        """What an explanation can silently become next, with the rules of all of it."""
        for one in self.silent(successor.explanation, besides, focus):
            yield Successor(one.explanation, successor.rules + one.rules)

    def outdone(self, seen: Seen, explanation: Explanation) -> bool:
        """Whether something at the same point has assumed no more and has all the lost calls; notes it otherwise."""
        self.spend(weight(explanation))
        key = place(explanation)
        if self.ahead:
            key = (self.ahead.state(explanation), *key[1:])
        others = seen.setdefault(key, [])
        for assumed, left in others:
            if explanation.assumed | assumed == assumed and within(explanation.lost, left):
                if self.ahead and self.ahead.consulted & ~assumed:
                    self.ahead.rely()
                return True
        others.append((explanation.assumed, explanation.lost))
        return False

    def spend(self, cost: int = 1) -> None:
        """Count something more that was looked at. Raises ExhaustedError when it is too much for one event."""
        self.spent += cost
        if self.spent > self.limit:
            raise ExhaustedError


def _without_fussier(ready: tuple[Ready, ...], assumed: int) -> tuple[Ready, ...]:
    """Those answers that no other is as good as, in one order: one that is the same, and assumes no more."""
    kept: list[tuple[int, Ready]] = []
    for one in ready:
        left = meet(assumed, one.assumes)
        alike = [(other, known) for other, known in kept if (known.answer, known.names) == (one.answer, one.names)]
        if left and not any(left | other == other for other, _ in alike):
            fussier = [known for other, known in alike if other | left == left]
            kept = [*((other, known) for other, known in kept if known not in fussier), (left, one)]
    return tuple(one for _, one in sorted(kept, key=operator.itemgetter(0)))


CALL_WEIGHT, A_UNIT = 4, 64
"""A call in flight weighs as much as so many messages that are owed; so many of those weigh as much as an explanation
itself. Where a channel owes names that nobody has seen, each of its messages weighs as much as it has names: these are
numbered anew with each step."""


def weight(explanation: Explanation) -> int:
    """What an explanation costs: one, and more where it owes many messages."""
    parts, each = CALL_WEIGHT * len(explanation.calls), len(explanation.names)
    for channel in explanation.channels:
        parts += len(channel.owed) * (each if channel.lowest < GONE else 1)
    return 1 + parts // A_UNIT


def place_with_lost(explanation: Explanation) -> Place:
    """Where an explanation is, whatever it assumed."""
    return (*place(explanation), explanation.lost)


def place(explanation: Explanation) -> Place:
    """Where an explanation is, whatever it assumed and whichever lost calls it has left."""
    here = explanation
    return here.state, here.names, here.calls, here.channels, here.gone, here.all_known
