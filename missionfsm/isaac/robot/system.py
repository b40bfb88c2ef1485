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
from missionfsm.isaac.shared.profiles import AS_SHIPPED, DOCUMENTED, SHIPPED_ROBOT
from missionfsm.kernel.readings import to_the_letter
from missionfsm.kernel.system import System

PROFILES = {DOCUMENTED: to_the_letter(SPEC.ambiguities), AS_SHIPPED: SHIPPED_ROBOT}

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
    profiles=PROFILES,
    matrix=MATRIX,
)
