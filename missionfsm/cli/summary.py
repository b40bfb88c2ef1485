"""What many verdicts come to, as a table that fits on a screen."""

from __future__ import annotations

import io
import os
import time
from collections.abc import Iterable, Sequence

from missionfsm.cli.common import say_shown
from missionfsm.kernel.text import clipped
from missionfsm.tools.check.summary import Tally, summed_up
from missionfsm.tools.check.verdict import Outcome, Verdict

MAX_ROWS = {"broken": 5, "flagged": 3, "inconclusive": 2}
"""How many are listed of each; with their titles, and a line that says how many more, all are 20 lines."""
WIDEST = 10_000
"""Columns that a line may have: a terminal folds it, and whoever reads a pipe finds each in one line."""


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
        for title, rows in (
            ("broken", found.broken),
            ("flagged", found.flagged),
            ("inconclusive", found.undecided),
        ):
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


def _table(title: str, rows: Sequence[Tally]) -> list[str]:
    """What was found, a line each, however wide a line is."""
    from rich.console import Console  # noqa: PLC0415 - seldom is anything found
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    table = Table(box=None, pad_edge=False)
    table.add_column(title, no_wrap=True)
    table.add_column("times", justify="right")
    table.add_column("first", no_wrap=True)
    most = MAX_ROWS[title]
    for one in rows[:most]:
        table.add_row(*(Text(clipped(cell)) for cell in (one.what, f"{one.times:,}", one.first)))
    console = Console(file=io.StringIO(), width=WIDEST, color_system=None)
    console.print(table)
    drawn = [line.rstrip() for line in console.file.getvalue().splitlines()]  # type: ignore[attr-defined]
    return drawn if len(rows) <= most else [*drawn, f"and {len(rows) - most:,} more"]


__all__ = ["Told"]
