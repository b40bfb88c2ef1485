"""Logs of a robot's connection that begin while it is in use: what cannot be known is not judged, the rest is."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import orjson
import pytest
from traffic import readings_at_random

from missionfsm.app.asked import judged_system
from missionfsm.app.recorded import check_file
from missionfsm.isaac.wire.framing import as_line
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
)
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.reference.subject import ReferenceSubject

ROBOT = judged_system("isaac.robot", strict=True)
DRIVES = ("line", "advance", "behaviorSucceeded", "behaviorFailed", "disconnect", "connect")


def judged(folder: Path, lines: list[Any], drives: tuple[str, ...] = DRIVES, **first: str) -> Verdict:
    head = {"missionfsm": 1, "system": "isaac.robot", "world": {}, "drives": list(drives), **first}
    path = folder / "log.jsonl"
    path.write_bytes(b"\n".join(map(orjson.dumps, [head, *lines])) + b"\n")
    ((_, verdict),) = check_file(str(path))
    return verdict


def line(channel: str, payload: MissionProto | MissionStatusProto | TextProto, number: int) -> str:
    return as_line(Message(Header(channel, number, number, Uuid(number, 9)), payload))


def sent(number: int, uuid: int, config: str = "{}") -> Any:
    """A mission with that identifier is sent to the robot; 0 for none."""
    proto = MissionProto(Uuid(uuid, 7) if uuid else None, config)
    return {"drive": {"event": "line", "line": line("mission", proto, number)}}


def says(status: str, uuid: int) -> Any:
    """The robot says a status of the mission with that identifier."""
    proto = MissionStatusProto(Uuid(uuid, 7), WireStatus(status))
    return {"connection": 4, "line": line("mission_status", proto, 100 + uuid)}


NAME = {"connection": 4, "line": line("name", TextProto("robot"), 99)}
SETTLED = {"settled": True}


def driven(event: str, **more: Any) -> Any:
    return {"drive": {"event": event, **more}}


def passes(seconds: float) -> list[Any]:
    return [driven("advance", seconds=seconds), NAME]


def conversation(seed: int, steps: int) -> list[Any]:
    """The lines of a conversation with a reference that follows some readings."""
    random = Random(seed)
    reference = ReferenceSubject(ROBOT, readings_at_random(seed, ROBOT) if seed % 4 else {})
    lines = [one.params for one in reference.exchange("reset", {"world": {}}).after]
    for number in range(1, steps + 1):
        what = random.randrange(12)
        if what == 0:
            lines.append(SETTLED)
            continue
        if what < 5:
            uuid, config = random.choice((number, number, number - 1, 0)), random.choice(("{}", "{}", "{}", "no json"))
            drive = sent(number, uuid, config)["drive"]
        elif what < 8:
            drive = {"event": "advance", "seconds": random.choice((0.3, 1, 5, 50))}
        else:
            drive = {"event": random.choice(DRIVES[2:])}
        exchange = reference.exchange("drive", drive)
        lines += [{"drive": drive}] * bool(exchange.result["happened"]) + [one.params for one in exchange.after]
    return [*lines, *(one.params for one in reference.exchange("drive", {"event": "advance", "seconds": 5}).after)]


@pytest.mark.parametrize("drives", [(), ("line",), DRIVES[:4], DRIVES])
@pytest.mark.parametrize("seed", range(3))
def test_a_conforming_log_that_is_cut_anywhere_is_no_violation(
    tmp_path: Path, seed: int, drives: tuple[str, ...]
) -> None:
    """However much of a right log is missing at its beginning, what is left is judged, and never a violation."""
    lines = conversation(10 * seed + len(drives), 14)
    wrong = {}
    for cut in range(len(lines)):
        verdict = judged(tmp_path, lines[cut:], drives, begins="anywhere")
        if verdict.violation is not None or "too many" in str(verdict):
            wrong[cut] = str(verdict)
    assert wrong == {}


RIGHT = {
    "a mission that was running ends": [
        says("running", 1),
        driven("behaviorSucceeded"),
        says("success", 1),
        *passes(2),
    ],
    "it is preempted": [
        *(says("running", 1), sent(1, 2), says("failure", 1), says("running", 2), SETTLED),
        *(driven("behaviorFailed"), says("failure", 2), *passes(2)),
    ],
    "statuses were waiting": [says("success", 1), says("failure", 2), sent(1, 3), says("running", 3), *passes(2)],
    "they wait for the connection": [
        *(driven("connect"), NAME, says("failure", 1), sent(1, 3), says("running", 3)),
        *(driven("behaviorSucceeded"), says("success", 3), *passes(2)),
    ],
    "the connection drops first": [
        *(driven("disconnect"), driven("connect"), NAME, says("failure", 1), says("running", 2), *passes(2)),
    ],
    "nothing runs": [NAME, *passes(50), *passes(50), sent(1, 1), says("running", 1), *passes(2)],
    "a mission without an identifier runs": [
        {"connection": 4, "line": line("mission_status", MissionStatusProto(None, WireStatus.RUNNING), 5)},
        *(driven("behaviorFailed"), SETTLED),
        {"connection": 4, "line": line("mission_status", MissionStatusProto(None, WireStatus.FAILURE), 6)},
        *passes(2),
    ],
}


@pytest.mark.parametrize("what", RIGHT)
def test_what_was_before_the_log_explains_it(tmp_path: Path, what: str) -> None:
    """It is accepted of a log that begins anywhere, and not of one that begins with the beginning."""
    verdict = judged(tmp_path, RIGHT[what], begins="anywhere")
    assert verdict.headline.startswith("conforms")
    assert what == "nothing runs" or judged(tmp_path, RIGHT[what]).violation is not None


LATER = [says("running", 1), *passes(2), *passes(2), says("running", 1)]
WRONG = {
    "another status than the tree's": ([*LATER, driven("behaviorSucceeded"), says("failure", 1)], "success"),
    "another mission's": (
        [sent(1, 2), says("running", 2), *passes(2), *passes(2), driven("behaviorSucceeded"), says("success", 3)],
        "about-its-mission",
    ),
    "no status at all": ([*LATER, driven("behaviorSucceeded"), *passes(2)], "success"),
    "no FAILURE of the one before": ([*LATER, sent(1, 2), says("running", 2), *passes(2)], "failure"),
    "a status after the last one": (
        [*LATER, driven("behaviorSucceeded"), says("success", 1), *passes(2), says("success", 1)],
        "success",
    ),
    "one that the tree did not report": ([*LATER, says("success", 1)], "starts-the-behavior-tree"),
    "its name comes no more": (
        [sent(1, 2), says("running", 2), driven("advance", seconds=100), says("running", 2)],
        "name",
    ),
    "a final status long after": (
        [sent(1, 2), says("running", 2), *passes(2), *passes(2), says("success", 1)],
        "success",
    ),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_can_be_known_is_judged(tmp_path: Path, what: str) -> None:
    """What a message has shown is known from then on; so is that nothing waits any more once a tick is over."""
    lines, rule = WRONG[what]
    violation = judged(tmp_path, [*lines, SETTLED], begins="anywhere").violation
    assert violation is not None
    assert any(rule in one.id for one in violation.rules), violation.rules
