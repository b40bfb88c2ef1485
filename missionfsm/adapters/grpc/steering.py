"""Drives and resets that a tester asks of a robot's control service, as lines of the history.

A drive that happened is a line at the place where it was asked for, and a reset begins another conversation. Only the
answer says whether it happened, and the messages that it causes may come before the answer: until then all lines wait.
"""

from __future__ import annotations

from typing import Any

from attrs import Factory, define, frozen
from google.protobuf.message import DecodeError

from missionfsm.adapters.grpc import control
from missionfsm.adapters.grpc.framing import Messages
from missionfsm.kernel.codec import JSON, UnreadableError

Line = dict[str, JSON]
DESCRIBE, DRIVE, RESET = "Describe", "Drive", "Reset"
PATHS = {f"/{control.SERVICE}/{name}".encode(): name for name in (DESCRIBE, DRIVE, RESET)}
"""The paths of those calls of the control service that say something about the robot."""
REFUSED = ("INVALID_ARGUMENT", "UNIMPLEMENTED", "UNAUTHENTICATED", "PERMISSION_DENIED", "NOT_FOUND")
"""Errors of a call of the control service that had no effect; any other error leaves that open."""


@frozen
class Steered:
    """The begin or the end of a call of the control service.

    Attributes:
        call: identifies the call among those that are under way.
        name: the name of the call.
        params: its params.
        result: its answer, if it has ended; None if it was refused.
        ended: whether it has ended.
        lost: whether it has ended without an answer, so that its effect is not known.
    """

    call: tuple[int, int]
    name: str
    params: JSON = None
    result: JSON = None
    ended: bool = False
    lost: bool = False


@define
class Steers:
    """A call of the control service that is under way."""

    call: tuple[int, int]
    name: str
    sent: Messages
    answered: Messages = Factory(Messages)
    params: JSON = None
    result: JSON = None


@define
class _Place:
    """The place of a drive or a reset among the lines that wait, with the lines that it makes once they are known."""

    name: str
    params: JSON
    at: float
    lines: list[Line] | None = None


@define
class Steering:
    """Puts drives and resets among the lines of a history, in the order of what came by.

    Attributes:
        system: of which the history is.
        others: whether others use the robot past the proxy; then they do so after a reset as well.
        drives: those that the control service says it has.
    """

    system: str
    others: bool = False
    drives: tuple[str, ...] = ()
    _open: dict[tuple[int, int], _Place] = Factory(dict)
    _waiting: list[Line | _Place] = Factory(list)

    def line(self, line: Line) -> list[Line]:
        """The lines that are known to come next, with this one behind them."""
        if not self._waiting:
            return [line]
        self._waiting.append(line)
        return []

    def steered(self, what: Steered, at: float) -> tuple[list[Line], bool]:
        """The lines that are known to come next, and whether the robot was reset: what was under way is forgotten then.

        Raises:
            UnreadableError: nobody knows what became of a drive or a reset.
        """
        if not what.ended:
            if what.name != DESCRIBE:
                self._open[what.call] = _Place(what.name, what.params, at)
                self._waiting.append(self._open[what.call])
            return [], False
        answer = what.result if isinstance(what.result, dict) else {}
        if what.name == DESCRIBE:
            if answer.get("system") == self.system:
                self.drives = tuple(name for name in answer.get("drives", ()) if isinstance(name, str))
            return [], False
        if what.call not in self._open:
            return [], False
        place = self._open.pop(what.call)
        if what.lost:
            raise UnreadableError(f"nobody knows what became of a {what.name} that the control service was asked for")
        reset = place.name == RESET and what.result is not None
        if reset:
            place.lines = [self._head(place.params)]
            del self._waiting[self._waiting.index(place) + 1 :]  # it was of what is forgotten now
            self._open.clear()
        else:
            happened = place.name == DRIVE and answer.get("happened") is True
            place.lines = [{"drive": place.params, "at": place.at}] if happened else []
        return list(self._known()), reset

    def _head(self, params: JSON) -> Line:
        world = params.get("world", {}) if isinstance(params, dict) else {}
        first: dict[str, Any] = {"missionfsm": 1, "system": self.system, "world": world, "drives": list(self.drives)}
        return {**first, "others": True} if self.others else first

    def _known(self) -> list[Line]:
        """Takes off what waits no more."""
        known: list[Line] = []
        while self._waiting:
            first = self._waiting[0]
            if isinstance(first, _Place):
                if first.lines is None:
                    break
                known += first.lines
            else:
                known.append(first)
            del self._waiting[0]
        return known


def struct(message: bytes | str) -> JSON:
    """What the control service was asked or answers; {} for bytes that are no message of it."""
    try:
        return {} if isinstance(message, str) else control.unpack(message)
    except (DecodeError, ValueError):
        return {}


__all__ = ["PATHS", "REFUSED", "Line", "Steered", "Steering", "Steers", "struct"]
