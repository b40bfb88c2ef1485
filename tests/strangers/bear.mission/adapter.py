"""The robot behind JSON-RPC lines on stdin and stdout."""

from __future__ import annotations

import copy
import json
from typing import TextIO

from errors import Refusal
from model import Json, World
from service import UNARY_CALLS, Fault, Robot

DRIVES = ["goalReached", "missionSucceeded", "missionFailed", "world", "fault"]
SYSTEM = "bear.mission"


class BadRequest(Exception):
    """A request that breaks the adapter protocol, with its JSON-RPC code."""

    def __init__(self, code: int, message: str) -> None:
        """Keep the code and a text for people."""
        super().__init__(message)
        self.code = code


class Adapter:
    """Carries requests to a robot and its answers and messages back."""

    def __init__(self, robot: type[Robot], name: str, output: TextIO) -> None:
        """Begin in the default world."""
        self.robot_class = robot
        self.name = name
        self.output = output
        self.robot = robot(World())
        self.last_stream = 0

    def serve(self, lines: TextIO) -> None:
        """Answer line by line until the end of the input."""
        for line in lines:
            if line.strip():
                self.handle(line)

    def handle(self, line: str) -> None:
        """Answer one line."""
        try:
            request = json.loads(line)
        except (ValueError, RecursionError):
            self.write({"id": None, "error": {"code": -32700, "message": "the line is not JSON"}})
            return
        if not isinstance(request, dict) or not isinstance(request.get("method"), str):
            self.write({"id": None, "error": {"code": -32600, "message": "the line is no request"}})
            return
        method = request["method"]
        answer = {"id": request.get("id"), **self.outcome(method, request.get("params", {}))}
        messages = self.robot.take_messages(method)
        before = messages if method == "settle" or self.robot.messages_first(method) else []
        for message in before:
            self.write({"method": "message", "params": message})
        self.write(answer)
        for message in messages if not before else []:
            self.write({"method": "message", "params": message})

    def write(self, item: Json) -> None:
        """Write one line."""
        self.output.write(json.dumps({"jsonrpc": "2.0", **item}) + "\n")
        self.output.flush()

    def outcome(self, method: str, params: object) -> Json:
        """The result or the error of a request."""
        try:
            if not isinstance(params, dict):
                raise BadRequest(-32602, "params has to be an object")
            return {"result": self.result(method, params)}
        except Refusal as refusal:
            error = {"code": refusal.code, "message": refusal.message, "data": {"status": refusal.status}}
            return {"error": error}
        except BadRequest as problem:
            return {"error": {"code": problem.code, "message": str(problem)}}

    def result(self, method: str, params: Json) -> Json:
        """The result of a request."""
        if method in UNARY_CALLS:
            return self.robot.call(method, copy.deepcopy(params))
        if method == "SubscribeMissionStatus":
            return self.subscribe(params)
        if method == "initialize":
            return self.initialize(params)
        if method == "reset":
            return self.reset(params)
        if method == "settle":
            return {}
        if method == "drive":
            return {"happened": self.drive(params)}
        if method == "cancel":
            self.robot.close_stream(params.get("stream", 0))
            return {}
        raise BadRequest(-32601, f"there is no method {method}")

    def initialize(self, params: Json) -> Json:
        """Say what this adapter is."""
        if params.get("protocolVersion") != 1 or params.get("system") != SYSTEM:
            raise BadRequest(-32602, f"this adapter speaks version 1 for {SYSTEM}")
        return {
            "implementation": {"name": self.name, "version": "1.0"},
            "drives": DRIVES,
            "concurrent": False,
        }

    def reset(self, params: Json) -> Json:
        """Begin anew in a world."""
        world = World()
        self.change(world, params.get("world") or {})
        self.robot = self.robot_class(world)
        return {}

    def change(self, world: World, fields: object) -> None:
        """Change a world, or call the request bad."""
        if not isinstance(fields, dict):
            raise BadRequest(-32602, "a world is an object")
        try:
            world.change(fields)
        except ValueError as problem:
            raise BadRequest(-32602, str(problem)) from None

    def subscribe(self, params: Json) -> Json:
        """Open a stream."""
        self.robot.subscribe(params, self.last_stream + 1)
        self.last_stream += 1
        return {"stream": self.last_stream}

    def drive(self, params: Json) -> bool:
        """Let something happen."""
        event = params.get("event")
        fields = {name: value for name, value in params.items() if name != "event"}
        if event == "goalReached":
            return self.robot.goal_reached()
        if event == "missionSucceeded":
            return self.robot.mission_succeeded()
        if event == "missionFailed":
            return self.robot.mission_failed()
        if event == "world" and "family" not in fields:
            self.change(World(), fields)
            self.robot.world_changed(fields)
            return True
        if event == "fault" and fields.get("status") in ("INTERNAL", "DEADLINE_EXCEEDED"):
            self.robot.fault = Fault(fields["status"], bool(fields.get("applied", False)))
            return True
        raise BadRequest(-32602, "there is no such drive")
