"""What happens to missions at the server: ends and their consequences, clocks that strike, connections that go.

Every function takes a `Move` and gives the moves that it can lead to, each with the readings that it decided recorded
in its state.
"""

from __future__ import annotations

import functools

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.clocks import START_CLOCKS, Moves, left_open, started, stopped, ticking, with_later_clocks
from missionfsm.isaac.server.deciding import split, ways
from missionfsm.isaac.server.independence import Part
from missionfsm.isaac.server.readings import (
    AI_03,
    AI_03_WHEN,
    AI_05,
    AI_06,
    AI_07,
    AI_08,
    AI_15,
    AI_15_SENT,
    AI_15_WHEN,
    AI_24_WHOLE,
    AI_31,
    AI_36,
    AI_39,
    AI_39_LIMITS,
    AI_39_ORDER,
)
from missionfsm.isaac.server.state import (
    DOOM,
    DROP,
    FAILURES,
    HEARD,
    LIFECYCLE,
    RUN,
    SENT,
    SILENT,
    START,
    START_COUNTS_FROM,
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


def becomes(move: Move, index: int, trigger: str) -> Move:
    """A mission moves on its chart."""
    after = LIFECYCLE.after(trigger, move.state.missions[index].status)
    assert after is not None, f"{trigger} is no move"  # noqa: S101 - callers look first
    return move.with_mission(index, status=after)


def ends(move: Move, index: int, trigger: str, *because: str) -> Move:
    """A mission ends; those that wait for it wait no longer, or are doomed."""
    move = becomes(move, index, trigger).with_mission(index, clocks=(), overdue=False)
    status = move.state.missions[index].status
    for other, mission in enumerate(move.state.missions):
        if index in mission.waits:
            doomed = mission.doomed
            if status in FAILURES or index in mission.fated:
                status_then = status if status in FAILURES else Status.FAILED
                doomed = tuple(sorted({*doomed, status_then}, key=lambda one: one.value))
            move = move.with_mission(other, waits=tuple(one for one in mission.waits if one != index), doomed=doomed)
            if move.state.missions[other].ready:
                move = started(move, other, START, "ready")
    return move.to(move.state, *because)


def cancellations(move: Move, part: Part) -> Moves:
    """A doomed mission is cancelled, or is found to wait (AI-03, AI-36); nothing where no mission is due.

    They make no difference to one another: the first comes first.
    """
    for index in part.missions:
        due = () if move.state.missions[index].overdue else tuple(cancellation(move, index))
        if due:
            yield from due
            return


def cancellation(move: Move, index: int) -> Moves:
    """A doomed mission is cancelled, or is found to wait (AI-03, AI-36)."""
    mission = move.state.missions[index]
    if mission.status is not Status.QUEUED or not mission.doomed or any(one.kind == DOOM for one in mission.clocks):
        return
    yes, no = split(move, AI_03, failures_that_cancel(mission))
    if yes is not None:
        now, later = split(yes, AI_36, "a") if mission.waits else (yes, None)
        yield from () if now is None else _doomed(now, move, index)
        if later is not None and later is not move:
            yield later
    if no is not None and no is not move:
        yield no


def _doomed(move: Move, before: Move, index: int) -> Moves:
    """A mission is to be cancelled: at once, when a pass notices it, or when it comes to the front of its queue."""
    at_once, noticed = split(move, AI_03_WHEN, "n")
    if at_once is not None:
        yield _cancelled(at_once, index)
    soon, waits = (None, None) if noticed is None else split(noticed, AI_03_WHEN, "q")
    if soon is not None:
        yield _to_be_noticed(soon, index, DOOM)
    if waits is not None and waits is not before:
        yield waits


def _held(move: Move, index: int, kind: str) -> Move:
    """A mission that was queued has ended, and it is left open how: clocks that cannot be over yet are none of it."""
    clocks = tuple(one for one in move.state.missions[index].clocks if one.lo <= move.at[1])
    after = move.with_mission(index, overdue=True, clocks=clocks)
    return after.to(after.state, _because(kind))


def _because(kind: str) -> str:
    return {START: rules.ABORTED, RUN: rules.OVERRUN, SILENT: rules.SILENCE, DOOM: rules.CANCELED}[kind].id


def _cancelled(move: Move, index: int) -> Move:
    """A mission is cancelled, unless it timed out before: where it may have, that is left open."""
    mission = move.state.missions[index]
    if not mission.overdue and any(one.kind in (START, RUN) and one.lo <= move.at[1] for one in mission.clocks):
        return _held(move, index, DOOM)
    return ends(move, index, "cancel", rules.CANCELED.id)


def failures_that_cancel(mission: Mission) -> str:
    """The letters of AI-03 under which the upstreams that failed cancel a mission."""
    reported = Status.FAILED in mission.doomed
    direct = any(one is not Status.CANCELED for one in mission.doomed)
    return "a" + ("b" if reported else "") + ("c" if direct else "")


def strikes(
    move: Move, index: int, clock: Clock, *, due: bool, held: bool = False
) -> tuple[tuple[Move, ...], tuple[Move, ...]]:
    """Where a clock that is over aborts its mission, and where it does not: it means nothing, or strikes later.

    Where it is not `due`, it may as well strike later as it is, and only the first are asked for. Where it is `held`,
    the mission has ended, and it is left open how.
    """
    if clock.kind == DROP:
        return tuple(_drop_noticed(move, index)), ()
    if clock.kind == DOOM:
        return (_held(move, index, DOOM) if held else ends(move, index, "cancel", rules.CANCELED.id),), ()
    alike: Move | None = move
    unlike: Move | None = None
    if clock.kind != SILENT:
        alike, unlike = split(move, AI_24_WHOLE, "w" if clock.whole else "x")
    if alike is None:
        return (), (move,)
    aborting, meaningless = _aborting(alike, index, clock)
    noticed = [_noticed(way, clock) if due else (way, None) for way in aborting]
    return (
        tuple(one for at_once, _ in noticed for one in _over(at_once, index, clock.kind, held=held)),
        (
            *(stopped(way, index, (clock.kind, clock.since)) for way in meaningless),
            *(with_later_clocks(later) for _, later in noticed if later is not None),
            *filter(None, (unlike,)),
        ),
    )


def _over(move: Move, index: int, kind: str, *, held: bool) -> Moves:
    """A mission has timed out; where it is `held`, it has ended, and it is left open how."""
    return iter((_held(move, index, kind),)) if held else aborted(move, index, kind)


def settled(move: Move, index: int) -> Moves:
    """How a mission has ended of which that was left open: each way, with what follows for those that wait for it."""
    now, mission = move.at, move.state.missions[index]
    for clock in mission.clocks:
        if clock.lo <= now[1]:
            when = (clock.lo, now[1] if clock.hi is None else max(clock.lo, min(clock.hi, now[1])))
            for one in strikes(evolve(move, at=when), index, clock, due=False)[0]:
                yield from (evolve(after, at=now) for after in _with_cancellations(one))
    if mission.doomed:
        for one in (*cancellation(move, index), *_cancelled_in_its_turn(move, index)):
            if not one.state.missions[index].overdue:
                yield from _with_cancellations(one)


def _cancelled_in_its_turn(move: Move, index: int) -> Moves:
    """AI-03.when p, h: a doomed mission may have been cancelled before it timed out, had its turn come."""
    mission = move.state.missions[index]
    here, _ = split(move, AI_03_WHEN, "ph")
    here, _ = (None, None) if here is None else split(here, AI_03, failures_that_cancel(mission))
    if here is not None and mission.waits:
        here, _ = split(here, AI_36, "a")
    if here is not None and any(one.name == mission.robot for one in here.state.links):
        yield ends(here, index, "cancel", rules.CANCELED.id)


def _with_cancellations(move: Move) -> Moves:
    """The move, with what it cancels."""
    everything = Part(tuple(range(len(move.state.missions))), ())
    todo = [move]
    while todo:
        here = todo.pop()
        due = list(cancellations(here, everything))
        todo += reversed(due)
        if not due:
            yield here


@functools.lru_cache(maxsize=20_000)
def all_settled(server: Server) -> tuple[Server, ...]:
    """The server where no end is left open: what may have timed out has, under each reading that makes a difference."""
    index = next((at for at, one in enumerate(server.missions) if one.overdue), None)
    if index is None:
        return (server,)
    ends_so = list(dict.fromkeys(one.state for one in settled(Move(server), index)))
    timed_out = [one for one in ends_so if one.missions[index].status is Status.ABORTED]
    others = [one for one in ends_so if one not in timed_out]
    return tuple(dict.fromkeys(after for one in (*timed_out, *others) for after in all_settled(one)))


def _noticed(move: Move, clock: Clock) -> tuple[Move, Move | None]:
    """AI-39.limits: the move where a timeout is noticed at once, and the one where the server has yet to look, if any.

    A server that looks now and then may do what one does that notices all at once, so that nothing is lost where the
    first is one of those from here on: the question is asked once, and not of each of many missions that wait.
    """
    asked = move.state.letters(AI_39) != "b" and move.state.letters(AI_39_LIMITS) == "ab"
    if clock.kind == SILENT or clock.whole or not asked or left_open(clock, move.state):
        return move, None
    at_once, later = split(move, AI_39_LIMITS, "a")
    return at_once or move, later


def _aborting(move: Move, index: int, clock: Clock) -> tuple[list[Move], list[Move]]:
    """The moves in which a clock counts, and those in which it does not: the first answer that says so decides."""
    aborting: list[Move] = []
    meaningless: list[Move] = []
    here: Move | None = move
    if (clock.kind, clock.since) == (RUN, "send"):
        by_send, here = split(move, AI_06, "b")
        aborting += () if by_send is None else (by_send,)
    for question, letters in _counts(move.state.missions[index], clock):
        here, no = (None, None) if here is None else split(here, question, letters)
        meaningless += () if no is None else (no,)
    aborting += () if here is None else (here,)
    return aborting, meaningless


def _counts(mission: Mission, clock: Clock) -> tuple[tuple[Ambiguity, str], ...]:
    """The questions that make a clock count, each with the letters that do."""
    if clock.kind == SILENT:
        return ((AI_31, "a"),)
    if clock.kind == START:
        since = (AI_05, START_COUNTS_FROM[clock.since])
        return (since, (AI_07, "ab")) if mission.status is Status.STARTED else (since,)
    if clock.since in ("send", "status"):
        return (AI_06, "a"), (AI_07, "c" if clock.since == "send" else "ab")
    return ((AI_06, "d" if clock.since == WAITS else "c"),)


def _drop_noticed(move: Move, index: int) -> Moves:
    """A scheduling pass notices that the connection of a mission has dropped (AI-15.when p)."""
    for one in move.state.gone:
        if one.serves and one.name == move.state.missions[index].robot:
            move = forgotten(move, one)
    for letter, way in ways(move, dropped(move.state.missions[index]), "c", "b"):
        here = stopped(way, index, (DROP, "drop"))
        yield ends(here, index, "lose") if letter == "c" else sent_again(here, index)


def aborted(move: Move, index: int, kind: str) -> Moves:
    """A mission is aborted; its robot is not told, or loses its connection (AI-08 c), or stays busy (d, e)."""
    mission = move.state.missions[index]
    after = ends(move, index, "time out", _because(kind))
    link = None if mission.sent_on is None else move.state.link_at(mission.sent_on)
    if link is None and mission.status in UNDER_WAY:
        link = move.state.serving(mission.robot)
    if link is None or mission.status not in UNDER_WAY:
        yield after
        return
    quiet, closing = split(after, AI_08, "ade")
    if quiet is not None:
        heard = mission.status is Status.RUNNING
        lingers = not set("de" if heard else "d").isdisjoint(quiet.state.letters(AI_08))
        word = HEARD if heard else SENT
        yield quiet.with_mission(index, sent_on=link.slot, lingers=word) if lingers else quiet
    if closing is not None:
        yield from (yet_to_be_seen(one, link, closing.state) for one in closed(closing, link))


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
                yield _to_be_noticed(noticed, index, DROP, still=still)
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


def _to_be_noticed(move: Move, index: int, kind: str, *, still: bool = False) -> Move:
    """The next scheduling pass notices a drop or a failed upstream; one that is to come notices all."""
    low, high = move.at
    clocks = move.state.missions[index].clocks
    if any(one.kind == kind for one in clocks):
        return move
    if still and not move.state.tolerance:
        low += 1  # no pass comes while no time passes; what a pass itself brings about it may notice
    return ticking(move, index, (*clocks, Clock(kind, kind, low, move.state.next_pass(high) + move.state.tolerance)))


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


def acknowledged(move: Move, index: int) -> Move:
    """RUNNING was reported: the start timeout is over, and the run timeout counts."""
    first = move.state.missions[index].status is Status.STARTED
    if first:
        move = stopped(becomes(move, index, "report running"), index, *START_CLOCKS)
        move = started(move, index, RUN, "status")
    return started(move, index, SILENT, "status")
