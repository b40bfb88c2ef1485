"""missionfsm: executable formal models of robot mission interfaces, and an oracle that judges implementations.

The public names; each is loaded when it is asked for, so that ``import missionfsm`` costs nothing.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from missionfsm.bear.messages import Command as Command
    from missionfsm.bear.messages import Goal as Goal
    from missionfsm.bear.messages import Pose as Pose
    from missionfsm.bear.messages import State as State
    from missionfsm.embedding import missions as missions
    from missionfsm.embedding import workflows as workflows
    from missionfsm.embedding.errors import ApiError as ApiError
    from missionfsm.embedding.errors import DeadlineExceeded as DeadlineExceeded
    from missionfsm.embedding.errors import FailedPrecondition as FailedPrecondition
    from missionfsm.embedding.errors import Internal as Internal
    from missionfsm.embedding.errors import InvalidArgument as InvalidArgument
    from missionfsm.embedding.errors import NotFound as NotFound
    from missionfsm.embedding.robot import Robot as Robot

_PLACES: Mapping[str, tuple[str, ...]] = {
    "missionfsm.bear.messages": ("Command", "Goal", "Pose", "State"),
    "missionfsm.embedding": ("missions", "workflows"),
    "missionfsm.embedding.errors": (
        "ApiError",
        "DeadlineExceeded",
        "FailedPrecondition",
        "Internal",
        "InvalidArgument",
        "NotFound",
    ),
    "missionfsm.embedding.robot": ("Robot",),
}
_PLACE = {name: place for place, names in _PLACES.items() for name in names}


def __getattr__(name: str) -> Any:  # noqa: ANN401 - whatever the name stands for
    place = _PLACE.get(name)
    if place is None:
        message = f"module 'missionfsm' has no attribute {name!r}"
        raise AttributeError(message)
    if place == "missionfsm.embedding":
        return importlib.import_module(f"{place}.{name}")
    return getattr(importlib.import_module(place), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_PLACE})
