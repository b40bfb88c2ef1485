"""What is sent next, and what of it follows at once. ``MissionSubmission › Robot Identification``.

Every function takes a `Move` and gives the moves that it can lead to, each with the readings that it decided recorded
in its state.
"""

from __future__ import annotations

import functools

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.clocks import Moves, started, with_later_clocks
from missionfsm.isaac.server.deciding import split, ways
from missionfsm.isaac.server.independence import Part
from missionfsm.isaac.server.indifference import holds_up, upstream_overdue
from missionfsm.isaac.server.lifecycle import becomes, cancellations, ends, failures_that_cancel
from missionfsm.isaac.server.losing import forgotten, sent_again
from missionfsm.isaac.server.queues import busy, choices_on, waiting_for
from missionfsm.isaac.server.readings import (
    AI_03,
    AI_03_WHEN,
    AI_05,
    AI_07,
    AI_15_SENT,
    AI_19,
    AI_24_WHOLE,
    AI_36,
    AI_39,
    AI_39_LIMITS,
    AI_39_ORDER,
)
from missionfsm.isaac.server.state import RUN, START, WAITS, Link, Move, Sends, Server, Status
from missionfsm.isaac.server.striking import settled, strikes


def lapses(state: Server, link: Link) -> list[Move]:
    """AI-03.when p, h: what becomes of a doomed mission that a scheduling pass finds first in an idle robot's queue.

    Whichever is the first, where those before it may have ended; under h a pass is needed for no other.
    """
    letters = state.letters(AI_03_WHEN)
    if letters not in ("p", "h", "ph"):
        return []
    first = _maybe_first(state, link)
    queue = waiting_for(state.missions, link.name)
    sure = [] if _is_in_no_order(state, queue) else queue[:1]
    return [one for at in first if letters == "p" or [at] != sure for one in _lapsed(Move(state), link, at)]


def _maybe_first(state: Server, link: Link) -> list[int]:
    """The doomed missions that may be the first in a robot's queue, since those before them may have ended."""
    found = []
    for index, mission in enumerate(state.missions):
        if mission.robot != link.name or not mission.queued:
            continue
        if mission.doomed:
            found.append(index)
        if state.alike:
            continue
        if not any(one.lo <= 0 for one in mission.clocks) and not upstream_overdue(state.missions, index):
            break
    return found


def _lapsing(move: Move, part: Part) -> Moves:
    """AI-03.when h: a doomed mission is cancelled once it is the first in an idle robot's queue."""
    if "h" not in move.state.letters(AI_03_WHEN):
        return
    for link in move.state.links:
        if link.serves and link.slot in part.slots and (lapsed := _lapsed(move, link, None)):
            _, passes = split(move, AI_03_WHEN, "h")
            yield from (here for one in lapsed if (here := split(one, AI_03_WHEN, "h")[0]) is not None)
            if passes is not None:
                yield passes
            return


def _is_in_no_order(state: Server, queue: list[int]) -> bool:
    """Whether nobody knows which mission of a queue is the first, so that it need not be one that is doomed."""
    return bool(state.alike) and not all(state.missions[index].doomed for index in queue)


def _lapsed(move: Move, link: Link, index: int | None) -> list[Move]:
    """A doomed mission is cancelled that is the first in the queue of an idle robot; None: whichever is."""
    state = move.state
    if index is None:
        queue = waiting_for(state.missions, link.name)
        index = None if not queue or _is_in_no_order(state, queue) else queue[0]
    if index is None or not state.missions[index].doomed or busy(state, link):
        return []
    head = state.missions[index]
    here, _ = split(move, AI_03, failures_that_cancel(head))
    if here is not None and head.waits:
        here, _ = split(here, AI_36, "a")
    return [] if here is None else [ends(here, index, "cancel", rules.CANCELED.id)]


def dispatches(move: Move, part: Part) -> Moves:
    """Every way to send a mission now to a robot that is there; where that is left to later, the decision alone.

    Robots make no difference to one another, unless they share missions that name none: the first comes first.
    """
    for link in move.state.links:
        if link.serves and link.name is not None and link.slot in part.slots:
            ways = tuple(dispatches_to(move, link))
            yield from ways
            if ways and "b" not in move.state.letters(AI_19):
                return


def dispatches_to(move: Move, link: Link) -> Moves:
    """Every way to send a mission on a connection now."""
    if move.state.lets_rest(link):
        return
    undecided = _whether_anybody(move)
    if undecided:
        yield from undecided
        return
    choices = list(choices_on(move, link))
    # Where it is decided whether anything may be sent, that it may be is decided although nothing is sent yet.
    decides = any(index is None and chosen is not move for index, chosen in choices)
    for index, chosen in choices:
        if index is not None:
            now, later = split(chosen, AI_39, "a")
            if now is not None:
                yield from _sent_or_rests(now, link, index)
            if later is not None:
                yield from _sent_later(later, chosen, decides=decides and later.state != move.state)
        elif chosen is not move:
            yield chosen


