"""Fleets with one thing wrong each: the machine has to find it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from attrs import evolve

from missionfsm import Fleet
from missionfsm.bear.status.messages import ErrorCodes, RobotState
from missionfsm.fakes.errors import NotFound, PermissionDenied
from missionfsm.fakes.fleet import Updates


class ShowsSomeOfThem(Fleet):
    """Where a robot is not the account's, the others are shown in the place of PERMISSION_DENIED."""

    def _subscribe(self, endpoint: Any, robots: Iterable[str] | None, location: str | None) -> Updates[Any]:
        try:
            return super()._subscribe(endpoint, robots, location)
        except PermissionDenied:
            return Updates()


class EmptyLocations(Fleet):
    """A location without robots is no error."""

    def _subscribe(self, endpoint: Any, robots: Iterable[str] | None, location: str | None) -> Updates[Any]:
        try:
            return super()._subscribe(endpoint, robots, location)
        except NotFound:
            return Updates()


class KnowsEverybody(Fleet):
    """GetRobotStatus of another's robot is answered."""

    def get_status(self, robot_id: str) -> RobotState:
        try:
            return super().get_status(robot_id)
        except PermissionDenied:
            return RobotState()


class MisspeltIsUnknown(Fleet):
    """GetRobotStatus of another's robot is NOT_FOUND, a row that the table does not have."""

    def get_status(self, robot_id: str) -> RobotState:
        try:
            return super().get_status(robot_id)
        except PermissionDenied as refusal:
            raise NotFound("GetRobotStatus", None, refusal.citation, refusal.message) from None


class NeverFails(Fleet):
    """A robot that cannot be reached is answered for."""

    def fail_next(self) -> None:
        pass


class ForgetsVelocity(Fleet):
    """GetRobotStatus leaves the twist out."""

    def get_status(self, robot_id: str) -> RobotState:
        return evolve(super().get_status(robot_id), twist=None)


class TellsErrorsOnce(Fleet):
    """Error codes that change are not streamed."""

    def report(self, robot: str, part: str, value: Any) -> bool:
        told = self.__dict__.setdefault("told", set())
        if isinstance(value, ErrorCodes) and robot in told:
            return True
        told |= {robot} if isinstance(value, ErrorCodes) else set()
        return super().report(robot, part, value)


class FirstOnly(Fleet):
    """Of several robots only the first is shown."""

    def robot_status(self, robots: Iterable[str] | None = None, *, location: str | None = None) -> Updates[Any]:
        some = None if robots is None else list(robots)
        return super().robot_status(some[:1] if some and location is None else some, location=location)


class CountsBack(Fleet):
    """Sequence numbers become smaller, though not 0."""

    def report(self, robot: str, part: str, value: Any) -> bool:
        for updates in self._subscriptions.values():
            if updates._numbers.get(robot, 0) > 2:
                updates._numbers[robot] -= 1
        return super().report(robot, part, value)


BROKEN: tuple[type[Fleet], ...] = (
    ShowsSomeOfThem,
    EmptyLocations,
    KnowsEverybody,
    MisspeltIsUnknown,
    NeverFails,
    ForgetsVelocity,
    TellsErrorsOnce,
    FirstOnly,
    CountsBack,
)
