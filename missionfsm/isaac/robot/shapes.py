"""JSON Schemas of what the lines of `isaac.robot` carry besides its drives."""

from __future__ import annotations

from missionfsm.kernel.shapes import Shapes, record

_NAME = {"type": "string", "minLength": 1}


def shapes() -> Shapes:
    """The schema of its world."""
    return Shapes(world=record(dict.fromkeys(("name", "channel", "statusChannel", "nameChannel"), _NAME)), lines=True)
