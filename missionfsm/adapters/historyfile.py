"""Recorded histories: JSON Lines from a file or a stream, one conversation or a whole fleet's day.

A history is never held: what is kept is one judge for every robot that a file speaks of. Stdin is read once; a file may
be read again, to find out which calls are never answered, and what came before a violation.
"""

from __future__ import annotations

import contextlib
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import IO

import orjson
from attrs import define, field

from missionfsm.adapters.addresses import Addresses
from missionfsm.adapters.decompress import DAMAGED, decompressed
from missionfsm.adapters.jsonlines import CutShortError, loads
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.ids import IdSet

STDIN = "-"
LONGEST_LINE = 64 * 1024 * 1024
"""Bytes that a line may have, give or take a chunk."""
ONE_A_LINE = "a value has to stand in one line, as `jq -c .` writes it"
CHUNK = 1 << 16
"""Bytes that are read at a time."""


def open_history(path: str) -> IO[bytes]:
    """A history to read, decompressed; ``-`` is stdin. Raises UnreadableError if there is none."""
    if not path:
        raise UnreadableError("'': an empty name is no name of a file")
    source = stdin() if path == STDIN else None
    try:
        return decompressed(source, stays_open=True) if source else decompressed(Path(path).open("rb"))
    except DAMAGED as error:
        raise _damaged(path, error) from None
    except UnreadableError as error:
        raise UnreadableError(f"{called(path)}: {error}") from None


def _damaged(path: str, error: Exception) -> UnreadableError:
    """What is said where reading fails."""
    if isinstance(error, EOFError):
        return UnreadableError(f"{called(path)}: the compressed data end too early: the file was cut short")
    return UnreadableError(f"{called(path)}: {getattr(error, 'strerror', None) or error}")


def stdin() -> IO[bytes]:
    """What comes in. Raises UnreadableError if nothing can."""
    if sys.stdin is None:
        raise UnreadableError("stdin is closed")
    return sys.stdin.buffer


def is_plain_file(path: str) -> bool:
    """Whether it can be read more than once."""
    try:
        return path != STDIN and Path(path).is_file()
    except OSError:
        return False


def called(path: str) -> str:
    """What a history is called."""
    return "stdin" if path == STDIN else path


def wrong_line(path: str, number: int, says: object) -> UnreadableError:
    """What is wrong, with the place where it is."""
    return UnreadableError(f"{called(path)}:{number}: {says}")


@contextlib.contextmanager
def placed(path: str, number: int) -> Iterator[None]:
    """Within it an UnreadableError names the file and the line."""
    try:
        yield
    except UnreadableError as error:
        raise wrong_line(path, number, error) from None


def read_whole(path: str) -> bytes:
    """All that is in a file; ``-`` is stdin. Raises UnreadableError."""
    with open_history(path) as source:
        return _read(source.read, -1, path)


def _read(read: Callable[[int], bytes], most: int, path: str) -> bytes:
    try:
        return read(most)
    except DAMAGED as error:
        raise _damaged(path, error) from None


def _chunks(source: IO[bytes], path: str) -> Iterator[tuple[int, list[bytes], bool]]:
    """The lines of a source, many at a time: how many came before, the lines, and whether they end with a newline."""
    number, size = 0, 0
    begun: list[bytes] = []
    # What waits in a pipe is taken as it comes, so that a live stream is judged at once.
    read: Callable[[int], bytes] = getattr(source, "read1", source.read)
    while block := _read(read, CHUNK, path):
        end = block.rfind(b"\n")
        size += len(block) if end < 0 else end
        if size > LONGEST_LINE + CHUNK:
            raise wrong_line(path, number + 1, f"the line has more than {LONGEST_LINE:,} bytes")
        if end < 0:
            begun.append(block)
            continue
        begun.append(block[:end])
        whole = b"".join(begun)
        found = (whole.replace(b"\r\n", b"\n").removesuffix(b"\r") if b"\r" in whole else whole).split(b"\n")
        yield number, found, True
        number += len(found)
        begun = [block[end + 1 :]]
        size = len(begun[0])
    if last := b"".join(begun):
        yield number, [last], False


