"""The adapter protocol over stdin and stdout: the reference as a server, and a child process as a subject.

The protocol is JSON-RPC 2.0, one object a line. Everything that a child may do wrong ends in a `SubjectError` that says
what it was: the child cannot be started, exits, hangs, writes rubbish, or writes too much.
"""

from __future__ import annotations

import contextlib
import os
import selectors
import subprocess
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import IO, Any

import orjson

from missionfsm.adapters.jsonlines import TooDeepError, loads
from missionfsm.adapters.processes import end_group, refuse_where_there_are_no_sessions
from missionfsm.adapters.stderrlog import Log
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.rules import STATUS_NUMBERS
from missionfsm.kernel.subject import Exchange, MissingMethodError, Notification, Subject, SubjectError
from missionfsm.kernel.text import brief

LONGEST_LINE = 64 * 1024 * 1024
"""Bytes in one line before a child counts as flooding."""

MAX_NOTIFICATIONS = 100_000
"""Notifications between two answers before a child counts as flooding."""

MAX_READS = 100
"""How many times what is left in a pipe is asked for before somebody counts as writing without end."""

MOMENT = 0.05
"""Seconds after which a child that says nothing is looked at whether it is still there."""

ASKED = 160
"""Characters of what a child was sent that an error message shows."""

GRACE = 1.0
"""Seconds that an answer may still take once a run was stopped."""

PARSE_ERROR, INVALID_REQUEST, NO_METHOD, INVALID_PARAMS = -32700, -32600, -32601, -32602

Trace = Callable[[str, bytes], None]
"""Given every line, after ``>`` if it was sent and ``<`` if it was received."""


# The reference as a server.


def serve(subject: Subject, requests: IO[bytes], responses: IO[bytes]) -> None:
    """Answer requests until their end, in order."""
    for line in requests:
        if line.strip():
            # In one piece: what follows an answer is there when the answer is, however much that is.
            responses.write(b"".join(orjson.dumps(one) + b"\n" for one in _respond(subject, line)))
            responses.flush()


def _respond(subject: Subject, line: bytes) -> list[JSON]:
    try:
        request = loads(line)
    except UnreadableError as error:
        return [_failure(None, PARSE_ERROR, str(error))]
    if not isinstance(request, dict) or not isinstance(request.get("method"), str):
        return [_failure(None, INVALID_REQUEST, "a request has a method")]
    number = request.get("id")
    try:
        exchange = subject.exchange(request["method"], request.get("params", {}))
    except SubjectError as error:
        return [_failure(number, INVALID_PARAMS, str(error))]
    answer: JSON = {"jsonrpc": "2.0", "id": number}
    if exchange.error is None:
        answer["result"] = exchange.result
    else:
        status = exchange.error["status"]
        answer["error"] = {
            "code": STATUS_NUMBERS[status],
            "message": exchange.error.get("message", ""),
            "data": {"status": status},
        }
    return [*map(_notice, exchange.before), answer, *map(_notice, exchange.after)]


def _notice(notification: Notification) -> JSON:
    return {"jsonrpc": "2.0", "method": notification.method, "params": notification.params}


def _failure(number: JSON, code: int, says: str) -> JSON:
    return {"jsonrpc": "2.0", "id": number, "error": {"code": code, "message": says}}


# A child process as a subject.


def _begins(line: bytes | bytearray) -> str:
    """How a line begins, as an error message shows it."""
    return brief(line[:80].decode(errors="replace"))


