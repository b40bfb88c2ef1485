"""`missionfsm check` on the bare messages of one live subscription: what is wrong is told at once."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from commandline import CommandLine


def battery(number: int, charge: int = 50) -> Any:
    return {
        "metadata": {"timestamp": "2025-01-01T00:00:00Z", "sequenceNumber": number},
        "robotId": "a",
        "batteryState": {
            "chargePercent": charge,
            "state": "STATE_DISCHARGING",
            "chargeMethod": "CHARGE_METHOD_NONE",
        },
    }


def written(path: Path, *messages: Any) -> Path:
    path.write_text("".join(json.dumps(one) + "\n" for one in messages))
    return path


def test_right_messages_conform(command_line: CommandLine, tmp_path: Path) -> None:
    """A stream whose numbers grow and whose values are in their ranges conforms, and is counted."""
    ended = command_line("check", str(written(tmp_path / "s.jsonl", battery(1), battery(2))), "--json", "-")
    found = json.loads(ended.out)
    assert (ended.status, found["verdict"], found["system"], found["events"]) == (0, "conforms", "bear.status", 2)


@pytest.mark.parametrize(
    ("second", "rule"),
    [
        (battery(2, 150), "the-charge-is-a-percentage"),
        (battery(1, 49), "sequence-numbers-grow"),
        ({"robotId": "a"}, "messages-are-well-formed"),
        ({**battery(2), "robotId": ""}, "messages-are-well-formed"),
    ],
    ids=["a charge of 150", "the same number again", "no metadata", "an empty id"],
)
def test_a_wrong_message_is_a_violation(command_line: CommandLine, tmp_path: Path, second: Any, rule: str) -> None:
    """What is wrong with message 2 is told with its line and its rule, and what follows is judged as well."""
    path = written(tmp_path / "s.jsonl", battery(1), second, battery(3, 101))
    ended = command_line("check", str(path))
    lines = ended.out.splitlines()
    assert ended.status == 1
    assert (lines[0].startswith("line 2: message 2"), rule in lines[0]) == (True, True)
    assert (lines[1].startswith("line 3: message 3"), "the-charge-is-a-percentage" in lines[1]) == (True, True)
    assert ": violates: bear.status" in lines[2]


def test_a_live_stream_is_judged_as_it_comes() -> None:
    """What is wrong is told while the stream goes on."""
    command = [sys.executable, "-m", "missionfsm", "check", "-"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        child.stdin.write(json.dumps(battery(1, 150)) + "\n")
        child.stdin.flush()
        assert child.stdout.readline().startswith("line 1: message 1 about a: charge_percent is 150")
        child.stdin.close()
        assert child.wait(30) == 1


def navigation(number: int, robot: str = "a") -> Any:
    metadata = {"timestamp": "2025-01-01T00:00:00Z", "sequenceNumber": number}
    return {"metadata": metadata, "robotId": robot, "navigationState": {"stuckState": {"state": "STATE_NOT_STUCK"}}}


def missions(number: int, *listed: Any) -> Any:
    metadata = {"timestamp": "2025-01-01T00:00:00Z", "sequence_number": number}
    return {"metadata": metadata, "missions": list(listed), "current_mission_index": -1, "current_mission": None}


def verdicts(command_line: CommandLine, path: Path) -> Any:
    ended = command_line("check", path, "--json", "-")
    assert ended.err == ""
    return [(one["implementation"], one["verdict"], one["events"]) for one in json.loads(ended.out)]


def test_topics_of_one_file_are_told_apart(command_line: CommandLine, tmp_path: Path) -> None:
    """Messages of several subscriptions and robots in one file are judged apart; their numbers are never compared."""
    webhook = {"robot_id": "r1", "state": missions(1)}
    other = {"robot_id": "r2", "state": missions(9)}
    lines = [battery(10), navigation(3), webhook, other, battery(11), navigation(4), {**webhook, "state": missions(2)}]
    assert verdicts(command_line, written(tmp_path / "s.jsonl", *lines)) == [
        ("a stream of SubscribeBatteryStatus", "conforms", 2),
        ("a stream of SubscribeNavigationStatus", "conforms", 2),
        ("a stream of SubscribeMissionStatus", "conforms", 3),
    ]


def test_what_is_wrong_with_a_webhook_is_told(command_line: CommandLine, tmp_path: Path) -> None:
    """The body of a webhook is judged as a message of the subscription is, by its robot, with its line."""
    bodies = [{"robot_id": "r1", "state": missions(number)} for number in (2, 1)]
    charge = {"metadata": battery(1)["metadata"], "battery_state": battery(1, 150)["batteryState"]}
    ended = command_line("check", written(tmp_path / "s.jsonl", *bodies, {"robot_id": "r1", "state": charge}))
    lines = ended.out.splitlines()
    assert ended.status == 1
    assert lines[0].startswith("line 2: message 2 about r1: the sequence number is smaller (1 after 2)")
    assert lines[1].startswith("line 3: message 1 about r1: charge_percent is 150")


@pytest.mark.parametrize("line", [7, "text", [battery(2)], {"level": "info"}, {"metadata": {}, "payload": {}}])
def test_a_line_that_is_no_message_is_bad_input(command_line: CommandLine, tmp_path: Path, line: Any) -> None:
    """A line that is no message of a subscription is the author's fault, not the robot's: status 2 and its number."""
    path = written(tmp_path / "s.jsonl", battery(1), navigation(1), line)
    ended = command_line("check", path)
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert ended.err.startswith(f"missionfsm: {path}:3: ")


def test_a_message_that_came_twice_is_flagged(command_line: CommandLine, tmp_path: Path) -> None:
    """The same message again is a redelivery (TR-02), and what no bare message can break is listed as not checked."""
    path = written(tmp_path / "s.jsonl", battery(1), battery(2, 49), battery(2, 49), battery(3))
    found = json.loads(command_line("check", path, "--json", "-").out)
    assert (found["verdict"], found["readings"], len(found["flagged"])) == ("conforms", {"TR-02": ["b"]}, 1)
    assert found["flagged"][0].startswith("TR-02=b: Did a message come twice?")
    assert "bear.status/messages/updates-follow-the-state: no bare message can break it" in found["unchecked"]
    assert not any("sequence-numbers-grow" in one for one in found["unchecked"])


GOALS = [{"destination_id": "table-1", "pose": None}, {"destination_id": "table-2"}]
RUNS = {"mission_id": "A", "state": "STATE_RUNNING", "goals": GOALS, "current_goal_index": 1, "owner": "api"}


@pytest.mark.parametrize(
    ("repeated", "rule"),
    [
        ({"current_mission": RUNS, "current_goal": GOALS[1]}, None),
        ({"current_mission": {**RUNS, "mission_feedback": None}, "current_goal": {**GOALS[1], "pose": None}}, None),
        ({"current_mission": None, "current_goal": None}, None),
        ({"current_goal": {"destination_id": "table-7"}}, "the-current-goal-index-is-the-active-goal"),
        (
            {"current_mission": {**RUNS, "owner": "touchscreen"}, "current_goal": GOALS[1]},
            "the-current-mission-index-is-the-active-mission",
        ),
        ({"current_mission": 7, "current_goal": None}, "the-current-mission-index-is-the-active-mission"),
    ],
)
def test_what_a_webhook_repeats_says_the_same(
    command_line: CommandLine, tmp_path: Path, repeated: Any, rule: str | None
) -> None:
    """`current_mission` and `current_goal` are what the indexes say; anything else is flagged."""
    metadata = {"timestamp": "2025-01-01T00:00:00Z", "sequence_number": 1}
    state = {"metadata": metadata, "missions": [RUNS], "current_mission_index": 0, **repeated}
    path = written(tmp_path / "s.jsonl", {"robot_id": "r1", "state": state})
    ended = command_line("check", str(path), "--json", "-")
    found = json.loads(ended.out)["flagged"]
    assert (ended.status, len(found)) == (0, 0 if rule is None else 1)
    assert rule is None or rule in found[0]
    assert command_line("check", str(path), "--no-flagged").status == (1 if rule else 0)


@pytest.mark.parametrize(
    ("repeated", "says"),
    [
        (
            {"current_mission": {**RUNS, "mission_id": "B"}},
            "current_mission is not the one in missions at current_mission_index 0: it is 'B', not 'A'",
        ),
        (
            {"current_goal": GOALS[0]},
            "current_goal is not the one in goals at current_goal_index 1: it is the one at 0",
        ),
    ],
)
def test_a_webhook_that_names_another_mission_or_goal_violates(
    command_line: CommandLine, tmp_path: Path, repeated: Any, says: str
) -> None:
    """The current mission is one, and so is its goal: two that differ cannot both be it."""
    metadata = {"timestamp": "2025-01-01T00:00:00Z", "sequence_number": 1}
    state = {"metadata": metadata, "missions": [RUNS], "current_mission_index": 0, **repeated}
    ended = command_line("check", written(tmp_path / "s.jsonl", {"robot_id": "r1", "state": state}))
    assert (ended.status, says in ended.out) == (1, True)
    ended_mission = {**RUNS, "state": "STATE_SUCCEEDED"}
    state = {"metadata": metadata, "missions": [ended_mission], "current_mission_index": -1, **repeated}
    assert command_line("check", written(tmp_path / "t.jsonl", {"robot_id": "r1", "state": state})).status == 0


@pytest.mark.parametrize("first", [True, False])
def test_a_subscription_with_a_violation_stands_before_those_that_conform(
    command_line: CommandLine, tmp_path: Path, *, first: bool
) -> None:
    """Whichever of them began first; what is wrong on one is not made good by another."""
    online = {"metadata": {"timestamp": "2025-01-01T00:00:00Z", "sequenceNumber": 1}, "onlineStates": {}}
    wrong = [battery(3), battery(2)]
    path = written(tmp_path / "s.jsonl", *([*wrong, online] if first else [online, *wrong]))
    ended = command_line("check", str(path))
    heads = [line for line in ended.out.splitlines() if "a stream of" in line]
    assert ended.status == 1
    assert [" violates: " in heads[0], " conforms" in heads[1], len(heads)] == [True, True, 2]
