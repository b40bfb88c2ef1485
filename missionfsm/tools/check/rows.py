"""Many verdicts as a table: a row for each file and robot, for whoever asks questions of a whole fleet's year."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from missionfsm.tools.check.verdict import Verdict

Cell = str | int | float | list[str] | None

COLUMNS: Mapping[str, type | None] = {
    "file": str,
    "robot": str,
    "system": str,
    "verdict": str,
    "rule": str,
    "line": int,
    "observed": str,
    "because": str,
    "events": int,
    "seconds": float,
    "flagged": None,
}
"""The columns in their order, with the type of what is in them; None for a list of texts."""


def rows(judged: Iterable[tuple[str, str | None, Verdict, float]]) -> dict[str, list[Cell]]:
    """The columns of the table.

    Where there is nothing to say a cell is None: the robot of a file that names none, the rule, the line and the event
    of what conforms. Of several rules that are broken the first is told. `flagged` has a line for each reading that
    departs from the text, and for whatever else was odd.

    Args:
        judged: file, robot, verdict, and the seconds that the file took to judge, all its robots together.
    """
    found: dict[str, list[Cell]] = {name: [] for name in COLUMNS}
    for path, robot, verdict, seconds in judged:
        violation = verdict.violation
        row: dict[str, Cell] = {
            "file": path,
            "robot": robot,
            "system": verdict.system,
            "verdict": verdict.outcome.value,
            "rule": violation.rules[0].id if violation and violation.rules else None,
            "line": violation.line if violation else None,
            "observed": violation.observed if violation else None,
            "because": verdict.because or None,
            "events": verdict.events,
            "seconds": seconds,
            "flagged": list(verdict.flagged),
        }
        for name, cell in row.items():
            found[name].append(cell)
    return found


__all__ = ["COLUMNS", "Cell", "rows"]
