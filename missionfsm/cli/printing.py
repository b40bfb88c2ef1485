"""How verdicts look on a terminal, and how what is written says when, by what and by which command it was made."""

from __future__ import annotations

import datetime as dt
import os
import re
import shlex
import shutil
import sys
import textwrap
from typing import Annotated, Protocol

import typer

from missionfsm.adapters.outputs import STDOUT, to_stdout
from missionfsm.cli.common import Troubles, readable, say, say_shown, write_json
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.text import clipped
from missionfsm.reports.report import Made

JsonFile = Annotated[str | None, typer.Option("--json", metavar="FILE", help="Write the verdict as JSON; - is stdout.")]
HANG = 4
"""By how many columns the rest of a folded line is indented."""
_WORST_FIRST = (
    (re.compile(r"(?:^|:\s+)(violates)\b"), "bold red"),
    (
        re.compile(r"(?:^|:\s+)(inconclusive|conforms(?:\s+in\s+part(?:,\s+flagged)?|,\s+flagged))\b"),
        "bold yellow",
    ),
    (re.compile(r"(?:^|:\s+)(conforms)\b"), "bold green"),
)
_TITLE = re.compile(r"^ *(?:readings still open|readings followed|flagged|allowed here|against|calls|readings|drives):")
_RULE = re.compile(r"\b[a-z]+\.[a-z]+/[\w/-]+")


def made() -> Made:
    """Now, by this program."""
    from missionfsm import __version__  # noqa: PLC0415 - seldom asked for

    now = dt.datetime.now(dt.UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return Made(__version__, now, readable(shlex.join(["missionfsm", *sys.argv[1:]])))


def stamped(value: JSON) -> JSON:
    """A value that also says how it was made."""
    return {**value, "made": made().to_json()}


def say_verdict(text: str, *, json: str | None) -> None:
    """Print a verdict: on a terminal in colour and no wider than it is, elsewhere as it stands.

    Raises UnreadableError if stdout cannot be written to.
    """
    if json == STDOUT or sys.stdout is None or not sys.stdout.isatty():
        say_shown(text, json=json)
        return
    from rich.console import Console  # noqa: PLC0415 - commands load what they need
    from rich.text import Text  # noqa: PLC0415

    with to_stdout():
        console = Console(file=sys.stdout, highlight=False, soft_wrap=True)
        columns = shutil.get_terminal_size().columns
        for number, line in enumerate(map(clipped, text.split("\n"))):
            folded = Text("\n".join(wrapped(line, columns)))
            if not number:
                for pattern, style in _WORST_FIRST:
                    if found := pattern.search(folded.plain):
                        folded.stylize(style, *found.span(1))
                        break
            elif found := _TITLE.match(folded.plain):
                folded.stylize("bold", *found.span())
            folded.highlight_regex(_RULE, "dim")
            console.print(folded)


def wrapped(line: str, columns: int) -> list[str]:
    """A line in as many as it takes; what follows the first goes in."""
    indent = len(line) - len(line.lstrip())
    if len(line) <= columns or columns <= indent + 2 * HANG:
        return [line]
    return textwrap.wrap(line, columns, subsequent_indent=" " * (indent + HANG), break_on_hyphens=False)


def in_github(wanted: bool | None) -> bool:
    """Whether annotations for GitHub are written: as the option says, by default in a workflow."""
    return os.environ.get("GITHUB_ACTIONS") == "true" if wanted is None else wanted


def say_annotations(lines: list[str], *, json: str | None) -> None:
    """Print workflow commands, each on a line that is not shortened; to stderr where JSON takes stdout.

    GitHub reads both. Raises UnreadableError if stdout cannot be written to.
    """
    for line in lines:
        if json == STDOUT and sys.stderr is not None:
            print(line, file=sys.stderr, flush=True)  # noqa: T201 - the command line speaks
        else:
            say(line)


class Result(Protocol):
    """What a command has found: a text for people, and JSON."""

    def to_json(self) -> JSON:
        """The result as JSON."""


def print_result(found: Result, json: str | None) -> Troubles:
    """Print a result and write it as JSON. Troubles with either are returned."""
    troubles = Troubles()
    with troubles.kept():
        say_verdict(str(found), json=json)
    with troubles.kept():
        write_json(json, stamped(found.to_json()))
    return troubles
