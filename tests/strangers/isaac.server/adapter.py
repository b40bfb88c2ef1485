"""The adapter: JSON-RPC over standard input and output around one mission server."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any, TextIO

from mission import SECOND, MissionRefused
from mission_server import MissionServer, Numbers
from variants import Variant

VERSION = "1.0"
"""Version of this implementation."""

DRIVES = ("connect", "line", "disconnect", "advance")
"""What a tester can make happen."""


class RpcError(Exception):
    """An answer that is an error."""

    def __init__(self, code: int, message: str, status: str | None = None) -> None:
        """An error with its code, its text and, where it is a documented one, its status."""
        super().__init__(message)
        self.code = code
        self.status = status

    def as_json(self) -> dict[str, Any]:
        """The error object of the answer."""
        error: dict[str, Any] = {"code": self.code, "message": str(self)}
        if self.status is not None:
            error["data"] = {"status": self.status}
        return error


def _invalid(message: str) -> RpcError:
    return RpcError(-32602, message)


def _number(params: dict[str, Any], member: str) -> int:
    value = params.get(member)
    if isinstance(value, bool) or not isinstance(value, int):
        raise _invalid(f"{member} must be a whole number")
    return value


class Adapter:
    """Answers requests one after the other."""

    def __init__(self, name: str, output: TextIO, variant: Variant) -> None:
        """An adapter in the default world."""
        self._name = name
        self._output = output
        self._variant = variant
        self._numbers = Numbers()
        self._notifications: list[dict[str, Any]] = []
        self._server = self._new_server("name")
        self._methods: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
            "initialize": self._initialize,
            "reset": self._reset,
            "settle": lambda params: {},
            "drive": self._drive,
            "cancel": lambda params: {},
            "submit": self._submit,
            "statuses": self._statuses,
        }

    def run(self, requests: TextIO) -> None:
        """Answer requests until the input ends."""
        for line in requests:
            if line.strip():
                self._answer(line)

    def _new_server(self, name_channel: str) -> MissionServer:
        return MissionServer(name_channel, self._numbers, self._notify, self._variant)

    def _notify(self, method: str, params: dict[str, Any]) -> None:
        self._notifications.append({"jsonrpc": "2.0", "method": method, "params": params})

    def _write(self, message: dict[str, Any]) -> None:
        self._output.write(json.dumps(message, separators=(",", ":")) + "\n")

    def _answer(self, line: str) -> None:
        identity: Any = None
        answer: dict[str, Any]
        try:
            try:
                request = json.loads(line)
            except (ValueError, RecursionError):
                raise RpcError(-32700, "not JSON") from None
            if not isinstance(request, dict) or not isinstance(request.get("method"), str):
                raise RpcError(-32600, "not a request")
            identity = request.get("id")
            answer = {"result": self._call(request["method"], request.get("params", {}))}
        except RpcError as error:
            answer = {"error": error.as_json()}
        self._write({"jsonrpc": "2.0", "id": identity, **answer})
        for notification in self._notifications:
            self._write(notification)
        self._notifications.clear()
        self._output.flush()

    def _call(self, method: str, params: Any) -> dict[str, Any]:
        handler = self._methods.get(method)
        if handler is None:
            raise RpcError(-32601, f"no method {method}")
        if not isinstance(params, dict):
            raise _invalid("params must be an object")
        return handler(params)

    def _initialize(self, params: dict[str, Any]) -> dict[str, Any]:
        if params.get("protocolVersion") != 1 or params.get("system") != "isaac.server":
            raise _invalid("this adapter speaks version 1 for isaac.server")
        implementation = {"name": self._name, "version": VERSION}
        return {"implementation": implementation, "drives": list(DRIVES), "concurrent": False}

    def _reset(self, params: dict[str, Any]) -> dict[str, Any]:
        world = params.get("world", {})
        if not isinstance(world, dict) or not isinstance(world.get("nameChannel", "name"), str):
            raise _invalid("world must be an object with a nameChannel")
        self._server = self._new_server(world.get("nameChannel", "name"))
        return {}

    def _submit(self, params: dict[str, Any]) -> dict[str, Any]:
        try:
            return {"mission": self._server.submit(params.get("mission"))}
        except MissionRefused as refusal:
            raise RpcError(3, str(refusal), "INVALID_ARGUMENT") from None

    def _statuses(self, params: dict[str, Any]) -> dict[str, Any]:
        return {"missions": {str(handle): status for handle, status in self._server.statuses().items()}}

    def _drive(self, params: dict[str, Any]) -> dict[str, Any]:
        event = params.get("event")
        if event == "connect":
            return {"happened": True, "connection": self._server.connect()}
        if event == "line":
            line = params.get("line")
            if not isinstance(line, str):
                raise _invalid("line must be a string")
            return {"happened": self._server.line(_number(params, "connection"), line)}
        if event == "disconnect":
            return {"happened": self._server.disconnect(_number(params, "connection"))}
        if event == "advance":
            self._server.advance(self._seconds(params.get("seconds")))
            return {"happened": True}
        raise _invalid("unknown drive")

    @staticmethod
    def _seconds(seconds: Any) -> int:
        if isinstance(seconds, bool) or not isinstance(seconds, (int, float)):
            raise _invalid("seconds must be a number")
        if not math.isfinite(seconds) or seconds < 0:
            raise _invalid("seconds must be finite and not negative")
        return round(Fraction(seconds) * SECOND)
