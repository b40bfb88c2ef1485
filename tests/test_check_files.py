"""Recorded histories as files: what is malformed is refused in one line that says where; what is not is judged."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

import orjson
import pytest
from commandline import CommandLine

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.ids import IdSet

FIRST = '{"missionfsm": 1, "system": "bear.mission", "world": {}}'
CLEAR = '{"call": 1, "method": "ClearMissionStatus", "params": {}}'
CLEARED = '{"return": 1, "result": {"missionIds": []}}'


def clear(**more: JSON) -> str:
    return orjson.dumps({"call": 1, "method": "ClearMissionStatus", "params": {}, **more}).decode()


def first(**more: JSON) -> str:
    return orjson.dumps({"missionfsm": 1, "system": "bear.mission", "world": {}, **more}).decode()


# Name of the case: lines, number of the malformed one, what is said about it.
MALFORMED = {
    "not JSON": ([FIRST, '{"call": 1, oops'], 2, "not JSON"),
    "two values in a line": ([FIRST, CLEAR + CLEARED], 2, "not JSON"),
    "NaN": ([FIRST, '{"call": 1, "method": "CreateMission", "params": {"x": NaN}}'], 2, "not JSON"),
    "half a surrogate": ([FIRST, '{"call": 1, "method": "\\ud800"}'], 2, "not JSON"),
    "too deep": (
        [FIRST, '{"call": 1, "method": "SkipGoal", "params": ' + "[" * 5000 + "]" * 5000 + "}"],
        2,
        "not JSON",
    ),
    "a little too deep": (
        [FIRST, '{"call": 1, "method": "SkipGoal", "params": ' + '[{"x":' * 100 + "1" + "}]" * 100 + "}"],
        2,
        "nested more than 200 deep",
    ),
    "a list": ([FIRST, "[1]"], 2, "[1] is not an object"),
    "null": ([FIRST, "null"], 2, "null is not an object"),
    "no first line": ([CLEAR], 1, "the first line has to be"),
    "a first line that is a list": (["[]"], 1, "the first line has to be"),
    "another version": ([first(missionfsm=2)], 1, "history format 2 is not known; this is version 1"),
    "a version that is no number": ([first(missionfsm=True)], 1, "history format true is not known"),
    "an unknown system": ([first(system="bear.missoin")], 1, "there is no system 'bear.missoin'"),
    "a system of 10 MB": ([first(system=10_000_000 * "x")], 1, "there is no system 'xxx"),
    "a system that is no text": ([first(system=7)], 1, "system: 7 is not the name of a system"),
    "an unknown key of the first line": ([first(wrold={})], 1, "'wrold' is not known in a first line"),
    "an unknown drive of the tester": ([first(drives=["fly"])], 1, "drives: bear.mission has no 'fly'"),
    "drives that are no list": ([first(drives="world")], 1, "drives: 'world' is not a list of names"),
    "an unknown field of the world": ([first(world={"colour": "red"})], 1, "world.colour: there is no such field"),
    "a wrong value in the world": ([first(world={"family": "cat"})], 1, "world.family: 'cat' is none of"),
    "a wrong type in the world": ([first(world={"blocked": 1})], 1, "world.blocked: 1 is not true or false"),
    "a world that is no object": ([first(world=[])], 1, "world: [] is not an object"),
    "a line of no kind": ([FIRST, '{"frobnicate": 1}'], 2, "is none of call, return"),
    "a line of two kinds": ([FIRST, clear(**{"return": 1})], 2, "'return' is not known in a call line"),
    "an unknown key": ([FIRST, clear(parms={})], 2, "'parms' is not known in a call line"),
    "an unknown method": ([FIRST, clear(method="Clear")], 2, "'Clear' is not a method of bear.mission"),
    "a method that is no text": ([FIRST, clear(method=3)], 2, "method: 3 is not the name of a call"),
    "no method": ([FIRST, '{"call": 1}'], 2, "method: null is not the name of a call"),
    "params that are a list": ([FIRST, clear(params=[])], 2, "params: [] is not an object"),
    "params that are a number": ([FIRST, clear(params=0)], 2, "params: 0 is not an object"),
    "an id that is no number": ([FIRST, clear(call="1")], 2, "call: '1' is not a whole number"),
    "an id that is true": ([FIRST, clear(call=True)], 2, "call: true is not a whole number"),
    "an id that is no whole number": ([FIRST, clear(call=1.5)], 2, "call: 1.5 is not a whole number"),
    "an id that is too long": (
        [FIRST, '{"call": 1' + 40 * "0" + ', "method": "SkipGoal"}'],
        2,
        "is not a whole number",
    ),
    "an id of a call in flight": ([FIRST, CLEAR, CLEAR], 3, "call 1 was sent before"),
    "an id of an answered call": ([FIRST, CLEAR, CLEARED, CLEAR], 4, "call 1 was sent before"),
    "an answer to nothing": ([FIRST, CLEARED], 2, "return 1: no call with this id is waiting"),
    "a second answer": ([FIRST, CLEAR, CLEARED, CLEARED], 4, "return 1: no call with this id is waiting"),
    "an answer of two kinds": (
        [FIRST, CLEAR, '{"return": 1, "result": {}, "error": {"status": "INTERNAL"}}'],
        3,
        "return 1: expected either a result or an error",
    ),
    "an answer of two kinds, both null": (
        [FIRST, CLEAR, '{"return": 1, "result": null, "error": null}'],
        3,
        "return 1: expected either a result or an error",
    ),
    "an answer of no kind": ([FIRST, CLEAR, '{"return": 1}'], 3, "return 1: expected either a result or an error"),
    "an unknown error": ([FIRST, CLEAR, '{"return": 1, "error": {"status": "BOOM"}}'], 3, "'BOOM' is not the name of"),
    "an error that is OK": ([FIRST, CLEAR, '{"return": 1, "error": {"status": "OK"}}'], 3, "'OK' is not the name of"),
    "an error that is null": ([FIRST, CLEAR, '{"return": 1, "error": null}'], 3, "null is not the name of"),
    "a stream without a number": (
        [FIRST, '{"call": 1, "method": "SubscribeMissionStatus"}', '{"return": 1, "result": {}}'],
        3,
        "carries no stream number",
    ),
    "a stream that is true": ([FIRST, '{"stream": true, "message": {}}'], 2, "stream: true is not a whole number"),
    "a stream without a message": ([FIRST, '{"stream": 1}'], 2, "stream 1: expected a message or closed"),
    "a stream that ends with no error": (
        [FIRST, '{"stream": 1, "closed": true, "error": {"status": 13}}'],
        2,
        "error.status: 13 is not the name of",
    ),
    "a stream that ends with a message": (
        [FIRST, '{"stream": 1, "message": {}, "closed": true, "error": {"status": "INTERNAL"}}'],
        2,
        "stream 1: expected a message or closed (with an error or without), not both",
    ),
    "a message with an error": ([FIRST, '{"stream": 1, "message": {}, "error": {}}'], 2, "not both"),
    "a message that is closed": ([FIRST, '{"stream": 1, "message": {}, "closed": "yes"}'], 2, "not both"),
    "a stream that is nearly closed": ([FIRST, '{"stream": 1, "closed": "yes"}'], 2, "closed: 'yes' is not true"),
    "a stream with an error but open": ([FIRST, '{"stream": 1, "error": {}}'], 2, "closed: null is not true"),
    "a stream that ends with 0": ([FIRST, '{"stream": 1, "closed": true, "error": 0}'], 2, "error.status: null is"),
    "a stream that ends with a list": ([FIRST, '{"stream": 1, "closed": true, "error": []}'], 2, "error.status: null"),
    "a stream that ends with an error without a status": (
        [FIRST, '{"stream": 1, "closed": true, "error": {}}'],
        2,
        "error.status: null is not the name of",
    ),
    "cancelling nothing": ([FIRST, '{"call": 1, "method": "cancel", "params": {}}'], 2, "cancel: {} names no stream"),
    "an unknown drive": ([FIRST, '{"drive": {"event": "fly"}}'], 2, "drive.event: 'fly' is not a drive"),
    "a drive without an event": ([FIRST, '{"drive": {}}'], 2, "drive: {} names no event"),
    "a drive with a wrong field": (
        [FIRST, '{"drive": {"event": "world", "colour": "red"}}'],
        2,
        "world.colour: there is no such field",
    ),
    "a drive of the family": (
        [FIRST, '{"drive": {"event": "world", "family": "base"}}'],
        2,
        "drive.family: the family changes only with reset",
    ),
    "a robot that connects without a connection": (
        [first(system="isaac.server"), '{"drive": {"event": "connect"}}'],
        2,
        "drive.connection: null is not the number of a connection",
    ),
    "a time that is too long": (
        [first(system="isaac.server"), '{"drive": {"event": "advance", "seconds": 1e308}}'],
        2,
        "drive.seconds: 1e+308 is more than 1e+300 seconds",
    ),
    "a timeout that is too long": (
        [
            first(system="isaac.server"),
            '{"call": 1, "method": "submit", "params": {"mission": {"robot": "r", "timeout": 1e308}}}',
        ],
        2,
        "submit.timeout: 1e+308 is more than 1e+300 seconds",
    ),
    "a tolerance that is too long": (
        [first(system="isaac.server", world={"tolerance": 1e308})],
        1,
        "world.tolerance: 1e+308 is more than 1e+300 seconds",
    ),
    "a part that is a list": (
        [
            first(system="bear.status"),
            '{"drive": {"event": "report", "robotId": "r", "part": [], "value": null}}',
        ],
        2,
        "drive.part: [] is not a part",
    ),
    "a status that is a number": (
        [FIRST, CLEAR, '{"return": 1, "error": {"status": 9}}'],
        3,
        "error.status: 9 is not the name of a gRPC error (FAILED_PRECONDITION is)",
    ),
    "a status that no number is": (
        [FIRST, CLEAR, '{"return": 1, "error": {"status": 99}}'],
        3,
        "error.status: 99 is not the name of a gRPC error",
    ),
    "settled but not true": ([FIRST, '{"settled": 1}'], 2, "settled: 1 is not true"),
    "time going down": ([FIRST, clear(at=5.5), '{"return": 1, "at": 4}'], 3, "at: 4 comes after 5.5"),
    "time that is a text": ([FIRST, clear(at="5")], 2, "at: '5' is not a number of seconds"),
    "time that is null": ([FIRST, clear(at=None)], 2, "at: null is not a number of seconds"),
    "a robot that is no text": ([FIRST, clear(robot=5)], 2, "robot: 5 is not a text"),
    "a robot that is null": ([FIRST, clear(robot=None)], 2, "robot: null is not a text"),
    "a line of 10 MB": ([FIRST, clear(method=10_000_000 * "x")], 2, "is not a method of bear.mission"),
    "10 MB in the place of a robot": ([FIRST, clear(robot=[10_000_000 * "x"])], 2, "is not a text"),
}


@pytest.mark.parametrize("case", MALFORMED)
def test_a_malformed_line_is_refused_in_one_line(command_line: CommandLine, tmp_path: Path, case: str) -> None:
    """A malformed history ends with status 2 and one short line: file, line number, what is wrong; and no verdict."""
    lines, number, says = MALFORMED[case]
    path = tmp_path / "log.jsonl"
    path.write_text("".join(f"{line}\n" for line in lines))
    ended = command_line("check", path)
    assert (ended.status, ended.out) == (2, "")
    assert ended.err.startswith(f"missionfsm: {path}:{number}: ")
    assert says in ended.err
    assert ended.err.count("\n") == 1
    assert len(ended.err) < 400


@pytest.mark.parametrize(
    ("answer", "status"),
    [
        ('{"return": 1, "result": {"missionIds": []}, "error": null}', 0),
        ('{"return": 1, "error": null, "result": {"missionIds": ["A"]}}', 1),
        ('{"return": 1, "result": null, "error": {"status": "NOT_FOUND"}}', 1),
    ],
)
def test_a_member_that_is_null_beside_the_other_is_absent(
    command_line: CommandLine, tmp_path: Path, answer: str, status: int
) -> None:
    """What libraries write as null beside a result or an error is not there: the other one is judged."""
    path = tmp_path / "log.jsonl"
    path.write_text(f"{FIRST}\n{CLEAR}\n{answer}\n")
    ended = command_line("check", path)
    assert (ended.status, ended.err) == (status, "")


def test_what_is_deep_and_wide_is_read(command_line: CommandLine, tmp_path: Path) -> None:
    """A line may be nested 200 deep, have far more brackets than that, and is judged like any other."""
    path = tmp_path / "log.jsonl"
    deep = "[" * 198 + "{}," * 1000 + "1" + "]" * 198
    path.write_text(f'{FIRST}\n{clear()}\n{{"return": 1, "result": {deep}}}\n')
    ended = command_line("check", path, "--json", "-")
    assert (ended.status, ended.err, orjson.loads(ended.out)["verdict"]) == (1, "", "violates")


@pytest.mark.parametrize(
    ("content", "where", "says"),
    [
        (b"", "", "the history is empty"),
        (b"\n \n", "", "the history is empty"),
        (bytes(range(256)) * 40, ":1", "not JSON"),
        (FIRST.encode() + b"\n" + bytes(range(128, 256)) * 40, ":2", "not JSON"),
        (FIRST.encode("utf-16"), "", "it is UTF-16; what is read here is UTF-8"),
        (f"{FIRST}\n{CLEAR[:30]}".encode(), ":2", "the file ends in the middle of it"),
    ],
    ids=["empty", "blank", "rubbish", "rubbish after the first line", "UTF-16", "cut short"],
)
def test_what_is_no_history_is_refused(
    command_line: CommandLine, tmp_path: Path, content: bytes, where: str, says: str
) -> None:
    """A file that is empty, binary, or cut short ends with status 2 and one line."""
    path = tmp_path / "log.jsonl"
    path.write_bytes(content)
    ended = command_line("check", path)
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert ended.err.startswith(f"missionfsm: {path}{where}: ")
    assert says in ended.err


@pytest.mark.parametrize("content", [f"{FIRST}\r{CLEAR}".encode(), b'{"missionfsm" 1}'])
def test_only_what_is_cut_short_is_called_so(command_line: CommandLine, tmp_path: Path, content: bytes) -> None:
    """A last line without an end that goes wrong before its end is not said to be cut short."""
    path = tmp_path / "log.jsonl"
    path.write_bytes(content)
    ended = command_line("check", path)
    assert ended.err.startswith(f"missionfsm: {path}:1: not JSON: unexpected c")
    assert "in the middle" not in ended.err


@pytest.mark.parametrize(
    ("name", "says"),
    [("missing.jsonl", "No such file or directory"), (300 * "x", "File name too long")],
)
def test_what_is_no_file_is_refused(command_line: CommandLine, tmp_path: Path, name: str, says: str) -> None:
    """A path without a file ends with status 2 and the system's word for it."""
    path = tmp_path / name
    ended = command_line("check", path)
    assert (ended.status, ended.out, ended.err) == (2, "", f"missionfsm: {path}: {says}\n")


