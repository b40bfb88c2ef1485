"""What a named deviation of the program is, and how the code asks whether one is in force."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Variant:
    """One named deviation from the base behaviour.

    `name` selects it on the command line, `sentence` says what differs, `place` is the heading of the page
    that leaves it open (a choice) or that it contradicts (a bug).
    """

    name: str
    sentence: str
    place: str


class Options:
    """The deviations in force in this process."""

    def __init__(self, declared: frozenset[str], active: frozenset[str] = frozenset()) -> None:
        unknown = active - declared
        if unknown:
            raise ValueError(f"not declared: {', '.join(sorted(unknown))}")
        self._declared = declared
        self.active = active

    def on(self, name: str) -> bool:
        """Whether the deviation `name` is in force; a name that nobody declared is a programming error."""
        if name not in self._declared:
            raise KeyError(name)
        return name in self.active
