"""What of the mission server is drawn besides the lifecycle: dispatch to one robot, and missions that depend."""

from __future__ import annotations

from attrs import evolve

from missionfsm.isaac.server.inputs import NAME, Connects, Drops, Incoming, Statuses, Submission
from missionfsm.isaac.server.readings import AI_10_FROM, AMBIGUITIES
from missionfsm.isaac.server.samples import ROBOTS, STATUSES, header, introduction, robot_line
from missionfsm.isaac.server.state import (
    ENDED,
    NOBODYS,
    Mission,
    Sends,
    Server,
    Status,
    first_link_ref,
    mission_of_uuid,
)
from missionfsm.isaac.shared.drives import Passes
from missionfsm.isaac.wire.messages import MissionStatusProto
from missionfsm.kernel.alphabet import Input, pick
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.picture import Sketch
from missionfsm.kernel.terms import Refs

_TIMES = {"start_timeout": 5, "timeout": 15}


def _names(*robots: str) -> tuple[JSON, ...]:
    return tuple(introduction(robot, "name") for robot in robots)


_REPORTS = tuple(
    robot_line(header(MissionStatusProto, "mission_status"), {"uuid": pick("uuid", 1), "missionStatus": status})
    for status in STATUSES
)
_CONNECT: JSON = {"event": "connect"}
_DROP: JSON = {"event": "disconnect", "connection": pick("connection", 0)}
_PASS: JSON = {"event": "advance", "seconds": 6}
"""More than a mission has to be acknowledged, less than it has to run: no clock strikes at the very end of it."""


def _status(mission: Mission) -> str:
    return mission.status.value


def _dispatch_node(server: Server) -> str:
    there = server.serving(ROBOTS[0]) is not None
    if server.missions and server.missions[0].status in ENDED:
        return _status(server.missions[0])
    mission = _status(server.missions[0]) if server.missions else "no mission"
    return f"{mission}, the robot is {'there' if there else 'away'}"


def _label(
    server: Server, what: Submission | Statuses | Connects | Drops | Incoming | Passes, refs: Refs
) -> str | None:
    if isinstance(what, Submission):
        return "submit"
    if isinstance(what, Passes):
        return "time passes"
    if isinstance(what, Connects):
        return "it connects"
    if refs[0] is None or refs[0] < first_link_ref(server):
        return None
    if isinstance(what, Drops):
        return "its connection drops"
    if isinstance(what, Incoming) and what.kind == NAME:
        return "it says its name"
    if isinstance(what, Incoming) and mission_of_uuid(server, refs[1]) != NOBODYS:
        return f"it reports {what.what.upper()}"
    return None


def _shows(_: Sends) -> str:
    return "the mission is sent"


_NUMBERS = ("first", "second")


def _depend_node(server: Server) -> str | None:
    if len(server.missions) < len(ROBOTS) or not all(map(server.serving, ROBOTS)):
        return None
    first, second = map(_status, server.missions)
    return f"first {first}, second {second}"


def _depend_within(server: Server) -> bool:
    """Both robots come and stay, then both missions are submitted, the second while the first is not reported of."""
    robots = tuple(one.robot for one in server.missions)
    names = tuple(one.name for one in server.links)
    coming = all(name in (None, robot) for name, robot in zip(names, ROBOTS, strict=False))
    both = all(map(server.serving, ROBOTS))
    early = len(robots) == len(ROBOTS) or all(one.status in (Status.QUEUED, Status.STARTED) for one in server.missions)
    known = robots == ROBOTS[: len(robots)] and len(names) <= len(ROBOTS)
    return known and coming and early and (both or not robots)


def _depend_label(server: Server, what: Submission | Connects | Incoming | Passes, refs: Refs) -> str | None:
    """What robots report of their own missions, and of each other's where that may be heeded (AI-10.from w)."""
    if isinstance(what, Passes):
        return "time passes"
    if not isinstance(what, Incoming) or what.kind == NAME:
        return None
    robot = (-1 if refs[0] is None else refs[0]) - first_link_ref(server)
    mission = mission_of_uuid(server, refs[1])
    if robot < 0 or mission == NOBODYS:
        return None
    said = f"the {_NUMBERS[robot]} robot reports {what.what.upper()}"
    if mission == robot:
        return said
    return f"{said} of the {_NUMBERS[mission]} mission" if "w" in server.letters(AI_10_FROM) else None


def _simple(server: Server, assumed: int) -> Server:
    """Everything is decided beforehand that a server decides when it matters, so its clocks are those that count."""
    return evolve(server, left=tuple(sorted((one.id, "".join(one.possible(assumed))) for one in AMBIGUITIES)))


SKETCHES = (
    Sketch(
        "dispatch",
        "one mission for one robot",
        node=_dispatch_node,
        label=_label,
        within=lambda server: len(server.missions) <= 1 and len(server.links) <= 1,
        simple=_simple,
        shows=_shows,
        inputs=(Input("submit", {"mission": {"robot": ROBOTS[0], **_TIMES}}),),
        drives=(_CONNECT, *_names(ROBOTS[0]), *_REPORTS, _DROP, _PASS),
        contrasts=("AI-15.sent=a", "AI-15.sent=b", "AI-05=b"),
    ),
    Sketch(
        "dependency",
        "a mission that waits for another",
        node=_depend_node,
        label=_depend_label,
        within=_depend_within,
        simple=_simple,
        shows=_shows,
        inputs=(
            Input("submit", {"mission": {"robot": ROBOTS[0], **_TIMES}}),
            Input("submit", {"mission": {"robot": ROBOTS[1], **_TIMES, "upstream": [pick("mission", 0)]}}),
        ),
        drives=(_CONNECT, *_names(*ROBOTS), *_REPORTS, _PASS),
        contrasts=("AI-03=b",),
    ),
)
