"""What of the status API is drawn besides the lifecycles of what is reported: what the calls are answered."""

from __future__ import annotations

from missionfsm.bear.status.state import GET, Endpoint, Event, Fleet, Request
from missionfsm.kernel.alphabet import Input
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.picture import Sketch
from missionfsm.kernel.terms import Refs

_OWN, _FOREIGN = "r1", "x1"
_WORLD: JSON = {
    "robots": [
        {"robotId": _OWN, "locationId": "L1", "owned": True, "state": {"connection": {"state": "STATE_CONNECTED"}}},
        {"robotId": _FOREIGN, "locationId": "L1", "owned": False, "state": {}},
    ],
    "locations": [{"locationId": "L1", "owned": True}],
}
_ASKED = {_OWN: "", _FOREIGN: " of another's robot", "": " of no robot", "nobody": " of an unknown robot"}
_PROMPTS = (
    *(Input(GET, {"robotId": robot}) for robot in _ASKED),
    *(Input(Endpoint.ROBOT.value, {"selector": {"robotIds": {"ids": [robot]}}}) for robot in _ASKED),
)
_DRIVES: tuple[JSON, ...] = (
    {"event": "report", "robotId": _OWN, "part": "connection", "value": {"state": "STATE_CONNECTED"}},
    {"event": "report", "robotId": _OWN, "part": "connection", "value": {"state": "STATE_DISCONNECTED"}},
    {"event": "fault", "status": "INTERNAL"},
)


def _node(fleet: Fleet) -> str:
    connection = fleet.robots[0].connection.name.removeprefix("STATE_")
    return f"{connection}, a failure is armed" if fleet.fault else connection


def _label(_: Fleet, what: Request | Event, __: Refs) -> str:
    if isinstance(what, Request):
        return f"{what.operation}{_ASKED[what.ids[0] if what.ids else '']}"
    if what.name == "fault":
        return "a tester arms a failure"
    return f"the robot reports {what.value.state.name}"


SKETCHES = (
    Sketch(
        "calls",
        "what the calls are answered",
        node=_node,
        label=_label,
        within=lambda _: True,
        inputs=_PROMPTS,
        drives=_DRIVES,
        world=_WORLD,
        contrasts=("AS-07.offline=b", "AS-02.GetRobotStatus=b"),
    ),
)
