"""Whether it makes a difference to anything else when a clock ends a mission, and how."""

from __future__ import annotations

from missionfsm.isaac.server.queues import first_ready, given, lanes_of, waiting_for
from missionfsm.isaac.server.readings import AI_11, AI_12
from missionfsm.isaac.server.state import DOOM, RUN, START, UNDER_WAY, Clock, Link, Mission, Server


def makes_no_difference(state: Server, index: int, clock: Clock, until: int) -> bool:
    """Whether nothing that may happen by then depends on whether a clock ends a queued mission before it or after.

    It would not be the first to be sent, or nothing is sent to its robot; and those that wait for it, who may be
    cancelled, hold nobody up. What is sent again or is anybody's is left as it comes.
    """
    missions, mission = state.missions, state.missions[index]
    if not mission.queued or clock.kind not in (START, RUN, DOOM) or mission.robot is None or mission.sent:
        return False
    if not _is_blocked(state, mission.robot, mission.channel, until):
        queue = waiting_for(missions, mission.robot)
        if any(index in first_ready(missions, lane) for lane in (queue, *lanes_of(missions, queue))):
            return False
        if holds_up(state, index):
            return False
    return not any(holds_up(state, one) for one in downstream(missions, index))


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


def holds_up(state: Server, index: int) -> bool:
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
    at_once = "d" in letters and any(one.at_once and one.robot == link.name for one in state.missions)
    if at_once or "b" in letters:
        return False
    return any(
        one.status in UNDER_WAY
        and (one.channel == channel or "c" not in letters)
        and all(clock.lo > until for clock in one.clocks)
        for one in given(state, link)
    )
