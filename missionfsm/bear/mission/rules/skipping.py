"""When `SkipGoal` is refused."""

from __future__ import annotations

from missionfsm.bear.mission.inputs import Call
from missionfsm.bear.mission.readings.skipping import AM_16
from missionfsm.bear.mission.rules.aspects import STATE
from missionfsm.bear.mission.rules.situations import is_paused
from missionfsm.bear.mission.state import MISSION, Situation
from missionfsm.kernel.rules import FAILED_PRECONDITION, INTERNAL, Rule, refusal


@refusal(FAILED_PRECONDITION, cite=MISSION["SkipGoal", "Errors"], looks_at=STATE)
def the_robot_is_not_on_a_mission(robot: Situation, _: Call) -> bool:
    """No mission is running or paused, so there is no goal to skip."""
    return robot.active is None


@refusal(FAILED_PRECONDITION, cite=MISSION["SkipGoal", "Errors"], assumes=AM_16["a"], looks_at=STATE)
def the_mission_is_paused(robot: Situation, _: Call) -> bool:
    """The mission is paused, not actively running (AM-16)."""
    return is_paused(robot)


def _consequence(code: str, name: str, says: str) -> Rule:
    """A refusal whose condition is the effect's to find: it depends on what skipping means for the mission."""
    return Rule(name, says, "", MISSION["SkipGoal"], code, None, None, STATE)


LAST_GOAL = {
    code: _consequence(code, "there-is-no-next-goal", "The mission is at its last goal (AM-17).")
    for code in (FAILED_PRECONDITION, INTERNAL)
}
WHILE_CHARGING = {
    code: _consequence(
        code, "charging-has-no-goals", "The robot charges or returns, which the page gives no goals (AM-19)."
    )
    for code in (FAILED_PRECONDITION, INTERNAL)
}
