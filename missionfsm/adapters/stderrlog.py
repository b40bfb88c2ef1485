"""What a child process writes to stderr: its beginning and end are kept, and the lines found that say why it died."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from pathlib import Path

from missionfsm.kernel.text import printable

KEPT = 1 << 20
"""Bytes at the beginning and at the end of a log that are kept; what is between them is left out."""

MAX_CHARACTERS = 200
"""Characters of one telling line that are shown."""

_FRAME = re.compile(r"^\s+(at |from |File \")|^\t.*:\d+|^\s*\d+: ")
"""A line of a stack trace."""

_TELLING = tuple(
    re.compile(pattern)
    for pattern in (
        r"^panic: ",  # Go
        r"^fatal error: ",  # Go: deadlock, concurrent map writes
        r"^thread '.*' (\(\d+\) )?panicked at ",  # Rust
        r"^Exception in thread ",  # Java, Kotlin, Scala
        r"^Caused by: ",  # the same
        r"^Unhandled exception[.:] ",  # .NET, Dart
        r"^terminate called ",  # C++
        r"^\S+: .*: Assertion .* failed",  # C
        r"^==\d+==\s*ERROR: ",  # sanitizers
        r"^PHP Fatal error: ",
        r"^\S+:\d+:in .*: ",  # Ruby
        r"^(Uncaught )?[A-Za-z_][\w.]*(Error|Exception|Interrupt|Exit)\b",  # Python, Node.js, Deno
        r"^(Uncaught )?Error( \[\w+\])?: ",  # Node.js, Deno: one of no other kind
        r"^\S+: \d+: .*",  # sh
    )
)


class Log:
    """The stderr of a child process, the beginning and the end of it at least."""

    def __init__(self) -> None:
        self._head = bytearray()
        self._tail = bytearray()
        self._dropped = 0

    def add(self, data: bytes) -> None:
        """Keep more of it."""
        room = KEPT - len(self._head)
        self._head += data[:room]
        self._tail += data[room:]
        if len(self._tail) > KEPT:
            self._dropped += len(self._tail) - KEPT
            del self._tail[:-KEPT]

    @property
    def text(self) -> str:
        """What is kept of it."""
        gap = f"\n… {self._dropped} bytes are left out …\n".encode() if self._dropped else b""
        return bytes(self._head + gap + self._tail).decode(errors="replace")

    def complaint(self) -> str:
        """Why the child says it failed, in one line; empty if it says nothing."""
        lines = [line.rstrip() for line in self.text.splitlines() if line.strip()]
        if not lines:
            return ""
        telling_lines = telling(lines)
        says = " | ".join(printable(line.strip()[:MAX_CHARACTERS]) for line in telling_lines)
        return f" (stderr: {says}{self._kept_whole() if len(lines) > len(telling_lines) else ''})"

    def _kept_whole(self) -> str:
        try:
            with tempfile.NamedTemporaryFile("w", prefix="missionfsm-adapter-", suffix=".log", delete=False) as file:
                file.write(self.text)
        except OSError:
            return ""
        return f"; all of it is in {Path(file.name)}"


def telling(lines: Sequence[str]) -> tuple[str, ...]:
    """The lines that say why a program died, whatever language it is written in: what it says last, if nothing else.

    Python says it in the last line; Node.js, Java, .NET and Ruby before a stack trace; Go and Rust before that and in
    two lines.
    """
    last = max((number for number, line in enumerate(lines) if any(one.match(line) for one in _TELLING)), default=None)
    if last is None:
        return tuple(lines[-1:])
    telling_lines = [lines[last]]
    for line in lines[last + 1 : last + 3]:
        if _FRAME.match(line):
            telling_lines.append(line)
            break
        if re.match(r"^(goroutine |note: |\[signal |stack backtrace)", line):
            continue
        telling_lines.append(line)
    return tuple(telling_lines)
