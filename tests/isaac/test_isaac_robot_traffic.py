"""What else a robot's application sends on the connection, and what the robot is called."""

import json
from typing import Any

import pytest

from missionfsm.app.bridged import Sockets, bridged
from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
)
from missionfsm.kernel.codec import UnreadableError
from missionfsm.oracle.transcript import Head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.verdict import Outcome, Verdict
from missionfsm.tools.conform.run import BOUNDS

ROBOT = system("isaac.robot")
DRIVES = ("line", "behaviorSucceeded", "behaviorFailed", "advance", "disconnect", "connect")
SETTLED = {"settled": True}
MISSION = Uuid(1, 7)


def _judged(*lines: Any, world: Any = None) -> Verdict:
    return check(ROBOT, Head("isaac.robot", world or {}, DRIVES), (*lines, SETTLED))


def _line(payload: Any, channel: str) -> Any:
    return {"connection": 1, "line": encode(Message(Header(channel, 1, 1), payload)).decode().strip()}


def _of_type(proto: object, channel: str = "odometry") -> Any:
    header = {"channel": channel, "pubtime": "1", "acqtime": "1", "proto": proto}
    return {"connection": 1, "line": json.dumps({"header": header, "payload": {"x": 1.5}})}


NAME = _line(TextProto("robot"), "name")
ARRIVES = {"drive": {"event": "line", "line": _line(MissionProto(MISSION, "{}"), "mission")["line"]}}
RUNS = _line(MissionStatusProto(MISSION, WireStatus.RUNNING), "mission_status")


@pytest.mark.parametrize("other", [_of_type("123456"), _of_type("-5"), _line(TextProto("battery low"), "log")])
def test_other_traffic_of_the_application_changes_nothing(other: Any) -> None:
    assert _judged(NAME, other, ARRIVES, SETTLED, other, RUNS, other, NAME).outcome is Outcome.CONFORMS
    assert _judged(other).outcome is Outcome.INCONCLUSIVE


def test_other_traffic_is_no_name_and_no_status() -> None:
    silent = _judged(_line(TextProto("robot"), "log"), {"drive": {"event": "advance", "seconds": 60}})
    assert silent.outcome is Outcome.VIOLATES


@pytest.mark.parametrize(
    "wrong",
    [
        _of_type(123456),
        _of_type("twelve"),
        _of_type("TensorProto"),
        _of_type("123456", "mission_status"),
        _of_type("123456", "name"),
        _line(TextProto("battery low"), "mission_status"),
        _line(MissionProto(MISSION, "{}"), "elsewhere"),
        _line(MissionStatusProto(MISSION, WireStatus.RUNNING), "elsewhere"),
    ],
    ids=str,
)
def test_messages_of_missions_and_malformed_ones_are_judged_on_every_channel(wrong: Any) -> None:
    assert _judged(NAME, wrong).outcome is Outcome.VIOLATES


def test_nothing_else_is_sent_without_a_connection() -> None:
    dropped = {"drive": {"event": "disconnect"}}
    assert _judged(NAME, SETTLED, dropped, SETTLED, _of_type("123456")).outcome is Outcome.VIOLATES


def test_a_robot_of_which_the_world_says_no_name_has_the_one_of_the_protocol() -> None:
    other = _line(TextProto("zzz"), "name")
    assert _judged(NAME).outcome is Outcome.CONFORMS
    assert _judged(other).outcome is Outcome.VIOLATES
    assert _judged(NAME, other).outcome is Outcome.VIOLATES
    assert _judged(other, world={"name": None}).outcome is Outcome.CONFORMS
    assert _judged(other, world={"name": "zzz"}).outcome is Outcome.CONFORMS


def test_a_name_that_is_any_is_written_as_it_is_read() -> None:
    codec = ROBOT.codec
    assert codec.write_world(codec.read_world({"name": None}))["name"] is None
    with pytest.raises(UnreadableError):
        codec.read_world({"channel": None})


def test_over_tcp_nobody_knows_what_a_robot_is_called() -> None:
    found = bridged(ROBOT, Sockets(None, 0, None, 0.5), None, None, 1)
    found.subject.close()
    assert found.system.alphabet({}, BOUNDS).worlds == ({"name": None},)


def test_the_name_and_that_a_mission_runs_are_said_on_any_occasion() -> None:
    """They are said periodically: no sentence says that a line or an end is no occasion, nor that time has to pass."""
    little = {"drive": {"event": "advance", "seconds": 0.05}}
    elsewhere = {"drive": {"event": "line", "line": _line(TextProto("hello"), "chat")["line"]}}
    ends = {"drive": {"event": "behaviorSucceeded"}}
    success = _line(MissionStatusProto(MISSION, WireStatus.SUCCESS), "mission_status")
    spoken = (NAME, little, SETTLED, ARRIVES, NAME, SETTLED, RUNS, little, SETTLED)
    assert _judged(*spoken).outcome is Outcome.CONFORMS
    assert _judged(*spoken, elsewhere, RUNS, NAME, SETTLED, RUNS).outcome is Outcome.CONFORMS
    assert _judged(*spoken, ends, success, NAME).outcome is Outcome.CONFORMS
    assert _judged(*spoken, ends, success, RUNS).outcome is Outcome.VIOLATES
    assert _judged(NAME, little, SETTLED, elsewhere, RUNS).outcome is Outcome.VIOLATES
