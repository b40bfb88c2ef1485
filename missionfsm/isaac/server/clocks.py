"""Clocks of missions: when they start and stop, and how late a server that looks now and then may be.

Every function takes a `Move` and gives it with other clocks.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from attrs import evolve

from missionfsm.isaac.server.deciding import counts, ways
from missionfsm.isaac.server.readings import AI_24, AI_39, AI_39_LIMITS
from missionfsm.isaac.server.state import (
    DAY,
    DOOM,
    DROP,
    PASS_PERIOD,
    RUN,
    SILENCE,
    SILENT,
    START,
    START_COUNTS_FROM,
    WAITS,
    Clock,
    Move,
    Server,
)
from missionfsm.isaac.shared.line import MICROSECONDS

Moves = Iterator[Move]


def _noticed_by(clock: Clock, state: Server, due: int) -> int:
    """When a timeout that is over at a moment is noticed at the latest, in microseconds."""
    late = state.letters(AI_39) == "b" or state.letters(AI_39_LIMITS) == "b" or left_open(clock, state)
    return state.tolerance + (state.next_pass(due) if late else due)


def left_open(clock: Clock, state: Server) -> bool:
    """Whether a clock strikes at its moment or when a server looks, and nobody asks which of the two.

    AI-39.limits b allows all that a does. Of most clocks a is tried first, so that what follows is known to the moment;
    of a run limit that counts from the sending it would be asked of every mission twice.
    """
    return clock.kind == RUN and clock.since in ("send", WAITS) and "b" in state.letters(AI_39_LIMITS)


def with_later_clocks(move: Move) -> Move:
    """AI-39 b or AI-39.limits b has been decided: clocks that run may strike later than was thought."""
    missions = tuple(
        evolve(one, clocks=tuple(_later(move.state, clock) for clock in one.clocks)) if one.clocks else one
        for one in move.state.missions
    )
    return move.to(evolve(move.state, missions=missions))


def _later(state: Server, clock: Clock) -> Clock:
    """The clock of a server that looks now and then; whole seconds are looked at so anyway."""
    in_a_pass = clock.whole or clock.kind in (DROP, DOOM) or left_open(clock, state)
    return clock if clock.hi is None or in_a_pass else evolve(clock, hi=state.next_pass(clock.hi))


def started(move: Move, index: int, kind: str, since: str) -> Move:
    """A clock of a mission starts anew now, if the mission has that timeout and some reading that is left wants it."""
    mission = move.state.missions[index]
    time = {START: mission.start, RUN: mission.run, SILENT: SILENCE}[kind]
    if time is None:
        return move
    (low, high), tolerance = move.at, move.state.tolerance
    clocks = [one for one in mission.clocks if (one.kind, one.since) != (kind, since)]
    if counts(move.state, kind, since, whole=False):
        clock = Clock(kind, since, max(low, time + low - tolerance), None)
        clocks.append(clock if kind == SILENT else evolve(clock, hi=_noticed_by(clock, move.state, time + high)))
    seconds = time // MICROSECONDS + 1
    if kind != SILENT and seconds < DAY and counts(move.state, kind, since, whole=True):
        whole = seconds * MICROSECONDS
        clocks.append(
            Clock(kind, since, max(low, whole + low - tolerance), whole + high + PASS_PERIOD + tolerance, whole=True)
        )
    return ticking(move, index, clocks)


def ticking(move: Move, index: int, clocks: Iterable[Clock]) -> Move:
    """These are the clocks of a mission that run."""
    ordered = tuple(sorted(clocks, key=lambda one: (one.kind, one.since, one.whole)))
    return move if ordered == move.state.missions[index].clocks else move.with_mission(index, clocks=ordered)


def stopped(move: Move, index: int, *kinds: tuple[str, str]) -> Move:
    """Clocks of a mission, each a kind and a beginning, run no more."""
    mission = move.state.missions[index]
    left = tuple(one for one in mission.clocks if (one.kind, one.since) not in kinds)
    return move if len(left) == len(mission.clocks) else move.with_mission(index, clocks=left)


START_CLOCKS = tuple((START, since) for since in START_COUNTS_FROM)


def zero_means(move: Move, *times: int | None) -> Iterator[tuple[str, Move]]:
    """AI-24: whether a timeout of 0 elapses at once or is none; not asked where no timeout is 0."""
    if 0 not in times:
        yield "a", move
    else:
        yield from ways(move, AI_24, "a", "b")


def counting(state: Server, index: int) -> tuple[Clock, ...]:
    """The clocks of a mission that may bring about anything yet."""
    mission = state.missions[index]
    return () if mission.overdue else mission.ticking