def _sent_or_rests(move: Move, link: Link, index: int) -> Moves:
    """A mission is sent now, or the robot of a connection is found to rest since another of it has just ended."""
    for question in move.state.rests(link):
        soon, rests = split(move, question, "a")
        if rests is not None:
            yield rests
        if soon is None:
            return
        move = soon
    yield from sends(move, link, index)


def _whether_anybody(move: Move) -> tuple[Move, ...]:
    """Both ways to decide whether a mission that names no robot is for any of them; none where that is known."""
    if any(one.robot is None and one.ready for one in move.state.missions):
        anybody, nobody = split(move, AI_19, "b")
        if anybody is not None and nobody is not None:
            return anybody, nobody
    return ()


def _sent_later(later: Move, chosen: Move, *, decides: bool) -> Moves:
    """Nothing is sent before the next pass: a move where that has just been decided, or something with it."""
    if later.state.letters(AI_39) != chosen.state.letters(AI_39):
        yield later if later.state.letters(AI_39_LIMITS) == "b" else with_later_clocks(later)
    elif decides:
        yield later


def _settling(move: Move, part: Part) -> Moves:
    """How missions have ended of which that was left open, once it may make a difference to the queue of a robot."""
    missions = move.state.missions
    for index in part.missions:
        if missions[index].queued and missions[index].waits and holds_up(move.state, index):
            open_ones = upstream_overdue(missions, index)
            if open_ones:
                yield from settled(move, open_ones[0])
                return


def sends(move: Move, link: Link, index: int) -> Moves:
    """A mission is sent on a connection."""
    mission = move.state.missions[index]
    if mission.start == 0:
        yield from _without_time(move, index)
    if mission.robot is None:
        chosen, _ = split(move, AI_19, "b")
        if chosen is None:
            return
        move = chosen.with_mission(index, robot=link.name)
    move = becomes(move, index, "send").with_mission(index, sent_on=link.slot, sent=True, new=None, at_once=False)
    for kind, since in ((START, "send"), (RUN, "send"), (RUN, WAITS)):
        move = started(move, index, kind, since)
    because = [rules.SENT.id, rules.UNNAMED.id]
    if mission.depends:
        because.append(rules.UPSTREAM.id)
    view = Sends(mission.channel, mission.config)
    yield move.emit(link.slot, index, view).to(move.state, *because)


def _without_time(move: Move, index: int) -> Moves:
    """A mission with a start limit of 0 is aborted when it could be sent: it is never sent.

    Nothing can be acknowledged before no time has passed, whatever the limit counts from, so a server may as well not
    set the robot going.
    """
    if "a" in move.state.letters(AI_05):
        ours, _ = split(move, AI_05, "a")
        needs = None if ours is None else split(ours, AI_07, "ab")[0]
        needs = None if needs is None else split(needs, AI_24_WHOLE, "x")[0]
        if needs is not None:
            yield ends(needs, index, "time out", rules.ABORTED.id)
    for clock in move.state.missions[index].clocks:
        if clock.kind == START and not clock.whole and clock.lo <= move.at[1]:
            yield from strikes(move, index, clock, due=False)[0]


def urgent(move: Move, part: Part) -> tuple[Move, ...]:
    """What follows from where things stand in a part of the server, one thing at a time."""
    due = tuple(_settling(move, part)) or tuple(cancellations(move, part)) or tuple(_lapsing(move, part))
    return due or tuple(dispatches(move, part))


def in_vain(move: Move, gone: Link) -> Moves:
    """AI-39.order s: a pass sends on a connection that has dropped, and then notices that."""
    choices = choices_on(move, gone) if move.state.letters(AI_39) == "b" else ()
    for index, chosen in choices:
        here, _ = (None, None) if index is None else split(forgotten(chosen, gone), AI_39_ORDER, "s")
        if index is None or here is None:
            continue
        for after in sends(here, gone, index):
            unheard = evolve(after, sent=move.sent)
            if after.state.missions[index].status is not Status.STARTED:
                yield unheard
                continue
            if gone.slot >= 0:
                unheard = after
            for letter, way in ways(unheard.with_mission(index, sent_on=None), AI_15_SENT, "c", "a", "b"):
                if letter == "c":
                    yield ends(way, index, "lose")
                else:
                    yield way if letter == "a" else sent_again(way, index)


def followed(move: Move, part: Part) -> list[Move]:
    """What follows at once in a part, at the moment of the move."""
    found: dict[Move, None] = {}
    todo = [move]
    while todo:
        here = todo.pop()
        follows = _urgent(here.state, here.at, part)
        if not follows:
            found[tidy(here)] = None
        todo += [Move(one.state, here.sent + one.sent, here.rules + one.rules, one.at) for one in reversed(follows)]
    return list(found)


@functools.lru_cache(maxsize=50_000)
def _urgent(state: Server, at: tuple[int, int], part: Part) -> tuple[Move, ...]:
    return urgent(Move(state, at=at), part)


def tidy(move: Move) -> Move:
    """The same with rules once each, and lines by connection: their order across connections means nothing."""
    return evolve(move, rules=tuple(sorted(set(move.rules))), sent=tuple(sorted(move.sent, key=lambda one: one[0])))
