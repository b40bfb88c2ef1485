"""missionfsm: executable formal models of robot mission interfaces, and an oracle that judges implementations.

The public names; each is loaded when it is asked for, so that ``import missionfsm`` costs nothing.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from missionfsm.bear.wire.messages import Command as Command
    from missionfsm.bear.wire.messages import Goal as Goal
    from missionfsm.bear.wire.messages import Pose as Pose
    from missionfsm.bear.wire.messages import State as State
    from missionfsm.fakes import missions as missions
    from missionfsm.fakes import workflows as workflows
    from missionfsm.fakes.errors import ApiError as ApiError
    from missionfsm.fakes.errors import DeadlineExceeded as DeadlineExceeded
    from missionfsm.fakes.errors import FailedPrecondition as FailedPrecondition
    from missionfsm.fakes.errors import Internal as Internal
    from missionfsm.fakes.errors import InvalidArgument as InvalidArgument
    from missionfsm.fakes.errors import NotFound as NotFound
    from missionfsm.fakes.robot import Robot as Robot

_PLACES: Mapping[str, tuple[str, ...]] = {
    "missionfsm.bear.wire.messages": ("Command", "Goal", "Pose", "State"),
    "missionfsm.fakes": ("missions", "workflows"),
    "missionfsm.fakes.errors": (
        "ApiError",
        "DeadlineExceeded",
        "FailedPrecondition",
        "Internal",
        "InvalidArgument",
        "NotFound",
    ),
    "missionfsm.fakes.robot": ("Robot",),
}
_PLACE = {name: place for place, names in _PLACES.items() for name in names}


def __getattr__(name: str) -> Any:  # noqa: ANN401 - whatever the name stands for
    place = _PLACE.get(name)
    if place is None:
        message = f"module 'missionfsm' has no attribute {name!r}"
        raise AttributeError(message)
    if place == "missionfsm.fakes":
        return importlib.import_module(f"{place}.{name}")
    return getattr(importlib.import_module(place), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_PLACE})
