"""The Errors tables of the Mission page: every row as the conditions that its sentence names."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from missionfsm.bear.mission.inputs import Call, Defect, Target, Wanted
from missionfsm.bear.mission.readings.charging import AM_37_PAUSED, AM_37_QUEUED, AM_38_DOCK, AM_40
from missionfsm.bear.mission.readings.clearing import AM_33, AM_34
from missionfsm.bear.mission.readings.codes import (
    AM_02_CLEARED,
    AM_02_ENDED,
    AM_02_QUEUED,
    AM_02_UNKNOWN,
    AM_03,
    AM_04_NO_ID,
    BUSY,
    IDLE,
)
from missionfsm.bear.mission.readings.queue import AM_06, AM_07
from missionfsm.bear.mission.readings.scope import BLOCKED, GAP, HALTED
from missionfsm.bear.mission.readings.skipping import AM_16
from missionfsm.bear.mission.readings.updating import AM_29, AM_31
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
from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.rules import (
    FAILED_PRECONDITION,
    INTERNAL,
    INVALID_ARGUMENT,
    NOT_FOUND,
    UNIMPLEMENTED,
    Rule,
    refusal,
)

FORM, SHAPE, GOALS, EITHER, TAKEN = "form", "shape", "goals", "either", "taken"
STATE, ABILITY = "state", "ability"
"""What a rule looks at; AM-01 read as c ranks them, and EITHER may be checked with the shape or with the goals.

A request of the wrong FORM cannot be decoded: whoever looks at something else first cannot do so without a request.
What other robots have TAKEN is neither the request nor the missions: it may be looked at first, last or between.
STATE is about the missions, ABILITY about whether the robot can start one. What is wrong with the request is ranked
against the state by its code, INVALID_ARGUMENT: a refusal of SHAPE or GOALS with another code is not.

A refusal that several calls share cites the table of the first; `operations.py` has it cite the table of each.
"""


def _wanted(call: Call) -> tuple[Wanted, ...]:
    return call.request.wanted


# The request by itself.


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


# The request and the world.


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMission", "Request"], looks_at=GOALS)
def a_destination_is_not_on_the_map(robot: Situation, call: Call) -> bool:
    """A destination_id is not the display name of a destination on the robot's map.

    AM-43: such a goal is invalid at once, or it is accepted and the mission fails.
    """
    return any(is_missing(robot.world, wanted.goals) for wanted in _wanted(call))


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


# The robot.


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMission", "Errors"], looks_at=STATE)
def another_mission_is_active_or_queued(robot: Situation, _: Call) -> bool:
    """A mission is running, paused or waiting, so a first mission cannot be created.

    AM-06: a paused mission has not ended. AM-05: "Default" means that nothing has run yet.
    """
    return robot.active is not None or robot.queued


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], looks_at=STATE)
def another_mission_is_running_or_queued(robot: Situation, _: Call) -> bool:
    """A mission is running or waiting, so a first batch cannot be created."""
    running = robot.active is not None and robot.active.state is State.STATE_RUNNING
    return running or robot.queued


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], assumes=AM_06["a"], looks_at=STATE)
def a_paused_mission_counts_as_running(robot: Situation, _: Call) -> bool:
    """A mission is paused, which counts as running (AM-06)."""
    return _is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], looks_at=ABILITY)
def the_robot_is_unable_to_start(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission."""
    return robot.world.blocked


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], looks_at=ABILITY)
def the_robot_is_unable_to_start_any_mission(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, which forbids every call that creates a first one (AM-53)."""
    return robot.world.blocked


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], looks_at=ABILITY)
def the_robot_is_unable_to_start_charging(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, and charging is one (AM-53)."""
    return robot.world.blocked


@refusal(INTERNAL, cite=MISSION["CreateMissionBatch", "Errors"], looks_at=ABILITY)
def the_mission_system_cannot_start_a_mission(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, which is taken for a failure of the mission system (AM-53)."""
    return robot.world.blocked


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMissionWorkflow", "Errors"], looks_at=ABILITY)
def the_workflow_does_not_fit_a_robot_that_cannot_start(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, which makes a workflow invalid (AM-53)."""
    return robot.world.blocked


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionWorkflow", "Errors"], looks_at=STATE)
def another_mission_is_active(robot: Situation, _: Call) -> bool:
    """A mission is running or paused, so a workflow cannot be created."""
    return robot.active is not None


def waiting(robot: Situation) -> str:
    """Why missions wait where none is active: a part of AM-07, AM-34 and AM-37."""
    return HALTED if robot.halted else BLOCKED if robot.world.blocked else GAP


def _waits(where: str, robot: Situation, _: Call) -> bool:
    """Whether missions wait and none is active, in one of the situations in which that can be so."""
    return robot.active is None and robot.queued and waiting(robot) == where


def _about_waiting(
    operation: str, under: Mapping[str, Assumption], *rules: tuple[str, str, str], code: str = FAILED_PRECONDITION
) -> tuple[Rule, ...]:
    """A refusal for each situation in which missions wait and none is active: the situation, its name, what it says."""
    return tuple(
        Rule(
            name,
            says,
            "",
            MISSION[operation, "Errors"] if operation != "ClearMissionStatus" else MISSION[operation],
            code,
            functools.partial(_waits, where),
            under[where],
            STATE,
        )
        for where, name, says in rules
    )


WORKFLOW_WHILE_WAITING = _about_waiting(
    "CreateMissionWorkflow",
    {where: one["a"] for where, one in AM_07.items()},
    (GAP, "another-mission-is-queued", "A mission waits, which forbids a workflow as it forbids a mission (AM-07)."),
    (HALTED, "another-mission-waits-in-a-halted-queue", "A mission waits in a halted queue (AM-07)."),
    (BLOCKED, "another-mission-cannot-start", "A mission waits that the robot is unable to start (AM-07)."),
)
WORKFLOW_UNFIT = _about_waiting(
    "CreateMissionWorkflow",
    {where: one["v"] for where, one in AM_07.items()},
    (GAP, "the-workflow-does-not-fit-a-queue", "A mission waits, which makes a workflow invalid (AM-07)."),
    (
        HALTED,
        "the-workflow-does-not-fit-a-halted-queue",
        "A mission waits in a halted queue, which makes a workflow invalid (AM-07).",
    ),
    (
        BLOCKED,
        "the-workflow-does-not-fit-what-cannot-start",
        "A mission waits that the robot is unable to start, which makes a workflow invalid (AM-07).",
    ),
    code=INVALID_ARGUMENT,
)


def _nothing_listed(robot: Situation) -> bool:
    return robot.active is None and not robot.queued and not robot.ended


@refusal(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], looks_at=STATE)
def the_mission_queue_is_empty(robot: Situation, _: Call) -> bool:
    """No mission is listed, so there is nothing to append to."""
    return _nothing_listed(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], looks_at=STATE)
