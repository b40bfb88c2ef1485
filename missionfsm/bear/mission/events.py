"""What a robot of the Mission page does by itself, and what a tester can make it do."""

from __future__ import annotations

import functools
from collections.abc import Hashable, Iterable, Iterator

from attrs import evolve

from missionfsm.bear.mission.edits import Edit, Op
from missionfsm.bear.mission.effects import become, end, failed, failed_to_start, reselected, turned_away
from missionfsm.bear.mission.outcome import Way
from missionfsm.bear.mission.readings.goals import AM_43_LEFT, AM_45_NONE
from missionfsm.bear.mission.readings.scope import part_of
from missionfsm.bear.mission.readings.starting import AM_53_THEN, QUEUE
from missionfsm.bear.mission.state import (
    AUTOMATIC,
    NOT_CHOSEN,
    PATROLS,
    Fault,
    Kind,
    Mission,
    Situation,
    World,
    free_goal,
    is_foreign,
    is_missing,
)
from missionfsm.bear.mission.unwatched import worlds
from missionfsm.bear.wire.messages import Goal, State
from missionfsm.kernel.values import value


@functools.lru_cache(maxsize=100_000)
def due(world: World, active: Mission | None, head: Mission | None, *, halted: bool, queued: bool) -> tuple[Way, ...]:
    """What must have happened once things have settled: a mission starts, a doomed one fails, a goal is selected.

    Args:
        head: the first waiting mission.
        queued: whether others wait behind the active mission.
    """
    if active is not None:
        return tuple(_due_of_active(world, active, queued=queued))
    if head is None or halted or (world.blocked and head.held):
        return ()
    if not world.blocked:
        return tuple(_started(world, head))
    then = AM_53_THEN[head.first or QUEUE]
    return (
        (((Op.HOLD, evolve(head, held=True)),), (then["p", "f"],)),
        *((edit, (then["s"], *assumes)) for edit, assumes in _started(world, head)),
    )


def _started(world: World, head: Mission) -> Iterator[Way]:
    """AM-45: a NavigateAuto mission selects its goal; where none is free it waits, fails or takes the first."""
    running = head.moved("start")
    if head.kind not in AUTOMATIC or head.doomed or head.goal != NOT_CHOSEN:
        yield ((Op.START, running),), ()
        return
    for seen, unseen in worlds(world, head.goals):
        chosen = free_goal(head.goals, seen)
        if chosen != NOT_CHOSEN:
            yield ((Op.START, evolve(running, goal=chosen)),), unseen
            continue
        none = AM_45_NONE[part_of(head.kind)]
        yield ((Op.START, running),), (none["a"], *unseen)
        yield ((Op.START, evolve(running, doomed=True)),), (none["b"], *unseen)
        yield ((Op.START, evolve(running, goal=0)),), (none["d"], *unseen)


def _due_of_active(world: World, active: Mission, *, queued: bool) -> Iterator[Way]:
    if active.doomed:
        yield from failed_to_start(_alone(world, active, queued=queued), active)
    elif _looks(active) and not world.unwatched:
        chosen = free_goal(active.goals, world)
        if chosen != NOT_CHOSEN:
            yield become(evolve(active, goal=chosen)), ()


def _looks(mission: Mission) -> bool:
    """Whether a mission runs and has not selected a goal yet."""
    return mission.kind in AUTOMATIC and mission.goal == NOT_CHOSEN and mission.state is State.STATE_RUNNING


def unwatched_choices(world: World, active: Mission | None) -> Iterator[Way]:
    """What a NavigateAuto mission may select at any time where others take and leave goals unseen (AM-45)."""
    if active is None or not world.unwatched or active.kind not in AUTOMATIC or active.doomed:
        return
    if active.state is not State.STATE_RUNNING:
        return
    for seen, unseen in worlds(world, active.goals):
        if _looks(active):
            chosen = free_goal(active.goals, seen)
            ways: Iterable[Way] = ((become(evolve(active, goal=chosen)), ()),) if chosen != NOT_CHOSEN else ()
        else:
            ways = reselected(seen, active) if unseen else ()
        for edit, assumes in ways:
            if edit != become(active):
                yield edit, (*assumes, *unseen)


def by_itself(
    world: World, active: Mission | None, head: Mission | None, *, halted: bool, queued: bool
) -> Iterator[Way]:
    """What a robot may do at any time: a hopeless mission fails.

    So does one of which a goal has left the map (AM-43), and one that the robot is unable to start (AM-53).

    Args:
        head: the first waiting mission.
        queued: whether others wait behind that one, or behind the active mission.
    """
    if active is not None and active.hopeless:
        yield from failed(_alone(world, active, queued=queued), active)
    elif active is not None and is_missing(world, _ahead(active)):
        for edit, assumes in failed(_alone(world, active, queued=queued), active):
            yield edit, (AM_43_LEFT["e"], *assumes)
        yield from _passes_over(world, active, queued=queued)
    elif active is None and head is not None and world.blocked and head.held and not halted:
        running = head.moved("start")
        for edit, assumes in failed_to_start(_alone(world, running, queued=queued), running):
            yield ((Op.START, running), *edit), (AM_53_THEN[head.first or QUEUE]["f"], *assumes)


