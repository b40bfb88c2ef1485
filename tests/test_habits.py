"""What people expect of any command line: -h, --version, defaults in pyproject.toml, JUnit."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
import typer
from commandline import CommandLine

import missionfsm
from missionfsm.cli import app
from missionfsm.cli.helping import EXAMPLES, completed
from missionfsm.systems import names, system

EDGES = Path(__file__).parent / "bear" / "edges"
GOOD = EDGES / "conform" / "AM-53-failed-without-having-run.jsonl"
BAD = EDGES / "violate" / "M-72-no-time.jsonl"


def test_dash_h_is_help(command_line: CommandLine) -> None:
    """-h is --help, of the program and of a command."""
    assert command_line("-h") == command_line("--help")
    assert command_line("check", "-h") == command_line("check", "--help")
    assert command_line("-h").status == 0


def test_the_version_is_that_of_the_package(command_line: CommandLine) -> None:
    """--version says the name and the version."""
    ended = command_line("--version")
    assert (ended.status, ended.out) == (0, f"missionfsm {missionfsm.__version__}\n")


def test_junit_has_a_test_case_for_each_verdict(command_line: CommandLine, tmp_path: Path) -> None:
    """What violates is a failure with the whole verdict in it; what conforms is a test that passes."""
    found = tmp_path / "junit.xml"
    assert command_line("check", GOOD, BAD, "--junit", found).status == 1
    suite = ET.fromstring(found.read_text())  # noqa: S314 - our own
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("2", "1", "0")
    good, bad = suite.findall("testcase")
    assert (good.get("classname"), good.get("name"), good.find("failure")) == ("bear.mission", str(GOOD), None)
    failure = bad.find("failure")
    assert failure is not None
    assert (failure.get("message") or "").startswith("violates: bear.mission")


NEW_FORMAT = """
from missionfsm.reports.report import Report


def written(report: Report) -> bytes:
    return "".join(f"{one.file},{one.verdict.outcome.value}\\n" for one in report.findings).encode()
"""
REGISTERED = """
from missionfsm.reports.formats import FORMATS, Format
FORMATS["csv"] = Format("their_format", "Write a line for each file.")
from missionfsm.cli import main
main()
"""


def test_a_format_of_reports_is_a_module_and_a_row(tmp_path: Path) -> None:
    """What a module makes of a report is written where the option of its name says; no command knows of it."""
    (tmp_path / "their_format.py").write_text(NEW_FORMAT)
    program = [sys.executable, "-c", REGISTERED]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(tmp_path), os.environ.get("PYTHONPATH", "")))}
    ended = subprocess.run(
        [*program, "check", GOOD, BAD, "--csv", "-"], env=environment, capture_output=True, text=True, check=False
    )
    assert (ended.returncode, ended.stderr) == (1, "")
    assert ended.stdout == f"{GOOD},conforms\n{BAD},violates\n"
    said = subprocess.run([*program, "conform", "--help"], env=environment, capture_output=True, text=True, check=True)
    assert "Write a line for each file." in said.stdout


def test_defaults_stand_in_pyproject(
    command_line: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An option in the table of the folder, or of one above it, is taken; the command line counts more."""
    (tmp_path / "pyproject.toml").write_text(
        '[tool.missionfsm]\nreading = ["AM-53.CreateMission=a"]\n[tool.missionfsm.check]\njson = "verdict.json"\n'
    )
    (tmp_path / "logs").mkdir()
    monkeypatch.chdir(tmp_path / "logs")
    command_line("check", GOOD)
    verdict = json.loads((tmp_path / "logs" / "verdict.json").read_text())
    assert verdict["system"] == "bear.mission"
    command_line("check", GOOD, "--json", "other.json")
    assert (tmp_path / "logs" / "other.json").exists()


@pytest.mark.parametrize(
    ("table", "says"),
    [
        ("sede = 1", "[tool.missionfsm] has 'sede', which is no command and no option"),
        ("[tool.missionfsm.check]\nsede = 1", "[tool.missionfsm.check] has 'sede', which is no option of it"),
        ("seed =", "pyproject.toml"),
    ],
)
def test_a_wrong_default_is_bad_input(
    command_line: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, table: str, says: str
) -> None:
    """A key that is no option, and a file that is no TOML, is one line and exit status 2."""
    (tmp_path / "pyproject.toml").write_text(f"[tool.missionfsm]\n{table}\n")
    monkeypatch.chdir(tmp_path)
    ended = command_line("check", GOOD)
    assert (ended.status, says in ended.err, ended.err.count("\n")) == (2, True, 1)


