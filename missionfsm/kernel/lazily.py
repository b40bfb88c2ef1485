"""What is worked out as far as somebody looks at it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Generic, TypeVar

T = TypeVar("T")


class Lazily(Iterable[T], Generic[T]):
    """Values in an order, each worked out once, when somebody comes to it."""

    def __init__(self, values: Iterable[T]) -> None:
        self._rest = iter(values)
        self._known: list[T] = []

    def __iter__(self) -> Iterator[T]:
        position = 0
        while self._knows(position):
            yield self._known[position]
            position += 1

    def _knows(self, position: int) -> bool:
        """Whether there are more than so many; works out the next one where it is not known."""
        if position < len(self._known):
            return True
        for value in self._rest:
            self._known.append(value)
            return True
        return False
