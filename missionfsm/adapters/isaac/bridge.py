"""Real sockets under test: the oracle as the robots of a mission server, or as the mission server of a robot.

A bridge is a subject like any other, in real time. What happens is written down with the time that has passed, as lines
of the history, so that the oracle's clocks go as those of the implementation do, but for a tolerance. After everything
that a bridge does it waits for that long, and what was caused by it has come by then.
"""

from __future__ import annotations

import contextlib
import math
import select
import socket
import time
from collections.abc import Callable
from typing import Final

from missionfsm.adapters.isaac.programs import Program, Wire
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification, Subject, SubjectError

PATIENCE: Final = 10.0
"""Seconds until an implementation that is started has to listen, or to connect."""

_ASKING: Final = ("statuses",)  # calls that cause nothing
_RETRY: Final = 0.02
_MOMENT: Final = 0.01  # seconds that are written down with those that follow


class _Bridge:
    """What both have in common: time that passes, and lines that arrive meanwhile.

    Attributes:
        left: how many seconds the run has left; no longer is waited where time is to pass.
    """

    name = ""
    drives: tuple[str, ...] = ()

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.wires: dict[int, Wire] = {}
        self.left: Callable[[], float] = lambda: math.inf
        self._noted = time.monotonic()

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Answer one request of the protocol. Raises SubjectError."""
        if method == "initialize":
            return Exchange({"implementation": {"name": self.name}, "drives": list(self.drives), "concurrent": False})
        if method == "reset":
            self.close_all()
            before = self.reset(params.get("world") or {})
            return Exchange({}, after=(*before, *self.while_waiting(self.tolerance)))
        earlier = self.while_waiting(0)
        if method == "settle":
            return Exchange({}, earlier=earlier)  # whatever was done was waited for
        if method != "drive":
            answer = self.call(method, params)
            lines = self.while_waiting(0 if method in _ASKING else self.tolerance)
            return Exchange(answer.result, answer.error, (), lines, earlier)
        if params["event"] == "advance":
            return self._advance(params["seconds"], earlier)
        result = self.drive(params["event"], params)
        return Exchange(result, after=self.while_waiting(self.tolerance), earlier=earlier)

    def _advance(self, seconds: float, earlier: tuple[Notification, ...]) -> Exchange:
        lines = self.collect(min(seconds, self.left()))
        return Exchange({"happened": True, "seconds": self.passed()}, after=lines, earlier=earlier)

    def while_waiting(self, seconds: float) -> tuple[Notification, ...]:
        """Wait; the time that has passed since that was written down last, and the lines that have come."""
        lines = self.collect(seconds)
        if time.monotonic() - self._noted < _MOMENT:
            return lines
        line = {"drive": {"event": "advance", "seconds": self.passed()}}
        return (Notification("history", line), *lines)

    def passed(self) -> float:
        """How much time has passed since this was asked last."""
        before, self._noted = self._noted, time.monotonic()
        return self.as_measured(self._noted - before)

    def as_measured(self, seconds: float) -> float:
        """A time as the oracle is told it, in whole microseconds."""
        return round(seconds, 6)

    def collect(self, seconds: float) -> tuple[Notification, ...]:
        """The lines that arrive within some time, on all connections."""
        found: list[Notification] = []
        until = time.monotonic() + seconds
        while True:
            there = {wire.sock.fileno(): wire for wire in self.wires.values() if wire.open}
            left = max(0.0, until - time.monotonic())
            if there:
                ready, _, _ = select.select(list(there), [], [], left)
            else:
                time.sleep(left)
                ready = []
            for one in ready:
                wire = there[one]
                found += [self.notice(wire.number, line) for line in wire.read() if line.strip()]
            if time.monotonic() >= until:
                return tuple(found)

    def close_all(self) -> None:
        """Close every connection."""
        for wire in self.wires.values():
            wire.close()
        self.wires.clear()

    def write(self, number: int, line: str) -> JSON:
        """Send a line on a connection, if that is open."""
        wire = self.wires.get(number)
        return {"happened": wire is not None and wire.open and wire.write(line)}

    def reset(self, world: JSON) -> tuple[Notification, ...]:
        """Have a fresh instance in a world; what of its history is known already."""
        raise NotImplementedError

    def drive(self, event: str, params: JSON) -> JSON:
        """Make something happen."""
        raise NotImplementedError

    def call(self, method: str, params: JSON) -> Exchange:
        """Answer a documented call."""
        raise SubjectError(f"{self.name} cannot be asked {method} {params!r}")

    def notice(self, number: int, line: str) -> Notification:
        """A line that has arrived."""
        raise NotImplementedError


class ServerBridge(_Bridge):
    """A mission server that listens at an address; the oracle's robots connect to it.

    Missions are submitted by an adapter (`submit`, `statuses` and `reset` of the protocol), or they are in a file that
    the server was given, and `submitted` are the lines of the history that say so. Such a server is started anew for
    every conversation by a program; without one it is there already, and there is one conversation.
    """

    drives = ("connect", "line", "disconnect", "advance")

    def __init__(
        self,
        host: str,
        port: int,
        tolerance: float,
        *,
        adapter: Subject | None = None,
        submitted: tuple[JSON, ...] = (),
        program: Program | None = None,
    ) -> None:
        super().__init__(tolerance)
        self.name = f"mission server at {host}:{port}"
        self._address = (host, port)
        self._adapter = adapter
        self._submitted = submitted
        self._program = program
        self._resets = self._made = 0

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Answer one request; an adapter is introduced first."""
        if method == "initialize" and self._adapter is not None:
            return evolved(self._adapter.exchange(method, params), self.drives)
        return super().exchange(method, params)

    def close(self) -> None:
        """Let go of everything."""
        self.close_all()
        if self._adapter is not None:
            self._adapter.close()
        if self._program is not None:
            self._program.close()

    def reset(self, world: JSON) -> tuple[Notification, ...]:
        """Have a fresh server, by its adapter or by its program, and wait until it listens."""
        self._resets += 1
        self._made = 0
        if self._adapter is not None:
            self._adapter.exchange("reset", {"world": {key: world[key] for key in world if key != "tolerance"}})
        elif self._program is not None:
            self._program.stop()
            if self._connected(_RETRY) is not None:
                raise SubjectError(f"something listens at {self._where} before the server was started")
            self._program.restart()
        elif self._resets > 1:
            raise SubjectError(f"the server at {self._where} cannot be started anew; give its command after --")
        self._listens()
        self._noted = time.monotonic()
        return tuple(Notification("history", line) for line in self._submitted)

    @property
    def _where(self) -> str:
        return f"{self._address[0]}:{self._address[1]}"

    def _listens(self) -> None:
        """Wait until somebody listens."""
        until = time.monotonic() + PATIENCE
        while (sock := self._connected(1.0)) is None:
            if self._program is not None and self._program.ended:
                raise SubjectError(f"the server exited before it listened{self._program.complaint()}")
            if time.monotonic() > until:
                raise SubjectError(f"nothing listens at {self._where} within {PATIENCE:g} s")
            time.sleep(_RETRY)
        sock.close()

    def _connected(self, timeout: float) -> socket.socket | None:
        try:
            return socket.create_connection(self._address, timeout)
        except OSError:
            return None

    def drive(self, event: str, params: JSON) -> JSON:
        """Be a robot."""
        if event == "connect":
            return self._connect()
        number = params["connection"]
        if event == "line":
            return self.write(number, params["line"])
        wire = self.wires.pop(number, None)
        if wire is None or not wire.open:
            return {"happened": False}
        wire.close()
        return {"happened": True}

    def _connect(self) -> JSON:
        sock = self._connected(PATIENCE)
        if sock is not None:
            self._made += 1
            self.wires[self._made] = Wire(self._made, sock)
            return {"happened": True, "connection": self._made}
        if self._adapter is None and self._made and (self._program is None or self._program.ended):
            return {"happened": False}  # it has served its file and is gone
        raise SubjectError(f"cannot connect to {self._where} any more")

    def call(self, method: str, params: JSON) -> Exchange:
        """Let the adapter answer."""
        if self._adapter is None:
            raise SubjectError(f"a server that takes its missions from a file cannot be asked {method}")
        return self._adapter.exchange(method, params)

    def notice(self, number: int, line: str) -> Notification:
        """A line from the server."""
        return Notification("line", {"connection": number, "line": line})


