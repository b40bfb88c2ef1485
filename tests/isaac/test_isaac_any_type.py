"""Every member of a line is fed with every type of JSON: a verdict comes, whatever it is, and never a crash."""

import json
from collections.abc import Iterator
from typing import Any

import pytest
from server_history import History

from missionfsm.adapters.isaac.subjects import RobotSubject, ServerSubject
from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    Payload,
    TextProto,
    Uuid,
    WireStatus,
)
from missionfsm.oracle.transcript import Head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.verdict import Outcome, Verdict

ONE = Uuid(1, 1 << 61 | 1)
MESSAGES: dict[str, Payload] = {
    "mission": MissionProto(ONE, '{"a":{"b":{"c":1}}}'),
    "mission_status": MissionStatusProto(ONE, WireStatus.RUNNING),
    "name": TextProto("r"),
}
"""A message of each type, by its channel."""

VALUES = (
    *("null", "true", "0", "-1", "1.5", "1e400", "NaN", str(1 << 64), "9" * 5000),
    *('""', '"x"', '"01"', '"²"', '"null"', r'"\ud800"', f'"{"9" * 5000}"'),
    *("[]", "[[1]]", "{}", '{"a":1}', '{"lower":[],"upper":"x"}', '{"serialized":1}', "[" * 5000 + "]" * 5000),
)
"""A value of every type as JSON text, with those that are at the edge of one."""

UUID = (("uuid",), ("uuid", "lower"), ("uuid", "upper"))
HEADER = (("channel",), ("proto",), ("pubtime",), ("acqtime",), ("other",), *UUID)
PAYLOAD = (("config",), ("config", "serialized"), ("missionStatus",), ("text",), ("other",), *UUID)
PATHS = (
    *((), ("header",), ("payload",), ("other",)),
    *(("header", *path) for path in HEADER),
    *(("payload", *path) for path in PAYLOAD),
)

HOLE = "the value stands here"


def _put(raw: Any, path: tuple[str, ...]) -> Any:
    """A value in which a hole is at some place."""
    if not path:
        return HOLE
    members = raw if isinstance(raw, dict) else {}
    return {**members, path[0]: _put(members.get(path[0]), path[1:])}


def _lines(channel: str, values: tuple[str, ...] = VALUES) -> Iterator[str]:
    """A message with each value in the place of each member, with its type id and without."""
    typed = json.loads(encode(Message(Header(channel, 1, 1, ONE), MESSAGES[channel])))
    header = {key: value for key, value in typed["header"].items() if key != "proto"}
    for raw in (typed, {**typed, "header": header}):
        for path in PATHS:
            text = json.dumps(_put(raw, path))
            yield from (text.replace(json.dumps(HOLE), value) for value in values)


def _robot(*lines: Any) -> Verdict:
    drives = ("line", "behaviorSucceeded", "behaviorFailed", "advance")
    return check(system("isaac.robot"), Head("isaac.robot", {}, drives), (*lines, {"settled": True}))


@pytest.mark.parametrize("name", ["isaac.robot", "isaac.server"])
@pytest.mark.parametrize("channel", MESSAGES)
def test_every_member_may_be_of_any_type(channel: str, name: str) -> None:
    """What is sent and what arrives is read, or said to be unreadable, whatever is in it."""
    codec = system(name).codec
    for line in _lines(channel):
        for part in codec.split_message(line):
            codec.read_content(part[2])
        codec.read_drive({"event": "line", "connection": 1, "line": line})


FEW = ("null", "true", "1", "1e400", '"{}"', '"²"', "[1]", "{}")


@pytest.mark.parametrize("channel", MESSAGES)
def test_a_history_with_any_member_of_any_type_is_judged(channel: str) -> None:
    """A line of any types that a server hears is the robot's affair; any other one gets a verdict."""
    for line in _lines(channel, FEW):
        sent = {"connection": 1, "line": line}
        outcomes = {_robot(sent).outcome}
        server = History().submit(1).robot(1)
        server.lines.append(sent)
        outcomes.add(server.settles.judged().outcome)
        assert outcomes <= {Outcome.CONFORMS, Outcome.VIOLATES, Outcome.INCONCLUSIVE}, line
        heard = History().robot(1).drive("line", connection=1, line=line).settles.judged()
        assert heard.outcome is Outcome.CONFORMS, line
        arrived = _robot({"drive": {"event": "line", "line": line}})
        assert arrived.outcome in (Outcome.CONFORMS, Outcome.VIOLATES), line


@pytest.mark.parametrize("config", ['{"a":{"b":1}}', {"serialized": '{"a":{"b":1}}'}, {"a": {"b": 1}}], ids=str)
def test_a_mission_may_carry_its_configuration_as_a_text_or_an_object(config: Any) -> None:
    """AI-28: the page does not say how `config` is written; another configuration is wrong in every form."""
    raw = json.loads(encode(Message(Header("mission", 1, 1, Uuid(2, 2)), MissionProto(ONE, "{}"))))
    raw["payload"]["config"] = config
    for wanted, right in (({"a": {"b": 1}}, True), ({"a": {"b": 2}}, False)):
        history = History().submit(1, config=wanted).robot(1)
        history.lines.append({"connection": 1, "line": json.dumps(raw)})
        assert history.settles.judged().conforms is right


@pytest.mark.parametrize("channel", MESSAGES)
def test_what_ships_goes_on_after_a_line_of_any_types(channel: str) -> None:
    """The server that ships sends its mission after all that, and the robot that ships runs it."""
    server, robot = ServerSubject(), RobotSubject()
    for line in _lines(channel):
        robot.exchange("drive", {"event": "line", "line": line})
        number = server.exchange("drive", {"event": "connect"}).result["connection"]
        server.exchange("drive", {"event": "line", "connection": number, "line": line})
        server.exchange("drive", {"event": "disconnect", "connection": number})
    server.exchange("submit", {"mission": {"robot": "last"}})
    number = server.exchange("drive", {"event": "connect"}).result["connection"]
    hello = encode(Message(Header("name"), TextProto("last"))).decode()
    (sent,) = server.exchange("drive", {"event": "line", "connection": number, "line": hello}).after
    robot.exchange("drive", {"event": "line", "line": sent.params["line"]})
    reported = robot.exchange("drive", {"event": "advance", "seconds": 1}).after
    mission = json.loads(sent.params["line"])["payload"]["uuid"]
    assert {"uuid": mission, "missionStatus": "running"} in [
        json.loads(one.params["line"])["payload"] for one in reported
    ]


@pytest.mark.parametrize(
    "member", ["robot", "channel", "status_channel", "config", "start_timeout", "timeout", "upstream"]
)
def test_every_member_of_a_submission_may_be_of_any_type(member: str) -> None:
    """What ships takes or refuses it, and what it does is judged without a crash."""
    for value in (None, True, -1, 1.5, 1e400, 1 << 70, "", "x", [], [1], [None], [[]], {}, {"a": [1]}):
        server = ServerSubject()
        mission: Any = {"robot": "r", member: value}
        answer = server.exchange("submit", {"mission": mission})
        refused = answer.error is not None
        history = History()
        history.lines.append({"call": 1, "method": "submit", "params": {"mission": mission}})
        history.lines.append({"return": 1, **({"error": answer.error} if refused else {"result": answer.result})})
        assert history.settles.judged().outcome in (Outcome.CONFORMS, Outcome.INCONCLUSIVE), value
