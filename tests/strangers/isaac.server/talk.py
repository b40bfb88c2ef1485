"""What a conversation can do, and how it writes statuses."""

from __future__ import annotations

from typing import Any, Protocol


class Talk(Protocol):
    """What a conversation can do."""

    def reset(self, name_channel: str = "name") -> None:
        """Begin anew."""

    def submit(self, robot: Any, upstream: list[int] | None = None, **members: Any) -> int:
        """Submit a mission; `upstream` counts this conversation's missions from 0; returns its own count."""

    def submit_raw(self, mission: Any) -> None:
        """Submit something as it is."""

    def connect(self, name: str | None = None) -> int:
        """Connect, say the name where one is given, and return the connection."""

    def name(self, connection: int, name: str, channel: str = "name", **header: Any) -> None:
        """Say a name."""

    def report(self, connection: int, state: str, nth: int = -1, **changes: Any) -> None:
        """Report on the nth mission seen on a connection; `changes` may have channel, proto, uuid, about."""

    def line(self, connection: int, line: str) -> None:
        """Send a line as it is."""

    def drop(self, connection: int) -> None:
        """Drop a connection."""

    def advance(self, seconds: float) -> None:
        """Let time pass."""

    def expect(self, text: str) -> None:
        """What the base must show now: a letter a mission, see `LETTERS`."""


LETTERS = {
    "CREATED": "c",
    "QUEUED": "q",
    "STARTED": "s",
    "RUNNING": "r",
    "SUCCESS": "+",
    "FAILED": "f",
    "FAILED_DISCONNECTED": "d",
    "FAILED_TIMEDOUT": "t",
    "FAILED_UPSTREAM": "u",
}
"""A letter for each status."""
