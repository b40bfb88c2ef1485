"""JSON with places for names: what a page fills in when it knows which names there are.

A page calls a name by a serial number. In texts that are made for it a number that nothing else has stands where the
name in a position goes, and the page puts the serial number there. A name that is written as other digits (an
identifier of two long numbers) is written in a page as its serial number, wherever those digits stand.
"""

from __future__ import annotations

import json
import re
from collections.abc import Hashable, Mapping
from typing import Any

from missionfsm.kernel.alphabet import ANY_NAME, Naming
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Name
from missionfsm.tools.conform.actions import filled
from missionfsm.tools.placeholders import fill

PLACES = 900_000_000
"""Stands for the name in position 0; those for the others follow. The page knows them as nine digits, 900000…"""

TEXT = ""
"""The kind of names that are plain text."""

_DIGITS = re.compile(r"\d{6,}")


def put(params: JSON, chosen: Mapping[int | None, Name], naming: Naming) -> JSON:
    """Params with names in the place of stand-ins: by slot, and under None for `ANY_NAME`."""
    named = filled(params, chosen.get(None, ANY_NAME))
    return fill(named, {slot: name for slot, name in chosen.items() if slot is not None}, naming, 1)


def dumped(value: JSON) -> str:
    """JSON in one line."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


class Writer:
    """Makes names that stand for places, and writes JSON with them."""

    def __init__(self, naming: Naming) -> None:
        self.naming = naming
        self._places: dict[str, str] = {}

    def made(self, kind: str, serial: int) -> Name:
        """The name of a kind with a serial number."""
        name: Name = self.naming.make(kind, serial) if kind else self.naming.given(serial)
        return name

    def place(self, kind: str, position: int) -> Name:
        """What stands for the name in a position."""
        name = self.made(kind, PLACES + position)
        self._places |= self._digits(name, position)
        return name

    def _digits(self, name: Name, position: int) -> dict[str, str]:
        written = self.naming.write(name) if isinstance(name, tuple) else name
        return dict.fromkeys(_DIGITS.findall(dumped(written)), str(PLACES + position))

    def text(self, value: JSON, besides: Mapping[Name, int] | None = None) -> str:
        """JSON in one line, with a place wherever a name that stands for one is written.

        Args:
            besides: other names that are to stand for places, with the positions of these.
        """
        places = dict(self._places)
        for name, position in (besides or {}).items():
            places |= self._digits(name, position)
        return _DIGITS.sub(lambda found: places.get(found[0], found[0]), dumped(value))


class Shared:
    """Values, each kept once, by the order in which they came up."""

    def __init__(self) -> None:
        self._numbers: dict[Any, int] = {}

    def number(self, value: Hashable) -> int:
        """The number of a value."""
        return self._numbers.setdefault(value, len(self._numbers))

    @property
    def values(self) -> list[Any]:
        """All values in the order of their numbers."""
        return list(self._numbers)

    def json(self, value: JSON) -> int:
        """The number of a JSON value whose parts are shared with those of others.

        A list is kept as the numbers of its items, an object as its keys and the numbers of its values. What is kept is
        JSON text, since 1 and true are the same to a dictionary.
        """
        if isinstance(value, dict):
            kept: JSON = {"k": list(value), "v": [self.json(one) for one in value.values()]}
        elif isinstance(value, list):
            kept = [self.json(one) for one in value]
        else:
            kept = value
        return self.number(dumped(kept))
