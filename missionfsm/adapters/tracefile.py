"""Every line between a tester and an adapter, in both directions, with the seconds since the beginning."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO

from missionfsm.adapters.outputs import STDOUT, naming, to_stdout


@contextlib.contextmanager
def tracing(path: str | None) -> Iterator[Callable[[str, bytes], None]]:
    """What writes lines to a file or to stdout, each with its direction; nothing where no path is given.

    Raises:
        UnreadableError: the file cannot be written.
    """
    if path is None:
        yield lambda _, __: None
        return
    began = time.monotonic()
    with contextlib.ExitStack() as stack:
        file = None if path == STDOUT else stack.enter_context(_opened(path))

        def trace(direction: str, line: bytes) -> None:
            timed = f"{time.monotonic() - began:10.4f} {direction} ".encode() + line + b"\n"
            if file is None:
                with to_stdout():
                    sys.stdout.buffer.write(timed)
                return
            with naming(path):
                file.write(timed)
                file.flush()  # whoever looks for a hang wants to see the last line

        yield trace


def _opened(path: str) -> IO[bytes]:
    with naming(path):
        return Path(path).open("wb")
