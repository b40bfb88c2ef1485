"""Verdicts as JSON: one verdict as an object, several as a list."""

from __future__ import annotations

import orjson

from missionfsm.kernel.codec import JSON
from missionfsm.reports.report import Finding, Report


def written(report: Report) -> bytes:
    """The JSON, which says of each verdict how it was made."""
    more: JSON = {"stale": list(report.stale)} if report.stale else {}
    stamp: JSON = {"made": report.made.to_json()}
    verdicts = [{**_place(one), **one.verdict.to_json(), **more, **stamp} for one in report.findings]
    value = verdicts[0] if len(verdicts) == 1 and not report.several else verdicts
    return orjson.dumps(value, option=orjson.OPT_INDENT_2) + b"\n"


def _place(finding: Finding) -> JSON:
    """The file and the robot, where a file was read."""
    return {"file": finding.file, "robot": finding.robot} if finding.file else {}
