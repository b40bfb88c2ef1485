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
        (battery(1), "sequence-numbers-grow"),
        ({"robotId": "a"}, "messages-are-well-formed"),
        (7, "messages-are-well-formed"),
    ],
    ids=["a charge of 150", "the same number again", "no metadata", "no object"],
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
