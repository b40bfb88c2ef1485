"""What a mission server has to tell: an entry for each of its effects, with a level.

Pure: whoever writes an entry adds the time.
"""

import enum
from collections.abc import Callable, Mapping, Sequence
from typing import Final

import attrs

from missionfsm.isaac.runtime.missions import (
    Close,
    Effect,
    RobotOffline,
    RobotOnline,
    RobotTakenOver,
    Send,
    Status,
    StatusChanged,
)
from missionfsm.isaac.wire.messages import Uuid


class Level(enum.IntEnum):
    """How much an entry matters."""

    DEBUG = 10
    INFO = 20
    WARNING = 30
    ERROR = 40


@attrs.frozen
class Entry:
    """One thing that happened.

    `event` says which kind, `text` the same for people. `fields` are what a program wants to know; which there are
    depends on the kind.
    """

    event: str
    text: str
    level: Level = Level.INFO
    fields: Mapping[str, object] = attrs.Factory(dict)


_FINE: Final = (Status.SUCCESS, Status.CREATED, Status.QUEUED, Status.STARTED, Status.RUNNING)


class Narrator:
    """Tells effects of the missions of one file.

    Args:
        robots: the robot of each mission, in the order of the file.
        peer: the other end of a connection as host:port, while that is known.
    """

    def __init__(self, robots: Sequence[str | None], peer: Callable[[int], str] = lambda _: "somebody") -> None:
        self._robots = robots
        self._numbers: dict[Uuid, int] = {}
        self.peer = peer

    def name(self, uuids: Sequence[Uuid]) -> None:
        """Say under which identifiers the missions run."""
        self._numbers = {uuid: number for number, uuid in enumerate(uuids)}

    def number(self, mission: Uuid) -> int:
        """The index of a mission in the file."""
        return self._numbers[mission]

    def tell(self, effect: Effect) -> Entry:
        """What there is to say of an effect."""
        if isinstance(effect, StatusChanged):
            level = Level.INFO if effect.status in _FINE else Level.WARNING
            more = {"before": effect.before.value, "status": effect.status.value}
            return self._mission("status", effect.mission, effect.status.value, level, more)
        if isinstance(effect, Send):
            where = self._where(effect.connection)
            says = f"sent to {where['peer']} on channel {effect.channel}"
            return self._mission("sent", effect.mission, says, Level.DEBUG, {"channel": effect.channel, **where})
        if isinstance(effect, RobotTakenOver):
            old, new = self.peer(effect.before), self.peer(effect.connection)
            says = f"robot {effect.robot}: taken over by {new}, which says the same name as {old}"
            before = {"connection": effect.before, "peer": old}
            fields = {"robot": effect.robot, "before": before, **self._where(effect.connection)}
            return Entry("robot-taken-over", says, Level.WARNING, fields)
        if isinstance(effect, RobotOnline | RobotOffline):
            word = "connected" if isinstance(effect, RobotOnline) else "disconnected"
            fields = {"robot": effect.robot, **self._where(effect.connection)}
            return Entry(f"robot-{word}", f"robot {effect.robot}: {word}", Level.INFO, fields)
        where = self._where(effect.connection)
        closed = isinstance(effect, Close)
        says = f"connection {effect.connection} from {where['peer']}: {'closed, ' if closed else ''}{effect.reason}"
        level = Level.WARNING if closed else Level.DEBUG
        return Entry("closed" if closed else "ignored", says, level, {"reason": effect.reason, **where})

    def _mission(self, event: str, uuid: Uuid, says: str, level: Level, more: Mapping[str, object]) -> Entry:
        number = self._numbers[uuid]
        robot = self._robots[number]
        fields = {"mission": number, "uuid": str(uuid), "robot": robot, **more}
        return Entry(event, f"missions[{number}] {robot}: {says}", level, fields)

    def _where(self, connection: int) -> dict[str, object]:
        return {"connection": connection, "peer": self.peer(connection)}
