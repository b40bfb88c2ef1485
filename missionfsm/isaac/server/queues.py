"""Which missions may be sent to a robot now: who waits, in which order, which channels are taken."""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.isaac.server.alike import first_of_alike
from missionfsm.isaac.server.deciding import split, ways
from missionfsm.isaac.server.readings import AI_08, AI_11, AI_12, AI_13, AI_16, AI_16_UNDER_WAY, AI_19
from missionfsm.isaac.server.state import HEARD, SENT, UNDER_WAY, Link, Mission, Move, Server


def busy(state: Server, link: Link) -> set[str]:
    """The channels of the missions that keep a connection's robot busy."""
    return {one.channel for one in given(state, link) if one.status in UNDER_WAY}


def lingering(state: Server, link: Link, *words: str) -> set[str]:
    """The channels of the missions that were aborted and that a connection's robot may still run (AI-08 d, e)."""
    return {one.channel for one in given(state, link) if one.lingers in words}


def given(state: Server, link: Link) -> Iterator[Mission]:
    """The missions of a connection's robot, but for those that were sent elsewhere and keep nobody busy."""
    apart = state.letters(AI_16_UNDER_WAY) == "m" or state.letters(AI_16) == "s"
    for one in state.missions:
        if one.robot == link.name and not (apart and one.sent_on is not None and one.sent_on != link.slot):
            yield one


def possible(state: Server, link: Link) -> list[tuple[int, Move]]:
    """What a server that looks now and then (AI-39 b) may send on a connection when it looks."""
    return [(index, chosen) for index, chosen in choices_on(Move(state), link) if index is not None]


def choices_on(move: Move, link: Link) -> Iterator[tuple[int | None, Move]]:
    """Missions that may be sent on a connection, each with what that decides; None for deciding to send nothing."""
    missions = move.state.missions
    queue = queue_of(move.state, link)
    if not any(missions[index].ready for index in queue):
        return
    taken = busy(move.state, link)
    sent, heard = lingering(move.state, link, SENT), lingering(move.state, link, HEARD)
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
    apart = lanes_of(missions, [index for index in queue if missions[index].channel not in taken])
    named = _named(missions, queue)
    waiting = "" if any(missions[index].ready for lane in apart for index in lane) else "c"
    waiting += "" if named else "d"
    held, several = split(move, AI_11, "a" + waiting)
    if several is not None:
        for letter, way in ways(several, AI_11, "b", "c", "d"):
            yield from _from_lanes(way, apart) if letter == "c" else _from_lane(way, queue if letter == "b" else named)
    if held is not None:
        yield None, held


def queue_of(state: Server, link: Link) -> list[int]:
    """The missions that wait for the robot of a connection, or (AI-19 b) for any."""
    whose = (link.name, None) if "b" in state.letters(AI_19) else (link.name,)
    return waiting_for(state.missions, *whose)


def waiting_for(missions: tuple[Mission, ...], *robots: str | None) -> list[int]:
    """The missions that wait for robots, in the order of submission; None is for any robot."""
    return [index for index, one in enumerate(missions) if one.robot in robots and one.queued]


def lanes_of(missions: tuple[Mission, ...], queue: list[int]) -> list[list[int]]:
    """The missions of a queue, those of each channel by themselves."""
    lanes: dict[str, list[int]] = {}
    for index in queue:
        lanes.setdefault(missions[index].channel, []).append(index)
    return list(lanes.values())


def first_ready(missions: tuple[Mission, ...], lane: list[int]) -> list[int]:
    """The first mission of a queue that is ready."""
    return [index for index in lane if missions[index].ready][:1]


def _named(missions: tuple[Mission, ...], queue: list[int]) -> list[int]:
    """AI-11 d: the missions of a queue that are sent when its robot's connection is named, and hold up nobody."""
    return [index for index in queue if missions[index].at_once]


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
    named = [] if missions[queue[0]].ready else _named(missions, queue)
    if named:
        at_once, rest = split(move, AI_11, "d")
        if at_once is not None:
            yield from _from_lane(at_once, named)
        if rest is None:
            return
        move = rest
    lanes = lanes_of(missions, queue)
    if len(lanes) == 1:
        yield from _from_lane(move, queue)
        return
    first = queue[0]
    if missions[first].ready:
        yield first, move
    found: dict[int | None, list[Move]] = {}
    whole, apart = split(move, AI_11, "abd")
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
    if len(ready) > 1 and move.state.letters(AI_13) == "b":
        yield from _in_any_order(move, queue, ready)
        return
    overtakes, holds = (move, None) if ready[0] == queue[0] else split(move, AI_12, "a")
    if overtakes is not None:
        yield ready[0], overtakes
    if len(ready) > 1:
        yield from _another_of(move, ready)
    if holds is not None:
        yield None, holds


def _another_of(move: Move, ready: list[int]) -> Iterator[tuple[int | None, Move]]:
    """AI-13 b: one that is ready goes before the first of them."""
    any_order, _ = split(move, AI_13, "b")
    free = None if any_order is None else split(any_order, AI_12, "a")[0]
    for index, after in () if free is None else _freely(free, ready):
        if index != ready[0] or after is not free:
            yield index, after


def _freely(free: Move, ready: list[int]) -> Iterator[tuple[int, Move]]:
    """Any of these goes first, of those that are alike the first."""
    for index, after in first_of_alike(free.state, ready):
        yield index, free if after is free.state else free.to(after)


def _in_any_order(move: Move, queue: list[int], ready: list[int]) -> Iterator[tuple[int | None, Move]]:
    """AI-13 b: any of these may go first, where none that waits holds it up (AI-12).

    That is asked at once: asked each time anew, missions that are alike would be told apart in one way more each time.
    """
    free, held = split(move, AI_12, "a")
    if free is not None:
        yield from _freely(free, ready)
    if held is not None:
        yield (ready[0] if ready[0] == queue[0] else None), held
