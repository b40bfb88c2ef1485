"""A queue of things that are due at a time, made for many that never come to pass."""

import heapq
from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")

_FEW = 64


class Deadlines(Generic[T]):
    """Entries of (time, kind, target) in order of time, then of entry.

    Nothing is ever taken out when it becomes void: `holds` tells whether an entry still stands, void ones are passed
    over when they come up, and swept out when the queue has doubled since the last sweep. So an entry costs a
    logarithm, and the queue is never more than about twice as long as what stands.
    """

    def __init__(self, holds: Callable[[float, str, T], bool]) -> None:
        self._holds = holds
        self._heap: list[tuple[float, int, str, T]] = []
        self._entered = 0
        self._sweep_at = _FEW

    def __len__(self) -> int:
        return len(self._heap)

    def push(self, due: float, kind: str, target: T) -> None:
        """Enter something that is due at `due`."""
        self._entered += 1
        heapq.heappush(self._heap, (due, self._entered, kind, target))
        if len(self._heap) > self._sweep_at:
            self._heap = [entry for entry in self._heap if self._holds(entry[0], entry[2], entry[3])]
            heapq.heapify(self._heap)
            self._sweep_at = max(_FEW, 2 * len(self._heap))

    def first(self) -> float | None:
        """When the next entry that stands is due."""
        while self._heap:
            due, _, kind, target = self._heap[0]
            if self._holds(due, kind, target):
                return due
            heapq.heappop(self._heap)
        return None

    def pop(self, now: float) -> tuple[float, str, T] | None:
        """Take out the next entry that stands and is due by `now`."""
        due = self.first()
        if due is None or due > now:
            return None
        _, _, kind, target = heapq.heappop(self._heap)
        return due, kind, target
