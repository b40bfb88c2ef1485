"""Time that nobody let pass: a log tells how much was between two of its lines, or not even that."""

from __future__ import annotations

from collections.abc import Iterator

from attrs import evolve

from missionfsm.isaac.server.clocks import counting
from missionfsm.isaac.server.connections import inherited
from missionfsm.isaac.server.deciding import merged
from missionfsm.isaac.server.dispatch import followed
from missionfsm.isaac.server.independence import Part, parts
from missionfsm.isaac.server.indifference import makes_no_difference
from missionfsm.isaac.server.scheduling import EVER, after_pass, waits_for_pass
from missionfsm.isaac.server.state import PASS_PERIOD, Clock, Link, Mission, Move, Server
from missionfsm.isaac.server.striking import strikes
from missionfsm.isaac.shared.line import MICROSECONDS

ABOUT = MICROSECONDS
"""By how much the times that a log tells of its lines may be off, in microseconds. The tester's choice."""


def elapsed(state: Server, time: int | None, late: int | None) -> tuple[Move, ...]:
    """The server so much later as its log tells, or any time later: what is due may have happened, and need not.

    Where `late` is given, what is due for longer has happened, and clocks say since when they are over (`known`).
    """
    long = EVER if time is None else time
    if late is None:
        return (Move(_loosened(state, long, known=False)),)
    begins = [Move(state)]
    for part in parts(state):
        begins = [after for move in begins for after in followed(move, part)]
    here = [evolve(move, state=_loosened(move.state, long, known=True)) for move in begins]
    return merged(after for move in here for after in _overdue(move, max(late, ABOUT)))


def _loosened(state: Server, time: int, *, known: bool) -> Server:
    """The server so much later, with nothing decided of what may have happened; `known` as in `elapsed`."""
    missions = (
        _with_clocks_loosened(one, time, known=known) if one.clocks or one.was or one.new is not None else one
        for one in state.missions
    )
    links = tuple(_looked_after(state, link, time) for link in state.links)
    return evolve(state, missions=tuple(missions), links=links)


def _with_clocks_loosened(mission: Mission, time: int, *, known: bool) -> Mission:
    clocks = (
        evolve(
            clock,
            lo=clock.lo - time if clock.lo - time > ABOUT else min(clock.lo, 0),
            hi=clock.hi - time if known and clock.hi is not None else None,
        )
        for clock in mission.clocks
    )
    was = mission.was and (*mission.was[:2], False)
    new = None if mission.new is None else False
    return evolve(mission, clocks=tuple(clocks), was=was, new=new)


def _overdue(move: Move, late: int) -> Iterator[Move]:
    """The moves after all that is due for longer than that has happened."""
    seen: set[Move] = set()
    todo = [move]
    while todo:
        here = todo.pop()
        if here in seen:
            continue
        seen.add(here)
        follows = [after for part in parts(here.state) for after in _late(here, part, late)]
        if not follows:
            yield here
        todo += follows


def _late(here: Move, part: Part, late: int) -> Iterator[Move]:
    """What happens next in a part of what should have happened long ago: a clock strikes, a pass comes."""
    state = here.state
    for index, clock in _long_over(state, part, late):
        aborting, meaningless = strikes(evolve(here, at=(clock.lo, 0)), index, clock, due=True)
        struck = (*(heard for one in aborting for heard in inherited(state, one)),)
        for one in (*struck, *(_a_pass_later(other, index, clock) for other in meaningless)):
            yield from (_pass_due_since(state, after, part, late) for after in followed(one, part))
    for slot in part.slots:
        link = state.link_at(slot)
        if link is not None and link.pass_since is not None and link.pass_since >= late + PASS_PERIOD:
            for one in after_pass(evolve(here, at=(-link.pass_since, 0)), slot, part):
                yield _pass_due_since(state, one, part, late)


def _long_over(state: Server, part: Part, late: int) -> list[tuple[int, Clock]]:
    """The clocks of missions that were over so long ago; of those that make no difference the first is enough."""
    due = [
        (index, clock)
        for index in part.missions
        for clock in counting(state, index)
        if clock.hi is not None and clock.hi <= -late
    ]
    return [one for one in due if not makes_no_difference(state, *one, 0)] or due[:1]


def _pass_due_since(before: Server, move: Move, part: Part, late: int) -> Move:
    """After something that was due long ago: a pass that was waited for still is; one for what follows may be over."""
    for slot in part.slots:
        link, was = move.state.link_at(slot), before.link_at(slot)
        if link is None:
            continue
        since = None if was is None or link.pass_since is None else was.pass_since
        look = (since or late) if waits_for_pass(move.state, link) else None
        if look != link.pass_since:
            move = move.with_link(slot, pass_since=look)
    return evolve(move, at=(0, 0))


def _a_pass_later(move: Move, index: int, clock: Clock) -> Move:
    """A move in which a clock did not strike: if it runs on, it has to no later than a pass after it should have."""
    later = 0 if clock.hi is None else clock.hi + PASS_PERIOD
    clocks = (
        evolve(one, hi=later) if (one.kind, one.since, one.whole) == (clock.kind, clock.since, clock.whole) else one
        for one in move.state.missions[index].clocks
    )
    return move.with_mission(index, clocks=tuple(clocks))


def _looked_after(state: Server, link: Link, time: int) -> Link:
    """A connection for which a pass may have come within a time."""
    if not waits_for_pass(state, link):
        return link
    return evolve(link, pass_since=min(EVER, time + (link.pass_since or 0)))
