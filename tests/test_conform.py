"""The oracle against a second implementation, in another language: it conforms; faults put into it are found."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from missionfsm.adapters.stdio import Child
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.plan import Plan

NODE = shutil.which("node")
SUBJECT = Path(__file__).parent / "subjects" / "bear_mission.mjs"
MISSION = system("bear.mission")

pytestmark = [
    pytest.mark.skipif(NODE is None, reason="the subject is written for Node.js, which is not installed"),
    pytest.mark.slow,
]

# Faults of every operation, of the order of missions, of their goals, of what subscribers are told.
BREAKS = (
    "create-while-running",
    "create-refused-when-finished",
    "create-busy-invalid-argument",
    "create-malformed-failed-precondition",
    "create-refused-but-listed",
    "create-answers-other-id",
    "mission-id-constant",
    "batch-while-running",
    "batch-empty-accepted",
    "batch-keeps-valid-prefix",
    "batch-reversed",
    "batch-loses-last",
    "workflow-empty-accepted",
    "append-to-empty-accepted",
    "append-refused-while-running",
    "append-starts-at-once",
    "append-preempts",
    "charge-not-listed",
    "clear-while-running",
    "clear-refused-when-finished",
    "clear-omits-id",
    "clear-removes-nothing",
    "skip-on-idle-accepted",
    "skip-refused-while-running",
    "skip-ignored",
    "update-unknown-command-pauses",
    "update-unknown-id-accepted",
    "queue-never-advances",
    "pause-ignored",
    "finish-reported-failed",
    "failure-reported-succeeded",
    "goals-end-after-first",
    "goals-start-over",
    "first-message-missing",
    "updates-missing",
    "update-one-behind",
    "sequence-decreasing",
    "current-index-too-high",
    "list-reversed",
    "list-omits-queued",
    "goals-reversed",
    "goal-index-stuck",
    "goal-index-carried-over",
    "patrol-of-workflow-ends-after-lap",
    "patrol-of-batch-ends-after-lap",
)
COMMON = ("batch-keeps-valid-prefix", "updates-missing")
"""An answer that is wrong and a message that is; the others are tried in the long tests."""
LONGEST = 22
"""Lines of the longest history that is needed to show one of them, the first line included."""


def judge(*options: str, plan: Plan = Plan(30, steps=30)) -> Verdict:  # noqa: B008 - a value
    child = Child([str(NODE), str(SUBJECT), *options])
    try:
        return conform(MISSION, child, plan=plan, seed=1, advice=False)
    finally:
        child.close()


@pytest.mark.parametrize(
    "plan", [Plan(4, 3, 30, 20, 10), pytest.param(Plan(10, 6, 60, 30, 40), marks=pytest.mark.long)], ids=["few", "more"]
)
def test_the_subject_conforms(plan: Plan) -> None:
    """A second implementation, written from the pages alone, conforms."""
    verdict = judge(plan=plan)
    assert verdict.conforms, str(verdict)


@pytest.mark.parametrize("name", COMMON)
def test_a_common_fault_is_found(name: str) -> None:
    """A fault is found, with a short history that shows it, and the rule that its last answer or message breaks."""
    found(name)


@pytest.mark.long
@pytest.mark.parametrize("name", [one for one in BREAKS if one not in COMMON])
def test_a_fault_is_found(name: str) -> None:
    """So it is with each of the others."""
    found(name)


def found(name: str) -> None:
    verdict = judge("--break", name)
    assert verdict.outcome.value == "violates", str(verdict)
    assert verdict.violation is not None
    if "drive" not in verdict.violation.history[-1]:  # what happened although it cannot breaks no single rule
        assert verdict.violation.rules, str(verdict)
    assert len(verdict.violation.history) <= LONGEST, str(verdict)