def test_a_malformed_file_keeps_no_other_from_being_judged(command_line: CommandLine, tmp_path: Path) -> None:
    """Of several files all that can be read are judged and written, then come the others, and the status is 2."""
    good, bad, last, out = (tmp_path / name for name in ("good.jsonl", "bad.jsonl", "last.jsonl", "out.json"))
    for path in (good, last):
        path.write_text(f"{FIRST}\n{CLEAR}\n{CLEARED}\n")
    bad.write_text("{")
    ended = command_line("check", good, bad, tmp_path / "missing", last, "--json", out)
    assert (ended.status, ended.err.count("\n")) == (2, 2)
    heads = [line for line in ended.out.splitlines() if "conforms" in line]
    assert heads == [f"{path}: conforms in part: bear.mission, 2 events" for path in (good, last)]
    assert [one["file"] for one in orjson.loads(out.read_bytes())] == [str(good), str(last)]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\n\n"], ids=["lines", "lines of Windows", "empty lines between"])
@pytest.mark.parametrize("last", [True, False], ids=["ended", "open"])
def test_a_well_formed_history_is_judged(command_line: CommandLine, tmp_path: Path, end: str, *, last: bool) -> None:
    """Any line ends do, also none after the last line."""
    path = tmp_path / "log.jsonl"
    path.write_bytes((end.join((FIRST, CLEAR, CLEARED)) + (end if last else "")).encode())
    ended = command_line("check", path)
    assert (ended.status, ended.err) == (0, "")
    assert ended.out.startswith(f"{path}: conforms in part: bear.mission, 2 events\n")


