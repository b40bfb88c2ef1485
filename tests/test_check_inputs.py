"""Histories as people record them: compressed, with a byte order mark, damaged, of robots with their own clocks."""

from __future__ import annotations

import bz2
import gzip
import lzma
from pathlib import Path
from typing import Any

import orjson
import pytest
import zstandard
from commandline import CommandLine

from missionfsm.app.recorded import FIRST_LINE

NAVIGATE = {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}


def text(*lines: Any) -> bytes:
    return b"".join(orjson.dumps(line) + b"\n" for line in lines)


def created(call: int, mission: str, *, params: dict[str, Any] | None = None, **more: Any) -> list[Any]:
    return [
        {"call": call, "method": "CreateMission", "params": {**(params or {}), "mission": NAVIGATE}, **more},
        {"return": call, "result": {"missionId": mission}, **more},
    ]


FIRST = {"missionfsm": 1, "system": "bear.mission", "world": {}}
DAY = text(FIRST, *created(1, "A"))
HALF = len(text(FIRST))
FORMS = {
    "as it is": DAY,
    "a byte order mark": b"\xef\xbb\xbf" + DAY,
    "CRLF": DAY.replace(b"\n", b"\r\n"),
    "CRLF at the end of the file alone": DAY[:-1] + b"\r\n",
    "gzip": gzip.compress(DAY),
    "two members of gzip": gzip.compress(DAY[:HALF]) + gzip.compress(DAY[HALF:]),
    "gzip of a file with a byte order mark": gzip.compress(b"\xef\xbb\xbf" + DAY),
    "zstandard": zstandard.compress(DAY),
    "two frames of zstandard": zstandard.compress(DAY[:HALF]) + zstandard.compress(DAY[HALF:]),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("piped", [False, True], ids=["file", "pipe"])
def test_what_a_file_is_its_first_bytes_tell(
    command_line: CommandLine, tmp_path: Path, form: str, *, piped: bool
) -> None:
    """A history says the same in every form in which files come, whatever the file is called, from a pipe as well."""
    path = tmp_path / "log"
    path.write_bytes(FORMS[form])
    ended = command_line("check", "-" if piped else path, "--json", "-", stdin=FORMS[form] if piped else b"")
    found = orjson.loads(ended.out)
    assert (ended.status, ended.err, found["verdict"], found["events"]) == (0, "", "conforms", 2)


DAMAGED = {
    "gzip that is cut short": (gzip.compress(DAY)[:-9], ": the compressed data end too early: the file was cut short"),
    "gzip that is damaged": (gzip.compress(DAY)[:40] + b"????" + gzip.compress(DAY)[44:], ": Error -3 while"),
    "zstandard that is cut short": (zstandard.compress(DAY)[:-9], ": the compressed data end too early"),
    "zstandard that is damaged": (zstandard.compress(DAY)[:4] + 64 * b"?", ": zstd decompressor error"),
    "NUL bytes at the end": (DAY + 512 * b"\0", ":4: 512 NUL bytes stand here instead of a line: the file was cut off"),
    "NUL bytes in a line": (DAY + b'{"settled"\0', ":4: not JSON"),
    "bzip2": (bz2.compress(DAY), ": it is compressed (bzip2); what is read here is plain, gzip or Zstandard"),
    "xz": (lzma.compress(DAY), ": it is compressed (xz); what is read here is plain, gzip or Zstandard"),
    "ZIP": (b"PK\3\4" + 99 * b"?", ": it is compressed (ZIP); what is read here is plain, gzip or Zstandard"),
    "Latin-1": (DAY + b'{"name": "K\xfcche"}', ":4: not JSON: byte 0xfc at column 12 is not UTF-8"),
    "JSON over several lines": (
        b'{\n  "missionfsm": 1\n}\n',
        ":1: not JSON: unexpected end of data: line 1 column 2 (char 1) (a value has to stand in one line, as",
    ),
    "a list of lines": (
        b"[" + DAY.replace(b"\n", b",")[:-1] + b"]",
        f":1: the first line has to be {FIRST_LINE}; of a ",
    ),
    "something else": (
        b'{"level": "info"}',
        f":1: the first line has to be {FIRST_LINE}, or a message of a subscription",
    ),
}


@pytest.mark.parametrize("case", DAMAGED)
def test_what_is_damaged_is_said_in_one_sentence(command_line: CommandLine, tmp_path: Path, case: str) -> None:
    """A damaged file ends with status 2 and one line that says where and what."""
    content, says = DAMAGED[case]
    path = tmp_path / "log"
    path.write_bytes(content)
    ended = command_line("check", path)
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert ended.err.startswith(f"missionfsm: {path}{says}")


def test_without_the_extra_it_is_said_what_to_install(
    command_line: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file of Zstandard without the extra is bad input, and one line says what to install."""
    path = tmp_path / "log.zst"
    path.write_bytes(FORMS["zstandard"])
    monkeypatch.setitem(__import__("sys").modules, "zstandard", None)
    ended = command_line("check", path)
    says = f"missionfsm: {path}: it is compressed with Zstandard: install missionfsm[zst] to read it\n"
    assert (ended.status, ended.out, ended.err) == (2, "", says)


def judged(command_line: CommandLine, path: Path, *lines: Any) -> dict[str | None, tuple[str, int]]:
    path.write_bytes(text(*lines))
    ended = command_line("check", path, "--json", "-")
    assert ended.err == ""
    found = orjson.loads(ended.out)
    return {one["robot"]: (one["verdict"], one["events"]) for one in (found if isinstance(found, list) else [found])}


def test_robots_have_clocks_of_their_own(command_line: CommandLine, tmp_path: Path) -> None:
    """The time of one robot may be behind that of another; within one robot it never goes down."""
    skewed = [FIRST, *created(1, "A", robot="r1", at=100), *created(2, "A", robot="r2", at=7)]
    assert judged(command_line, tmp_path / "log", *skewed) == {"r1": ("conforms", 2), "r2": ("conforms", 2)}
    path = tmp_path / "back"
    path.write_bytes(text(*skewed, {"settled": True, "robot": "r1", "at": 99}))
    ended = command_line("check", path)
    says = "at: 99 comes after 100 of 'r1'; a robot's times never go back, so leave out all but one clock's"
    assert (ended.status, ended.err) == (2, f"missionfsm: {path}:6: {says}\n")


@pytest.mark.parametrize("key", ["robotId", "robot_id"])
def test_a_request_may_name_its_robot(command_line: CommandLine, tmp_path: Path, key: str) -> None:
    """Where requests name a robot, their answers and what comes on their streams are that robot's as well."""
    message = {
        key: "r1",
        "metadata": {"timestamp": {"seconds": "1743527100", "nanos": 0}, "sequenceNumber": 1},
        "missionStates": {"missions": [], "currentMissionIndex": -1},
    }
    lines = [
        FIRST,
        {"call": 1, "method": "SubscribeMissionStatus", "params": {key: "r1"}},
        *created(2, "A", params={key: "r2"}),
        {"return": 1, "result": {"stream": 1}},
        {"stream": 1, "message": message},
        {"call": 3, "method": "ClearMissionStatus", "params": {key: "r1"}},
    ]
    assert judged(command_line, tmp_path / "log", *lines) == {"r1": ("conforms", 4), "r2": ("conforms", 2)}


def test_calls_that_name_a_robot_are_followed_to_their_end(command_line: CommandLine, tmp_path: Path) -> None:
    """Of many robots named in params, the one with a call that is never answered is judged by its own lines alone."""
    lines: list[Any] = [FIRST]
    for call in range(1, 60, 2):
        lines += created(call, f"A{call}", params={"robotId": f"r{call}"})
        lines.append({"call": call + 1, "method": "SkipGoal", "params": {"robotId": f"r{call}"}})
    found = judged(command_line, tmp_path / "log", *lines)
    assert found == {f"r{call}": ("conforms", 3) for call in range(1, 60, 2)}


def empty(number: int, **more: Any) -> Any:
    stamp = {"timestamp": {"seconds": "1743527100", "nanos": 0}, "sequenceNumber": number}
    return {
        "stream": 1,
        "message": {**more, "metadata": stamp, "missionStates": {"missions": [], "currentMissionIndex": -1}},
    }


SUBSCRIBED = [{"call": 1, "method": "SubscribeMissionStatus", "params": {}}, {"return": 1, "result": {"stream": 1}}]
SELECTED = [{**SUBSCRIBED[0], "params": {"selector": {"robotIds": {"ids": ["r1"]}}}}, SUBSCRIBED[1]]
CLEARED = [
    {"call": 2, "method": "ClearMissionStatus", "params": {"robotId": "r1"}},
    {"return": 2, "error": {"status": "FAILED_PRECONDITION"}},
]


@pytest.mark.parametrize(
    ("lines", "found"),
    [
        ([*SUBSCRIBED, empty(1), *CLEARED, empty(2)], {None: ("conforms", 6)}),
        ([*CLEARED, *SUBSCRIBED, empty(1), {"drive": {"event": "world", "destinations": []}}], {"r1": ("conforms", 6)}),
        ([*SELECTED, empty(1, robotId="r1"), *CLEARED], {"r1": ("conforms", 5)}),
        ([*CLEARED, *SELECTED, empty(1, robotId="r1"), {"settled": True}], {"r1": ("conforms", 6)}),
    ],
    ids=["not-at-first", "at-first", "selected", "selected-later"],
)
def test_where_one_robot_is_named_all_lines_are_about_it(
    command_line: CommandLine, tmp_path: Path, lines: list[Any], found: dict[str | None, tuple[str, int]]
) -> None:
    """Params that name the only robot of a log in some calls do not take those apart from the others."""
    assert judged(command_line, tmp_path / "log", FIRST, *lines) == found


@pytest.mark.parametrize(
    "lines",
    [
        [*SUBSCRIBED, *CLEARED, *created(3, "A", params={"robotId": "r2"})],
        [*CLEARED, *created(3, "A", params={"robotId": "r2"}), *SUBSCRIBED],
    ],
    ids=["before", "after"],
)
def test_lines_that_name_none_of_several_robots_are_refused(
    command_line: CommandLine, tmp_path: Path, lines: list[Any]
) -> None:
    """Nobody can tell whose they are: one line says so."""
    path = tmp_path / "log"
    path.write_bytes(text(FIRST, *lines))
    ended = command_line("check", path)
    says = "params name several robots, as 'r1' and 'r2', but not everywhere: give every line its `robot`"
    assert (ended.status, ended.out, ended.err) == (2, "", f"missionfsm: {path}:6: {says}\n")


LATE = "a call was not answered, or only after everything had settled"


@pytest.mark.parametrize(
    ("answered", "flagged"), [((500.0, 503.0), []), ((2.0, 3.0), []), ((2.0, 90.0), [LATE])], ids=str
)
def test_a_silence_before_a_call_says_nothing_of_it(
    command_line: CommandLine, tmp_path: Path, answered: tuple[float, float], flagged: list[str]
) -> None:
    """`--settled-after`: what settles while nothing happens has settled before the line that ends the silence."""
    sent, returned = answered
    calls = [*created(1, "A", at=1.0), {"call": 2, "method": "ClearMissionStatus", "params": {}, "at": sent}]
    refused = {"return": 2, "error": {"status": "FAILED_PRECONDITION"}, "at": returned}
    path = tmp_path / "log"
    path.write_bytes(text({**FIRST, "drives": ["goalReached", "missionSucceeded", "missionFailed"]}, *calls, refused))
    ended = command_line("check", path, "--settled-after", "60", "--json", "-")
    found = orjson.loads(ended.out)
    assert (ended.status, found["verdict"], found["flagged"]) == (0, "conforms", flagged)


def test_what_ends_a_silence_tells_that_something_is_late(command_line: CommandLine, tmp_path: Path) -> None:
    """`--settled-after`: a list without a mission that should have started long ago is told with the time."""
    calls = [*SUBSCRIBED, {**empty(1), "at": 1.0}, *created(2, "A", at=2.0), {**empty(2), "at": 90.0}]
    path = tmp_path / "log"
    path.write_bytes(text(FIRST, *calls))
    ended = command_line("check", path, "--settled-after", "60")
    assert ended.status == 1
    assert "nothing had come for 60 s before it: what happens by itself" in ended.out
