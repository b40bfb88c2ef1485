"""What becomes of missions when connections go, are taken over or are back (AI-15, AI-16).

Every function takes a `Move` and gives the moves that it can lead to, as in `lifecycle`.
"""

from __future__ import annotations

from attrs import evolve

from missionfsm.isaac.server.clocks import Moves, started, stopped, ticking
from missionfsm.isaac.server.deciding import ways
from missionfsm.isaac.server.lifecycle import becomes, ends, to_be_noticed
from missionfsm.isaac.server.readings import AI_15, AI_15_SENT, AI_15_WHEN, AI_39, AI_39_ORDER
from missionfsm.isaac.server.state import (
    DROP,
    RUN,
    SILENT,
    START,
    UNDER_WAY,
    WAITS,
    Clock,
    Closes,
    Link,
    Mission,
    Move,
    Server,
    Status,
)
from missionfsm.kernel.readings import Ambiguity


def yet_to_be_seen(move: Move, link: Link, before: Server) -> Move:
    """The server has closed a connection, which is told."""
    still = Link(link.slot, closing=True)
    links = (still if one.slot == link.slot else move.state.link_at(one.slot) for one in before.links)
    return move.to(evolve(move.state, links=tuple(one for one in links if one is not None))).emit(
        link.slot, -1, Closes()
    )


def untimed(move: Move, slot: int) -> Move:
    """What was sent on an older connection goes on there without its timeouts (AI-16.under-way m)."""
    for index, mission in enumerate(move.state.missions):
        if mission.status in UNDER_WAY and mission.sent_on == slot:
            move = move.with_mission(index, start=None, run=None, clocks=())
    return move


def closed(move: Move, link: Link, *, seen: bool = False) -> Moves:
    """A connection is gone; `seen`: what is sent on it all the same may be seen."""
    state = move.state
    # A connection that took over from this one unnoticed took over from the one before, if that is still there.
    links = tuple(
        one if one.over != link.slot else evolve(one, over=link.over, fresh=one.fresh if link.over is not None else 0)
        for one in state.links
        if one.slot != link.slot
    )
    gone = state.gone
    served = link.serves or any(one.over == link.slot for one in state.links)  # as far as a pass has noticed
    if served and "b" in state.letters(AI_39) and "s" in state.letters(AI_39_ORDER):
        until = state.next_pass(move.at[1]) + state.tolerance
        slot = link.slot if seen else min((0, *(one.slot for one in gone))) - 1
        gone = (*gone, Link(slot, link.name, serves=True, fresh=until))
    yield from lost(move.to(evolve(state, links=links, gone=gone)), link, still=seen)


def forgotten(move: Move, gone: Link) -> Move:
    """A pass has noticed that a connection dropped."""
    rest = (evolve(one, serves=False) if one.slot == gone.slot else one for one in move.state.gone)
    return move.to(evolve(move.state, gone=tuple(one for one in rest if one.serves or one.slot >= 0)))


def lost(move: Move, link: Link, *, still: bool = False) -> Moves:
    """A connection is no robot's any more: what was sent on it goes on, is sent again, or has failed (AI-15)."""
    missions = move.state.missions
    move = unconnected(move, link)
    held = [index for index, mission in enumerate(missions) if mission.lingers and _was_on(mission, link)]
    free = kept = move
    for index in held:
        free, kept = free.with_mission(index, lingers=""), kept.with_mission(index, sent_on=None)
    affected = [index for index, one in enumerate(missions) if one.status in UNDER_WAY and _was_on(one, link)]
    # AI-08 d: a robot that has a newer connection may be held to what was aborted on an older one that drops.
    moves = [free, kept] if held and not link.serves else [free]
    for index in affected:
        moves = [after for one in moves for after in _lost_mission(one, index, still=still)]
    yield from moves


def shared(server: Server, link: Link, name: str | None) -> bool:
    """Whether a robot is there on another connection than this one (AI-16 s)."""
    return any(one.serves and one.name == name and one.slot != link.slot for one in server.links)


def unconnected(move: Move, link: Link) -> Move:
    """The time to start that counts from when a robot connects counts no more for what waits for one that has gone.

    Where it may be over by now, that may have been noticed before, or be noticed later.
    """
    if not link.serves or shared(move.state, link, link.name):
        return move
    for index, mission in enumerate(move.state.missions):
        if mission.robot == link.name and mission.queued:
            clocks = (
                evolve(one, hi=None) if (one.kind, one.since) == (START, "connect") else one
                for one in mission.clocks
                if (one.kind, one.since) != (START, "connect") or one.lo <= move.at[1]
            )
            move = ticking(move, index, clocks)
    return move


def dropped(mission: Mission) -> Ambiguity:
    """The question what becomes of a mission under way when the connection drops that it was sent on."""
    return AI_15_SENT if mission.status is Status.STARTED else AI_15


def _lost_mission(move: Move, index: int, *, still: bool) -> Moves:
    for letter, way in ways(move, dropped(move.state.missions[index]), "c", "a", "b"):
        here = way.with_mission(index, sent_on=None)
        if letter == "a":
            yield here
            continue
        for when, noticed in ways(here, AI_15_WHEN, "n", "p", "r", "g"):
            if when == "n":
                yield ends(noticed, index, "lose") if letter == "c" else sent_again(noticed, index)
            elif when == "p":
                yield to_be_noticed(noticed, index, DROP, still=still)
            elif when == "g":
                yield _in_grace(noticed, index, still=still)
            else:
                yield noticed


def _in_grace(move: Move, index: int, *, still: bool) -> Move:
    """A mission fails after a while, of which nothing says how long it is, unless its robot is back before."""
    clocks = move.state.missions[index].clocks
    if any(one.kind == DROP for one in clocks):
        return move
    soonest = move.at[0] + (still and not move.state.tolerance)
    return ticking(move, index, (*clocks, Clock(DROP, DROP, soonest, None)))


def back(move: Move, robot: str | None) -> Moves:
    """A robot is there again: what was under way when its connection dropped goes on, or ends now (AI-15.when)."""
    moves = [move]
    for index, mission in enumerate(move.state.missions):
        if mission.robot == robot and mission.sent_on is None and mission.status in UNDER_WAY:
            moves = [after for one in moves for after in _back(one, index)]
    yield from moves


def _back(move: Move, index: int) -> Moves:
    when = move.state.letters(AI_15_WHEN)
    if when == "g":
        yield stopped(move, index, (DROP, "drop"))
    elif when == "r":
        for letter, way in ways(move, dropped(move.state.missions[index]), "a", "b", "c"):
            if letter == "a":
                yield way
            else:
                yield ends(way, index, "lose") if letter == "c" else sent_again(way, index)
    else:
        yield move


def _was_on(mission: Mission, link: Link) -> bool:
    return mission.sent_on == link.slot or (link.serves and mission.sent_on is None and mission.robot == link.name)


def sent_again(move: Move, index: int) -> Move:
    """A mission that was sent is queued again (AI-15 b)."""
    move = becomes(move, index, "send again later").with_mission(index, sent_on=None)
    gone = (
        (START, "send"),
        (START, "ready"),
        (START, "connect"),
        (RUN, "send"),
        (RUN, WAITS),
        (RUN, "status"),
        (SILENT, "status"),
        (DROP, "drop"),
    )
    return started(stopped(move, index, *gone), index, START, "ready")
