"""JSON Schemas of what the lines of `bear.status` carry."""

from __future__ import annotations

from typing import Any

from missionfsm.bear.status import messages as wire
from missionfsm.bear.status.codec import STREAMS
from missionfsm.bear.status.state import GET, MAPS, Endpoint
from missionfsm.bear.wire.schema import reference
from missionfsm.kernel.shapes import BOOLEAN, TEXT, Shapes, record

_SINGLES = (wire.BatteryMessage, wire.NavigationMessage, wire.RobotMessage)
_ENTRIES = {
    Endpoint.ERRORS: wire.ErrorCodesEntry,
    Endpoint.NETWORK: wire.NetworkEntry,
    Endpoint.ONLINE: wire.OnlineEntry,
}


def shapes() -> Shapes:
    """The schemas of its world, requests, answers and messages."""
    found: dict[str, Any] = {}
    robot = {
        "robotId": TEXT,
        "locationId": TEXT,
        "owned": BOOLEAN,
        "state": {"anyOf": [reference(wire.RobotState, found), {"type": "null"}]},
        "wifi": {"anyOf": [reference(wire.Wifi, found), {"type": "null"}]},
    }
    location = record({"locationId": TEXT, "owned": BOOLEAN}, ("locationId",))
    maps = (
        record({name: {"type": "object", "additionalProperties": reference(_ENTRIES[endpoint], found)}}, more=True)
        for endpoint, name in MAPS.items()
    )
    return Shapes(
        world=record(
            {
                "robots": {"type": "array", "items": record(robot, ("robotId", "locationId"))},
                "locations": {"type": "array", "items": location},
            }
        ),
        requests={
            GET: reference(wire.StatusRequest, found),
            **{method: reference(wire.SubscribeRequest, found) for method in STREAMS},
        },
        results={GET: reference(wire.StatusResponse, found)},
        messages=(*(reference(kind, found) for kind in _SINGLES), *maps),
        definitions=found,
    )
