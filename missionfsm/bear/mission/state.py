"""The robot of the Mission page as a state: its world and its listed missions.

The missions of a robot stand in the order of their turns: those that have ended, then the active one, then those that
wait. Nothing that the documents allow ever breaks that order, so it is the shape of the state rather than an invariant
over it. Where a mission had its turn before others that were assigned earlier, `Robot.assigned` says how they are
listed.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from typing import TypeVar

from attrs import evolve

from missionfsm.bear.wire.messages import Goal, State
from missionfsm.kernel.chart import Chart
from missionfsm.kernel.rules import Document
from missionfsm.kernel.values import value

MISSION = Document("Mission", "Mission (robot API)")
SYSTEM_NAME = "bear.mission"


class Family(enum.Enum):
    """What kind of robot it is."""

    BASE = "base"
    SERVI = "servi"
    CARTI = "carti"


class Kind(enum.Enum):
    """What kind of mission it is, workflows included."""

    BASE_NAVIGATE = "base navigate"
    BASE_NAVIGATE_AUTO = "base navigate-auto"
    SERVI_DELIVERY = "servi delivery"
    SERVI_DELIVERY_PATROL = "servi delivery patrol"
    SERVI_BUSSING = "servi bussing"
    SERVI_BUSSING_PATROL = "servi bussing patrol"
    SERVI_NAVIGATE = "servi navigate"
    SERVI_NAVIGATE_AUTO = "servi navigate-auto"
    SERVI_BIRTHDAY = "servi birthday"
    SERVI_HOSTING = "servi hosting"
    SERVI_HOSTING_PATROL = "servi hosting patrol"
    CARTI_TRAVERSE = "carti traverse"
    CARTI_TRAVERSE_PATROL = "carti traverse patrol"
    CARTI_NAVIGATE = "carti navigate"
    CARTI_NAVIGATE_AUTO = "carti navigate-auto"
    CHARGE = "charge"
    RETURN = "return"


PATROLS = frozenset(
    {Kind.SERVI_DELIVERY_PATROL, Kind.SERVI_BUSSING_PATROL, Kind.SERVI_HOSTING_PATROL, Kind.CARTI_TRAVERSE_PATROL}
)
AUTOMATIC = frozenset({Kind.BASE_NAVIGATE_AUTO, Kind.SERVI_NAVIGATE_AUTO, Kind.CARTI_NAVIGATE_AUTO})
GOALLESS = frozenset({Kind.CHARGE, Kind.RETURN})
FAMILY: Mapping[Kind, Family | None] = {
    kind: next((family for family in (Family.SERVI, Family.CARTI) if kind.value.startswith(family.value)), None)
    for kind in Kind
}
"""The family that a kind of mission is for; None where it is for all."""

RETURN_POINT = Goal(destination_id="")
"""A goal that a workflow may add by itself (AM-25, AM-27): which one it is, nobody is told."""

LIFECYCLE: Chart[State] = Chart(
    "mission",
    State.STATE_DEFAULT,
    (
        ("start", State.STATE_DEFAULT, State.STATE_RUNNING),
        ("cancel", State.STATE_RUNNING, State.STATE_CANCELED),
        ("cancel", State.STATE_PAUSED, State.STATE_CANCELED),
        ("pause", State.STATE_RUNNING, State.STATE_PAUSED),
        ("resume", State.STATE_PAUSED, State.STATE_RUNNING),
        ("finish", State.STATE_RUNNING, State.STATE_SUCCEEDED),
        ("finish", State.STATE_PAUSED, State.STATE_SUCCEEDED),
        ("succeed", State.STATE_RUNNING, State.STATE_SUCCEEDED),
        ("fail", State.STATE_RUNNING, State.STATE_FAILED),
        ("fail", State.STATE_PAUSED, State.STATE_FAILED),
        ("cancel with the queue", State.STATE_DEFAULT, State.STATE_CANCELED),
        ("fail with the queue", State.STATE_DEFAULT, State.STATE_FAILED),
    ),
    {
        "cancel with the queue": "only where AM-09 or AM-10 is read as c",
        "fail with the queue": "only where AM-10 is read as e",
    },
)
"""The lifecycle of one mission; waiting is reported as STATE_DEFAULT (AM-08)."""

ENDED = frozenset(LIFECYCLE.final)
T = TypeVar("T")
NOT_CHOSEN = -1
"""The goal of a NavigateAuto mission that has not selected one."""


@value(cache_hash=True)
class Mission:
    """One listed mission.

    Attributes:
        goal: index of the current goal; `NOT_CHOSEN` for a NavigateAuto mission that has not selected one.
        finishing: it was told to finish and will, at its current goal (AM-30 read as b).
        doomed: it was accepted although it cannot be done, and fails once it is started (AM-41 c, AM-43 b, AM-45 b).
        hopeless: it was accepted although it cannot be done, and fails on the way (AM-41 d, AM-43 d).
        first: the call that made it, if it is the first of a queue and the robot was unable to start it (AM-53).
        held: it waits since the robot is unable to start it (AM-53.then read as p or f).
    """

    kind: Kind
    goals: tuple[Goal, ...] = ()
    state: State = State.STATE_DEFAULT
    goal: int = 0
    finishing: bool = False
    doomed: bool = False
    hopeless: bool = False
    first: str = ""
    held: bool = False

    def moved(self, trigger: str) -> Mission:
        """The mission after a move of its lifecycle. Raises ValueError where that is not a move."""
        after = LIFECYCLE.after(trigger, self.state)
        if after is None:
            message = f"a mission in {self.state.name} cannot {trigger}"
            raise ValueError(message)
        goes_on = after not in ENDED
        return evolve(
            self,
            state=after,
            finishing=False,
            doomed=self.doomed and goes_on,
            hopeless=self.hopeless and goes_on,
            first="",
            held=False,
        )

    @property
    def visible(self) -> Mission:
        """What a subscriber can tell of it."""
        if self.finishing or self.doomed or self.hopeless or self.first or self.held:
            return evolve(self, finishing=False, doomed=False, hopeless=False, first="", held=False)
        return self


@value(cache_hash=True)
class World:
    """What the robot is and where it stands; the fields are those of the adapter protocol.

    Attributes:
        destinations: display names on the robot's map.
        occupied: those that another robot holds or claims.
        blocked: whether the robot is unable to start a mission.
        unwatched: whether what is occupied may change with nobody saying so (`missionfsm.bear.mission.unwatched`); no
            field of the protocol.
    """

    family: Family = Family.SERVI
    contact_dock: bool = True
    charging_location: bool = True
    destinations: tuple[str, ...] = ("table-1", "table-2", "table-3")
    occupied: tuple[str, ...] = ()
    blocked: bool = False
    unwatched: bool = False


def without_place(missions: tuple[Mission, ...]) -> tuple[Mission, ...]:
    """The missions, those that have ended without the goal at which they did: no message has to show it."""
    for ended in missions:
        if ended.goal and ended.state in ENDED:
            return tuple([evolve(one, goal=0) if one.goal and one.state in ENDED else one for one in missions])
    return missions


@value
class Fault:
    """The next call that would succeed and documents `status` answers with it; `applied`: and takes effect."""

    status: str
    applied: bool


@value(cache_hash=True)
class Robot:
    """A robot: its world and its listed missions in order.

    Attributes:
        done: missions that have ended, in the order in which they were assigned.
        active: the mission that is running or paused.
        pending: missions that wait.
        halted: the waiting missions are not going to start by themselves (AM-09, AM-10 read as b).
        fresh: no mission was ever assigned, nor what stands for none cleared (AM-36.cleared d).
        fault: an armed fault.
        assigned: how many of `turns` were assigned before each, where that is not their order (AM-07, AM-37); () where
            it is.
    """

    world: World
    done: tuple[Mission, ...] = ()
    active: Mission | None = None
    pending: tuple[Mission, ...] = ()
    halted: bool = False
    fresh: bool = True
    fault: Fault | None = None
    assigned: tuple[int, ...] = ()

    @property
    def turns(self) -> tuple[Mission, ...]:
        """All listed missions in the order of their turns; names and references stand in it as well."""
        return (*self.done, *((self.active,) if self.active else ()), *self.pending)

    def listed(self, turns: tuple[T, ...]) -> tuple[T, ...]:
        """What there is for each mission in the order of their turns, first to last assigned."""
        if not self.assigned:
            return turns
        return tuple(one for _, one in sorted(zip(self.assigned, turns, strict=True), key=lambda pair: pair[0]))


@value(cache_hash=True)
class Situation:
    """All of a robot that decides what a call is answered; the ended and the waiting missions only count."""

    world: World
    active: Mission | None
    queued: bool
    ended: bool
    halted: bool
    fresh: bool
    fault: Fault | None


def situation(robot: Robot) -> Situation:
    """What of a robot decides its answers."""
    return Situation(
        robot.world, robot.active, bool(robot.pending), bool(robot.done), robot.halted, robot.fresh, robot.fault
    )


def is_missing(world: World, goals: tuple[Goal, ...]) -> bool:
    """Whether one of the goals is a destination that the map has not."""
    return any(goal.destination_id and goal.destination_id not in world.destinations for goal in goals)


def spelt_on_the_map(world: World, goal: Goal) -> str:
    """The destination of a goal as the map has it, where only its case differs; empty where the map has it not."""
    name = goal.destination_id or ""
    if name in world.destinations:
        return name
    wanted = name.casefold()
    return next((one for one in world.destinations if one.casefold() == wanted), "")


def is_spelt_otherwise(world: World, goals: tuple[Goal, ...]) -> bool:
    """Whether only the case of one of the goals differs from a destination on the map."""
    return is_missing(world, goals) and any(
        spelt_on_the_map(world, goal) not in ("", goal.destination_id) for goal in goals
    )


def is_nowhere(world: World, goals: tuple[Goal, ...]) -> bool:
    """Whether one of the goals is a destination that the map has not, in whatever case."""
    return is_missing(world, goals) and any(goal.destination_id and not spelt_on_the_map(world, goal) for goal in goals)


def is_foreign(world: World, kind: Kind) -> bool:
    """Whether a mission is for another family than the robot's."""
    return FAMILY[kind] not in (None, world.family)


def free_goal(goals: tuple[Goal, ...], world: World, after: int = -1) -> int:
    """The lowest index above `after` of a goal that no other robot holds or claims; `NOT_CHOSEN` if there is none."""
    free = (index for index, goal in enumerate(goals) if index > after and goal.destination_id not in world.occupied)
    return next(free, NOT_CHOSEN)
