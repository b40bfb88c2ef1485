"""Verdicts as JUnit XML, which build servers show as tests: a test case for each verdict."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement, tostring

from missionfsm.kernel.text import printable, printable_lines
from missionfsm.reports.report import Finding, Report
from missionfsm.tools.check.verdict import Outcome


def written(report: Report) -> bytes:
    """The XML. A verdict that violates is a failure, one that is inconclusive an error."""
    outcomes = [one.verdict.outcome for one in report.findings]
    suite = Element(
        "testsuite",
        name="missionfsm",
        tests=str(len(outcomes)),
        failures=str(outcomes.count(Outcome.VIOLATES)),
        errors=str(outcomes.count(Outcome.INCONCLUSIVE)),
    )
    for one in report.findings:
        verdict = one.verdict
        case = SubElement(suite, "testcase", classname=verdict.system, name=printable(_name(one)))
        text = printable_lines(str(verdict))
        headline = text.partition("\n")[0]
        if verdict.conforms:
            SubElement(case, "system-out").text = text
        else:
            kind = "failure" if verdict.outcome is Outcome.VIOLATES else "error"
            SubElement(case, kind, message=headline).text = text
    return bytes(tostring(suite, encoding="utf-8", xml_declaration=True)) + b"\n"


def _name(finding: Finding) -> str:
    return f"{finding.file} {finding.robot}" if finding.robot else finding.file or finding.subject
