"""The states in which no mission is added: creating and appending."""

from __future__ import annotations

from missionfsm.bear.mission.inputs import Call
from missionfsm.bear.mission.readings.queue import AM_06, AM_07
from missionfsm.bear.mission.readings.scope import BLOCKED, GAP, HALTED
from missionfsm.bear.mission.rules.aspects import ABILITY, STATE
from missionfsm.bear.mission.rules.situations import about_waiting, is_paused, nothing_listed
from missionfsm.bear.mission.state import MISSION, Situation
from missionfsm.bear.wire.messages import State
from missionfsm.kernel.rules import FAILED_PRECONDITION, INTERNAL, INVALID_ARGUMENT, refusal


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
    return is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionWorkflow", "Errors"], looks_at=STATE)
def another_mission_is_active(robot: Situation, _: Call) -> bool:
    """A mission is running or paused, so a workflow cannot be created."""
    return robot.active is not None


WORKFLOW_WHILE_WAITING = about_waiting(
    "CreateMissionWorkflow",
    {where: one["a"] for where, one in AM_07.items()},
    (GAP, "another-mission-is-queued", "A mission waits, which forbids a workflow as it forbids a mission (AM-07)."),
    (HALTED, "another-mission-waits-in-a-halted-queue", "A mission waits in a halted queue (AM-07)."),
    (BLOCKED, "another-mission-cannot-start", "A mission waits that the robot is unable to start (AM-07)."),
)
WORKFLOW_UNFIT = about_waiting(
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


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], looks_at=ABILITY)
def the_robot_is_unable_to_start(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission."""
    return robot.world.blocked


@refusal(FAILED_PRECONDITION, cite=MISSION["CreateMissionBatch", "Errors"], looks_at=ABILITY)
def the_robot_is_unable_to_start_any_mission(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, which forbids every call that creates a first one (AM-53)."""
    return robot.world.blocked


@refusal(INTERNAL, cite=MISSION["CreateMissionBatch", "Errors"], looks_at=ABILITY)
def the_mission_system_cannot_start_a_mission(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, which is taken for a failure of the mission system (AM-53)."""
    return robot.world.blocked


@refusal(INVALID_ARGUMENT, cite=MISSION["CreateMissionWorkflow", "Errors"], looks_at=ABILITY)
def the_workflow_does_not_fit_a_robot_that_cannot_start(robot: Situation, _: Call) -> bool:
    """The robot is unable to start a mission, which makes a workflow invalid (AM-53)."""
    return robot.world.blocked


@refusal(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], looks_at=STATE)
def the_mission_queue_is_empty(robot: Situation, _: Call) -> bool:
    """No mission is listed, so there is nothing to append to."""
    return nothing_listed(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], looks_at=STATE)
def every_mission_has_ended(robot: Situation, _: Call) -> bool:
    """Every listed mission has ended, and those are not in the queue any more (AM-11)."""
    return robot.active is None and not robot.queued and robot.ended


@refusal(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], looks_at=STATE)
def no_mission_is_running(robot: Situation, _: Call) -> bool:
    """The active mission is paused, and only a running one can be appended to (AM-12)."""
    return is_paused(robot)


@refusal(FAILED_PRECONDITION, cite=MISSION["AppendMission", "Errors"], looks_at=STATE)
def the_queue_is_halted(robot: Situation, _: Call) -> bool:
    """The queue is halted, and only a running mission can be appended to (AM-12)."""
    return robot.active is None and robot.queued and robot.halted
