"""Protobuf messages as attrs values, in and out of protobuf JSON.

What every kind of input means is decided here, once:

- a name may come in lowerCamelCase or in snake_case; null is the same as absent; absent means the field's default;
- an enum may come by name or by number, also one as text; a name that does not exist is malformed, as is a number of
  more than 32 bits; any other number is kept;
- a 64-bit integer may come as a number or as text; a float also as "NaN", "Infinity" or "-Infinity";
- a timestamp is an RFC 3339 text of a day and a time that exist, or ``{"seconds", "nanos"}``, as recorders write it;
- a value of another type, a number out of the range of its field, two members of one oneof are malformed;
- a field that the message does not have is ignored, and `unknown_fields` finds it for those who refuse it.
"""

from __future__ import annotations

import enum
import functools
import marshal
import math
import re
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import Any, NewType, TypeVar, get_args

import attrs
import cattrs

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.text import brief

Int64 = NewType("Int64", int)
"""A 64-bit integer field; `int` is a 32-bit one."""

Timestamp = NewType("Timestamp", str)
"""A google.protobuf.Timestamp, as a text of RFC 3339."""

_TIME = r"[Tt](?:[01][0-9]|2[0-3]):[0-5][0-9]:[0-5][0-9](?:\.[0-9]{1,9})?(?:[Zz]|[+-][0-9]{2}:[0-9]{2})"
USUAL_TIMESTAMP = r"(?!0000)[0-9]{4}-(?:0[1-9]|1[0-2])-(?:0[1-9]|1[0-9]|2[0-8])" + _TIME
"""A regular expression for timestamps on days that every month has. Other texts have to be parsed."""

_ANY_TIMESTAMP = re.compile(
    r"([0-9]{4}-[0-9]{2}-[0-9]{2})[Tt]([0-9]{2}:[0-9]{2}):([0-9]{2})(?:\.[0-9]{1,9})?(?:[Zz]|[+-][0-9]{2}:[0-9]{2})"
)
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)

T = TypeVar("T")
Declared = Any
"""The type of a field, as it is declared: a class, or what `typing` makes of several."""

_Key = TypeVar("_Key")
_Found = TypeVar("_Found")


class MalformedError(ValueError):
    """A JSON text is not the message that it should be: says where and what."""

    def __init__(self, says: str, path: str = "") -> None:
        self.says = says
        self.path = path
        super().__init__(f"{path or 'the message'}: {says}")

    def inside(self, step: str) -> MalformedError:
        """The same error, seen from one level further out."""
        return MalformedError(self.says, step + ("" if self.path.startswith("[") or not self.path else ".") + self.path)


def member(group: str) -> Any:  # noqa: ANN401 - as attrs.field
    """A field that belongs to a oneof: at most one of the group may be set."""
    return attrs.field(default=None, metadata={"oneof": group})


def camel(name: str) -> str:
    """``current_goal_index`` to ``currentGoalIndex``."""
    head, *rest = name.split("_")
    return head + "".join(word.capitalize() for word in rest)


def key_of(message: dict[str, Any], name: str) -> str:
    """The key under which a message has a field, given its ``snake_case`` name; null is the same as absent."""
    usual = camel(name)
    return name if message.get(usual) is None and message.get(name) is not None else usual


_DIGITS = re.compile(r"-?[0-9]{1,20}", re.ASCII)
_NUMBER = re.compile(r"-?(0|[1-9][0-9]*)(\.[0-9]+)?([eE][+-]?[0-9]+)?|NaN|-?Infinity", re.ASCII)


def _integer(bits: int, given: object) -> int:
    value = given
    if isinstance(value, str) and _DIGITS.fullmatch(value):
        value = int(value)
    elif isinstance(value, str) and _NUMBER.fullmatch(value):
        value = float(value)
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int):
        raise MalformedError(f"{brief(given)} is not an integer")
    if not -(1 << bits - 1) <= value < 1 << bits - 1:
        raise MalformedError(f"{brief(given)} does not fit into {bits} bits")
    return value


LARGEST = 3.4028235677973366e38
"""Where what rounds to a 32-bit float ends."""


def _float(value: object, _: object = None) -> float:
    if isinstance(value, str) and _NUMBER.fullmatch(value):
        if value.endswith("Infinity"):
            return float(value)
        text, value = value, float(value)
        if math.isinf(value):
            raise MalformedError(f"{brief(text)} does not fit into 32 bits")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise MalformedError(f"{brief(value)} is not a number")
    if LARGEST < abs(value) != math.inf:
        raise MalformedError(f"{brief(value)} does not fit into 32 bits")
    return float(value)


