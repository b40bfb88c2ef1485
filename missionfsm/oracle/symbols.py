"""What an event is to the automaton: its kind and its parts, with numbers in the place of names.

The kind is one of the classes of `missionfsm.kernel.history`; after it come, in this order,

| kind | parts |
| --- | --- |
| `Called` | request, names, whether it is lost, call |
| `Returned` | answer, names, call |
| `Received` | content, names, relations of its numbers to those before, channel |
| `Ended` | status, channel |
| `Cancelled` | channel |
| `Driven` | event, names |
| `Settled` | |

A symbol is made for every event of a log, and a tuple is made eight times as fast as a named one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from missionfsm.kernel.history import Answer
from missionfsm.kernel.terms import Content
from missionfsm.kernel.values import value

T = TypeVar("T")

Part = Any
"""A part of an event: of which type, its kind says."""

Symbol = tuple[Part, ...]
"""The kind of an event, and then its parts."""

Observer = Callable[..., T]
"""What takes explanations and the parts of an event of one kind."""


def call_of(symbol: Symbol) -> int:
    """The number of the call that is sent or answered."""
    call: int = symbol[-1]
    return call


def names_of(symbol: Symbol) -> tuple[int, ...]:
    """The numbers of the names in a call, an answer or a message."""
    names: tuple[int, ...] = symbol[2]
    return names


def relations_of(symbol: Symbol) -> tuple[str, ...]:
    """How the numbers of a message compare with those before."""
    relations: tuple[str, ...] = symbol[3]
    return relations


@value
class Arrival:
    """A message that came: on which channel, what it says, and the numbers of the names in it."""

    channel: int
    content: Content
    names: tuple[int, ...]


@value
class Reply:
    """An answer that came, and the numbers of the names in it."""

    answer: Answer
    names: tuple[int, ...]
