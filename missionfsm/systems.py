"""The systems that missionfsm knows, by their names on the command line: where vendors plug into the tools.

Those of other packages are found by the entry-point group ``missionfsm.systems``: the name of an entry is that of the
system, and its object the `missionfsm.kernel.system.System`.

    [project.entry-points."missionfsm.systems"]
    lamp = "my_lamp.system:SYSTEM"
"""

from __future__ import annotations

import importlib
from importlib.metadata import EntryPoint, entry_points

from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.system import System
from missionfsm.kernel.text import brief

GROUP = "missionfsm.systems"
"""The entry-point group of systems that are in other packages."""

_NAMES = ("bear.mission", "bear.status", "isaac.server", "isaac.robot")
"""A system is put together in the module ``system`` of the package of its name, and loaded when it is asked for."""


def _others() -> dict[str, EntryPoint]:
    """The systems of other packages; a name that is taken stays what it is."""
    return {one.name: one for one in sorted(entry_points(group=GROUP)) if one.name not in _NAMES}


def names() -> tuple[str, ...]:
    """The names of all systems: those that are here, and those of packages that are installed."""
    return (*_NAMES, *_others())


def system(name: str) -> System:
    """The system with a name.

    Raises:
        UnreadableError: there is none, and those that exist are listed; or that of another package cannot be loaded.
    """
    if name in _NAMES:
        shipped: System = importlib.import_module(f"missionfsm.{name}.system").SYSTEM
        return shipped
    entry = _others().get(name)
    if entry is None:
        message = f"there is no system {brief(name)}; there are {', '.join(names())}"
        raise UnreadableError(message)
    try:
        found = entry.load()
    except Exception as error:  # whatever the module of somebody else does
        message = f"the system {name} cannot be loaded from {entry.value}: {type(error).__name__}: {error}"
        raise UnreadableError(message) from error
    if not isinstance(found, System):
        message = f"the system {name} cannot be loaded from {entry.value}: that is a {type(found).__name__}, no System"
        raise UnreadableError(message)
    return found
