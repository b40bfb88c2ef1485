"""Sets of ids that clients count up: calls and streams of a long history, at next to no cost."""

from __future__ import annotations

_BLOCK_BITS = 8
"""Numbers that differ in the last bits alone, so many of them, are kept together."""


class IdSet:
    """A set of whole numbers that costs next to nothing where they are close together."""

    def __init__(self) -> None:
        self._blocks: dict[int, int] = {}
        self._next = 1  # all from 1 up to, but not with, this one are in the set: most clients count

    def add(self, number: int) -> bool:
        """Add a number; whether it is new."""
        if number == self._next and not self._blocks:
            self._next += 1
            return True
        if 0 < number < self._next:
            return False
        block, bit = number >> _BLOCK_BITS, 1 << (number % (1 << _BLOCK_BITS))
        bits = self._blocks.get(block, 0)
        if bits & bit:
            return False
        self._blocks[block] = bits | bit
        return True
