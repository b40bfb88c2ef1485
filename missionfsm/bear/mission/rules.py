"""The Errors tables of the Mission page: every row as the conditions that its sentence names."""

from __future__ import annotations

from collections.abc import Callable

from missionfsm.bear.mission.inputs import Call, Defect, Target, Wanted
from missionfsm.bear.mission.readings import (
    AM_02_ENDED,
    AM_02_UNKNOWN,
    AM_03,
    AM_04,
    AM_06,
    AM_07,
    AM_11,
    AM_12_HALTED,
    AM_12_PAUSED,
    AM_16,
    AM_29,
    AM_31,
    AM_33,
    AM_34_GAP,
    AM_34_HALTED,
    AM_37_PAUSED,
    AM_37_QUEUED,
    AM_38_DOCK,
    AM_40,
    AM_41,
    AM_43,
    AM_44,
    AM_45_NONE,
    AM_53,
    AM_53_CHARGE,
    AM_58,
)
from missionfsm.bear.mission.state import (
    AUTOMATIC,
    MISSION,
    NOT_CHOSEN,
    Kind,
    Situation,
    free_goal,
    is_foreign,
    is_missing,
)
from missionfsm.bear.wire.messages import Command, State
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import (
    FAILED_PRECONDITION,
    INTERNAL,
    INVALID_ARGUMENT,
    NOT_FOUND,
    UNIMPLEMENTED,
    Rule,
    rule,
)

SHAPE, GOALS, EITHER, STATE = "shape", "goals", "either", "state"
"""What a rule looks at; AM-01 read as c ranks them, and EITHER may be checked with the shape or with the goals."""


def _wanted(call: Call) -> tuple[Wanted, ...]:
    return call.request.wanted


# The request by itself.


@rule(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], kind=SHAPE)
def the_request_is_empty(_: Situation, call: Call) -> bool:
    """The request does not say which mission it wants."""
    return Defect.EMPTY in call.request.defects


@rule(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], kind=SHAPE)
def the_request_is_malformed(_: Situation, call: Call) -> bool:
    """The request is not of the documented form: a wrong type, an unknown name, two members of a oneof."""
    return Defect.FORMAT in call.request.defects


@rule(INVALID_ARGUMENT, cite=MISSION["SubscribeMissionStatus", "Errors"], under=AM_58["b"], kind=SHAPE)
def a_field_is_unknown(_: Situation, call: Call) -> bool:
    """The request has a field that is not documented, and such a request is taken for malformed.

    AM-58: readers of protobuf JSON may ignore such a field or refuse it.
    """
    return Defect.FIELD in call.request.defects


@rule(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], kind=EITHER)
def a_goal_is_invalid(_: Situation, call: Call) -> bool:
    """A goal is neither a destination nor a pose, its destination is empty, or its pose is not finite."""
    return Defect.GOAL in call.request.defects


@rule(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], kind=EITHER)
def the_goals_do_not_match_the_mission_type(_: Situation, call: Call) -> bool:
    """A mission that needs a goal has none.

    AM-42: the number and kind of goals is what can be told from the page.
    """
    return Defect.MATCH in call.request.defects


