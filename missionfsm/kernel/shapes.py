"""JSON Schemas of what the lines of a system carry: its world, drives, requests, answers and messages."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import Factory, frozen

from missionfsm.kernel.codec import JSON

Schema = Mapping[str, JSON]
"""A JSON Schema, or some by name."""

TEXT: Schema = {"type": "string"}
NUMBER: Schema = {"type": "number"}
BOOLEAN: Schema = {"type": "boolean"}
OBJECT: Schema = {"type": "object"}


def record(fields: Schema, required: tuple[str, ...] = (), *, more: bool = False) -> dict[str, JSON]:
    """The schema of an object with these members; `more` says whether it may have others."""
    found: dict[str, JSON] = {"type": "object", "properties": dict(fields)}
    if required:
        found["required"] = list(required)
    if not more:
        found["additionalProperties"] = False
    return found


@frozen
class Shapes:
    """JSON Schemas by what they are of; what is left out may be anything.

    Attributes:
        world: the world of `reset` and of a history's first line.
        drives: the name of a drive to the schema of its params, ``event`` included.
        happened: the name of a drive to the members that its result has beside ``happened``.
        requests: a call to its well-formed requests. Others may be sent to see that they are refused.
        results: a call to its answers; a subscription's is its stream.
        messages: of streams, of whichever subscription.
        lines, connections: whether it sends lines in the place of messages; whether on connections with numbers.
        definitions: what the others refer to as ``#/$defs/NAME``.
    """

    world: Schema = Factory(dict)
    drives: Schema = Factory(dict)
    happened: Schema = Factory(dict)
    requests: Schema = Factory(dict)
    results: Schema = Factory(dict)
    messages: tuple[Schema, ...] = ()
    lines: bool = False
    connections: bool = False
    definitions: Schema = Factory(dict)
