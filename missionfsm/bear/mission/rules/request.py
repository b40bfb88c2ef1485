"""What is wrong with a request, by itself and in the world of the robot."""

from __future__ import annotations

from missionfsm.bear.mission.inputs import Call, Defect, Wanted
from missionfsm.bear.mission.rules.aspects import EITHER, FORM, GOALS, SHAPE, TAKEN
from missionfsm.bear.mission.state import (
    AUTOMATIC,
    MISSION,
    NOT_CHOSEN,
    Kind,
    Situation,
    free_goal,
    is_foreign,
    is_nowhere,
    is_spelt_otherwise,
)
from missionfsm.kernel.rules import FAILED_PRECONDITION, INVALID_ARGUMENT, refusal


def _wanted(call: Call) -> tuple[Wanted, ...]:
    return call.request.wanted


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], looks_at=SHAPE)
def the_request_is_empty(_: Situation, call: Call) -> bool:
    """The request does not say which mission it wants."""
    return Defect.EMPTY in call.request.defects


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], looks_at=FORM)
def the_request_is_malformed(_: Situation, call: Call) -> bool:
    """The request is not of the documented form: a wrong type, an unknown name, two members of a oneof."""
    return Defect.FORMAT in call.request.defects


@refusal(INVALID_ARGUMENT, cite=MISSION["SubscribeMissionStatus", "Errors"], looks_at=FORM)
def a_field_is_unknown(_: Situation, call: Call) -> bool:
    """The request has a field that is not documented, and such a request is taken for malformed.

    AM-58: readers of protobuf JSON may ignore such a field or refuse it.
    """
    return Defect.FIELD in call.request.defects


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], looks_at=EITHER)
def a_goal_is_invalid(_: Situation, call: Call) -> bool:
    """A goal is neither a destination nor a pose, its destination is empty, or its pose is not finite."""
    return Defect.GOAL in call.request.defects


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], looks_at=EITHER)
def the_goals_do_not_match_the_mission_type(_: Situation, call: Call) -> bool:
    """A mission that needs a goal has none.

    AM-42: the number and kind of goals is what can be told from the page.
    """
    return Defect.MATCH in call.request.defects


def _occurs_twice(wanted: Wanted) -> bool:
    return len(set(wanted.goals)) < len(wanted.goals)


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], looks_at=EITHER)
def a_goal_occurs_twice(_: Situation, call: Call) -> bool:
    """A goal occurs twice in one mission, and that is taken for invalid (AM-44)."""
    return any(wanted.kind not in AUTOMATIC and _occurs_twice(wanted) for wanted in _wanted(call))


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], looks_at=EITHER)
def a_goal_occurs_twice_in_the_list(_: Situation, call: Call) -> bool:
    """A goal occurs twice in the list of a NavigateAuto mission, and that is taken for invalid (AM-44)."""
    return any(wanted.kind in AUTOMATIC and _occurs_twice(wanted) for wanted in _wanted(call))


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Request"], looks_at=GOALS)
def a_destination_is_not_on_the_map(robot: Situation, call: Call) -> bool:
    """A destination_id is not the display name of a destination on the robot's map.

    AM-43: such a goal is invalid at once, or it is accepted and the mission fails.
    """
    return any(is_nowhere(robot.world, wanted.goals) for wanted in _wanted(call))


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Request"], looks_at=GOALS)
def the_case_of_a_destination_differs(robot: Situation, call: Call) -> bool:
    """Only the case of a destination_id differs from the display name of a destination on the robot's map (AM-43)."""
    return any(is_spelt_otherwise(robot.world, wanted.goals) for wanted in _wanted(call))


def _is_for_another_family(robot: Situation, kind: Kind | None) -> bool:
    return kind is not None and is_foreign(robot.world, kind)


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Request"], looks_at=EITHER)
def the_mission_is_for_another_family(robot: Situation, call: Call) -> bool:
    """The mission is specific to a family that the robot is not of.

    AM-41: said for workflows; a mission of another family is refused in the same way.
    """
    return any(_is_for_another_family(robot, wanted.kind) for wanted in _wanted(call))


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMission", "Request"], looks_at=EITHER)
def the_robot_is_of_another_family(robot: Situation, call: Call) -> bool:
    """The robot is not of the family that the mission is for (AM-41 read as a matter of state)."""
    return any(_is_for_another_family(robot, wanted.kind) for wanted in _wanted(call))


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMissionWorkflow", "Errors"], looks_at=EITHER)
def the_workflow_is_for_another_family(robot: Situation, call: Call) -> bool:
    """The robot's family does not have this workflow."""
    return any(_is_for_another_family(robot, wanted.kind) for wanted in _wanted(call))


def _no_goal_is_free(robot: Situation, missions: tuple[Wanted, ...]) -> bool:
    return any(
        wanted.kind in AUTOMATIC and bool(wanted.goals) and free_goal(wanted.goals, robot.world) == NOT_CHOSEN
        for wanted in missions
    )


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "NavigateAutoMission"], looks_at=TAKEN)
def no_goal_is_free(robot: Situation, call: Call) -> bool:
    """Every goal of a NavigateAuto mission is taken, and that is checked when it is created (AM-45)."""
    return _no_goal_is_free(robot, _wanted(call))


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMission", "NavigateAutoMission"], looks_at=TAKEN)
def no_goal_is_free_now(robot: Situation, call: Call) -> bool:
    """Every goal of a NavigateAuto mission is taken, and that is a state that forbids to create it (AM-45)."""
    return _no_goal_is_free(robot, _wanted(call))


def _none_is_free_at_once(robot: Situation, call: Call) -> bool:
    return robot.active is None and not robot.queued and _no_goal_is_free(robot, _wanted(call)[:1])


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "NavigateAutoMission"], looks_at=TAKEN)
def no_goal_is_free_to_start_with(robot: Situation, call: Call) -> bool:
    """Every goal of a NavigateAuto mission that would start at once is taken, and that is checked then (AM-45)."""
    return _none_is_free_at_once(robot, call)


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMission", "NavigateAutoMission"], looks_at=TAKEN)
def a_mission_could_not_start_now(robot: Situation, call: Call) -> bool:
    """Every goal of a NavigateAuto mission that would start at once is taken, which forbids to create it (AM-45)."""
    return _none_is_free_at_once(robot, call)