def _text(value: object, _: object = None) -> str:
    if not isinstance(value, str):
        raise MalformedError(f"{brief(value)} is not a text")
    return value


def _timestamp(value: object) -> str:
    if isinstance(value, dict):
        return _counted(value)
    found = _ANY_TIMESTAMP.fullmatch(value) if isinstance(value, str) else None
    if found is None:
        raise MalformedError(f"{brief(value)} is not a timestamp")
    day, minute, second = found.groups()
    try:  # a leap second counts as the second before
        datetime.fromisoformat(f"{day}T{minute}:{'59' if second == '60' else second}")
    except ValueError:
        raise MalformedError(f"{brief(value)} is not a day and a time that exist") from None
    return found[0]


def _counted(value: dict[str, Any]) -> str:
    """The timestamp that an object of seconds since 1970 and nanoseconds says."""
    if not value.keys() <= {"seconds", "nanos"}:
        raise MalformedError(f"{brief(value)} is not a timestamp")
    seconds, nanos = (_integer(bits, value.get(name) or 0) for name, bits in (("seconds", 64), ("nanos", 32)))
    try:
        when = _EPOCH + timedelta(seconds=seconds)
    except OverflowError:
        when = None
    if when is None or not 0 <= nanos < 1_000_000_000:
        raise MalformedError(f"{brief(value)} is not a time that exists")
    return f"{when:%Y-%m-%dT%H:%M:%S}.{nanos:09}Z"


def _enum(value: object, kind: type[enum.IntEnum]) -> int:
    if isinstance(value, str) and not _DIGITS.fullmatch(value):
        try:
            return kind[value]
        except KeyError:
            raise MalformedError(f"{brief(value)} is none of {', '.join(kind.__members__)}") from None
    try:
        number = _integer(32, value)
    except MalformedError:
        raise MalformedError(f"{brief(value)} is neither the name nor the number of an enum's value") from None
    return kind(number) if number in kind._value2member_map_ else number


@functools.cache
def _fields(kind: type) -> dict[str, attrs.Attribute[Any]]:
    """The fields of a message class by either of their JSON names."""
    attrs.resolve_types(kind)
    found: dict[str, attrs.Attribute[Any]] = {}
    for attribute in attrs.fields(kind):
        found[camel(attribute.name)] = attribute
        found[attribute.name] = attribute
    return found


def _message_hook(kind: type[T]) -> Callable[[object, object], T]:
    fields = _fields(kind)  # type: ignore[arg-type]  # a class can be hashed
    hooks: dict[str, Callable[..., Any]] = {}

    def structure(value: object, _: object = None) -> T:
        if not isinstance(value, dict):
            raise MalformedError(f"{brief(value)} is not an object")
        given: dict[str, Any] = {}
        groups: dict[str, str] = {}
        for name, content in value.items():
            attribute = fields.get(name)
            if attribute is None or content is None:
                continue
            group = attribute.metadata.get("oneof")
            if group and groups.setdefault(group, name) != name:
                raise MalformedError(f"{groups[group]} and {name} are set; only one may be")
            if attribute.name in given:
                raise MalformedError(f"{name} is set twice")
            declared: Any = attribute.type
            hook = hooks.get(attribute.name)
            if hook is None:
                hook = hooks[attribute.name] = CONVERTER.get_structure_hook(_plain(declared))
            try:
                given[attribute.name] = hook(content, _plain(declared))
            except MalformedError as error:
                raise error.inside(name) from None
        return kind(**given)

    return structure


@functools.cache
def _plain(declared: Declared) -> Declared:
    """The type that a present value has: an optional field's without the None."""
    inner = [one for one in get_args(declared) if one is not type(None)]
    return inner[0] if type(None) in get_args(declared) else declared


def _is_tuple(declared: object) -> bool:
    return getattr(declared, "__origin__", None) is tuple


MAX_KNOWN = 5_000
"""How many messages in lists are remembered, since a list that grows has the same ones in it again and again."""


def _tuple_hook(declared: Declared) -> Callable[[object, object], tuple[Any, ...]]:
    inner = get_args(declared)[0]
    hook = CONVERTER.get_structure_hook(inner)
    if attrs.has(inner):
        hook = _knowing(hook)

    def structure(value: object, _: object = None) -> tuple[Any, ...]:
        if not isinstance(value, list):
            raise MalformedError(f"{brief(value)} is not a list")
        found = []
        for index, item in enumerate(value):
            try:
                found.append(hook(item, inner))
            except MalformedError as error:
                raise error.inside(f"[{index}]") from None
        return tuple(found)

    return structure


