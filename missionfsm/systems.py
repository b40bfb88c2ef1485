"""The systems that missionfsm knows, by their names on the command line: where vendors plug into the tools."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

from attrs import frozen

from missionfsm.kernel.codec import Codec, UnreadableError
from missionfsm.kernel.spec import Spec


@frozen
class System:
    """A specification, how its JSON is read, and what the tools try on it.

    Attributes:
        alphabet: (bounds) to the requests, drives and worlds that exploration and generation draw from; the class of
            the bounds is the system's own (`missionfsm.kernel.alphabet.Bounds` by default).
    """

    name: str
    spec: Spec
    codec: Codec
    alphabet: Any


_MODULES: Mapping[str, str] = {
    "bear.mission": "missionfsm.bear.mission_system",
}
"""Where each system is put together; it is loaded when it is asked for."""


def names() -> tuple[str, ...]:
    """The names of all systems."""
    return tuple(_MODULES)


def system(name: str) -> System:
    """The system with a name. Raises UnreadableError, which lists those that exist."""
    if name not in _MODULES:
        message = f"there is no system {name!r}; there are {', '.join(_MODULES)}"
        raise UnreadableError(message)
    found: System = importlib.import_module(_MODULES[name]).SYSTEM
    return found
