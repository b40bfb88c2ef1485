"""JSON Schemas of what the lines of `isaac.server` carry."""

from __future__ import annotations

from missionfsm.isaac.shared.drives import SECONDS
from missionfsm.kernel.shapes import NUMBER, OBJECT, TEXT, Shapes, record

_CONNECTION = {"type": "integer"}
_HANDLES = {"type": "array", "items": {"type": "integer", "minimum": 0}}
_MISSION = {
    "robot": {"type": "string", "minLength": 1},
    "channel": TEXT,
    "status_channel": TEXT,
    "config": OBJECT,
    "start_timeout": SECONDS,
    "timeout": {"anyOf": [SECONDS, {"type": "null"}]},
    "upstream": _HANDLES,
}


def shapes() -> Shapes:
    """The schemas of its world, requests and answers."""
    return Shapes(
        world=record({"nameChannel": {"type": "string", "minLength": 1}, "tolerance": NUMBER}),
        happened={"connect": {"connection": _CONNECTION}},
        requests={"submit": record({"mission": record(_MISSION, ("robot",))}, ("mission",)), "statuses": OBJECT},
        results={
            "submit": record({"mission": {"type": "integer", "minimum": 0}}, ("mission",), more=True),
            "statuses": record(
                {"missions": {"type": "object", "additionalProperties": TEXT}}, ("missions",), more=True
            ),
        },
        lines=True,
        connections=True,
    )
