"""What is wrong with a mission that is sent though nothing owes it."""

from __future__ import annotations

from collections.abc import Hashable

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.state import ENDED, UNDER_WAY, Link, Mission, Server, Status, mission_of_uuid
from missionfsm.isaac.shared.line import LineContent
from missionfsm.kernel.step import Unowed
from missionfsm.kernel.terms import Refs


def unowed(server: Server, at: Hashable, content: object, refs: Refs) -> tuple[str, ...] | Unowed:
    """What is wrong with a mission that is sent now: before its upstreams, to another robot, or twice."""
    link = server.link_of_topic(at)
    if link is None or not isinstance(content, LineContent) or content.kind != "mission":
        return ()
    known = [mission_of_uuid(server, ref) for ref in refs if ref is not None]
    if known:
        return _once_more([server.missions[index] for index in known if index >= 0])
    return _too_early(server, link, [one for one in server.missions if _says(content, one)])


def _once_more(meant: list[Mission]) -> tuple[str, ...] | Unowed:
    """Why a mission that was sent before is not due."""
    for one in meant:
        if one.status in ENDED:
            return Unowed((rules.SENT.id,), f"the mission with that uuid has ended, it is {_word(one.status)}")
        if one.sent:
            return Unowed((rules.SENT.id,), "the mission with that uuid was sent already")
    return ()


def _waits(own: list[Mission], under_way: list[Mission]) -> tuple[str, ...] | Unowed:
    """Why none of these missions of the robot is due, which are queued, while others of it are under way."""
    if all(one.ready for one in own):
        busy = ", ".join(f"the one with {one.config} is {_word(one.status)}" for one in under_way)
        return Unowed((rules.SENT.id,), f"its robot is busy: {busy}") if busy else (rules.SENT.id,)
    has = "failed" if all(one.doomed for one in own) else "not succeeded"
    return Unowed((rules.UPSTREAM.id, rules.SENT.id), f"an upstream of the mission with that configuration has {has}")


def _not_queued(meant: list[Mission]) -> Unowed:
    """Why none of these missions is due, of which none is queued."""
    ended = next((one for one in meant if one.status in ENDED and not one.sent), None)
    if ended is not None:
        return Unowed((rules.SENT.id,), f"the mission with that configuration has ended, it is {_word(ended.status)}")
    says = "was sent already, with another uuid" if meant else "was never accepted"
    return Unowed((rules.SENT.id,), f"a mission with that channel and that configuration {says}")


def _too_early(server: Server, link: Link, meant: list[Mission]) -> tuple[str, ...] | Unowed:
    """Why none of these missions is due on a connection."""
    queued = [one for one in meant if one.queued]
    own = [one for one in queued if link.serves and one.robot == link.name]
    if own:
        return _waits(own, [one for one in server.missions if one.status in UNDER_WAY and one.robot == link.name])
    if any(one.status is Status.CANCELED and one.robot == link.name for one in meant):
        says = "the mission with that configuration was cancelled, since an upstream of it has failed"
        return Unowed((rules.CANCELED.id, rules.UPSTREAM.id), says)
    if not queued:
        return _not_queued(meant)
    return _for_another(link, queued)


def _for_another(link: Link, queued: list[Mission]) -> Unowed:
    """These missions are for other robots."""
    robots = ", ".join(dict.fromkeys(repr(one.robot) for one in queued))
    whose = "has said no name" if link.name is None else f"is that of {link.name!r}"
    return Unowed((rules.UNNAMED.id,), f"the mission with that configuration is for {robots}, the connection {whose}")


def _word(status: Status) -> str:
    return {Status.ABORTED: "timed out", Status.CANCELED: "cancelled", Status.LOST: "lost"}.get(
        status, status.value.lower()
    )


def _says(content: LineContent, mission: Mission) -> bool:
    return (content.channel, content.what) == (mission.channel, mission.config)
