"""JSON Schemas of what the lines of `isaac.robot` carry."""

from __future__ import annotations

from missionfsm.isaac.robot.inputs import NAMED_ONLY
from missionfsm.isaac.shared.schema import LINE_DRIVES, drive
from missionfsm.kernel.shapes import Shapes, record

_NAME = {"type": "string", "minLength": 1}


def shapes() -> Shapes:
    """The schemas of its world and drives."""
    return Shapes(
        world=record(dict.fromkeys(("name", "channel", "statusChannel", "nameChannel"), _NAME)),
        drives={**LINE_DRIVES, **{event: drive(event) for event in NAMED_ONLY}},
        lines=True,
    )
