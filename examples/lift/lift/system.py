"""The lift as a system: its specification, its JSON, and what is worth trying."""

from __future__ import annotations

from lift.codec import CODEC
from lift.spec import NAME, SPEC
from missionfsm.kernel.language import JSON, Alphabet, Bounds, Input, ScriptStep, System, every_state, pick


def alphabet(_world: JSON, _bounds: Bounds) -> Alphabet:
    """What is worth trying."""
    calls = tuple(Input("Call", {"floor": floor}) for floor in (0, 1, 2))
    cancel, watch = Input("Cancel", {"ride": pick("ride")}), Input("Watch", {})
    full = (*(ScriptStep("Call", {"floor": floor}) for floor in (0, 1, 2, 3)), ScriptStep("settle"))
    return Alphabet(
        inputs=(*calls, Input("Call", {"floor": 4}), Input("Call", {"floor": "one"}), cancel, watch),
        core_inputs=(*calls[:2], cancel),
        drives=({"event": "arrive"},),
        wrong_names=("no-such-ride",),
        look=watch,
        scripts=(
            (
                ScriptStep("Watch", {}),
                *full,
                ScriptStep("Cancel", {"ride": pick("ride")}, ((0, 2),)),
                ScriptStep("settle"),
            ),
        ),
    )


# A picture of all states of a lift that is called to one floor alone, and whose rides are cancelled.

ONE_FLOOR = (Input("Call", {"floor": 1}), Input("Cancel", {"ride": pick("ride")}))
SYSTEM = System(NAME, SPEC, CODEC, alphabet, sketches=(every_state(SPEC, ONE_FLOOR),))