def every_mission_has_ended(robot: Situation, _: Call) -> bool:
    """Every listed mission has ended, and those are not in the queue any more (AM-11)."""
    return robot.active is None and not robot.queued and robot.ended


def _is_paused(robot: Situation) -> bool:
    return robot.active is not None and robot.active.state is State.STATE_PAUSED


@refusal(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], looks_at=STATE)
def no_mission_is_running(robot: Situation, _: Call) -> bool:
    """The active mission is paused, and only a running one can be appended to (AM-12)."""
    return _is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], looks_at=STATE)
def the_queue_is_halted(robot: Situation, _: Call) -> bool:
    """The queue is halted, and only a running mission can be appended to (AM-12)."""
    return robot.active is None and robot.queued and robot.halted


# ChargeRobot.


@refusal(FAILED_PRECONDITION, cite=MISSION["ChargeRobot", "Errors"], looks_at=STATE)
def a_mission_is_running(robot: Situation, _: Call) -> bool:
    """A mission is running and must be cancelled first."""
    return robot.active is not None and robot.active.state is State.STATE_RUNNING


@refusal(FAILED_PRECONDITION, cite=MISSION["ChargeRobot", "Errors"], assumes=AM_37_PAUSED["a"], looks_at=STATE)
def a_mission_is_paused(robot: Situation, _: Call) -> bool:
    """A mission is paused and must be cancelled first (AM-37)."""
    return _is_paused(robot)


CHARGING_WHILE_WAITING = _about_waiting(
    "ChargeRobot",
    {where: one["a"] for where, one in AM_37_QUEUED.items()},
    (GAP, "a-mission-is-queued", "A mission waits and must be cleared first (AM-37)."),
    (HALTED, "a-mission-waits-in-a-halted-queue", "A mission waits in a halted queue (AM-37)."),
    (BLOCKED, "a-mission-cannot-start", "A mission waits that the robot is unable to start (AM-37)."),
)


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


# ClearMissionStatus and SkipGoal.


