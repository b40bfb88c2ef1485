"""Which of the declared variants this run shows."""

from __future__ import annotations

from bugs import BUGS
from choices import CHOICES
from declared import Declared


class UnknownVariant(ValueError):
    """No variant of that name is declared."""


def find(declared: tuple[Declared, ...], name: str) -> Declared:
    """The declaration with that name."""
    for entry in declared:
        if entry.name == name:
            return entry
    raise UnknownVariant(name)


class Variant:
    """The base, one choice or one bug; `variant("name")` tells whether that one is shown."""

    _names = frozenset(entry.name for entry in CHOICES + BUGS)

    def __init__(self, name: str | None = None) -> None:
        """Show the variant of that name, or the base."""
        if name is not None and name not in self._names:
            raise UnknownVariant(name)
        self.name = name

    def __call__(self, name: str) -> bool:
        """Whether the variant of that name is shown; the name must be declared."""
        if name not in self._names:
            raise UnknownVariant(name)
        return name == self.name
