"""Settling by time: nothing has happened for so long that messages which have not come yet are late."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable

from missionfsm.kernel.history import Event, Received, Settled

_SETTLED = Settled()

_KEPT = 64
"""How many of the events that ended a silence are kept."""


class Quiet:
    """Finds when a conversation has been quiet for long enough.

    A message that only repeats what its stream showed last causes nothing, so it does not end a silence.

    Args:
        seconds: how many seconds (of `at`) after its cause a message is late.

    Attributes:
        timed: whether any line had a time.
        broken: the events that ended a silence after which all had settled, the last ones.
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.timed = False
        self.broken: deque[Event] = deque(maxlen=_KEPT)
        self._since: float | None = None
        self._waiting = False
        self._shown: dict[Hashable, Hashable] = {}

    def settling(self, at: float | None, events: tuple[Event, ...]) -> tuple[Event, ...]:
        """The events of a line, after a `Settled` if everything had settled before it.

        Args:
            at: the time of the line, in seconds; None if it does not say.
            events: its events.
        """
        before: tuple[Event, ...] = ()
        if at is not None:
            self.timed = True
            if self._waiting and self._since is not None and at - self._since >= self.seconds:
                before, self._waiting = (_SETTLED,), False
                self.broken.extend(events)
        noted = [self._note(event) for event in events]
        if any(noted):
            self._since, self._waiting = self._since if at is None else at, True
        return (*before, *events)

    def _note(self, event: Event) -> bool:
        """Note what an event shows. Returns whether it may cause something."""
        if type(event) is not Received:
            return True
        key = (event.channel, *(track for track, _ in event.marks))
        says = (event.content, event.names)
        again = self._shown.get(key) == says
        self._shown[key] = says
        return not again


__all__ = ["Quiet"]