def evolved(introduced: Exchange, drives: tuple[str, ...]) -> Exchange:
    """What an adapter said of itself, with the drives of the bridge in place of its own."""
    result = introduced.result if isinstance(introduced.result, dict) else {}
    return Exchange({**result, "drives": list(drives)}, introduced.error)


class RobotBridge(_Bridge):
    """A robot that connects to the oracle's mission server.

    It is started anew for every conversation by a program; without one it connects by itself, and there is one
    conversation. Nobody stops its behavior tree but itself.
    """

    drives = ("line", "advance")

    def __init__(self, port: int, tolerance: float, *, host: str = "", program: Program | None = None) -> None:
        super().__init__(tolerance)
        self._program = program
        self._resets = 0
        try:
            self._listener = socket.create_server((host, port), backlog=1)
        except OSError as error:
            raise SubjectError(f"cannot listen on port {port}: {error.strerror}") from None
        self._listener.settimeout(PATIENCE)
        self.port: int = self._listener.getsockname()[1]
        self.name = f"robot at port {self.port}"

    def close(self) -> None:
        """Let go of everything."""
        self.close_all()
        self._listener.close()
        if self._program is not None:
            self._program.close()

    def _turn_away(self) -> None:
        """Close the connections of a robot that came back before it was stopped."""
        self._listener.settimeout(0)
        with contextlib.suppress(BlockingIOError):
            while True:
                self._listener.accept()[0].close()
        self._listener.settimeout(PATIENCE)

    def as_measured(self, seconds: float) -> float:
        """A time as the oracle is told it: a little less than it was."""
        return super().as_measured(max(0.0, seconds - self.tolerance))

    def reset(self, world: JSON) -> tuple[Notification, ...]:  # noqa: ARG002 - it has no parameters
        """Have a fresh robot, and wait until it connects."""
        self._resets += 1
        if self._program is not None:
            self._program.stop()
            self._turn_away()
            self._program.restart()
        elif self._resets > 1:
            raise SubjectError("the robot cannot be started anew; give its command after --")
        try:
            sock, _ = self._listener.accept()
        except TimeoutError:
            why = "" if self._program is None else self._program.complaint()
            raise SubjectError(f"no robot has connected to port {self.port} within {PATIENCE:g} s{why}") from None
        self.wires[1] = Wire(1, sock)
        self._noted = time.monotonic()
        return ()

    def drive(self, event: str, params: JSON) -> JSON:  # noqa: ARG002 - there is one
        """Be a server."""
        sent = self.write(1, params["line"])
        if not sent["happened"]:
            raise SubjectError("the robot has closed its connection; nothing more can be asked of it")
        return sent

    def notice(self, number: int, line: str) -> Notification:  # noqa: ARG002 - there is one
        """A line from the robot."""
        return Notification("line", {"line": line})


def address(text: str) -> tuple[str, int]:
    """``HOST:PORT``. Raises ValueError."""
    host, colon, port = text.rpartition(":")
    with contextlib.suppress(ValueError):
        if colon and host and 0 < int(port) < 1 << 16:
            return host.removeprefix("[").removesuffix("]"), int(port)
    raise ValueError(f"{text!r}: expected an address such as 127.0.0.1:9998")
