"""How much memory the oracle takes: one accounting, in bytes, of everything that it remembers to be quick.

What is counted is an estimate, which a test compares with what is measured. Whoever reaches its share forgets what it
can find out again, or gives up where it cannot.
"""

from __future__ import annotations

from attrs import define

from missionfsm.oracle.explanation import Explanation

MEMORY = 128 * 2**20
"""How many bytes an automaton and what walks it may take, unless somebody says otherwise."""

NODES, STEPS, NAMES, TEXTS = 2, 4, 8, 8
"""Which part of it goes to nodes and edges, to steps of the system, to names that are gone, to lines that come again:
one in so many."""

ENTRY = 400
"""What anything takes that is remembered."""

EACH_NAME = 16
"""What it takes more for each name of the state in it."""

NAME = 200
"""What a name takes that is remembered by itself."""

PLACE = 8
"""What a message that is owed takes once more in another channel, or in what a channel becomes."""

TEXT = 4
"""How many bytes one byte of a text takes that is remembered with what it means."""


@define(eq=False, slots=True)
class Room:
    """How many bytes something may remember at most, and how many it does by now."""

    most: int
    taken: int = 0

    def overflows(self, more: int) -> bool:
        """Count what is going to be remembered. Whether that is too much: then all before it is to be forgotten."""
        self.taken += more
        if self.taken <= self.most:
            return False
        self.taken = 0
        return True


def explanation_bytes(explanation: Explanation) -> int:
    """What an explanation takes, with its state."""
    owed = sum([len(channel.owed) for channel in explanation.channels])
    parts = 1 + owed + len(explanation.calls) + len(explanation.lost)
    return ENTRY * parts + EACH_NAME * (len(explanation.names) + len(explanation.gone))


def bytes_besides(explanation: Explanation, before: Explanation) -> int:
    """What an explanation takes besides what it shares with one before it, of which it has become."""
    channels, calls = set(map(id, before.channels)), set(map(id, before.calls))
    others = [len(one.owed) for one in explanation.channels if id(one) not in channels]
    parts = 1 + 2 * len(others) + sum(id(one) not in calls for one in explanation.calls) + len(explanation.lost)
    return ENTRY * parts + PLACE * sum(others) + EACH_NAME * (len(explanation.names) + len(explanation.gone))
