"""JSON Schemas of what the lines of `bear.mission` carry."""

from __future__ import annotations

from typing import Any

from missionfsm.bear.mission.codec import RESULTS, STREAMS
from missionfsm.bear.mission.request_codec import REQUESTS
from missionfsm.bear.mission.state import Family
from missionfsm.bear.wire.messages import Empty, FamilyStatus, MissionStatus
from missionfsm.bear.wire.schema import names_of, reference
from missionfsm.kernel.rules import DEADLINE_EXCEEDED, INTERNAL
from missionfsm.kernel.shapes import BOOLEAN, TEXT, Shapes, record

_TEXTS = {"type": "array", "items": TEXT}
_CHANGING = {
    "contactDock": BOOLEAN,
    "chargingLocation": BOOLEAN,
    "destinations": _TEXTS,
    "occupied": _TEXTS,
    "blocked": BOOLEAN,
}


def _drive(event: str, **fields: object) -> dict[str, Any]:
    return record({"event": {"const": event}, **fields}, ("event", *(("status",) if "status" in fields else ())))


def shapes() -> Shapes:
    """The schemas of its world, drives, requests, answers and messages."""
    found: dict[str, Any] = {}
    message = reference(MissionStatus, found)
    feedback = found["MissionFeedback"]["properties"]
    for name in ("servi_feedback", "carti_feedback", "serviFeedback", "cartiFeedback"):  # AM-50: or the bare status
        feedback[name] = {"anyOf": [feedback[name], names_of(FamilyStatus)]}
    return Shapes(
        world=record({"family": {"enum": [one.value for one in Family]}, **_CHANGING}),
        drives={
            "goalReached": _drive("goalReached"),
            "missionSucceeded": _drive("missionSucceeded"),
            "missionFailed": _drive("missionFailed"),
            "world": _drive("world", **_CHANGING),
            "fault": _drive("fault", status={"enum": [INTERNAL, DEADLINE_EXCEEDED]}, applied=BOOLEAN),
        },
        requests={method: reference(kind, found) for method, kind in REQUESTS.items()},
        results={method: reference(RESULTS.get(method, Empty), found) for method in REQUESTS if method not in STREAMS},
        messages=(message,),
        definitions=found,
    )
