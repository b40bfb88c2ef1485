"""Recorded histories: JSON Lines from a file or a stream, one conversation or a whole fleet's day.

A history is read once and never held: what is kept is one judge for every robot that a file speaks of.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import IO

import orjson
from attrs import field, frozen

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.transcript import Ids

STDIN = "-"
LONGEST_LINE = 64 * 1024 * 1024
"""Bytes that a line may have."""


def open_history(path: str) -> IO[bytes]:
    """A history to read; ``-`` is stdin. Raises UnreadableError if there is none."""
    if path == STDIN:
        return sys.stdin.buffer
    try:
        return Path(path).open("rb")
    except OSError as error:
        message = f"{path}: {error.strerror}"
        raise UnreadableError(message) from None


def wrong_line(path: str, number: int, says: object) -> UnreadableError:
    """What is wrong, with the place where it is."""
    return UnreadableError(f"{'stdin' if path == STDIN else path}:{number}: {says}")


def _raw(source: IO[bytes], path: str) -> Iterator[tuple[int, bytes]]:
    number = 0
    while line := source.readline(LONGEST_LINE + 1):
        number += 1
        if len(line) > LONGEST_LINE:
            raise wrong_line(path, number, f"the line has more than {LONGEST_LINE} bytes")
        if not line.isspace():
            yield number, line


def lines(source: IO[bytes], path: str) -> Iterator[tuple[int, JSON]]:
    """The JSON of every line with its number. Raises UnreadableError, which says where and what is wrong."""
    for number, line in _raw(source, path):
        try:
            found = orjson.loads(line)
        except orjson.JSONDecodeError as error:
            short = " (the file ends in the middle of it)" if not line.endswith(b"\n") else ""
            raise wrong_line(path, number, f"not JSON: {error}{short}") from None
        yield number, found


_PLAIN = re.compile(rb'\{"(call|return)": ?(\d+)[,}]')
"""How the commonest lines that call or return begin; what they say can be told without reading all of them."""


def lost_calls(path: str) -> Mapping[str | None, frozenset[int]]:
    """Ids of the calls of each robot that a file never answers; nothing is known of what can be read only once.

    Knowing them beforehand makes undecided calls cheap. A file that is malformed is left to `lines` to complain of.
    """
    if not Path(path).is_file():
        return {}
    sent: dict[str | None, Ids] = {}
    waiting: dict[str | None, set[int]] = {}
    with open_history(path) as source:
        try:
            for _, line in _raw(source, path):
                plain = _PLAIN.match(line)
                if plain and b'"robot"' not in line and b'"cancel"' not in line:
                    robot, called, number = None, plain[1] == b"call", int(plain[2])
                elif b'"call"' in line or b'"return"' in line:
                    one = orjson.loads(line)
                    if one.get("method") == "cancel" or not one.keys() & {"call", "return"}:
                        continue
                    robot, called = one.get("robot"), "call" in one
                    number = one["call" if called else "return"]
                else:
                    continue
                calls = waiting.setdefault(robot, set())
                if not called:
                    calls.discard(number)
                elif sent.setdefault(robot, Ids()).add(number):
                    calls.add(number)
                else:
                    return {}
        except (orjson.JSONDecodeError, UnreadableError, TypeError, AttributeError):
            return {}
    return {robot: frozenset(calls) for robot, calls in waiting.items()}


def fingerprint(value: JSON) -> bytes:
    """Something hashable that tells JSON values apart, fast."""
    return orjson.dumps(value)


@frozen
class Stamps:
    """Checks what any line may carry: ``at`` never goes down, ``robot`` is a text."""

    _latest: dict[str, float] = field(factory=dict, init=False)

    def robot(self, line: JSON) -> str | None:
        """Whose line it is. Raises UnreadableError."""
        if not isinstance(line, dict):
            message = f"{line!r:.60} is not an object"
            raise UnreadableError(message)
        if "at" in line:
            at = line["at"]
            if isinstance(at, bool) or not isinstance(at, int | float):
                message = f"at: {at!r:.60} is not a number of seconds"
                raise UnreadableError(message)
            if at < self._latest.get("at", at):
                message = f"at: {at} comes after {self._latest['at']}"
                raise UnreadableError(message)
            self._latest["at"] = at
        robot = line.get("robot")
        if robot is None and "robot" not in line:
            return None
        if not isinstance(robot, str):
            message = f"robot: {robot!r:.60} is not a text"
            raise UnreadableError(message)
        return robot


def write_history(path: str, history: tuple[JSON, ...]) -> None:
    """Write the lines of a history to a file, whole or not at all."""
    write_whole(path, b"".join(orjson.dumps(line) + b"\n" for line in history))


def write_whole(path: str, data: bytes) -> None:
    """Write a file whole or not at all; ``-`` is stdout. Raises UnreadableError if that is not possible."""
    if path == STDIN:
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
        return
    target = Path(path)
    part = target.with_name(target.name + ".part")
    try:
        part.write_bytes(data)
        part.replace(target)
    except OSError as error:
        part.unlink(missing_ok=True)
        message = f"{path}: {error.strerror}"
        raise UnreadableError(message) from None


Warn = Callable[[str], None]
