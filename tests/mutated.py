"""Lines with something wrong in them, for whatever reads lines."""

from __future__ import annotations

import copy
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from random import Random
from typing import Any

import orjson

MANY = int(os.environ.get("MISSIONFSM_MUTATED", "30"))
"""How many lines of each form are mutated."""
SECONDS = 60
"""After so many seconds a file counts as one that hangs."""
JUNK: tuple[Any, ...] = (
    *(
        None,
        True,
        False,
        0,
        -1,
        1,
        2**31,
        2**53 + 1,
        2**63,
        -(2**63),
        1e308,
        1.5,
        -0.0,
        "",
        "0",
        "NaN",
        "\x00",
        "\ud7ff",
    ),
    *(
        "STATE_RUNNING",
        "missionfsm",
        "mission-2",
        "\u2028\u202e",
        "x" * 5_000,
        [],
        {},
        [[]],
        [{}],
        {"": {}},
        {"seconds": "1"},
    ),
)


def _nested(depth: int) -> Any:
    found: Any = 1
    for _ in range(depth):
        found = [found]
    return found


def mutated(random: Random, line: Any) -> bytes:
    """A line with something wrong in it, as JSON or as bytes."""
    sort = random.randrange(4)
    if sort == 0:
        raw = bytearray(orjson.dumps(line))
        for _ in range(random.randrange(1, 4)):
            at = random.randrange(len(raw))
            raw[at : at + random.randrange(3)] = bytes(random.randrange(256) for _ in range(random.randrange(3)))
        return bytes(raw).replace(b"\n", b" ")
    line = copy.deepcopy(line)
    holder, key = random.choice(list(_places(line)))
    if sort == 1:
        holder[key] = random.choice(JUNK)
    elif sort == 2:
        del holder[key]
    else:
        holder[key] = random.choice(
            [[holder[key], holder[key]], {"value": holder[key]}, str(holder[key]), _nested(random.choice((50, 500)))]
        )
    return orjson.dumps(line, default=str, option=orjson.OPT_NON_STR_KEYS) if sort != 3 else _dumped(line)


def _dumped(line: Any) -> bytes:
    try:
        return orjson.dumps(line)
    except orjson.JSONEncodeError:  # too deep for it to write
        return b"[" * 500 + b"]" * 500


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Every member and every item, with what holds it."""
    for key in list(value) if isinstance(value, dict) else range(len(value)):
        yield value, key
        if isinstance(value[key], dict | list):
            yield from _places(value[key])


@contextmanager
def limited(seconds: int) -> Iterator[None]:
    """Raise TimeoutError after so many seconds."""

    def late(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
