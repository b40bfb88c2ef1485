"""The system ``isaac.robot``, put together."""

from __future__ import annotations

from missionfsm.isaac.robot import alphabet, codec, matrix, mutations, pictures, shapes
from missionfsm.isaac.robot.spec import SPEC
from missionfsm.isaac.shared.naming import NAMING
from missionfsm.isaac.shared.profiles import SHIPPED_ROBOT, profiles
from missionfsm.kernel.system import System

SYSTEM = System(
    SPEC.system,
    SPEC,
    codec.CODEC,
    alphabet.alphabet,
    NAMING,
    message_mutations=mutations.MESSAGE_MUTATIONS,
    step_mutations=mutations.STEP_MUTATIONS,
    sketches=pictures.SKETCHES,
    shapes=shapes.shapes,
    profiles=profiles(SPEC.ambiguities, SHIPPED_ROBOT),
    matrix=matrix.MATRIX,
)
