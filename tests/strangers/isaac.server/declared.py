"""The form in which choices and bugs are declared."""

from __future__ import annotations

from typing import NamedTuple


class Declared(NamedTuple):
    """A choice or a bug: its name, what differs from the base, the heading of the page that it is about."""

    name: str
    text: str
    place: str
