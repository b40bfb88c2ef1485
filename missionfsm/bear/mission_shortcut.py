"""The steps of a robot for the explorer: what a situation allows is found once, as edits, and then only applied.

Most steps of a robot depend on its situation alone, and there are few of those. ``tests/bear/test_mission_explore.py``
holds this to what `missionfsm.bear.mission_spec` says step by step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from missionfsm.bear.mission import Edit, Mission, Op, Robot, Situation, World, apply, situation
from missionfsm.bear.mission_effects import Call, Happening, due, happens, outcomes
from missionfsm.bear.mission_requests import Request, Target
from missionfsm.bear.mission_rules import OPERATIONS
from missionfsm.kernel.readings import meet

_Key = tuple[World, Mission | None, bool, bool, bool, bool, object]


def shortcut(
    requests: Iterable[tuple[Request, tuple[bool, ...]]], events: Iterable[Happening], assumed: int, most: int
) -> Callable[[Robot], list[Robot]]:
    """A function from a robot to the robots after every step that changes it, within `most` listed missions."""
    calls = tuple(
        Call(request, target) for request, named in requests for target in (tuple(Target) if named else (None,))
    )
    happenings = tuple(events)
    # What a situation allows: edits by how many missions they add; the plain tuple spares making a Situation.
    menus: dict[_Key, tuple[tuple[int, bool, Edit], ...]] = {}
    started: dict[tuple[World, Mission | None, Mission | None, bool], tuple[Edit, ...]] = {}

    def menu(robot: Robot) -> tuple[tuple[int, bool, Edit], ...]:
        here = situation(robot)
        edits = dict.fromkeys(_edits(here, calls, happenings, assumed))
        return tuple((_added(edit), _forgets(edit), edit) for edit in edits if edit)

    def successors(robot: Robot) -> list[Robot]:
        done, active, pending = robot.done, robot.active, robot.pending
        key = (robot.world, active, not pending, not done, robot.halted, robot.fresh, robot.fault)
        edits = menus.get(key)
        if edits is None:
            edits = menus[key] = menu(robot)
        room = most - len(done) - (active is not None) - len(pending)
        after = [
            _apply(edit, robot)
            for added, forgets, edit in edits
            if added <= room or (forgets and added <= room + len(done))
        ]
        head = pending[0] if pending else None
        at_once = (robot.world, active, head, robot.halted)
        starts = started.get(at_once)
        if starts is None:
            ways = due(robot.world, active, head, halted=robot.halted, queued=head is not None)
            starts = started[at_once] = tuple(edit for edit, assumes in ways if meet(assumed, assumes))
        if starts:
            after += [_apply(edit, robot) for edit in starts]
        return after

    return successors


def _apply(edit: Edit, robot: Robot) -> Robot:
    """`missionfsm.bear.mission.apply`, with the commonest edits written out."""
    if len(edit) == 1:
        ((op, what),) = edit
        if op is Op.BECOME:
            return Robot(robot.world, robot.done, what, robot.pending, robot.halted, robot.fresh, robot.fault)
        if op is Op.ADD:
            return Robot(robot.world, robot.done, robot.active, robot.pending + what, robot.halted, False, robot.fault)  # noqa: FBT003
        if op is Op.END:
            return Robot(robot.world, (*robot.done, what), None, robot.pending, robot.halted, robot.fresh, robot.fault)
        if op is Op.START:
            return Robot(robot.world, robot.done, what, robot.pending[1:], robot.halted and len(robot.pending) > 1, robot.fresh, robot.fault)
    return apply(edit, robot)


def _edits(
    robot: Situation, calls: Iterable[Call], happenings: Iterable[Happening], assumed: int
) -> Iterator[Edit]:
    for call in calls:
        if call.target is not None and not _possible(robot, call.target):
            continue
        for outcome in outcomes(OPERATIONS[call.request.operation], robot, call):
            if meet(assumed, outcome.assumes):
                yield outcome.edit
    for happening in happenings:
        for edit, assumes in happens(robot, happening):
            if meet(assumed, assumes):
                yield edit


def _possible(robot: Situation, target: Target) -> bool:
    """Whether a robot in this situation has a mission there to name."""
    return {
        Target.ACTIVE: robot.active is not None,
        Target.QUEUED: robot.queued,
        Target.ENDED: robot.ended,
        Target.UNKNOWN: True,
    }[target]


def _added(edit: Edit) -> int:
    """How many missions an edit adds to the list."""
    return sum(len(what) for op, what in edit if op in (Op.ADD, Op.PUT_FIRST))


def _forgets(edit: Edit) -> bool:
    """Whether an edit makes room by taking the ended missions off the list."""
    return any(op in (Op.FORGET_ENDED, Op.CLEAR) for op, _ in edit)
