"""Which missions and goals a robot takes (AM-41, AM-43 to AM-45)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import APPENDING, BATCHES, CREATING, missions_of
from missionfsm.bear.mission.state import AUTOMATIC, Kind
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AM_41 = asked_of_each(
    "AM-41",
    "A mission is for another family: what does {} answer?",
    {
        "a": "INVALID_ARGUMENT",
        "b": "FAILED_PRECONDITION",
        "c": "OK, and the mission fails when it is started",
        "d": "OK, and the mission fails on the way",
    },
    (*BATCHES, "CreateMission", "AppendMission"),
    flagged="cd",
)
AM_43 = asked_of_each(
    "AM-43",
    "{}: a destination is not on the map: when is it refused?",
    {
        "a": "at once, INVALID_ARGUMENT",
        "b": "the mission is accepted and fails when it is started",
        "d": "the mission is accepted and fails on the way",
    },
    (*CREATING, *APPENDING),
    flagged="bd",
)
AM_43_CASE = asked_of_each(
    "AM-43.case",
    "{}: only the case of a destination differs from one on the map: what becomes of it?",
    {
        "a": "it is refused, INVALID_ARGUMENT",
        "b": "the mission is accepted and fails when it is started",
        "d": "the mission is accepted and fails on the way",
        "f": "it is taken for the one on the map, and shown as it was asked for",
        "m": "it is taken for the one on the map, and shown as it is spelt there",
    },
    (*CREATING, *APPENDING),
    flagged="bdfm",
)
AM_43_LEFT = Ambiguity(
    "AM-43.left",
    "What becomes of a mission under way of which a goal leaves the map?",
    {"a": "it goes on", "e": "it may fail", "p": "the goal is passed over; where none is left, the mission fails"},
)
AM_44 = asked_of_each(
    "AM-44",
    "{}: may a goal occur twice in one mission?",
    {"a": "yes", "i": "no, INVALID_ARGUMENT"},
    (*CREATING, *APPENDING),
)
AM_44_AUTOMATIC = asked_of_each(
    "AM-44.automatic",
    "{}: may a goal occur twice in the list of a NavigateAuto mission?",
    {"a": "yes", "i": "no, INVALID_ARGUMENT"},
    (*BATCHES, "CreateMission", "AppendMission"),
)
AM_45_NONE = asked_of_each(
    "AM-45.none",
    "What does {} do when it is to start and no goal is free?",
    {"a": "it waits, running", "b": "it fails", "d": "it takes the first goal"},
    missions_of(kind for kind in Kind if kind in AUTOMATIC),
)
AM_45_AGAIN = asked_of_each(
    "AM-45.none.again",
    "What does {} do when it selects again and no goal is free then?",
    {"a": "it stays as it is, or waits, running", "b": "it fails", "d": "it takes the first goal"},
    missions_of(kind for kind in Kind if kind in AUTOMATIC),
)
AM_45_REFUSED = asked_of_each(
    "AM-45.none.refused",
    "{}: is a NavigateAuto mission refused of which no goal is free?",
    {
        "a": "no",
        "c": "yes, INVALID_ARGUMENT or FAILED_PRECONDITION",
        "s": "yes, INVALID_ARGUMENT or FAILED_PRECONDITION, where it would start at once",
    },
    (*BATCHES, "CreateMission", "AppendMission"),
)
AM_45_WHEN = asked_of_each(
    "AM-45.when",
    "When does {} select its goal?",
    {
        "h": "when it is created",
        "i": "when it starts",
        "j": "when it starts, and again on the way",
        "o": "when it starts, and again where another robot takes its goal",
    },
    missions_of(kind for kind in Kind if kind in AUTOMATIC),
    default="i",
)
