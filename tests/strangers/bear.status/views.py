"""What is shown of a robot: its whole state, and the contents of the messages of each topic."""

from __future__ import annotations

import copy
from typing import Any

from distortions import distort
from schema import PARTS, Json
from variants import Options
from world import STATE, WIFI, Robot, World

METHODS: dict[str, str] = {
    "SubscribeBatteryStatus": "battery",
    "SubscribeErrorCodes": "errorCodes",
    "SubscribeNavigationStatus": "navigationState",
    "SubscribeNetworkStatus": WIFI,
    "SubscribeOnlineStatus": "connection",
    "SubscribeRobotStatus": STATE,
}

SINGLE_FIELDS: dict[str, str] = {"battery": "batteryState", "navigationState": "navigationState", STATE: "robotState"}
MAP_FIELDS: dict[str, str] = {"errorCodes": "errorCodes", WIFI: "networkStates", "connection": "onlineStates"}

_WRITTEN_OUT: dict[str, Json] = {
    "connection": {"state": "STATE_UNKNOWN"},
    "emergencyStop": {"emergency": "EMERGENCY_UNKNOWN", "buttonPressed": "EMERGENCY_UNKNOWN"},
    "errorCodes": {"codes": []},
    "localizationState": {"state": "STATE_UNKNOWN"},
}
_RESERVED_REASONS = ("REASON_DESTINATION_OBSTRUCTED", "REASON_DESTINATION_UNREACHABLE")


class Views:
    """Reads the world for the answers and the stream messages."""

    def __init__(self, options: Options, world: World) -> None:
        self._options = options
        self._world = world
        self._cache: dict[str, Json] = {}
        self._twists: dict[str, Json] = {}

    def status(self, robot: Robot) -> Json:
        """The robot_state of a GetRobotStatus response."""
        on = self._options.on
        if on("get-cached") or on("get-cached-by-location"):
            key = robot.robot_id if on("get-cached") else robot.location_id
            if key not in self._cache:
                self._cache[key] = self.robot_state(robot, "get")
            return copy.deepcopy(self._cache[key])
        return self.robot_state(robot, "get")

    def robot_state(self, robot: Robot, scope: str) -> Json:
        """The RobotState message, as GetRobotStatus (`get`) or as SubscribeRobotStatus (`state`) shows it."""
        state: Json = {}
        for part in PARTS:
            value = self.part(robot, part, scope)
            if value is not None:
                state[part] = value
        self._typed(state)
        return state

    def _typed(self, state: Json) -> None:
        on = self._options.on
        if on("both-types-set") and "serviState" in state:
            state["cartiState"] = {}
        if on("carti-shown-as-servi") and "cartiState" in state:
            state.pop("cartiState")
            state["serviState"] = {"trayStates": {"trayStates": []}}

    def part(self, robot: Robot, part: str, scope: str) -> Any:
        """A part of the robot's state as it is shown in the scope, None where it is not set."""
        on = self._options.on
        value = copy.deepcopy(robot.part(part))
        if part == "twist":
            value = self._twist(robot, value)
        if part == "emergencyStop" and robot.index == 1 and on("second-robot-shares-emergency"):
            value = copy.deepcopy(next(iter(self._world.robots.values())).part(part))
        if part == "battery" and value is not None and not robot.online() and on("offline-battery-empty"):
            value["chargePercent"] = 0
        if part == "errorCodes" and value is not None and on("codes-sorted"):
            value["codes"] = sorted(value.get("codes") or [], key=lambda code: (code.get("code", 0), str(code)))
        if part == "navigationState" and value is not None and on("reserved-reason-unknown"):
            stuck = value.get("stuckState") or {}
            if stuck.get("reason") in _RESERVED_REASONS:
                stuck["reason"] = "REASON_UNKNOWN"
        if part == WIFI and value is None:
            if on("lost-wifi-kept"):
                value = copy.deepcopy(robot.previous_wifi)
            elif on("lost-wifi-as-empty"):
                value = {"ssid": "", "signalLevelDbm": 0, "linkQuality": 0, "security": "SECURITY_UNKNOWN"}
        if value is None and part in _WRITTEN_OUT and on("unknown-written-out"):
            value = copy.deepcopy(_WRITTEN_OUT[part])
        return distort(self._options, scope, part, value)

    def _twist(self, robot: Robot, value: Any) -> Any:
        on = self._options.on
        if on("offline-twist-omitted") and not robot.online():
            return None
        if value is None and on("twist-of-zeros"):
            return {"linearVelocity": 0.0, "angularVelocity": 0.0}
        if value is None and on("twist-kept"):
            return copy.deepcopy(self._twists.get(robot.robot_id))
        if value is not None:
            self._twists[robot.robot_id] = copy.deepcopy(value)
        return value

    def content(self, robot: Robot, topic: str) -> Json:
        """What a message of the topic, or its map's entry for the robot, says beside the metadata."""
        if topic == STATE:
            return {"robotState": self.robot_state(robot, STATE)}
        value = self.part(robot, topic, topic)
        if topic == "errorCodes":
            return {"codes": list((value or {}).get("codes") or [])}
        if value is None:
            return {}
        name = {"battery": "batteryState", "navigationState": "navigationState", WIFI: "connectedWifi"}
        return {name.get(topic, "connection"): value}