@refusal(FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus", "Errors"], looks_at=STATE)
def a_mission_is_running_or_paused(robot: Situation, _: Call) -> bool:
    """A mission is running or paused and must end first."""
    return robot.active is not None


@refusal(
    FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus", "Errors"], assumes=AM_33["cleared"]["b"], looks_at=STATE
)
def nothing_is_listed(robot: Situation, _: Call) -> bool:
    """There is nothing left to clear (AM-33)."""
    return _nothing_listed(robot) and not robot.fresh


@refusal(INVALID_ARGUMENT, cite=MISSION["ClearMissionStatus", "Errors"], assumes=AM_33["cleared"]["c"], looks_at=SHAPE)
def there_is_nothing_to_clear(robot: Situation, _: Call) -> bool:
    """There is nothing left to clear, so the request means nothing (AM-33)."""
    return _nothing_listed(robot) and not robot.fresh


@refusal(FAILED_PRECONDITION, cite=MISSION["ClearMissionStatus", "Errors"], assumes=AM_33["fresh"]["b"], looks_at=STATE)
def nothing_was_ever_listed(robot: Situation, _: Call) -> bool:
    """There never was anything to clear (AM-33)."""
    return robot.fresh


@refusal(INVALID_ARGUMENT, cite=MISSION["ClearMissionStatus", "Errors"], assumes=AM_33["fresh"]["c"], looks_at=SHAPE)
def there_never_was_anything_to_clear(robot: Situation, _: Call) -> bool:
    """There never was anything to clear, so the request means nothing (AM-33)."""
    return robot.fresh


CLEARING_WHILE_WAITING = _about_waiting(
    "ClearMissionStatus",
    {where: one["c"] for where, one in AM_34.items()},
    (GAP, "a-mission-is-about-to-start", "A mission is about to start, and all must have ended (AM-34)."),
    (HALTED, "a-mission-waits-in-a-halted-queue", "A mission waits, and all must have ended (AM-34)."),
    (BLOCKED, "a-mission-cannot-start", "A mission waits that the robot is unable to start (AM-34)."),
)


@refusal(FAILED_PRECONDITION, cite=MISSION["SkipGoal", "Errors"], looks_at=STATE)
def the_robot_is_not_on_a_mission(robot: Situation, _: Call) -> bool:
    """No mission is running or paused, so there is no goal to skip."""
    return robot.active is None


@refusal(FAILED_PRECONDITION, cite=MISSION["SkipGoal", "Errors"], assumes=AM_16["a"], looks_at=STATE)
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
        code, "charging-has-no-goals", "The robot charges or returns, which the page gives no goals (AM-19)."
    )
    for code in (FAILED_PRECONDITION, INTERNAL)
}


# UpdateMission.


@refusal(INVALID_ARGUMENT, cite=MISSION["UpdateMission", "Errors"], looks_at=SHAPE)
def the_command_is_not_set(_: Situation, call: Call) -> bool:
    """The command is COMMAND_UNKNOWN, a number without a name, or missing."""
    return Defect.COMMAND in call.request.defects


@refusal(INVALID_ARGUMENT, cite=MISSION["UpdateMission", "Errors"], looks_at=SHAPE)
def the_mission_id_is_missing(_: Situation, call: Call) -> bool:
    """The request does not say which mission it is about."""
    return Defect.EMPTY in call.request.defects


@refusal(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], assumes=AM_04_NO_ID["c"], looks_at=STATE)
def the_robot_is_on_no_mission(robot: Situation, call: Call) -> bool:
    """No mission is active, and the request does not say readably which one it is about (AM-04)."""
    return call.target is None and robot.active is None


@refusal(NOT_FOUND, cite=MISSION["UpdateMission", "Errors"], looks_at=STATE)
def the_mission_is_still_queued(robot: Situation, call: Call) -> bool:
    """The mission still waits behind the active one, and waiting missions cannot be updated."""
    return call.target is Target.QUEUED and robot.active is not None


def id_situation(robot: Situation, call: Call) -> str:
    """What a mission id that is not the active mission's means: a part of AM-04."""
    if call.target is None:
        return "no-id"
    if call.target in (Target.UNKNOWN, Target.CLEARED) and _nothing_listed(robot):
        return "fresh" if robot.fresh else _TARGETS[call.target]
    return f"{_TARGETS[call.target]}-{IDLE if robot.active is None else BUSY}"


_TARGETS = {
    Target.ACTIVE: "active",
    Target.QUEUED: "queued",
    Target.ENDED: "ended",
    Target.CLEARED: "cleared",
    Target.UNKNOWN: "unknown",
}


