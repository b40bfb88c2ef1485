"""Protobuf JSON of any message of the table, drawn, and made wrong in ways that people and programs find."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from typing import Any

from missionfsm.bear.wire.enums import ENUMS
from missionfsm.bear.wire.fields import MESSAGES, Field
from missionfsm.bear.wire.protojson import LARGEST, camel
from missionfsm.kernel.codec import JSON

Place = tuple[Any, ...]
"""The keys and indices on the way to a part of a value."""

_SCALARS: dict[str, list[JSON]] = {
    "string": ["", "a", "m-1", "é", "12"],
    "int32": [0, 1, -1, 7, 2**31 - 1, -(2**31), "12", 3.0],
    "int64": [0, 1, "2", "9007199254740993", 2**63 - 1, -1, 5.0],
    "float": [0, 1, 0.5, -2.25, 0.1, "1.5", "NaN", "Infinity", "-Infinity", 3e38],
    "google.protobuf.Timestamp": [
        "2025-06-01T12:00:00Z",
        "2025-06-01T12:00:00.5Z",
        "2025-06-01T12:00:00+02:00",
        "1970-01-01T00:00:00Z",
        "2024-02-29T23:59:59.123456789Z",
    ],
    "google.protobuf.Any": [
        {},
        {"@type": "type.googleapis.com/google.protobuf.Timestamp", "value": "2025-06-01T12:00:00Z"},
    ],
}
_WRONG: list[JSON] = [
    *(None, True, False, 0, -1, 1, 77, 2**31, 2**31 - 1, -(2**31) - 1, -(2**31), 2**63, 2**64),
    *(1.5, 2.0, -0.0, 1e39),
    *(
        "",
        "0",
        "2",
        "-1",
        " 1",
        "1 ",
        "+1",
        "01",
        "1_0",
        "1.0",
        "1e2",
        "1.5",
        "2147483648",
        "NaN",
        "Infinity",
        "nan",
        "1e39",
        "1e400",
    ),
    *("STATE_RUNNING", "state_running", "STATE_NONE", "COMMAND_CANCEL"),
    *("2025-02-30T00:00:00Z", "2023-02-29T00:00:00Z", "2025-13-01T00:00:00Z", "2025-06-01T12:00:00"),
    *("2025-06-01 12:00:00Z", "2025-06-01T24:00:00Z", "2025-06-01T23:59:61Z", "0001-01-01T00:00:00Z"),
    *("0000-01-01T00:00:00Z", "9999-12-31T23:59:59Z", "2025-06-01T12:00:00.1234567890Z", "2025-06-01T12:00Z"),
    *("2025-6-1T12:00:00Z", "2025-06-01T12:00:00Z ", "12025-06-01T12:00:00Z"),
    *([], [None], [1], ["a"], {}, {"a": 1}, [[]], [{}]),
]
_STRANGE_KEYS = ("noSuch", "typedStatus", "mission", "feedback", "goal", "extra")
NOT_MODELLED = ("extension", "localizationState", "localization_state")
"""Fields of the table that the model takes for unknown."""
BOTH = "a field in both spellings"
OBJECT = "a timestamp as an object, which is how recorders write it"
TOLERATED = {BOTH, OBJECT}
"""Laxities that the model has, the first where one of the two is null."""


def message(chance: random.Random, name: str, depth: int = 0) -> dict[str, JSON]:
    """A message as protobuf JSON."""
    found: dict[str, JSON] = {}
    taken: set[str] = set()
    for field in chance.sample(MESSAGES[name], len(MESSAGES[name])):
        if chance.random() < (0.35 if depth < 6 else 0.8) or field.oneof in taken - {""}:
            continue
        taken.add(field.oneof)
        found[chance.choice((camel(field.name), field.name))] = _content(chance, field, depth)
    return found


def _content(chance: random.Random, field: Field, depth: int) -> JSON:
    def one() -> JSON:
        if field.type in MESSAGES:
            return message(chance, field.type, depth + 1)
        if field.type in ENUMS:
            return chance.choice((*ENUMS[field.type], *ENUMS[field.type].values(), 77))
        return chance.choice(_SCALARS[field.type])

    if field.label == "map":
        return {key: one() for key in chance.sample(("r1", "r2", ""), chance.randint(0, 2))}
    return [one() for _ in range(chance.randint(0, 3))] if field.label == "repeated" else one()


def usually(name: str, value: JSON) -> JSON:
    """The same message with every name in lowerCamelCase, and enums by name where they have one."""
    if name in ENUMS:
        return next((one for one, number in ENUMS[name].items() if number == value), value)
    if name not in MESSAGES:
        return value
    found = {}
    for field in MESSAGES[name]:
        content = value.get(field.name, value.get(camel(field.name)))
        if content is None:
            continue
        if field.label == "map":
            content = {key: usually(field.type, one) for key, one in content.items()}
        elif field.label == "repeated":
            content = [usually(field.type, one) for one in content]
        else:
            content = usually(field.type, content)
        found[camel(field.name)] = content
    return found


def _places(value: JSON, place: Place = ()) -> Iterator[Place]:
    yield place
    if isinstance(value, dict):
        for key, inner in value.items():
            if key not in NOT_MODELLED:
                yield from _places(inner, (*place, key))
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _places(inner, (*place, index))


def _at(value: JSON, place: Place) -> JSON:
    for step in place:
        value = value[step]
    return value


def _with(value: JSON, place: Place, new: JSON) -> JSON:
    if not place:
        return new
    changed = value.copy()
    changed[place[0]] = _with(value[place[0]], place[1:], new)
    return changed


def mutated(chance: random.Random, value: JSON) -> JSON:
    """A value with one thing changed, mostly for the worse."""
    place = chance.choice(list(_places(value)))
    here = _at(value, place)
    if chance.random() < 0.5:
        new = chance.choice(_WRONG)
    elif isinstance(here, dict):
        new = {**here, chance.choice(_STRANGE_KEYS): chance.choice((None, 1, {}))}
        if here and chance.random() < 0.5:
            key = chance.choice(list(here))
            new = {**here, other_spelling(key): here[key]}
    elif isinstance(here, list):
        new = here + here[:1]
    elif isinstance(here, str):
        new = here + chance.choice(("x", " ", "0"))
    else:
        new = str(here)
    return _with(value, place, new)


def other_spelling(key: str) -> str:
    """``robot_id`` for ``robotId``, and the other way round."""
    return camel(key) if "_" in key else re.sub("[A-Z]", lambda found: f"_{found[0].lower()}", key)


def laxities(name: str, value: JSON) -> Iterator[str]:
    """Where Python's json_format, or the model, reads what the mapping from protobuf to JSON does not have, and how."""
    if not isinstance(value, dict):
        if value in ([], ""):
            yield "an empty list or text for a message"
        return
    for field in MESSAGES[name]:
        spellings = [key for key in {field.name, camel(field.name)} if key in value]
        if len(spellings) > 1:
            yield BOTH
        for key in spellings:
            items = value[key]
            if field.label == "map":
                items = list(items.values()) if isinstance(items, dict) else []
            for one in items if isinstance(items, list) and field.label in ("repeated", "map") else [items]:
                yield from laxities(field.type, one) if field.type in MESSAGES else _lax_scalar(field.type, one)


