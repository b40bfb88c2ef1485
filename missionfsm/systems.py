"""The systems that missionfsm knows, by their names on the command line: where vendors plug into the tools."""

from __future__ import annotations

import importlib
from collections.abc import Mapping

from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.system import System
from missionfsm.kernel.words import brief

_MODULES: Mapping[str, str] = {
    "bear.mission": "missionfsm.bear.mission_system",
    "bear.status": "missionfsm.bear.status_system",
    "isaac.server": "missionfsm.isaac.server_system",
    "isaac.robot": "missionfsm.isaac.robot_system",
}
"""Where each system is put together; it is loaded when it is asked for."""


def names() -> tuple[str, ...]:
    """The names of all systems."""
    return tuple(_MODULES)


def system(name: str) -> System:
    """The system with a name. Raises UnreadableError, which lists those that exist."""
    if name not in _MODULES:
        message = f"there is no system {brief(name)}; there are {', '.join(_MODULES)}"
        raise UnreadableError(message)
    found: System = importlib.import_module(_MODULES[name]).SYSTEM
    return found
