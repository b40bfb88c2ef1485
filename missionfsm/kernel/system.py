"""A system as the tools see it: a specification, how its JSON is read, and what is worth trying."""

from __future__ import annotations

from collections.abc import Callable

from attrs import frozen

from missionfsm.kernel.alphabet import Alphabet, Bounds, Naming
from missionfsm.kernel.codec import JSON, Codec
from missionfsm.kernel.spec import Spec


@frozen(eq=False)
class System:
    """A specification, how its JSON is read, and what is worth trying (in a world, within bounds)."""

    name: str
    spec: Spec
    codec: Codec
    alphabet: Callable[[JSON, Bounds], Alphabet]
    naming: Naming = Naming()