@rule(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Errors"], under=AM_44["i"], kind=EITHER)
def a_goal_occurs_twice(_: Situation, call: Call) -> bool:
    """A goal occurs twice in one mission, and that is taken for invalid (AM-44)."""
    return any(len(set(wanted.goals)) < len(wanted.goals) for wanted in _wanted(call))


# The request and the world.


@rule(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Request"], under=AM_43["a"], kind=GOALS)
def a_destination_is_not_on_the_map(robot: Situation, call: Call) -> bool:
    """A destination_id is not the display name of a destination on the robot's map.

    AM-43: such a goal is invalid at once, or it is accepted and the mission fails.
    """
    return any(is_missing(robot.world, wanted.goals) for wanted in _wanted(call))


def _is_for_another_family(robot: Situation, kind: Kind | None) -> bool:
    return kind is not None and is_foreign(robot.world, kind)


@rule(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Request"], under=AM_41["a"], kind=EITHER)
def the_mission_is_for_another_family(robot: Situation, call: Call) -> bool:
    """The mission is specific to a family that the robot is not of.

    AM-41: said for workflows; a mission of another family is refused in the same way.
    """
    return any(_is_for_another_family(robot, wanted.kind) for wanted in _wanted(call))


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMission", "Request"], under=AM_41["b"], kind=EITHER)
def the_robot_is_of_another_family(robot: Situation, call: Call) -> bool:
    """The robot is not of the family that the mission is for (AM-41 read as a matter of state)."""
    return any(_is_for_another_family(robot, wanted.kind) for wanted in _wanted(call))


@rule(INVALID_ARGUMENT, cite=MISSION["CreateMissionWorkflow", "Errors"], kind=EITHER)
def the_workflow_is_for_another_family(robot: Situation, call: Call) -> bool:
    """The robot's family does not have this workflow."""
    return any(_is_for_another_family(robot, wanted.kind) for wanted in _wanted(call))


def _no_goal_is_free(robot: Situation, call: Call) -> bool:
    return any(
        wanted.kind in AUTOMATIC and bool(wanted.goals) and free_goal(wanted.goals, robot.world) == NOT_CHOSEN
        for wanted in _wanted(call)
    )


@rule(INVALID_ARGUMENT, cite=MISSION["CreateMission", "NavigateAutoMission"], under=AM_45_NONE["c"], kind=GOALS)
def no_goal_is_free(robot: Situation, call: Call) -> bool:
    """Every goal of a NavigateAuto mission is taken, and that is checked when it is created (AM-45)."""
    return _no_goal_is_free(robot, call)


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMission", "NavigateAutoMission"], under=AM_45_NONE["c"], kind=GOALS)
def no_goal_is_free_now(robot: Situation, call: Call) -> bool:
    """Every goal of a NavigateAuto mission is taken, and that is a state that forbids to create it (AM-45)."""
    return _no_goal_is_free(robot, call)


# The robot.


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMission", "Errors"], kind=STATE)
def another_mission_is_active_or_queued(robot: Situation, _: Call) -> bool:
    """A mission is running, paused or waiting, so a first mission cannot be created.

    AM-06: a paused mission has not ended. AM-05: "Default" means that nothing has run yet.
    """
    return robot.active is not None or robot.queued


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], kind=STATE)
def another_mission_is_running_or_queued(robot: Situation, _: Call) -> bool:
    """A mission is running or waiting, so a first batch cannot be created."""
    running = robot.active is not None and robot.active.state is State.STATE_RUNNING
    return running or robot.queued


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], under=AM_06["a"], kind=STATE)
def a_paused_mission_counts_as_running(robot: Situation, _: Call) -> bool:
    """A mission is paused, which counts as running (AM-06)."""
    return _is_paused(robot)


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], kind=STATE)
def the_robot_is_unable_to_start(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission."""
    return robot.world.blocked


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], under=AM_53["a"], kind=STATE)
def the_robot_is_unable_to_start_any_mission(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, which forbids every call that creates a first one (AM-53)."""
    return robot.world.blocked


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], under=AM_53_CHARGE["a"], kind=STATE)
def the_robot_is_unable_to_start_charging(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, and charging is one (AM-53)."""
    return robot.world.blocked


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMissionWorkflow", "Errors"], kind=STATE)
def another_mission_is_active(robot: Situation, _: Call) -> bool:
    """A mission is running or paused, so a workflow cannot be created."""
    return robot.active is not None


@rule(FAILED_PRECONDITION, cite=MISSION["CreateMissionWorkflow", "Errors"], under=AM_07["a"], kind=STATE)
def another_mission_is_queued(robot: Situation, _: Call) -> bool:
    """A mission waits, which forbids a workflow as it forbids a mission (AM-07)."""
    return robot.active is None and robot.queued


def _nothing_listed(robot: Situation) -> bool:
    return robot.active is None and not robot.queued and not robot.ended


@rule(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], kind=STATE)
def the_mission_queue_is_empty(robot: Situation, _: Call) -> bool:
    """No mission is listed, so there is nothing to append to."""
    return _nothing_listed(robot)


@rule(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], under=AM_11["b"], kind=STATE)
def every_mission_has_ended(robot: Situation, _: Call) -> bool:
    """Every listed mission has ended, and those are not in the queue any more (AM-11)."""
    return robot.active is None and not robot.queued and robot.ended


def _is_paused(robot: Situation) -> bool:
    return robot.active is not None and robot.active.state is State.STATE_PAUSED


@rule(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], under=AM_12_PAUSED["b"], kind=STATE)
def no_mission_is_running(robot: Situation, _: Call) -> bool:
    """The active mission is paused, and only a running one can be appended to (AM-12)."""
    return _is_paused(robot)


@rule(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], under=AM_12_HALTED["b"], kind=STATE)
def the_queue_is_halted(robot: Situation, _: Call) -> bool:
    """The queue is halted, and only a running mission can be appended to (AM-12)."""
    return robot.active is None and robot.queued and robot.halted


# ChargeRobot.


@rule(FAILED_PRECONDITION, cite=MISSION["ChargeRobot", "Errors"], kind=STATE)
def a_mission_is_running(robot: Situation, _: Call) -> bool:
    """A mission is running and must be cancelled first."""
    return robot.active is not None and robot.active.state is State.STATE_RUNNING


@rule(FAILED_PRECONDITION, cite=MISSION["ChargeRobot", "Errors"], under=AM_37_PAUSED["a"], kind=STATE)
def a_mission_is_paused(robot: Situation, _: Call) -> bool:
    """A mission is paused and must be cancelled first (AM-37)."""
    return _is_paused(robot)


@rule(FAILED_PRECONDITION, cite=MISSION["ChargeRobot", "Errors"], under=AM_37_QUEUED["a"], kind=STATE)
def a_mission_is_queued(robot: Situation, _: Call) -> bool:
    """A mission waits and must be cleared first (AM-37)."""
    return robot.active is None and robot.queued


def _charger_rule(code: str, letter: str) -> Rule:
    @rule(code, cite=MISSION["ChargeRobot"], under=AM_38_DOCK[letter], kind=GOALS)
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


@rule(NOT_FOUND, cite=MISSION["ChargeRobot", "Errors"], kind=GOALS)
def the_map_has_no_charging_location(robot: Situation, _: Call) -> bool:
    """The robot's map has no contact charger."""
    return not robot.world.charging_location


# ClearMissionStatus and SkipGoal.


@rule(FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus", "Errors"], kind=STATE)
def a_mission_is_running_or_paused(robot: Situation, _: Call) -> bool:
    """A mission is running or paused and must end first."""
    return robot.active is not None


@rule(FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus", "Errors"], under=AM_33["b"], kind=STATE)
def nothing_is_listed(robot: Situation, _: Call) -> bool:
    """There is nothing to clear (AM-33)."""
    return _nothing_listed(robot)


@rule(INVALID_ARGUMENT, cite=MISSION["ClearMissionStatus", "Errors"], under=AM_33["c"], kind=SHAPE)
def there_is_nothing_to_clear(robot: Situation, _: Call) -> bool:
    """There is nothing to clear, so the request means nothing (AM-33)."""
    return _nothing_listed(robot)


@rule(FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus"], under=AM_34_GAP["c"], kind=STATE)
def a_mission_is_about_to_start(robot: Situation, _: Call) -> bool:
    """A mission is about to start, and all must have ended (AM-34)."""
    return robot.active is None and robot.queued and not robot.halted


@rule(FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus"], under=AM_34_HALTED["c"], kind=STATE)
def a_mission_waits_in_a_halted_queue(robot: Situation, _: Call) -> bool:
    """A mission waits, and all must have ended (AM-34)."""
    return robot.active is None and robot.queued and robot.halted


@rule(FAILED_PRECONDITION, cite=MISSION["SkipGoal", "Errors"], kind=STATE)
def the_robot_is_not_on_a_mission(robot: Situation, _: Call) -> bool:
    """No mission is running or paused, so there is no goal to skip."""
    return robot.active is None


@rule(FAILED_PRECONDITION, cite=MISSION["SkipGoal", "Errors"], under=AM_16["a"], kind=STATE)
def the_mission_is_paused(robot: Situation, _: Call) -> bool:
    """The mission is paused, not actively running (AM-16)."""
    return _is_paused(robot)


def _consequence(code: str, name: str, says: str) -> Rule:
    """A refusal whose condition is the effect's to find: it depends on what skipping means for the mission."""
    return Rule(name, says, "", MISSION["SkipGoal"], code, None, None, STATE)


LAST_GOAL = {
    code: _consequence(code, "there-is-no-next-goal", "The mission is at its last goal (AM-17).")
    for code in (FAILED_PRECONDITION, INTERNAL)
}
CHARGING = {
    code: _consequence(
        code, "charging-has-no-goals", "The robot charges or returns, which has no goals of its own (AM-19)."
    )
    for code in (FAILED_PRECONDITION, INTERNAL)
}


# UpdateMission.


@rule(INVALID_ARGUMENT, cite=MISSION["UpdateMission", "Errors"], kind=SHAPE)
def the_command_is_not_set(_: Situation, call: Call) -> bool:
    """The command is COMMAND_UNKNOWN, a number without a name, or missing."""
    return Defect.COMMAND in call.request.defects


@rule(INVALID_ARGUMENT, cite=MISSION["UpdateMission", "Errors"], kind=SHAPE)
def the_mission_id_is_missing(_: Situation, call: Call) -> bool:
    """The request does not say which mission it is about."""
    return Defect.EMPTY in call.request.defects


@rule(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], under=AM_04["c"], kind=STATE)
def the_robot_is_on_no_mission(robot: Situation, call: Call) -> bool:
    """No mission is active, and the request does not say readably which one it is about (AM-04)."""
    return call.target is None and robot.active is None


@rule(NOT_FOUND, cite=MISSION["UpdateMission", "Errors"], kind=STATE)
def the_mission_is_still_queued(_: Situation, call: Call) -> bool:
    """The mission still waits, and waiting missions cannot be updated."""
    return call.target is Target.QUEUED


def _id_rule(code: str, name: str, says: str, under: Assumption, holds: Callable[[Situation, Call], bool]) -> Rule:
    return Rule(name, says, "", MISSION["UpdateMission", "Errors"], code, holds, under, STATE)


def _ended(robot: Situation, call: Call) -> bool:
    return call.target is Target.ENDED and robot.active is None


def _ended_while_another_is_active(robot: Situation, call: Call) -> bool:
    return call.target is Target.ENDED and robot.active is not None


def _unknown(robot: Situation, call: Call) -> bool:
    return call.target is Target.UNKNOWN and robot.active is None and not _nothing_listed(robot)


def _unknown_while_another_is_active(robot: Situation, call: Call) -> bool:
    return call.target is Target.UNKNOWN and robot.active is not None


def _no_mission(robot: Situation, call: Call) -> bool:
    return call.target is Target.UNKNOWN and _nothing_listed(robot)


WRONG_ID = (
    _id_rule(
        FAILED_PRECONDITION, "the-mission-has-ended", "The mission has ended.", AM_02_ENDED["a", "c", "e"], _ended
    ),
    _id_rule(NOT_FOUND, "the-mission-has-ended", "The mission is not active.", AM_02_ENDED["b"], _ended),
    _id_rule(INVALID_ARGUMENT, "the-mission-has-ended", "The mission is not active.", AM_02_ENDED["d"], _ended),
    _id_rule(
        FAILED_PRECONDITION,
        "the-mission-has-ended-and-another-is-active",
        "The mission has ended.",
        AM_02_ENDED["a"],
        _ended_while_another_is_active,
    ),
    _id_rule(
        NOT_FOUND,
        "the-mission-has-ended-and-another-is-active",
        "Another mission is active.",
        AM_02_ENDED["b", "c"],
        _ended_while_another_is_active,
    ),
    _id_rule(
        INVALID_ARGUMENT,
        "the-mission-has-ended-and-another-is-active",
        "Another mission is active.",
        AM_02_ENDED["d", "e"],
        _ended_while_another_is_active,
    ),
    _id_rule(INVALID_ARGUMENT, "the-mission-is-not-listed", "No such mission is listed.", AM_02_UNKNOWN["a"], _unknown),
    _id_rule(NOT_FOUND, "the-mission-is-not-listed", "No such mission is listed.", AM_02_UNKNOWN["b"], _unknown),
    _id_rule(
        FAILED_PRECONDITION,
        "the-mission-is-not-listed",
        "No mission is active.",
        AM_02_UNKNOWN["e", "f"],
        _unknown,
    ),
    _id_rule(
        INVALID_ARGUMENT,
        "the-mission-is-not-listed-and-another-is-active",
        "The id is not that of the active mission.",
        AM_02_UNKNOWN["a", "e"],
        _unknown_while_another_is_active,
    ),
    _id_rule(
        NOT_FOUND,
        "the-mission-is-not-listed-and-another-is-active",
        "The id is not that of the active mission.",
        AM_02_UNKNOWN["b", "f"],
        _unknown_while_another_is_active,
    ),
    _id_rule(FAILED_PRECONDITION, "the-robot-has-no-mission", "The robot has no mission.", AM_03["a"], _no_mission),
    _id_rule(NOT_FOUND, "the-robot-has-no-mission", "The robot has no mission.", AM_03["b"], _no_mission),
    _id_rule(INVALID_ARGUMENT, "the-robot-has-no-mission", "The robot has no mission.", AM_03["c"], _no_mission),
)
"""AM-02, AM-03: the rows overlap on ids that are not the active mission's, and each way to share them is a reading."""


def _asks(call: Call, command: Command) -> bool:
    return call.target is Target.ACTIVE and call.request.command is command


@rule(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], under=AM_29["a"], kind=STATE)
def the_mission_is_already_paused(robot: Situation, call: Call) -> bool:
    """The mission is paused already (AM-29)."""
    return _asks(call, Command.COMMAND_PAUSE) and _is_paused(robot)


@rule(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], under=AM_29["a"], kind=STATE)
def the_mission_is_not_paused(robot: Situation, call: Call) -> bool:
    """The mission is not paused, so it cannot be resumed (AM-29)."""
    return _asks(call, Command.COMMAND_RESUME) and not _is_paused(robot)


@rule(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], under=AM_31["b"], kind=STATE)
def a_paused_mission_cannot_be_finished(robot: Situation, call: Call) -> bool:
    """The mission is paused and must be resumed before it can be finished (AM-31)."""
    return _asks(call, Command.COMMAND_FINISH) and _is_paused(robot)


@rule(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], under=AM_40["c"], kind=STATE)
def charging_cannot_be_paused(robot: Situation, call: Call) -> bool:
    """The robot is charging, which cannot be paused (AM-40)."""
    charging = robot.active is not None and robot.active.kind is Kind.CHARGE
    return _asks(call, Command.COMMAND_PAUSE) and charging and not _is_paused(robot)
