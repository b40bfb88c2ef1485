"""Which event ruled a reading out: noted while a conversation is judged, at next to no cost.

What explanations assume only ever grows. So a node of the belief automaton that the conversation has met before rules
nothing out, and only nodes that are new to it are looked at.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from attrs import frozen

from missionfsm.kernel.history import Event, Returned
from missionfsm.kernel.readings import Ambiguity, meet
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.terms import Request
from missionfsm.oracle.automaton import Node
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.explanation import Explanation, InFlight
from missionfsm.oracle.memory import MEMORY, NODES
from missionfsm.oracle.parted import Parted
from missionfsm.tools.check.phrases import described, event_words

MAX_LOOKED_AT = 50
"""How many explanations are searched for what an answer could have been."""


@frozen(eq=False)
class Elimination:
    """The event that ruled a reading out.

    Attributes:
        spec: the system.
        event: the event.
        request: the request, if the event is an answer.
        at: how many readings its conversation had ruled out before.
        before: the node before the event.
    """

    spec: Spec
    event: Event
    request: Request
    at: int = 0
    before: Node | None = None

    def __str__(self) -> str:
        words = event_words(self.spec, self.event)
        if self.request is None:
            return words
        where = f" in {self.situation}" if self.situation else ""
        return f"{described(self.spec, self.request)} was {words}{where}"

    @property
    def situation(self) -> str:
        """The state in which the call was made, in words; empty if several are possible, or if it is no answer."""
        states = {here.state for here, _ in self._made()}
        return described(self.spec, states.pop()) if len(states) == 1 else ""

    @property
    def rules(self) -> tuple[str, ...]:
        """Ids of the rules of other answers that the call could have had, then those of the answer that it had.

        They are known only for answers.
        """
        if self.request is None or not isinstance(self.event, Returned):
            return ()
        code = self.event.answer.code
        against, given = dict[str, None](), dict[str, None]()
        for answer, rules in self._possible():
            (given if answer == code else against).update(dict.fromkeys(rules))
        if not against and not given:
            operation = self.spec.operations[self.spec.request_operation(self.request)]
            return tuple(rule.id for rule in operation.refusals if rule.code == code)
        return (*against, *(rule for rule in given if rule not in against))

    def _made(self) -> Iterator[tuple[Explanation, InFlight]]:
        """The call that is answered, in each explanation before the event."""
        for here in self.before.explanations[:MAX_LOOKED_AT] if self.before and self.request is not None else ():
            yield from ((here, call) for call in here.calls if call.request == self.request)

    def _possible(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """The answers that the call could have had, each with its rules."""
        for here, call in self._made():
            ready = (*call.ready, call.done) if call.done else call.ready
            yield from ((one.answer.code, one.rules) for one in ready)
            if call.done is None:
                for step in self.spec.outcomes(here.state, call.request, tuple(map(here.ref, call.args))):
                    if step.answer is not None and meet(here.assumed, step.assumes):
                        yield step.answer.code, step.rules


class Eliminations:
    """The readings that one conversation has ruled out so far, each with the event that did it.

    Attributes:
        seen: the nodes that were looked at; whoever meets another one calls `notice`.
        found: for each ambiguity id and letter that was ruled out, the event that did it.
    """

    def __init__(self, belief: Belief | Parted) -> None:
        self.seen: set[Node] = {belief.node}
        self.found: dict[tuple[str, str], Elimination] = {}
        self._belief = belief
        self._bytes = belief.node.bytes
        self._left = _left(belief.node)

    def notice(self, event: Event, asked: Request | None, before: Node | None = None) -> None:
        """Note what an event rules out that has led to a node which was not seen before.

        Args:
            event: the event.
            asked: the request, if the event is an answer.
            before: the node before the event.
        """
        node = self._belief.node
        self._bytes += node.bytes
        if self._bytes > MEMORY // NODES:
            self.seen.clear()
            self._bytes = node.bytes
        self.seen.add(node)
        left = _left(node)
        gone = self._left & ~left
        if not gone:
            return
        self._left &= left
        spec = self._belief.spec
        request = asked if isinstance(event, Returned) else None
        before = before and self._belief.of_last_event.whole(before)
        elimination = Elimination(spec, event, request, len(self.found), before)
        for ambiguity in spec.ambiguities:
            if gone & ambiguity.group:  # of hundreds, few
                for letter in ambiguity.possible(gone):
                    self.found[ambiguity.id, letter] = elimination

    def skip(self) -> None:
        """Attribute what was ruled out since to no event: many events were explained together."""
        self._left = self._belief.left
        self.seen.add(self._belief.node)


def _left(node: Node) -> int:
    left = 0
    for one in node.explanations:
        left |= one.assumed
    return left


def by_ambiguity(
    ambiguities: tuple[Ambiguity, ...],
    found: Mapping[tuple[str, str], Elimination],
    left: Mapping[str, tuple[str, ...]],
) -> dict[str, dict[str, str]]:
    """For each ambiguity id and letter that was ruled out, the event in words, in the order of the ambiguities.

    Args:
        ambiguities: the ambiguities.
        found: for each ambiguity id and letter, the event that ruled it out somewhere.
        left: the readings that are possible: another conversation may have ruled out one of them.
    """
    open_letters = {
        one.id: {
            letter: str(found[one.id, letter])
            for letter in one.readings
            if (one.id, letter) in found and letter not in left.get(one.id, ())
        }
        for one in ambiguities
    }
    return {name: letters for name, letters in open_letters.items() if letters}
