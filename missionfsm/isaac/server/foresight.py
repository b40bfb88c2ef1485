"""Which missions may be sent before a robot says more, so that a search need not imagine what cannot lead there.

A mission that waits for another becomes ready by a success that is reported, and by nothing else; one with an upstream
that has failed never does. Time alone ends missions, and makes none ready.
"""

from __future__ import annotations

from collections.abc import Hashable

from missionfsm.isaac.server.inputs import STATUS, Connects, Drops, Incoming
from missionfsm.isaac.server.state import UNDER_WAY, Link, Mission, Server
from missionfsm.isaac.shared.line import LineContent

_FAILS, _RUNS, _ASKS = "failure", "running", "statuses"
_MAKES_NONE_READY = frozenset({_FAILS, _RUNS, _ASKS})
"""What is reported, and what is asked, that makes no mission ready."""


def heeded(event: Connects | Drops | Incoming) -> str:
    """What is told of a drive: the status that is reported, where it is beyond doubt; else its name."""
    if not isinstance(event, Incoming) or event.kind != STATUS or event.odd or event.garbled:
        return event.name
    return event.what


def foresees(
    server: Server,
    _names: tuple[int, ...],
    content: object,
    _shown: tuple[int, ...],
    happens: frozenset[str],
    at: Hashable,
) -> bool:
    """Whether a mission may come to be sent on a connection while nothing else happens; see `Spec.foresees`."""
    if not (isinstance(content, LineContent) and content.kind == "mission" and happens <= _MAKES_NONE_READY):
        return True
    link = server.link_of_topic(at)
    if link is None or link.name is None or server.unsteady or server.gone:
        return True
    return any(
        (one.channel, one.config) == (content.channel, content.what) and _may_be_sent(one, link)
        for one in server.missions
    )


def _may_be_sent(mission: Mission, link: Link) -> bool:
    """Whether a mission may be sent on a connection, as far as its upstreams let it, or once more."""
    if mission.robot is not None and mission.robot != link.name:
        return False
    return mission.ready or (mission.status in UNDER_WAY and mission.sent_on != link.slot)
