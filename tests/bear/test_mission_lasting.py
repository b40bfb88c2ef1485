"""What a mission is stays as it is while it is listed, also where the page leaves open what it is."""

from __future__ import annotations

import pytest

from missionfsm.kernel.codec import JSON
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.verdict import Outcome, Verdict

MISSION = system("bear.mission")
TABLE = {"destinationId": "table-1"}


def shown(number: int, **mission: JSON) -> JSON:
    """A status message with one mission."""
    first = {"missionId": "A", "state": "STATE_RUNNING", "currentGoalIndex": 0, "owner": "api", **mission}
    states = {"missions": [first], "currentMissionIndex": 0 if first["state"] == "STATE_RUNNING" else -1}
    metadata = {"timestamp": "2025-01-01T00:00:00Z", "sequenceNumber": number}
    return {"stream": 1, "message": {"metadata": metadata, "missionStates": states}}


def charged(*messages: JSON) -> Verdict:
    """The verdict of a charge that is shown so, and succeeds."""
    lines = [
        {"call": 1, "method": "ChargeRobot", "params": {}},
        {"return": 1, "result": {"missionId": "A"}},
        {"call": 2, "method": "SubscribeMissionStatus", "params": {}},
        {"return": 2, "result": {"stream": 1}},
        messages[0],
        {"drive": {"event": "missionSucceeded"}},
        *messages[1:],
    ]
    drives = ["missionSucceeded", "missionFailed", "goalReached"]
    return check(MISSION, head({"missionfsm": 1, "system": "bear.mission", "world": {}, "drives": drives}), lines)


@pytest.mark.parametrize(
    ("before", "after", "rule"),
    [
        ({"goals": [TABLE]}, {"goals": []}, "the-goals-are-those-requested"),
        ({"goals": [TABLE]}, {"goals": [{"destinationId": "table-2"}]}, "the-goals-are-those-requested"),
        (
            {"missionType": {"baseType": "BASE_TYPE_NAVIGATE"}},
            {"missionType": {"serviType": "SERVI_TYPE_SERVING"}},
            "the-type-is-that-requested",
        ),
        ({"missionType": {"baseType": "BASE_TYPE_NAVIGATE"}}, {}, "the-type-is-that-requested"),
    ],
)
def test_a_charge_keeps_what_it_was_shown_to_be(before: JSON, after: JSON, rule: str) -> None:
    """Nothing is said of a charge's goals and type, but that they belong to the mission: they do not change."""
    ended = {"state": "STATE_SUCCEEDED"}
    assert charged(shown(1, **before), shown(2, **before, **ended)).outcome is Outcome.CONFORMS
    violation = charged(shown(1, **before), shown(2, **after, **ended)).violation
    assert violation
    assert [one.id for one in violation.rules] == [f"bear.mission/SubscribeMissionStatus/{rule}"]


def test_an_absent_type_is_an_unknown_one() -> None:
    """A member that is left out has its default, so that nothing changes with it."""
    verdict = charged(shown(1), shown(2, missionType={"baseType": 0}, state="STATE_SUCCEEDED"))
    assert verdict.outcome is Outcome.CONFORMS


@pytest.mark.parametrize("other", ["touchscreen", "", "API"])
def test_an_owner_that_changes_is_flagged(other: str) -> None:
    """AM-52: owners are free texts, and nothing on the page changes the one of a mission."""
    ended = {"state": "STATE_SUCCEEDED"}
    kept = charged(shown(1, owner=other), shown(2, owner=other, **ended))
    changed = charged(shown(1), shown(2, owner=other, **ended))
    assert (kept.outcome, kept.flagged) == (Outcome.CONFORMS, ())
    assert (changed.outcome, len(changed.flagged)) == (Outcome.CONFORMS, 1)
    assert "AM-52.change=b" in str(changed)
