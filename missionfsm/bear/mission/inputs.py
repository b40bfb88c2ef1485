"""What the mission API can be asked, as values: well-formed or not, but never without a meaning."""

from __future__ import annotations

import enum

from missionfsm.bear.mission.state import Kind
from missionfsm.bear.wire.messages import Command, Goal
from missionfsm.kernel.values import value


class Defect(enum.Enum):
    """What is wrong with a request whatever the robot does."""

    EMPTY = "nothing is asked for"
    FORMAT = "the format is wrong"
    GOAL = "a goal is invalid"
    MATCH = "the goals do not match the mission type"
    COMMAND = "the command is not set"
    FIELD = "a field is not known"


@value(cache_hash=True)
class Wanted:
    """One mission that a request asks for; `kind` is None where the request does not say which."""

    kind: Kind | None = None
    goals: tuple[Goal, ...] = ()


@value(cache_hash=True)
class Request:
    """One call of one operation.

    Attributes:
        operation: its name.
        wanted: the missions that it asks for, in order.
        command: what UpdateMission asks for.
        defects: what is wrong with it by itself, in the order of `Defect`.
        says: for people: where a malformed request is malformed.
    """

    operation: str
    wanted: tuple[Wanted, ...] = ()
    command: Command | None = None
    defects: tuple[Defect, ...] = ()
    says: str = ""


class Target(enum.Enum):
    """Where the mission stands that an UpdateMission names."""

    ACTIVE = "active"
    QUEUED = "waiting"
    ENDED = "ended"
    CLEARED = "not listed any more"
    UNKNOWN = "never listed"


@value(cache_hash=True)
class Call:
    """A request with what its mission id means to the robot that gets it."""

    request: Request
    target: Target | None = None
