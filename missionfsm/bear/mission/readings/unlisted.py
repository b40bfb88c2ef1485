"""Fields and codes that the page does not list (AM-58, AM-61)."""

from __future__ import annotations

from missionfsm.bear.mission.readings.scope import EVERY_CALL
from missionfsm.kernel.readings import Ambiguity, asked_of_each

_UNKNOWN_FIELD = "{}: is a request with an unknown field malformed?"
_MALFORMED = {"a": "no, the field is ignored", "b": "yes, INVALID_ARGUMENT"}
_UNLISTED = ("ChargeRobot", "SkipGoal")
"""The calls whose tables have no row for INVALID_ARGUMENT: they may well be read otherwise than the others."""

AM_58 = {
    **asked_of_each("AM-58", _UNKNOWN_FIELD, _MALFORMED, (one for one in EVERY_CALL if one not in _UNLISTED)),
    **asked_of_each("AM-58", _UNKNOWN_FIELD, _MALFORMED, _UNLISTED, alike=False),
}
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
