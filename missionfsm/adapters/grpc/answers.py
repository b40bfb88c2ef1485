"""What a gRPC server asks of the robot that it serves, and how that answers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from attrs import frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System

Listener = Callable[[JSON], None]
"""Takes a message of a stream; is called while the robot's lock is held, so it only passes the message on."""


@frozen
class Answered:
    """How a call ended: with a result, or with an error, the rules that demand it, and their places on the page."""

    result: JSON = None
    error: Mapping[str, str] | None = None
    rules: tuple[str, ...] = ()
    cites: tuple[str, ...] = ()


@frozen
class Spoilt:
    """What a network makes of a call: the error that its caller sees, and whether it took effect all the same."""

    error: Mapping[str, str]
    applied: bool


class Robots(Protocol):
    """A robot, or a fleet, that can be served; `missionfsm.app.live.Live` is one."""

    system: System

    def call(self, method: str, params: JSON, spoilt: Spoilt | None = None) -> Answered:
        """Ask a documented call with one answer."""

    def subscribe(self, method: str, params: JSON, listener: Listener, spoilt: Spoilt | None = None) -> Answered:
        """Open a documented stream, unless the network keeps it from that; the result is its number."""

    def cancel(self, stream: int) -> None:
        """Give a stream up."""

    def drive(self, event: JSON) -> JSON:
        """Make something happen. Raises SubjectError for what is no drive."""

    def reset(self, world: JSON) -> None:
        """Begin anew in a world. Raises UnreadableError for what is none."""

    def history(self) -> tuple[JSON, ...]:
        """All that was seen since the last reset."""
