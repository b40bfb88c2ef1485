"""JSON as the standard has it, and the places where a text departs from it.

The standard library's reader takes NaN, keeps the last of two equal keys, lets ``1e999`` become infinite and gives up
with a RecursionError on a deep text. Here each of these is a fault with a path, because what is read is sent on to
robots and has to mean one thing only.
"""

import json
import math
from collections.abc import Iterator
from typing import Any, Final

import attrs

MAX_DEPTH: Final = 200
"""Objects and lists within one another; more is refused, whatever the interpreter's own limit is."""

_SHOWN: Final = 40


@attrs.frozen
class JsonFault:
    """What is wrong with a text, at `position`, counted in characters from 0."""

    position: int
    problem: str


class JsonObject(dict[str, Any]):
    """A JSON object that remembers which of its keys were given more than once."""

    doubled: tuple[str, ...] = ()


def _object(pairs: list[tuple[str, Any]]) -> JsonObject:
    result = JsonObject(pairs)
    if len(result) != len(pairs):
        seen: set[str] = set()
        doubled: dict[str, None] = {}
        for key, _ in pairs:
            if key in seen:
                doubled[key] = None
            seen.add(key)
        result.doubled = tuple(doubled)
    return result


def parse(text: str) -> object | JsonFault:
    """The value of a JSON text, or what is wrong with it.

    The literals NaN, Infinity and -Infinity come out as floats, for the caller to judge by their place: `faults`
    reports them, with every number that is too large to be finite.
    """
    try:
        value: object = json.loads(text, object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        return JsonFault(error.pos, f"not JSON: {error.msg[:1].lower()}{error.msg[1:]}")
    except RecursionError:
        return JsonFault(0, f"nested more than {MAX_DEPTH} deep")
    except ValueError:  # the interpreter refuses to convert numbers of thousands of digits
        return JsonFault(0, "holds a number of thousands of digits")
    return value


def faults(value: object, path: str = "") -> Iterator[tuple[str, str]]:
    """Every (path, problem) inside a parsed value: doubled keys, infinite numbers, broken Unicode, depth."""
    if _is_sound(value):
        return
    stack: list[tuple[str, object, int]] = [(path, value, 1)]
    while stack:
        here, item, depth = stack.pop()
        if isinstance(item, str) and not _is_unicode(item):
            yield here, "holds half of a surrogate pair, which is no Unicode text"
        elif isinstance(item, float) and not math.isfinite(item):
            yield here, "is not a finite number"
        elif isinstance(item, dict | list) and depth > MAX_DEPTH:
            yield here, f"is nested more than {MAX_DEPTH} deep"
        elif isinstance(item, dict):
            yield from _key_faults(item, here)
            stack.extend((below(here, key), item[key], depth + 1) for key in reversed(item))
        elif isinstance(item, list):
            stack.extend((f"{here}[{index}]", item[index], depth + 1) for index in reversed(range(len(item))))


def _is_sound(value: object) -> bool:
    """A quick look without paths, for the usual case; False where a closer one is needed."""
    level: list[object] = [value]
    for _ in range(MAX_DEPTH):
        below_level: list[object] = []
        for item in level:
            if isinstance(item, str):
                if not _is_unicode(item):
                    return False
            elif isinstance(item, dict):
                if not isinstance(item, JsonObject) or item.doubled or not all(map(_is_unicode, item)):
                    return False
                below_level += item.values()
            elif isinstance(item, list):
                below_level += item
            elif isinstance(item, float) and not math.isfinite(item):
                return False
        if not below_level:
            return True
        level = below_level
    return False


def _key_faults(value: dict[str, Any], path: str) -> Iterator[tuple[str, str]]:
    for key in value.doubled if isinstance(value, JsonObject) else ():
        yield below(path, key), "is given more than once"
    for key in value:
        if not _is_unicode(key):
            yield path, f"has the key {brief_json(key)}, which is no Unicode text"


def below(path: str, key: str) -> str:
    """The path of a member of an object: ``a.b``, or ``a["odd key"]`` where a dot would mislead."""
    if key.isidentifier():
        return f"{path}.{key}" if path else key
    return f"{path}[{brief_json(key)}]"


def brief_json(value: object) -> str:
    """A value in a message for people: one line, short, ASCII."""
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, list):
        return "a list"
    if isinstance(value, str) and len(value) > _SHOWN:
        return json.dumps(value[:_SHOWN]) + "…"
    text = json.dumps(value)
    return text if len(text) <= _SHOWN * 6 else f"{text[:_SHOWN]}…"


def compact(value: object) -> str:
    """A JSON value as text without spaces; ASCII, so that it is UTF-8 whatever it holds."""
    return json.dumps(value, separators=(",", ":"), allow_nan=False)


def _is_unicode(text: str) -> bool:
    return text.isascii() or not any("\ud800" <= character <= "\udfff" for character in text)
