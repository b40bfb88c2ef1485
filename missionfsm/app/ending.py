"""Signals to end while an event loop runs: the work ends in an orderly way, and knows which signal it was."""

from __future__ import annotations

import asyncio
import contextlib
import signal
from collections.abc import Callable, Iterator


@contextlib.contextmanager
def told_to_end(end: Callable[[signal.Signals], object]) -> Iterator[None]:
    """Within it Ctrl-C, SIGTERM and SIGHUP call `end` on the running event loop, where that is the main thread's."""
    loop = asyncio.get_running_loop()
    taken: list[signal.Signals] = []
    with contextlib.suppress(ValueError, RuntimeError, NotImplementedError):  # another thread, or no such thing here
        for one in (getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)):
            loop.add_signal_handler(one, end, one)
            taken.append(one)
    try:
        yield
    finally:
        for one in taken:
            loop.remove_signal_handler(one)


def said(by: signal.Signals) -> str:
    """Who ended it, in words."""
    return "interrupted" if by is signal.SIGINT else f"ended by {by.name}"
