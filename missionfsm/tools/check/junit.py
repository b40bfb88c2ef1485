"""Verdicts as JUnit XML, which build servers show as tests: a test case for each verdict."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, tostring

from missionfsm.kernel.text import printable, printable_lines
from missionfsm.tools.check.verdict import Outcome, Verdict


def junit(verdicts: Iterable[tuple[str, Verdict]]) -> bytes:
    """The XML of named verdicts. One that violates is a failure, one that is inconclusive an error."""
    judged = list(verdicts)
    outcomes = [verdict.outcome for _, verdict in judged]
    suite = Element(
        "testsuite",
        name="missionfsm",
        tests=str(len(judged)),
        failures=str(outcomes.count(Outcome.VIOLATES)),
        errors=str(outcomes.count(Outcome.INCONCLUSIVE)),
    )
    for name, verdict in judged:
        case = SubElement(suite, "testcase", classname=verdict.system, name=printable(name))
        text = printable_lines(str(verdict))
        headline = text.partition("\n")[0]
        if verdict.conforms:
            SubElement(case, "system-out").text = text
        else:
            kind = "failure" if verdict.outcome is Outcome.VIOLATES else "error"
            SubElement(case, kind, message=headline).text = text
    return bytes(tostring(suite, encoding="utf-8", xml_declaration=True)) + b"\n"