def test_help_lists_the_systems_and_examples(command_line: CommandLine) -> None:
    """--help says which systems there are and what each is, and shows commands to copy."""
    shown = command_line("--help").out
    told = re.findall(r"^  (\S+) +(.*)$", shown.partition("Systems:\n")[2].partition("\n\n")[0], re.MULTILINE)
    assert told == [(name, system(name).spec.title) for name in names()]
    assert shown.partition("Examples:\n")[2].split("\n")[:-1] == [f"  {one}" for one in EXAMPLES["missionfsm"]]


def test_every_command_has_examples_whose_options_exist() -> None:
    """Each command shows at least one example; its words are the command, options of it, or their values."""
    group = typer.main.get_group(app)
    assert EXAMPLES.keys() == {"missionfsm", *group.commands}
    for name, examples in EXAMPLES.items():
        for one in examples:
            program, command, *words = shlex.split(one)
            assert (program, name in ("missionfsm", command)) == ("missionfsm", True)
            known = {option for parameter in group.commands[command].params for option in parameter.opts}
            own = words[: words.index("--")] if "--" in words else words
            shell = own[: own.index(">")] if ">" in own else own
            assert {word for word in shell if word.startswith("-")} <= known, one


def test_the_example_of_teeth_breaks_something(command_line: CommandLine) -> None:
    """What the example picks is there, and noticed."""
    [example] = EXAMPLES["teeth"]
    ended = command_line(*shlex.split(example)[1:])
    assert (ended.status, re.match(r"isaac\.robot: [1-9]\d* of", ended.out) is not None) == (0, True), ended.err


def test_names_of_systems_are_completed() -> None:
    """A shell is told the systems whose names begin as what was typed."""
    assert completed("isaac.") == ["isaac.server", "isaac.robot"]
    assert completed("") == list(names())


BARE = '{"metadata": {"sequenceNumber": "1"}, "batteryState": {"chargePercent": 50}}\n'


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("conform", "bear.mission", "--tolerance", "1"), "--tolerance: it has no effect without --tcp"),
        (("conform", "isaac.server", "--tcp", "h:1", "--distinguish"), "--distinguish: it has no effect over TCP"),
        (("check", "bare", "--others"), "bare: --others has no effect on bare messages"),
        (("check", "bare", "--settled-after", "2"), "bare: --settled-after has no effect on bare messages"),
        (
            ("explore", "isaac.robot", "--forget-ended", "--html", "page"),
            "--forget-ended: it has no effect on the page of --html",
        ),
        (("diagram", "bear.mission/mission", "--refusals"), "--refusals: it has no effect on bear.mission/mission"),
        (
            ("diagram", "bear.mission/mission", "--reading", "AM-09=b"),
            "--reading: it has no effect on bear.mission/mission",
        ),
        (
            ("diagram", "isaac.robot/reports", "--format", "table", "--refusals"),
            "--refusals: it has no effect on table",
        ),
        (("serve", "bear.mission", "--grpc", "0", "--seed", "4"), "--seed: it has no effect without --fault or --auto"),
        (("dispatch", "bare", "--resume", "fail"), "--resume: it has no effect without --journal"),
        (
            ("robot", "--name", "r", "--script", "fail", "--behavior", "succeed"),
            "--behavior: it has no effect with --script",
        ),
        (
            ("robot", "--name", "r", "--script", "fail:1,hang", "--duration", "2"),
            "--duration: it has no effect where every step of --script has seconds",
        ),
        (
            ("robot", "--name", "r", "--behavior", "hang", "--duration", "2"),
            "--duration: it has no effect with --behavior hang",
        ),
    ],
)
def test_options_without_effect_are_refused(
    command_line: CommandLine,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: tuple[str, ...],
    says: str,
) -> None:
    """An option that changes nothing where it is given is bad usage, in one line."""
    (tmp_path / "bare").write_text(BARE)
    monkeypatch.chdir(tmp_path)
    ended = command_line(*arguments)
    assert (ended.status, ended.err.startswith(f"missionfsm: {says}"), ended.err.count("\n")) == (2, True, 1)
