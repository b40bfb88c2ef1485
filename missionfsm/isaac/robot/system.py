"""The system ``isaac.robot``, put together."""

from __future__ import annotations

from missionfsm.isaac.robot.alphabet import alphabet
from missionfsm.isaac.robot.codec import CODEC
from missionfsm.isaac.robot.mutations import BENDS, TWISTS
from missionfsm.isaac.robot.pictures import SKETCHES
from missionfsm.isaac.robot.shapes import shapes
from missionfsm.isaac.robot.spec import SPEC
from missionfsm.isaac.shared.naming import NAMING
from missionfsm.kernel.system import System

SYSTEM = System(
    SPEC.system, SPEC, CODEC, alphabet, NAMING, bends=BENDS, twists=TWISTS, sketches=SKETCHES, shapes=shapes
)
