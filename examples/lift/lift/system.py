"""The lift as a system: its specification, its JSON, and what is worth trying."""

from __future__ import annotations

from lift.codec import CODEC
from lift.spec import ARRIVAL, NAME, SPEC
from missionfsm.kernel.alphabet import Alphabet, Bounds, Line, Prompt, pick
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System


def alphabet(_world: JSON, _bounds: Bounds) -> Alphabet:
    """What is worth trying."""
    calls = tuple(Prompt("Call", {"floor": floor}) for floor in (0, 1, 2))
    cancel, watch = Prompt("Cancel", {"ride": pick("ride")}), Prompt("Watch", {})
    drives = ({"event": ARRIVAL.name},)
    full = (*(Line("Call", {"floor": floor}) for floor in (0, 1, 2, 3)), Line("settle"))
    return Alphabet(
        prompts=(*calls, Prompt("Call", {"floor": 4}), Prompt("Call", {"floor": "one"}), cancel, watch),
        plain=(*calls[:2], cancel),
        drives=drives,
        plain_drives=drives,
        worlds=({},),
        wrong_names=("no-such-ride",),
        look=watch,
        scripts=((Line("Watch", {}), *full, Line("Cancel", {"ride": pick("ride")}, ((0, 2),)), Line("settle")),),
    )


SYSTEM = System(NAME, SPEC, CODEC, alphabet)
