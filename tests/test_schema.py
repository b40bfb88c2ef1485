"""The JSON Schemas of the two formats: what is written is valid, what is wrong is not."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from commandline import CommandLine

from missionfsm.adapters.stdio import Child
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.rules import STATUS_NUMBERS
from missionfsm.kernel.subject import Exchange, Subject
from missionfsm.systems import names, system
from missionfsm.tools.reference.subject import ReferenceSubject
from missionfsm.tools.schema import FORMATS, schema

TESTS = Path(__file__).parent
SCRIPTS = {
    "bear.mission": "bear_mission.mjs",
    "bear.status": "bear_status.mjs",
    "isaac.server": "isaac_server.mjs",
    "isaac.robot": "isaac_robot.mjs",
}


def validator(which: str, name: str | None) -> Any:
    made = schema(which, system(name) if name else None)
    jsonschema.Draft202012Validator.check_schema(made)
    return jsonschema.Draft202012Validator(made)


def on_the_wire(error: JSON) -> JSON:
    """An error as an adapter writes it."""
    return {"code": STATUS_NUMBERS[error["status"]], "message": error.get("message", ""), "data": error}


class Watched:
    """A subject, and every line that went to it and came from it, each kind of line a few times."""

    def __init__(self, subject: Subject) -> None:
        self.subject = subject
        self.lines: dict[str, list[JSON]] = {}

    def exchange(self, method: str, params: JSON) -> Exchange:
        found = self.subject.exchange(method, params)
        self.keep(f"{method} {found.error is None}", {"jsonrpc": "2.0", "id": 1, "method": method, "params": params})
        error = found.error
        answer: JSON = {"result": found.result} if error is None else {"error": on_the_wire(error)}
        self.keep(f"answer to {method} {error is None}", {"jsonrpc": "2.0", "id": 1, **answer})
        for one in (*found.earlier, *found.before, *found.after):
            self.keep(one.method, {"jsonrpc": "2.0", "method": one.method, "params": one.params})
        return found

    def keep(self, kind: str, line: JSON) -> None:
        kept = self.lines.setdefault(kind, [])
        if len(kept) < 12 and line not in kept:
            kept.append(line)

    def close(self) -> None:
        self.subject.close()


def wrong(validator: Any, lines: list[JSON]) -> list[str]:
    return [json.dumps(line) for line in lines if not validator.is_valid(line)]


def spoken(name: str, subject: Subject) -> list[JSON]:
    """The lines of a conversation with a subject in each of two worlds: everything worth asking, and every drive."""
    judged = system(name)
    watched, most = Watched(subject), 60 if judged.codec.streams else 12
    try:
        watched.exchange("initialize", {"protocolVersion": 1, "system": name})
        for world in judged.alphabet({}, Bounds()).worlds[:2]:
            alphabet = judged.alphabet(world, Bounds())
            watched.exchange("reset", {"world": world})
            asked = [(one.method, one.params) for one in (*alphabet.core_inputs, *alphabet.inputs)]
            driven: list[tuple[str, JSON]] = [("drive", one) for one in (*alphabet.core_drives, *alphabet.drives)]
            ends: list[tuple[str, JSON]] = [("cancel", {"stream": 1})] if judged.codec.streams else []
            subscribed: list[tuple[str, JSON]] = [one for one in asked if one[0] in judged.codec.streams][:3]
            for method, params in (
                *subscribed,
                *asked[:most],
                *driven[:most],
                ("settle", {}),
                *ends,
            ):
                if "$" not in json.dumps(params):
                    watched.exchange(method, params)
    finally:
        watched.close()
    return [line for kept in watched.lines.values() for line in kept]


@pytest.mark.parametrize("name", names())
def test_what_the_reference_and_the_tester_say_is_valid(name: str) -> None:
    """Every line of conversations with the reference is valid for its system, and for any."""
    lines = spoken(name, ReferenceSubject(system(name)))
    assert len(lines) > 15
    assert wrong(validator("adapter", name), lines) == []
    assert wrong(validator("adapter", None), lines) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", names())
def test_what_an_implementation_in_another_language_says_is_valid(name: str) -> None:
    """Every line of conversations with our implementations in Node.js is valid."""
    if shutil.which("node") is None:
        pytest.skip("Node.js is not installed")
    assert (
        wrong(validator("adapter", name), spoken(name, Child(["node", str(TESTS / "subjects" / SCRIPTS[name])]))) == []
    )


def test_recorded_histories_are_valid() -> None:
    """Every line of the recorded histories that conform is valid."""
    checked = 0
    valid = {name: validator("history", name) for name in names()}
    for path in sorted((TESTS / "bear" / "edges" / "conform").glob("*.jsonl")):
        lines = [json.loads(line) for line in path.read_text().splitlines()]
        assert wrong(valid[lines[0]["system"]], lines) == [], path.name
        checked += len(lines)
    assert checked > 100


@pytest.mark.parametrize(
    ("which", "line"),
    [
        ("adapter", {"jsonrpc": "2.0", "id": 1, "method": "drive", "params": {"event": "goalreached"}}),
        ("adapter", {"jsonrpc": "2.0", "id": 1, "method": "reset", "params": {"world": {"family": "cart"}}}),
        ("adapter", {"jsonrpc": "2.0", "id": 1, "result": {"missionId": 7}}),
        ("adapter", {"jsonrpc": "2.0", "id": 1, "error": {"code": 9, "message": "", "data": {"status": "NOPE"}}}),
        ("adapter", {"jsonrpc": "2.0", "method": "message", "params": {"stream": 1, "message": {"missionStates": 1}}}),
        ("adapter", {"id": 1, "result": {}}),
        ("history", {"missionfsm": 2, "system": "bear.mission"}),
        ("history", {"call": 1, "method": "createMission", "params": {}}),
        ("history", {"return": 1}),
        ("history", {"drive": {"event": "fault", "status": "ABORTED"}}),
        ("history", {"settled": False}),
        ("history", {"settled": True, "at": "12:00"}),
    ],
    ids=str,
)
def test_what_is_wrong_is_not_valid(which: str, line: JSON) -> None:
    """A misspelt name, a value of a wrong type and a member that is missing are found."""
    assert not validator(which, "bear.mission").is_valid(line)


def test_the_command_writes_the_schema(command_line: CommandLine) -> None:
    """`missionfsm schema` writes it to stdout; another format or system is bad usage."""
    ended = command_line("schema", "history", "--system", "isaac.server")
    assert (ended.status, json.loads(ended.out)) == (0, schema("history", system("isaac.server")))
    assert command_line("schema", "log").status == 2
    assert command_line("schema", "history", "--system", "bear").status == 2
    assert {json.loads(command_line("schema", one).out)["title"] for one in FORMATS} == {
        "a line of the adapter protocol, version 1, for any system",
        "a line of the history format, version 1, for any system",
    }