def _wrong_id(situation: str, name: str, says: str, ambiguity: Ambiguity, codes: Mapping[str, str]) -> tuple[Rule, ...]:
    """Refusals of an id that means something else than the active mission: the letters to the codes."""
    return tuple(
        Rule(
            name,
            says,
            "",
            MISSION["UpdateMission", "Errors"],
            code,
            lambda robot, call: id_situation(robot, call) == situation,
            ambiguity[letter],
            STATE,
        )
        for letter, code in codes.items()
    )


_ENDED_CODES = {"a": FAILED_PRECONDITION, "b": NOT_FOUND, "d": INVALID_ARGUMENT}
_GONE_CODES = {"a": INVALID_ARGUMENT, "b": NOT_FOUND, "e": FAILED_PRECONDITION}
_NO_MISSION_CODES = {"a": FAILED_PRECONDITION, "b": NOT_FOUND, "c": INVALID_ARGUMENT}
WRONG_ID = tuple(
    rule
    for rules in (
        _wrong_id(
            "queued-idle",
            "the-mission-still-waits-and-none-is-active",
            "The mission still waits, and no mission is active.",
            AM_02_QUEUED,
            {"a": NOT_FOUND, "b": FAILED_PRECONDITION},
        ),
        _wrong_id("ended-idle", "the-mission-has-ended", "The mission has ended.", AM_02_ENDED[IDLE], _ENDED_CODES),
        _wrong_id(
            "ended-busy",
            "the-mission-has-ended-and-another-is-active",
            "The mission has ended, and another is active.",
            AM_02_ENDED[BUSY],
            _ENDED_CODES,
        ),
        _wrong_id(
            "cleared-idle",
            "the-mission-is-not-listed-any-more",
            "The mission is not listed any more.",
            AM_02_CLEARED[IDLE],
            _GONE_CODES,
        ),
        _wrong_id(
            "cleared-busy",
            "the-mission-is-not-listed-any-more-and-another-is-active",
            "The mission is not listed any more, and another is active.",
            AM_02_CLEARED[BUSY],
            _GONE_CODES,
        ),
        _wrong_id(
            "unknown-idle",
            "the-mission-is-not-listed",
            "No such mission was ever listed.",
            AM_02_UNKNOWN[IDLE],
            _GONE_CODES,
        ),
        _wrong_id(
            "unknown-busy",
            "the-mission-is-not-listed-and-another-is-active",
            "No such mission was ever listed, and another is active.",
            AM_02_UNKNOWN[BUSY],
            _GONE_CODES,
        ),
        _wrong_id(
            "fresh",
            "the-robot-never-had-a-mission",
            "The robot never had a mission.",
            AM_03["fresh"],
            _NO_MISSION_CODES,
        ),
        _wrong_id(
            "unknown",
            "the-robot-has-no-mission",
            "The robot has no mission, and no such mission was ever listed.",
            AM_03["unknown"],
            _NO_MISSION_CODES,
        ),
        _wrong_id(
            "cleared",
            "the-robot-has-no-mission-any-more",
            "The robot has no mission; this one was listed once.",
            AM_03["cleared"],
            _NO_MISSION_CODES,
        ),
    )
    for rule in rules
)
"""AM-02, AM-03: the rows overlap on ids that are not the active mission's, and each way to share them is a reading."""


def _asks(call: Call, command: Command) -> bool:
    return call.target is Target.ACTIVE and call.request.command is command


@refusal(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], assumes=AM_29["pause"]["a"], looks_at=STATE)
def the_mission_is_already_paused(robot: Situation, call: Call) -> bool:
    """The mission is paused already (AM-29)."""
    return _asks(call, Command.COMMAND_PAUSE) and _is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], assumes=AM_29["resume"]["a"], looks_at=STATE)
def the_mission_is_not_paused(robot: Situation, call: Call) -> bool:
    """The mission is not paused, so it cannot be resumed (AM-29)."""
    return _asks(call, Command.COMMAND_RESUME) and not _is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], assumes=AM_31["b"], looks_at=STATE)
def a_paused_mission_cannot_be_finished(robot: Situation, call: Call) -> bool:
    """The mission is paused and must be resumed before it can be finished (AM-31)."""
    return _asks(call, Command.COMMAND_FINISH) and _is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], assumes=AM_40["c"], looks_at=STATE)
def charging_cannot_be_paused(robot: Situation, call: Call) -> bool:
    """The robot is charging, which cannot be paused (AM-40)."""
    charging = robot.active is not None and robot.active.kind is Kind.CHARGE
    return _asks(call, Command.COMMAND_PAUSE) and charging and not _is_paused(robot)
