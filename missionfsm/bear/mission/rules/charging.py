"""When `ChargeRobot` is refused."""

from __future__ import annotations

from missionfsm.bear.mission.inputs import Call
from missionfsm.bear.mission.readings.charging import AM_37_PAUSED, AM_37_QUEUED, AM_38_DOCK
from missionfsm.bear.mission.readings.scope import BLOCKED, GAP, HALTED
from missionfsm.bear.mission.rules.aspects import ABILITY, GOALS, STATE
from missionfsm.bear.mission.rules.situations import about_waiting, is_paused
from missionfsm.bear.mission.state import MISSION, Situation
from missionfsm.bear.wire.messages import State
from missionfsm.kernel.rules import (
    FAILED_PRECONDITION,
    INTERNAL,
    INVALID_ARGUMENT,
    NOT_FOUND,
    UNIMPLEMENTED,
    Rule,
    refusal,
)


@refusal(FAILED_PRECONDITION, cite=MISSION["ChargeRobot", "Errors"], looks_at=STATE)
def a_mission_is_running(robot: Situation, _: Call) -> bool:
    """A mission is running and must be cancelled first."""
    return robot.active is not None and robot.active.state is State.STATE_RUNNING


@refusal(FAILED_PRECONDITION, cite=MISSION["ChargeRobot", "Errors"], assumes=AM_37_PAUSED["a"], looks_at=STATE)
def a_mission_is_paused(robot: Situation, _: Call) -> bool:
    """A mission is paused and must be cancelled first (AM-37)."""
    return is_paused(robot)


WHILE_WAITING_TO_CHARGE = about_waiting(
    "ChargeRobot",
    {where: one["a"] for where, one in AM_37_QUEUED.items()},
    (GAP, "a-mission-is-queued", "A mission waits and must be cleared first (AM-37)."),
    (HALTED, "a-mission-waits-in-a-halted-queue", "A mission waits in a halted queue (AM-37)."),
    (BLOCKED, "a-mission-cannot-start", "A mission waits that the robot is unable to start (AM-37)."),
)


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], looks_at=ABILITY)
def the_robot_is_unable_to_start_charging(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, and charging is one (AM-53)."""
    return robot.world.blocked


def _charger_rule(code: str, letter: str) -> Rule:
    @refusal(code, cite=MISSION["ChargeRobot"], assumes=AM_38_DOCK[letter], looks_at=GOALS)
    def the_robot_has_no_contact_dock(robot: Situation, _: Call) -> bool:
        """The robot has no contact-based charging dock.

        AM-38: the page names no code for it.
        """
        return not robot.world.contact_dock

    return the_robot_has_no_contact_dock


NO_DOCK = tuple(
    _charger_rule(code, letter)
    for code, letter in (
        (NOT_FOUND, "a"),
        (FAILED_PRECONDITION, "b"),
        (INTERNAL, "c"),
        (UNIMPLEMENTED, "d"),
        (INVALID_ARGUMENT, "g"),
    )
)


@refusal(NOT_FOUND, cite=MISSION["ChargeRobot", "Errors"], looks_at=GOALS)
def the_map_has_no_charging_location(robot: Situation, _: Call) -> bool:
    """The robot's map has no contact charger."""
    return not robot.world.charging_location
