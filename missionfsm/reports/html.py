"""Verdicts as one page for a browser; what makes it is in `missionfsm.pages`."""

from __future__ import annotations

from missionfsm.pages.report import LabelledVerdict, report
from missionfsm.reports.report import Report
from missionfsm.systems import system


def written(found: Report) -> bytes:
    """The page."""
    judged = [LabelledVerdict(one.verdict, one.file, one.robot or "") for one in found.findings]
    # What an implementation sent may hold halves of surrogate pairs, which no encoding has.
    return report(judged, system, str(found.made)).encode("utf-8", "xmlcharrefreplace")
