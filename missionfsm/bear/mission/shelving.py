"""Missions that have ended are put away while nobody watches: a list that is never cleared costs nothing then."""

from __future__ import annotations

from attrs import evolve

from missionfsm.bear.mission.inputs import Request
from missionfsm.bear.mission.state import Kind, Mission, Robot
from missionfsm.bear.wire.messages import State
from missionfsm.kernel.shelving import Shelving
from missionfsm.kernel.values import value

_ASKING = frozenset({"SubscribeMissionStatus", "ClearMissionStatus"})
"""The operations that tell which missions are listed; to all others it matters at most whether one has ended."""


@value(cache_hash=True)
class PutAway(Mission):
    """What stands for missions that were put away, on which shelf."""

    shelf: int = 0


def _front(robot: Robot) -> int:
    return 0 if robot.assigned else len(robot.done)


def _shelf(robot: Robot) -> int | None:
    first = robot.done[0] if robot.done else None
    return first.shelf if isinstance(first, PutAway) else None


def _put(robot: Robot, many: int, shelf: int) -> Robot:
    stands = PutAway(Kind.RETURN, state=State.STATE_SUCCEEDED, shelf=shelf)
    return evolve(robot, done=(stands, *robot.done[many:]))


def _brought(robot: Robot, missions: tuple[Mission, ...]) -> Robot:
    more = len(missions) - 1
    assigned = robot.assigned and (*range(more), *(place + more for place in robot.assigned))
    return evolve(robot, done=(*missions, *robot.done[1:]), assigned=assigned)


def _asks(request: Request) -> bool:
    return request.operation in _ASKING


SHELVING = Shelving(
    front=_front,
    things=lambda robot, many: robot.done[:many],
    shelf=_shelf,
    put=_put,
    brought=_brought,
    asks=_asks,
)
