"""What is sent next, and what of it follows at once. ``MissionSubmission › Robot Identification``.

Every function takes a `Move` and gives the moves that it can lead to, each with the readings that it decided recorded
in its state.
"""

from __future__ import annotations

from collections.abc import Iterator

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.alike import first_of_alike
from missionfsm.isaac.server.clocks import Moves, started, with_later_clocks
from missionfsm.isaac.server.deciding import split, ways
from missionfsm.isaac.server.independence import Part
from missionfsm.isaac.server.lifecycle import (
    becomes,
    cancellations,
    ends,
    failures_that_cancel,
    forgotten,
    sent_again,
    settled,
    strikes,
)
from missionfsm.isaac.server.readings import (
    AI_03,
    AI_03_WHEN,
    AI_05,
    AI_07,
    AI_08,
    AI_11,
    AI_12,
    AI_13,
    AI_15_SENT,
    AI_16,
    AI_16_UNDER_WAY,
    AI_19,
    AI_24_WHOLE,
    AI_36,
    AI_39,
    AI_39_FAILED,
    AI_39_LIMITS,
    AI_39_ORDER,
)
from missionfsm.isaac.server.state import (
    DOOM,
    HEARD,
    RUN,
    SENT,
    START,
    UNDER_WAY,
    WAITS,
    Clock,
    Link,
    Mission,
    Move,
    Sends,
    Server,
    Status,
)


def lapses(state: Server, link: Link) -> list[Move]:
    """AI-03.when p, h: what becomes of a doomed mission that a scheduling pass finds first in an idle robot's queue.

    Whichever is the first, where those before it may have ended; under h a pass is needed for no other.
    """
    letters = state.letters(AI_03_WHEN)
    if letters not in ("p", "h", "ph"):
        return []
    first = _maybe_first(state, link)
    queue = _waiting_for(state.missions, link.name)
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
        queue = _waiting_for(state.missions, link.name)
        index = None if not queue or _is_in_no_order(state, queue) else queue[0]
    if index is None or not state.missions[index].doomed or busy(state, link):
        return []
    head = state.missions[index]
    here, _ = split(move, AI_03, failures_that_cancel(head))
    if here is not None and head.waits:
        here, _ = split(here, AI_36, "a")
    return [] if here is None else [ends(here, index, "cancel", rules.CANCELED.id)]


def busy(state: Server, link: Link) -> set[str]:
    """The channels of the missions that keep a connection's robot busy."""
    return {one.channel for one in _given(state, link) if one.status in UNDER_WAY}


def _lingering(state: Server, link: Link, *words: str) -> set[str]:
    """The channels of the missions that were aborted and that a connection's robot may still run (AI-08 d, e)."""
    return {one.channel for one in _given(state, link) if one.lingers in words}


def _given(state: Server, link: Link) -> Iterator[Mission]:
    """The missions of a connection's robot, but for those that were sent elsewhere and keep nobody busy."""
    apart = state.letters(AI_16_UNDER_WAY) == "m" or state.letters(AI_16) == "s"
    for one in state.missions:
        if one.robot == link.name and not (apart and one.sent_on is not None and one.sent_on != link.slot):
            yield one


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
    choices = list(_choices(move, link))
    # Where it is decided whether anything may be sent, that it may be is decided although nothing is sent yet.
    decides = any(index is None and chosen is not move for index, chosen in choices)
    for index, chosen in choices:
        if index is not None:
            now, later = split(chosen, AI_39, "a")
            soon, rests = split(now, AI_39_FAILED, "a") if now is not None and link.rests else (now, None)
            if soon is not None:
                yield from sends(soon, link, index)
            if rests is not None:
                yield rests
            if later is not None:
                yield from _sent_later(later, chosen, decides=decides and later.state != move.state)
        elif chosen is not move:
            yield chosen


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


def possible(state: Server, link: Link) -> list[tuple[int, Move]]:
    """What a server that looks now and then (AI-39 b) may send on a connection when it looks."""
    return [(index, chosen) for index, chosen in _choices(Move(state), link) if index is not None]


