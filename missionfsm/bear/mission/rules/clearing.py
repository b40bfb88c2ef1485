"""When `ClearMissionStatus` is refused."""

from __future__ import annotations

from missionfsm.bear.mission.inputs import Call
from missionfsm.bear.mission.readings.clearing import AM_33, AM_34
from missionfsm.bear.mission.readings.scope import BLOCKED, GAP, HALTED
from missionfsm.bear.mission.rules.aspects import SHAPE, STATE
from missionfsm.bear.mission.rules.situations import about_waiting, nothing_listed
from missionfsm.bear.mission.state import MISSION, Situation
from missionfsm.kernel.rules import FAILED_PRECONDITION, INVALID_ARGUMENT, refusal


@refusal(FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus", "Errors"], looks_at=STATE)
def a_mission_is_running_or_paused(robot: Situation, _: Call) -> bool:
    """A mission is running or paused and must end first."""
    return robot.active is not None


@refusal(
    FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus", "Errors"], assumes=AM_33["cleared"]["b"], looks_at=STATE
)
def nothing_is_listed(robot: Situation, _: Call) -> bool:
    """There is nothing left to clear (AM-33)."""
    return nothing_listed(robot) and not robot.fresh


@refusal(INVALID_ARGUMENT, cite=MISSION["ClearMissionStatus", "Errors"], assumes=AM_33["cleared"]["c"], looks_at=SHAPE)
def there_is_nothing_to_clear(robot: Situation, _: Call) -> bool:
    """There is nothing left to clear, so the request means nothing (AM-33)."""
    return nothing_listed(robot) and not robot.fresh


@refusal(FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus", "Errors"], assumes=AM_33["fresh"]["b"], looks_at=STATE)
def nothing_was_ever_listed(robot: Situation, _: Call) -> bool:
    """There never was anything to clear (AM-33)."""
    return robot.fresh


@refusal(INVALID_ARGUMENT, cite=MISSION["ClearMissionStatus", "Errors"], assumes=AM_33["fresh"]["c"], looks_at=SHAPE)
def there_never_was_anything_to_clear(robot: Situation, _: Call) -> bool:
    """There never was anything to clear, so the request means nothing (AM-33)."""
    return robot.fresh


WHILE_WAITING_TO_CLEAR = about_waiting(
    "ClearMissionStatus",
    {where: one["c"] for where, one in AM_34.items()},
    (GAP, "a-mission-is-about-to-start", "A mission is about to start, and all must have ended (AM-34)."),
    (HALTED, "a-mission-waits-in-a-halted-queue", "A mission waits, and all must have ended (AM-34)."),
    (BLOCKED, "a-mission-cannot-start", "A mission waits that the robot is unable to start (AM-34)."),
)
