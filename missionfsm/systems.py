"""The systems that missionfsm knows, by their names on the command line: where vendors plug into the tools.

Those of other packages are found by the entry-point group ``missionfsm.systems``: the name of an entry is that of the
system, and its object the `missionfsm.kernel.system.System`.

    [project.entry-points."missionfsm.systems"]
    lamp = "my_lamp.system:SYSTEM"
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.system import System
from missionfsm.kernel.text import brief

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "missionfsm.systems"
"""The entry-point group of systems that are in other packages."""

_SHIPPED = {
    "bear.mission": "one robot's missions",
    "bear.status": "the status of an account's fleet",
    "isaac.server": "a mission server",
    "isaac.robot": "a robot's mission codelet",
}
"""Name to title. A system is put together in the module ``system`` of the package of its name, and loaded when it is
asked for; its title stands here too, so that a list of all systems loads none."""


def _others() -> dict[str, EntryPoint]:
    """The systems of other packages, but for those that have a name of a system of this one."""
    from importlib.metadata import entry_points  # noqa: PLC0415 - it reads mail, and is seldom needed

    return {one.name: one for one in sorted(entry_points(group=GROUP)) if one.name not in _SHIPPED}


def names() -> tuple[str, ...]:
    """The names of all systems: those of this package, then those of other installed packages."""
    return (*_SHIPPED, *_others())


def system(name: str) -> System:
    """The system with a name.

    Raises:
        UnreadableError: there is none, and those that exist are listed; or that of another package cannot be loaded.
    """
    if name in _SHIPPED:
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


def title(name: str) -> str:
    """What a system is, in a few words; those of other packages are loaded for it. Raises as `system` does."""
    return _SHIPPED.get(name) or system(name).spec.title
