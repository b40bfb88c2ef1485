"""JSON Schemas of what the lines of `isaac.robot` carry besides its drives."""

from __future__ import annotations

from missionfsm.isaac.robot.codec import WORLD
from missionfsm.kernel.shapes import Shapes, record


def shapes() -> Shapes:
    """The schema of its world."""
    return Shapes(world=record(WORLD.members), lines=True)
