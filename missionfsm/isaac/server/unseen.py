"""What may have happened by now though nothing shows it, and the server where none of that has."""

from __future__ import annotations

import operator
from collections.abc import Iterator

from attrs import evolve

from missionfsm.isaac.server.clocks import counting
from missionfsm.isaac.server.connections import drops, inherited
from missionfsm.isaac.server.dispatch import followed, in_vain
from missionfsm.isaac.server.independence import Part
from missionfsm.isaac.server.indifference import makes_no_difference, upstream_overdue
from missionfsm.isaac.server.scheduling import (
    after_pass,
    dropped_unnoticed,
    overlooked,
    sent_before,
    waits_for_pass,
    waits_quietly,
)
from missionfsm.isaac.server.state import DROP, ENDED, PASS_PERIOD, Clock, Mission, Move, Server
from missionfsm.isaac.server.striking import settled, strikes


def unseen(state: Server, part: Part, asked: frozenset[int] | None = None) -> Iterator[Move]:
    """What may have happened in a part by now though it need not.

    Clocks that have struck, passes that have come, and where nobody says when they do, connections that have dropped.

    Args:
        asked: missions of which more is asked than what else happens; None: all of them.
    """
    yield from _unsaid(state, part, asked)
    if state.unsteady:
        for link in state.links:
            if link.slot in part.slots:
                yield from drops(Move(state), link, seen=True)


def _unsaid(state: Server, part: Part, asked: frozenset[int] | None) -> Iterator[Move]:
    for struck in _struck(state, part, asked):
        yield from (_pass_possible_since(after, part) for after in followed(struck, part))
    for slot in part.slots:
        link = state.link_at(slot)
        if link is not None and link.pass_since is not None:
            for one in after_pass(Move(state, at=(-link.pass_since, 0)), slot, part):
                yield _pass_possible_since(one, part)
    for gone in dropped_unnoticed(state, part):
        for one in in_vain(Move(state, at=(-PASS_PERIOD, 0)), gone):
            yield from (_pass_possible_since(after, part) for after in followed(one, part))
    for older, link in overlooked(state, part):
        yield from (
            _pass_possible_since(after, part) for after in sent_before(Move(state, at=(-PASS_PERIOD, 0)), older, link)
        )


def _struck(state: Server, part: Part, asked: frozenset[int] | None) -> Iterator[Move]:
    """A clock has struck by now."""
    yield from _told_apart(state, part, asked)
    for index in part.missions:
        anyway = asked is None or index in asked
        for clock in counting(state, index):
            if clock.lo <= 0 and (anyway or not makes_no_difference(state, index, clock, 0)):
                for one in strikes(Move(state, at=(clock.lo, 0)), index, clock, due=False)[0]:
                    yield from inherited(state, one)


def _told_apart(state: Server, part: Part, asked: frozenset[int] | None) -> Iterator[Move]:
    """How the first mission has ended of those of which that was left open and which tell something of the others."""
    missions = state.missions
    about = [index for index in part.missions if asked is None or index in asked]
    ended = {at for index in about for at in ((index,) if missions[index].overdue else ())}
    ended |= {at for index in about for at in upstream_overdue(missions, index)}
    if ended:
        yield from settled(Move(state), min(ended))


def _pass_possible_since(move: Move, part: Part) -> Move:
    """After something that happened unseen: a pass may have come since."""
    low = move.at[0]
    for slot in part.slots:
        link = move.state.link_at(slot)
        if link is None:
            continue
        look = None
        if waits_for_pass(move.state, link) if low < 0 else waits_quietly(move.state, link):
            look = -low if link.pass_since is None else min(link.pass_since, -low)
        if look != link.pass_since:
            move = move.with_link(slot, pass_since=look)
    return evolve(move, at=(0, 0))


def calmed(state: Server) -> Server:
    """The server once all has been seen that was sent: what was cancelled in a pass would not have been."""
    after = nothing_open_happened(state)
    for link in state.links:
        if link.pass_since is not None and waits_quietly(after, link):
            after = Move(after).with_link(link.slot, pass_since=0).state
    return after


def nothing_open_happened(state: Server, only: tuple[Part, ...] | None = None) -> Server:
    """The server where nothing that is left open has happened before now, in some of its parts or in all.

    When a drop is noticed is left open: what follows may look as before.
    """
    if only is None:
        only = (Part(tuple(range(len(state.missions))), tuple(link.slot for link in state.links)),)
    missions, links = list(state.missions), list(state.links)
    for part in only:
        for index in part.missions:
            missions[index] = _none_struck(missions[index])
        links = [
            evolve(one, pass_since=None) if one.pass_since is not None and one.slot in part.slots else one
            for one in links
        ]
    unchanged = all(map(operator.is_, missions, state.missions)) and all(map(operator.is_, links, state.links))
    return state if unchanged else evolve(state, missions=tuple(missions), links=tuple(links))


def _none_struck(mission: Mission) -> Mission:
    """The mission of which no clock has struck before now."""
    if mission.status in ENDED or mission.overdue or not any(_may_have_struck(clock) for clock in mission.clocks):
        return mission
    clocks = (evolve(clock, lo=0) if _may_have_struck(clock) else clock for clock in mission.clocks)
    return evolve(mission, clocks=tuple(clocks))


def _may_have_struck(clock: Clock) -> bool:
    return clock.lo < 0 and clock.kind != DROP
