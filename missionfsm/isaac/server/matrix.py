"""In which situations of a mission server a tester should have asked what, and had what happen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from missionfsm.isaac.server.inputs import (
    BAD,
    BLANK,
    DEFAULT_START,
    FOREIGN,
    NAME,
    STATUS,
    Connects,
    Drops,
    Incoming,
    Statuses,
    Submission,
)
from missionfsm.isaac.server.reports import STATUS_CHANNEL
from missionfsm.isaac.server.script import PAUSE, A, B, Script
from missionfsm.isaac.server.state import ENDED, FAILURES, PASS_PERIOD, UNDER_WAY, Link, Mission, Server, Status
from missionfsm.isaac.shared.drives import Passes
from missionfsm.kernel.alphabet import Bounds, ScriptStep
from missionfsm.kernel.matrix import Matrix
from missionfsm.kernel.terms import Refs

MANY, LINKS = 6, 3
"""Missions and connections up to which a server is tried."""

AWAY, BUSY, FREE = "is away", "is busy", "is free"


def situation(server: Server, _: object = ()) -> str | None:
    """The situation that a server is in; None where it has more missions or connections than it is tried with."""
    if len(server.missions) > MANY or len(server.links) > LINKS:
        return None
    there = any(link.serves for link in server.links)
    if any(link.name is not None and not link.serves for link in server.links):
        return "a name that two connections said"
    if not server.missions:
        return "nothing to do" if there else "nothing submitted"
    if all(one.status in ENDED for one in server.missions):
        return "all has ended" if there else "all has ended, no robot"
    return _of_missions(server)


def _of_missions(server: Server) -> str:
    queued = [one for one in server.missions if one.queued]
    if any(_robot(server, one.robot) == FREE for one in queued if one.waits):
        return "waiting for an upstream"
    at = {one.status for one in server.missions if one.status in UNDER_WAY}
    if not at:
        return "waiting for the robot"
    return f"{'running' if Status.RUNNING in at else 'sent'}{' with a queue' if queued else ''}"


def _robot(server: Server, name: str | None) -> str:
    if server.serving(name) is None:
        return AWAY
    return BUSY if any(one.status in UNDER_WAY and one.robot == name for one in server.missions) else FREE


def columns(server: Server, _: object, asked: object, refs: Refs) -> tuple[str, ...]:
    """The kinds of actions that a request or an event is an example of."""
    if isinstance(asked, Submission):
        return () if asked.defects else tuple(_of_submission(server, asked, refs))
    if isinstance(asked, Statuses | Connects):
        return ("statuses" if isinstance(asked, Statuses) else asked.name,)
    if isinstance(asked, Passes):
        return (_of_time(server, asked.time),)
    link = _link_at(server, refs)
    if link is None:
        return ()
    if isinstance(asked, Drops):
        return (f"disconnect of {_whose(server, link)}",)
    return _of_line(server, asked, refs[1:], link) if isinstance(asked, Incoming) else ()


def _link_at(server: Server, refs: Refs) -> Link | None:
    at = -1 if not refs or refs[0] is None else refs[0] - 2 * len(server.missions)
    return server.links[at] if 0 <= at < len(server.links) else None


def _mission_at(server: Server, ref: int | None) -> Mission | None:
    return server.missions[ref // 2] if ref is not None and ref < 2 * len(server.missions) else None


# Submissions.


def _of_submission(server: Server, asked: Submission, refs: Refs) -> Iterator[str]:
    upstream = [_mission_at(server, ref) for ref in refs]
    if None in upstream:
        yield "submit after a mission that does not exist"
    elif len(upstream) > 1:
        yield f"submit after two missions {_ends({one.status for one in upstream if one is not None})}"
    elif upstream:
        yield from (f"submit after a mission that is {one.status.value}" for one in upstream if one is not None)
    else:
        whom = "no robot in particular" if asked.robot is None else f"a robot that {_robot(server, asked.robot)}"
        yield f"submit to {whom}"
        yield from (f"submit with {what}" for what in _particulars(asked))


def _ends(statuses: set[Status]) -> str:
    if not statuses.isdisjoint(FAILURES):
        return "of which one failed"
    return "that succeeded" if statuses == {Status.SUCCESS} else "of which one has not ended"


def _particulars(asked: Submission) -> Iterator[str]:
    if asked.start != DEFAULT_START:
        yield "a start_timeout" if asked.start else "a start_timeout of 0"
    if asked.run is not None:
        yield "a timeout" if asked.run else "a timeout of 0"
    if asked.status_channel is not None:
        yield "channels of its own"


# Events.


def _of_time(server: Server, time: int) -> str:
    under_way = [one for one in server.missions if one.status in UNDER_WAY]
    if any(one.status is Status.STARTED and one.start is not None and one.start < time for one in under_way):
        return "start_timeout passes"
    if any(one.run is not None and one.run < time for one in under_way):
        return "timeout passes"
    return "a second passes" if time > PASS_PERIOD else "less than a second passes"


def _whose(server: Server, link: Link) -> str:
    if link.name is None:
        return "a connection without a name"
    if not link.serves:
        return "a connection whose name is another's"
    return f"a robot that {_robot(server, link.name)}"


_NO_MESSAGES = {
    BAD: "a line that is no message",
    BLANK: "a line that is no message",
    FOREIGN: "a message of another type",
}


def _of_line(server: Server, heard: Incoming, refs: Refs, link: Link) -> tuple[str, ...]:
    if heard.kind == STATUS:
        return (_of_status(server, heard, refs, link),)
    if heard.kind == NAME and heard.channel == server.name_channel:
        return (_of_name(server, heard.what, link),)
    if heard.kind == NAME:
        return ("a name on another channel",)
    return (_NO_MESSAGES.get(heard.kind, "a message to nobody"),)


def _of_name(server: Server, text: str, link: Link) -> str:
    name = text.strip()
    if not name:
        return "a name that is empty"
    if name != text:
        return "a name with space around it"
    known = {one.name for one in server.links} | {one.robot for one in server.missions}
    if name not in known and name.lower() in {one.lower() for one in known if one}:
        return "a name in other letters"
    if link.name == name:
        return "the name of a connection, again"
    if link.name is not None:
        return "another name"
    return "a name that another connection has" if server.serving(name) is not None else "a name"


def _of_status(server: Server, heard: Incoming, refs: Refs, link: Link) -> str:
    if heard.numeric:
        return "a status in numbers"
    named = refs[0] if heard.named else None
    mission = _mission_at(server, named if heard.named else refs[-1] if heard.header else None)
    if mission is None:
        return "a status of a mission that does not exist" if heard.named or heard.header else "a status of no mission"
    channels = (mission.status_channel,) if mission.status_channel else (STATUS_CHANNEL, f"{mission.channel}_status")
    if heard.channel not in channels:
        return "a status on another channel"
    if not heard.header:
        return "a status that its header does not name"
    if link.name != mission.robot:
        return "a status from another robot"
    if mission.status in (Status.ABORTED, Status.LOST):
        return f"a status of a mission that is {mission.status.value}"
    stands = "has ended" if mission.status in ENDED else f"is {mission.status.value}"
    return f"{heard.what.upper()} of a mission that {stands}"


# Ways.

LONG = 50
"""Seconds: a timeout that passes only where that is wanted, in the longest time that is let pass at once."""


def _ways(*scripts: Script) -> tuple[tuple[ScriptStep, ...], ...]:
    return tuple(tuple(one.lines) for one in scripts)


def _sent(robot: str = A) -> Script:
    return Script().submit(robot, start_timeout=LONG).robot(0, robot)


def _running(*others: str, robot: str = A) -> Script:
    script = Script().submit(robot, timeout=LONG)
    for other in others:
        script = script.submit(other)
    return script.robot(0, robot).report(0, 0, "running")


def _ended(status: str = "success") -> Script:
    return _running().report(0, 0, status)


def _timed_out() -> Script:
    return Script().submit(A, timeout=4).robot(0, A).report(0, 0, "running").wait(6)


def _canceled() -> Script:
    return Script().submit(A).submit(B, 0).robot(0, A).robot(1, B).report(0, 0, "failure")


def _lost() -> Script:
    return _running().drop(0)


def _two() -> Script:
    return Script().robot(0, A).robot(1, A)


def _late(before: Script, link: int = 0) -> Script:
    """A second mission of the robot, after what has ended."""
    return before.submit(A, start_timeout=LONG, timeout=LONG).wait().connect().say(link, 1, "running").wait(0.5)


WAYS: Mapping[str, tuple[tuple[ScriptStep, ...], ...]] = {
    "nothing submitted": _ways(Script(), Script().connect()),
    "nothing to do": _ways(Script().robot(0, A), Script().robot(0, B).connect(), Script().robot(0, A).robot(1, B)),
    "waiting for the robot": _ways(
        Script().submit(A),
        Script().submit(A).submit(B).robot(0, "carter-03"),
        _timed_out().submit(B),
        _ended("failure").submit(B),
        _ended().submit(B).wait(),
        _ended().submit(B).wait().connect(),
        Script().submit(A).connect().name(0, A).connect().name(1, A).drop(0).drop(1).connect(),
    ),
    "waiting for an upstream": _ways(
        Script().submit(B, start_timeout=LONG).submit(A, 0).robot(0, A).connect(),
        Script().submit(B, start_timeout=LONG).submit(A, 0).robot(0, A).robot(1, B),
        _running().submit(B, 0).robot(1, B),
        _canceled().submit(B, start_timeout=LONG).submit(A, 2),
        _timed_out().submit(B).submit(A, 1),
        _ended().submit(A).wait().report(0, 1, "success").submit(B).submit(A, 2),
    ),
    "sent": _ways(
        _sent(),
        _sent(B).connect(),
        _sent(B).robot(1, A),
        _sent().robot(1, B),
        _lost().robot(1, A).submit(A, start_timeout=LONG).wait(),
        _ended("failure").submit(A, start_timeout=LONG, timeout=4).wait(),
        _timed_out().submit(A, start_timeout=LONG).wait(),
        _ended().submit(A).wait().report(0, 1, "success").submit(A, start_timeout=LONG).wait(),
    ),
    "sent with a queue": _ways(
        _sent().submit(A).wait(),
        _sent(B).submit(B).wait().robot(1, A),
        _sent().submit(A, 0).submit(B).connect(),
        Script().submit(A, start_timeout=LONG, timeout=4).submit(A).robot(0, A),
        _timed_out().submit(A, start_timeout=LONG).submit(A).wait(),
        _lost().robot(1, A).submit(A, start_timeout=LONG).submit(A).wait(),
        _ended("failure").submit(A, start_timeout=LONG).submit(A).wait(),
    ),
    "running": _ways(
        _running(),
        _running().robot(1, B),
        _running(B).robot(1, B),
        _late(_ended()),
        _late(_timed_out()),
        _late(_lost().robot(1, A), 1),
        _canceled().submit(A, timeout=LONG).wait().report(0, 2, "running"),
        _canceled().submit(B, timeout=LONG).wait().report(1, 2, "running"),
    ),
    "running with a queue": _ways(
        _running(A),
        _running(A, B).connect(),
        _running(A, B).robot(1, B),
        _running(B, robot=B).robot(1, A),
        _late(_timed_out()).submit(A),
        _late(_ended("failure")).submit(A),
        _late(_lost().robot(1, A), 1).submit(A),
    ),
    "a name that two connections said": _ways(
        _two(),
        _two().connect(),
        _two().submit(B),
        _running().connect().name(1, A),
        _running(B).robot(1, B).connect().name(2, B),
        _ended("failure").connect().name(1, A),
        _ended().connect().name(1, A).wait(),
        _timed_out().connect().name(1, A),
        _sent().connect().name(1, A),
        _sent(B).robot(1, A).connect().name(2, A),
    ),
    "all has ended": _ways(_ended(), _ended("failure").connect(), _timed_out(), _canceled(), _lost().robot(1, A)),
    "all has ended, no robot": _ways(
        _ended().drop(0),
        _ended("failure").drop(0).connect(),
        _lost().connect(),
        _canceled().drop(0).drop(1),
        _timed_out().drop(0),
    ),
}

MATRIX = Matrix(situation, columns, WAYS, Bounds(), ScriptStep("drive", {"event": "advance", "seconds": PAUSE}))
