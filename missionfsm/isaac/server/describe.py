"""The values of the mission server in words, for people."""

from __future__ import annotations

from missionfsm.isaac.server.inputs import (
    BAD,
    BLANK,
    DEFAULT_START,
    FOREIGN,
    NAME,
    NOISE,
    STATUS,
    Connects,
    Drops,
    Incoming,
    Statuses,
    Submission,
)
from missionfsm.isaac.server.state import Closes, Link, Mission, Sends, Server
from missionfsm.isaac.shared.drives import Elapsed, Passes
from missionfsm.isaac.shared.line import MICROSECONDS, LineContent
from missionfsm.kernel.codec import Malformed


def describe(value: object) -> str:
    """A state, an event, a request, a view or a line in a few words."""
    if isinstance(value, Server):
        missions = ", ".join(map(_mission, value.missions)) or "no mission"
        return f"{missions}; {', '.join(map(_link, value.links)) or 'no connection'}"
    if isinstance(value, Submission):
        return _submission(value)
    if isinstance(value, Incoming):
        return _heard(value)
    if isinstance(value, Closes):
        return "its end"
    if isinstance(value, Sends):
        return f"a mission on {value.channel} with {value.config}"
    if isinstance(value, LineContent):
        return f"a {value.kind} on {value.channel}" + (f" with {value.what}" if value.what else "")
    if isinstance(value, Malformed):
        return f"a malformed line: {value.says}"
    if isinstance(value, Passes | Elapsed):
        return "time passes" if value.time is None else f"{value.time / MICROSECONDS:g} s pass"
    if isinstance(value, tuple):
        return ", ".join(map(str, value)) or "no mission"
    return {Connects: "a robot connects", Drops: "a connection drops", Statuses: "statuses()"}.get(
        type(value), str(value)
    )


def _mission(mission: Mission) -> str:
    return f"{mission.status.value} for {mission.robot}" + (" (waits)" if mission.waits else "")


def _link(link: Link) -> str:
    return "an unnamed connection" if link.name is None else f"{link.name}'s connection"


def _submission(asked: Submission) -> str:
    if asked.defects:
        return f"submit(a mission: {'; '.join(asked.defects)})"
    parts = [f"robot {asked.robot}", f"channel {asked.channel}"]
    if asked.upstream:
        parts.append(f"{asked.upstream} upstream")
    for name, time in (("start_timeout", asked.start), ("timeout", asked.run)):
        if time is not None and not (name == "start_timeout" and time == DEFAULT_START):
            parts.append(f"{name} {time / MICROSECONDS:g}")
    return f"submit({', '.join(parts)})"


_KINDS = {
    NOISE: "a message for nobody",
    BLANK: "an empty line",
    BAD: "a line that is no message",
    FOREIGN: "a message with buffers",
}


def _heard(heard: Incoming) -> str:
    if heard.kind == NAME:
        return f"a robot says its name, {heard.what!r}"
    if heard.kind == STATUS:
        about = "of a mission" if heard.named else "of no mission in particular"
        return f"a robot reports {heard.what.upper()} {about} on {heard.channel}"
    return f"a robot sends {_KINDS[heard.kind]}"
