"""The conversations of the smoke driver: lists of requests, each a method and its params."""

from __future__ import annotations

from typing import Any

Json = dict[str, Any]
Step = tuple[str, Json]

STATE: Json = {
    "connection": {"state": "STATE_CONNECTED"},
    "battery": {"chargePercent": 60, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_CONTACT"},
    "emergencyStop": {"emergency": "EMERGENCY_DISENGAGED", "buttonPressed": "EMERGENCY_ENGAGED"},
    "mission": {"missionId": "m1", "state": "STATE_RUNNING", "goals": [], "currentGoalIndex": 0},
    "pose": {"xMeters": 1.1, "yMeters": 2.5, "headingRadians": 0.5},
    "errorCodes": {
        "codes": [
            {"code": 2042, "severity": "SEVERITY_LOW", "message": "Camera"},
            {"code": 1001, "severity": "SEVERITY_HIGH", "message": "Low battery"},
        ]
    },
    "twist": {"linearVelocity": -0.5, "angularVelocity": 0.25},
    "localizationState": {"state": "STATE_SUCCEEDED"},
    "navigationState": {"stuckState": {"state": "STATE_STUCK", "reason": "REASON_PATH_BLOCKED"}},
    "serviState": {"trayStates": {"trayStates": [{"trayName": "top", "loadState": "LOAD_STATE_EMPTY"}]}},
}
WIFI: Json = {"ssid": "Hall", "signalLevelDbm": -45, "linkQuality": 65, "security": "SECURITY_PASSWORD_SECURED"}
SECOND: Json = {
    "connection": {"state": "STATE_DISCONNECTED"},
    "battery": {"chargePercent": 100, "state": "STATE_FULL", "chargeMethod": "CHARGE_METHOD_NONE"},
    "emergencyStop": {"emergency": "EMERGENCY_ENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"},
    "navigationState": {"stuckState": {"state": "STATE_NOT_STUCK", "reason": "REASON_UNKNOWN"}},
    "cartiState": {"conveyorState": {"index": 1, "healthState": "HEALTH_STATE_OK"}},
    "twist": {"linearVelocity": 0.5, "angularVelocity": 0.0},
}
TOPICS = ("BatteryStatus", "ErrorCodes", "NavigationStatus", "NetworkStatus", "OnlineStatus", "RobotStatus")


def world() -> Json:
    """Two own robots and a foreign one at L1, one that never reported at L2, a foreign location, empty ones."""

    def robot(robot_id: str, location: str, owned: bool, state: Json, wifi: Json | None) -> Json:
        return {"robotId": robot_id, "locationId": location, "owned": owned, "state": state, "wifi": wifi}

    return {
        "robots": [
            robot("zed", "L1", True, STATE, WIFI),
            robot("amy", "L1", True, SECOND, None),
            robot("new", "L2", True, {}, None),
            robot("not-mine", "L3", False, STATE, WIFI),
            robot("mixed", "L4", False, STATE, WIFI),
            robot("with-mixed", "L4", True, STATE, WIFI),
            robot("lost", "L5", False, STATE, WIFI),
            robot("off", "L6", True, SECOND, None),
        ],
        "locations": [
            {"locationId": name, "owned": name not in ("L3", "L8")} for name in [f"L{number}" for number in range(1, 9)]
        ],
    }


def get(robot_id: Any) -> Step:
    """A GetRobotStatus."""
    return "GetRobotStatus", {"robotId": robot_id}


def ids(topic: str, *robot_ids: str) -> Step:
    """A subscription by ids."""
    return f"Subscribe{topic}", {"selector": {"robotIds": {"ids": list(robot_ids)}}}


def place(topic: str, location_id: str) -> Step:
    """A subscription by location."""
    return f"Subscribe{topic}", {"selector": {"locationId": location_id}}


def report(robot_id: str, part: str, value: Any) -> Step:
    """A report of one part of a robot."""
    return "drive", {"event": "report", "robotId": robot_id, "part": part, "value": value}


def drive(event: str, **fields: Any) -> Step:
    """Another drive."""
    return "drive", {"event": event, **fields}


def battery(percent: int, state: str = "CHARGING", method: str = "CONTACT") -> Json:
    """A battery state."""
    return {"chargePercent": percent, "state": f"STATE_{state}", "chargeMethod": f"CHARGE_METHOD_{method}"}


def stuck(state: str, reason: str = "UNKNOWN") -> Json:
    """A navigation state."""
    return {"stuckState": {"state": f"STATE_{state}", "reason": f"REASON_{reason}"}}


def codes(*numbers: int) -> Json:
    """A list of error codes."""
    return {"codes": [{"code": number, "severity": "SEVERITY_LOW", "message": f"e{number}"} for number in numbers]}


def connection(state: str) -> Json:
    """A connection state."""
    return {"state": f"STATE_{state}"}


def wifi(**fields: Any) -> Json:
    """A network."""
    return WIFI | fields


SETTLE: Step = ("settle", {})


def _refusals() -> list[Step]:
    steps: list[Step] = [get("zed"), get(""), ("GetRobotStatus", {}), get("not-mine"), get("nobody"), get(7), get(" ")]
    steps += [get("amy"), get("zed"), ("GetRobotStatus", {"robotId": "zed", "more": 1})]
    selectors: list[Any] = [
        None,
        {},
        7,
        {"robotIds": {"ids": []}},
        {"robotIds": {}},
        {"robotIds": {"ids": [3]}},
        {"robotIds": {"ids": "zed"}},
        {"locationId": ""},
        {"locationId": 3},
        {"robotIds": {"ids": ["zed"]}, "locationId": "L2"},
        {"robotIds": {"ids": ["zed"]}, "locationId": ""},
        {"robot_ids": {"ids": ["zed"]}},
    ]
    for topic in TOPICS:
        steps += [(f"Subscribe{topic}", {"selector": selector}) for selector in selectors]
        steps += [ids(topic, "not-mine"), ids(topic, "nobody"), ids(topic, "zed", "mixed"), ids(topic, "zed", "nobody")]
        steps += [ids(topic, ""), ids(topic, "", "not-mine"), ids(topic, " "), ids(topic, "zed", "zed")]
        steps += [place(topic, f"L{number}") for number in range(1, 10)]
        steps += [SETTLE]
    return steps


def _values() -> list[Step]:
    steps = [ids(topic, "zed", "amy", "new") for topic in TOPICS] + [SETTLE]
    for robot_id in ("zed", "amy"):
        steps += [report(robot_id, "battery", battery(percent)) for percent in (61, 63, 70, 71, 100)]
        steps += [report(robot_id, "battery", battery(100, "CHARGING", "WIRED"))]
        steps += [report(robot_id, "battery", battery(100, "CHARGING", "WIRED"))]
        steps += [report(robot_id, "navigationState", stuck("STUCK", "PATH_BLOCKED"))]
        steps += [report(robot_id, "navigationState", stuck("STUCK", "INSIDE_RESTRICTED_AREA"))]
        steps += [report(robot_id, "navigationState", stuck("STUCK", "DESTINATION_OBSTRUCTED"))]
        steps += [report(robot_id, "navigationState", stuck("NOT_STUCK"))]
        steps += [report(robot_id, "errorCodes", codes(5)), report(robot_id, "errorCodes", codes(6, 4)), SETTLE]
        steps += [report(robot_id, "errorCodes", codes()), report(robot_id, "errorCodes", None)]
        steps += [report(robot_id, "wifi", wifi(linkQuality=70)), report(robot_id, "wifi", wifi(linkQuality=1))]
        steps += [report(robot_id, "wifi", None), report(robot_id, "wifi", wifi(ssid="Kitchen")), get(robot_id)]
        steps += [report(robot_id, "twist", {"linearVelocity": 0.0, "angularVelocity": 0.0})]
        steps += [report(robot_id, "twist", None), report(robot_id, "localizationState", {"state": "STATE_FAILED"})]
        still = {"emergency": "EMERGENCY_DISENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"}
        steps += [report(robot_id, "emergencyStop", still), report(robot_id, "pose", {"xMeters": 1.0}), get(robot_id)]
        steps += [report(robot_id, "connection", connection("DISCONNECTED")), get(robot_id)]
        steps += [report(robot_id, "connection", connection("CONNECTED")), report(robot_id, "battery", battery(9))]
        steps += [report(robot_id, "connection", connection("UNKNOWN")), report(robot_id, "connection", None), SETTLE]
        steps += [report(robot_id, "battery", None), report(robot_id, "mystery", 1), report("nobody", "twist", None)]
    return [*steps, get("zed"), get("amy"), get("new"), SETTLE]


def _streams() -> list[Step]:
    steps: list[Step] = []
    for topic in TOPICS:
        steps += [
            ids(topic, "zed"),
            report("zed", "battery", battery(20)),
            ids(topic, "amy", "zed"),
            place(topic, "L1"),
        ]
    steps += [
        SETTLE,
        report("zed", "navigationState", stuck("NOT_STUCK")),
        report("zed", "errorCodes", codes(7)),
        SETTLE,
    ]
    steps += [ids(topic, "zed") for topic in TOPICS] + [("cancel", {"stream": -1}), ("cancel", {"stream": 999}), SETTLE]
    steps += [report("zed", "wifi", wifi(ssid="X")), report("amy", "connection", connection("CONNECTED"))]
    steps += [report("zed", "connection", connection("DISCONNECTED")), report("zed", "battery", battery(21)), SETTLE]
    steps += [report("amy", "connection", connection("DISCONNECTED")), report("amy", "navigationState", stuck("STUCK"))]
    return [*steps, report("zed", "pose", {"xMeters": 9.0}), report("amy", "battery", battery(3)), SETTLE]


def _moves() -> list[Step]:
    steps = [place(topic, "L2") for topic in TOPICS] + [ids(topic, "zed") for topic in TOPICS]
    steps += [SETTLE, drive("move", robotId="zed", locationId="L2"), SETTLE, report("zed", "battery", battery(5))]
    steps += [report("zed", "wifi", None), report("zed", "connection", connection("DISCONNECTED"))]
    steps += [place(topic, "L2") for topic in TOPICS] + [SETTLE]
    steps += [drive("move", robotId="new", locationId="L7"), report("new", "battery", battery(6)), SETTLE]
    steps += [drive("move", robotId="zed", locationId="L7"), report("zed", "battery", battery(7)), SETTLE]
    steps += [place("BatteryStatus", "L2"), place("BatteryStatus", "L7"), drive("move", robotId="x", locationId="L7")]
    return [*steps, drive("move", robotId="mixed", locationId="L7"), SETTLE]


def _restarts() -> list[Step]:
    steps = [ids(topic, "zed", "amy") for topic in TOPICS] + [SETTLE]
    steps += [report("zed", "battery", battery(percent)) for percent in (1, 50, 99)]
    steps += [drive("restart", robotId="zed"), drive("restart", robotId="nobody"), get("zed"), SETTLE]
    steps += [ids(topic, "zed") for topic in TOPICS]
    steps += [report("zed", "battery", battery(percent)) for percent in (2, 51, 98)]
    steps += [report("zed", "navigationState", stuck("NOT_STUCK")), SETTLE]
    steps += [report("amy", "battery", battery(percent)) for percent in (1, 50, 99)]
    return [*steps, SETTLE]


def _faults() -> list[Step]:
    steps = [drive("fault", status="INTERNAL"), get("nobody"), ids("BatteryStatus", "zed"), get("zed"), get("zed")]
    return [
        *steps,
        drive("fault", status="INTERNAL"),
        drive("fault", status="INTERNAL"),
        get("amy"),
        get("amy"),
        SETTLE,
    ]


def _equal_reports() -> list[Step]:
    steps = [ids("BatteryStatus", "zed"), ids("NavigationStatus", "zed"), ids("RobotStatus", "zed")]
    steps += [report("zed", "battery", battery(60)), report("zed", "navigationState", stuck("STUCK", "PATH_BLOCKED"))]
    return [*steps, ids("BatteryStatus", "zed"), report("zed", "battery", battery(61)), SETTLE]


def _one_topic(topic: str) -> list[Step]:
    steps = [ids(topic, "zed"), SETTLE, ids(topic, "new"), place(topic, "L1"), SETTLE]
    steps += [report(robot_id, "battery", battery(percent)) for robot_id in ("zed", "new") for percent in (30, 40)]
    steps += [report(robot_id, "connection", connection("DISCONNECTED")) for robot_id in ("zed", "new", "amy")]
    steps += [report("zed", "errorCodes", codes(1, 2)), report("new", "wifi", WIFI), ("cancel", {"stream": -1})]
    return [*steps, SETTLE, report("zed", "twist", {"linearVelocity": 0.1}), report("zed", "wifi", None), SETTLE]


CONVERSATIONS: dict[str, list[Step]] = {
    "refusals": _refusals(),
    "values": _values(),
    "streams": _streams(),
    "moves": _moves(),
    "restarts": _restarts(),
    "faults": _faults(),
    "equal reports": _equal_reports(),
} | {f"only {topic}": _one_topic(topic) for topic in TOPICS}