def test_stdin_is_judged(command_line: CommandLine) -> None:
    """``check -`` reads stdin, and says so where it is malformed."""
    good = command_line("check", "-", stdin=f"{FIRST}\n{CLEAR}\n{CLEARED}\n".encode())
    bad = command_line("check", "-", stdin=f"{FIRST}\n{CLEARED}\n".encode())
    nothing = command_line("check", "-")
    assert (good.status, good.out.partition("\n")[0]) == (0, "-: conforms in part: bear.mission, 2 events")
    assert (bad.status, bad.out) == (2, "")
    assert bad.err == "missionfsm: stdin:2: return 1: no call with this id is waiting for an answer\n"
    assert (nothing.status, nothing.err) == (2, "missionfsm: stdin: the history is empty\n")


def test_a_pipe_is_read_once(command_line: CommandLine, tmp_path: Path) -> None:
    """A named pipe, which cannot be read twice, is judged like a file."""
    path = tmp_path / "pipe"
    os.mkfifo(path)
    writer = threading.Thread(target=path.write_text, args=(f"{FIRST}\n{CLEAR}\n{CLEARED}\n",))
    writer.start()
    ended = command_line("check", path)
    writer.join()
    assert (ended.status, ended.out.partition("\n")[0]) == (0, f"{path}: conforms in part: bear.mission, 2 events")


