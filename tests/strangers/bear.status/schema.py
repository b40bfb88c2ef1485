"""The messages of the service: their fields, the fields' types and the numbers of the enums.

A type is `int`, `int64`, `float`, `str`, `Timestamp`, the name of a message, `enum NAME`, `[T]` for a repeated
field, `{T}` for a map from text to T.
"""

from __future__ import annotations

from typing import Any

Json = dict[str, Any]

ENUMS: dict[str, tuple[str, ...]] = {
    "Connection": ("STATE_UNKNOWN", "STATE_CONNECTED", "STATE_DISCONNECTED"),
    "Battery": ("STATE_UNKNOWN", "STATE_CHARGING", "STATE_DISCHARGING", "STATE_FULL"),
    "ChargeMethod": (
        "CHARGE_METHOD_UNKNOWN",
        "CHARGE_METHOD_NONE",
        "CHARGE_METHOD_WIRED",
        "CHARGE_METHOD_CONTACT",
    ),
    "Emergency": ("EMERGENCY_UNKNOWN", "EMERGENCY_ENGAGED", "EMERGENCY_DISENGAGED"),
    "Mission": (
        "STATE_UNKNOWN",
        "STATE_DEFAULT",
        "STATE_RUNNING",
        "STATE_PAUSED",
        "STATE_CANCELED",
        "STATE_SUCCEEDED",
        "STATE_FAILED",
    ),
    "BaseStatus": ("STATUS_UNKNOWN", "STATUS_NAVIGATING"),
    "Status": ("STATUS_UNKNOWN", "STATUS_NAVIGATING", "STATUS_ARRIVED", "STATUS_DOCKING", "STATUS_UNDOCKING"),
    "BaseType": ("BASE_TYPE_UNKNOWN", "BASE_TYPE_NAVIGATE", "BASE_TYPE_NAVIGATE_AUTO"),
    "ServiType": (
        "SERVI_TYPE_UNKNOWN",
        "SERVI_TYPE_SERVING",
        "SERVI_TYPE_SERVING_PATROL",
        "SERVI_TYPE_BUSSING",
        "SERVI_TYPE_BUSSING_PATROL",
        "SERVI_TYPE_NAVIGATE",
        "SERVI_TYPE_NAVIGATE_AUTO",
    ),
    "CartiType": (
        "CARTI_TYPE_UNKNOWN",
        "CARTI_TYPE_TRAVERSE",
        "CARTI_TYPE_TRAVERSE_PATROL",
        "CARTI_TYPE_NAVIGATE",
        "CARTI_TYPE_NAVIGATE_AUTO",
    ),
    "Severity": ("SEVERITY_UNKNOWN", "SEVERITY_LOW", "SEVERITY_MEDIUM", "SEVERITY_HIGH"),
    "Localization": (
        "STATE_UNKNOWN",
        "STATE_FAILED",
        "STATE_SUCCEEDED",
        "STATE_LOCALIZING",
        "STATE_MISLOCALIZED",
    ),
    "Stuck": ("STATE_UNKNOWN", "STATE_NOT_STUCK", "STATE_STUCK"),
    "Reason": (
        "REASON_UNKNOWN",
        "REASON_PATH_BLOCKED",
        "REASON_DESTINATION_OBSTRUCTED",
        "REASON_DESTINATION_UNREACHABLE",
        "REASON_INSIDE_RESTRICTED_AREA",
    ),
    "Security": (
        "SECURITY_UNKNOWN",
        "SECURITY_UNSECURED",
        "SECURITY_PASSWORD_SECURED",
        "SECURITY_USERNAME_PASSWORD_SECURED",
    ),
    "Load": ("LOAD_STATE_UNKNOWN", "LOAD_STATE_LOADED", "LOAD_STATE_EMPTY", "LOAD_STATE_OVERLOADED"),
    "Operation": ("OPERATION_STATE_UNKNOWN", "OPERATION_STATE_ROLLING", "OPERATION_STATE_STOP"),
    "Payload": ("PAYLOAD_STATE_UNKNOWN", "PAYLOAD_STATE_LOADED", "PAYLOAD_STATE_EMPTY"),
    "Health": ("HEALTH_STATE_UNKNOWN", "HEALTH_STATE_OK", "HEALTH_STATE_ERROR"),
    "Installation": (
        "INSTALLATION_STATE_UNKNOWN",
        "INSTALLATION_STATE_INSTALLED",
        "INSTALLATION_STATE_NOT_INSTALLED",
    ),
}

