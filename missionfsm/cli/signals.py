"""Being told to end, from the keyboard or by others."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator
from types import FrameType

from attrs import define

_TOLD = tuple(one for one in ("SIGTERM", "SIGHUP") if hasattr(signal, one))


@contextlib.contextmanager
def ended_like_ctrl_c() -> Iterator[None]:
    """Within it SIGTERM and SIGHUP are KeyboardInterrupt, unless somebody wants them to be something else."""
    if threading.current_thread() is not threading.main_thread():  # no other may say so
        yield
        return
    numbers = [getattr(signal, one) for one in _TOLD]
    taken = [one for one in numbers if signal.getsignal(one) is signal.SIG_DFL]
    for number in taken:
        signal.signal(number, signal.default_int_handler)
    try:
        yield
    finally:
        for number in taken:
            signal.signal(number, signal.SIG_DFL)


@define
class Interruption:
    """Whether somebody has asked for an end."""

    asked: bool = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Take the first signal for a request, the second one for an order."""
        if self.asked:
            signal.default_int_handler(number, frame)
        self.asked = True


@contextlib.contextmanager
def interruptible() -> Iterator[Interruption]:
    """Within it a first signal to end is only noted, so that what was found until then can be told.

    It is for work that looks at the note often. A second signal ends it at once.
    """
    noted = Interruption()
    if threading.current_thread() is not threading.main_thread():
        yield noted
        return
    numbers = [getattr(signal, one) for one in ("SIGINT", *_TOLD)]
    before = {one: signal.getsignal(one) for one in numbers}
    taken = [one for one, handler in before.items() if handler not in (signal.SIG_IGN, None)]
    for number in taken:
        signal.signal(number, noted)
    try:
        yield noted
    finally:
        for number in taken:
            signal.signal(number, before[number])
