"""Time that a tester lets pass at the server: clocks strike, passes come, and what follows happens when they do.

An exact simulation over intervals: everything that is due has an earliest and a latest moment, and the order in which
things happen is any that these allow, in each part of the server by itself (`missionfsm.isaac.server.independence`).
Only what must have happened by the end is decided. What may have happened is left open: its clock says since when it
may have struck, its connection since when a pass may have come. It is decided when something is observed that tells of
it, or turns out not to have happened before (both in `unseen`). Where all moments are exact, which they are unless
AI-39 is read as b, nothing is left open but what falls on the very end. Time that a log tells of is in `elapsing`.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Iterable, Iterator

from attrs import define, evolve, field

from missionfsm.isaac.server.clocks import counting
from missionfsm.isaac.server.connections import inherited
from missionfsm.isaac.server.deciding import merged, unusual, ways
from missionfsm.isaac.server.dispatch import followed, in_vain
from missionfsm.isaac.server.independence import Part, parts
from missionfsm.isaac.server.indifference import downstream, makes_no_difference
from missionfsm.isaac.server.losing import forgotten
from missionfsm.isaac.server.readings import AI_39_ORDER
from missionfsm.isaac.server.scheduling import (
    EVER,
    after_pass,
    dropped_unnoticed,
    held_back,
    overlooked,
    pass_by,
    sent_before,
    taken_up,
    waits_for_pass,
)
from missionfsm.isaac.server.shifting import shifted
from missionfsm.isaac.server.state import Clock, Move, Server
from missionfsm.isaac.server.striking import strikes
from missionfsm.kernel.values import value

FEW = 8
"""Of so many ways, what falls on the very end of a time has happened rather than not; of more, it is left open."""

MANY = 64
"""More than so many ways in which time may pass are worked out one by one."""


@value(cache_hash=True)
class _Moment:
    """A moment on the way, in one part: what was done until then, and what the server has yet to look at.

    Attributes:
        low: the moment at the earliest.
        awaited: slots of connections for which a pass would do something, each with since when, at the earliest and at
            the latest.
    """

    move: Move
    low: int
    awaited: tuple[tuple[int, int, int], ...]


def passes(state: Server, time: int) -> Iterable[Move]:
    """Everything that may have become of a server when so many microseconds have passed.

    Where that is much, it is worked out as it is asked for, with what is read in its usual way first.
    """
    begins = [Move(state)]
    for part in parts(state):
        begins = [other for move in begins for after in followed(move, part) for other in _in_order(after, part)]
    moves = _all_until(begins, state, time, due=False, most=MANY)
    if moves is None:
        return _one_by_one(begins, state, time)
    if any(_falls_on(move.state, time) for move in moves):  # it has happened rather than not
        moves = (_all_until(begins, state, time, due=True, most=FEW) or []) + moves
    return merged(_apart(moves, time))


def _one_by_one(begins: list[Move], state: Server, time: int) -> Iterator[Move]:
    """The same where it is much, one after the other."""

    def onwards(move: Move, left: tuple[Part, ...]) -> Iterator[Move]:
        if not left:
            yield move
            return
        for after in _until(move, left[0], time, due=False, usual_first=True):
            yield from onwards(after, left[1:])

    moves = (after for move in sorted(begins, key=_unusual) for after in onwards(move, parts(state)))
    yield from _apart(moves, time)


def _apart(moves: Iterable[Move], time: int) -> Iterator[Move]:
    """The moves at the end of a time, each once."""
    found: set[object] = set()
    for move in moves:
        after = shifted(move, time)
        if (after.state, after.sent) not in found:
            found.add((after.state, after.sent))
            yield after


def _in_order(move: Move, part: Part) -> list[Move]:
    """AI-39.order is decided where a pass is about to send to a name that none need have taken up."""
    held = any(
        link.held[1] and link.slot in part.slots and waits_for_pass(move.state, link) for link in move.state.links
    )
    return [way for _, way in ways(move, AI_39_ORDER, "n", "s")] if held else [move]


def _all_until(
    begins: list[Move], state: Server, time: int, *, due: bool, most: int | None = None
) -> list[Move] | None:
    """What may have become of all parts at a time; None where that is more than `most`."""
    moves = begins
    for part in parts(state):
        found = itertools.chain.from_iterable(_until(move, part, time, due=due) for move in moves)
        few = list(found if most is None else itertools.islice(found, most + 1))
        if most is not None and len(few) > most:
            return None
        moves = list(merged(few))
    return moves


def _falls_on(state: Server, time: int) -> bool:
    """Whether a clock that has not struck is due at this very moment at the latest."""
    return any(clock.hi == time for index in range(len(state.missions)) for clock in counting(state, index))


def _until(move: Move, part: Part, time: int, *, due: bool, usual_first: bool = False) -> Iterator[Move]:
    """What may have become of a part at a time, with all decided that must have happened by then.

    Args:
        due: whether a clock that must have struck by that very moment has; passes have come.
        usual_first: whether what is read in its usual way comes first.
    """
    todo = _ToDo(usual_first)
    todo.add([_moment(evolve(move, at=(0, 0)), -EVER, part, ())])
    for here in todo:
        strike, comes = _latest(here, part)
        if comes > time and (strike > time or (strike == time and not due)):
            since = {slot: first for slot, first, _ in here.awaited if first <= time}
            after = here.move
            for slot in part.slots:
                link = after.state.link_at(slot)
                if link is not None and link.pass_since != since.get(slot):
                    after = after.with_link(slot, pass_since=since.get(slot))
            yield evolve(after, at=(0, 0))
            continue
        todo.add(list(_next(here, part, int(min(strike, comes)))))


@define(eq=False)
class _ToDo:
    """Moments to go on from, each once: the first of those that were found last.

    Attributes:
        usual: whether those come before that which leave most questions to be read in their usual way.
    """

    usual: bool
    seen: set[_Moment] = field(factory=set)
    heap: list[tuple[int, int, _Moment]] = field(factory=list)
    added: int = 0

    def add(self, found: list[_Moment]) -> None:
        for one in reversed(found):
            order = _unusual(one.move) if self.usual else 0
            self.added += 1
            heapq.heappush(self.heap, (order, -self.added, one))

    def __iter__(self) -> Iterator[_Moment]:
        while self.heap:
            _, _, here = heapq.heappop(self.heap)
            if here not in self.seen:
                self.seen.add(here)
                yield here


def _unusual(move: Move) -> int:
    """How many questions cannot be read in their usual way any more."""
    return unusual(move.state.left)


def _moment(move: Move, low: int, part: Part, awaited: tuple[tuple[int, int, int], ...]) -> _Moment:
    """The moment after a move, with the passes that are waited for."""
    known = {slot: (first, last) for slot, first, last in awaited}
    found = []
    for slot in part.slots:
        link = move.state.link_at(slot)
        if link is not None and waits_for_pass(move.state, link):
            first, last = known.get(slot, move.at)
            since = first if link.pass_since is None else min(first, -link.pass_since)
            found.append((slot, max(since, held_back(move.state, link)), last))
    return _Moment(move, low, tuple(found))


def _latest(here: _Moment, part: Part) -> tuple[float, float]:
    """Until when a clock has to have struck in a part, and a pass to have come, at the latest."""
    state = here.move.state
    due = (clock.hi for index in part.missions for clock in counting(state, index) if clock.hi is not None)
    looks = [pass_by(state, slot, last) for slot, _, last in here.awaited]
    looks += [gone.fresh for gone in dropped_unnoticed(state, part)]
    looks += [link.fresh for _, link in overlooked(state, part)]
    return min(due, default=math.inf), min(looks, default=math.inf)


def _next(here: _Moment, part: Part, until: int) -> Iterator[_Moment]:
    """Everything that may happen next in a part, no later than `until`.

    What ends a mission and makes no difference to anything else until then may as well happen later: it is left open.
    Where it must have happened by then it comes first of all.
    """
    state = here.move.state
    found = [(index, one) for index in part.missions for one in counting(state, index) if one.lo <= until]
    idle = [(index, one) for index, one in found if makes_no_difference(state, index, one, until)]
    for index, clock in idle:
        if clock.hi is not None and clock.hi <= until:
            yield from _ends_quietly(here, part, index, clock)
            return
    for index, clock in found:
        if (index, clock) not in idle:
            yield from _strike(here, part, index, clock, until)
    yield from _passes(here, part, until)
    yield from _unnoticed(here, part, until)


def _passes(here: _Moment, part: Part, until: int) -> Iterator[_Moment]:
    """A scheduling pass comes to a connection."""
    for slot, first, last in here.awaited:
        when = (max(here.low, first), min(pass_by(here.move.state, slot, last), until))
        if when[0] <= when[1]:
            rest = tuple(one for one in here.awaited if one[0] != slot)
            for after in after_pass(evolve(here.move, at=when), slot, part):
                yield _moment(after, when[0], part, rest)


def _unnoticed(here: _Moment, part: Part, until: int) -> Iterator[_Moment]:
    """Something is sent that reaches nobody, since no pass has noticed yet who is there; or a pass notices it."""
    state = here.move.state
    for gone in dropped_unnoticed(state, part):
        when = (here.low, max(here.low, min(gone.fresh, until)))
        for sent in in_vain(evolve(here.move, at=when), gone):
            yield from (_moment(after, when[0], part, here.awaited) for after in followed(sent, part))
        if gone.fresh <= until:
            yield _moment(forgotten(here.move, gone), here.low, part, here.awaited)
    for older, link in overlooked(state, part):
        when = (here.low, max(here.low, min(link.fresh, until)))
        for after in sent_before(evolve(here.move, at=when), older, link):
            yield _moment(after, when[0], part, here.awaited)
        if link.fresh <= until:
            yield _moment(taken_up(here.move, link), here.low, part, here.awaited)


def _strike(here: _Moment, part: Part, index: int, clock: Clock, until: int) -> Iterator[_Moment]:
    low = max(here.low, clock.lo)
    when = (low, max(low, until if clock.hi is None else min(clock.hi, until)))
    due = clock.hi is not None and clock.hi <= until
    aborting, meaningless = strikes(evolve(here.move, at=when), index, clock, due=due)
    for one in aborting:
        for heard in inherited(here.move.state, one):
            yield from (_moment(after, low, part, here.awaited) for after in followed(heard, part))
    if due:
        for one in meaningless:
            yield from (_moment(after, here.low, part, here.awaited) for after in followed(one, part))


def _ends_quietly(here: _Moment, part: Part, index: int, clock: Clock) -> Iterator[_Moment]:
    """A clock has struck that makes no difference; how a mission has ended is left open where others are about it."""
    state = here.move.state
    mission = state.missions[index]
    held = bool(mission.waits or mission.doomed or downstream(state.missions, index))
    move = evolve(here.move, at=(clock.lo, clock.hi if clock.hi is not None else clock.lo))
    for one in (*(both := strikes(move, index, clock, due=True, held=held))[0], *both[1]):
        yield from (_moment(after, here.low, part, here.awaited) for after in followed(one, part))
