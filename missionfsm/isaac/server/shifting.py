"""A server so much later: clocks say how much is left from there on, and connections since when they wait."""

from __future__ import annotations

from attrs import evolve

from missionfsm.isaac.server.dispatch import tidy
from missionfsm.isaac.server.scheduling import taken_up
from missionfsm.isaac.server.state import Link, Mission, Move


def shifted(move: Move, time: int) -> Move:
    """The end of it: clocks say how much is left from here on."""
    missions = tuple(_with_clocks_shifted(one, time) for one in move.state.missions)
    after = evolve(tidy(move), state=evolve(move.state, missions=missions), at=(0, 0))
    for link in move.state.links:
        if link.pass_since is not None:
            after = after.with_link(link.slot, pass_since=time - link.pass_since)
        if link.fresh:
            after = _takeover_noticed(after, link, time)
        if link.held[1]:
            first, last = link.held
            after = after.with_link(link.slot, held=(max(0, first - time), max(0, last - time)))
    state = after.state
    if state.slow or state.gone:
        gone = tuple(_gone(one, time) for one in state.gone if one.fresh > time or (one.fresh and one.slot >= 0))
        after = after.to(evolve(state, slow=max(0, state.slow - time), gone=gone))
    return after


def _with_clocks_shifted(mission: Mission, time: int) -> Mission:
    """A mission whose clocks say how much is left so much later."""
    if mission.rests:
        mission = evolve(mission, rests=max(0, mission.rests - time))
    if mission.new is not None:
        mission = evolve(mission, new=mission.new and not time)
    if mission.was is not None:
        status, left, fresh = mission.was
        mission = evolve(mission, was=(status, left - time, fresh and not time) if left > time else None)
    if not mission.clocks:
        return mission
    if mission.overdue:
        return _with_clocks_stopped(mission, time)
    clocks = (
        evolve(clock, lo=clock.lo - time, hi=None if clock.hi is None else max(0, clock.hi - time))
        for clock in mission.clocks
    )
    return evolve(mission, clocks=tuple(clocks))


def _with_clocks_stopped(mission: Mission, time: int) -> Mission:
    """A mission that has ended, nobody knows how: of its clocks only which came first matters, not how long ago."""
    latest = max(clock.lo for clock in mission.clocks)
    by = min(time, max(0, latest))
    clocks = (evolve(one, lo=one.lo - by, hi=None if one.hi is None else one.hi - by) for one in mission.clocks)
    return evolve(mission, clocks=tuple(clocks))


def _gone(link: Link, time: int) -> Link:
    """A connection that dropped, so much later; it is forgotten only later still: what was sent on it may be seen."""
    left = max(0, link.fresh - time)
    return evolve(link, fresh=left, serves=link.serves and left > 0)


def _takeover_noticed(move: Move, link: Link, time: int) -> Move:
    """A connection that took over from another, so much later: a pass has noticed it after a while."""
    if link.fresh <= time:
        return taken_up(move, link)
    return move.with_link(link.slot, fresh=link.fresh - time)
