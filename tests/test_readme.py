"""The README says what is true: its code runs, its commands exist."""

from __future__ import annotations

import re
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
