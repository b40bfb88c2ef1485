"""When `UpdateMission` is refused: the command, the id, and what the command asks of the mission."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.bear.mission.inputs import Call, Defect, Target
from missionfsm.bear.mission.readings.charging import AM_40
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
from missionfsm.bear.mission.readings.updating import AM_29, AM_31
from missionfsm.bear.mission.rules.aspects import SHAPE, STATE
from missionfsm.bear.mission.rules.situations import is_paused, nothing_listed
from missionfsm.bear.mission.state import MISSION, Kind, Situation
from missionfsm.bear.wire.messages import Command
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.rules import FAILED_PRECONDITION, INVALID_ARGUMENT, NOT_FOUND, Rule, refusal


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
    if call.target in (Target.UNKNOWN, Target.CLEARED) and nothing_listed(robot):
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
    return _asks(call, Command.COMMAND_PAUSE) and is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], assumes=AM_29["resume"]["a"], looks_at=STATE)
def the_mission_is_not_paused(robot: Situation, call: Call) -> bool:
    """The mission is not paused, so it cannot be resumed (AM-29)."""
    return _asks(call, Command.COMMAND_RESUME) and not is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], assumes=AM_31["b"], looks_at=STATE)
def a_paused_mission_cannot_be_finished(robot: Situation, call: Call) -> bool:
    """The mission is paused and must be resumed before it can be finished (AM-31)."""
    return _asks(call, Command.COMMAND_FINISH) and is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["UpdateMission", "Errors"], assumes=AM_40["c"], looks_at=STATE)
def charging_cannot_be_paused(robot: Situation, call: Call) -> bool:
    """The robot is charging, which cannot be paused (AM-40)."""
    charging = robot.active is not None and robot.active.kind is Kind.CHARGE
    return _asks(call, Command.COMMAND_PAUSE) and charging and not is_paused(robot)
