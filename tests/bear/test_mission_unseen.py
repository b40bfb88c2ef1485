"""What a subscriber of missions cannot tell from what it was shown is not owed to it."""

from __future__ import annotations

import pytest

from missionfsm.kernel.codec import JSON
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.verdict import Outcome

MISSION = system("bear.mission")
GOAL = {"goal": {"destinationId": "table-1"}}
DRIVES = ["goalReached", "missionSucceeded", "missionFailed", "world", "fault"]


def shown(number: int, *states: str) -> JSON:
    """A status message with missions in these states, the last of them active unless it has ended."""
    missions = [
        {
            "missionId": f"mission-{place}",
            "state": f"STATE_{state}",
            "goals": [{"destinationId": "table-1"}],
            "currentGoalIndex": 0,
            "missionType": {"baseType": "BASE_TYPE_NAVIGATE"},
            "owner": "api",
        }
        for place, state in enumerate(states, 1)
    ]
    index = len(states) - 1 if states and states[-1] == "RUNNING" else -1
    metadata = {"timestamp": "2025-01-01T00:00:00Z", "sequenceNumber": number}
    return {
        "stream": 1,
        "message": {"metadata": metadata, "missionStates": {"missions": missions, "currentMissionIndex": index}},
    }


SUBSCRIBED = (
    {"call": 1, "method": "SubscribeMissionStatus", "params": {}},
    {"return": 1, "result": {"stream": 1}},
    shown(0),
)
CREATED = (
    {"call": 2, "method": "CreateMission", "params": {"mission": {"baseMission": {"navigateMission": GOAL}}}},
    {"return": 2, "result": {"missionId": "mission-1"}},
)
ENDED = ({"drive": {"event": "missionSucceeded"}},)
CLEARED = (
    {"call": 3, "method": "ClearMissionStatus", "params": {}},
    {"return": 3, "result": {"missionIds": ["mission-1"]}},
)
SETTLED = {"settled": True}


@pytest.mark.parametrize("transport", [{}, {"transport": "strict"}])
def test_an_empty_list_is_not_owed_to_who_saw_it_last(transport: JSON) -> None:
    """A stream that shows only the latest may show nothing of a mission that came, ended and was cleared meanwhile.

    It owes what differs: a mission that is still listed, and the empty list to those who saw the mission.
    """
    first = head({"missionfsm": 1, "system": "bear.mission", "world": {}, "drives": DRIVES, **transport})

    def outcome(*lines: JSON) -> Outcome:
        return check(MISSION, first, lines).outcome

    assert outcome(*SUBSCRIBED, *CREATED, *ENDED, *CLEARED, SETTLED) is Outcome.CONFORMS
    if transport:
        assert outcome(*SUBSCRIBED, *CREATED, *ENDED, SETTLED) is Outcome.VIOLATES
        seen = (*SUBSCRIBED, *CREATED, shown(1, "RUNNING"), *ENDED, *CLEARED)
        assert outcome(*seen, SETTLED) is Outcome.VIOLATES
        assert outcome(*seen, shown(2), SETTLED) is Outcome.CONFORMS
