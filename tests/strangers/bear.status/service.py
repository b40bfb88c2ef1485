"""The robot-status service of the cloud: its calls, its subscriptions and what the robots do."""

from __future__ import annotations

import copy
from itertools import count
from typing import Any

from access import Gate, Refusal
from schema import Json
from streams import Letter, Streams
from variants import Options
from views import METHODS, Views
from world import World, known_part, topics_of
from writing import Writer

DRIVES: tuple[str, ...] = ("report", "restart", "fault", "move")


class BadDrive(Exception):
    """A drive that is unknown or lacks a field."""


class FleetService:
    """One instance of the service with its world; a reset puts a new world in the place of the old one."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._writer = Writer(options)
        self._numbers = count(1)
        self.reset({})

    def reset(self, description: Json) -> None:
        """Begin again in the described world; every stream is forgotten."""
        self._world = World(self._options, description)
        self._gate = Gate(self._options, self._world)
        self._views = Views(self._options, self._world)
        self._streams = Streams(self._options, self._world, self._views)
        self._fault_armed = False

    def get_robot_status(self, request: Json) -> Json:
        """Answer a GetRobotStatus request."""
        on = self._options.on
        robot = self._gate.robot_for(request)
        if self._fault_armed:
            self._fault_armed = False
            if on("get-fault-as-precondition"):
                raise Refusal("FAILED_PRECONDITION", "the robot did not answer")
            if on("get-fault-as-empty"):
                return {"robotState": {}}
            if not on("get-fault-ignored"):
                raise Refusal("INTERNAL", "the robot did not answer")
        return self._writer.write("GetRobotStatus", {"robotState": self._views.status(robot)})

    def subscribe(self, method: str, request: Json) -> int:
        """Open a subscription and return its number."""
        selection = self._gate.select(request, METHODS[method])
        number = next(self._numbers)
        self._streams.open(number, method, selection)
        return number

    def cancel(self, number: Any) -> None:
        """End a subscription, if it is open."""
        if isinstance(number, int):
            self._streams.close(number)

    def settle(self) -> None:
        """Do what is due while nothing else happens."""
        if self._options.on("hybrid-repeats"):
            self._streams.repeat()

    def drive(self, params: Json) -> bool:
        """Let something happen in the world; tells whether it did."""
        event = params.get("event")
        if event == "report":
            return self._report(_text(params, "robotId"), _text(params, "part"), _field(params, "value"))
        if event == "restart":
            return self._restart(_text(params, "robotId"))
        if event == "move":
            return self._move(_text(params, "robotId"), _text(params, "locationId"))
        if event == "fault":
            if _text(params, "status") != "INTERNAL":
                raise BadDrive("only INTERNAL can be armed")
            self._fault_armed = True
            return True
        raise BadDrive("an unknown drive")

    def _report(self, robot_id: str, part: str, value: Any) -> bool:
        robot = self._world.robots.get(robot_id)
        if robot is None or not known_part(part):
            return False
        old = copy.deepcopy(robot.part(part))
        changed = self._world.report(robot, part, value)
        topics = topics_of(part)
        if not changed and self._options.on("hybrid-tells-every-report") and "state" in topics:
            self._world.record(robot, ("state",))
        self._streams.announce(robot, part, old, topics, changed)
        return True

    def _restart(self, robot_id: str) -> bool:
        robot = self._world.robots.get(robot_id)
        if robot is None:
            return False
        self._world.restart(robot)
        if self._options.on("restart-shows-zero"):
            self._streams.show_again(robot)
        return True

    def _move(self, robot_id: str, location_id: str) -> bool:
        robot = self._world.robots.get(robot_id)
        if robot is None or location_id not in self._world.locations:
            return False
        robot.location_id = location_id
        self._streams.moved(robot, location_id)
        return True

    def collect(self, settling: bool) -> list[Json]:
        """The notifications that are to be written now."""
        if not settling and (self._options.on("late-delivery") or self._options.on("updates-reversed")):
            return []
        letters = self._streams.outbox
        self._streams.outbox = []
        if self._options.on("updates-reversed"):
            updates = [letter for letter in letters if letter.update]
            letters = [letter for letter in letters if not letter.update] + updates[::-1]
        return [self._notification(letter) for letter in letters]

    def _notification(self, letter: Letter) -> Json:
        if letter.message is None:
            return {"jsonrpc": "2.0", "method": "closed", "params": {"stream": letter.stream.number}}
        message = self._writer.write(letter.stream.method, letter.message)
        return {"jsonrpc": "2.0", "method": "message", "params": {"stream": letter.stream.number, "message": message}}


def _field(params: Json, name: str) -> Any:
    if name not in params:
        raise BadDrive(f"{name} is missing")
    return params[name]


def _text(params: Json, name: str) -> str:
    value = _field(params, name)
    if not isinstance(value, str):
        raise BadDrive(f"{name} must be a text")
    return value