_LAX_NUMBER = re.compile(r"\s*[+-]?[0-9_]+\s*")
_LAX_FLOAT = re.compile(r"\s*[+-]?([0-9_]+(\.[0-9_]*)?([eE][+-]?[0-9]+)?|NaN|Infinity)\s*", re.IGNORECASE)
_FLOAT = re.compile(r"-?(0|[1-9][0-9]*)(\.[0-9]+)?([eE][+-]?[0-9]+)?|NaN|-?Infinity")
_RFC_3339 = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}(\.[0-9]{1,9})?(Z|[+-][0-9]{2}:[0-9]{2})")


def _lax_scalar(kind: str, value: JSON) -> Iterator[str]:
    if kind in ENUMS and isinstance(value, float) and not value.is_integer():
        yield "a fraction for an enum"
    if (kind in ENUMS or kind == "float") and isinstance(value, bool):
        yield "a truth value for a number"
    if kind == "google.protobuf.Timestamp" and isinstance(value, dict):
        yield OBJECT
    if not isinstance(value, str):
        return
    if (kind in ENUMS or kind.startswith("int")) and _LAX_NUMBER.fullmatch(value):
        if kind in ENUMS and re.fullmatch(r"-?[0-9]+", value) and not -(2**31) <= int(value) < 2**31:
            yield "a number of more than 32 bits as text for an enum"
        elif not re.fullmatch(r"-?[0-9]+", value):
            yield "blanks, plus or underscores in a number"
    elif kind == "float" and _FLOAT.fullmatch(value) and value[-1].isdigit() and abs(float(value)) > LARGEST:
        yield "a number of more than 32 bits as text for a float"
    elif kind == "float" and _LAX_FLOAT.fullmatch(value) and not _FLOAT.fullmatch(value):
        yield "blanks, plus, underscores or leading zeros in a number"
    elif kind == "google.protobuf.Timestamp" and not _RFC_3339.fullmatch(value):
        yield "a timestamp in another form than RFC 3339 has"
