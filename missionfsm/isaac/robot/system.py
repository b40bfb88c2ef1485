"""The system ``isaac.robot``, put together."""

from __future__ import annotations

from missionfsm.isaac.robot.alphabet import alphabet
from missionfsm.isaac.robot.codec import CODEC
from missionfsm.isaac.robot.matrix import MATRIX
from missionfsm.isaac.robot.mutations import MESSAGE_MUTATIONS, STEP_MUTATIONS
from missionfsm.isaac.robot.pictures import SKETCHES
from missionfsm.isaac.robot.shapes import shapes
from missionfsm.isaac.robot.spec import SPEC
from missionfsm.isaac.shared.naming import NAMING
from missionfsm.isaac.shared.profiles import SHIPPED_ROBOT, profiles
from missionfsm.kernel.system import System

SYSTEM = System(
    SPEC.system,
    SPEC,
    CODEC,
    alphabet,
    NAMING,
    message_mutations=MESSAGE_MUTATIONS,
    step_mutations=STEP_MUTATIONS,
    sketches=SKETCHES,
    shapes=shapes,
    profiles=profiles(SPEC.ambiguities, SHIPPED_ROBOT),
    matrix=MATRIX,
)
