"""Being told to end by others than the keyboard: what was started is ended first, as with Ctrl-C."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Iterator

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
