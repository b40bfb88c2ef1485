"""Whose line it is, and when it was written: what any line of a history may carry."""

from __future__ import annotations

from typing import Any

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.text import brief

_ROBOT = ("robotId", "robot_id")
"""How a request of a vendor's cloud, and a message of its streams, names the robot."""

_OF_A_ROBOT = frozenset({"call", "stream", "drive"})
"""What a line has that is of a robot: who answers, and when all is settled, needs no name."""


class Addresses:
    """Finds which robot each line is about, and checks that ``at`` never goes down for one robot.

    Args:
        by_params: whether the params of a call may name its robot. Its answer, and messages of a stream that it opened,
            are about that robot as well. Where only one robot is named, lines that name none are about it too.

    Attributes:
        by_call: whether any call said so.
    """

    def __init__(self, *, by_params: bool = False) -> None:
        self._by_params = by_params
        self._latest: dict[str | None, float] = {}
        self._calls: dict[Any, str] = {}
        self._streams: dict[Any, str] = {}
        self._names: dict[str, None] = {}
        self._nameless = self._nameless_first = False
        self.by_call = False

    @property
    def undecided(self) -> bool:
        """Whether no line has said yet, or left unsaid, which robot it is about."""
        return self._by_params and not self._names and not self._nameless

    def whose(self, line: JSON) -> tuple[str | None, JSON]:
        """The robot of a line, and the line without what only names the robot. Raises UnreadableError."""
        if not isinstance(line, dict):
            message = f"{brief(line)} is not an object"
            raise UnreadableError(message)
        robot = line.get("robot")
        if robot is None and "robot" not in line:
            if self._by_params:
                named, line = self._addressed(line)
                robot = self._only_one(named, line)
        elif not isinstance(robot, str):
            message = f"robot: {brief(robot)} is not a text"
            raise UnreadableError(message)
        if "at" in line:
            self._at(robot, line["at"])
        return robot, line

    def _at(self, robot: str | None, at: JSON) -> None:
        if isinstance(at, bool) or not isinstance(at, int | float):
            message = f"at: {brief(at)} is not a number of seconds"
            raise UnreadableError(message)
        latest = self._latest.get(robot)
        if latest is not None and at < latest:
            whose = "" if robot is None else f" of {brief(robot)}"
            message = (
                f"at: {at} comes after {latest}{whose}; a robot's times never go back, so leave out all but one clock's"
            )
            raise UnreadableError(message)
        self._latest[robot] = at

    def _only_one(self, named: str | None, line: dict[str, JSON]) -> str | None:
        """Whose line it is, where one robot may be named in some lines only.

        All lines are about nobody in particular if the first of them are, which is how the judge of those goes on.

        Raises:
            UnreadableError: several robots are named, and some lines name none.
        """
        if named is not None:
            self._names[named] = None
        elif not _OF_A_ROBOT.isdisjoint(line):
            self._nameless_first = self._nameless_first or not self._names
            self._nameless = True
        if len(self._names) < 2:
            return None if self._nameless_first else next(iter(self._names), None)
        if self._nameless:
            several = " and ".join(brief(name) for name in list(self._names)[:2])
            message = f"params name several robots, as {several}, but not everywhere: give every line its `robot`"
            raise UnreadableError(message)
        return named

    def _addressed(self, line: dict[str, JSON]) -> tuple[str | None, JSON]:
        """Whose line it is by what a call said before, or says itself."""
        if "call" in line:
            robot, params = _named(line.get("params"))
            robot = robot or _selected(params)
            if robot is None:
                return None, line
            self.by_call = True
            if _is_number(line["call"]):
                self._calls[line["call"]] = robot
            return robot, {**line, "params": params}
        if not self.by_call:
            return None, line
        if "return" in line:
            robot = self._calls.pop(line["return"], None) if _is_number(line["return"]) else None
            stream = line["result"].get("stream") if isinstance(line.get("result"), dict) else None
            if robot is not None and _is_number(stream):
                self._streams[stream] = robot
            return robot, line
        stream = line.get("stream")
        named, message = _named(line.get("message"))
        robot = self._streams.get(stream, named) if _is_number(stream) else named
        return robot, line if named is None else {**line, "message": message}


def _named(given: JSON) -> tuple[str | None, JSON]:
    """The robot that an object names, and the object without that."""
    if isinstance(given, dict):
        for key in _ROBOT:
            if key in given and isinstance(given[key], str) and given[key]:
                return given[key], {name: value for name, value in given.items() if name not in _ROBOT}
    return None, given


def _selected(params: JSON) -> str | None:
    """The only robot that a subscription selects, as those to a vendor's cloud do."""
    try:
        (robot,) = params["selector"]["robotIds"]["ids"]
    except (KeyError, TypeError, ValueError, IndexError):
        return None
    return robot if isinstance(robot, str) and robot else None


def _is_number(value: JSON) -> bool:
    return type(value) is int