MESSAGES: dict[str, dict[str, str]] = {
    "RobotState": {
        "connection": "RobotConnection",
        "battery": "BatteryState",
        "emergencyStop": "EmergencyStopState",
        "mission": "MissionState",
        "pose": "Pose",
        "errorCodes": "ErrorCodes",
        "serviState": "ServiState",
        "cartiState": "CartiState",
        "twist": "Twist",
        "localizationState": "LocalizationState",
        "navigationState": "NavigationState",
    },
    "RobotConnection": {"state": "enum Connection"},
    "BatteryState": {"chargePercent": "int", "state": "enum Battery", "chargeMethod": "enum ChargeMethod"},
    "EmergencyStopState": {"emergency": "enum Emergency", "buttonPressed": "enum Emergency"},
    "MissionState": {
        "missionId": "str",
        "state": "enum Mission",
        "goals": "[Goal]",
        "currentGoalIndex": "int",
        "missionFeedback": "MissionFeedback",
        "missionType": "MissionType",
        "owner": "str",
    },
    "MissionFeedback": {"baseFeedback": "BaseFeedback", "serviFeedback": "Feedback", "cartiFeedback": "Feedback"},
    "BaseFeedback": {"status": "enum BaseStatus"},
    "Feedback": {"status": "enum Status"},
    "MissionType": {},
    "Goal": {"pose": "Pose"},
    "Pose": {"xMeters": "float", "yMeters": "float", "headingRadians": "float"},
    "ErrorCodes": {"codes": "[ErrorCode]"},
    "ErrorCode": {"code": "int", "severity": "enum Severity", "message": "str"},
    "ServiState": {"trayStates": "TrayStates"},
    "TrayStates": {"trayStates": "[TrayState]"},
    "TrayState": {"trayName": "str", "loadState": "enum Load", "weightKg": "float", "loadRatio": "float"},
    "CartiState": {"conveyorState": "ConveyorState"},
    "ConveyorState": {
        "index": "int",
        "operationState": "enum Operation",
        "payloadState": "enum Payload",
        "healthState": "enum Health",
        "installationState": "enum Installation",
    },
    "Twist": {"linearVelocity": "float", "angularVelocity": "float"},
    "LocalizationState": {"state": "enum Localization"},
    "NavigationState": {"stuckState": "StuckState"},
    "StuckState": {"state": "enum Stuck", "reason": "enum Reason"},
    "Wifi": {"ssid": "str", "signalLevelDbm": "int", "linkQuality": "int", "security": "enum Security"},
    "EventMetadata": {"timestamp": "Timestamp", "sequenceNumber": "int64"},
    "ErrorCodesWithMetadata": {"metadata": "EventMetadata", "codes": "[ErrorCode]"},
    "NetworkStateWithMetadata": {"metadata": "EventMetadata", "connectedWifi": "Wifi"},
    "RobotConnectionWithMetadata": {"metadata": "EventMetadata", "connection": "RobotConnection"},
    "GetRobotStatus": {"robotState": "RobotState"},
    "SubscribeBatteryStatus": {"metadata": "EventMetadata", "robotId": "str", "batteryState": "BatteryState"},
    "SubscribeErrorCodes": {"errorCodes": "{ErrorCodesWithMetadata}"},
    "SubscribeNavigationStatus": {
        "metadata": "EventMetadata",
        "robotId": "str",
        "navigationState": "NavigationState",
    },
    "SubscribeNetworkStatus": {"networkStates": "{NetworkStateWithMetadata}"},
    "SubscribeOnlineStatus": {"onlineStates": "{RobotConnectionWithMetadata}"},
    "SubscribeRobotStatus": {"metadata": "EventMetadata", "robotId": "str", "robotState": "RobotState"},
}

PARTS: tuple[str, ...] = tuple(MESSAGES["RobotState"])

_ZERO_NAMES = frozenset(names[0] for names in ENUMS.values())


def is_default(value: Any) -> bool:
    """Whether a value in JSON is one that a field has when it was never set."""
    if isinstance(value, str):
        return value == "" or value in _ZERO_NAMES
    if isinstance(value, (dict, list)):
        return value == []
    return value is None or value == 0


def canonical(value: Any) -> Any:
    """The value without the members that have their default, so that equal messages compare equal."""
    if isinstance(value, dict):
        kept = {name: canonical(member) for name, member in value.items()}
        return {name: member for name, member in kept.items() if not is_default(member)}
    if isinstance(value, list):
        return [canonical(member) for member in value]
    return value
