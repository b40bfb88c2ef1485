"""Recordings in which calls are lost, time out or overlap are decided, from a file and from a pipe alike."""

from __future__ import annotations

import pytest
from recordings import Line, late_appends, lost_appends, lost_mixture, overlapping_appends

from missionfsm.kernel.codec import JSON
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.verdict import Outcome

RECORDINGS: dict[str, tuple[list[Line], Line | None]] = {
    "lost appends": (lost_appends(40, 20), None),
    "many lost appends": (lost_appends(100, 50), None),
    "lost appends that never happened": (lost_appends(300, 0), None),
    "a mission among the lost that nobody asked for": (lost_appends(40, 20, bad=True), {"stream": 1}),
    "appends that timed out": (late_appends(150, 0), None),
    "appends that timed out and happened": (late_appends(40, 20), None),
    "appends that timed out, and one that was none": (late_appends(40, 20, bad=True), {"stream": 1}),
    "appends that overlap": (overlapping_appends(11), None),
    "appends that overlap, two shown the wrong way round": (overlapping_appends(8, bad=True), {"stream": 1}),
    "lost calls of several kinds": (lost_mixture(10), None),
}


def judged(lines: list[Line], *, piped: bool) -> tuple[Outcome, int | None]:
    """What is said of a recording and, if it is wrong, of which line; whoever reads a pipe cannot look ahead."""
    found = system("bear.mission")
    calls = {line["call"] for line in lines if "call" in line} - {line["return"] for line in lines if "return" in line}
    verdict = check(found, head(lines[0]), lines[1:], lost=frozenset() if piped else frozenset(calls))
    return verdict.outcome, verdict.violation.at if verdict.violation else None


def where(lines: list[Line], wrong: JSON) -> int | None:
    """The last line of a kind."""
    kinds = [number for number, line in enumerate(lines, 1) if wrong and wrong.items() <= line.items()]
    return kinds[-1] if kinds else None


@pytest.mark.parametrize("piped", [False, True], ids=["file", "pipe"])
@pytest.mark.parametrize("name", RECORDINGS)
def test_what_is_lost_late_or_overlaps_is_decided(name: str, *, piped: bool) -> None:
    """Which calls took effect is read off what comes later; what nothing explains is found where it stands."""
    lines, wrong = RECORDINGS[name]
    outcome = Outcome.VIOLATES if wrong else Outcome.CONFORMS
    assert judged(lines, piped=piped) == (outcome, where(lines, wrong))


@pytest.mark.parametrize("piped", [False, True], ids=["file", "pipe"])
@pytest.mark.parametrize("name", [name for name, (_, wrong) in RECORDINGS.items() if not wrong])
def test_what_is_cut_off_conforms(name: str, *, piped: bool) -> None:
    """Where the snapshot that would show it is missing, anything may have happened."""
    lines, _ = RECORDINGS[name]
    assert judged(lines[:-2], piped=piped) == (Outcome.CONFORMS, None)
