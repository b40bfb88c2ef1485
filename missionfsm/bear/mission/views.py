"""What a status message shows of a robot, and what one says, as values."""

from __future__ import annotations

import functools

from attrs import evolve

from missionfsm.bear.mission.state import NOT_CHOSEN, Family, Mission, Robot
from missionfsm.bear.wire.messages import MissionState, MissionStates
from missionfsm.kernel.values import value

TOPIC = "mission status"
MORE = "with fields that are not documented"
"""The shape of an answer that has undocumented fields (AM-58)."""


@value(cache_hash=True)
class Listing:
    """What a status message shows of a robot.

    Attributes:
        missions: the listed missions, in order.
        active: the place of the active one; None if none is active.
        family: the family of the robot.
        fresh: whether no mission was ever assigned.
        held: whether no waiting mission is going to start; subscribers do not see that.
        created: the call that has just made the first waiting mission, although it has nothing to wait for.
    """

    missions: tuple[Mission, ...]
    active: int | None
    family: Family
    fresh: bool = False
    held: bool = False
    created: str = ""

    def looks_like(self, other: Listing) -> bool:
        """Whether a subscriber could not tell it from the other."""
        return (self.missions, self.active, self.fresh) == (other.missions, other.active, other.fresh)

    def may_look_like(self, other: Listing) -> bool:
        """Whether a subscriber need not be able to tell: a goal that is not selected may be shown as the first."""
        if self.active != other.active or self.fresh != other.fresh or len(self.missions) != len(other.missions):
            return False
        return _selected(self.missions) == _selected(other.missions)


def _selected(missions: tuple[Mission, ...]) -> tuple[Mission, ...]:
    return tuple([evolve(one, goal=0) if one.goal == NOT_CHOSEN else one for one in missions])


@functools.lru_cache(maxsize=64)
def listing(robot: Robot) -> Listing:
    """What a subscriber of the robot is shown; of missions that have ended, all is visible."""
    going_on = robot.turns[len(robot.done) :]
    return Listing(
        robot.listed((*robot.done, *[mission.visible for mission in going_on])),
        (robot.assigned[len(robot.done)] if robot.assigned else len(robot.done)) if robot.active else None,
        robot.world.family,
        robot.fresh,
        robot.active is None and bool(robot.pending) and (robot.halted or robot.pending[0].held),
    )


@value(cache_hash=True)
class Seen:
    """A status message without its mission ids and metadata.

    Attributes:
        states: the message.
        named: for each mission, whether it has an id.
        bare: for each mission, whether its feedback is a bare enum instead of a message.
        timed: whether the message says when it was recorded.
        more: whether it has undocumented fields.
    """

    states: MissionStates
    named: tuple[bool, ...]
    bare: tuple[bool, ...]
    timed: bool = True
    more: bool = False


def without_ids(states: MissionStates) -> MissionStates:
    """The message with its mission ids taken out."""
    return evolve(states, missions=tuple(map(_without_id, states.missions)))


@functools.lru_cache(maxsize=10_000)
def _without_id(mission: MissionState) -> MissionState:
    return evolve(mission, mission_id="")
