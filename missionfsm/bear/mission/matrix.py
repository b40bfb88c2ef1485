"""In which situations of a robot a tester should have asked what: missions of every kind, commands, events."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping

from missionfsm.bear.mission.effects import target
from missionfsm.bear.mission.events import Event
from missionfsm.bear.mission.inputs import Defect, Request, Target, Wanted
from missionfsm.bear.mission.samples import CANCEL, PAUSE, TABLES
from missionfsm.bear.mission.scripts import APPENDED, CREATED, call, commanded, drive
from missionfsm.bear.mission.state import AUTOMATIC, Fault, Robot, World, is_foreign, is_missing
from missionfsm.bear.wire.messages import State
from missionfsm.kernel.alphabet import Bounds, ScriptStep
from missionfsm.kernel.matrix import Matrix
from missionfsm.kernel.terms import Refs

MANY = 4
"""Missions that wait, goals of a mission and missions of a batch up to which a robot is tried."""

_BATCHES = ("CreateMissionBatch", "AppendMissionBatch")


def situation(robot: Robot, _: object = ()) -> str | None:
    """The situation that a robot is in, whoever watches; None where it cannot start, or does not start what waits."""
    if robot.world.blocked:
        return None
    if robot.active is None:
        if robot.pending:
            return None
        return "ended" if robot.done else "idle" if robot.fresh else "cleared"
    at = "paused" if robot.active.state is State.STATE_PAUSED else "running"
    if len(robot.pending) >= MANY and at == "running":
        return f"running with {MANY} in the queue"
    if robot.pending:
        return f"{at} with a queue"
    return "running the last of a queue" if robot.done and at == "running" else at


_AT_REST: tuple[ScriptStep, ...] = ()
_QUEUE = (*CREATED, *APPENDED)
_TAKEN = drive("world", occupied=[TABLES[0]])

WAYS: Mapping[str, tuple[tuple[ScriptStep, ...], ...]] = {
    "idle": (_AT_REST, _TAKEN),
    "running": (CREATED, (*CREATED, *_TAKEN)),
    "paused": ((*CREATED, *commanded(0, PAUSE)), (*CREATED, *_TAKEN, *commanded(0, PAUSE))),
    "running with a queue": (_QUEUE, (*_QUEUE, *APPENDED, *drive("missionSucceeded"), *_TAKEN)),
    "paused with a queue": (
        (*_QUEUE, *commanded(0, PAUSE)),
        (*_QUEUE, *APPENDED, *drive("missionSucceeded"), *_TAKEN, *commanded(1, PAUSE)),
    ),
    f"running with {MANY} in the queue": ((*CREATED, *APPENDED * MANY), (*CREATED, *APPENDED * MANY, *_TAKEN)),
    "running the last of a queue": (
        (*_QUEUE, *drive("missionSucceeded")),
        (*_QUEUE, *_TAKEN, *commanded(0, CANCEL)),
    ),
    "ended": ((*CREATED, *drive("missionSucceeded")), (*CREATED, *commanded(0, CANCEL), *_TAKEN)),
    "cleared": (
        (*CREATED, *drive("missionSucceeded"), *call("ClearMissionStatus")),
        (*CREATED, *commanded(0, CANCEL), *call("ClearMissionStatus"), *_TAKEN),
    ),
}


def columns(robot: Robot, _: object, asked: Request | Event, refs: Refs) -> tuple[str, ...]:
    """The kinds of actions that a request or an event is an example of, to a robot."""
    if isinstance(asked, Event):
        return _of_event(asked)
    if asked.command is not None and not asked.defects:
        at = target(robot, refs[0]) if refs else Target.UNKNOWN
        return (f"{asked.command.name} of the mission that is {at.value}",) if at is not Target.UNKNOWN else ()
    return _of_request(robot.world, asked)


@functools.lru_cache(maxsize=100_000)
def _of_request(world: World, asked: Request) -> tuple[str, ...]:
    if asked.wanted:
        return tuple(_of_missions(world, asked))
    # Two members of one message are the one format that is wrong in a way of its own.
    if asked.defects == (Defect.FORMAT,) and asked.says.endswith("only one may be"):
        return (f"{asked.operation} with two members in one wrapper",)
    return () if asked.defects else (asked.operation,)


def _of_event(event: Event) -> tuple[str, ...]:
    if isinstance(event.what, Fault):
        return (f"{event.what.status} {'after' if event.what.applied else 'instead of'} its effect",)
    if event.name == "world":
        return tuple(f"{name.replace('_', ' ')} changes" for name, _ in event.what)  # type: ignore[attr-defined]
    return (event.name,)


def _of_missions(world: World, asked: Request) -> Iterator[str]:
    wrong = [_is_wrong(world, one) for one in asked.wanted]
    batch = asked.operation in _BATCHES
    if batch and len(wrong) > 1 and wrong[-1] and not any(wrong[:-1]):
        yield f"{asked.operation} whose last mission is wrong"
    if asked.defects or any(wrong):
        if not batch and any(_ends_wrong(world, one) for one in asked.wanted):
            yield f"{asked.operation} whose last goal is wrong"
    elif batch:
        yield f"{asked.operation} of {len(asked.wanted)}"
    else:
        yield from _of_mission(world, asked.operation, asked.wanted[0])


def _of_mission(world: World, operation: str, wanted: Wanted) -> Iterator[str]:
    """The kinds of actions that asking for a mission which is right is an example of."""
    kind = wanted.kind.value if wanted.kind else ""
    yield f"{operation} of {kind} to a {world.family.value} robot"
    if len(wanted.goals) >= MANY:
        yield f"{operation} with {MANY} goals to a {world.family.value} robot"
    if wanted.kind in AUTOMATIC and wanted.goals[0].destination_id in world.occupied:
        yield f"{operation} of {kind} past a goal that is taken"


def _is_wrong(world: World, wanted: Wanted) -> bool:
    return wanted.kind is None or is_foreign(world, wanted.kind) or is_missing(world, wanted.goals)


def _ends_wrong(world: World, wanted: Wanted) -> bool:
    """Whether only the last of several goals is not on the map."""
    goals = wanted.goals
    return len(goals) > 1 and is_missing(world, goals[-1:]) and not is_missing(world, goals[:-1])


MATRIX = Matrix(situation, columns, WAYS, Bounds(2 * MANY, goals=MANY, batch=MANY, maps=2))
