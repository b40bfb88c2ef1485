"""What a question ranges over, part by part: calls, kinds of missions, and what keeps missions waiting."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from missionfsm.bear.mission.state import Kind

CREATING = ("CreateMission", "CreateMissionBatch", "CreateMissionWorkflow")
APPENDING = ("AppendMission", "AppendMissionBatch")
BATCHES = ("CreateMissionBatch", "AppendMissionBatch")
ADDING = (*CREATING, *APPENDING, "ChargeRobot")
FIELDLESS = ("ChargeRobot", "ClearMissionStatus", "SkipGoal")
EVERY_CALL = (*CREATING, *APPENDING, *FIELDLESS, "UpdateMission", "SubscribeMissionStatus")
WORKFLOWS = (
    Kind.SERVI_DELIVERY,
    Kind.SERVI_DELIVERY_PATROL,
    Kind.SERVI_BUSSING,
    Kind.SERVI_BUSSING_PATROL,
    Kind.SERVI_BIRTHDAY,
    Kind.SERVI_HOSTING,
    Kind.SERVI_HOSTING_PATROL,
    Kind.CARTI_TRAVERSE,
    Kind.CARTI_TRAVERSE_PATROL,
)
GAP, HALTED, BLOCKED = "gap", "halted", "blocked"
WAITING: Mapping[str, str] = {
    GAP: "the next mission is about to start",
    HALTED: "the queue is halted",
    BLOCKED: "the robot is unable to start the next mission",
}
"""Situations in which missions wait and none is active."""


def part_of(kind: Kind) -> str:
    """What a kind of missions is called in the id of an ambiguity."""
    return kind.value.replace(" ", "-")


def missions_of(kinds: Iterable[Kind]) -> Mapping[str, str]:
    """The parts of a question that is asked of some kinds of missions."""
    return {part_of(kind): f"a {kind.value} mission" for kind in kinds}
