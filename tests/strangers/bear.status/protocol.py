"""The conversation on stdin and stdout: JSON-RPC 2.0, one object a line."""

from __future__ import annotations

import json
from typing import Any, TextIO

from access import Refusal
from schema import Json
from service import DRIVES, BadDrive, FleetService
from views import METHODS

SYSTEM = "bear.status"
VERSION = 1


class ProtocolError(Exception):
    """A request that the protocol itself refuses."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code


class Conversation:
    """Reads requests from one stream and writes answers and notifications to the other."""

    def __init__(self, service: FleetService, source: TextIO, sink: TextIO) -> None:
        self._service = service
        self._source = source
        self._sink = sink

    def run(self) -> None:
        """Serve until the end of the input."""
        for line in self._source:
            if line.strip():
                self._serve(line)

    def _serve(self, line: str) -> None:
        request_id: Any = None
        settling = False
        try:
            request = _parsed(line)
            request_id = request.get("id")
            method = request.get("method")
            params = request.get("params")
            if not isinstance(method, str) or not isinstance(params, dict):
                raise ProtocolError(-32600, "a request needs a method and params")
            settling = method == "settle"
            answer: Json = {"result": self._dispatch(method, params)}
        except Refusal as refusal:
            answer = {"error": {"code": refusal.code, "message": str(refusal), "data": {"status": refusal.status}}}
        except BadDrive as fault:
            answer = {"error": {"code": -32602, "message": str(fault)}}
        except ProtocolError as fault:
            answer = {"error": {"code": fault.code, "message": str(fault)}}
        if settling:
            self._notify(True)
        self._write({"jsonrpc": "2.0", "id": request_id} | answer)
        if not settling:
            self._notify(False)
        self._sink.flush()

    def _dispatch(self, method: str, params: Json) -> Json:
        if method == "initialize":
            if params.get("protocolVersion") != VERSION or params.get("system") != SYSTEM:
                raise ProtocolError(-32602, f"this is {SYSTEM}, version {VERSION}")
            implementation = {"name": "fleet", "version": "1.0"}
            return {"implementation": implementation, "drives": list(DRIVES), "concurrent": False}
        if method == "reset":
            self._service.reset(params.get("world") or {})
            return {}
        if method == "settle":
            self._service.settle()
            return {}
        if method == "drive":
            return {"happened": self._service.drive(params)}
        if method == "cancel":
            self._service.cancel(params.get("stream"))
            return {}
        if method == "GetRobotStatus":
            return self._service.get_robot_status(params)
        if method in METHODS:
            return {"stream": self._service.subscribe(method, params)}
        raise ProtocolError(-32601, f"no method {method}")

    def _notify(self, settling: bool) -> None:
        for notification in self._service.collect(settling):
            self._write(notification)

    def _write(self, message: Json) -> None:
        self._sink.write(json.dumps(message, separators=(",", ":")) + "\n")


def _parsed(line: str) -> Json:
    try:
        request = json.loads(line)
    except ValueError as error:
        raise ProtocolError(-32700, "not JSON") from error
    if not isinstance(request, dict):
        raise ProtocolError(-32600, "not an object")
    return request