class Lines:
    """The lines of a history with their numbers, as they come; empty ones are left out."""

    def __init__(self, source: IO[bytes], path: str) -> None:
        self._source = source
        self._path = path
        self._cut = False

    def __iter__(self) -> Iterator[tuple[int, bytes]]:
        for before, found, whole in _chunks(self._source, self._path):
            self._cut = not whole
            for number, text in enumerate(found, before + 1):
                if text and not text.isspace():
                    yield number, text

    def json(self, text: bytes) -> JSON:
        """What the line that came last says. Raises UnreadableError, which says what is wrong."""
        try:
            return loads(text)
        except CutShortError as error:
            why = "the file ends in the middle of it" if self._cut else ONE_A_LINE
            message = f"{error} ({why})"
            raise UnreadableError(message) from None

    def parsed(self, numbered: Iterator[tuple[int, bytes]]) -> Iterator[tuple[int, JSON]]:
        """The JSON of lines, with their numbers. Raises UnreadableError, which names the file and the line."""
        for number, text in numbered:
            try:
                yield number, self.json(text)
            except UnreadableError as error:
                raise wrong_line(self._path, number, error) from None


def lines(source: IO[bytes], path: str) -> Iterator[tuple[int, JSON]]:
    """The JSON of every line, with its number. Raises UnreadableError, which names the file and the line."""
    found = Lines(source, path)
    return found.parsed(iter(found))


def lost_calls(path: str, *, by_params: bool = False) -> Mapping[str | None, frozenset[int]]:
    """Ids of the calls of each robot that a file never answers.

    Knowing them beforehand makes undecided calls cheap. A file that is malformed is left to `lines` to complain of.
    `by_params` is as for `Addresses`.
    """
    return {robot: frozenset(calls.waiting) for robot, calls in (_calls(path, by_params=by_params) or {}).items()}


def early_answers(path: str, *, by_params: bool = False) -> Mapping[str | None, int] | None:
    """How many answers a file has, for each robot, to calls that were sent before it; None of one that is malformed.

    `by_params` is as for `Addresses`.
    """
    found = _calls(path, by_params=by_params)
    return None if found is None else {robot: calls.early for robot, calls in found.items()}


@define
class _Calls:
    """The ids of a robot's calls, as far as a file was read.

    Attributes:
        waiting: those that have no answer yet.
        sent: all of them, and those that were only answered.
        early: how many were only answered.
    """

    waiting: set[int] = field(factory=set)
    sent: IdSet = field(factory=IdSet)
    early: int = 0


def _calls(path: str, *, by_params: bool) -> Mapping[str | None, _Calls] | None:
    """The calls of each robot; None where a line is malformed."""
    calls: defaultdict[str | None, _Calls] = defaultdict(_Calls)
    addresses = Addresses(by_params=by_params)
    with open_history(path) as source:
        try:
            for _, found, _ in _chunks(source, path):
                _follow(found, calls, addresses)
        except (orjson.JSONDecodeError, UnreadableError, TypeError, AttributeError):
            return None
    return calls


def _follow(found: list[bytes], calls: defaultdict[str | None, _Calls], addresses: Addresses) -> None:
    """Take the calls and the returns of some lines into account. Raises UnreadableError if an id comes twice."""
    for line in found:
        counts = b'"call"' in line or b'"return"' in line or b"\\u" in line
        if not counts and (not addresses.undecided or b'"robot"' in line):
            continue
        one = orjson.loads(line)
        if "at" in one:
            del one["at"]  # whether times go back is not asked here
        robot, _ = addresses.whose(one)
        if "call" not in one and "return" not in one:
            continue
        known = calls[robot]
        if "call" not in one:
            known.early += known.sent.add(one["return"])
            known.waiting.discard(one["return"])
        elif not known.sent.add(one["call"]):
            raise UnreadableError("an id that was sent before")
        elif one.get("method") != "cancel":
            known.waiting.add(one["call"])


def fingerprint(value: JSON) -> bytes:
    """Something hashable that tells JSON values apart, fast."""
    return orjson.dumps(value)