class Child:
    """A child process that speaks the protocol; it is started at once.

    Args:
        command: the program and its arguments.
        timeout: seconds that an answer may take.
        stopped: asked while an answer is waited for: whether the run was stopped, so that it is not waited for long.
        trace: told of every line in both directions.
        folder: where the program is started; None is where this one runs.

    Raises:
        SubjectError: the program cannot be started.
    """

    def __init__(
        self,
        command: Sequence[str],
        timeout: float = 10.0,
        *,
        stopped: Callable[[], bool] = lambda: False,
        trace: Trace = lambda _, __: None,
        folder: str | None = None,
    ) -> None:
        self.command = tuple(command)
        self.timeout = timeout
        self._stopped = stopped
        self._trace = trace
        self._asked = ""
        refuse_where_there_are_no_sessions()
        pipe = subprocess.PIPE
        try:
            self._process = subprocess.Popen(  # noqa: S603 - running the user's command is the purpose
                self.command, stdin=pipe, stdout=pipe, stderr=pipe, bufsize=0, start_new_session=True, cwd=folder
            )
        except OSError as error:
            message = f"cannot start {self.command[0]}: {error.strerror}"
            raise SubjectError(message) from None
        assert self._process.stdin is not None  # noqa: S101 - it was asked for
        assert self._process.stdout is not None  # noqa: S101
        assert self._process.stderr is not None  # noqa: S101
        self._in, self._out = self._process.stdin.fileno(), self._process.stdout.fileno()
        self._errors, self._err = self._process.stderr, self._process.stderr.fileno()
        self._selector = selectors.DefaultSelector()
        for end in (self._in, self._out, self._err):
            os.set_blocking(end, False)
        for end in (self._out, self._err):
            self._selector.register(end, selectors.EVENT_READ)
        self._log = Log()
        self._partial = bytearray()
        self._lines: deque[bytes] = deque()
        self._serial = 0

    def close(self) -> None:
        """End its input, give it a moment, then end it and whatever it has started."""
        if self._errors.closed:
            return
        self._selector.close()
        try:
            for pipe in (self._process.stdin, self._process.stdout):
                if pipe is not None:
                    with contextlib.suppress(OSError):
                        pipe.close()
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(0.5)
        finally:
            end_group(self._process)
            self._errors.close()

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Send a request and wait for its answer."""
        self._serial += 1
        request = {"jsonrpc": "2.0", "id": self._serial, "method": method, "params": params}
        deadline = time.monotonic() + self.timeout
        line = orjson.dumps(request)
        self._asked = f"{method} {orjson.dumps(params).decode()}"
        self._trace(">", line)
        self._write(line + b"\n", deadline, method)
        before: list[Notification] = []
        while True:
            message = self._parse(self._line(deadline, method))
            if "id" not in message:
                before.append(self._notification(message))
                if len(before) > MAX_NOTIFICATIONS:
                    raise self._failed(
                        f"flooded: more than {MAX_NOTIFICATIONS} notifications before answering {method}"
                    )
                continue
            return self._answer(message, tuple(before), method)

    def _answer(self, message: dict[str, Any], before: tuple[Notification, ...], method: str) -> Exchange:
        if message["id"] != self._serial:
            raise self._failed(f"answered request {brief(message['id'])} instead of {self._serial} ({method})")
        after = self._at_hand()
        if message.get("error") is None and message.get("result") is not None:
            return Exchange(message["result"], None, before, after)  # an error that is null is absent
        if "error" not in message:
            if "result" not in message:
                raise self._failed(f"answered {method} without a result or an error: {brief(message)}")
            return Exchange(None, None, before, after)
        return Exchange(None, self._error(message["error"], method), before, after)

    def _error(self, error: JSON, method: str) -> dict[str, str]:
        """The gRPC status that an error of JSON-RPC stands for."""
        code = error.get("code") if isinstance(error, dict) else None
        if isinstance(code, bool) or not isinstance(code, int):
            raise self._failed(f"answered {method} with an error without a code: {brief(error)}")
        if code == NO_METHOD:
            says = f"answered {method} with JSON-RPC error {code}: it does not have it"
            raise MissingMethodError(self._failed(says).args[0])
        if code < 0:
            raise self._failed(f"answered {method} with JSON-RPC error {code}: {brief(error.get('message', ''))}")
        data = error.get("data")
        status = data.get("status") if isinstance(data, dict) else None
        if status is None:
            status = next((name for name, number in STATUS_NUMBERS.items() if number == code), None)
        if not isinstance(status, str) or status == "OK" or STATUS_NUMBERS.get(status) != code:
            raise self._failed(f"answered {method} with error {code}, status {brief(status)}: not a gRPC error")
        said = error.get("message", "")
        return {"status": status, "message": said if isinstance(said, str) else ""}

    def _notification(self, message: dict[str, Any]) -> Notification:
        method, params = message.get("method"), message.get("params")
        ending = "connection" if isinstance(params, dict) and "connection" in params else "stream"
        wanted = {"message": ("stream", "message"), "closed": (ending,), "line": ("line",)}.get(str(method))
        if wanted is None or not isinstance(params, dict) or any(key not in params for key in wanted):
            raise self._failed(f"sent something that is no notification of the protocol: {brief(message)}")
        for key in ("stream", "connection"):
            if key in params and (isinstance(params[key], bool) or not isinstance(params[key], int)):
                raise self._failed(f"sent a notification whose {key} is {brief(params[key])}")
        return Notification(str(method), params)

    def _at_hand(self) -> tuple[Notification, ...]:
        """The notifications that have arrived in full and stand before anything else."""
        self._read_available()
        found: list[Notification] = []
        while self._lines:
            message = self._parse(self._lines[0])
            if "id" in message:
                break
            self._lines.popleft()
            found.append(self._notification(message))
        return tuple(found)

    def _parse(self, line: bytes) -> dict[str, Any]:
        try:
            message = loads(line)
        except UnreadableError as error:
            what = error if isinstance(error, TooDeepError) else "not JSON"
            raise self._failed(f"wrote a line that is {what}: {_begins(line)}") from None
        if not isinstance(message, dict):
            raise self._failed(f"wrote a line that is not a JSON object: {brief(message)}")
        return message

    def _write(self, data: bytes, deadline: float, method: str) -> None:
        view = memoryview(data)
        while view:
            try:
                view = view[os.write(self._in, view) :]
            except BlockingIOError:
                # A child that does not read may be busy writing: take what it has, or both would wait for ever.
                self._read_available()
                self._read_log()
                if time.monotonic() > deadline:
                    raise self._failed(f"did not read {method} within {self.timeout:g} s") from None
                time.sleep(0.001)
            except OSError:
                raise self._exited(method) from None

    def _line(self, deadline: float, method: str) -> bytes:
        ended_early = False
        while not self._lines:
            if not ended_early and self._stopped():
                ended_early, deadline = True, min(deadline, time.monotonic() + GRACE)
            left = deadline - time.monotonic()
            if left <= 0:
                when = "when the run was stopped" if ended_early else f"within {self.timeout:g} s"
                raise self._failed(f"did not answer {method} {when}")
            ready = {key.fd for key, _ in self._selector.select(min(left, MOMENT))}
            if self._err in ready:
                self._read_log()
            # What it has started may hold its output open for longer than it lives itself.
            gone = self._out not in ready and self._process.poll() is not None
            if self._out in ready or gone:
                ended = not self._read_available() or gone
                if ended and not self._lines:
                    raise self._exited(method)
        return self._lines.popleft()

    def _read_available(self) -> bool:
        """Take what has arrived; False at the end of its output."""
        while True:
            try:
                data = os.read(self._out, 1 << 20)
            except BlockingIOError:
                return True
            except (OSError, ValueError):
                return False
            if not data:
                return False
            *whole, rest = data.split(b"\n")
            for part in whole:
                self._lines.append(bytes(self._partial) + part if self._partial else part)
                self._trace("<", self._lines[-1])
                self._partial.clear()
            self._partial += rest
            if len(self._partial) > LONGEST_LINE:
                raise self._failed(f"flooded: a line of more than {LONGEST_LINE} bytes")
            if len(self._lines) > MAX_NOTIFICATIONS:
                raise self._failed(f"flooded: more than {MAX_NOTIFICATIONS} lines at a time")
            if len(data) < 1 << 20:
                return True

    def _read_log(self) -> bool:
        """Take some of what it has written to stderr and keep the end; False if there is no more for now."""
        try:
            data = os.read(self._err, 1 << 16)
        except BlockingIOError:
            return False
        if not data:
            with contextlib.suppress(KeyError):
                self._selector.unregister(self._err)
        self._log.add(data)
        return bool(data)

    def _exited(self, method: str) -> SubjectError:
        try:
            status = self._process.wait(0.5)
        except subprocess.TimeoutExpired:
            return self._failed(f"closed its output before answering {method}")
        ended = f"was ended by signal {-status}" if status < 0 else f"exited with status {status}"
        half = f", in the middle of the line {_begins(self._partial)}" if self._partial else ""
        return self._failed(f"{ended} before answering {method}{half}")

    def _failed(self, says: str) -> SubjectError:
        for _ in range(MAX_READS):  # one that floods has always more
            if not self._read_log():
                break
        asked = f"; it was sent {self._asked[:ASKED]}{'…' * (len(self._asked) > ASKED)}" if self._asked else ""
        return SubjectError(f"the adapter {says}{self._log.complaint()}{asked}")
