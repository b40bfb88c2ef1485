"""Time that passes at the server: clocks strike, and what follows happens when they do.

An exact simulation over intervals: everything that is due has an earliest and a latest moment, and the order in which
things happen is any that these allow. Where all moments are exact, which they are unless AI-39 is read as b, there is
one order but for what falls on the same moment.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator

from attrs import evolve

from missionfsm.isaac.server.lifecycle import lapses, possible, sends, strikes, urgent
from missionfsm.isaac.server.readings import AI_39
from missionfsm.isaac.server.state import LOOK, Clock, Link, Move, Server, Status
from missionfsm.kernel.values import value

Look = tuple[int, int, int]
"""AI-39 b: a connection's slot, and since when a mission can be sent on it, at the earliest and at the latest."""


@value(cache_hash=True)
class _Here:
    """A moment on the way: what was done until then, and what the server has yet to look at."""

    move: Move
    looks: tuple[Look, ...]


def passes(state: Server, time: int) -> tuple[Move, ...]:
    """Everything that may have become of a server when so many microseconds have passed."""
    found: dict[object, Move] = {}
    seen: set[_Here] = set()
    todo = [_Here(Move(state), ())]
    while todo:
        here = todo.pop()
        if here in seen:
            continue
        seen.add(here)
        follows = _follows(here.move)
        if follows:
            todo += [evolve(here, move=_tidy(one)) for one in reversed(follows)]
            continue
        here = _looking(here)
        latest = _latest(here)
        later = list(_next(here, min(latest, time)))
        todo += reversed(later)
        if latest >= time and all(last + _pass(here) > time for _, _, last in here.looks):
            after = _shifted(here.move, time)
            found.setdefault((after.state, after.sent), after)
    return tuple(sorted(found.values(), key=lambda one: -_done(state, one.state)))


@functools.lru_cache(maxsize=50_000)
def _urgent(state: Server, at: tuple[int, int]) -> tuple[Move, ...]:
    return urgent(Move(state, at=at))


def _follows(move: Move) -> tuple[Move, ...]:
    return tuple(
        Move(one.state, move.sent + one.sent, move.rules + one.rules, one.at) for one in _urgent(move.state, move.at)
    )


def _done(before: Server, after: Server) -> int:
    """How many missions have another status: what is due by the very end is done rather than not."""
    return sum(one.status is not other.status for one, other in zip(before.missions, after.missions, strict=True))


def _tidy(move: Move) -> Move:
    """The same with rules once each, and lines by connection: their order across connections means nothing."""
    return evolve(move, rules=tuple(sorted(set(move.rules))), sent=tuple(sorted(move.sent, key=lambda one: one[0])))


def _looking(here: _Here) -> _Here:
    """Which connections a scheduling pass would send something on or cancel something for, and since when."""
    state = here.move.state
    known = {slot: (first, last) for slot, first, last in here.looks}
    looks = tuple(
        (link.slot, *known.get(link.slot, here.move.at))
        for link in state.links
        if link.serves and ((state.letters(AI_39) == "b" and possible(state, link)) or lapses(state, link))
    )
    return evolve(here, looks=looks)


def _pass(here: _Here) -> int:
    """How long a scheduling pass is in coming at the latest, in microseconds."""
    return here.move.state.tolerance + LOOK


def _latest(here: _Here) -> float:
    """Until when something has to have happened, at the latest."""
    due = [clock.hi for mission in here.move.state.missions for clock in mission.clocks if clock.hi is not None]
    due += [last + _pass(here) for _, _, last in here.looks]
    return min(due, default=math.inf)


def _next(here: _Here, until: float) -> Iterator[_Here]:
    """Everything that may happen next, no later than `until`."""
    low, _ = here.move.at
    for index, mission in enumerate(here.move.state.missions):
        for clock in mission.clocks:
            if clock.lo <= until:
                yield from _strike(here, index, clock, until)
    for slot, first, last in here.looks:
        link = here.move.state.link(slot)
        when = (max(low, first), int(min(last + _pass(here), until)))
        if link is None or when[0] > when[1]:
            continue
        at = evolve(here.move, at=when)
        rest = tuple(one for one in here.looks if one[0] != slot)
        for lapsed in lapses(here.move.state, link):
            ended = Move(lapsed.state, at.sent, at.rules + lapsed.rules, when)
            yield _Here(_tidy(ended), rest)
        for index, chosen in possible(here.move.state, link) if here.move.state.letters(AI_39) == "b" else ():
            for after in sends(at.to(chosen.state), link, index):
                yield _Here(_tidy(after), rest)


def _strike(here: _Here, index: int, clock: Clock, until: float) -> Iterator[_Here]:
    low, _ = here.move.at
    last = until if clock.hi is None else min(clock.hi, until)
    when = (max(low, clock.lo), int(max(low, last)))
    if when[0] > when[1]:
        return
    aborting, meaningless = strikes(evolve(here.move, at=when), index, clock)
    yield from (evolve(here, move=_tidy(one)) for one in aborting)
    if clock.hi is not None and clock.hi <= until:
        yield from (evolve(here, move=evolve(_tidy(one), at=here.move.at)) for one in meaningless)


def _shifted(move: Move, time: int) -> Move:
    """The end of it: clocks say how much is left from here on."""
    missions = tuple(
        evolve(
            one,
            clocks=tuple(
                evolve(clock, lo=max(0, clock.lo - time), hi=None if clock.hi is None else max(0, clock.hi - time))
                for clock in one.clocks
            ),
        )
        if one.clocks
        else one
        for one in move.state.missions
    )
    links = tuple(_noticed(one, time) if one.fresh else one for one in move.state.links)
    return evolve(_tidy(move), state=evolve(move.state, missions=missions, links=links), at=(0, 0))


def _noticed(link: Link, time: int) -> Link:
    """A connection that took over from another, so much later: a pass has noticed it after a while."""
    fresh = max(0, link.fresh - time)
    return evolve(link, fresh=fresh, over=link.over if fresh else None)


def at_any_time(state: Server) -> tuple[Move, ...]:
    """Clocks that may strike now, though they need not before more time has passed."""
    return tuple(
        move
        for index, mission in enumerate(state.missions)
        if mission.status in (Status.QUEUED, Status.STARTED, Status.RUNNING)
        for clock in mission.clocks
        if clock.lo == 0
        for move in strikes(Move(state), index, clock)[0]
    )
