"""What clocks do that strike: missions are aborted or cancelled; how some have ended is left open, and settled later.

Every function takes a `Move` and gives the moves that it can lead to, as in `lifecycle`.
"""

from __future__ import annotations

import functools

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.clocks import Moves, left_open, stopped, with_later_clocks
from missionfsm.isaac.server.deciding import split, ways
from missionfsm.isaac.server.independence import Part
from missionfsm.isaac.server.lifecycle import (
    cancellation,
    cancellations,
    cause_of,
    ends,
    failures_that_cancel,
    held_open,
)
from missionfsm.isaac.server.losing import closed, dropped, forgotten, sent_again, yet_to_be_seen
from missionfsm.isaac.server.readings import (
    AI_03,
    AI_03_WHEN,
    AI_05,
    AI_06,
    AI_07,
    AI_08,
    AI_24_WHOLE,
    AI_31,
    AI_36,
    AI_39,
    AI_39_LIMITS,
)
from missionfsm.isaac.server.state import (
    DOOM,
    DROP,
    HEARD,
    RUN,
    SENT,
    SILENT,
    START,
    START_COUNTS_FROM,
    UNDER_WAY,
    WAITS,
    Clock,
    Mission,
    Move,
    Server,
    Status,
)
from missionfsm.kernel.readings import Ambiguity


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
        return (held_open(move, index, DOOM) if held else ends(move, index, "cancel", rules.CANCELED.id),), ()
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
    return iter((held_open(move, index, kind),)) if held else aborted(move, index, kind)


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
    after = ends(move, index, "time out", cause_of(kind))
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
