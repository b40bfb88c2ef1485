"""The ten operations of the Mission page: what each refuses and promises, and which refusal comes first."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Mapping

from attrs import evolve

from missionfsm.bear.mission.inputs import Call
from missionfsm.bear.mission.readings.charging import AM_38_BUSY, DOCK, LOCATION
from missionfsm.bear.mission.readings.codes import AM_01, AM_01_BLOCKED, AM_04, AM_04_NO_ID
from missionfsm.bear.mission.readings.goals import AM_41, AM_43, AM_44, AM_44_AUTOMATIC, AM_45_REFUSED
from missionfsm.bear.mission.readings.queue import AM_11, AM_12_HALTED, AM_12_PAUSED
from missionfsm.bear.mission.readings.starting import AM_53
from missionfsm.bear.mission.readings.unlisted import AM_58
from missionfsm.bear.mission.rules import (
    ABILITY,
    CHARGING,
    CHARGING_WHILE_WAITING,
    CLEARING_WHILE_WAITING,
    EITHER,
    FORM,
    GOALS,
    LAST_GOAL,
    NO_DOCK,
    SHAPE,
    STATE,
    TAKEN,
    WORKFLOW_UNFIT,
    WORKFLOW_WHILE_WAITING,
    WRONG_ID,
    a_destination_is_not_on_the_map,
    a_field_is_unknown,
    a_goal_is_invalid,
    a_goal_occurs_twice,
    a_goal_occurs_twice_in_the_list,
    a_mission_could_not_start_now,
    a_mission_is_paused,
    a_mission_is_running,
    a_mission_is_running_or_paused,
    a_paused_mission_cannot_be_finished,
    a_paused_mission_counts_as_running,
    another_mission_is_active,
    another_mission_is_active_or_queued,
    another_mission_is_running_or_queued,
    charging_cannot_be_paused,
    every_mission_has_ended,
    id_situation,
    no_goal_is_free,
    no_goal_is_free_now,
    no_goal_is_free_to_start_with,
    no_mission_is_running,
    nothing_is_listed,
    nothing_was_ever_listed,
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
    the_mission_system_cannot_start_a_mission,
    the_queue_is_halted,
    the_request_is_empty,
    the_request_is_malformed,
    the_robot_is_not_on_a_mission,
    the_robot_is_of_another_family,
    the_robot_is_on_no_mission,
    the_robot_is_unable_to_start,
    the_robot_is_unable_to_start_any_mission,
    the_robot_is_unable_to_start_charging,
    the_workflow_does_not_fit_a_robot_that_cannot_start,
    the_workflow_is_for_another_family,
    there_is_nothing_to_clear,
    there_never_was_anything_to_clear,
)
from missionfsm.bear.mission.state import MISSION, SYSTEM_NAME, Situation
from missionfsm.bear.wire.messages import Command
from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.rules import (
    DEADLINE_EXCEEDED,
    INTERNAL,
    INVALID_ARGUMENT,
    Decision,
    Operation,
    Rule,
    decide,
    promise,
)


def _under(rule: Rule, assumption: Assumption) -> Rule:
    """A refusal that holds under a reading."""
    return evolve(rule, assumes=assumption)


def _format(operation: str) -> tuple[Rule, ...]:
    return (
        the_request_is_empty,
        the_request_is_malformed,
        a_goal_is_invalid,
        the_goals_do_not_match_the_mission_type,
        _under(a_destination_is_not_on_the_map, AM_43[operation]["a"]),
        _under(a_goal_occurs_twice, AM_44[operation]["i"]),
        _under(a_field_is_unknown, AM_58[operation]["b"]),
    )


def _mission(operation: str) -> tuple[Rule, ...]:
    return (
        *_format(operation),
        _under(a_goal_occurs_twice_in_the_list, AM_44_AUTOMATIC[operation]["i"]),
        _under(the_mission_is_for_another_family, AM_41[operation]["a"]),
        _under(the_robot_is_of_another_family, AM_41[operation]["b"]),
        _under(no_goal_is_free, AM_45_REFUSED[operation]["c"]),
        _under(no_goal_is_free_now, AM_45_REFUSED[operation]["c"]),
        _under(no_goal_is_free_to_start_with, AM_45_REFUSED[operation]["s"]),
        _under(a_mission_could_not_start_now, AM_45_REFUSED[operation]["s"]),
    )


def _append(operation: str) -> tuple[Rule, ...]:
    return (
        *_mission(operation),
        the_mission_queue_is_empty,
        _under(every_mission_has_ended, AM_11[operation]["b"]),
        _under(no_mission_is_running, AM_12_PAUSED[operation]["b"]),
        _under(the_queue_is_halted, AM_12_HALTED[operation]["b"]),
    )


def _no_fields(operation: str) -> tuple[Rule, ...]:
    return (the_request_is_malformed, _under(a_field_is_unknown, AM_58[operation]["b"]))


_COMMAND_REFUSALS = (the_mission_is_already_paused, the_mission_is_not_paused, a_paused_mission_cannot_be_finished)
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
"""Calls without fields whose tables have no row for INVALID_ARGUMENT: that a request is not of the documented form,
their section about the request says."""


def _at_home(name: str, one: Rule) -> Rule:
    """A refusal that several calls share, cited from the table of this one.

    Whether a robot is able to start is a question of one table alone; where it refuses other calls as well, that table
    is what it is cited from.
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
                another_mission_is_active_or_queued,
                _under(the_robot_is_unable_to_start_any_mission, AM_53["CreateMission"]["a"]),
                _under(the_mission_system_cannot_start_a_mission, AM_53["CreateMission"]["i"]),
            ),
            _ONE_ID,
        ),
        _operation(
            "CreateMissionBatch",
            (
                *_mission("CreateMissionBatch"),
                another_mission_is_running_or_queued,
                a_paused_mission_counts_as_running,
                the_robot_is_unable_to_start,
            ),
            _ALL_IDS,
        ),
        _operation(
            "CreateMissionWorkflow",
            (
                *_format("CreateMissionWorkflow"),
                the_workflow_is_for_another_family,
                another_mission_is_active,
                *WORKFLOW_WHILE_WAITING,
                *WORKFLOW_UNFIT,
                _under(the_robot_is_unable_to_start_any_mission, AM_53["CreateMissionWorkflow"]["a"]),
                _under(the_mission_system_cannot_start_a_mission, AM_53["CreateMissionWorkflow"]["i"]),
                _under(the_workflow_does_not_fit_a_robot_that_cannot_start, AM_53["CreateMissionWorkflow"]["v"]),
            ),
            _WORKFLOW_IDS,
        ),
        _operation("AppendMission", _append("AppendMission"), _APPENDED, _ONE_ID),
        _operation("AppendMissionBatch", _append("AppendMissionBatch"), _APPENDED, _ALL_IDS),
        _operation(
            "ChargeRobot",
            (
                *_no_fields("ChargeRobot"),
                a_mission_is_running,
                a_mission_is_paused,
                *CHARGING_WHILE_WAITING,
                _under(the_robot_is_unable_to_start_charging, AM_53["ChargeRobot"]["a"]),
                _under(the_mission_system_cannot_start_a_mission, AM_53["ChargeRobot"]["i"]),
                *NO_DOCK,
                the_map_has_no_charging_location,
            ),
            _ONE_ID,
        ),
        _operation(
            "ClearMissionStatus",
            (
                *_no_fields("ClearMissionStatus"),
                a_mission_is_running_or_paused,
                nothing_is_listed,
                there_is_nothing_to_clear,
                nothing_was_ever_listed,
                there_never_was_anything_to_clear,
                *CLEARING_WHILE_WAITING,
            ),
            _CLEARED,
            failures=(INTERNAL,),
        ),
        _operation(
            "SkipGoal",
            (
                *_no_fields("SkipGoal"),
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
                _under(a_field_is_unknown, AM_58["UpdateMission"]["b"]),
                the_robot_is_on_no_mission,
                the_mission_is_still_queued,
                *WRONG_ID,
                *_COMMAND_REFUSALS,
                charging_cannot_be_paused,
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


def decisions(holding: tuple[Rule, ...], robot: Situation, call: Call) -> tuple[Decision, ...]:
    """What may be answered where some rules hold, and what that assumes about AM-01, AM-04 or AM-38."""
    operation = call.request.operation
    return _decisions(operation, id_situation(robot, call) if operation == "UpdateMission" else "", holding)


@functools.lru_cache(maxsize=10_000)
def _decisions(operation: str, about: str, holding: tuple[Rule, ...]) -> tuple[Decision, ...]:
    if operation == "UpdateMission":
        return decide(holding, functools.partial(_rank_update, about))
    if operation == "ChargeRobot":
        return decide(holding, _rank_charge)
    return decide(holding, functools.partial(_rank_format_and_state, operation))


Ranked = Iterator[tuple[str, tuple[Assumption, ...]]]


def _codes(holding: Iterable[Rule]) -> Iterator[str]:
    return iter(dict.fromkeys(str(one.code) for one in holding))


def _rank_format_and_state(operation: str, holding: tuple[Rule, ...]) -> Ranked:
    """AM-01: the format first, the state first, or the state between shape and goals.

    Where no state forbids the call, there is nothing that could come first. What cannot be decoded is
    INVALID_ARGUMENT whatever is looked at first, since there is no request to look at anything for; what others have
    taken may be looked at whenever an implementation likes.
    """
    forbidding = tuple(_forbidding(operation, holding))
    looked_at = {one.looks_at for one in holding if one.code == INVALID_ARGUMENT}
    invalid = looked_at - {TAKEN}
    if not forbidding or not invalid:
        yield from ((code, ()) for code in _codes(holding))
        return
    if not looked_at.isdisjoint((FORM, TAKEN)):
        yield INVALID_ARGUMENT, ()
    sure = not invalid.isdisjoint((FORM, SHAPE))  # of EITHER nobody knows whether it is noticed so early
    early = sure or EITHER in invalid
    about = dict.fromkeys(ambiguity for _, ambiguity in forbidding)
    yield INVALID_ARGUMENT, tuple(_format_first(one, early=early) for one in about)
    if FORM not in invalid:
        yield from _of_the_family(holding)
    for code, one in forbidding:
        yield code, (one["b"] if sure or "c" not in one.readings else one["b", "c"],)


def _format_first(ambiguity: Ambiguity, *, early: bool) -> Assumption:
    """The readings of a part of AM-01 under which a format that is looked at so early comes before the state."""
    return ambiguity["a", "c"] if early and "c" in ambiguity.readings else ambiguity["a"]


def _of_the_family(holding: tuple[Rule, ...]) -> Ranked:
    """AM-41: what is told by the family of the robot is neither the format nor the state of its missions."""
    yield from (
        (code, ()) for code in _codes(one for one in holding if one.looks_at == EITHER and one.code != INVALID_ARGUMENT)
    )


def _forbidding(operation: str, holding: tuple[Rule, ...]) -> Iterator[tuple[str, Ambiguity]]:
    """The codes by which a state forbids the call, each with the part of AM-01 that ranks it against the format."""
    for looked_at, ambiguity in ((STATE, AM_01[operation]), (ABILITY, AM_01_BLOCKED.get(operation))):
        if ambiguity is not None:
            yield from ((code, ambiguity) for code in _codes(one for one in holding if one.looks_at == looked_at))


def _rank_update(situation: str, holding: tuple[Rule, ...]) -> Ranked:
    """AM-04: the command or the id is answered for."""
    about = AM_04_NO_ID if situation == AM_04_NO_ID.id.partition(".")[2] else AM_04.get(situation)
    for code, looked_at in dict.fromkeys((str(one.code), one.looks_at) for one in holding):
        if about is None or looked_at == FORM:
            yield code, ()
        else:
            yield code, (about["a"] if looked_at == SHAPE else about.besides("a"),)


_BUSY = {
    a_mission_is_running.name: "running",
    a_mission_is_paused.name: "paused",
}
"""What forbids to charge whatever the robot is equipped with: parts of AM-38.

Missions that wait and a robot that is unable to start one are not ranked: they are seldom met together with a charger
that is missing, and each may be read in several ways already.
"""


def _rank_charge(holding: tuple[Rule, ...]) -> Ranked:
    """AM-38: the mission is answered for, or what is missing."""
    left = tuple(one for one in holding if one.looks_at != FORM)
    late: tuple[Assumption, ...] = ()
    if left != holding:
        yield INVALID_ARGUMENT, ()
        late = (AM_01["ChargeRobot"]["b"],)
    yield from ((code, (*late, *assumes)) for code, assumes in _rank_busy(left))


def _rank_busy(holding: tuple[Rule, ...]) -> Ranked:
    busy = {_BUSY[one.name]: str(one.code) for one in holding if one.name in _BUSY}
    missing = {_missing(one): str(one.code) for one in holding if one.looks_at == GOALS}
    ranked = busy and missing
    others = [one for one in holding if not (ranked and (one.looks_at == GOALS or one.name in _BUSY))]
    yield from ((code, ()) for code in _codes(others))
    if ranked:
        yield from _busy_or_missing(busy, missing)


def _busy_or_missing(busy: Mapping[str, str], missing: Mapping[str, str]) -> Ranked:
    """AM-38 for what a robot is busy with and what it lacks, each with its code."""
    for code in busy.values():
        yield code, tuple(AM_38_BUSY[state][what]["e"] for what in missing for state in busy)
    for what, code in missing.items():
        yield code, tuple(AM_38_BUSY[state][what]["f"] for state in busy)


def _missing(rule: Rule) -> str:
    """What a robot lacks of which a rule says that it cannot charge: its dock, or its location."""
    return DOCK if rule.name == NO_DOCK[0].name else LOCATION
