"""The command line: exit statuses, what goes to stdout, and that what is recorded is judged alike."""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from pathlib import Path

import orjson
import pytest
from commandline import CommandLine

from missionfsm import systems
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.middle import MIDDLE
from missionfsm.kernel.transport import TRANSPORT
from missionfsm.tools.explore import explore as visiting

FIRST = {"missionfsm": 1, "system": "bear.mission", "world": {}}
DELIVERY = {"mission": {"serviMission": {"deliveryMission": {"goals": [{"destinationId": "table-1"}]}}}}
GOOD = (FIRST, {"call": 1, "method": "CreateMission", "params": DELIVERY}, {"return": 1, "result": {"missionId": "m"}})
WRONG = (*GOOD[:2], {"return": 1, "error": {"status": "FAILED_PRECONDITION"}})

# An adapter of a robot to which nothing ever happens.
MUTE = """
import json, sys
about = {"implementation": {"name": "mute"}, "drives": DRIVES}
for line in sys.stdin:
    request = json.loads(line)
    result = {"initialize": about, "drive": {"happened": False}}.get(request["method"], {})
    print(json.dumps({"jsonrpc": "2.0", "id": request["id"], "result": result}), flush=True)
"""

# An adapter that answers every call with one error.
REFUSING = """
import json, sys
for line in sys.stdin:
    request = json.loads(line)
    answer = {"jsonrpc": "2.0", "id": request["id"], "result": {}}
    if request["method"] == "initialize":
        answer["result"] = {"implementation": {"name": "no"}, "drives": []}
    elif request["method"] not in ("reset", "settle", "cancel"):
        del answer["result"]
        answer["error"] = {"code": 13, "message": "no", "data": {"status": "INTERNAL"}}
    print(json.dumps(answer), flush=True)
"""


def history(path: Path, lines: tuple[object, ...]) -> Path:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    return path


def test_check_ends_with_its_verdict(command_line: CommandLine, tmp_path: Path) -> None:
    """``check`` ends with 0 where all histories conform, else with 1."""
    good, wrong = history(tmp_path / "good", GOOD), history(tmp_path / "wrong", WRONG)
    statuses = [command_line("check", *files).status for files in ((good,), (wrong,), (good, wrong), (good, good))]
    assert statuses == [0, 1, 1, 0]


@pytest.mark.parametrize("command", ["check", "conform"])
def test_what_exit_statuses_mean_is_said_where_one_looks(command_line: CommandLine, command: str) -> None:
    """The help of what ends with a verdict names all four."""
    shown = " ".join(command_line(command, "--help").out.split())
    _, _, says = shown.partition("Exit status: ")
    assert [f" {number}" in f" {says[:400]}" for number in range(4)] == [True] * 4


def test_nothing_exercised_is_inconclusive(command_line: CommandLine, tmp_path: Path) -> None:
    """A history in which nothing happened is inconclusive, which ends with 1."""
    ended = command_line("check", history(tmp_path / "none", (FIRST, {"settled": True})))
    assert ended.status == 1
    assert "inconclusive" in ended.out


def test_json_has_stdout_for_itself(command_line: CommandLine, tmp_path: Path) -> None:
    """``--json -`` writes JSON to stdout and nothing else; ``--json FILE`` leaves stdout to people."""
    wrong = history(tmp_path / "wrong", WRONG)
    alone = command_line("check", wrong, "--json", "-")
    found = orjson.loads(alone.out)
    assert (alone.err, found["verdict"], found["system"]) == ("", "violates", "bear.mission")
    assert found["violation"]["history"] == list(WRONG)
    both = command_line("check", wrong, "--json", tmp_path / "verdict.json")
    assert both.out.startswith(f"{wrong}: violates: bear.mission")
    written = orjson.loads((tmp_path / "verdict.json").read_bytes())
    assert {**written, "made": found["made"]} == found
    nowhere = command_line("check", wrong, "--json", tmp_path / "no" / "verdict.json")
    assert (nowhere.status, nowhere.err.count("\n")) == (2, 1)


