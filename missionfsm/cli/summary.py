"""What many verdicts come to, as a table that fits on a screen."""

from __future__ import annotations

import io
import os
import shutil
import sys
import time
from collections.abc import Iterable, Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from missionfsm.cli.common import say_shown
from missionfsm.kernel.text import shown
from missionfsm.tools.check.summary import Found, summed_up
from missionfsm.tools.check.verdict import Outcome, Verdict

MAX_ROWS = 8
"""Rules and readings that are listed, each."""
PIPE_COLUMNS = 120
"""How wide a table is where nobody says how wide it may be."""


class Told:
    """Tells at the end what verdicts come to, and how long it took from now.

    Args:
        json: where JSON goes; where that is stdout, nothing is told.
    """

    def __init__(self, json: str | None) -> None:
        self._json = json
        self._begun = time.monotonic()

    def say(self, verdicts: Iterable[tuple[str, str | None, Verdict]]) -> None:
        """Tell it. Raises UnreadableError if stdout cannot be written to."""
        judged = list(verdicts)
        above = _folder([path for path, _, _ in judged])
        found = summed_up((path.removeprefix(above), robot, verdict) for path, robot, verdict in judged)
        counted = ", ".join(f"{found.outcomes.get(one, 0):,} {one.value}" for one in Outcome)
        flagged = sum(bool(verdict.flagged) for _, _, verdict in judged)
        seconds = time.monotonic() - self._begun
        lines = [
            f"{len(judged):,} judged: {counted}; {flagged:,} flagged",
            f"{found.events:,} events in {seconds:.1f} s",
        ]
        for title, rows in (("broken", found.broken), ("flagged", found.flagged)):
            if rows:
                lines += ["", *_table(title, rows)]
        say_shown("\n".join(lines), json=self._json)


def _folder(paths: Sequence[str]) -> str:
    """The folder that all files are in, as their names begin; "" if there is none."""
    folders = {os.path.dirname(path) for path in paths}  # noqa: PTH120 - it may be a folder of a file that is gone
    above = (
        os.path.commonpath(folders)
        if folders and "" not in folders and len({one[:1] == "/" for one in folders}) == 1
        else ""
    )
    return f"{above}/" if above else ""


def _table(title: str, rows: Sequence[Found]) -> list[str]:
    table = Table(box=None, pad_edge=False)
    table.add_column(title, no_wrap=True)
    table.add_column("times", justify="right")
    table.add_column("first", overflow="fold")
    for one in rows[:MAX_ROWS]:
        table.add_row(*(Text(shown(cell)) for cell in (one.what, f"{one.times:,}", one.first)))
    columns = shutil.get_terminal_size().columns if sys.stdout is not None and sys.stdout.isatty() else PIPE_COLUMNS
    console = Console(file=io.StringIO(), width=columns, color_system=None)
    console.print(table)
    drawn = [line.rstrip() for line in console.file.getvalue().splitlines()]  # type: ignore[attr-defined]
    return drawn if len(rows) <= MAX_ROWS else [*drawn, f"and {len(rows) - MAX_ROWS:,} more"]


__all__ = ["Told"]
