"""What the Mission page promises of its status stream."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.bear.mission.state import MISSION, SYSTEM_NAME
from missionfsm.kernel.rules import Rule, promise


def _promise(name: str, says: str, *place: str) -> Rule:
    return promise(name, says, cite=MISSION[("SubscribeMissionStatus", *place)]).registered(
        SYSTEM_NAME, "SubscribeMissionStatus"
    )


WELL_FORMED = _promise("messages-are-well-formed", "A message has the documented form.", "Response")
SEQUENCE = _promise(
    "sequence-numbers-grow", "A sequence number is larger than the one before, or 0; never negative.", "EventMetadata"
)
ALL_LISTED = _promise(
    "all-missions-are-listed", "Every mission of the robot is listed once, and no other.", "MissionStates"
)
CURRENT = _promise(
    "the-current-mission-index-is-the-active-mission",
    "current_mission_index is that of the active mission, -1 if none is active.",
    "MissionStates",
)
STATE = _promise("the-state-is-reported", "A mission is reported in the state that it is in.", "State enum")
GOALS = _promise(
    "the-goals-are-those-requested", "A mission lists its goals in the order of the request.", "MissionState"
)
GOAL_INDEX = _promise(
    "the-current-goal-index-is-the-active-goal", "current_goal_index is that of the active goal.", "MissionState"
)
FEEDBACK = _promise("the-feedback-fits-the-mission", "Feedback is of the mission's kind.", "MissionFeedback")
TYPE = _promise("the-type-is-that-requested", "A mission has the type that was asked for.", "MissionType")
OWED = _promise(
    "updates-follow-the-state", "Every state that lasts is shown, in order, and none that was never reached."
)
RULES = (WELL_FORMED, SEQUENCE, ALL_LISTED, CURRENT, STATE, GOALS, GOAL_INDEX, FEEDBACK, TYPE, OWED)
ANSWERS_FOR: Mapping[str, tuple[str, ...]] = {
    entry: (rule.id,)
    for rule, entries in (
        (STATE, ("AM-08", "AM-09", "AM-10", "AM-45.none")),
        (CURRENT, ("AM-14",)),
        (ALL_LISTED, ("AM-13", "AM-35", "AM-36")),
        (TYPE, ("AM-26", "AM-51")),
        (GOALS, ("AM-27",)),
        (GOAL_INDEX, ("AM-45.when", "AM-64")),
        (FEEDBACK, ("AM-50",)),
        (WELL_FORMED, ("AM-49", "AM-58.sent")),
        (OWED, ("AM-47", "AM-54", "AM-63")),
    )
    for entry in entries
}
"""By what is shown, the promise that a question is about; see `missionfsm.kernel.spec.Spec`."""
