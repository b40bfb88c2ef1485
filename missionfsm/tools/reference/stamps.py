"""When the events of a reference happened, by a clock that its caller gives."""

from __future__ import annotations

from collections.abc import Callable

MAX_STAMPS = 10_000
"""Events whose timestamps are remembered."""


class Stamps:
    """The number of an event to its timestamp: the same for every stream that shows it.

    Args:
        clock: seconds since the epoch of the reference; asked once for an event, when it is shown first.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._stamps: dict[int, float] = {}

    def __call__(self, number: int) -> float:
        """When the event with this number happened."""
        if number not in self._stamps:
            self._stamps[number] = self._clock()
            if len(self._stamps) > MAX_STAMPS:
                del self._stamps[next(iter(self._stamps))]
        return self._stamps[number]
