"""Scheduling passes: until when one has come to a connection, whether it would do something there, and what it does.

Where a server looks now and then (AI-39 b), names, drops and what may be sent are noticed in a pass alone.
"""

from __future__ import annotations

from collections.abc import Iterator

from attrs import evolve

from missionfsm.isaac.server.deciding import split
from missionfsm.isaac.server.dispatch import followed, lapses, sends
from missionfsm.isaac.server.independence import Part
from missionfsm.isaac.server.losing import untimed
from missionfsm.isaac.server.queues import possible
from missionfsm.isaac.server.readings import AI_16_UNDER_WAY, AI_39, AI_39_ORDER
from missionfsm.isaac.server.state import Link, Move, Server

EVER = 10**15
"""Longer ago than anything happened, in microseconds."""


def waits_for_pass(state: Server, link: Link) -> bool:
    """Whether a scheduling pass would send something on a connection or cancel something for it."""
    later = _sends_later(state, link)
    return link.serves and bool((later and possible(state, link)) or lapses(state, link))


def _sends_later(state: Server, link: Link) -> bool:
    """Whether what can be sent on a connection is sent when the server looks."""
    return state.letters(AI_39) == "b" or state.lets_rest(link)


def waits_quietly(state: Server, link: Link) -> bool:
    """Whether a pass may do something for a connection that sends nothing: cancel, or give up what has no time."""
    later = _sends_later(state, link)
    no_time = later and any(state.missions[index].start == 0 for index, _ in possible(state, link))
    return link.serves and bool(no_time or lapses(state, link))


def held_back(state: Server, link: Link) -> int:
    """Before when no pass sends on a connection since none has taken up its name (AI-39.order s), in microseconds."""
    return link.held[0] - state.tolerance if link.held[0] and state.letters(AI_39_ORDER) == "s" else -EVER


def pass_by(state: Server, slot: int, last: int) -> int:
    """Until when a scheduling pass has come for a connection that waits for one since a moment, in microseconds."""
    link = state.link_at(slot)
    if link is not None:
        last = max(last, link.held[1])
    return state.next_pass(last) + state.tolerance


def dropped_unnoticed(state: Server, part: Part) -> list[Link]:
    """The connections that dropped on which the pass that notices it may send before."""
    gone = [one for one in state.gone if one.serves and one.slot in part.slots]
    return [one for one in gone if state.letters(AI_39) == "b" and possible(state, one)]


def overlooked(state: Server, part: Part) -> list[tuple[Link, Link]]:
    """The connections that were taken over, with those that did, of which the pass that notices it sends before."""
    if state.letters(AI_39) != "b" or "s" not in state.letters(AI_39_ORDER):
        return []
    pairs = [
        (evolve(older, serves=True), link)
        for link in state.links
        if link.slot in part.slots and link.over is not None and (older := state.link_at(link.over)) is not None
    ]
    return [(older, link) for older, link in pairs if possible(state, older)]


def sent_before(move: Move, older: Link, link: Link) -> Iterator[Move]:
    """A pass sends on a connection, and then takes up that another has taken over (AI-39.order s)."""
    for index, chosen in possible(move.state, older):
        here, _ = split(move.to(chosen.state), AI_39_ORDER, "s")
        if here is not None:
            for after in sends(here, older, index):
                yield taken_up(after, link)


def taken_up(move: Move, link: Link) -> Move:
    """A pass has noticed that a connection took over from another."""
    after = move.with_link(link.slot, over=None, fresh=0)
    if link.over is not None and move.state.letters(AI_16_UNDER_WAY) == "m":
        return untimed(after, link.over)
    return after


def _rested(move: Move, link: Link) -> Move:
    """The robot of a connection rests no more."""
    for index, mission in enumerate(move.state.missions):
        if mission.rests and mission.robot == link.name:
            move = move.with_mission(index, rests=0)
    return move


def after_pass(move: Move, slot: int, part: Part) -> Iterator[Move]:
    """What a scheduling pass does for a connection at the moment of the move."""
    link = move.state.link_at(slot)
    if link is None:
        return
    here = move if link.pass_since is None else move.with_link(slot, pass_since=None)
    quiet = link.pass_since == 0
    link = evolve(link, pass_since=None)
    for lapsed in lapses(here.state, link):
        yield from followed(Move(lapsed.state, here.sent, here.rules + lapsed.rules, here.at), part)
    for index, chosen in possible(here.state, link) if _sends_later(here.state, link) else ():
        for after in sends(_rested(here.to(chosen.state), link), link, index):
            if not quiet or len(after.sent) == len(here.sent):
                yield from followed(after, part)