def _knowing(hook: Callable[[object, object], object]) -> Callable[[object, object], object]:
    """A hook that gives the same message for the same JSON; messages are frozen, so that they can be shared."""
    known: dict[str | bytes, object] = {}

    def structure(value: object, kind: object) -> object:
        return _recalled(known, _as_key(value), lambda: hook(value, kind))

    return structure


def _as_key(value: object) -> str | bytes:
    """Something hashable that tells JSON values apart, also 1 from true and from 1.0; the fastest there is.

    Version 2 of the form says the same of equal values; later ones say how often an object is referred to.
    """
    try:
        return marshal.dumps(value, 2)  # type: ignore[arg-type]  # what is no JSON value raises
    except ValueError:  # of no JSON value, or nested too deep
        return repr(value)


def _recalled(known: dict[_Key, _Found], key: _Key, work_out: Callable[[], _Found]) -> _Found:
    """What is known for a key, worked out where it is not; no more than `MAX_KNOWN` are remembered."""
    found = known.get(key)
    if found is None:
        found = work_out()
        if len(known) >= MAX_KNOWN:
            known.clear()
        known[key] = found
    return found


def _converter() -> cattrs.Converter:
    converter = cattrs.Converter(detailed_validation=False)
    converter.register_structure_hook(int, lambda value, _: _integer(32, value))
    converter.register_structure_hook_func(lambda kind: kind is Int64, lambda value, _: _integer(64, value))
    converter.register_structure_hook_func(lambda kind: kind is Timestamp, lambda value, _: _timestamp(value))
    converter.register_structure_hook(float, _float)
    converter.register_structure_hook(str, _text)
    converter.register_structure_hook(enum.IntEnum, _enum)
    converter.register_structure_hook_factory(attrs.has, _message_hook)
    converter.register_structure_hook_factory(_is_tuple, _tuple_hook)
    converter.register_unstructure_hook_factory(attrs.has, _writer)
    converter.register_unstructure_hook(enum.IntEnum, lambda value: value.name)
    converter.register_unstructure_hook(float, _write_float)
    return converter


def _write_float(value: float) -> float | str:
    if math.isnan(value):
        return "NaN"
    return value if math.isfinite(value) else ("Infinity" if value > 0 else "-Infinity")


def _writer(kind: type) -> Callable[[object], dict[str, JSON]]:
    names = [(attribute.name, camel(attribute.name)) for attribute in attrs.fields(kind)]

    def unstructure(value: object) -> dict[str, JSON]:
        return {
            json: content if content.__class__ in _AS_THEY_ARE else _write(content)
            for name, json in names
            if (content := getattr(value, name)) is not None
        }

    return unstructure


_AS_THEY_ARE = frozenset((str, int, bool))
"""Types whose JSON they are themselves."""


def _write(content: object) -> JSON:
    return [_write(one) for one in content] if isinstance(content, tuple) else CONVERTER.unstructure(content)


CONVERTER = _converter()


def read(kind: type[T], value: object) -> T:
    """The message that a JSON value is. Raises MalformedError, which says where and what."""
    return CONVERTER.structure(value, kind)


def write(message: object) -> JSON:
    """The JSON value of a message: every field that is not None, zeros included, enums by name."""
    return CONVERTER.unstructure(message)


@functools.cache
def _message_of(declared: Declared) -> type | None:
    """The type of the message, or of the messages, that a field of a type has; None where it has none."""
    plain = _plain(declared)
    inner = get_args(plain)[0] if _is_tuple(plain) else plain
    return inner if attrs.has(inner) else None


def unknown_fields(kind: type, value: object) -> tuple[str, ...]:
    """The paths of fields that the message does not have."""
    if not isinstance(value, dict):
        return ()
    found: list[str] = []
    fields = _fields(kind)
    for name, content in value.items():
        attribute = fields.get(name)
        if attribute is None:
            found.append(str(name))
            continue
        declared: Any = attribute.type
        inner = _message_of(declared)
        if inner is not None and isinstance(content, list):
            found += (f"{name}.{path}" for item in content for path in _unknown_of_item(inner, item))
        elif inner is not None:
            found += (f"{name}.{path}" for path in unknown_fields(inner, content))
    return tuple(found)


_ITEMS: dict[tuple[type, str | bytes], tuple[str, ...]] = {}
"""The unknown fields of items of lists, by their text: lists come again and again with one item more."""


def _unknown_of_item(kind: type, item: object) -> tuple[str, ...]:
    """See `unknown_fields`, whose answers for items of lists are remembered."""
    return _recalled(_ITEMS, (kind, _as_key(item)), lambda: unknown_fields(kind, item))
