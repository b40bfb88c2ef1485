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
    header = {"channel": channel, "pubtime": "1", "acqtime": "1"} | ({} if proto is None else {"proto": proto})
    return {"connection": 1, "line": json.dumps({"header": header, "payload": {"x": 1.5}})}


NAME = _line(TextProto("robot"), "name")
ARRIVES = {"drive": {"event": "line", "line": _line(MissionProto(MISSION, "{}"), "mission")["line"]}}
RUNS = _line(MissionStatusProto(MISSION, WireStatus.RUNNING), "mission_status")


@pytest.mark.parametrize(
    "other", [_of_type("123456"), _of_type("-5"), _of_type(None), _line(TextProto("battery low"), "log")]
)
def test_other_traffic_of_the_application_changes_nothing(other: Any) -> None:
    """Messages of other types and texts on other channels are allowed, and exercise no rule."""
    assert _judged(NAME, other, ARRIVES, SETTLED, other, RUNS, other, NAME).outcome is Outcome.CONFORMS
    assert _judged(other).outcome is Outcome.INCONCLUSIVE


def test_other_traffic_is_no_name_and_no_status() -> None:
    """A text on another channel does not stand for the name that a robot has to say."""
    silent = _judged(_line(TextProto("robot"), "log"), {"drive": {"event": "advance", "seconds": 90}})
    assert silent.outcome is Outcome.VIOLATES


@pytest.mark.parametrize(
    "wrong",
    [
        _of_type(123456),
        _of_type("twelve"),
        _of_type("TensorProto"),
        _of_type("123456", "mission_status"),
        _of_type("123456", "name"),
        _of_type(None, "mission_status"),
        _of_type(None, "name"),
        _line(TextProto("battery low"), "mission_status"),
        _line(MissionProto(MISSION, "{}"), "elsewhere"),
        _line(MissionStatusProto(MISSION, WireStatus.RUNNING), "elsewhere"),
    ],
    ids=str,
)
def test_messages_of_missions_and_malformed_ones_are_judged_on_every_channel(wrong: Any) -> None:
    """Malformed lines, other types on the channels of missions, and missions' messages elsewhere are violations."""
    assert _judged(NAME, wrong).outcome is Outcome.VIOLATES


def test_nothing_else_is_sent_without_a_connection() -> None:
    """Other traffic cannot come after the connection has dropped and things have settled."""
    dropped = {"drive": {"event": "disconnect"}}
    assert _judged(NAME, SETTLED, dropped, SETTLED, _of_type("123456")).outcome is Outcome.VIOLATES


def test_a_robot_of_which_the_world_says_no_name_has_the_one_of_the_protocol() -> None:
    """Without a name in the world a robot is called `robot`; with null it may have any name, always the same."""
    other = _line(TextProto("zzz"), "name")
    assert _judged(NAME).outcome is Outcome.CONFORMS
    assert _judged(other).outcome is Outcome.VIOLATES
    assert _judged(NAME, other).outcome is Outcome.VIOLATES
    assert _judged(other, world={"name": None}).outcome is Outcome.CONFORMS
    assert _judged(other, world={"name": "zzz"}).outcome is Outcome.CONFORMS


def test_a_name_that_is_any_is_written_as_it_is_read() -> None:
    """A world whose name is null is written with null; no other parameter may be null."""
    codec = ROBOT.codec
    assert codec.write_world(codec.read_world({"name": None}))["name"] is None
    with pytest.raises(UnreadableError):
        codec.read_world({"channel": None})


def test_over_tcp_nobody_knows_what_a_robot_is_called() -> None:
    """Over TCP a robot is tried in the world in which it may have any name."""
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


SUCCEEDED = {"drive": {"event": "behaviorSucceeded"}}
DROPS, CONNECTS = {"drive": {"event": "disconnect"}}, {"drive": {"event": "connect"}}
WAITS = {"drive": {"event": "advance", "seconds": 1}}
SUCCESS = _line(MissionStatusProto(MISSION, WireStatus.SUCCESS), "mission_status")


@pytest.mark.parametrize("late", [(RUNS,), (RUNS, RUNS, NAME), (NAME,), (_of_type("123456"),)])
def test_what_was_on_its_way_when_the_connection_dropped_may_still_come(late: Any) -> None:
    """Lines that were due before a drop may come after it, until things settle, time passes or the robot is back."""
    runs = (NAME, ARRIVES, SETTLED, RUNS, SETTLED, DROPS)
    assert _judged(*runs, *late, SETTLED, CONNECTS, NAME).outcome is Outcome.CONFORMS
    for later in (SETTLED, WAITS, CONNECTS):
        wrong = SUCCESS if later is CONNECTS else late[-1]
        assert _judged(*runs, later, wrong).outcome is Outcome.VIOLATES


def test_a_final_status_that_was_on_its_way_may_still_come_once() -> None:
    """A final status that was due before a drop may come after it, once; one that was not due may not."""
    ends = (NAME, ARRIVES, RUNS, SETTLED, SUCCEEDED, DROPS)
    assert _judged(*ends, SUCCESS).outcome is Outcome.CONFORMS
    assert _judged(*ends, SUCCESS, SUCCESS).outcome is Outcome.VIOLATES
    assert _judged(NAME, ARRIVES, RUNS, SETTLED, DROPS, SUCCESS).outcome is Outcome.VIOLATES


def test_a_tree_that_stops_while_no_mission_runs_is_nothing_to_the_codelet() -> None:
    """AI-31.idle b: a behavior that ends while no mission runs may be ignored, and never makes a status."""
    verdict = _judged(NAME, SETTLED, SUCCEEDED, SETTLED, ARRIVES, RUNS, SETTLED, SUCCEEDED, SUCCESS)
    assert [one.reading for one in verdict.flagged] == ["AI-31.idle=b"]
    assert _judged(NAME, SETTLED, SUCCEEDED, SUCCESS).outcome is Outcome.VIOLATES
    failure = _line(MissionStatusProto(MISSION, WireStatus.FAILURE), "mission_status")
    away = (NAME, ARRIVES, RUNS, SETTLED, DROPS, SETTLED, SUCCEEDED, SETTLED, CONNECTS, NAME)
    assert _judged(*away, failure).outcome is Outcome.VIOLATES


def test_a_status_is_a_name_or_a_number_which_is_flagged() -> None:
    """AI-28.status e: a robot may write a status as a number, which is flagged."""
    line = json.loads(RUNS["line"])
    for written, flagged in (("RUNNING", []), (0, ["AI-28.status=e"])):
        line["payload"]["missionStatus"] = written
        verdict = _judged(NAME, ARRIVES, {"connection": 1, "line": json.dumps(line)}, SETTLED)
        assert verdict.conforms
        assert [one.reading for one in verdict.flagged] == flagged


def test_a_robot_that_says_nothing_at_all_is_noticed() -> None:
    """It is connected from the start, so that no time passes before that."""
    assert _judged({"drive": {"event": "advance", "seconds": 600}}).outcome is Outcome.VIOLATES
    assert _judged(CONNECTS, NAME).outcome is Outcome.VIOLATES
