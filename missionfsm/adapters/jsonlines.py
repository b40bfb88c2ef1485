"""One line of JSON from somebody who is not trusted: read fast, and never deeper than what comes after can follow."""

from __future__ import annotations

from itertools import chain

import orjson

from missionfsm.kernel.codec import JSON, UnreadableError

DEEPEST = 200
"""How deep lists and objects may be nested in a line."""
_NESTING = frozenset((list, dict))


class CutShortError(UnreadableError):
    """It is JSON as far as it goes, and ends too early."""


class TooDeepError(UnreadableError):
    """It is JSON, but nested so deep that nobody means it."""


def loads(text: bytes) -> JSON:
    """What a line says. Raises UnreadableError, which says what is wrong."""
    try:
        value = orjson.loads(text)
    except orjson.JSONDecodeError as error:
        if not text.strip(b"\0"):
            message = f"{len(text):,} NUL bytes stand here instead of a line: the file was cut off while it was written"
            raise UnreadableError(message) from None
        message = f"not JSON: {_not_utf_8(text) or error}"
        raise (CutShortError if error.pos == len(error.doc) else UnreadableError)(message) from None
    if len(text) > 2 * DEEPEST and _may_be_too_deep(text) and _is_too_deep(value):
        message = f"nested more than {DEEPEST} deep"
        raise TooDeepError(message)
    return value


def _not_utf_8(text: bytes) -> str:
    """What is wrong with a line that is no text; "" for one that is."""
    try:
        text.decode()
    except UnicodeDecodeError as error:
        return f"byte 0x{text[error.start]:02x} at column {error.start + 1} is not UTF-8"
    return ""


def _may_be_too_deep(text: bytes) -> bool:
    """Whether there are enough brackets; an object with its key takes five bytes, so that most lines are too short."""
    lists = text.count(b"[")
    return len(text) > 5 * (DEEPEST - lists) and text.count(b"{") + lists > DEEPEST


def _is_too_deep(value: JSON) -> bool:
    level = [value] if type(value) in _NESTING else []
    for _ in range(DEEPEST):
        inner = chain.from_iterable(one.values() if type(one) is dict else one for one in level)
        level = [one for one in inner if type(one) in _NESTING]
        if not level:
            return False
    return True