# Several robots in one file.

DELIVERY = {"mission": {"serviMission": {"deliveryMission": {"goals": [{"destinationId": "table-1"}]}}}}


def fleet(*answers: JSON) -> list[JSON]:
    """Robots that are each asked for a mission, at the same time and with the same call id; with their answers."""
    asked = [
        {"call": 1, "method": "CreateMission", "params": DELIVERY, "robot": f"r{index}", "at": 1}
        for index in range(len(answers))
    ]
    said = [{"return": 1, "robot": f"r{index}", "at": 2 + index, **answer} for index, answer in enumerate(answers)]
    return [orjson.loads(FIRST), *asked, *said]


def write(path: Path, lines: list[JSON]) -> Path:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    return path


def test_robots_are_judged_apart(command_line: CommandLine, tmp_path: Path) -> None:
    """Lines of several robots may be mixed: each robot has its own ids, its own missions and its own verdict."""
    wrong = {"error": {"status": "FAILED_PRECONDITION"}}
    path = write(tmp_path / "fleet.jsonl", fleet({"result": {"missionId": "m"}}, wrong, {"result": {"missionId": "m"}}))
    ended = command_line("check", path, "--json", "-")
    found = orjson.loads(ended.out)
    assert ended.status == 1
    assert [(one["robot"], one["verdict"], one["events"]) for one in found] == [
        ("r0", "conforms", 2),
        ("r1", "violates", 2),
        ("r2", "conforms", 2),
    ]
    assert {one["file"] for one in found} == {str(path)}


