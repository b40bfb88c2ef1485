"""The lift: its states are as they should be, and the oracle that is made from it tells right from wrong."""

import json
import sys
from pathlib import Path

import pytest
from lift.spec import NAME
from lift.system import SYSTEM

from missionfsm import check, conform, explore

HERE = Path(__file__).parent.parent
BUGS = {
    "fifth-floor": ["Call/INVALID_ARGUMENT/there-is-no-such-floor"],
    "one-more": ["Call/RESOURCE_EXHAUSTED/enough-rides-wait"],
    "stays": ["Watch/rides-are-shown-in-order"],
    "name-again": ["Call/a-ride-is-queued"],
    "newest-first": ["Watch/rides-are-shown-in-order", "Cancel/FAILED_PRECONDITION/the-ride-is-under-way"],
    "cancels-the-first": ["Watch/rides-are-shown-in-order"],
    "quiet": ["Watch/rides-are-shown-in-order"],
    "now-so-now-so": ["Call/a-ride-is-shared"],
    "forgets": ["Watch/rides-are-shown-in-order"],
}


def test_every_state_is_as_it_should_be():
    """Every state with up to four rides has an answer to every call, and keeps every invariant."""
    assert explore(SYSTEM, size=4).holds


def test_the_reference_conforms():
    """What is computed from the specification is what the specification allows."""
    assert conform(SYSTEM, examples=40, seed=1).conforms


def test_the_building_conforms():
    """The building makes a second ride to a floor, and refuses to give up the one under way: both are readings."""
    verdict = conform(SYSTEM, [sys.executable, str(HERE / "building.py")], examples=40, seed=1)
    assert verdict.conforms, str(verdict)


@pytest.mark.parametrize("bug", BUGS)
def test_a_bug_is_found(bug):
    """Every bug is found, and a rule that it breaks is named."""
    command = [sys.executable, str(HERE / "building.py"), "--bug", bug]
    verdict = conform(SYSTEM, command, examples=80, seed=1)
    assert verdict.violation is not None, str(verdict)
    assert {rule.id for rule in verdict.violation.rules} & {f"{NAME}/{rule}" for rule in BUGS[bug]}


@pytest.mark.parametrize(("log", "right"), [("two-clients", True), ("overtaken", False)])
def test_a_log_of_two_clients_is_judged(log, right):
    """Overlapping calls may take effect in either order, and a lost one at any time; a ride overtakes none."""
    lines = [json.loads(line) for line in (HERE / "logs" / f"{log}.jsonl").read_text().splitlines()]
    assert check(lines).conforms == right
