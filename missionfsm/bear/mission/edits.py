"""The edits that steps make to a robot: what they do to its missions, and which names they keep."""

from __future__ import annotations

import enum
from collections.abc import Callable, Mapping
from typing import Any

from missionfsm.bear.mission.state import Mission, Robot


class Op(enum.Enum):
    """The smallest changes of a robot, each with what it takes."""

    END = "the active mission ends as this one"
    BECOME = "the active mission becomes this one"
    START = "the first waiting mission becomes active as this one"
    ADD = "these missions are appended"
    PUT_FIRST = "these missions are put before those that wait"
    OVERTAKE = "these missions have their turn before those that wait, and are listed behind them"
    HOLD = "the first waiting mission becomes this one"
    END_QUEUE = "all waiting missions end by this move"
    DROP_QUEUE = "all waiting missions vanish"
    FORGET_ENDED = "the ended missions vanish"
    CLEAR = "all missions vanish"
    HALT = "whether the queue is halted"
    ARM = "the armed fault"
    WORLD = "the world"

    __hash__ = object.__hash__  # each is one object; the hash that an enum has by itself is slow


Edit = tuple[tuple[Op, Any], ...]
"""A change of a robot, said without the missions that it leaves alone."""

Listed = tuple[tuple[Mission, ...], Mission | None, tuple[Mission, ...]]
"""The ended missions, the active one, and those that wait."""

_REARRANGED: Mapping[Op, Callable[[Listed, Any], Listed]] = {
    Op.END: lambda listed, ended: ((*listed[0], ended), None, listed[2]),
    Op.BECOME: lambda listed, active: (listed[0], active, listed[2]),
    Op.START: lambda listed, first: (listed[0], first, listed[2][1:]),
    Op.ADD: lambda listed, more: (listed[0], listed[1], listed[2] + more),
    Op.PUT_FIRST: lambda listed, more: (listed[0], listed[1], more + listed[2]),
    Op.OVERTAKE: lambda listed, more: (listed[0], listed[1], more + listed[2]),
    Op.HOLD: lambda listed, first: (listed[0], listed[1], (first, *listed[2][1:])),
    Op.END_QUEUE: lambda listed, move: ((*listed[0], *(one.moved(move) for one in listed[2])), listed[1], ()),
    Op.DROP_QUEUE: lambda listed, _: (listed[0], listed[1], ()),
    Op.FORGET_ENDED: lambda listed, _: ((), listed[1], listed[2]),
    Op.CLEAR: lambda _, __: ((), None, ()),
}
"""What each operation makes of the missions; operations that are not here set what their name says."""

ADDITIONS = (Op.ADD, Op.PUT_FIRST, Op.OVERTAKE)
"""The operations that add missions."""

LISTING_ANEW = frozenset((*ADDITIONS, Op.CLEAR))
"""The operations after which a robot is not fresh any more."""


def apply(edit: Edit, robot: Robot, names: tuple[int, ...] | None = None) -> Robot:
    """The robot after an edit; the same object if the edit is empty.

    Args:
        edit: the edit.
        robot: the robot before.
        names: the names that the edit keeps, if the caller knows them already (see `renumber`).
    """
    if not edit:
        return robot
    listed: Listed = (robot.done, robot.active, robot.pending)
    settings: dict[Op, Any] = {}
    fresh, overtakes = robot.fresh, False
    for op, what in edit:
        rearranged = _REARRANGED.get(op)
        if rearranged is None:
            settings[op] = what
            continue
        listed = rearranged(listed, what)
        fresh = fresh and op not in LISTING_ANEW
        overtakes = overtakes or op is Op.OVERTAKE
    done, active, pending = listed
    halted, fault, world = robot.halted, robot.fault, robot.world
    if settings:
        halted, fault = settings.get(Op.HALT, halted), settings.get(Op.ARM, fault)
        world = settings.get(Op.WORLD, world)
    assigned: tuple[int, ...] = ()
    if overtakes or robot.assigned:
        assigned = _assigned(robot, renumber(edit, robot)[0] if names is None else names)
    return Robot(world, done, active, pending, halted and bool(pending), fresh, fault, assigned)


def _assigned(robot: Robot, names: tuple[int, ...]) -> tuple[int, ...]:
    """How the missions are listed after an edit that keeps these names; see `Robot.assigned`."""
    before = robot.assigned or tuple(range(len(robot.turns)))
    places = [before[name] if name < len(before) else name for name in names]
    ranks = {place: rank for rank, place in enumerate(sorted(places))}
    after = tuple(ranks[place] for place in places)
    return () if after == tuple(range(len(after))) else after


def renumber(edit: Edit, robot: Robot) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Which names an edit keeps, in the order of their turns after it, and which belong to missions that vanish.

    Names are referred to as in `missionfsm.kernel.step.Step`: 0… are those before, the added ones follow.
    """
    ended, here = len(robot.done), len(robot.done) + (robot.active is not None)
    done, active = list(range(ended)), list(range(ended, here))
    total = new = here + len(robot.pending)
    pending = list(range(here, total))
    gone: list[int] = []
    for op, what in edit:
        if op is Op.END:
            done, active = done + active, []
        elif op is Op.START:
            active, pending = pending[:1], pending[1:]
        elif op in ADDITIONS:
            added = list(range(new, new + len(what)))
            new += len(what)
            pending = pending + added if op is Op.ADD else added + pending
        elif op is Op.END_QUEUE:
            done, pending = done + pending, []
        elif op is Op.DROP_QUEUE:
            gone, pending = gone + pending, []
        elif op is Op.FORGET_ENDED:
            gone, done = gone + done, []
        elif op is Op.CLEAR:
            gone, done, active, pending = gone + done + active + pending, [], [], []
    return (*done, *active, *pending), tuple(gone)
