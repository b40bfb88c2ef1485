"""What happens to missions at the server: moves on the chart, ends and their consequences, cancellations.

Every function takes a `Move` and gives the moves that it can lead to, each with the readings that it decided recorded
in its state. What clocks bring about is in `striking`, what connections do to missions in `losing`.
"""

from __future__ import annotations

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.clocks import START_CLOCKS, Moves, started, stopped, ticking
from missionfsm.isaac.server.deciding import split
from missionfsm.isaac.server.independence import Part
from missionfsm.isaac.server.readings import AI_03, AI_03_WHEN, AI_36, AI_39
from missionfsm.isaac.server.state import (
    DOOM,
    FAILURES,
    LIFECYCLE,
    PASS_PERIOD,
    RESTS,
    RUN,
    SILENT,
    START,
    UNDER_WAY,
    Clock,
    Mission,
    Move,
    Status,
)


def becomes(move: Move, index: int, trigger: str) -> Move:
    """A mission moves on its chart."""
    after = LIFECYCLE.after(trigger, move.state.missions[index].status)
    assert after is not None, f"{trigger} is no move"  # noqa: S101 - callers look first
    return move.with_mission(index, status=after)


def ends(move: Move, index: int, trigger: str, *because: str) -> Move:
    """A mission ends; those that wait for it wait no longer, or are doomed."""
    under_way = move.state.missions[index].status in UNDER_WAY
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
    if under_way and move.state.letters(AI_39) == "a" and "b" in move.state.letters(RESTS[status]):
        move = move.with_mission(index, rests=move.at[1] + PASS_PERIOD + move.state.tolerance)
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
        yield cancelled(at_once, index)
    soon, waits = (None, None) if noticed is None else split(noticed, AI_03_WHEN, "q")
    if soon is not None:
        yield to_be_noticed(soon, index, DOOM)
    if waits is not None and waits is not before:
        yield waits


def held_open(move: Move, index: int, kind: str) -> Move:
    """A mission that was queued has ended, and it is left open how: clocks that cannot be over yet are none of it."""
    clocks = tuple(one for one in move.state.missions[index].clocks if one.lo <= move.at[1])
    after = move.with_mission(index, overdue=True, clocks=clocks)
    return after.to(after.state, cause_of(kind))


def cause_of(kind: str) -> str:
    """The rule by which a clock of a kind ends a mission."""
    return {START: rules.ABORTED, RUN: rules.OVERRUN, SILENT: rules.SILENCE, DOOM: rules.CANCELED}[kind].id


def cancelled(move: Move, index: int) -> Move:
    """A mission is cancelled, unless it timed out before: where it may have, that is left open."""
    mission = move.state.missions[index]
    if not mission.overdue and any(one.kind in (START, RUN) and one.lo <= move.at[1] for one in mission.clocks):
        return held_open(move, index, DOOM)
    return ends(move, index, "cancel", rules.CANCELED.id)


def failures_that_cancel(mission: Mission) -> str:
    """The letters of AI-03 under which the upstreams that failed cancel a mission."""
    reported = Status.FAILED in mission.doomed
    direct = any(one is not Status.CANCELED for one in mission.doomed)
    return "a" + ("b" if reported else "") + ("c" if direct else "")


def to_be_noticed(move: Move, index: int, kind: str, *, still: bool = False) -> Move:
    """The next scheduling pass notices a drop or a failed upstream; one that is to come notices all."""
    low, high = move.at
    clocks = move.state.missions[index].clocks
    if any(one.kind == kind for one in clocks):
        return move
    if still and not move.state.tolerance:
        low += 1  # no pass comes while no time passes; what a pass itself brings about it may notice
    return ticking(move, index, (*clocks, Clock(kind, kind, low, move.state.next_pass(high) + move.state.tolerance)))


def acknowledged(move: Move, index: int) -> Move:
    """RUNNING was reported: the start timeout is over, and the run timeout counts."""
    first = move.state.missions[index].status is Status.STARTED
    if first:
        move = stopped(becomes(move, index, "report running"), index, *START_CLOCKS)
        move = started(move, index, RUN, "status")
    return started(move, index, SILENT, "status")
