"""The README says what is true: its code runs, its commands exist."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from missionfsm.cli import app
from missionfsm.systems import names

README = (Path(__file__).parent.parent / "README.md").read_text()
SNIPPETS = re.findall(r"<!-- run -->\n```python\n(.*?)```", README, re.DOTALL)


def test_the_readme_has_code_to_run() -> None:
    """There is a snippet, of at most a dozen lines, so that the test below tests something."""
    assert [snippet.count("\n") <= 12 for snippet in SNIPPETS] == [True]


@pytest.mark.parametrize("snippet", SNIPPETS)
def test_a_snippet_runs_as_it_stands(snippet: str) -> None:
    """What a reader copies works."""
    exec(compile(snippet, "README.md", "exec"), {})  # noqa: S102 - the README's own code


SHELL = re.findall(r"<!-- console -->\n```console\n(.*?)```", README, re.DOTALL)
SUITE = re.findall(r"<!-- suite -->\n```python\n(.*?)```", README, re.DOTALL)
CHANGES = re.compile(r"[0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12}|\d+ events in \d+ examples")
"""What is told of a run and is not the same in each: an id that the robot chose, how far a run came."""


@pytest.fixture
def reader(tmp_path: Path) -> Path:
    """Where a reader is who has just cloned the project."""
    if shutil.which("node") is None:
        pytest.skip("Node.js is not installed")
    (tmp_path / "tests").symlink_to(Path(__file__).parent)
    return tmp_path


def test_the_shown_commands_say_what_is_shown(reader: Path) -> None:
    """Every command of the console blocks, one after the other, says first what stands below it, in all that lasts."""
    tools = {**os.environ, "PATH": os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))}
    told = [part.partition("\n") for block in SHELL for part in block.split("$ ")[1:]]
    assert len(told) == 3
    for command, _, shown in told:
        ran = subprocess.run(
            ["sh", "-c", command], cwd=reader, env=tools, capture_output=True, text=True, check=False, timeout=120
        )
        assert ran.returncode == 1, ran.stderr
        assert CHANGES.sub("…", ran.stdout).startswith(CHANGES.sub("…", shown)), ran.stdout


def test_the_suite_is_a_suite(reader: Path) -> None:
    """The five lines are a test file that passes on our own implementation in another language."""
    (source,) = SUITE
    (reader / "test_it.py").write_text(source)
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--missionfsm-examples=5", "test_it.py"],
        cwd=reader,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert (ran.returncode, " passed" in ran.stdout) == (0, True), ran.stdout


def test_every_command_in_the_table_exists() -> None:
    """The table names the commands that there are, and all of them."""
    rows = re.findall(r"^\| ((?:`[a-z]+[^`]*`(?:, )?)+) \|", README, re.MULTILINE)
    written = {word for row in rows for word in re.findall(r"`([a-z]+)(?: |`)", row)}
    known = {command.name or command.callback.__name__ for command in app.registered_commands if command.callback}
    assert written & known == known


def test_every_system_is_listed() -> None:
    """The table of systems has each that the command line knows."""
    assert [name for name in names() if f"| `{name}` |" not in README] == []


def test_help_names_every_command() -> None:
    """``missionfsm --help`` works and lists the commands."""
    shown = CliRunner().invoke(app, ["--help"])
    assert (shown.exit_code, "conform" in shown.output, "check" in shown.output) == (0, True, True)