def _choices(move: Move, link: Link) -> Iterator[tuple[int | None, Move]]:
    """Missions that may be sent on a connection, each with what that decides; None for deciding to send nothing."""
    missions = move.state.missions
    queue = _queue(move.state, link)
    if not any(missions[index].ready for index in queue):
        return
    taken = busy(move.state, link)
    sent, heard = _lingering(move.state, link, SENT), _lingering(move.state, link, HEARD)
    idle, held = split(move, AI_08, "ac" if heard else "ace") if sent or heard else (move, None)
    if idle is not None:
        yield from _with_taken(idle, queue, taken)
    if held is None:
        return
    for letter, way in ways(held, AI_08, "d", "e"):
        yield from _with_taken(way, queue, taken | heard | (sent if letter == "d" else set()))


def _with_taken(move: Move, queue: list[int], taken: set[str]) -> Iterator[tuple[int | None, Move]]:
    """What may be sent of a robot's queue while these channels of it are taken."""
    missions = move.state.missions
    if not taken:
        yield from _from_free(move, queue)
        return
    apart = _lanes(missions, [index for index in queue if missions[index].channel not in taken])
    holding = "a" if any(missions[index].ready for lane in apart for index in lane) else "ac"
    held, several = split(move, AI_11, holding)
    if several is not None:
        for letter, way in ways(several, AI_11, "b", "c"):
            yield from _from_lane(way, queue) if letter == "b" else _from_lanes(way, apart)
    if held is not None:
        yield None, held


def _queue(state: Server, link: Link) -> list[int]:
    """The missions that wait for the robot of a connection, or (AI-19 b) for any."""
    whose = (link.name, None) if "b" in state.letters(AI_19) else (link.name,)
    return _waiting_for(state.missions, *whose)


def _waiting_for(missions: tuple[Mission, ...], *robots: str | None) -> list[int]:
    """The missions that wait for robots, in the order of submission; None is for any robot."""
    return [index for index, one in enumerate(missions) if one.robot in robots and one.queued]


def _lanes(missions: tuple[Mission, ...], queue: list[int]) -> list[list[int]]:
    """The missions of a queue, those of each channel by themselves."""
    lanes: dict[str, list[int]] = {}
    for index in queue:
        lanes.setdefault(missions[index].channel, []).append(index)
    return list(lanes.values())


def makes_no_difference(state: Server, index: int, clock: Clock, until: int) -> bool:
    """Whether nothing that may happen by then depends on whether a clock ends a queued mission before it or after.

    It would not be the first to be sent, or nothing is sent to its robot; and those that wait for it, who may be
    cancelled, hold nobody up. What is sent again or is anybody's is left as it comes.
    """
    missions, mission = state.missions, state.missions[index]
    if not mission.queued or clock.kind not in (START, RUN, DOOM) or mission.robot is None or mission.sent:
        return False
    if not _is_blocked(state, mission.robot, mission.channel, until):
        queue = _waiting_for(missions, mission.robot)
        if any(index in _first_ready(missions, lane) for lane in (queue, *_lanes(missions, queue))):
            return False
        if _holds_up(state, index):
            return False
    return not any(_holds_up(state, one) for one in downstream(missions, index))


def downstream(missions: tuple[Mission, ...], index: int) -> list[int]:
    """The missions that wait for one, and those that wait for them, in the order of submission."""
    found: list[int] = []
    upstream = {index}
    for at in range(index + 1, len(missions)):  # what waits for a mission was submitted later
        if not upstream.isdisjoint(missions[at].waits):
            upstream.add(at)
            found.append(at)
    return found


def upstream_overdue(missions: tuple[Mission, ...], index: int) -> list[int]:
    """Those among the missions for which one waits, and for which they wait, that have ended, nobody knows how."""
    found = [index]
    for at in found:
        found += [one for one in missions[at].waits if one not in found]
    return sorted(one for one in found[1:] if missions[one].overdue)


