"""The JSON of the lift: requests, answers, messages and the one drive, in and out."""

from __future__ import annotations

from typing import Any

from lift.spec import FLOORS, SPEC, Asked, Lift
from missionfsm.kernel.language import JSON, OK, Answer, Codec, Malformed, Part, UnreadableError

# What an implementation says is read whatever it is; what is no ride or no floor becomes `Malformed`.


Names = tuple[Any, ...]
"""What a server chooses, each with its kind: ``("ride", "ride-1")``, ``("stream", 1)``."""


def ride_name(ride: str) -> Names:
    """The name of a ride, which is never that of a stream."""
    return (("ride", ride),)


def split_request(method: str, params: JSON) -> tuple[Names, JSON]:
    """The name of a ride is taken out of a request."""
    if method not in SPEC.operations:
        raise UnreadableError(f"{method} is not a method of a lift; those are {', '.join(SPEC.operations)}")
    ride = params.get("ride") if isinstance(params, dict) else None
    return (ride_name(ride), {**params, "ride": "-"}) if method == "Cancel" and isinstance(ride, str) else ((), params)


def read_request(method: str, params: JSON) -> Asked:
    """What is left of the params is the floor."""
    floor = params.get("floor") if isinstance(params, dict) else None
    return Asked(method, floor if type(floor) is int and floor in FLOORS else None)


def write_request(asked: Asked, names: Names) -> JSON:
    """The params of a request."""
    return {"ride": names[0][1]} if names else {} if asked.floor is None else {"floor": asked.floor}


def read_answer(method: str, result: JSON) -> tuple[Answer, Names]:
    """``{"ride": "r1"}`` of Call, ``{}`` of Cancel, ``{"stream": 1}`` of Watch."""
    said = result if isinstance(result, dict) else {}
    if method == "Watch":
        stream = said.get("stream")
        if type(stream) is not int:
            raise UnreadableError(f"Watch answered {result}, which carries no stream number")
        return Answer(OK), (("stream", stream),)
    if method == "Cancel":
        return Answer(OK, None if result == {} else Malformed("Cancel answers with an empty object")), ()
    ride = said.get("ride")
    if not isinstance(ride, str):
        return Answer(OK, Malformed("Call answers with the name of a ride")), ()
    return Answer(OK), ride_name(ride)


def write_answer(method: str, _: Answer, names: Names) -> JSON:
    """The result of a call that succeeded."""
    return {"stream": names[0][1]} if method == "Watch" else {"ride": names[0][1]} if method == "Call" else {}


def split_message(message: JSON) -> tuple[Part, ...]:
    """``{"rides": [{"ride": "r1", "floor": 2}], "moving": true}``: its names, and what is left."""
    rides = message.get("rides") if isinstance(message, dict) else None
    if not isinstance(rides, list) or not all(
        isinstance(one, dict) and isinstance(one.get("ride"), str) for one in rides
    ):
        return (((), (), message),)
    bare = [{**one, "ride": "-"} for one in rides]
    names = tuple(("ride", one["ride"]) for one in rides)
    return ((names, (), {**message, "rides": bare}),)


def read_content(message: JSON) -> Lift | Malformed:
    """What a message shows."""
    try:
        floors = tuple(one["floor"] for one in message["rides"])
        moving = message["moving"]
    except (KeyError, TypeError):
        return Malformed("a message has rides, each with a ride and a floor, and moving")
    if type(moving) is not bool or not all(type(floor) is int for floor in floors):
        return Malformed("floors are numbers, and moving is true or false")
    return Lift(floors, moving)


def write_message(view: Lift, names: Names, _choice: int, _number: int, _seconds: float) -> JSON:
    """The message that shows a state."""
    rides = [{"ride": name[1], "floor": floor} for name, floor in zip(names, view.floors, strict=True)]
    return {"rides": rides, "moving": view.moving}


CODEC = Codec(
    methods=tuple(SPEC.operations),
    streams=("Watch",),
    events=tuple(SPEC.drives),
    split_request=split_request,
    read_request=read_request,
    read_answer=read_answer,
    split_message=split_message,
    read_content=read_content,
    write_request=write_request,
    write_answer=write_answer,
    write_message=write_message,
)