def _passes_over(world: World, active: Mission, *, queued: bool) -> Iterator[Way]:
    """AM-43: a mission goes on to its next goal that is on the map, or fails where there is none."""
    passed = (AM_43_LEFT["p"],)
    if active.goal == NOT_CHOSEN or not is_missing(world, active.goals[active.goal : active.goal + 1]):
        return
    count = len(active.goals)
    around = active.kind in PATROLS or active.kind in AUTOMATIC
    later = range(active.goal + 1, active.goal + count if around else count)
    there = [at % count for at in later if not is_missing(world, (active.goals[at % count],))]
    if active.kind in AUTOMATIC:
        there = [at for at in there if free_goal((active.goals[at],), world) != NOT_CHOSEN]
    if there:
        yield become(evolve(active, goal=there[0])), passed
        return
    for edit, assumes in failed(_alone(world, active, queued=queued), active):
        yield edit, (*passed, *assumes)


def _ahead(mission: Mission) -> tuple[Goal, ...]:
    """The goals that a mission has not left behind for good."""
    return mission.goals if mission.kind in PATROLS else mission.goals[max(mission.goal, 0) :]


def _alone(world: World, mission: Mission, *, queued: bool) -> Situation:
    """A robot of which nothing else matters."""
    return Situation(world, mission, queued, True, False, False, None)  # noqa: FBT003


@value(cache_hash=True)
class Event:
    """Something that the environment does: the name of a drive and what it takes."""

    name: str
    what: Hashable = None


PLAIN_EVENTS = ("goalReached", "missionSucceeded", "missionFailed")
"""The drives that say nothing but that they happen; they bring missions on."""


def goal_reached(robot: Situation) -> Iterable[Way]:
    """The running mission is done with its current goal."""
    mission = robot.active
    if mission is None or mission.state is not State.STATE_RUNNING or mission.kind is Kind.CHARGE:
        return
    if mission.kind is Kind.RETURN:  # nobody was told how many goals it has
        yield end(mission, "succeed"), ()
        yield (), ()
        return
    if mission.goal == NOT_CHOSEN or _cannot_arrive(robot.world, mission):
        return
    last = mission.goal + 1 >= len(mission.goals)
    if mission.kind in AUTOMATIC or mission.finishing or (last and mission.kind not in PATROLS):
        yield end(mission, "succeed"), ()
    else:
        again = evolve(mission, goal=0 if last else mission.goal + 1)
        yield (become(again) if again != mission else ()), ()


def mission_succeeded(robot: Situation) -> Iterable[Way]:
    """The running mission ends well."""
    mission = robot.active
    if mission is None or mission.state is not State.STATE_RUNNING or _cannot_arrive(robot.world, mission):
        return
    yield end(mission, "succeed"), ()


def _cannot_arrive(world: World, mission: Mission) -> bool:
    """Whether a mission is bound to fail when it is started, or fails on the way and is at a goal that is not there."""
    if not (mission.doomed or mission.hopeless):
        return False
    goals = mission.goals if mission.doomed else mission.goals[mission.goal : mission.goal + 1]
    return is_foreign(world, mission.kind) or is_missing(world, goals)


def mission_failed(robot: Situation) -> Iterable[Way]:
    """The running or paused mission ends in failure."""
    if robot.active is not None:
        yield from failed(robot, robot.active)


def world_changes(robot: Situation, changed: tuple[tuple[str, Hashable], ...]) -> Iterable[Way]:
    """The world becomes another; a NavigateAuto mission on its way may select again (AM-45)."""
    world = evolve(robot.world, **dict(changed))  # type: ignore[arg-type]  # fields of a world
    edit: Edit = ((Op.WORLD, world),)
    active = robot.active
    if active is None or active.kind not in AUTOMATIC:
        yield edit, ()
    elif active.state is State.STATE_RUNNING:
        for more, assumes in reselected(world, active):
            yield (edit if more == become(active) else edit + more), assumes
    else:  # a paused one may turn to another goal at once, or when it is resumed
        yield edit, ()
        yield from ((edit + more, assumes) for more, assumes in turned_away(world, active))


def fault_armed(_: Situation, fault: Fault) -> Iterable[Way]:
    """The next call that succeeds and documents the status answers with it."""
    yield ((Op.ARM, fault),), ()


@functools.lru_cache(maxsize=100_000)
def apply_event(robot: Situation, event: Event) -> tuple[Way, ...]:
    """The ways in which something that the environment does comes about; none where it does not apply."""
    return tuple(
        {
            "goalReached": lambda: goal_reached(robot),
            "missionSucceeded": lambda: mission_succeeded(robot),
            "missionFailed": lambda: mission_failed(robot),
            "world": lambda: world_changes(robot, event.what),  # type: ignore[arg-type]
            "fault": lambda: fault_armed(robot, event.what),  # type: ignore[arg-type]
        }[event.name]()
    )