def _holds_up(state: Server, index: int) -> bool:
    """Whether it may make a difference to others of its robot whether a mission that waits has been cancelled."""
    missions, robot = state.missions, state.missions[index].robot
    if not missions[index].queued or not any(one.name == robot for one in (*state.links, *state.gone)):
        return robot is None
    return "b" in state.letters(AI_12) and any(one.robot == robot and one.ready for one in missions[index:])


def _is_blocked(state: Server, robot: str, channel: str, until: int) -> bool:
    """Whether nothing is sent to a robot on a channel by then: it is busy for longer, or not there."""
    links = [one for one in (*state.links, *state.gone) if one.name == robot]
    if any(one.over is not None or one.slot < 0 or one in state.gone for one in links):
        return False
    return all(_is_kept_busy(state, one, channel, until) for one in links if one.serves)


def _is_kept_busy(state: Server, link: Link, channel: str, until: int) -> bool:
    letters = state.letters(AI_11)
    if "b" in letters:
        return False
    return any(
        one.status in UNDER_WAY
        and (one.channel == channel or "c" not in letters)
        and all(clock.lo > until for clock in one.clocks)
        for one in _given(state, link)
    )


def _settling(move: Move, part: Part) -> Moves:
    """How missions have ended of which that was left open, once it may make a difference to the queue of a robot."""
    missions = move.state.missions
    for index in part.missions:
        if missions[index].queued and missions[index].waits and _holds_up(move.state, index):
            open_ones = upstream_overdue(missions, index)
            if open_ones:
                yield from settled(move, open_ones[0])
                return


def _first_ready(missions: tuple[Mission, ...], lane: list[int]) -> list[int]:
    """The first mission of a queue that is ready."""
    return [index for index in lane if missions[index].ready][:1]


def _from_lanes(move: Move, lanes: list[list[int]]) -> Iterator[tuple[int | None, Move]]:
    """What may be sent of several queues that do not wait for one another."""
    missions = move.state.missions
    surely = any(missions[lane[0]].ready for lane in lanes)
    for lane in lanes:
        for index, way in _from_lane(move, lane):
            if index is not None or not surely:
                yield index, way


def _from_free(move: Move, queue: list[int]) -> Iterator[tuple[int | None, Move]]:
    """Nothing is under way: the queue as one, or (AI-11 c) by channels, where that makes a difference."""
    missions = move.state.missions
    lanes = _lanes(missions, queue)
    if len(lanes) == 1:
        yield from _from_lane(move, queue)
        return
    first = queue[0]
    if missions[first].ready:
        yield first, move
    found: dict[int | None, list[Move]] = {}
    whole, apart = split(move, AI_11, "ab")
    if whole is not None:
        for index, way in _from_lane(whole, queue):
            found.setdefault(index, []).append(way)
    if apart is not None:
        for index, way in _from_lanes(apart, lanes):
            found.setdefault(index, []).append(way)
    for index, moves in found.items():
        if index != first:
            yield from ((index, way) for way in dict.fromkeys(moves))


def _from_lane(move: Move, queue: list[int]) -> Iterator[tuple[int | None, Move]]:
    """Of missions in the order of submission: the first that is ready, or (AI-13 b) another that is."""
    missions = move.state.missions
    ready = [index for index in queue if missions[index].ready]
    if not ready:
        return
    overtakes, holds = (move, None) if ready[0] == queue[0] else split(move, AI_12, "a")
    if overtakes is not None:
        yield ready[0], overtakes
    if len(ready) > 1:
        any_order, _ = split(move, AI_13, "b")
        free = None if any_order is None else split(any_order, AI_12, "a")[0]
        if free is not None:
            for index, after in first_of_alike(free.state, ready):
                if index != ready[0] or after is not free.state:
                    yield index, free if after is free.state else free.to(after)
    if holds is not None:
        yield None, holds


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
    move = becomes(move, index, "send").with_mission(index, sent_on=link.slot, sent=True)
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
    choices = _choices(move, gone) if move.state.letters(AI_39) == "b" else ()
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
