"""What a later message tells of the states before it: whether one may come to be shown so, by the calls that are known.

Which calls may take effect before the message is known of a recording: those that wait already, and those that are sent
in between; and so is what is driven in between. `Spec.foresees` says what they can make of a state.
"""

from __future__ import annotations

import bisect
from collections.abc import Callable, Hashable, Sequence

from missionfsm.kernel.spec import Spec
from missionfsm.oracle.alignment import Message
from missionfsm.oracle.explanation import Explanation, Names

Calls = int
"""Operations of calls, and what is heeded of drives, as bits."""

Asked = tuple[int, Calls, Hashable]
"""The identity of a message, what happens before it, and the topic that it comes on."""


class Foresight:
    """Whether states may come to be shown as later messages show them; remembered.

    Args:
        spec: the system.
        sent: of each call that is sent, its position and its operation, and what is heeded of drives.
        make_room: is told of each explanation of which something is going to be remembered.
    """

    def __init__(self, spec: Spec, sent: Sequence[tuple[int, str]], make_room: Callable[[Explanation], None]) -> None:
        self._spec = spec
        self._make_room = make_room
        self._sent_at = [at for at, _ in sent]
        self._waits: tuple[tuple[object, object], Calls] = (None, None), 0
        self._bits: dict[str, Calls] = {}
        self._sent = [self._bit(operation) for _, operation in sent]
        self._between: dict[tuple[int, int], Calls] = {}
        self._foreseen: dict[tuple[object, Names], dict[Asked, bool]] = {}
        self._here: tuple[Explanation | None, dict[Asked, bool], Calls, frozenset[int]]
        self._here = None, {}, 0, frozenset()

    def forget(self) -> None:
        """Drop what is remembered; it can be found out again."""
        self._foreseen.clear()
        self._here = None, {}, 0, frozenset()

    def may_show(self, explanation: Explanation, message: Message, since: int, until: int, topic: Hashable) -> bool:
        """Whether a state may come to be shown so.

        Args:
            explanation: what the state is, and which calls wait.
            message: what shows it.
            since: the position of the next event.
            until: that of the event before which the state has to be shown so.
            topic: where it is shown; None: anywhere.
        """
        if self._here[0] is not explanation:
            self._look_from(explanation)
        _, known, waiting, gone = self._here
        content, names = message
        if gone and not gone.isdisjoint(names):
            return False
        foresees = self._spec.foresees
        if foresees is None:
            return True
        key = id(message), waiting | self._sent_between(since, until), topic
        found = known.get(key)
        if found is None:
            self._make_room(explanation)
            operations = frozenset(operation for operation, bit in self._bits.items() if key[1] & bit)
            found = known[key] = foresees(explanation.state, explanation.names, content, names, operations, topic)
        return found

    def _look_from(self, explanation: Explanation) -> None:
        """Look from an explanation, from which several messages are looked at in turn."""
        known = self._foreseen.setdefault((explanation.state, explanation.names), {})
        self._here = explanation, known, self._waiting(explanation), frozenset(explanation.gone)

    def _waiting(self, explanation: Explanation) -> Calls:
        """The operations of the calls that have not taken effect."""
        calls, lost = explanation.calls, explanation.lost
        (same_calls, same_lost), waiting = self._waits
        if calls is not same_calls or lost is not same_lost:  # most events leave them as they are
            operation = self._spec.request_operation
            waiting = 0
            for request in [*[one.request for one in calls if one.done is None], *[request for request, *_ in lost]]:
                waiting |= self._bit(operation(request))
            self._waits = (calls, lost), waiting
        return waiting

    def _sent_between(self, since: int, until: int) -> Calls:
        """The operations of the calls that are sent between two positions, and what is driven there."""
        key = bisect.bisect_left(self._sent_at, since), bisect.bisect_left(self._sent_at, until)
        found = self._between.get(key)
        if found is None:
            found = 0
            for bit in self._sent[slice(*key)]:
                found |= bit
            self._between[key] = found
        return found

    def _bit(self, operation: str) -> Calls:
        return self._bits.setdefault(operation, 1 << len(self._bits))
