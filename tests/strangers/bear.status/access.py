"""Which robots a request asks for, and whether the client may see them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from schema import Json
from variants import Options
from world import Robot, World

CODES = {
    "INVALID_ARGUMENT": 3,
    "NOT_FOUND": 5,
    "PERMISSION_DENIED": 7,
    "FAILED_PRECONDITION": 9,
    "INTERNAL": 13,
}


class Refusal(Exception):
    """A request is answered with a documented error."""

    def __init__(self, status: str, message: str) -> None:
        super().__init__(message)
        self.status = status
        self.code = CODES[status]


@dataclass
class Selection:
    """What a selector chose: the robots by id, or those at a location."""

    robot_ids: list[str]
    location_id: str | None = None


def invalid(message: str) -> Refusal:
    """The refusal of a request that is not well formed."""
    return Refusal("INVALID_ARGUMENT", message)


def denied(message: str) -> Refusal:
    """The refusal of a robot or a location that is not the client's."""
    return Refusal("PERMISSION_DENIED", message)


def member(message: Json, camel: str, snake: str) -> Any:
    """A field of a request, by either of its names; None where it is not there."""
    value = message.get(camel)
    return message.get(snake) if value is None else value


class Gate:
    """Checks requests against the world."""

    def __init__(self, options: Options, world: World) -> None:
        self._options = options
        self._world = world

    def robot_for(self, request: Json) -> Robot:
        """The robot that a GetRobotStatus request names."""
        on = self._options.on
        self._known_fields(request, {"robotId", "robot_id"})
        robot_id = member(request, "robotId", "robot_id")
        if robot_id is None and on("get-missing-id-first"):
            owned = [robot for robot in self._world.robots.values() if robot.owned]
            if owned:
                return owned[0]
        if robot_id is not None and not isinstance(robot_id, str):
            raise invalid("robot_id must be a text")
        if not robot_id or self._blank(robot_id):
            if on("get-empty-id-denied"):
                raise denied("no such robot")
            raise invalid("robot_id must not be empty")
        robot = self._world.robots.get(robot_id)
        if robot is None:
            raise Refusal("NOT_FOUND" if on("get-unknown-not-found") else "PERMISSION_DENIED", "not your robot")
        if not robot.owned and not on("get-foreign-served"):
            raise Refusal("NOT_FOUND" if on("get-foreign-not-found") else "PERMISSION_DENIED", "not your robot")
        if not robot.online() and on("get-offline-denied"):
            raise denied("not your robot")
        if not robot.online() and on("offline-internal"):
            raise Refusal("INTERNAL", "the robot cannot be reached")
        return robot

    def select(self, request: Json, topic: str) -> Selection:
        """The robots that the selector of a subscription chooses."""
        on = self._options.on
        self._known_fields(request, {"selector"})
        selector = request.get("selector")
        if selector is None and on("selector-missing-means-all"):
            return Selection(self._all_owned())
        if not isinstance(selector, dict):
            raise invalid("a selector is required")
        self._known_fields(selector, {"robotIds", "robot_ids", "locationId", "location_id"})
        robot_ids = member(selector, "robotIds", "robot_ids")
        location_id = member(selector, "locationId", "location_id")
        if robot_ids is not None and location_id is not None:
            if on("both-prefer-ids"):
                location_id = None
            elif on("both-prefer-location"):
                robot_ids = None
            elif on("blank-location-beside-ids") and location_id == "":
                location_id = None
            else:
                raise invalid("either robot_ids or location_id")
        if robot_ids is not None:
            return self._by_ids(robot_ids, topic)
        if location_id is not None:
            return self._by_location(location_id, topic)
        raise invalid("the selector selects nothing")

    def _by_ids(self, robot_ids: Any, topic: str) -> Selection:
        on = self._options.on
        if not isinstance(robot_ids, dict):
            raise invalid("robot_ids must be a message")
        self._known_fields(robot_ids, {"ids"})
        ids = robot_ids.get("ids")
        if ids is None:
            ids = []
        if not isinstance(ids, list) or not all(isinstance(robot_id, str) for robot_id in ids):
            raise invalid("ids must be texts")
        if not ids:
            if on("ids-empty-means-all"):
                return Selection(self._all_owned())
            if self._options.topic_is("ids-empty-silent", topic, "wifi"):
                return Selection([])
            raise invalid("robot_ids must not be empty")
        if len(ids) > 1 and self._options.topic_is("two-ids-refused", topic, "battery"):
            raise invalid("one robot at a time")
        if len(set(ids)) < len(ids) and on("duplicate-ids-refused"):
            raise invalid("an id is repeated")
        blanks = [robot_id for robot_id in ids if robot_id == "" or self._blank(robot_id)]
        if blanks and not on("blank-id-denied") and not on("ownership-before-blanks"):
            raise invalid("an id is empty")
        chosen = self._owned_ids(ids, topic)
        if blanks and not on("blank-id-denied"):
            raise invalid("an id is empty")
        if self._options.topic_is("ids-first-only", topic, "errorCodes"):
            chosen = chosen[:1]
        return Selection(list(dict.fromkeys(chosen)))

    def _owned_ids(self, ids: list[str], topic: str) -> list[str]:
        on = self._options.on
        chosen: list[str] = []
        for position, robot_id in enumerate(ids):
            if on("ownership-before-blanks") and (robot_id == "" or self._blank(robot_id)):
                continue
            robot = self._world.robots.get(robot_id)
            allowed = robot is not None and robot.owned
            if robot is not None and position > 0 and on("foreign-after-first-unchecked"):
                allowed = True
            if robot is not None and self._options.topic_is("status-foreign-id-served", topic, "state"):
                allowed = True
            if allowed:
                chosen.append(robot_id)
            elif (on("foreign-id-skipped") and len(ids) > 1) or (robot is None and on("unknown-id-silent")):
                continue
            elif self._options.topic_is("online-foreign-not-found", topic, "connection"):
                raise Refusal("NOT_FOUND", "no such robot")
            else:
                raise denied("not your robot")
        return chosen

    def _by_location(self, location_id: Any, topic: str) -> Selection:
        on = self._options.on
        if not isinstance(location_id, str):
            raise invalid("location_id must be a text")
        if location_id == "" or self._blank(location_id):
            if on("location-blank-not-found"):
                raise Refusal("NOT_FOUND", "no such location")
            raise invalid("location_id must not be empty")
        if location_id not in self._world.locations:
            raise Refusal("NOT_FOUND" if on("unknown-location-not-found") else "PERMISSION_DENIED", "no such location")
        there = self._world.at(location_id)
        if not self._world.locations[location_id]:
            if not there and on("empty-foreign-location-not-found"):
                raise Refusal("NOT_FOUND", "no robots there")
            if self._options.topic_is("foreign-location-not-found", topic, "battery", "errorCodes"):
                raise Refusal("NOT_FOUND", "no such location")
            if not on("foreign-location-served"):
                raise denied("not your location")
        return self._robots_at(location_id, there, topic)

    def _robots_at(self, location_id: str, there: list[Robot], topic: str) -> Selection:
        on = self._options.on
        owned = [robot.robot_id for robot in there if robot.owned]
        if len(owned) < len(there):
            if on("foreign-robot-at-location-denied") or (not owned and on("only-foreign-robots-denied")):
                raise denied("a robot there is not yours")
            if on("foreign-robot-at-location-served"):
                owned = [robot.robot_id for robot in there]
        if on("offline-location-not-found") and not any(robot.online() for robot in there):
            owned = []
        if on("location-ignored"):
            owned = self._all_owned()
        accepted = self._options.topic_is("navigation-empty-location-accepted", topic, "navigationState")
        if not owned and not accepted and not on("empty-location-accepted"):
            raise Refusal("PERMISSION_DENIED" if on("empty-location-denied") else "NOT_FOUND", "no robots there")
        if self._options.topic_is("location-first-robot-only", topic, "connection", "wifi"):
            owned = owned[:1]
        return Selection(owned, location_id)

    def _all_owned(self) -> list[str]:
        return [robot.robot_id for robot in self._world.robots.values() if robot.owned]

    def _blank(self, text: str) -> bool:
        return self._options.on("blank-trimmed") and not text.strip()

    def _known_fields(self, message: Json, names: set[str]) -> None:
        if self._options.on("unknown-fields-refused") and not set(message) <= names:
            raise invalid("an unknown field")
