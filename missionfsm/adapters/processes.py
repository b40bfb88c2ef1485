"""Programs that are started in a session of their own, so that whatever they start ends with them.

Windows has neither such sessions nor pipes that can be waited for together, so that programs are not started there.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys

from missionfsm.kernel.subject import SubjectError

PLATFORM = sys.platform


def refuse_where_there_are_no_sessions() -> None:
    """Raise SubjectError on Windows, where programs cannot be started in sessions of their own."""
    if PLATFORM == "win32":
        message = (
            "programs can be judged under Linux and macOS, and on Windows in WSL; `check` and `--grpc` work without it"
        )
        raise SubjectError(message)


def signal_group(process: subprocess.Popen[bytes], number: int) -> None:
    """Send a signal to a program that was started with a session of its own, and to all that it has started."""
    # Where all have ended there is no such group, or (on macOS) none that may be told so.
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, number)


def end_group(process: subprocess.Popen[bytes]) -> None:
    """End a program and every process that it has started, also if the program itself has ended."""
    signal_group(process, signal.SIGKILL)
    process.wait()
