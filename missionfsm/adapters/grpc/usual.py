"""Messages from protobuf JSON in its usual form, ten times as fast as protobuf's own parser.

The usual form has names in lowerCamelCase, enums by name, integers and floats as numbers, and timestamps of UTC. All
other forms are left to `google.protobuf.json_format`, which alone decides what a value means and whether it is refused.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from typing import Any

from missionfsm.bear.wire.enums import ENUMS
from missionfsm.bear.wire.fields import MESSAGES, Field
from missionfsm.bear.wire.protojson import camel
from missionfsm.kernel.codec import JSON

MAX_FLOAT = 3.0e38
"""Floats beyond it may not fit into 32 bits."""

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_TIMESTAMP = re.compile(r"([0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2})(?:\.([0-9]{1,9}))?Z", re.ASCII)

Reader = Callable[[JSON], Any]
"""JSON to what the constructor of a message takes for it. Raises UnusualError."""


class UnusualError(ValueError):
    """A value is not written as usual; it may be a message all the same."""


def fields(name: str, value: JSON) -> dict[str, Any]:
    """What the constructor of a message takes, given the message's name in the table and its protobuf JSON.

    Raises:
        ValueError: it is not written as usual.
    """
    found: dict[str, Any] = _message(name)(value)
    return found


@functools.cache
def _message(name: str) -> Reader:
    known = {camel(one.name): (one.name, one.oneof) for one in MESSAGES[name]}
    types = {camel(one.name): one for one in MESSAGES[name]}
    readers: dict[str, Reader] = {}

    def read(value: JSON) -> dict[str, Any]:
        if value.__class__ is not dict:
            raise UnusualError
        found = {}
        taken = ""
        for key, content in value.items():
            reader = readers.get(key)
            if reader is None:
                if key not in known:
                    raise UnusualError
                reader = readers[key] = _field(types[key])  # only now, since messages may hold themselves
            field, oneof = known[key]
            if oneof:
                if taken:
                    raise UnusualError
                taken = oneof
            found[field] = reader(content)
        return found

    return read


def _field(field: Field) -> Reader:
    one = _one(field.type)
    if field.label == "repeated":

        def read_list(value: JSON) -> list[Any]:
            if value.__class__ is not list:
                raise UnusualError
            return [one(item) for item in value]

        return read_list
    if field.label == "map":

        def read_map(value: JSON) -> dict[str, Any]:
            if value.__class__ is not dict:
                raise UnusualError
            return {key: one(item) for key, item in value.items()}

        return read_map
    return one


def _one(kind: str) -> Reader:
    if kind in MESSAGES:
        return _message(kind)
    if kind in ENUMS:
        return functools.partial(_enum, ENUMS[kind])
    return _SCALARS[kind]


def _enum(names: Mapping[str, int], value: JSON) -> int:
    number = names.get(value) if value.__class__ is str else None
    if number is None:
        raise UnusualError
    return number


def _of(kind: type) -> Reader:
    def read(value: JSON) -> Any:  # noqa: ANN401 - of that type
        if value.__class__ is not kind:
            raise UnusualError
        return value

    return read


def _float(value: JSON) -> float:
    if value.__class__ is not float or not -MAX_FLOAT < value < MAX_FLOAT:
        raise UnusualError
    return float(value)


def _timestamp(value: JSON) -> dict[str, int]:
    found = _TIMESTAMP.fullmatch(value) if value.__class__ is str else None
    if found is None:
        raise UnusualError
    since = datetime.fromisoformat(found[1] + "+00:00") - _EPOCH
    return {"seconds": since.days * 86_400 + since.seconds, "nanos": int((found[2] or "").ljust(9, "0"))}


def _any(_: JSON) -> Any:  # noqa: ANN401 - never returns
    raise UnusualError


_SCALARS: Mapping[str, Reader] = {
    "string": _of(str),
    "int32": _of(int),  # one that is out of range is refused by the constructor, with a ValueError
    "int64": _of(int),
    "float": _float,
    "bool": _of(bool),
    "google.protobuf.Timestamp": _timestamp,
    "google.protobuf.Any": _any,
}
