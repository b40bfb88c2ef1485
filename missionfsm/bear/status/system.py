"""The system ``bear.status``: its specification, its JSON, and what is worth trying on it."""

from __future__ import annotations

from missionfsm.bear.status.alphabet import alphabet
from missionfsm.bear.status.codec import CODEC
from missionfsm.bear.status.matrix import MATRIX
from missionfsm.bear.status.mutations import MESSAGE_MUTATIONS, STEP_MUTATIONS
from missionfsm.bear.status.pictures import SKETCHES
from missionfsm.bear.status.shapes import shapes
from missionfsm.bear.status.spec import SPEC
from missionfsm.bear.status.state import SYSTEM_NAME as NAME
from missionfsm.kernel.system import System

SYSTEM = System(
    NAME,
    SPEC,
    CODEC,
    alphabet,
    message_mutations=MESSAGE_MUTATIONS,
    step_mutations=STEP_MUTATIONS,
    sketches=SKETCHES,
    shapes=shapes,
    matrix=MATRIX,
)

__all__ = ["SYSTEM"]
