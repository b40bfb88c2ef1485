"""What a message of the status stream shows, and when one comes (AM-08, AM-14, AM-35, AM-36, AM-47 to AM-52, AM-54)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import BATCHES, missions_of
from missionfsm.bear.mission.state import Kind
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AM_08 = Ambiguity(
    "AM-08",
    "Which state does a waiting mission report?",
    {"a": "STATE_DEFAULT", "b": "STATE_UNKNOWN or none", "c": "STATE_PAUSED, if the index does not point at it"},
    flagged="bc",
)
AM_14_ENDED = Ambiguity(
    "AM-14.ended",
    "What is current_mission_index when nothing is active and nothing waits?",
    {"a": "-1", "b": "the last mission's"},
    flagged="b",
)
AM_14_GAP = Ambiguity(
    "AM-14.gap",
    "What is current_mission_index when nothing is active but a mission is about to start?",
    {"c": "-1", "d": "the mission before", "e": "the next mission"},
    flagged="de",
)
AM_14_HALTED = Ambiguity(
    "AM-14.halted",
    "What is current_mission_index when nothing is active and missions wait in a halted queue?",
    AM_14_GAP.readings,
    default="c",
    flagged="de",
)
AM_35 = Ambiguity(
    "AM-35",
    "What does a subscriber see after a clear?",
    {"a": "no missions", "c": "one unnamed mission in STATE_DEFAULT"},
)
AM_36 = Ambiguity(
    "AM-36",
    "What is the first message of a robot that never had a mission?",
    {"a": "no missions", "b": "one unnamed mission in STATE_DEFAULT", "c": "none, until there is a mission"},
)
AM_36_CLEARED = Ambiguity(
    "AM-36.cleared",
    "What becomes of the unnamed mission that stands for none when a robot that never had one is cleared?",
    {"a": "it stays", "d": "it is cleared as well"},
)
AM_47_SKIP = Ambiguity(
    "AM-47.skip",
    "Is every change a message?",
    {"a": "yes", "b": "no, only the latest state is sure to be sent"},
)
AM_47_REPEAT = Ambiguity(
    "AM-47.repeat",
    "May a message repeat the one before?",
    {"a": "no", "c": "yes"},
)
AM_49 = Ambiguity(
    "AM-49.timestamp",
    "Does every message say when it was recorded?",
    {"a": "yes", "b": "no, the timestamp may be absent"},
    flagged="b",
)
AM_50_SHAPE = Ambiguity(
    "AM-50.shape",
    "Is the feedback of a Servi or Carti mission a message or a bare enum?",
    {"a": "a message with a status", "b": "a bare enum, which only JSON can say"},
    json_only="b",
)
AM_50_MEMBER = Ambiguity(
    "AM-50.member",
    "Which feedback does a base mission of a Servi or Carti robot report?",
    {"c": "that of the mission's kind", "d": "that of the robot's family"},
    flagged="d",
)
AM_51 = asked_of_each(
    "AM-51",
    "Which mission_type does {} of a Servi or Carti robot report?",
    {"a": "base_type", "b": "the type of the robot's family"},
    missions_of((Kind.BASE_NAVIGATE, Kind.BASE_NAVIGATE_AUTO)),
    flagged="b",
)
AM_52 = Ambiguity(
    "AM-52.change",
    "May a mission that is listed change its owner?",
    {"a": "no", "b": "yes"},
    flagged="b",
)
AM_54 = {
    **asked_of_each(
        "AM-54",
        "Is what {} makes seen all at once?",
        {"a": "yes", "b": "no, it may be seen growing"},
        BATCHES,
        flagged="b",
    ),
    "CreateMissionWorkflow": Ambiguity(
        "AM-54.CreateMissionWorkflow",
        "Are the missions of a workflow seen all at once?",
        {"a": "yes", "b": "no, they may be seen growing"},
    ),
}
