"""Lines written by a thread of their own: whoever says one never waits for those who read them."""

from __future__ import annotations

import os
import sys
import threading
from collections import deque
from collections.abc import Callable
from typing import Final

KEPT: Final = 100_000
"""Lines that may wait for a reader; of more, the newest are lost and counted."""

PATIENCE: Final = 2.0
"""Seconds without any line being read after which `close` waits no longer."""

_BATCH: Final = 4096  # bytes that a pipe takes whole or not at all


def _missing(count: int) -> str:
    return f"{count} lines are missing here: nobody read them in time"


class BackgroundLines:
    """Writes lines in the order in which they were said. Any thread may say them; nobody but `close` ever waits.

    A reader that has gone away is no matter: what follows goes nowhere.

    Args:
        write: writes some bytes, all of them, and may block; OSError where nobody reads any more.
        kept: how many lines may wait.
        missing: the line that takes the place of so many lines that found no room.
    """

    def __init__(
        self, write: Callable[[bytes], object], *, kept: int = KEPT, missing: Callable[[int], str] = _missing
    ) -> None:
        self._write = write
        self._kept = kept
        self._missing = missing
        self._waiting: deque[bytes] = deque()
        self._lost = 0
        self._writing = 0  # lines that were taken and are not written yet
        self._batches = 0  # written so far
        self._gone = False
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None

    def say(self, line: str) -> None:
        """Have one line written, some time."""
        with self._changed:
            if self._gone:
                return
            if len(self._waiting) >= self._kept:
                self._lost += 1
                return
            if self._lost:
                self._waiting.append(_line(self._missing(self._lost)))
                self._lost = 0
            self._waiting.append(_line(line))
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="missionfsm-lines", daemon=True)
                self._thread.start()
            self._changed.notify_all()

    def close(self, patience: float = PATIENCE) -> int:
        """Wait until all is written, as long as somebody reads. How many lines were not.

        Args:
            patience: seconds in which nothing is read, after which nobody is expected to.
        """
        with self._changed:
            while (self._waiting or self._writing) and not self._gone:
                before = self._batches
                if not self._changed.wait_for(lambda seen=before: self._batches != seen or self._gone, patience):  # type: ignore[misc]
                    break
            unread = 0 if self._gone else len(self._waiting) + self._writing + self._lost
            self._gone = True
            self._changed.notify_all()
        return unread

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting or self._gone)
                if self._gone:
                    return
                batch = [self._waiting.popleft()]
                size = len(batch[0])
                while self._waiting and size + len(self._waiting[0]) <= _BATCH:
                    size += len(self._waiting[0])
                    batch.append(self._waiting.popleft())
                self._writing = len(batch)
            try:
                self._write(b"".join(batch))
            except OSError:
                with self._changed:
                    self._gone = True
                    self._waiting.clear()
                    self._changed.notify_all()
                return
            with self._changed:
                self._writing = 0
                self._batches += 1
                self._changed.notify_all()


def stdout_lines(missing: Callable[[int], str] = _missing) -> BackgroundLines:
    """Lines to stdout. Its descriptor is written to, so that a thread that still writes holds up no exit."""
    if sys.stdout is None:
        return BackgroundLines(lambda _: None, missing=missing)
    stream = sys.stdout
    stream.flush()
    try:
        descriptor = stream.fileno()
    except OSError:  # a stream of a test

        def say(data: bytes) -> None:
            stream.write(data.decode())

        return BackgroundLines(say, missing=missing)

    def write(data: bytes) -> None:
        left = memoryview(data)
        while left:
            left = left[os.write(descriptor, left) :]

    return BackgroundLines(write, missing=missing)


def _line(text: str) -> bytes:
    return text.encode("utf-8", "replace") + b"\n"
