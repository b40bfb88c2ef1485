"""Programs that are started in a session of their own, so that whatever they start ends with them."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess


def signal_group(process: subprocess.Popen[bytes], number: int) -> None:
    """Send a signal to a program that was started with a session of its own, and to all that it has started."""
    # Where all have ended there is no such group, or (on macOS) none that may be told so.
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, number)


def end_group(process: subprocess.Popen[bytes]) -> None:
    """End such a program and all that it has started, whether it lives or not."""
    signal_group(process, signal.SIGKILL)
    process.wait()
