"""The system ``isaac.server``: its specification, its JSON, and what is worth trying on it."""

from __future__ import annotations

from missionfsm.isaac.server.alphabet import alphabet
from missionfsm.isaac.server.codec import CODEC
from missionfsm.isaac.server.matrix import MATRIX
from missionfsm.isaac.server.mutations import MESSAGE_MUTATIONS, STEP_MUTATIONS
from missionfsm.isaac.server.pictures import SKETCHES
from missionfsm.isaac.server.plans import PLANS
from missionfsm.isaac.server.shapes import shapes
from missionfsm.isaac.server.spec import SPEC
from missionfsm.isaac.shared.naming import NAMING
from missionfsm.isaac.shared.profiles import SHIPPED_SERVER, profiles
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
    plans=PLANS,
    shapes=shapes,
    profiles=profiles(SPEC.ambiguities, SHIPPED_SERVER),
    matrix=MATRIX,
    minutes_at=2,
)
