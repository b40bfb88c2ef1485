"""What an event is to the automaton: its kind and its parts, with numbers in the place of names."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

T = TypeVar("T")

Part = Any
"""A part of an event: of which type, its kind says (`missionfsm.oracle.belief.Belief.symbol`)."""

Symbol = tuple[Part, ...]
"""The kind of an event, one of the classes of `missionfsm.kernel.history`, and then its parts."""

Observer = Callable[..., T]
"""What takes explanations and the parts of an event of one kind."""
