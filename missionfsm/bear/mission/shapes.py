"""JSON Schemas of what the lines of `bear.mission` carry."""

from __future__ import annotations

from typing import Any

from missionfsm.bear.mission.codec import RESULTS, STREAMS, WORLD
from missionfsm.bear.mission.request_codec import REQUESTS
from missionfsm.bear.wire.messages import Empty, FamilyStatus, MissionStatus
from missionfsm.bear.wire.schema import names_of, reference
from missionfsm.kernel.shapes import Shapes, record


def shapes() -> Shapes:
    """The schemas of its world, requests, answers and messages."""
    found: dict[str, Any] = {}
    message = reference(MissionStatus, found)
    feedback = found["MissionFeedback"]["properties"]
    for name in ("servi_feedback", "carti_feedback", "serviFeedback", "cartiFeedback"):  # AM-50: or the bare status
        feedback[name] = {"anyOf": [feedback[name], names_of(FamilyStatus)]}
    return Shapes(
        world=record(WORLD.members),
        requests={method: reference(kind, found) for method, kind in REQUESTS.items()},
        results={method: reference(RESULTS.get(method, Empty), found) for method in REQUESTS if method not in STREAMS},
        messages=(message,),
        definitions=found,
    )
