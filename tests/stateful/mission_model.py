"""What the Mission page says of a robot's list of missions, as plain lists; nothing of how the project models it.

Where the page leaves open what becomes of something, there are several lists: any of them will do. None in a field
stands for anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from missionfsm import Goal, State

WAITING = State.STATE_DEFAULT
RUNNING = State.STATE_RUNNING
PAUSED = State.STATE_PAUSED
CANCELED = State.STATE_CANCELED
SUCCEEDED = State.STATE_SUCCEEDED
FAILED = State.STATE_FAILED

ACTIVE = (RUNNING, PAUSED)
ENDED = (CANCELED, SUCCEEDED, FAILED)

ROWS = {
    "CreateMission": {"FAILED_PRECONDITION", "INVALID_ARGUMENT", "INTERNAL", "DEADLINE_EXCEEDED"},
    "CreateMissionBatch": {"FAILED_PRECONDITION", "INVALID_ARGUMENT", "INTERNAL", "DEADLINE_EXCEEDED"},
    "CreateMissionWorkflow": {"FAILED_PRECONDITION", "INVALID_ARGUMENT", "INTERNAL", "DEADLINE_EXCEEDED"},
    "AppendMission": {"FAILED_PRECONDITION", "INVALID_ARGUMENT", "INTERNAL", "DEADLINE_EXCEEDED"},
    "AppendMissionBatch": {"FAILED_PRECONDITION", "INVALID_ARGUMENT", "INTERNAL", "DEADLINE_EXCEEDED"},
    "ChargeRobot": {"FAILED_PRECONDITION", "NOT_FOUND", "INTERNAL", "DEADLINE_EXCEEDED"},
    "ClearMissionStatus": {"FAILED_PRECONDITION", "INVALID_ARGUMENT", "INTERNAL"},
    "SkipGoal": {"FAILED_PRECONDITION", "INTERNAL"},
    "UpdateMission": {"FAILED_PRECONDITION", "INVALID_ARGUMENT", "NOT_FOUND", "INTERNAL", "DEADLINE_EXCEEDED"},
}
"""The rows of every Errors table of a call with one answer."""


class Listed(NamedTuple):
    """A mission of the list.

    Attributes:
        kind: how it goes through its goals: "one", "auto", "list", "patrol"; "charge" has none; of "other" the page
            says nothing: what a workflow adds by itself, a NavigateAuto mission that is run while no goal is free.
        at: the index of its current goal.
        early: for "auto", the goal that was the first free one when it was created.
    """

    mission_id: str | None
    kind: str
    goals: tuple[Goal, ...] | None
    state: State
    at: int | None = None
    early: int | None = None


class World(NamedTuple):
    """What is around the robot."""

    family: str
    destinations: tuple[str, ...]
    occupied: tuple[str, ...]
    contact_dock: bool
    charging_location: bool
    blocked: bool

    def knows(self, goals: Iterable[Goal] | None) -> bool:
        """Whether all goals are poses or display names on the map."""
        return all(goal.pose is not None or goal.destination_id in self.destinations for goal in goals or ())

    def first_free(self, goals: Iterable[Goal]) -> int | None:
        """The goal with the lowest index that is neither occupied nor claimed. Mission › NavigateAutoMission."""
        free = (index for index, goal in enumerate(goals) if goal.destination_id not in self.occupied)
        return next(free, None)


Missions = list[Listed]


def put(missions: Missions, index: int, state: State, *at: int | None) -> Missions:
    """The list with one mission in another state, and at another goal if one is given (None: any)."""
    mission = missions[index]
    changed = mission._replace(state=state, at=at[0] if at else mission.at)
    return [*missions[:index], changed, *missions[index + 1 :]]


def indices(missions: Missions, *states: State) -> list[int]:
    """Where missions in these states are."""
    return [index for index, mission in enumerate(missions) if mission.state in states]


def active(missions: Missions) -> int | None:
    """The index of the mission that is running or paused."""
    return next(iter(indices(missions, *ACTIVE)), None)


def next_runs(world: World, missions: Missions) -> Iterator[Missions]:
    """Nothing is active: the first that waits runs, for missions are executed in their order.

    Open: what becomes of one that cannot go, since its goals left the map, none is free, or the robot is blocked.
    """
    waiting = indices(missions, WAITING)
    if not waiting:
        yield missions
        return
    head = missions[waiting[0]]
    free = world.first_free(head.goals or ()) if head.kind == "auto" else None
    choices = {free, head.early} - {None} if head.kind == "auto" else {0 if head.goals else None}
    for at in sorted(choices, key=str):
        yield put(missions, waiting[0], RUNNING, at)
    none_free = head.kind == "auto" and free is None
    if none_free:
        yield put(
            [*missions[: waiting[0]], head._replace(kind="other"), *missions[waiting[0] + 1 :]],
            waiting[0],
            RUNNING,
            None,
        )
    if world.blocked:
        yield missions
    if world.blocked or none_free or not world.knows(head.goals):
        for state in (FAILED, CANCELED):
            yield from after_end(world, put(missions, waiting[0], state, None), state)


def after_end(world: World, missions: Missions, how: State) -> Iterator[Missions]:
    """A mission has ended, and what waits goes on.

    Open after a mission that was canceled or failed: whether what waits is run, stays, or ends with it.
    """
    yield from next_runs(world, missions)
    if how is not SUCCEEDED:
        yield missions
        for state in (CANCELED, how):
            rest = missions
            for index in indices(missions, WAITING):
                rest = put(rest, index, state, None)
            yield rest


def ends(world: World, missions: Missions, index: int, *states: State) -> list[Missions]:
    """A mission ends in one of some states."""
    return [
        after for state in states for after in after_end(world, put(missions, index, state, missions[index].at), state)
    ]


def added(world: World, before: Missions, new: Missions) -> list[Missions]:
    """New missions are at the end of the list, and the first of them runs if nothing is active.

    Open: whether what has ended is still listed in front of them.
    """
    fronts = [before] if active(before) is not None or indices(before, WAITING) else [before, []]
    if active(before) is not None:
        return [front + new for front in fronts]
    return [after for front in fronts for after in next_runs(world, front + new)]
