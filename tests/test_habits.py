"""What people expect of any command line: -h, --version, defaults in pyproject.toml, JUnit."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from commandline import CommandLine

import missionfsm

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
