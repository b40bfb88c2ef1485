"""A program that is started to be judged over TCP, and a connection to it."""

from __future__ import annotations

import contextlib
import signal
import socket
import subprocess
import tempfile
from collections.abc import Sequence
from typing import Final

from missionfsm.adapters.processes import end_group, signal_group
from missionfsm.isaac.wire.framing import MAX_LINE
from missionfsm.kernel.subject import SubjectError

SLICE: Final = 1 << 16
"""Bytes that are read at once, at most."""

SEND_TIMEOUT: Final = 5.0
"""Seconds in which a line has to be taken."""


class Program:
    """A program that is started anew for every conversation."""

    def __init__(self, command: Sequence[str]) -> None:
        self.command = tuple(command)
        self._process: subprocess.Popen[bytes] | None = None
        self._said = tempfile.TemporaryFile("w+b")  # noqa: SIM115 - lives as long as the program

    def restart(self) -> None:
        """Stop it if it runs, and start it. Raises SubjectError."""
        self.stop()
        self._said.seek(0)
        self._said.truncate()
        try:
            self._process = subprocess.Popen(  # noqa: S603 - running the user's command is the purpose
                self.command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=self._said,
                start_new_session=True,
            )
        except OSError as error:
            raise SubjectError(f"cannot start {self.command[0]}: {error.strerror}") from None

    @property
    def ended(self) -> bool:
        """Whether it has exited by itself."""
        return self._process is not None and self._process.poll() is not None

    def complaint(self) -> str:
        """What it wrote to stderr last, for an error message."""
        self._said.seek(0)
        lines = self._said.read()[-2000:].decode(errors="replace").strip().splitlines()
        return f" (stderr: {lines[-1].strip()[:200]})" if lines else ""

    def stop(self) -> None:
        """Ask it and whatever it has started to end, and end what does not."""
        if self._process is None:
            return
        signal_group(self._process, signal.SIGTERM)
        try:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(2.0)
        finally:
            end_group(self._process)
            self._process = None

    def close(self) -> None:
        """Stop it for good."""
        self.stop()
        self._said.close()


class Wire:
    """One connection: lines out, lines in."""

    def __init__(self, number: int, sock: socket.socket) -> None:
        self.number = number
        self.sock = sock
        self.open = True
        self._rest = b""
        sock.setblocking(False)  # noqa: FBT003 - the library's own

    def read(self) -> list[str]:
        """The lines that have arrived; a last one without an end counts when the connection is closed."""
        found: list[bytes] = []
        while self.open:
            try:
                data = self.sock.recv(SLICE)
            except BlockingIOError:
                break
            except OSError:
                data = b""
            if not data:
                self.close()
                found += [self._rest] if self._rest else []
                break
            *whole, self._rest = (self._rest + data).split(b"\n")
            found += whole
            if len(self._rest) > MAX_LINE:
                raise SubjectError(f"connection {self.number}: a line of more than {MAX_LINE} bytes")
        return [line.decode(errors="backslashreplace") for line in found]

    def write(self, line: str) -> bool:
        """Send a line; False where the other end is gone."""
        try:
            self.sock.settimeout(SEND_TIMEOUT)
            self.sock.sendall(line.encode(errors="replace") + b"\n")
            self.sock.setblocking(False)  # noqa: FBT003 - the library's own
        except TimeoutError:
            raise SubjectError(f"connection {self.number}: nothing was read for {SEND_TIMEOUT:g} s") from None
        except OSError:
            self.close()
            return False
        return True

    def close(self) -> None:
        """Close it; what has not been read is lost."""
        self.open = False
        self.sock.close()