def test_a_demanded_reading_decides(command_line: CommandLine, tmp_path: Path) -> None:
    """``--reading`` makes a violation of what another reading explains."""
    lines = (
        *GOOD,
        {
            "call": 2,
            "method": "UpdateMission",
            "params": {"missionCommand": {"missionId": "m", "command": "COMMAND_RESUME"}},
        },
        {"return": 2, "result": {}},
    )
    path = history(tmp_path / "log", lines)
    statuses = [
        command_line("check", path, *more).status for more in ((), ("--reading", "AM-29=b"), ("--reading", "AM-29=a"))
    ]
    assert statuses == [0, 0, 1]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("conform", "bear.missoin"), "there is no system 'bear.missoin'; there are bear.mission"),
        (("explore", "bear.missoin"), "there is no system 'bear.missoin'"),
        (("rules", "bear.missoin"), "there is no system 'bear.missoin'"),
        (("readings", "bear.missoin"), "there is no system 'bear.missoin'"),
        (("adapter", "bear.missoin"), "there is no system 'bear.missoin'"),
        (("explore", "bear.mission", "--reading", "AM-9=a"), "there is no ambiguity AM-9"),
        (("explore", "bear.mission", "--reading", "AM-09=z"), "AM-09 has no reading z"),
        (("explore", "bear.mission", "--reading", "AM-09"), "expected an ambiguity and a letter"),
        (("conform", "bear.mission", "--reading", "AM-09=z"), "AM-09 has no reading z"),
        (("adapter", "bear.mission", "--reading", "AM-09=z"), "AM-09 has no reading z"),
        (
            ("explore", "bear.mission", "--reading", "AM-09=a", "--reading", "AM-09=b"),
            "AM-09 was given the reading a before",
        ),
    ],
)
def test_bad_usage_ends_with_2(command_line: CommandLine, arguments: tuple[str, ...], says: str) -> None:
    """A system, an ambiguity or a reading that does not exist ends with status 2 and one line."""
    ended = command_line(*arguments)
    assert (ended.status, ended.out, ended.err.count("\n")) == (2, "", 1)
    assert ended.err.startswith("missionfsm: ")
    assert says in ended.err


@pytest.mark.parametrize(
    "arguments", [("conform",), ("check",), ("fly",), ("conform", "bear.mission", "--examples", "0")]
)
def test_bad_options_end_with_2(command_line: CommandLine, arguments: tuple[str, ...]) -> None:
    """Missing arguments, unknown commands and values out of range end with status 2."""
    ended = command_line(*arguments)
    assert (ended.status, ended.out) == (2, "")
    assert "Traceback" not in ended.err


def test_the_built_in_reference_conforms(command_line: CommandLine) -> None:
    """``conform`` without a command judges the reference behind the adapter protocol, and says so on stdout alone."""
    ended = command_line("conform", "bear.mission", "--examples", 3, "--steps", 10, "--seed", 1)
    assert (ended.status, ended.err) == (0, "")
    assert ended.out.startswith("conforms in part: bear.mission missionfsm reference 1, ")


@pytest.mark.long
def test_an_adapter_that_refuses_everything_is_inconclusive(command_line: CommandLine, tmp_path: Path) -> None:
    """An adapter that answers every call with a documented failure proves nothing: inconclusive, status 1."""
    path = tmp_path / "adapter.py"
    path.write_text(REFUSING)
    command = (sys.executable, path)
    ended = command_line("conform", "bear.mission", "--examples", 3, "--seed", 1, "--json", "-", "--", *command)
    found = orjson.loads(ended.out)
    assert (ended.status, found["verdict"], found["violation"]) == (1, "inconclusive", None)
    assert "refuses every call" in found["because"]


@pytest.mark.parametrize("drives", [[], ["line", "behaviorSucceeded", "behaviorFailed", "advance"]])
def test_a_robot_that_does_nothing_is_inconclusive(
    command_line: CommandLine, tmp_path: Path, drives: list[str]
) -> None:
    """A robot that nothing can be done to, or to which nothing happens, proves nothing: inconclusive, status 1."""
    path = tmp_path / "adapter.py"
    path.write_text(MUTE.replace("DRIVES", repr(drives)))
    command = (sys.executable, path)
    ended = command_line("conform", "isaac.robot", "--examples", 3, "--seed", 1, "--json", "-", "--", *command)
    found = orjson.loads(ended.out)
    told = (ended.status, found["verdict"], found["violation"], found["because"])
    assert told == (1, "inconclusive", None, "nothing was exercised")


