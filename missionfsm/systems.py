"""The systems that missionfsm knows, by their names on the command line: where vendors plug into the tools."""

from __future__ import annotations

import importlib

from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.system import System
from missionfsm.kernel.text import brief

_NAMES = ("bear.mission", "bear.status", "isaac.server", "isaac.robot")
"""A system is put together in the module ``system`` of the package of its name, and loaded when it is asked for."""


def names() -> tuple[str, ...]:
    """The names of all systems."""
    return _NAMES


def system(name: str) -> System:
    """The system with a name. Raises UnreadableError, which lists those that exist."""
    if name not in _NAMES:
        message = f"there is no system {brief(name)}; there are {', '.join(_NAMES)}"
        raise UnreadableError(message)
    found: System = importlib.import_module(f"missionfsm.{name}.system").SYSTEM
    return found
