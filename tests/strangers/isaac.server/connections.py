"""The connections of robots and the names that they said."""

from __future__ import annotations

from dataclasses import dataclass

from mission import SECOND
from variants import Variant

_PATIENCE = 60 * SECOND


@dataclass
class Connection:
    """One connection; `name` is None until the robot has said it."""

    number: int
    opened_at: int
    name: str | None = None
    named_order: int = 0
    open: bool = True
    deaf: bool = False
    retired: bool = False
    missions_sent: int = 0


class Connections:
    """All connections since the last reset, and which of them serves which robot."""

    def __init__(self, variant: Variant) -> None:
        """No connection."""
        self._variant = variant
        self._all: dict[int, Connection] = {}

    def add(self, number: int, now: int) -> Connection:
        """A robot connected."""
        connection = Connection(number, now)
        others = sum(1 for other in self._all.values() if other.open)
        if (self._variant("one-connection") and others >= 1) or (self._variant("three-connections") and others >= 2):
            connection.deaf = True
        self._all[number] = connection
        return connection

    def get(self, number: int) -> Connection | None:
        """The open connection with that number."""
        connection = self._all.get(number)
        return connection if connection is not None and connection.open else None

    def open_ones(self) -> list[Connection]:
        """The open connections, oldest first."""
        return [connection for connection in self._all.values() if connection.open]

    def named(self, name: str) -> list[Connection]:
        """The open connections of that name, oldest name first."""
        found = [connection for connection in self.open_ones() if connection.name == name]
        return sorted(found, key=lambda connection: connection.named_order)

    def is_first_of_name(self, connection: Connection) -> bool:
        """Whether no connection had this one's name before it, open or not."""
        others = [other for other in self._all.values() if other.name == connection.name]
        return all(other.named_order >= connection.named_order for other in others)

    def spoken(self, name: str) -> str:
        """The robot's name that a text on the name channel stands for."""
        if self._variant("name-trimmed"):
            return name.strip()
        if self._variant("name-lower-cased"):
            return name.lower()
        if self._variant("name-cut"):
            return name[:8]
        return name

    def serving(self, robot: str) -> Connection | None:
        """The connection on which a robot's missions go out."""
        variant = self._variant
        named = self.named(robot)
        if variant("no-way-back"):
            named = [connection for connection in named if not connection.retired]
        if variant("old-drop-loses-robot"):
            named = [connection for connection in named if not connection.deaf]
        ever = [connection for connection in self._all.values() if connection.name == robot]
        if variant("dead-robot-served") and not named and ever:
            return ever[-1]
        if variant("return-unnoticed") and named:
            return ever[0]
        if variant("last-named-gets-all"):
            anyone = [connection for connection in self.open_ones() if connection.name is not None]
            return max(anyone, key=lambda connection: connection.named_order, default=None)
        if variant("name-prefix-matched") and not named:
            named = [
                connection for connection in self.open_ones() if connection.name and robot.startswith(connection.name)
            ]
        if variant("unnamed-served") and not named:
            named = [connection for connection in self.open_ones() if connection.name is None]
        if not named:
            return None
        return named[0] if variant("elder-keeps-name") else named[-1]

    def patience_ends(self) -> list[tuple[int, Connection]]:
        """When unnamed connections are given up, where they are."""
        if not self._variant("unnamed-dropped"):
            return []
        return [
            (connection.opened_at + _PATIENCE, connection) for connection in self.open_ones() if connection.name is None
        ]
