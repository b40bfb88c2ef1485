"""The JSON of the lift: requests, answers, messages and the one drive, in and out."""

from __future__ import annotations

from typing import Any

from lift.spec import FLOORS, SPEC, Asked, Lift
from missionfsm.kernel.language import JSON, Codec, UnreadableError, reads


def read_request(method: str, params: JSON) -> Asked:
    """What is left of the params, once the name of a ride is taken out, is the floor."""
    if method not in SPEC.operations:
        raise UnreadableError(f"{method} is not a method of a lift; those are {', '.join(SPEC.operations)}")
    floor = params.get("floor") if isinstance(params, dict) else None
    return Asked(method, floor if type(floor) is int and floor in FLOORS else None)


def write_request(asked: Asked, names: tuple[Any, ...]) -> JSON:
    """The params of a request; the name of a ride is ``("ride", "ride-1")``."""
    if names:
        return {"ride": names[0][1]}
    return {} if asked.floor is None else {"floor": asked.floor}


CODEC = Codec(
    names=("ride",),
    answers={"Call": "ride"},
    read_request=read_request,
    write_request=write_request,
    read_content=reads(Lift),
)
