"""Verdicts as a table in a file of Parquet: a row for each file and robot, for whoever asks of a whole fleet's year."""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping
from typing import Any

from missionfsm.reports.report import Finding, Report

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


def written(report: Report) -> bytes:
    """The table."""
    import pyarrow as pa  # noqa: PLC0415 - an extra
    from pyarrow import parquet  # noqa: PLC0415 - as above

    kinds: dict[type | None, Any] = {
        str: pa.string(),
        int: pa.int64(),
        float: pa.float64(),
        None: pa.list_(pa.string()),
    }
    schema = pa.schema([(name, kinds[kind]) for name, kind in COLUMNS.items()])
    file = io.BytesIO()
    parquet.write_table(pa.table(_columns(report.findings), schema=schema), file)
    return file.getvalue()


def _columns(findings: Iterable[Finding]) -> dict[str, list[Cell]]:
    """The columns of the table.

    Where there is nothing to say a cell is None: the robot of a file that names none, the rule, the line and the event
    of what conforms. Of several rules that are broken the first is told. `flagged` has a line for each reading that
    departs from the text, and for whatever else was odd. `seconds` are those that the whole file took.
    """
    found: dict[str, list[Cell]] = {name: [] for name in COLUMNS}
    for one in findings:
        verdict, violation = one.verdict, one.verdict.violation
        row: dict[str, Cell] = {
            "file": one.file,
            "robot": one.robot,
            "system": verdict.system,
            "verdict": verdict.outcome.value,
            "rule": violation.rules[0].id if violation and violation.rules else None,
            "line": violation.line if violation else None,
            "observed": violation.observed if violation else None,
            "because": verdict.because or None,
            "events": verdict.events,
            "seconds": one.seconds,
            "flagged": list(verdict.flagged),
        }
        for name, cell in row.items():
            found[name].append(cell)
    return found


__all__ = ["COLUMNS", "written"]
