"""Fields and codes that the page does not list (AM-58, AM-61)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import EVERY_CALL
from missionfsm.kernel.readings import Ambiguity, asked_of_each

AM_58 = asked_of_each(
    "AM-58",
    "{}: is a request with an unknown field malformed?",
    {"a": "no, the field is ignored", "b": "yes, INVALID_ARGUMENT"},
    EVERY_CALL,
)
AM_58_SENT = asked_of_each(
    "AM-58.sent",
    "Do {} have fields that are not documented?",
    {"a": "no", "b": "yes"},
    ("answers", "messages"),
    flagged="b",
    alike=False,
)
AM_61 = Ambiguity(
    "AM-61",
    "May codes of the transport and of authentication come that no table lists?",
    {"a": "no", "b": "yes"},
    flagged="b",
)
