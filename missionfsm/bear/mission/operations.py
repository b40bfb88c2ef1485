"""The ten operations of the Mission page: what each refuses and promises, row by row."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import evolve

from missionfsm.bear.mission.readings.goals import AM_41, AM_43, AM_43_CASE, AM_44, AM_44_AUTOMATIC, AM_45_REFUSED
from missionfsm.bear.mission.readings.queue import AM_11, AM_12_HALTED, AM_12_PAUSED
from missionfsm.bear.mission.readings.starting import AM_53
from missionfsm.bear.mission.readings.unlisted import AM_58
from missionfsm.bear.mission.rules import adding, charging, clearing, request, skipping, updating
from missionfsm.bear.mission.rules.aspects import ABILITY
from missionfsm.bear.mission.state import MISSION, SYSTEM_NAME
from missionfsm.bear.wire.messages import Command
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import (
    DEADLINE_EXCEEDED,
    INTERNAL,
    INVALID_ARGUMENT,
    Operation,
    Rule,
    promise,
)


def _under(rule: Rule, assumption: Assumption) -> Rule:
    """A refusal that holds under a reading."""
    return evolve(rule, assumes=assumption)


def _format(operation: str) -> tuple[Rule, ...]:
    """What is wrong with a request for missions, whatever they are."""
    return (
        request.the_request_is_empty,
        request.the_request_is_malformed,
        request.a_goal_is_invalid,
        request.the_goals_do_not_match_the_mission_type,
        _under(request.a_destination_is_not_on_the_map, AM_43[operation]["a"]),
        _under(request.the_case_of_a_destination_differs, AM_43_CASE[operation]["a"]),
        _under(request.a_goal_occurs_twice, AM_44[operation]["i"]),
        _under(request.a_field_is_unknown, AM_58[operation]["b"]),
    )


def _mission(operation: str) -> tuple[Rule, ...]:
    """What is wrong with a request for missions other than workflows."""
    return (
        *_format(operation),
        _under(request.a_goal_occurs_twice_in_the_list, AM_44_AUTOMATIC[operation]["i"]),
        _under(request.the_mission_is_for_another_family, AM_41[operation]["a"]),
        _under(request.the_robot_is_of_another_family, AM_41[operation]["b"]),
        _under(request.no_goal_is_free, AM_45_REFUSED[operation]["c"]),
        _under(request.no_goal_is_free_now, AM_45_REFUSED[operation]["c"]),
        _under(request.no_goal_is_free_to_start_with, AM_45_REFUSED[operation]["s"]),
        _under(request.a_mission_could_not_start_now, AM_45_REFUSED[operation]["s"]),
    )


def _append(operation: str) -> tuple[Rule, ...]:
    """Why missions are not appended."""
    return (
        *_mission(operation),
        adding.the_mission_queue_is_empty,
        _under(adding.every_mission_has_ended, AM_11[operation]["b"]),
        _under(adding.no_mission_is_running, AM_12_PAUSED[operation]["b"]),
        _under(adding.the_queue_is_halted, AM_12_HALTED[operation]["b"]),
    )


def _no_fields(operation: str) -> tuple[Rule, ...]:
    """What is wrong with a request that has no fields."""
    return (request.the_request_is_malformed, _under(request.a_field_is_unknown, AM_58[operation]["b"]))


_ONE_ID = promise(
    "the-answer-names-the-new-mission",
    "The answer has the id of the mission that was created, which no mission had before.",
    cite=MISSION["CreateMission", "Response"],
    names=True,
)
_ALL_IDS = promise(
    "the-answer-names-the-new-missions-in-order",
    "All missions of the request are created, one after the other; the answer has their ids in the same order.",
    cite=MISSION["CreateMissionBatch"],
    names=True,
)
_WORKFLOW_IDS = promise(
    "the-answer-names-the-missions-of-the-workflow",
    "The answer has the ids of the missions that the workflow created.",
    cite=MISSION["CreateMissionWorkflow", "Response"],
)
_APPENDED = promise(
    "missions-are-appended-at-the-end",
    "Appended missions wait behind all others and run in the order in which they came.",
    cite=MISSION["AppendMission"],
)


def _of_batch(*promises: Rule) -> tuple[Rule, ...]:
    """What holds of appended batches as of other calls, citing their own section, which says it as well."""
    return tuple(evolve(one, cite=MISSION["AppendMissionBatch"]) for one in promises)


_CLEARED = promise(
    "the-answer-names-the-cleared-missions",
    "The answer has the ids of exactly the missions that are not listed any more.",
    cite=MISSION["ClearMissionStatus", "Response"],
)
_SKIPPED = promise(
    "the-next-goal-is-taken-up",
    "The active mission goes on to its next goal, and the answer has its id.",
    cite=MISSION["SkipGoal"],
)
_COMMAND_PROMISES = {
    command: promise(name, says, cite=MISSION["UpdateMission", "Command enum"])
    for command, name, says in (
        (Command.COMMAND_CANCEL, "cancel", "COMMAND_CANCEL ends the mission as cancelled."),
        (Command.COMMAND_PAUSE, "pause", "COMMAND_PAUSE pauses a running mission."),
        (Command.COMMAND_RESUME, "resume", "COMMAND_RESUME lets a paused mission run on."),
        (Command.COMMAND_FINISH, "finish", "COMMAND_FINISH ends the mission as completed."),
    )
}
_SNAPSHOT = promise(
    "the-latest-state-comes-first",
    "The first message of a stream shows the latest known state.",
    cite=MISSION["SubscribeMissionStatus"],
)
_INTERNAL_OR_DEADLINE = (INTERNAL, DEADLINE_EXCEEDED)
INVALID_UNLISTED = ("ChargeRobot", "SkipGoal")
"""Calls without fields whose tables have no row for INVALID_ARGUMENT; their section about the request says its form."""


def _at_home(name: str, one: Rule) -> Rule:
    """A refusal that several calls share, citing the table of this one.

    That a robot is unable to start a mission is a row of one table alone: what refuses other calls for it cites that.
    """
    if one.cite.headings[1:] != ("Errors",) or one.looks_at == ABILITY:
        return one
    unlisted = one.code == INVALID_ARGUMENT and name in INVALID_UNLISTED
    return evolve(one, cite=evolve(one.cite, headings=(name, "Request" if unlisted else "Errors")))


def _operation(
    name: str,
    refusals: tuple[Rule, ...],
    *promises: Rule,
    failures: tuple[str, ...] = _INTERNAL_OR_DEADLINE,
    streaming: bool = False,
) -> Operation:
    own = tuple(_at_home(name, one) for one in refusals)
    return Operation.with_rules(
        name, SYSTEM_NAME, MISSION[name], refusals=own, promises=promises, failures=failures, streaming=streaming
    )


COMMANDED: Mapping[Command, str] = {
    command: one.registered(SYSTEM_NAME, "UpdateMission").id for command, one in _COMMAND_PROMISES.items()
}
"""What a command does, as the id of the rule that promises it."""

OPERATIONS: Mapping[str, Operation] = {
    one.name: one
    for one in (
        _operation(
            "CreateMission",
            (
                *_mission("CreateMission"),
                adding.another_mission_is_active_or_queued,
                _under(adding.the_robot_is_unable_to_start_any_mission, AM_53["CreateMission"]["a"]),
                _under(adding.the_mission_system_cannot_start_a_mission, AM_53["CreateMission"]["i"]),
            ),
            _ONE_ID,
        ),
        _operation(
            "CreateMissionBatch",
            (
                *_mission("CreateMissionBatch"),
                adding.another_mission_is_running_or_queued,
                adding.a_paused_mission_counts_as_running,
                adding.the_robot_is_unable_to_start,
            ),
            _ALL_IDS,
        ),
        _operation(
            "CreateMissionWorkflow",
            (
                *_format("CreateMissionWorkflow"),
                request.the_workflow_is_for_another_family,
                adding.another_mission_is_active,
                *adding.WORKFLOW_WHILE_WAITING,
                *adding.WORKFLOW_UNFIT,
                _under(adding.the_robot_is_unable_to_start_any_mission, AM_53["CreateMissionWorkflow"]["a"]),
                _under(adding.the_mission_system_cannot_start_a_mission, AM_53["CreateMissionWorkflow"]["i"]),
                _under(adding.the_workflow_does_not_fit_a_robot_that_cannot_start, AM_53["CreateMissionWorkflow"]["v"]),
            ),
            _WORKFLOW_IDS,
        ),
        _operation("AppendMission", _append("AppendMission"), _APPENDED, _ONE_ID),
        _operation("AppendMissionBatch", _append("AppendMissionBatch"), *_of_batch(_APPENDED, _ALL_IDS)),
        _operation(
            "ChargeRobot",
            (
                *_no_fields("ChargeRobot"),
                charging.a_mission_is_running,
                charging.a_mission_is_paused,
                *charging.WHILE_WAITING_TO_CHARGE,
                _under(charging.the_robot_is_unable_to_start_charging, AM_53["ChargeRobot"]["a"]),
                _under(adding.the_mission_system_cannot_start_a_mission, AM_53["ChargeRobot"]["i"]),
                *charging.NO_DOCK,
                charging.the_map_has_no_charging_location,
            ),
            _ONE_ID,
        ),
        _operation(
            "ClearMissionStatus",
            (
                *_no_fields("ClearMissionStatus"),
                clearing.a_mission_is_running_or_paused,
                clearing.nothing_is_listed,
                clearing.there_is_nothing_to_clear,
                clearing.nothing_was_ever_listed,
                clearing.there_never_was_anything_to_clear,
                *clearing.WHILE_WAITING_TO_CLEAR,
            ),
            _CLEARED,
            failures=(INTERNAL,),
        ),
        _operation(
            "SkipGoal",
            (
                *_no_fields("SkipGoal"),
                skipping.the_robot_is_not_on_a_mission,
                skipping.the_mission_is_paused,
                *skipping.LAST_GOAL.values(),
                *skipping.WHILE_CHARGING.values(),
            ),
            _SKIPPED,
            failures=(INTERNAL,),
        ),
        _operation(
            "UpdateMission",
            (
                updating.the_mission_id_is_missing,
                request.the_request_is_malformed,
                updating.the_command_is_not_set,
                _under(request.a_field_is_unknown, AM_58["UpdateMission"]["b"]),
                updating.the_robot_is_on_no_mission,
                updating.the_mission_is_still_queued,
                *updating.WRONG_ID,
                updating.the_mission_is_already_paused,
                updating.the_mission_is_not_paused,
                updating.a_paused_mission_cannot_be_finished,
                updating.charging_cannot_be_paused,
            ),
            *_COMMAND_PROMISES.values(),
        ),
        _operation(
            "SubscribeMissionStatus",
            _no_fields("SubscribeMissionStatus"),
            _SNAPSHOT,
            failures=(INTERNAL,),
            streaming=True,
        ),
    )
}
