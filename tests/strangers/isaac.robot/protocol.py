"""The conversation on stdin and stdout: JSON-RPC 2.0, one object a line."""

from __future__ import annotations

import json
import math
from typing import Any, TextIO

from machine import Names, Robot
from variants import Options
from wire import Json

SYSTEM = "isaac.robot"
VERSION = 1
DRIVES = ("line", "behaviorSucceeded", "behaviorFailed", "advance", "disconnect", "connect")


class ProtocolError(Exception):
    """A request that the protocol itself refuses."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code


class Conversation:
    """Reads requests from one stream and writes answers and notifications to the other."""

    def __init__(self, options: Options, source: TextIO, sink: TextIO) -> None:
        self._options = options
        self._source = source
        self._sink = sink
        self._robot: Robot | None = None

    def run(self) -> None:
        """Serve until the end of the input."""
        for line in self._source:
            if line.strip():
                self._serve(line)

    def _serve(self, line: str) -> None:
        request_id: Any = None
        try:
            request = _parsed(line)
            request_id = request.get("id")
            method, params = request.get("method"), request.get("params")
            if not isinstance(method, str) or not isinstance(params, dict):
                raise ProtocolError(-32600, "a request needs a method and params")
            answer: Json = {"result": self._dispatch(method, params)}
        except ProtocolError as fault:
            answer = {"error": {"code": fault.code, "message": str(fault)}}
        self._write({"jsonrpc": "2.0", "id": request_id} | answer)
        if self._robot is not None:
            for sent in self._robot.outbox:
                self._write({"jsonrpc": "2.0", "method": "line", "params": {"line": sent}})
            self._robot.outbox.clear()
        self._sink.flush()

    def _dispatch(self, method: str, params: Json) -> Json:
        if method == "initialize":
            if params.get("protocolVersion") != VERSION or params.get("system") != SYSTEM:
                raise ProtocolError(-32602, f"this is {SYSTEM}, version {VERSION}")
            implementation = {"name": "robot", "version": "1.0"}
            return {"implementation": implementation, "drives": list(DRIVES), "concurrent": False}
        if method == "reset":
            self._robot = Robot(self._options, Names.from_world(params.get("world") or {}))
            return {}
        if method in ("settle", "cancel"):
            return {}
        if method != "drive":
            raise ProtocolError(-32601, f"no method {method}")
        if self._robot is None:
            self._robot = Robot(self._options, Names())
        return {"happened": _drive(self._robot, params)}

    def _write(self, message: Json) -> None:
        self._sink.write(json.dumps(message, separators=(",", ":")) + "\n")


def _drive(robot: Robot, params: Json) -> bool:
    event = params.get("event")
    if event == "line":
        line = params.get("line")
        if not isinstance(line, str):
            raise ProtocolError(-32602, "line must be a text")
        return robot.receive(line)
    if event in ("behaviorSucceeded", "behaviorFailed"):
        return robot.behavior(event == "behaviorSucceeded")
    if event == "advance":
        seconds = params.get("seconds")
        if isinstance(seconds, bool) or not isinstance(seconds, (int, float)):
            raise ProtocolError(-32602, "seconds must be a number")
        if not math.isfinite(seconds) or seconds < 0:
            raise ProtocolError(-32602, "seconds must not be negative")
        robot.advance(seconds)
        return True
    if event == "disconnect":
        return robot.disconnect()
    if event == "connect":
        return robot.connect()
    raise ProtocolError(-32602, "an unknown drive")


def _parsed(line: str) -> Json:
    try:
        request = json.loads(line)
    except ValueError as error:
        raise ProtocolError(-32700, "not JSON") from error
    if not isinstance(request, dict):
        raise ProtocolError(-32600, "not an object")
    return request
