"""The steps of a robot for the explorer: what a situation allows is found once, as edits, and then only applied.

Most steps of a robot depend on its situation alone, and there are few of those; robots are told apart as numbers. How
missions are listed that did not have their turns in the order in which they were assigned decides nothing that comes.
``tests/bear/test_mission_explore.py`` holds this to what `missionfsm.bear.mission.spec` says step by step.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from missionfsm.bear.mission.edits import ADDITIONS, LISTING_ANEW, Edit, Op
from missionfsm.bear.mission.effects import outcomes
from missionfsm.bear.mission.events import Event, apply_event, by_itself, due
from missionfsm.bear.mission.inputs import Call, Request, Target
from missionfsm.bear.mission.operations import OPERATIONS
from missionfsm.bear.mission.state import Fault, Kind, Mission, Robot, Situation, World, situation
from missionfsm.bear.wire.messages import State
from missionfsm.kernel.readings import meet

Code = tuple[int, tuple[int, ...], tuple[int, ...]]
"""A robot as numbers: its frame, its ended missions, those that wait."""

_Frame = tuple[World, Mission | None, bool, bool, Fault | None]
"""What of a robot is not a list: its world, its active mission, whether it is halted and fresh, its fault."""

_Ops = tuple[tuple[Op, tuple[int, ...]], ...]


_Move = tuple[int, int, int, bool, bool, _Ops]
"""An edit as numbers: the frame after it where missions wait then, and where none does; how many missions it adds, and
whether it makes room by taking the ended ones off the list, and those that wait; what becomes of the lists."""

_Step = tuple[int, bool, tuple[int, ...], tuple[int, ...]]
"""A step of robots for which the same missions wait: the frame after it, whether it takes the ended ones off the list,
those that come to them, and those that wait then."""


class Shortcut:
    """The steps of robots that change them, within `most` listed missions, on robots as numbers.

    Args:
        requests, events: what is tried.
        assumed: the readings that are possible.
        forget_ended: what has ended is only counted (see `forget_ended`).
    """

    def __init__(
        self,
        requests: Iterable[tuple[Request, tuple[bool, ...]]],
        events: Iterable[Event],
        assumed: int,
        most: int,
        *,
        forget_ended: bool = False,
    ) -> None:
        self._calls = tuple(
            Call(request, target) for request, named in requests for target in (tuple(Target) if named else (None,))
        )
        self._events = tuple(events)
        self._assumed = assumed
        self._most = most
        self._forget = forget_ended
        self._frames: dict[_Frame, int] = {}
        self._frame: list[_Frame] = []
        self._missions: dict[Mission, int] = {}
        self._mission: list[Mission] = []
        self._steps: dict[tuple[int, tuple[int, ...], int], tuple[_Step, ...]] = {}
        self._menus: dict[tuple[int, bool, bool], tuple[_Move, ...]] = {}
        self._starts: dict[tuple[int, int], tuple[_Move, ...]] = {}
        self._counted = self._number(_COUNTED)

    def encode(self, robot: Robot) -> Code:
        """The numbers of a robot."""
        frame = (robot.world, robot.active, robot.halted, robot.fresh, robot.fault)
        ended = (self._counted,) * len(robot.done) if self._forget else self._numbers(robot.done)
        return self._frame_number(frame), ended, self._numbers(robot.pending)

    def decode(self, code: Code) -> Robot:
        """The robot with these numbers."""
        frame, done, pending = code
        world, active, halted, fresh, fault = self._frame[frame]
        known = self._mission.__getitem__
        return Robot(world, tuple(map(known, done)), active, tuple(map(known, pending)), halted, fresh, fault)

    def successors(self, code: Code) -> list[Code]:
        """The robots after every step, in any order and perhaps some twice."""
        frame, done, pending = code
        known = frame, pending, len(done)
        steps = self._steps.get(known)
        if steps is None:
            steps = self._steps[known] = tuple(self._possible_steps(code))
        return [(after, ended if forgets else done + ended, waiting) for after, forgets, ended, waiting in steps]

    def _possible_steps(self, code: Code) -> Iterator[_Step]:
        """The steps for which there is room: which missions have ended before decides nothing, only how many."""
        frame, done, pending = code
        menu = frame, not pending, not done
        if menu not in self._menus:
            self._menus[menu] = self._menu(code)
        start = frame, pending[0] if pending else -1
        if start not in self._starts:
            self._starts[start] = self._due(code)
        room = self._most - len(done) - (self._frame[frame][1] is not None) - len(pending)
        for busy, idle, added, forgets, drops, ops in (*self._menus[menu], *self._starts[start]):
            if added <= room or added <= room + forgets * len(done) + drops * len(pending):
                ended, waiting = self._moved(ops, (), pending)
                yield busy if waiting else idle, forgets, ended, waiting

    def _moved(
        self, ops: _Ops, done: tuple[int, ...], pending: tuple[int, ...]
    ) -> tuple[tuple[int, ...], tuple[int, ...]]:
        for op, what in ops:
            if op is Op.ADD:
                pending += what
            elif op is Op.END:
                done += what
            elif op is Op.START:
                pending = pending[1:]
            elif op is Op.FORGET_ENDED:
                done = ()
            elif op is Op.END_QUEUE:
                move = _MOVES[what[0]]
                done, pending = (*done, *self._numbers_ended(self._mission[one].moved(move) for one in pending)), ()
            elif op is Op.HOLD:
                pending = what + pending[1:]
            elif op in (Op.PUT_FIRST, Op.OVERTAKE):
                pending = what + pending
            elif op is Op.DROP_QUEUE:
                pending = ()
            elif op is Op.CLEAR:
                done = pending = ()
        return done, pending

    def _number(self, mission: Mission) -> int:
        number = self._missions.get(mission)
        if number is None:
            number = self._missions[mission] = len(self._mission)
            self._mission.append(mission)
        return number

    def _numbers(self, missions: Iterable[Mission]) -> tuple[int, ...]:
        return tuple(map(self._number, missions))

    def _numbers_ended(self, missions: Iterable[Mission]) -> tuple[int, ...]:
        return tuple(self._counted if self._forget else self._number(one) for one in missions)

    def _frame_number(self, frame: _Frame) -> int:
        number = self._frames.get(frame)
        if number is None:
            number = self._frames[frame] = len(self._frame)
            self._frame.append(frame)
        return number

    def _menu(self, code: Code) -> tuple[_Move, ...]:
        here = situation(self.decode(code))
        edits = dict.fromkeys(_edits(here, self._calls, self._events, self._assumed))
        return tuple(self._compiled(edit, self._frame[code[0]]) for edit in edits if edit)

    def _due(self, code: Code) -> tuple[_Move, ...]:
        robot = self.decode(code)
        head = robot.pending[0] if robot.pending else None
        queued = head is not None
        ways = (
            *due(robot.world, robot.active, head, halted=robot.halted, queued=queued),
            *by_itself(robot.world, robot.active, head, halted=robot.halted, queued=queued),
        )
        edits = (edit for edit, assumes in ways if meet(self._assumed, assumes))
        return tuple(self._compiled(edit, self._frame[code[0]]) for edit in edits)

    def _compiled(self, edit: Edit, frame: _Frame) -> _Move:
        """An edit as numbers; what of it concerns no list is carried out here and now (see `apply`)."""
        world, active, halted, fresh, fault = frame
        ops: list[tuple[Op, tuple[int, ...]]] = []
        added = 0
        fresh = fresh and LISTING_ANEW.isdisjoint(dict(edit))
        for op, what in edit:
            if op in ADDITIONS:
                ops.append((op, self._numbers(what)))
                added += len(what)
            elif op is Op.END:
                ops.append((op, self._numbers_ended((what,))))
                active = None
            elif op is Op.HOLD:
                ops.append((op, self._numbers((what,))))
            elif op is Op.END_QUEUE:
                ops.append((op, (_MOVES.index(what),)))
            elif op in _LISTED:
                ops.append((op, ()))
                active = {Op.START: what, Op.CLEAR: None}.get(op, active)
            elif op is Op.BECOME:
                active = what
            elif op is Op.HALT:
                halted = what
            elif op is Op.ARM:
                fault = what
            elif op is Op.WORLD:
                world = what
        busy = self._frame_number((world, active, halted, fresh, fault))
        idle = self._frame_number((world, active, False, fresh, fault))
        forgets = any(op in (Op.FORGET_ENDED, Op.CLEAR) for op, _ in edit)
        drops = any(op is Op.DROP_QUEUE for op, _ in edit)
        return busy, idle, added, forgets, drops, tuple(ops)


_LISTED = frozenset({Op.START, Op.DROP_QUEUE, Op.FORGET_ENDED, Op.CLEAR})
_MOVES = ("cancel with the queue", "fail with the queue")
_COUNTED = Mission(Kind.RETURN, state=State.STATE_SUCCEEDED)


def forget_ended(robot: Robot) -> Robot:
    """The robot with its ended missions only counted: what they were, and how all are listed, decides nothing more."""
    if not (robot.done or robot.assigned):
        return robot
    done = (_COUNTED,) * len(robot.done)
    return Robot(robot.world, done, robot.active, robot.pending, robot.halted, robot.fresh, robot.fault)


def _edits(robot: Situation, calls: Iterable[Call], events: Iterable[Event], assumed: int) -> Iterator[Edit]:
    for call in calls:
        if call.target is not None and not _possible(robot, call.target):
            continue
        for outcome in outcomes(OPERATIONS[call.request.operation], robot, call):
            if meet(assumed, outcome.assumes):
                yield outcome.edit
    for event in events:
        for edit, assumes in apply_event(robot, event):
            if meet(assumed, assumes):
                yield edit


def _possible(robot: Situation, target: Target) -> bool:
    """Whether a robot in this situation has a mission there to name."""
    return {
        Target.ACTIVE: robot.active is not None,
        Target.QUEUED: robot.queued,
        Target.ENDED: robot.ended,
        Target.CLEARED: True,
        Target.UNKNOWN: True,
    }[target]
