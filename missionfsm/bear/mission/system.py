"""The system ``bear.mission``: its specification, its JSON, and what is worth trying on it."""

from __future__ import annotations

from missionfsm.bear.mission.alphabet import alphabet
from missionfsm.bear.mission.codec import CODEC
from missionfsm.bear.mission.matrix import MATRIX
from missionfsm.bear.mission.mutations import MESSAGE_MUTATIONS, REACHING, STEP_MUTATIONS
from missionfsm.bear.mission.pictures import SKETCHES
from missionfsm.bear.mission.shapes import shapes
from missionfsm.bear.mission.spec import SPEC
from missionfsm.kernel.alphabet import Naming
from missionfsm.kernel.system import System

NAMING = Naming(given=lambda serial: f"mission-{serial}")
SYSTEM = System(
    SPEC.system,
    SPEC,
    CODEC,
    alphabet,
    NAMING,
    message_mutations=MESSAGE_MUTATIONS,
    step_mutations=STEP_MUTATIONS,
    reaching=REACHING,
    sketches=SKETCHES,
    shapes=shapes,
    matrix=MATRIX,
)
