"""JSON Schemas of protobuf messages in the JSON in which they are read (see `protojson`).

Enums are names or numbers, 64-bit integers and floats numbers or texts, null is absent; names are lowerCamelCase or the
field's own.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from typing import Any, get_args

import attrs

from missionfsm.bear.wire.protojson import Declared, Int64, Timestamp, camel
from missionfsm.kernel.shapes import record

_INTEGER = {"type": ["integer", "string"], "pattern": "^-?[0-9]+$"}
_FLOAT = {"type": ["number", "string"], "pattern": "^(-?[0-9]+(\\.[0-9]+)?([eE][+-]?[0-9]+)?|NaN|-?Infinity)$"}
_TIMESTAMP = {
    "anyOf": [
        {"type": "string", "pattern": "^[0-9]{4}-[0-9]{2}-[0-9]{2}[Tt]"},
        {"type": "object", "properties": {"seconds": _INTEGER, "nanos": _INTEGER}, "additionalProperties": False},
    ]
}
_SCALARS: Mapping[Any, Mapping[str, Any]] = {
    str: {"type": "string"},
    bool: {"type": "boolean"},
    int: _INTEGER,
    Int64: _INTEGER,
    float: _FLOAT,
    Timestamp: _TIMESTAMP,
}


def reference(kind: type, definitions: dict[str, Any]) -> dict[str, Any]:
    """The schema of a message class, as a reference to what is added to the definitions."""
    name = kind.__name__
    if name not in definitions:
        definitions[name] = {}  # so that one that holds itself ends
        attrs.resolve_types(kind)
        fields = {one.name: _optional(one.type, definitions) for one in attrs.fields(kind)}
        both = {spelt: found for name, found in fields.items() for spelt in (camel(name), name)}
        definitions[name] = record(both)
        oneofs = _oneofs(kind)
        if oneofs:
            definitions[name]["allOf"] = oneofs
    return {"$ref": f"#/$defs/{name}"}


def names_of(kind: type[enum.IntEnum]) -> dict[str, Any]:
    """The schema of an enum: a name, or a number."""
    return {"anyOf": [{"enum": [one.name for one in kind]}, dict(_INTEGER)]}


def _oneofs(kind: type) -> list[dict[str, Any]]:
    """That at most one member of each oneof is set: no two of them are."""
    groups: dict[str, list[str]] = {}
    for one in attrs.fields(kind):
        if "oneof" in one.metadata:
            groups.setdefault(one.metadata["oneof"], []).append(camel(one.name))
    present = {"not": {"type": "null"}}
    return [
        {"not": {"required": [first, second], "properties": {first: present, second: present}}}
        for names in groups.values()
        for index, first in enumerate(names)
        for second in names[index + 1 :]
    ]


def _optional(declared: Declared, definitions: dict[str, Any]) -> dict[str, Any]:
    """The schema of a field that may be null."""
    return {"anyOf": [_value(declared, definitions), {"type": "null"}]}


def _value(declared: Declared, definitions: dict[str, Any]) -> dict[str, Any]:
    if declared in _SCALARS:
        return dict(_SCALARS[declared])
    inner = [one for one in get_args(declared) if one is not type(None)]
    if getattr(declared, "__origin__", None) is tuple:
        return {"type": "array", "items": _value(inner[0], definitions)}
    if inner:
        return _value(inner[0], definitions)
    if issubclass(declared, enum.IntEnum):
        return names_of(declared)
    return reference(declared, definitions)
