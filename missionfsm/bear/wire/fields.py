"""The messages of the Bear API as they are on the wire: number, name and type of every field, as one table.

`enums` and `methods` have the other two tables. `missionfsm.adapters.grpc.descriptors` builds protobuf descriptors of
them at run time, so that a client that was generated from the vendor's own definitions speaks with what is served here.
Names are relative to `PACKAGE`.
"""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen

PACKAGE = "bearrobotics.api.v1"
"""What the name of every message, enum and service begins with."""


@frozen
class Field:
    """A field of a message.

    Attributes:
        number: its number on the wire.
        name: its name, in snake_case.
        type: a scalar type of protobuf; a message or an enum of the table; a name of ``google.protobuf``.
        label: ``singular``; ``optional``, which has presence; ``repeated``; ``map``, by a text to `type`.
        oneof: the oneof that it belongs to, or "".
    """

    number: int
    name: str
    type: str
    label: str = "singular"
    oneof: str = ""


MESSAGES: Mapping[str, tuple[Field, ...]] = {
    "carti.ConveyorState": (
        Field(1, "index", "int32"),
        Field(2, "operation_state", "carti.ConveyorState.OperationState"),
        Field(3, "payload_state", "carti.ConveyorState.PayloadState"),
        Field(4, "health_state", "carti.ConveyorState.HealthState"),
        Field(5, "installation_state", "carti.ConveyorState.InstallationState"),
    ),
    "carti.Feedback": (Field(1, "status", "carti.Feedback.Status"),),
    "carti.Mission": (
        Field(1, "traverse_mission", "carti.TraverseMission", oneof="mission"),
        Field(2, "traverse_patrol_mission", "carti.TraversePatrolMission", oneof="mission"),
        Field(3, "navigate_mission", "carti.NavigateMission", oneof="mission"),
        Field(4, "navigate_auto_mission", "carti.NavigateAutoMission", oneof="mission"),
    ),
    "carti.MissionWorkflow": (
        Field(1, "traverse", "carti.TraverseWorkflow", oneof="workflow"),
        Field(2, "traverse_patrol", "carti.TraversePatrolWorkflow", oneof="workflow"),
    ),
    "carti.NavigateAutoMission": (Field(1, "goals", "core.Goal", "repeated"),),
    "carti.NavigateMission": (Field(1, "goal", "core.Goal"),),
    "carti.TraverseMission": (
        Field(1, "goals", "core.Goal", "repeated"),
        Field(2, "params", "carti.TraverseParams"),
    ),
    "carti.TraverseParams": (),
    "carti.TraversePatrolMission": (
        Field(1, "goals", "core.Goal", "repeated"),
        Field(2, "params", "carti.TraversePatrolParams"),
    ),
    "carti.TraversePatrolParams": (),
    "carti.TraversePatrolWorkflow": (Field(1, "goals", "core.Goal", "repeated"),),
    "carti.TraverseWorkflow": (Field(1, "goals", "core.Goal", "repeated"),),
    "core.BaseFeedback": (Field(1, "status", "core.BaseFeedback.Status"),),
    "core.BaseMission": (
        Field(1, "navigate_mission", "core.NavigateMission", oneof="mission"),
        Field(2, "navigate_auto_mission", "core.NavigateAutoMission", oneof="mission"),
    ),
    "core.BatteryState": (
        Field(1, "charge_percent", "int32"),
        Field(2, "state", "core.BatteryState.State"),
        Field(3, "charge_method", "core.BatteryState.ChargeMethod"),
    ),
    "core.CartiState": (Field(1, "conveyor_state", "carti.ConveyorState", "optional"),),
    "core.EmergencyStopState": (
        Field(1, "emergency", "core.EmergencyStopState.Emergency"),
        Field(2, "button_pressed", "core.EmergencyStopState.Emergency"),
    ),
    "core.ErrorCode": (
        Field(1, "code", "int32"),
        Field(2, "severity", "core.ErrorCode.Severity"),
        Field(3, "message", "string"),
    ),
    "core.ErrorCodes": (Field(1, "codes", "core.ErrorCode", "repeated"),),
    "core.ErrorCodesWithMetadata": (
        Field(1, "metadata", "core.EventMetadata"),
        Field(2, "codes", "core.ErrorCode", "repeated"),
    ),
    "core.EventMetadata": (
        Field(1, "timestamp", "google.protobuf.Timestamp"),
        Field(2, "sequence_number", "int64"),
    ),
    "core.Goal": (
        Field(1, "destination_id", "string", oneof="goal"),
        Field(2, "pose", "core.Pose", oneof="goal"),
    ),
    "core.LocalizationState": (Field(2, "state", "core.LocalizationState.State"),),
    "core.Mission": (
        Field(1, "base_mission", "core.BaseMission", oneof="mission"),
        Field(2, "servi_mission", "servi.Mission", oneof="mission"),
        Field(3, "carti_mission", "carti.Mission", oneof="mission"),
        Field(888, "extension", "google.protobuf.Any"),
    ),
    "core.MissionCommand": (
        Field(1, "mission_id", "string"),
        Field(2, "command", "core.MissionCommand.Command"),
    ),
    "core.MissionState": (
        Field(1, "mission_id", "string"),
        Field(2, "state", "core.MissionState.State"),
        Field(3, "goals", "core.Goal", "repeated"),
        Field(4, "current_goal_index", "int32"),
        Field(5, "mission_feedback", "core.MissionState.MissionFeedback"),
        Field(6, "mission_type", "core.MissionType"),
        Field(7, "owner", "string"),
    ),
    "core.MissionState.MissionFeedback": (
        Field(1, "base_feedback", "core.BaseFeedback", oneof="feedback"),
        Field(2, "servi_feedback", "servi.Feedback", oneof="feedback"),
        Field(3, "carti_feedback", "carti.Feedback", oneof="feedback"),
    ),
    "core.MissionStates": (
        Field(1, "missions", "core.MissionState", "repeated"),
        Field(2, "current_mission_index", "int32"),
    ),
    "core.MissionType": (
        Field(1, "base_type", "core.BaseType", oneof="type"),
        Field(2, "servi_type", "servi.ServiType", oneof="type"),
        Field(3, "carti_type", "carti.CartiType", oneof="type"),
    ),
    "core.MissionWorkflow": (
        Field(1, "servi_workflow", "servi.MissionWorkflow", oneof="workflow"),
        Field(2, "carti_workflow", "carti.MissionWorkflow", oneof="workflow"),
    ),
    "core.NavigateAutoMission": (Field(1, "goals", "core.Goal", "repeated"),),
    "core.NavigateMission": (Field(1, "goal", "core.Goal"),),
    "core.NavigationState": (Field(1, "stuck_state", "core.StuckState"),),
    "core.NetworkStateWithMetadata": (
        Field(1, "metadata", "core.EventMetadata"),
        Field(2, "connected_wifi", "core.Wifi", "optional"),
    ),
    "core.Pose": (
        Field(1, "x_meters", "float"),
        Field(2, "y_meters", "float"),
        Field(3, "heading_radians", "float"),
    ),
    "core.RobotConnection": (Field(1, "state", "core.RobotConnection.State"),),
    "core.RobotConnectionWithMetadata": (
        Field(1, "metadata", "core.EventMetadata"),
        Field(2, "connection", "core.RobotConnection"),
    ),
    "core.RobotSelector": (
        Field(1, "robot_ids", "core.RobotSelector.RobotIDs", oneof="target_id"),
        Field(2, "location_id", "string", oneof="target_id"),
    ),
    "core.RobotSelector.RobotIDs": (Field(1, "ids", "string", "repeated"),),
    "core.RobotState": (
        Field(1, "connection", "core.RobotConnection"),
        Field(2, "battery", "core.BatteryState"),
        Field(3, "emergency_stop", "core.EmergencyStopState"),
        Field(4, "mission", "core.MissionState"),
        Field(5, "pose", "core.Pose"),
        Field(6, "error_codes", "core.ErrorCodes"),
        Field(7, "servi_state", "core.ServiState", oneof="typed_status"),
        Field(8, "carti_state", "core.CartiState", oneof="typed_status"),
        Field(9, "twist", "core.Twist"),
        Field(10, "localization_state", "core.LocalizationState"),
        Field(11, "navigation_state", "core.NavigationState"),
    ),
    "core.ServiState": (Field(1, "tray_states", "servi.TrayStates"),),
    "core.StuckState": (
        Field(1, "state", "core.StuckState.State"),
        Field(2, "reason", "core.StuckState.Reason"),
    ),
    "core.Twist": (
        Field(1, "linear_velocity", "float"),
        Field(2, "angular_velocity", "float"),
    ),
    "core.Wifi": (
        Field(1, "ssid", "string"),
        Field(2, "signal_level_dbm", "int32"),
        Field(3, "link_quality", "int32"),
        Field(4, "security", "core.Wifi.Security"),
    ),
    "servi.BirthdayWorkflow": (Field(1, "goal", "core.Goal"),),
    "servi.BussingMission": (
        Field(1, "goals", "core.Goal", "repeated"),
        Field(2, "params", "servi.BussingParams"),
    ),
    "servi.BussingParams": (),
    "servi.BussingPatrolMission": (
        Field(1, "goals", "core.Goal", "repeated"),
        Field(2, "params", "servi.BussingPatrolParams"),
    ),
    "servi.BussingPatrolParams": (),
    "servi.BussingPatrolWorkflow": (Field(1, "goals", "core.Goal", "repeated"),),
    "servi.BussingWorkflow": (Field(1, "goals", "core.Goal", "repeated"),),
    "servi.DeliveryMission": (
        Field(1, "goals", "core.Goal", "repeated"),
        Field(2, "params", "servi.DeliveryParams"),
    ),
    "servi.DeliveryParams": (Field(1, "tray_mappings", "servi.TrayMapping", "repeated"),),
    "servi.DeliveryPatrolMission": (
        Field(1, "goals", "core.Goal", "repeated"),
        Field(2, "params", "servi.DeliveryPatrolParams"),
    ),
    "servi.DeliveryPatrolParams": (),
    "servi.DeliveryPatrolWorkflow": (Field(1, "goals", "core.Goal", "repeated"),),
    "servi.DeliveryWorkflow": (Field(1, "goals", "core.Goal", "repeated"),),
    "servi.Feedback": (Field(1, "status", "servi.Feedback.Status"),),
    "servi.HostingPatrolWorkflow": (Field(1, "goals", "core.Goal", "repeated"),),
    "servi.HostingWorkflow": (Field(1, "goals", "core.Goal", "repeated"),),
    "servi.Mission": (
        Field(1, "delivery_mission", "servi.DeliveryMission", oneof="mission"),
        Field(2, "bussing_mission", "servi.BussingMission", oneof="mission"),
        Field(3, "delivery_patrol_mission", "servi.DeliveryPatrolMission", oneof="mission"),
        Field(4, "bussing_patrol_mission", "servi.BussingPatrolMission", oneof="mission"),
        Field(5, "navigate_mission", "servi.NavigateMission", oneof="mission"),
        Field(6, "navigate_auto_mission", "servi.NavigateAutoMission", oneof="mission"),
    ),
    "servi.MissionWorkflow": (
        Field(1, "delivery", "servi.DeliveryWorkflow", oneof="workflow"),
        Field(2, "delivery_patrol", "servi.DeliveryPatrolWorkflow", oneof="workflow"),
        Field(3, "bussing", "servi.BussingWorkflow", oneof="workflow"),
        Field(4, "bussing_patrol", "servi.BussingPatrolWorkflow", oneof="workflow"),
        Field(5, "birthday", "servi.BirthdayWorkflow", oneof="workflow"),
        Field(6, "hosting", "servi.HostingWorkflow", oneof="workflow"),
        Field(7, "hosting_patrol", "servi.HostingPatrolWorkflow", oneof="workflow"),
    ),
    "servi.NavigateAutoMission": (Field(1, "goals", "core.Goal", "repeated"),),
    "servi.NavigateMission": (Field(1, "goal", "core.Goal"),),
    "servi.TrayMapping": (
        Field(1, "tray_name", "string"),
        Field(2, "goal", "core.Goal"),
    ),
    "servi.TrayState": (
        Field(1, "tray_name", "string"),
        Field(2, "load_state", "servi.TrayState.LoadState"),
        Field(3, "weight_kg", "float"),
        Field(4, "load_ratio", "float"),
    ),
    "servi.TrayStates": (Field(1, "tray_states", "servi.TrayState", "repeated"),),
    "services.cloud.GetRobotStatusRequest": (Field(1, "robot_id", "string"),),
    "services.cloud.GetRobotStatusResponse": (Field(1, "robot_state", "core.RobotState"),),
    "services.cloud.SubscribeBatteryStatusRequest": (Field(1, "selector", "core.RobotSelector"),),
    "services.cloud.SubscribeBatteryStatusResponse": (
        Field(1, "metadata", "core.EventMetadata"),
        Field(2, "robot_id", "string"),
        Field(3, "battery_state", "core.BatteryState"),
    ),
    "services.cloud.SubscribeErrorCodesRequest": (Field(1, "selector", "core.RobotSelector"),),
    "services.cloud.SubscribeErrorCodesResponse": (Field(1, "error_codes", "core.ErrorCodesWithMetadata", "map"),),
    "services.cloud.SubscribeNavigationStatusRequest": (Field(1, "selector", "core.RobotSelector"),),
    "services.cloud.SubscribeNavigationStatusResponse": (
        Field(1, "metadata", "core.EventMetadata"),
        Field(2, "robot_id", "string"),
        Field(3, "navigation_state", "core.NavigationState"),
    ),
    "services.cloud.SubscribeNetworkStatusRequest": (Field(1, "selector", "core.RobotSelector"),),
    "services.cloud.SubscribeNetworkStatusResponse": (
        Field(1, "network_states", "core.NetworkStateWithMetadata", "map"),
    ),
    "services.cloud.SubscribeOnlineStatusRequest": (Field(1, "selector", "core.RobotSelector"),),
    "services.cloud.SubscribeOnlineStatusResponse": (
        Field(1, "online_states", "core.RobotConnectionWithMetadata", "map"),
    ),
    "services.cloud.SubscribeRobotStatusRequest": (Field(1, "selector", "core.RobotSelector"),),
    "services.cloud.SubscribeRobotStatusResponse": (
        Field(1, "metadata", "core.EventMetadata"),
        Field(2, "robot_id", "string"),
        Field(3, "robot_state", "core.RobotState"),
    ),
    "services.robot.AppendMissionBatchRequest": (
        Field(1, "missions", "services.robot.AppendMissionRequest", "repeated"),
    ),
    "services.robot.AppendMissionBatchResponse": (Field(1, "mission_ids", "string", "repeated"),),
    "services.robot.AppendMissionRequest": (Field(1, "mission", "core.Mission"),),
    "services.robot.AppendMissionResponse": (Field(1, "mission_id", "string"),),
    "services.robot.ChargeRobotRequest": (),
    "services.robot.ChargeRobotResponse": (Field(1, "mission_id", "string"),),
    "services.robot.ClearMissionStatusRequest": (),
    "services.robot.ClearMissionStatusResponse": (Field(1, "mission_ids", "string", "repeated"),),
    "services.robot.CreateMissionBatchRequest": (
        Field(1, "missions", "services.robot.CreateMissionRequest", "repeated"),
    ),
    "services.robot.CreateMissionBatchResponse": (Field(1, "mission_ids", "string", "repeated"),),
    "services.robot.CreateMissionRequest": (Field(1, "mission", "core.Mission"),),
    "services.robot.CreateMissionResponse": (Field(1, "mission_id", "string"),),
    "services.robot.CreateMissionWorkflowRequest": (Field(1, "mission_workflow", "core.MissionWorkflow"),),
    "services.robot.CreateMissionWorkflowResponse": (Field(1, "mission_ids", "string", "repeated"),),
    "services.robot.SkipGoalRequest": (),
    "services.robot.SkipGoalResponse": (Field(1, "mission_id", "string"),),
    "services.robot.SubscribeMissionStatusRequest": (),
    "services.robot.SubscribeMissionStatusResponse": (
        Field(1, "metadata", "core.EventMetadata"),
        Field(2, "mission_states", "core.MissionStates"),
    ),
    "services.robot.UpdateMissionRequest": (Field(1, "mission_command", "core.MissionCommand"),),
    "services.robot.UpdateMissionResponse": (),
}
"""Every message; one whose name has a dot after that of another message stands inside it."""
