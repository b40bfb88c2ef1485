"""What an answer tells: what the call did, or that it failed, and which names are which."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator

from missionfsm.kernel.history import Answer
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Failure
from missionfsm.kernel.step import Match, Step
from missionfsm.oracle import lenient, middle
from missionfsm.oracle.explanation import GONE, Explanation, InFlight, Names, mentioned, tidy, unify, with_lost
from missionfsm.oracle.focusing import before_answer
from missionfsm.oracle.successors import Successor, Successors
from missionfsm.oracle.symbols import Reply


class Answering:
    """What becomes of explanations when a call is answered.

    Args:
        successors: what one explanation can become.
        level: how much of what only a transport does is thought of (see `missionfsm.oracle.observing`).
    """

    def __init__(self, successors: Successors, level: int) -> None:
        self._successors = successors
        self._spec = successors.spec
        self._level = level

    def returned(
        self, explanations: Iterable[Explanation], answer: Answer, names: Names, call: int
    ) -> Iterator[Successor]:
        """The explanations in which a call is answered so, now or by a step that comes before."""
        undone, reply = [], Reply(answer, names)
        for explanation in self._over_transport(explanations, answer, call):
            position = explanation.place_of(call)
            if position is None:
                continue
            failed = tuple(self._failed(explanation, position, reply))
            yield from (Successor(tidy(one)) for one in failed)
            if middle.is_unknown(explanation):
                yield from middle.answered(self._successors, explanation, position, answer, names)
                continue
            for one in middle.wild(self._successors, explanation, position, answer, names):
                yield Successor(tidy(one))
            if explanation.calls[position].done is None:
                # Where the call may still take effect and nothing is assumed, this stands for all that was answered so.
                if not any(one.lost != explanation.lost and one.assumed == explanation.assumed for one in failed):
                    undone.append(explanation)
                else:
                    self._successors.rely()
                continue
            # What is silent may as well come after the answer.
            for after, rules in self._answered(explanation, position, reply):
                yield Successor(tidy(after), rules)
        yield from self._answered_after_others(undone, call, reply)

    def _over_transport(self, explanations: Iterable[Explanation], answer: Answer, call: int) -> Iterable[Explanation]:
        """The explanations with those that only a transport has, and what a success says of the robot's software."""
        if self._level > 1:
            explanations = (*explanations, *lenient.restarted(self._successors, self._spec, explanations))
        if answer.code == OK and self._spec.transport and self._spec.added:
            return lenient.up_to_date(self._successors, explanations, call)
        return explanations

    def _answered_after_others(self, undone: list[Explanation], call: int, reply: Reply) -> Iterator[Successor]:
        """The explanations in which something else comes before the call takes effect and is answered."""
        about = before_answer(self._successors, call, reply.answer)
        for successor in self._successors.closure(undone, besides=call, focus=about):
            position = successor.explanation.place_of(call)
            if position is not None:
                for after, rules in self._answered(successor.explanation, position, reply):
                    yield Successor(tidy(after), successor.rules + rules)

    def _failed(self, explanation: Explanation, position: int, reply: Reply) -> Iterator[Explanation]:
        """The explanations in which the call has failed without anybody's doing, which any state allows.

        What is silent may as well come after it, so that these explanations are enough.
        """
        if reply.names or reply.answer.shape is not None:
            return
        one = explanation.calls[position]
        for failure in self._failures(one, reply.answer.code):
            if one.done and not failure.open_ended:
                continue
            assumed = self._successors.meet(explanation.assumed, failure.assumes)
            if assumed:
                calls = (*explanation.calls[:position], *explanation.calls[position + 1 :])
                late = failure.open_ended and not one.done
                lost = with_lost(explanation.lost, one.request, one.args) if late else explanation.lost
                yield explanation.replace(assumed=assumed, calls=calls, lost=lost)

    def _failures(self, call: InFlight, code: str) -> Iterator[Failure]:
        """In which ways the call may have failed with a code without anybody's doing."""
        yield from self._successors.failures(call, code)
        if self._level:
            refused = lenient.too_old(self._spec, self._spec.request_operation(call.request), code)
            if refused:
                yield refused

    def _answered(
        self, here: Explanation, position: int, reply: Reply
    ) -> Iterator[tuple[Explanation, tuple[str, ...]]]:
        answer, names = reply.answer, reply.names
        call = here.calls[position]
        rest = here.without_call(position)
        if call.done:
            for match in self._successors.agreements(call.done.answer, answer):
                assumed = self._successors.meet(rest.assumed, match.assumes)
                for bound in self._bound(rest, reply, call.done.names) if assumed else ():
                    yield bound.replace(assumed=assumed), match.rules
        for ready in call.ready:
            for match in self._successors.agreements(ready.answer, answer):
                assumed = self._successors.meet(rest.assumed, (*ready.assumes, *match.assumes))
                for bound in self._bound(rest, reply, ready.names) if assumed else ():
                    yield bound.replace(assumed=assumed), ready.rules + match.rules
        if call.done:
            return
        for where, refs in self._successors.addressed(rest, call.args):
            for step in self._successors.outcomes(where.state, call.request, refs):
                if step.answer is None or len(step.refs) != len(names):
                    continue
                for match in self._successors.agreements(step.answer, answer):
                    yield from self._answered_by(where, step, match, call, reply)

    def _answered_by(
        self, where: Explanation, step: Step, match: Match, call: InFlight, reply: Reply
    ) -> Iterator[tuple[Explanation, tuple[str, ...]]]:
        assumed = self._successors.meet(where.assumed, match.assumes)
        if not assumed:
            return
        lost = where.lost if step.applied else with_lost(where.lost, call.request, call.args)
        taken = self._successors.advance(where.replace(lost=lost, assumed=assumed), step)
        if taken:
            for bound in self._bound(taken[0], reply, taken[1]):
                yield bound, step.rules + match.rules

    def _bound(self, explanation: Explanation, reply: Reply, own: Names) -> Iterator[Explanation]:
        """The explanation with the names of an answer, in every way in which they can be ours.

        In an unordered answer those that are known go together; of the others, any can be any. Where nothing else
        mentions ours, though, which is which makes no difference.
        """
        observed = reply.names
        if len(own) != len(observed):
            return
        in_order = (zip(own, observed, strict=True),)
        for pairs in _pairings(explanation, own, observed) if reply.answer.unordered else in_order:
            self._successors.spend()
            bound = unify(explanation, pairs)
            if bound:
                yield bound


def _pairings(explanation: Explanation, own: Names, observed: Names) -> Iterator[list[tuple[int, int]]]:
    """The pairs of names that an unordered answer may mean; none where it says one twice."""
    shared = [name for name in own if name in observed]
    left, free = ([name for name in names if name not in shared] for names in (own, observed))
    if max(left, default=GONE - 1) >= GONE or len(left) != len(set(free)):
        return
    elsewhere = set(mentioned(explanation)) if len(left) > 1 else set()
    mentioned_too, rest = ([name for name in left if (name in elsewhere) is known] for known in (True, False))
    for some in itertools.permutations(free, len(mentioned_too)):
        others = (name for name in free if name not in some)
        yield [
            *zip(shared, shared, strict=True),
            *zip(mentioned_too, some, strict=True),
            *zip(rest, others, strict=True),
        ]
