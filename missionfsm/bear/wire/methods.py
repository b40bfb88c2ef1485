"""The calls of the Bear API as they are on the wire, as one table. Names are relative to `fields.PACKAGE`."""

from __future__ import annotations

from attrs import frozen


@frozen
class Method:
    """A call of a service: its request, its response, and whether that is a stream."""

    service: str
    name: str
    request: str
    response: str
    streams: bool


METHODS: tuple[Method, ...] = (
    Method(
        "services.cloud.APIService",
        "GetRobotStatus",
        "services.cloud.GetRobotStatusRequest",
        "services.cloud.GetRobotStatusResponse",
        streams=False,
    ),
    Method(
        "services.cloud.APIService",
        "SubscribeBatteryStatus",
        "services.cloud.SubscribeBatteryStatusRequest",
        "services.cloud.SubscribeBatteryStatusResponse",
        streams=True,
    ),
    Method(
        "services.cloud.APIService",
        "SubscribeErrorCodes",
        "services.cloud.SubscribeErrorCodesRequest",
        "services.cloud.SubscribeErrorCodesResponse",
        streams=True,
    ),
    Method(
        "services.cloud.APIService",
        "SubscribeNavigationStatus",
        "services.cloud.SubscribeNavigationStatusRequest",
        "services.cloud.SubscribeNavigationStatusResponse",
        streams=True,
    ),
    Method(
        "services.cloud.APIService",
        "SubscribeNetworkStatus",
        "services.cloud.SubscribeNetworkStatusRequest",
        "services.cloud.SubscribeNetworkStatusResponse",
        streams=True,
    ),
    Method(
        "services.cloud.APIService",
        "SubscribeOnlineStatus",
        "services.cloud.SubscribeOnlineStatusRequest",
        "services.cloud.SubscribeOnlineStatusResponse",
        streams=True,
    ),
    Method(
        "services.cloud.APIService",
        "SubscribeRobotStatus",
        "services.cloud.SubscribeRobotStatusRequest",
        "services.cloud.SubscribeRobotStatusResponse",
        streams=True,
    ),
    Method(
        "services.robot.APIService",
        "AppendMission",
        "services.robot.AppendMissionRequest",
        "services.robot.AppendMissionResponse",
        streams=False,
    ),
    Method(
        "services.robot.APIService",
        "AppendMissionBatch",
        "services.robot.AppendMissionBatchRequest",
        "services.robot.AppendMissionBatchResponse",
        streams=False,
    ),
    Method(
        "services.robot.APIService",
        "ChargeRobot",
        "services.robot.ChargeRobotRequest",
        "services.robot.ChargeRobotResponse",
        streams=False,
    ),
    Method(
        "services.robot.APIService",
        "ClearMissionStatus",
        "services.robot.ClearMissionStatusRequest",
        "services.robot.ClearMissionStatusResponse",
        streams=False,
    ),
    Method(
        "services.robot.APIService",
        "CreateMission",
        "services.robot.CreateMissionRequest",
        "services.robot.CreateMissionResponse",
        streams=False,
    ),
    Method(
        "services.robot.APIService",
        "CreateMissionBatch",
        "services.robot.CreateMissionBatchRequest",
        "services.robot.CreateMissionBatchResponse",
        streams=False,
    ),
    Method(
        "services.robot.APIService",
        "CreateMissionWorkflow",
        "services.robot.CreateMissionWorkflowRequest",
        "services.robot.CreateMissionWorkflowResponse",
        streams=False,
    ),
    Method(
        "services.robot.APIService",
        "SkipGoal",
        "services.robot.SkipGoalRequest",
        "services.robot.SkipGoalResponse",
        streams=False,
    ),
    Method(
        "services.robot.APIService",
        "SubscribeMissionStatus",
        "services.robot.SubscribeMissionStatusRequest",
        "services.robot.SubscribeMissionStatusResponse",
        streams=True,
    ),
    Method(
        "services.robot.APIService",
        "UpdateMission",
        "services.robot.UpdateMissionRequest",
        "services.robot.UpdateMissionResponse",
        streams=False,
    ),
)
"""Every call that is modelled."""
