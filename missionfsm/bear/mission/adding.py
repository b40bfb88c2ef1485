"""What takes effect where missions come: those that create, append or charge, and what readings make of them."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator

from attrs import evolve

from missionfsm.bear.mission.edits import Edit, Op
from missionfsm.bear.mission.inputs import Call, Wanted
from missionfsm.bear.mission.outcome import ADDED, Assumed, Outcome, Way
from missionfsm.bear.mission.readings.charging import AM_37_HALTED, AM_37_QUEUED
from missionfsm.bear.mission.readings.goals import AM_41, AM_43, AM_43_CASE, AM_45_WHEN
from missionfsm.bear.mission.readings.queue import AM_06, AM_07, AM_07_AFTER, AM_12_HALTED, AM_13
from missionfsm.bear.mission.readings.scope import part_of
from missionfsm.bear.mission.readings.workflows import AM_25, AM_27
from missionfsm.bear.mission.rules.situations import waiting
from missionfsm.bear.mission.state import (
    AUTOMATIC,
    NOT_CHOSEN,
    RETURN_POINT,
    Kind,
    Mission,
    Situation,
    World,
    free_goal,
    is_foreign,
    is_nowhere,
    is_spelt_otherwise,
    spelt_on_the_map,
)
from missionfsm.bear.wire.messages import Goal
from missionfsm.kernel.readings import UNCONSTRAINED, Assumption, meet
from missionfsm.kernel.rules import OK


def _accepted(robot: Situation, operation: str, wanted: Wanted, *, waits: bool) -> Iterator[tuple[Mission, Assumed]]:
    """The missions that may be listed for a wanted one. A mission that cannot be done may be accepted, and fails later.

    Args:
        robot: the situation of the robot.
        operation: the name of the call's operation.
        wanted: the mission that was asked for.
        waits: whether it does not start at once.
    """
    assert wanted.kind is not None, "an empty request is refused"  # noqa: S101 - what the rules have made sure
    for mission, assumes in _doomed_or_hopeless(robot, operation, wanted.kind, wanted.goals):
        if wanted.kind not in AUTOMATIC:
            yield mission, assumes
            continue
        chosen = free_goal(wanted.goals, robot.world)
        if chosen == NOT_CHOSEN or not waits:
            # Selecting when it is created and when it starts is the same for a mission that starts at once.
            yield evolve(mission, goal=NOT_CHOSEN), assumes
        else:
            when = AM_45_WHEN[part_of(wanted.kind)]
            yield evolve(mission, goal=NOT_CHOSEN), (*assumes, when.besides("h"))
            yield evolve(mission, goal=chosen), (*assumes, when["h"])


def _doomed_or_hopeless(
    robot: Situation, operation: str, kind: Kind, goals: tuple[Goal, ...]
) -> Iterator[tuple[Mission, Assumed]]:
    """AM-41, AM-43: a mission that cannot be done fails when it is started, or on the way."""
    world = robot.world
    reasons: list[tuple[Assumption, ...]] = []
    if is_nowhere(world, goals):
        reasons.append((AM_43[operation]["b"], AM_43[operation]["d"]))
    if is_foreign(world, kind):
        reasons.append((AM_41[operation]["c"], AM_41[operation]["d"]))
    case = AM_43_CASE[operation] if is_spelt_otherwise(world, goals) else None
    if case is not None:
        reasons.append((case["b"], case["d"], case["f"], case["m"]))
    for how in itertools.product(*reasons):
        at_once = any(one in how for one, *_ in reasons)
        on_the_way = any(one in how for _, one, *_ in reasons)
        as_on_the_map = case is not None and case["m"] in how
        places = tuple(_as_on_the_map(world, goal) for goal in goals) if as_on_the_map else goals
        yield Mission(kind, places, doomed=at_once, hopeless=on_the_way and not at_once), how


def _as_on_the_map(world: World, goal: Goal) -> Goal:
    """A goal as the map spells it."""
    return evolve(goal, destination_id=spelt_on_the_map(world, goal) or goal.destination_id)


def _all_accepted(
    robot: Situation, operation: str, wanted: tuple[Wanted, ...]
) -> list[tuple[tuple[Mission, ...], Assumed]]:
    """The missions that may be listed for all wanted ones, in every way that reads each ambiguity alike for all."""
    first = robot.active is None and not robot.queued
    held = first and robot.world.blocked
    waits = not first or held
    ways: list[tuple[tuple[Mission, ...], Assumed, int]] = [((), (), UNCONSTRAINED)]
    for one in wanted:
        accepted = tuple(_accepted(robot, operation, one, waits=waits))
        ways = [
            ((*missions, mission), (*assumed, *assumes) if assumes else assumed, left)
            for missions, assumed, before in ways
            for mission, assumes in accepted
            if (left := meet(before, assumes))
        ]
        waits = True
    return [
        ((evolve(missions[0], first=operation), *missions[1:]) if held else missions, tuple(dict.fromkeys(assumed)))
        for missions, assumed, _ in ways
    ]


def _listed_anew(robot: Situation, operation: str, edit: Edit) -> Iterator[Way]:
    """AM-13: the new missions follow the ended ones, or replace them."""
    if not robot.ended:
        yield edit, ()
        return
    yield edit, (AM_13[operation]["a"],)
    yield ((Op.FORGET_ENDED, None), *edit), (AM_13[operation]["b"],)


def create(robot: Situation, call: Call) -> Iterator[Outcome]:
    """Missions are created where none is unfinished."""
    paused = (AM_06["b"],) if robot.active is not None else ()
    operation = call.request.operation
    for missions, assumes in _all_accepted(robot, operation, call.request.wanted):
        for edit, anew in _listed_anew(robot, operation, ((Op.ADD, missions),)):
            yield Outcome(OK, edit, ADDED, (*paused, *assumes, *anew))


def create_workflow(robot: Situation, call: Call) -> Iterator[Outcome]:
    """The missions of a workflow are created: how many, is read in several ways."""
    (wanted,) = call.request.wanted
    for parts, how in _workflow_missions(wanted):
        for missions, assumes in _all_accepted(robot, "CreateMissionWorkflow", parts):
            for edit, joined in _joining(robot, missions):
                for whole, anew in _listed_anew(robot, "CreateMissionWorkflow", edit):
                    yield Outcome(OK, whole, ADDED, (*how, *assumes, *joined, *anew))


def _joining(robot: Situation, missions: tuple[Mission, ...]) -> Iterator[Way]:
    """AM-07: a workflow joins the missions that wait, or replaces them; a halted queue may go on with it, or after."""
    add: Edit = ((Op.ADD, missions),)
    if not robot.queued:
        yield add, ()
        return
    how = AM_07[waiting(robot)]
    yield add, (how["b"],)
    yield ((Op.DROP_QUEUE, None), *add, (Op.HALT, False)), (how["r"],)
    rest: Edit = ((Op.ADD, missions[1:]),) if missions[1:] else ()
    first: Edit = ((Op.OVERTAKE, missions[:1]), *rest)
    if rest or not robot.halted or robot.world.blocked:
        yield (*first, (Op.HALT, False)), (how["o"],)
    else:
        yield (*first, (Op.HALT, False)), (how["o"], AM_07_AFTER["a"])
        yield (*first, (Op.START, missions[0].moved("start"))), (how["o"], AM_07_AFTER["s"])
    if robot.halted:
        yield (*add, (Op.HALT, False)), (how["b"],)


@functools.lru_cache(maxsize=1_000)
def _workflow_missions(wanted: Wanted) -> tuple[tuple[tuple[Wanted, ...], Assumed], ...]:
    """AM-25, AM-27: the missions that a workflow may create, with their goals."""
    assert wanted.kind is not None, "an empty request is refused"  # noqa: S101 - as above
    part = part_of(wanted.kind)
    many, point = AM_25[part], AM_27[part]
    back, place = Wanted(Kind.RETURN), (RETURN_POINT,)

    def to(*goals: Goal) -> Wanted:
        return evolve(wanted, goals=goals)

    whole = wanted.goals
    each = tuple(map(to, whole))
    ways: list[tuple[tuple[Wanted, ...], Assumed]] = [
        ((wanted,), (many["a"], point["a"])),
        ((to(*whole, *place),), (many["a"], point["b"])),
        ((wanted, back), (many["b"],)),
        (each, (many["c"],)),
        ((*each, back), (many["d"],)),
    ]
    others = (
        (to(*whole, *place), back),
        (to(*place, *whole),),
        (to(*place, *whole, *place),),
        (to(*whole, *place, *place),),
        (back, wanted),
        (back, wanted, back),
        (wanted, back, back),
        tuple(to(goal, *place) for goal in whole),
        tuple(itertools.chain.from_iterable((one, back) for one in each)),
        *(tuple(to(*group) for group in groups) for groups in _groups(whole)),
    )
    known = {parts for parts, _ in ways}
    return (*ways, *((parts, (many["x"],)) for parts in dict.fromkeys(others) if parts not in known))


def _groups(goals: tuple[Goal, ...]) -> Iterator[tuple[tuple[Goal, ...], ...]]:
    """Every way to cut goals into groups of which none is empty."""
    for cuts in itertools.product((False, True), repeat=len(goals) - 1):
        ends = [0, *(at for at, cut in enumerate(cuts, 1) if cut), len(goals)]
        yield tuple(goals[begin:end] for begin, end in itertools.pairwise(ends))


def append(robot: Situation, call: Call) -> Iterator[Outcome]:
    """Missions are put behind all others."""
    operation = call.request.operation
    for missions, assumes in _all_accepted(robot, operation, call.request.wanted):
        edit: Edit = ((Op.ADD, missions),)
        if robot.halted:
            how = AM_12_HALTED[operation]
            yield Outcome(OK, edit, ADDED, (*assumes, how["a"]))
            yield Outcome(OK, (*edit, (Op.HALT, False)), ADDED, (*assumes, how["c"]))
        else:
            yield Outcome(OK, edit, ADDED, assumes)


def _charging_first(robot: Situation, put: Edit) -> Iterator[Way]:
    """AM-37.halted: where the queue is halted, a charge that is put first sets it going, or is begun by itself."""
    if not robot.halted or robot.world.blocked:
        yield (*put, (Op.HALT, False)), ()
        return
    yield (*put, (Op.HALT, False)), (AM_37_HALTED["a"],)
    yield (*put, (Op.START, Mission(Kind.CHARGE).moved("start"))), (AM_37_HALTED["s"],)


def charge(robot: Situation, _: Call) -> Iterator[Outcome]:
    """A mission to charge is created, or appended where others are unfinished."""
    alone = robot.active is None and not robot.queued
    charge = (Mission(Kind.CHARGE, first="ChargeRobot" if alone and robot.world.blocked else ""),)
    ways: list[Way] = [(((Op.ADD, charge),), ())]
    if robot.active is None and robot.queued:
        how = AM_37_QUEUED[waiting(robot)]
        ways = [(((Op.ADD, charge), (Op.HALT, False)), (how["b"],))]
        for put, letter in ((Op.PUT_FIRST, "c"), (Op.OVERTAKE, "o")):
            ways += [(edit, (how[letter], *then)) for edit, then in _charging_first(robot, ((put, charge),))]
    for edit, assumes in ways:
        for whole, anew in _listed_anew(robot, "ChargeRobot", edit):
            yield Outcome(OK, whole, ADDED, (*assumes, *anew))
