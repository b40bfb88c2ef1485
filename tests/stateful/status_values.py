"""What robots report, part by part. Robot Status › GetRobotStatus › Response; nothing contradicts itself."""

from __future__ import annotations

from typing import Any

from hypothesis import strategies as st

from missionfsm import Goal, Pose, State
from missionfsm.bear.status.messages import (
    BatteryMode,
    BatteryState,
    CartiState,
    ChargeMethod,
    ConnectionState,
    ConveyorState,
    Emergency,
    EmergencyStopState,
    ErrorCode,
    ErrorCodes,
    LoadState,
    NavigationState,
    OperationState,
    Reason,
    RobotConnection,
    Security,
    ServiState,
    Severity,
    Stuck,
    StuckState,
    TrayState,
    TrayStates,
    Twist,
    Wifi,
)
from missionfsm.bear.wire.messages import MissionState

_BATTERIES = st.sampled_from(
    [
        (BatteryMode.STATE_CHARGING, ChargeMethod.CHARGE_METHOD_CONTACT),
        (BatteryMode.STATE_CHARGING, ChargeMethod.CHARGE_METHOD_WIRED),
        (BatteryMode.STATE_DISCHARGING, ChargeMethod.CHARGE_METHOD_NONE),
    ]
)
_ERRORS = st.builds(
    ErrorCode,
    st.sampled_from([1001, 2042]),
    st.sampled_from([Severity.SEVERITY_LOW, Severity.SEVERITY_MEDIUM, Severity.SEVERITY_HIGH]),
    st.sampled_from(["Low battery", "A camera is lost"]),
)
_STUCK = st.sampled_from(
    [
        # NavigationState › StuckState: a reason only where the robot is stuck; reasons 2 and 3 are reserved.
        StuckState(Stuck.STATE_NOT_STUCK, Reason.REASON_UNKNOWN),
        StuckState(Stuck.STATE_STUCK, Reason.REASON_UNKNOWN),
        StuckState(Stuck.STATE_STUCK, Reason.REASON_PATH_BLOCKED),
        StuckState(Stuck.STATE_STUCK, Reason.REASON_INSIDE_RESTRICTED_AREA),
    ]
)

PARTS: dict[str, st.SearchStrategy[Any]] = {
    "connection": st.builds(
        RobotConnection, st.sampled_from([ConnectionState.STATE_CONNECTED, ConnectionState.STATE_DISCONNECTED])
    ),
    # BatteryState › charge_percent: 0 to 100.
    "battery": st.builds(lambda percent, how: BatteryState(percent, *how), st.integers(0, 100), _BATTERIES),
    "emergency_stop": st.builds(
        EmergencyStopState,
        *[st.sampled_from([Emergency.EMERGENCY_ENGAGED, Emergency.EMERGENCY_DISENGAGED])] * 2,
    ),
    "mission": st.builds(
        lambda state, at: MissionState("mission-123", state, (Goal("kitchen"), Goal("table-1")), at, owner="api"),
        st.sampled_from([State.STATE_RUNNING, State.STATE_PAUSED, State.STATE_SUCCEEDED]),
        st.integers(0, 1),
    ),
    "pose": st.builds(Pose, *[st.sampled_from([0.0, 1.5, -2.25])] * 3),
    "error_codes": st.builds(lambda codes: ErrorCodes(tuple(codes)), st.lists(_ERRORS, max_size=2)),
    "twist": st.builds(Twist, *[st.sampled_from([0.0, 0.5, -0.25])] * 2),
    "navigation_state": st.builds(NavigationState, _STUCK),
    # typed_status: one of the two, that of the robot's family.
    "servi_state": st.builds(
        lambda state: ServiState(TrayStates((TrayState("top", state, 2.5, 0.5),))),
        st.sampled_from([LoadState.LOAD_STATE_LOADED, LoadState.LOAD_STATE_EMPTY]),
    ),
    "carti_state": st.builds(
        lambda state: CartiState(ConveyorState(1, state)),
        st.sampled_from([OperationState.OPERATION_STATE_ROLLING, OperationState.OPERATION_STATE_STOP]),
    ),
    # SubscribeNetworkStatus › Wifi › link_quality: 0 to 70.
    "wifi": st.builds(
        Wifi,
        st.sampled_from(["Office", "Kitchen"]),
        st.integers(-90, -30),
        st.integers(0, 70),
        st.sampled_from([Security.SECURITY_UNSECURED, Security.SECURITY_PASSWORD_SECURED]),
    ),
}
"""For each field of RobotState, and for the network, what a robot may report."""
