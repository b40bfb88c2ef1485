"""The system ``isaac.server``: its specification, its JSON, and what is worth trying on it."""

from __future__ import annotations

from missionfsm.isaac.server import alphabet, codec, matrix, mutations, pictures, plans, shapes
from missionfsm.isaac.server.spec import SPEC
from missionfsm.isaac.shared.naming import NAMING
from missionfsm.isaac.shared.profiles import SHIPPED_SERVER, profiles
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
    plans=plans.PLANS,
    shapes=shapes.shapes,
    profiles=profiles(SPEC.ambiguities, SHIPPED_SERVER),
    matrix=matrix.MATRIX,
    minutes_at=2,
)
