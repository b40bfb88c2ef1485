"""Which requests binary protobuf can carry: what is wrong in other ways than these cannot reach a robot over gRPC."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from missionfsm.bear.wire.enums import ENUMS
from missionfsm.bear.wire.fields import MESSAGES, Field
from missionfsm.bear.wire.methods import METHODS
from missionfsm.bear.wire.protojson import camel
from missionfsm.kernel.codec import JSON

_REQUESTS: Mapping[str, str] = {one.name: one.request for one in METHODS}
_NO_NUMBERS = ("NaN", "Infinity", "-Infinity")
_INTEGERS: Mapping[str, range] = {
    "int32": range(-(2**31), 2**31),
    "uint32": range(2**32),
    "int64": range(-(2**63), 2**63),
    "uint64": range(2**64),
}


def carries(method: str, params: JSON) -> bool:
    """Whether a request of a call can be said in binary.

    It cannot where it has a field that is not known, an enum by a name that does not exist, a value of another type, or
    two members of one oneof. Where in doubt (a number that is written as a text, say) it cannot either: a tester has
    enough to ask.
    """
    return method in _REQUESTS and _message(_REQUESTS[method], params)


def _message(name: str, value: JSON) -> bool:
    if not isinstance(value, dict):
        return False
    fields = {spelt: field for field in MESSAGES[name] for spelt in (field.name, camel(field.name))}
    taken: set[str] = set()
    for key, content in value.items():
        field = fields.get(key)
        if field is None:
            return False
        if content is None:
            continue
        mark = field.oneof or field.name
        if mark in taken or not _field(field, content):
            return False
        taken.add(mark)
    return True


def _field(field: Field, content: JSON) -> bool:
    if field.label == "repeated":
        return isinstance(content, list) and all(_value(field.type, each) for each in content)
    if field.label == "map":
        return isinstance(content, dict) and all(_value(field.type, each) for each in content.values())
    return _value(field.type, content)


def _value(kind: str, content: JSON) -> bool:
    if kind in MESSAGES:
        return _message(kind, content)
    if kind in ENUMS:
        return _is_integer(content, _INTEGERS["int32"]) or (isinstance(content, str) and content in ENUMS[kind])
    if kind in _INTEGERS:
        return _is_integer(content, _INTEGERS[kind])
    return kind in _SCALARS and _SCALARS[kind](content)


def _is_integer(content: object, within: range) -> bool:
    return isinstance(content, int) and not isinstance(content, bool) and content in within


def _is_number(content: object) -> bool:
    return (isinstance(content, int | float) and not isinstance(content, bool)) or content in _NO_NUMBERS


_SCALARS: Mapping[str, Callable[[Any], bool]] = {
    "string": lambda content: isinstance(content, str),
    "bool": lambda content: isinstance(content, bool),
    "float": _is_number,
    "double": _is_number,
}
