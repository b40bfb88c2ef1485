"""The enums of the Bear API as they are on the wire, as one table. Names are relative to `fields.PACKAGE`."""

from __future__ import annotations

from collections.abc import Mapping

ENUMS: Mapping[str, Mapping[str, int]] = {
    "carti.CartiType": {
        "CARTI_TYPE_UNKNOWN": 0,
        "CARTI_TYPE_TRAVERSE": 1,
        "CARTI_TYPE_TRAVERSE_PATROL": 2,
        "CARTI_TYPE_NAVIGATE": 3,
        "CARTI_TYPE_NAVIGATE_AUTO": 4,
    },
    "carti.ConveyorState.HealthState": {
        "HEALTH_STATE_UNKNOWN": 0,
        "HEALTH_STATE_OK": 1,
        "HEALTH_STATE_ERROR": 2,
    },
    "carti.ConveyorState.InstallationState": {
        "INSTALLATION_STATE_UNKNOWN": 0,
        "INSTALLATION_STATE_INSTALLED": 1,
        "INSTALLATION_STATE_NOT_INSTALLED": 2,
    },
    "carti.ConveyorState.OperationState": {
        "OPERATION_STATE_UNKNOWN": 0,
        "OPERATION_STATE_ROLLING": 1,
        "OPERATION_STATE_STOP": 2,
    },
    "carti.ConveyorState.PayloadState": {
        "PAYLOAD_STATE_UNKNOWN": 0,
        "PAYLOAD_STATE_LOADED": 1,
        "PAYLOAD_STATE_EMPTY": 2,
    },
    "carti.Feedback.Status": {
        "STATUS_UNKNOWN": 0,
        "STATUS_NAVIGATING": 1,
        "STATUS_ARRIVED": 2,
        "STATUS_DOCKING": 3,
        "STATUS_UNDOCKING": 4,
    },
    "core.BaseFeedback.Status": {
        "STATUS_UNKNOWN": 0,
        "STATUS_NAVIGATING": 1,
    },
    "core.BaseType": {
        "BASE_TYPE_UNKNOWN": 0,
        "BASE_TYPE_NAVIGATE": 1,
        "BASE_TYPE_NAVIGATE_AUTO": 2,
    },
    "core.BatteryState.ChargeMethod": {
        "CHARGE_METHOD_UNKNOWN": 0,
        "CHARGE_METHOD_NONE": 1,
        "CHARGE_METHOD_WIRED": 2,
        "CHARGE_METHOD_CONTACT": 3,
    },
    "core.BatteryState.State": {
        "STATE_UNKNOWN": 0,
        "STATE_CHARGING": 1,
        "STATE_DISCHARGING": 2,
        "STATE_FULL": 3,
    },
    "core.EmergencyStopState.Emergency": {
        "EMERGENCY_UNKNOWN": 0,
        "EMERGENCY_ENGAGED": 1,
        "EMERGENCY_DISENGAGED": 2,
    },
    "core.ErrorCode.Severity": {
        "SEVERITY_UNKNOWN": 0,
        "SEVERITY_LOW": 1,
        "SEVERITY_MEDIUM": 2,
        "SEVERITY_HIGH": 3,
    },
    "core.LocalizationState.State": {
        "STATE_UNKNOWN": 0,
        "STATE_FAILED": 1,
        "STATE_SUCCEEDED": 2,
        "STATE_LOCALIZING": 3,
        "STATE_MISLOCALIZED": 4,
    },
    "core.MissionCommand.Command": {
        "COMMAND_UNKNOWN": 0,
        "COMMAND_CANCEL": 1,
        "COMMAND_PAUSE": 2,
        "COMMAND_RESUME": 3,
        "COMMAND_FINISH": 4,
    },
    "core.MissionState.State": {
        "STATE_UNKNOWN": 0,
        "STATE_DEFAULT": 1,
        "STATE_RUNNING": 2,
        "STATE_PAUSED": 3,
        "STATE_CANCELED": 4,
        "STATE_SUCCEEDED": 5,
        "STATE_FAILED": 6,
    },
    "core.RobotConnection.State": {
        "STATE_UNKNOWN": 0,
        "STATE_CONNECTED": 1,
        "STATE_DISCONNECTED": 2,
    },
    "core.StuckState.Reason": {
        "REASON_UNKNOWN": 0,
        "REASON_PATH_BLOCKED": 1,
        "REASON_DESTINATION_OBSTRUCTED": 2,
        "REASON_DESTINATION_UNREACHABLE": 3,
        "REASON_INSIDE_RESTRICTED_AREA": 4,
    },
    "core.StuckState.State": {
        "STATE_UNKNOWN": 0,
        "STATE_NOT_STUCK": 1,
        "STATE_STUCK": 2,
    },
    "core.Wifi.Security": {
        "SECURITY_UNKNOWN": 0,
        "SECURITY_UNSECURED": 1,
        "SECURITY_PASSWORD_SECURED": 2,
        "SECURITY_USERNAME_PASSWORD_SECURED": 3,
    },
    "servi.Feedback.Status": {
        "STATUS_UNKNOWN": 0,
        "STATUS_NAVIGATING": 1,
        "STATUS_ARRIVED": 2,
        "STATUS_DOCKING": 3,
        "STATUS_UNDOCKING": 4,
    },
    "servi.ServiType": {
        "SERVI_TYPE_UNKNOWN": 0,
        "SERVI_TYPE_SERVING": 1,
        "SERVI_TYPE_SERVING_PATROL": 2,
        "SERVI_TYPE_BUSSING": 3,
        "SERVI_TYPE_BUSSING_PATROL": 4,
        "SERVI_TYPE_NAVIGATE": 5,
        "SERVI_TYPE_NAVIGATE_AUTO": 6,
    },
    "servi.TrayState.LoadState": {
        "LOAD_STATE_UNKNOWN": 0,
        "LOAD_STATE_LOADED": 1,
        "LOAD_STATE_EMPTY": 2,
        "LOAD_STATE_OVERLOADED": 3,
    },
}
"""Every enum: its values by name."""
