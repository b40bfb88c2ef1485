"""What of a mission server a search and an exploration tell apart, and how far they go."""

from __future__ import annotations

from attrs import evolve

from missionfsm.isaac.server.state import ENDED, UNDER_WAY, Mission, Server


def search_key(server: Server) -> object:
    """What a search tells a server apart by: how each robot's missions stand and who is connected, not the times."""
    robots = dict.fromkeys((*(one.robot for one in server.missions), *(one.name for one in server.links)))
    return tuple(sorted((_of_robot(server, robot) for robot in robots), key=repr))


def _of_robot(server: Server, robot: str | None) -> object:
    own = [one for one in server.missions if one.robot == robot]
    under_way = tuple(
        (one.status.value, one.run is not None, one.channel, one.sent_on is None)
        for one in own
        if one.status in UNDER_WAY
    )
    queue = _queue([one for one in own if one.queued])
    lingers = any(one.lingers for one in own)
    ended = tuple(sorted({one.status.value for one in own if one.status in ENDED}))
    links = tuple(one.serves for one in server.links if one.name == robot)
    return under_way, *queue, lingers, ended, links


def _queue(queued: list[Mission]) -> tuple[int, tuple[int, ...], bool]:
    """Whether none, one or more are ready, for how many missions others wait, and whether any is to be cancelled."""
    waiting = tuple(sorted({len(one.waits) for one in queued if one.waits}))
    return min(2, sum(one.ready for one in queued)), waiting, any(one.doomed for one in queued)


def idle_search_key(server: Server) -> object:
    """The same for what has no effect: whether something is under way, and whether a robot is there."""
    return any(one.status in UNDER_WAY for one in server.missions), any(one.serves for one in server.links)


def search_size(server: Server) -> int:
    """How many missions have not ended; or connections, or half of all missions, if that is more."""
    open_ones = sum(one.status not in ENDED for one in server.missions)
    return max(open_ones, (len(server.missions) + 1) // 2, len(server.links))


def explore_size(server: Server) -> int:
    """How many missions there are; a second connection counts as a third mission."""
    return max(len(server.missions), 2 * len(server.links) - 1)


def canonical(server: Server) -> Server:
    """The server with all readings open again, clocks that may strike at any time, and nothing kept for later."""
    missions = tuple(
        evolve(
            one,
            lingers="",
            was=None,
            new=None,
            rests=0,
            at_once=False,
            clocks=tuple(evolve(clock, lo=0, hi=None) for clock in one.clocks),
        )
        if one.clocks or one.lingers or one.was or one.new is not None or one.rests or one.at_once
        else one
        for one in server.missions
    )
    links = tuple(evolve(one, early=(), held=(0, 0)) if one.early or one.held[1] else one for one in server.links)
    return Server(server.name_channel, missions, links, tolerance=server.tolerance)
