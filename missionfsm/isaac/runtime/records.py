"""What the mission server remembers: mutable records, its own affair."""

from collections import deque

import attrs

from missionfsm.isaac.runtime.missions import MissionRequest, Status
from missionfsm.isaac.wire.messages import Message, Uuid


@attrs.define(eq=False)
class MissionRecord:
    """A mission and all that the server keeps about it."""

    uuid: Uuid
    request: MissionRequest
    key: str  # of its robot; empty without one, which no robot can be called
    status_channel: str
    attempt: Uuid  # what the robot knows it by: its own identifier, or that of its last retry
    status: Status = Status.CREATED
    number: int = -1  # in the order of submission; -1 before
    waiting: int = 0  # upstreams not yet done
    doomed: bool = False  # an upstream failed
    ended: bool = False
    needed: int = 0  # missions that have not ended and name it as upstream
    downstream: "list[MissionRecord]" = attrs.Factory(list)
    in_flight: bool = False  # sent and not ended
    was_sent: bool = False
    acknowledged: bool = False
    heard: float = 0.0
    due: dict[str, float] = attrs.Factory(dict)  # by clock: start, run, silence
    connection: "ConnectionRecord | None" = None  # that it was sent on
    untimed: bool = False  # its timeouts count no more (AI-16.under-way m)


@attrs.define(eq=False)
class LaneRecord:
    """Where a robot's missions wait for their turn: one a robot, or one a channel (AI-11 c)."""

    robot: "RobotRecord"
    ready: list[tuple[int, MissionRecord]] = attrs.Factory(list)
    line: deque[MissionRecord] = attrs.Factory(deque)  # AI-12 b: all of them, in order
    sent: dict[Uuid, MissionRecord] = attrs.Factory(dict)


@attrs.define(eq=False)
class RobotRecord:
    """A robot and all that the server keeps about it."""

    key: str
    name: str
    connection: "ConnectionRecord | None" = None
    lanes: dict[str, LaneRecord] = attrs.Factory(dict)
    unfinished: dict[Uuid, MissionRecord] = attrs.Factory(dict)


@attrs.define(eq=False)
class ConnectionRecord:
    """A connection and all that the server keeps about it."""

    id: int
    number: int  # in the order of arrival
    open: bool = True
    token: str = ""  # what it said last on the token channel
    leaving: bool = False  # its peer sends nothing more, and is sent nothing
    robot: RobotRecord | None = None
    displaced: bool = False  # another took its robot over
    kept: dict[Uuid, MissionRecord] = attrs.Factory(dict)  # what goes on here after that (AI-16.under-way m)
    early: list[Message] = attrs.Factory(list)
