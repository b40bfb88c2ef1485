"""The ten operations of the Mission page: what each refuses and promises, and which refusal comes first."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from missionfsm.bear.mission.inputs import Call
from missionfsm.bear.mission.readings import AM_01, AM_04, AM_38_RUNNING
from missionfsm.bear.mission.rules import (
    CHARGING,
    EITHER,
    LAST_GOAL,
    NO_DOCK,
    SHAPE,
    STATE,
    WRONG_ID,
    a_destination_is_not_on_the_map,
    a_field_is_unknown,
    a_goal_is_invalid,
    a_goal_occurs_twice,
    a_mission_is_about_to_start,
    a_mission_is_paused,
    a_mission_is_queued,
    a_mission_is_running,
    a_mission_is_running_or_paused,
    a_mission_waits_in_a_halted_queue,
    a_paused_mission_cannot_be_finished,
    a_paused_mission_counts_as_running,
    another_mission_is_active,
    another_mission_is_active_or_queued,
    another_mission_is_queued,
    another_mission_is_running_or_queued,
    charging_cannot_be_paused,
    every_mission_has_ended,
    no_goal_is_free,
    no_goal_is_free_now,
    no_mission_is_running,
    nothing_is_listed,
    the_command_is_not_set,
    the_goals_do_not_match_the_mission_type,
    the_map_has_no_charging_location,
    the_mission_id_is_missing,
    the_mission_is_already_paused,
    the_mission_is_for_another_family,
    the_mission_is_not_paused,
    the_mission_is_paused,
    the_mission_is_still_queued,
    the_mission_queue_is_empty,
    the_queue_is_halted,
    the_request_is_empty,
    the_request_is_malformed,
    the_robot_is_not_on_a_mission,
    the_robot_is_of_another_family,
    the_robot_is_on_no_mission,
    the_robot_is_unable_to_start,
    the_robot_is_unable_to_start_any_mission,
    the_robot_is_unable_to_start_charging,
    the_workflow_is_for_another_family,
    there_is_nothing_to_clear,
)
from missionfsm.bear.mission.state import MISSION, SYSTEM, Situation
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import (
    DEADLINE_EXCEEDED,
    FAILED_PRECONDITION,
    INTERNAL,
    INVALID_ARGUMENT,
    Operation,
    Ranking,
    Rule,
    promise,
)

_FORMAT = (
    the_request_is_empty,
    the_request_is_malformed,
    a_goal_is_invalid,
    the_goals_do_not_match_the_mission_type,
    a_destination_is_not_on_the_map,
    a_goal_occurs_twice,
    a_field_is_unknown,
)
_MISSION = (
    *_FORMAT,
    the_mission_is_for_another_family,
    the_robot_is_of_another_family,
    no_goal_is_free,
    no_goal_is_free_now,
)
_APPEND = (the_mission_queue_is_empty, every_mission_has_ended, no_mission_is_running, the_queue_is_halted)
_COMMAND = (the_mission_is_already_paused, the_mission_is_not_paused, a_paused_mission_cannot_be_finished)
_ONE_ID = promise(
    "the-answer-names-the-new-mission",
    "The answer has the id of the mission that was created, which no mission had before.",
    cite=MISSION["CreateMission", "Response"],
)
_ALL_IDS = promise(
    "the-answer-names-the-new-missions-in-order",
    "All missions of the request are created, one after the other; the answer has their ids in the same order.",
    cite=MISSION["CreateMissionBatch"],
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
_COMMANDED = tuple(
    promise(name, says, cite=MISSION["UpdateMission", "Command enum"])
    for name, says in (
        ("cancel", "COMMAND_CANCEL ends the mission as cancelled."),
        ("pause", "COMMAND_PAUSE pauses a running mission."),
        ("resume", "COMMAND_RESUME lets a paused mission run on."),
        ("finish", "COMMAND_FINISH ends the mission as completed."),
    )
)
_SNAPSHOT = promise(
    "the-latest-state-comes-first",
    "The first message of a stream shows the latest known state.",
    cite=MISSION["SubscribeMissionStatus"],
)
_EITHER = (INTERNAL, DEADLINE_EXCEEDED)


def _operation(
    name: str,
    refusals: tuple[Rule, ...],
    *promises: Rule,
    failures: tuple[str, ...] = _EITHER,
    streaming: bool = False,
) -> Operation:
    return Operation.of(
        name, SYSTEM, MISSION[name], refusals=refusals, promises=promises, failures=failures, streaming=streaming
    )


OPERATIONS: Mapping[str, Operation] = {
    one.name: one
    for one in (
        _operation(
            "CreateMission",
            (*_MISSION, another_mission_is_active_or_queued, the_robot_is_unable_to_start_any_mission),
            _ONE_ID,
        ),
        _operation(
            "CreateMissionBatch",
            (
                *_MISSION,
                another_mission_is_running_or_queued,
                a_paused_mission_counts_as_running,
                the_robot_is_unable_to_start,
            ),
            _ALL_IDS,
        ),
        _operation(
            "CreateMissionWorkflow",
            (
                *_FORMAT,
                the_workflow_is_for_another_family,
                another_mission_is_active,
                another_mission_is_queued,
                the_robot_is_unable_to_start_any_mission,
            ),
            _WORKFLOW_IDS,
        ),
        _operation("AppendMission", (*_MISSION, *_APPEND), _ONE_ID, _APPENDED),
        _operation("AppendMissionBatch", (*_MISSION, *_APPEND), _ALL_IDS, _APPENDED),
        _operation(
            "ChargeRobot",
            (
                the_request_is_malformed,
                a_field_is_unknown,
                a_mission_is_running,
                a_mission_is_paused,
                a_mission_is_queued,
                the_robot_is_unable_to_start_charging,
                *NO_DOCK,
                the_map_has_no_charging_location,
            ),
            _ONE_ID,
        ),
        _operation(
            "ClearMissionStatus",
            (
                the_request_is_malformed,
                a_field_is_unknown,
                a_mission_is_running_or_paused,
                nothing_is_listed,
                there_is_nothing_to_clear,
                a_mission_is_about_to_start,
                a_mission_waits_in_a_halted_queue,
            ),
            _CLEARED,
            failures=(INTERNAL,),
        ),
        _operation(
            "SkipGoal",
            (
                the_request_is_malformed,
                a_field_is_unknown,
                the_robot_is_not_on_a_mission,
                the_mission_is_paused,
                *LAST_GOAL.values(),
                *CHARGING.values(),
            ),
            _SKIPPED,
            failures=(INTERNAL,),
        ),
        _operation(
            "UpdateMission",
            (
                the_mission_id_is_missing,
                the_request_is_malformed,
                the_command_is_not_set,
                a_field_is_unknown,
                the_robot_is_on_no_mission,
                the_mission_is_still_queued,
                *WRONG_ID,
                *_COMMAND,
                charging_cannot_be_paused,
            ),
            *_COMMANDED,
        ),
        _operation(
            "SubscribeMissionStatus",
            (the_request_is_malformed, a_field_is_unknown),
            _SNAPSHOT,
            failures=(INTERNAL,),
            streaming=True,
        ),
    )
}


def ranking(robot: Situation, call: Call) -> Ranking:
    """Which codes may be answered where several rules hold, and what that assumes about AM-01, AM-04 or AM-38."""
    ranks = {"UpdateMission": _rank_update, "ChargeRobot": _rank_charge}.get(call.request.operation, _rank_create)
    return lambda holding: ranks(robot, holding)


Ranked = Iterator[tuple[str, tuple[Assumption, ...]]]


def _rank_create(_: Situation, holding: tuple[Rule, ...]) -> Ranked:
    """AM-01: the format first, the state first, or the state between shape and goals.

    Where no state forbids the call, there is nothing that could come first.
    """
    if not any(one.kind == STATE for one in holding):
        yield from ((code, ()) for code in dict.fromkeys(str(one.code) for one in holding))
        return
    early = any(one.kind in (SHAPE, EITHER) for one in holding if one.code == INVALID_ARGUMENT)
    sure = any(one.kind == SHAPE for one in holding if one.code == INVALID_ARGUMENT)
    yield INVALID_ARGUMENT, (AM_01["a", "c"] if early else AM_01["a"],)
    yield FAILED_PRECONDITION, (AM_01["b"] if sure else AM_01["b", "c"],)


def _rank_update(robot: Situation, holding: tuple[Rule, ...]) -> Ranked:
    """AM-04: the command, the id or the state is looked at first."""
    for code, about_command in dict.fromkeys((str(one.code), one.kind == SHAPE) for one in holding):
        forbidden = robot.active is None and any(one.code == FAILED_PRECONDITION for one in holding)
        if any(one.name == the_robot_is_on_no_mission.name for one in holding):
            # An id that cannot be read cannot be looked for either.
            yield code, (AM_04["a", "b"] if about_command else AM_04["c"],)
        elif about_command:
            yield code, (AM_04["a"] if forbidden else AM_04["a", "c"],)
        else:
            yield code, (AM_04["b", "c"],)


def _rank_charge(_: Situation, holding: tuple[Rule, ...]) -> Ranked:
    """AM-38: the running mission or the missing charger is answered for."""
    busy = any(one.kind == STATE for one in holding)
    for code, kind in dict.fromkeys((str(one.code), one.kind) for one in holding):
        if not busy or kind == SHAPE:
            yield code, ()
        else:
            yield code, (AM_38_RUNNING["e" if kind == STATE else "f"],)
