"""The JSON of what robots report: values of each part of a status, in range and without contradictions."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.kernel.codec import JSON

BATTERIES: tuple[JSON, ...] = (
    {"chargePercent": 78, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_CONTACT"},
    {"chargePercent": 79, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_CONTACT"},
    {"chargePercent": 42, "state": "STATE_DISCHARGING", "chargeMethod": "CHARGE_METHOD_NONE"},
    {"chargePercent": 100, "state": "STATE_FULL", "chargeMethod": "CHARGE_METHOD_WIRED"},
    {"chargePercent": 0, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_WIRED"},
    {"chargePercent": 78, "state": "STATE_CHARGING", "chargeMethod": "CHARGE_METHOD_WIRED"},
)
ERRORS: tuple[JSON, ...] = (
    {"codes": []},
    {"codes": [{"code": 1001, "severity": "SEVERITY_MEDIUM", "message": "Low battery warning"}]},
    {
        "codes": [
            {"code": 1001, "severity": "SEVERITY_MEDIUM", "message": "Low battery warning"},
            {"code": 2042, "severity": "SEVERITY_HIGH", "message": "Camera connection lost"},
        ]
    },
    {"codes": [{"code": 7, "severity": "SEVERITY_LOW", "message": "Up camera process error."}]},
    # The same code with another severity, with another message, and twice.
    {"codes": [{"code": 1001, "severity": "SEVERITY_HIGH", "message": "Low battery warning"}]},
    {"codes": [{"code": 1001, "severity": "SEVERITY_MEDIUM", "message": "Low battery"}]},
    {
        "codes": [
            {"code": 7, "severity": "SEVERITY_LOW", "message": "Up camera process error."},
            {"code": 7, "severity": "SEVERITY_LOW", "message": "Down camera process error."},
        ]
    },
)
NAVIGATIONS: tuple[JSON, ...] = tuple(
    {"stuckState": {"state": state, "reason": reason}}
    for state, reason in (
        ("STATE_NOT_STUCK", "REASON_UNKNOWN"),
        ("STATE_STUCK", "REASON_PATH_BLOCKED"),
        ("STATE_STUCK", "REASON_INSIDE_RESTRICTED_AREA"),
        ("STATE_STUCK", "REASON_UNKNOWN"),
    )
)
NETWORKS: tuple[JSON, ...] = (
    {"ssid": "office", "signalLevelDbm": -45, "linkQuality": 65, "security": "SECURITY_PASSWORD_SECURED"},
    {"ssid": "office", "signalLevelDbm": -60, "linkQuality": 40, "security": "SECURITY_PASSWORD_SECURED"},
    {"ssid": "office", "signalLevelDbm": -45, "linkQuality": 70, "security": "SECURITY_PASSWORD_SECURED"},
    {"ssid": "office", "signalLevelDbm": -45, "linkQuality": 65, "security": "SECURITY_USERNAME_PASSWORD_SECURED"},
    {"ssid": "guests", "signalLevelDbm": -70, "linkQuality": 0, "security": "SECURITY_UNSECURED"},
    None,
)
CONNECTIONS: tuple[JSON, ...] = ({"state": "STATE_CONNECTED"}, {"state": "STATE_DISCONNECTED"})
STOPS: tuple[JSON, ...] = (
    {"emergency": "EMERGENCY_DISENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"},
    {"emergency": "EMERGENCY_ENGAGED", "buttonPressed": "EMERGENCY_DISENGAGED"},
    {"emergency": "EMERGENCY_DISENGAGED", "buttonPressed": "EMERGENCY_ENGAGED"},
    {"emergency": "EMERGENCY_ENGAGED", "buttonPressed": "EMERGENCY_ENGAGED"},
)
MISSIONS: tuple[JSON, ...] = (
    {
        "missionId": "mission-123",
        "state": "STATE_RUNNING",
        "goals": [{"pose": {"xMeters": 5.2, "yMeters": 3.1, "headingRadians": 0.0}}],
        "currentGoalIndex": 0,
    },
    {
        "missionId": "mission-123",
        "state": "STATE_SUCCEEDED",
        "goals": [{"destinationId": "table-1"}],
        "currentGoalIndex": 0,
    },
    {
        "missionId": "mission-456",
        "state": "STATE_PAUSED",
        "goals": [{"destinationId": "table-1"}, {"destinationId": "table-2"}],
        "currentGoalIndex": 1,
    },
    None,
)
TWISTS: tuple[JSON, ...] = (
    {"linearVelocity": 0.5, "angularVelocity": 0.25},
    {"linearVelocity": 0.0, "angularVelocity": 0.0},
    {"linearVelocity": -0.1, "angularVelocity": -0.7},
    None,
)
POSES: tuple[JSON, ...] = (
    {"xMeters": 1.5, "yMeters": 2.8, "headingRadians": 0.78},
    {"xMeters": 2.1, "yMeters": 1.8, "headingRadians": 1.2},
)
TRAYS: JSON = {
    "trayStates": {
        "trayStates": [{"trayName": "top", "loadState": "LOAD_STATE_LOADED", "weightKg": 2.5, "loadRatio": 0.8}]
    }
}
CONVEYOR: JSON = {
    "conveyorState": {"index": 0, "operationState": "OPERATION_STATE_ROLLING", "payloadState": "PAYLOAD_STATE_LOADED"}
}

SHORT: Mapping[str, tuple[JSON, ...]] = {
    "battery": ({"chargePercent": 41, "state": "STATE_DISCHARGING"},),
    "errorCodes": ({}, {"codes": [{"code": 1001}]}),
    "navigationState": ({"stuckState": {"state": "STATE_NOT_STUCK"}},),
    "wifi": ({"ssid": "guests"},),
    "emergencyStop": ({"emergency": "EMERGENCY_ENGAGED"},),
    "mission": (
        {"missionId": "mission-456", "state": "STATE_SUCCEEDED"},
        {"missionId": "mission-456", "state": "STATE_RUNNING", "goals": [{"pose": {"yMeters": 3.1}}]},
    ),
    "twist": ({"angularVelocity": 0.25},),
    "pose": ({"xMeters": 1.5, "yMeters": 2.8},),
    "serviState": ({"trayStates": {"trayStates": [{"trayName": "top"}]}},),
    "cartiState": (
        {"conveyorState": {"operationState": "OPERATION_STATE_STOP"}},
        {"conveyorState": {"index": 1, "payloadState": "PAYLOAD_STATE_EMPTY"}},
    ),
}
"""For parts values in which members are left out, which then have their defaults, not what was reported before."""

REPORTS: tuple[tuple[str, tuple[JSON, ...]], ...] = (
    ("battery", (*BATTERIES, *SHORT["battery"], None)),
    ("errorCodes", (*ERRORS, *SHORT["errorCodes"], None)),
    ("navigationState", (*NAVIGATIONS, *SHORT["navigationState"], None)),
    ("wifi", (*NETWORKS, *SHORT["wifi"])),
    ("connection", (*CONNECTIONS, CONNECTIONS[0], None)),
    ("emergencyStop", (*STOPS, *SHORT["emergencyStop"], None)),
    ("mission", (*MISSIONS, *SHORT["mission"])),
    ("twist", (*TWISTS, *SHORT["twist"])),
    ("pose", (*POSES, *SHORT["pose"], None)),
    ("serviState", (TRAYS, {"trayStates": {"trayStates": []}}, TRAYS, *SHORT["serviState"], None, None)),
    ("cartiState", (CONVEYOR, *SHORT["cartiState"], None)),
    ("localizationState", ({"state": "STATE_SUCCEEDED"},)),
)


def report(robot: str, part: str, value: JSON) -> JSON:
    """The drive of a report."""
    return {"event": "report", "robotId": robot, "part": part, "value": value}


def by_ids(*robots: JSON, **selector: JSON) -> JSON:
    """A request that selects robots by their ids."""
    return {"selector": {"robotIds": {"ids": list(robots)}, **selector}}


def at(location: JSON) -> JSON:
    """A request that selects the robots at a location."""
    return {"selector": {"locationId": location}}