def test_what_other_robots_do_is_nothing_that_a_robot_did(command_line: CommandLine, tmp_path: Path) -> None:
    """A robot of which nothing was seen is inconclusive in a file with others just as alone."""
    lines = [*fleet({"result": {"missionId": "m"}}), {"settled": True, "robot": "idle"}]
    ended = command_line("check", write(tmp_path / "log.jsonl", lines), "--json", "-")
    busy, idle = orjson.loads(ended.out)
    assert ended.status == 1
    assert (busy["verdict"], idle["verdict"], idle["because"]) == ("conforms", "inconclusive", "nothing was exercised")
    assert busy["coverage"]["rules"]
    assert not idle["coverage"]["rules"]


def test_lines_without_a_robot_are_a_robot_of_their_own(command_line: CommandLine, tmp_path: Path) -> None:
    """Lines with and without ``robot`` in one file are conversations apart."""
    named = {"call": 1, "method": "CreateMission", "params": DELIVERY}
    lines = [orjson.loads(FIRST), {**named, "robot": "r"}, named]
    answers = [{"return": 1, "result": {"missionId": "m"}, "robot": "r"}, {"return": 1, "result": {"missionId": "m"}}]
    path = write(tmp_path / "log.jsonl", lines + answers)
    ended = command_line("check", path)
    assert ended.status == 0
    heads = [line for line in ended.out.splitlines() if line.startswith(str(path))]
    assert heads == [
        f"{path} r: conforms in part: bear.mission, 2 events",
        f"{path}: conforms in part: bear.mission, 2 events",
    ]


