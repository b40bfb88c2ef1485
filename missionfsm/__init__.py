"""missionfsm: executable formal models of robot mission interfaces, and an oracle that judges implementations.

Judging: `check` (a recorded history), `conform` (an implementation), `explore` (a system); each returns its verdict.
Fakes for tests of clients: `Robot` and `Fleet` (Bear), with the messages that they take and the errors that they raise,
`Shared` for several threads, `serve` for clients that speak gRPC; `MissionServer` and `Mission` (Isaac), on real
sockets. `systems` has what is modelled.

Each name is loaded when it is asked for, so that ``import missionfsm`` costs nothing.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from missionfsm import systems
    from missionfsm.adapters.isaac.missionserver import Mission, MissionServer
    from missionfsm.api import check, check_robots, conform, explore
    from missionfsm.app.serve import serve
    from missionfsm.app.shared import Shared
    from missionfsm.bear.wire.messages import Command, Goal, Pose, State
    from missionfsm.fakes import missions, workflows
    from missionfsm.fakes.conversion import from_json, to_json
    from missionfsm.fakes.errors import (
        ApiError,
        DeadlineExceeded,
        FailedPrecondition,
        Internal,
        InvalidArgument,
        NotFound,
    )
    from missionfsm.fakes.fleet import Fleet
    from missionfsm.fakes.robot import Robot
    from missionfsm.kernel.codec import UnreadableError
    from missionfsm.kernel.subject import SubjectError
    from missionfsm.tools.check.verdict import Outcome, Verdict

    __version__: str

__all__ = [
    "ApiError",
    "Command",
    "DeadlineExceeded",
    "FailedPrecondition",
    "Fleet",
    "Goal",
    "Internal",
    "InvalidArgument",
    "Mission",
    "MissionServer",
    "NotFound",
    "Outcome",
    "Pose",
    "Robot",
    "Shared",
    "State",
    "SubjectError",
    "UnreadableError",
    "Verdict",
    "__version__",
    "check",
    "check_robots",
    "conform",
    "explore",
    "from_json",
    "missions",
    "serve",
    "systems",
    "to_json",
    "workflows",
]

_PLACES: Mapping[str, tuple[str, ...]] = {
    "missionfsm": ("systems",),
    "missionfsm.adapters.isaac.missionserver": ("Mission", "MissionServer"),
    "missionfsm.api": ("check", "check_robots", "conform", "explore"),
    "missionfsm.app.serve": ("serve",),
    "missionfsm.app.shared": ("Shared",),
    "missionfsm.bear.wire.messages": ("Command", "Goal", "Pose", "State"),
    "missionfsm.fakes": ("missions", "workflows"),
    "missionfsm.fakes.conversion": ("from_json", "to_json"),
    "missionfsm.fakes.errors": (
        "ApiError",
        "DeadlineExceeded",
        "FailedPrecondition",
        "Internal",
        "InvalidArgument",
        "NotFound",
    ),
    "missionfsm.fakes.fleet": ("Fleet",),
    "missionfsm.fakes.robot": ("Robot",),
    "missionfsm.kernel.codec": ("UnreadableError",),
    "missionfsm.kernel.subject": ("SubjectError",),
    "missionfsm.tools.check.verdict": ("Outcome", "Verdict"),
}
"""Where each name is; those of a package without names of its own are modules."""

_PLACE = {name: place for place, names in _PLACES.items() for name in names}

if not TYPE_CHECKING:  # a type checker that saw this would take any name for one that is there

    def __getattr__(name: str) -> Any:  # noqa: ANN401 - whatever the name stands for
        place = _PLACE.get(name)
        if name == "__version__":
            from importlib.metadata import version  # noqa: PLC0415 - seldom asked for

            return version("missionfsm")
        if place is None:
            message = f"module 'missionfsm' has no attribute {name!r}"
            raise AttributeError(message)
        if place in ("missionfsm", "missionfsm.fakes"):
            return importlib.import_module(f"{place}.{name}")
        return getattr(importlib.import_module(place), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