@pytest.mark.long
def test_what_is_recorded_is_judged_alike(command_line: CommandLine, tmp_path: Path) -> None:
    """The history that ``conform --record`` writes is one that ``check`` finds the same violation in."""
    log = tmp_path / "violation.jsonl"
    # The reference follows AM-16=b, and AM-16=a is demanded.
    adapter = (sys.executable, "-m", "missionfsm", "adapter", "bear.mission", "--reading", "AM-16=b")
    options = ("--seed", 1, "--reading", "AM-16=a", "--record", log, "--json", "-")
    judged = command_line("conform", "bear.mission", *options, "--", *adapter)
    live = orjson.loads(judged.out)
    checked = command_line("check", log, "--reading", "AM-16=a", "--json", "-")
    found = orjson.loads(checked.out)
    assert (judged.status, checked.status) == (1, 1)
    assert (live["verdict"], found["verdict"]) == ("violates", "violates")
    for part in ("observed", "rules", "expected"):
        assert found["violation"][part] == live["violation"][part]
    assert command_line("check", log).status == 0


@pytest.mark.long
def test_explore_says_what_it_saw(command_line: CommandLine) -> None:
    """``explore`` ends with 0 where everything holds, and its JSON has the counts."""
    ended = command_line("explore", "bear.mission", "--missions", 1, "--goals", 1, "--batch", 1, "--json", "-")
    found = orjson.loads(ended.out)
    assert (ended.status, found["counterexample"]) == (1 if found["unmet"] else 0, None)
    assert found["bounds"] == {"missions": 1, "goals": 1, "batch": 1}
    told = command_line("explore", "bear.mission", "--missions", 1, "--goals", 1, "--batch", 1)
    assert told.status == ended.status
    assert told.out.startswith("bear.mission within size 1, goals 1, batch 1: ")


def test_what_takes_minutes_is_said_before_it_begins(
    command_line: CommandLine, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where a system has too many states within bounds, a line on stderr says so, and what is quicker."""
    one = functools.partial(visiting.explore, bounds=Bounds(0))
    monkeypatch.setattr(visiting, "explore", lambda explored, _, **how: one(explored, **how))
    said = "missionfsm: explore isaac.server: this takes minutes; --missions 1 takes seconds\n"
    assert command_line("explore", "isaac.server").err == said
    assert command_line("explore", "isaac.server", "--missions", 1).err == ""
    assert command_line("explore", "isaac.robot").err == ""


@pytest.mark.parametrize("what", ["rules", "readings"])
def test_lists_are_whole(command_line: CommandLine, what: str) -> None:
    """``rules`` and ``readings`` list everything of every system, in words and as JSON."""
    ids = []
    for one in map(systems.system, systems.names()):
        logs = (
            *(TRANSPORT if one.codec.streams else ()),
            *(MIDDLE if one.spec.middle and one.spec.middle.glimpses else ()),
        )
        ids += [each.id for each in (one.spec.all_rules if what == "rules" else (*one.spec.ambiguities, *logs))]
    words, json = command_line(what), command_line(what, "--json")
    assert [one["id"] for one in orjson.loads(json.out)] == ids
    assert [one for one in ids if one not in words.out] == []
    assert (words.status, json.status) == (0, 0)


def test_a_reader_that_goes_away_is_no_error() -> None:
    """Output into a pipe that is closed ends quietly."""
    command = f"{sys.executable} -m missionfsm rules | head -n 1"
    ended = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command], capture_output=True, text=True, check=False, env={**os.environ}
    )
    assert (ended.stderr, ended.stdout.count("\n")) == ("", 1)


def test_a_file_where_one_works_takes_no_modules_place(tmp_path: Path) -> None:
    """`python -m missionfsm` beside an adapter's queue.py uses Python's queue."""
    (tmp_path / "queue.py").write_text("raise SystemExit('not this one')\n")
    (tmp_path / "attrs.py").write_text("raise SystemExit('nor this one')\n")
    command = [sys.executable, "-m", "missionfsm", "conform", "isaac.robot", "--examples", "1", "--seed", "1"]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120)
    assert ran.stdout.startswith("conforms"), ran.stdout + ran.stderr