def test_what_comes_after_a_violation_is_not_shown(command_line: CommandLine, tmp_path: Path) -> None:
    """However much that is, and wherever it is read from: the history ends with the line that is wrong."""
    wrong = [{"call": 1, "method": "SkipGoal"}, {"return": 1, "result": {"missionId": "m"}}]
    path = write(tmp_path / "log.jsonl", [orjson.loads(FIRST), *wrong, *({"settled": True} for _ in range(300))])
    shown = [
        orjson.loads(command_line("check", source, "--json", "-", stdin=stdin).out)["violation"]
        for source, stdin in ((path, b""), ("-", path.read_bytes()))
    ]
    assert [one["history"][1:] for one in shown] == [wrong, wrong]


def test_a_file_that_is_called_like_stdin_is_not_read(
    command_line: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``-`` is stdin, whatever else has that name; it is read once, whatever is undecided in it."""
    monkeypatch.chdir(tmp_path)
    Path("-").write_text("oops")
    calls = "".join(clear(call=number) + "\n" for number in range(1, 40))
    ended = command_line("check", "-", stdin=f"{FIRST}\n{calls}".encode())
    assert (ended.status, ended.err) == (1, "")
    assert "inconclusive" in ended.out


def test_an_id_that_comes_again_is_told_where_it_does(command_line: CommandLine, tmp_path: Path) -> None:
    """Also where other calls have no answer, so that the file is looked through for such."""
    refused = {"error": {"status": "FAILED_PRECONDITION"}}
    answered = [
        line
        for number in range(2, 30)
        for line in ({"call": number, "method": "SkipGoal"}, {"return": number, **refused})
    ]
    lost, again = {"call": 1, "method": "ClearMissionStatus"}, {"call": 5, "method": "SkipGoal"}
    path = write(tmp_path / "log.jsonl", [orjson.loads(FIRST), lost, *answered, again])
    ended = command_line("check", path)
    assert (ended.status, ended.out) == (2, "")
    assert ended.err == f"missionfsm: {path}:59: call 5 was sent before; ids are unique within a file\n"


def test_a_key_may_be_written_with_escapes(command_line: CommandLine, tmp_path: Path) -> None:
    """An answer is one however its keys are written; and a key that comes twice is the last, as in any JSON."""
    escaped = '{"r\\u0065turn":2,"error":{"status":"FAILED_PRECONDITION"}}'
    twice = '{"call":%d,"method":"SkipGoal","params":{},"c\\u0061ll":2}'
    lost = ['{"call":1,"method":"ClearMissionStatus"}', '{"call":2,"method":"SkipGoal"}', *['{"settled":true}'] * 40]
    path = tmp_path / "log.jsonl"
    path.write_text("\n".join((FIRST, *lost, escaped)))
    assert command_line("check", path).err == ""
    path.write_text("\n".join((FIRST, twice % 2, escaped, twice % 3)))
    assert "call 2 was sent before" in command_line("check", path).err


def test_a_line_is_malformed_whatever_came_before(command_line: CommandLine, tmp_path: Path) -> None:
    """Also one that only in its last byte differs from a line that is known."""
    shown = '{"missionStates":{"missions":[],"currentMissionIndex":-1}}'
    message = '{"stream":1,"message":{"metadata":{"timestamp":"2025-01-01T00:00:00Z","sequenceNumber":%d},' + shown[1:]
    subscribed = ['{"call":1,"method":"SubscribeMissionStatus"}', '{"return":1,"result":{"stream":1}}']
    path = tmp_path / "log.jsonl"
    path.write_text("\n".join((FIRST, *subscribed, message % 1 + "}", message % 2 + "!")))
    ended = command_line("check", path)
    assert (ended.status, ended.out) == (2, "")
    assert ended.err.startswith(f"missionfsm: {path}:5: not JSON")


def test_only_the_last_lines_of_a_long_history_are_kept(command_line: CommandLine, tmp_path: Path) -> None:
    """A violation at the end of a long history is found at its line, and shown with a few lines before it."""
    quiet = [
        line
        for number in range(2_000)
        for line in (
            {"call": number, "method": "ClearMissionStatus", "params": {}},
            {"return": number, "result": {"missionIds": []}},
        )
    ]
    wrong = [{"call": -1, "method": "SkipGoal"}, {"return": -1, "result": {"missionId": "m"}}, {"settled": True}]
    path = write(tmp_path / "log.jsonl", [orjson.loads(FIRST), *quiet, *wrong])
    ended = command_line("check", path, "--json", "-")
    found = orjson.loads(ended.out)
    assert (ended.status, found["verdict"], found["events"]) == (1, "violates", 4002)
    history = found["violation"]["history"]
    assert history[0] == orjson.loads(FIRST)
    assert wrong[1] in history
    assert len(history) < 250


def test_the_command_itself_refuses_in_one_line(tmp_path: Path) -> None:
    """The installed command, as a process: status 2, one line, no traceback."""
    path = tmp_path / "log.jsonl"
    path.write_text("{\n")
    command = [sys.executable, "-m", "missionfsm", "check", str(path)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr.count("\n")) == (2, "", 1)
    assert ended.stderr.startswith(f"missionfsm: {path}:1: not JSON: ")


def test_ids_are_a_set() -> None:
    """`IdSet` tells numbers that came before from new ones, negative and huge ones as well."""
    ids = IdSet()
    numbers = [0, 1, -1, 255, 256, -256, -257, 1 << 62, -(1 << 62)]
    assert [ids.add(number) for number in numbers] == [True] * len(numbers)
    assert [ids.add(number) for number in numbers] == [False] * len(numbers)
    assert ids.add(2)


def test_a_folder_is_judged_as_a_whole(command_line: CommandLine, tmp_path: Path) -> None:
    """All histories in a folder are judged, in as many processes as one likes, and a summary says what they come to."""
    folder = tmp_path / "logs"
    (folder / "day").mkdir(parents=True)
    right, wrong = (
        [FIRST, CLEAR, CLEARED],
        [FIRST, '{"call": 1, "method": "SkipGoal", "params": {}}', '{"return": 1, "result": {}}'],
    )
    for name, lines in (("a.jsonl", right), ("day/b.jsonl", wrong), ("day/c.jsonl", wrong), ("notes.txt", ["no"])):
        (folder / name).write_text("\n".join(lines) + "\n")
    out = tmp_path / "out.json"
    alone = command_line("check", folder, "--json", out, "--jobs", "1")
    verdicts = orjson.loads(out.read_bytes())
    together = command_line("check", folder, "--json", out, "--jobs", "2")
    assert (alone.status, together.status) == (1, 1)
    assert [{**one, "made": {}} for one in orjson.loads(out.read_bytes())] == [{**one, "made": {}} for one in verdicts]
    assert [(one["file"], one["verdict"]) for one in verdicts] == [
        (str(folder / "a.jsonl"), "conforms"),
        (str(folder / "day/b.jsonl"), "violates"),
        (str(folder / "day/c.jsonl"), "violates"),
    ]
    assert alone.out.startswith("3 judged: 1 conforms, 2 violates, 0 inconclusive; 0 flagged\n")
    assert [line.split()[1:] for line in alone.out.splitlines() if "SkipGoal" in line] == [
        ["2", "day/b.jsonl,", "line", "3"]
    ]


def test_what_cannot_be_read_in_a_folder_is_said_and_the_rest_is_judged(
    command_line: CommandLine, tmp_path: Path
) -> None:
    """A file that cannot be read is bad input; the others of its folder are judged all the same."""
    (tmp_path / "a.jsonl").write_text(f"{FIRST}\nnothing\n")
    (tmp_path / "b.jsonl").write_text(f"{FIRST}\n{CLEAR}\n{CLEARED}\n")
    ended = command_line("check", tmp_path)
    assert (ended.status, ended.out.startswith("1 judged: 1 conforms"), "a.jsonl:2" in ended.err) == (2, True, True)


def test_a_folder_without_histories_is_bad_input(command_line: CommandLine, tmp_path: Path) -> None:
    """A folder in which nothing is a history is said to be so, in one line."""
    ended = command_line("check", tmp_path)
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
