"""The messages of the Robot Status page, field by field as they are on the wire (numbers: the published definitions).

Three things differ from the wire so that what is wrong can be told by rule instead of as bad form: the arms of a
selector and of the typed status are plain fields here, and `localization_state`, which the page does not define, is
left out.
"""

from __future__ import annotations

import enum

from attrs import frozen

from missionfsm.bear.wire.messages import EventMetadata, MissionState, Pose


class ConnectionState(enum.IntEnum):
    """RobotConnection › State."""

    STATE_UNKNOWN = 0
    STATE_CONNECTED = 1
    STATE_DISCONNECTED = 2


class BatteryMode(enum.IntEnum):
    """BatteryState › State."""

    STATE_UNKNOWN = 0
    STATE_CHARGING = 1
    STATE_DISCHARGING = 2
    STATE_FULL = 3


class ChargeMethod(enum.IntEnum):
    """BatteryState › ChargeMethod."""

    CHARGE_METHOD_UNKNOWN = 0
    CHARGE_METHOD_NONE = 1
    CHARGE_METHOD_WIRED = 2
    CHARGE_METHOD_CONTACT = 3


class Emergency(enum.IntEnum):
    """EmergencyStopState › Emergency; of the software stop and of the button alike."""

    EMERGENCY_UNKNOWN = 0
    EMERGENCY_ENGAGED = 1
    EMERGENCY_DISENGAGED = 2


class Severity(enum.IntEnum):
    """ErrorCode › Severity."""

    SEVERITY_UNKNOWN = 0
    SEVERITY_LOW = 1
    SEVERITY_MEDIUM = 2
    SEVERITY_HIGH = 3


class Stuck(enum.IntEnum):
    """StuckState › State."""

    STATE_UNKNOWN = 0
    STATE_NOT_STUCK = 1
    STATE_STUCK = 2


class Reason(enum.IntEnum):
    """StuckState › Reason; 2 and 3 are reserved."""

    REASON_UNKNOWN = 0
    REASON_PATH_BLOCKED = 1
    REASON_DESTINATION_OBSTRUCTED = 2
    REASON_DESTINATION_UNREACHABLE = 3
    REASON_INSIDE_RESTRICTED_AREA = 4


class Security(enum.IntEnum):
    """Wifi › Security."""

    SECURITY_UNKNOWN = 0
    SECURITY_UNSECURED = 1
    SECURITY_PASSWORD_SECURED = 2
    SECURITY_USERNAME_PASSWORD_SECURED = 3


class LoadState(enum.IntEnum):
    """TrayState › LoadState."""

    LOAD_STATE_UNKNOWN = 0
    LOAD_STATE_LOADED = 1
    LOAD_STATE_EMPTY = 2
    LOAD_STATE_OVERLOADED = 3


class OperationState(enum.IntEnum):
    """ConveyorState › OperationState."""

    OPERATION_STATE_UNKNOWN = 0
    OPERATION_STATE_ROLLING = 1
    OPERATION_STATE_STOP = 2


class PayloadState(enum.IntEnum):
    """ConveyorState › PayloadState."""

    PAYLOAD_STATE_UNKNOWN = 0
    PAYLOAD_STATE_LOADED = 1
    PAYLOAD_STATE_EMPTY = 2


class HealthState(enum.IntEnum):
    """ConveyorState › HealthState."""

    HEALTH_STATE_UNKNOWN = 0
    HEALTH_STATE_OK = 1
    HEALTH_STATE_ERROR = 2


class InstallationState(enum.IntEnum):
    """ConveyorState › InstallationState."""

    INSTALLATION_STATE_UNKNOWN = 0
    INSTALLATION_STATE_INSTALLED = 1
    INSTALLATION_STATE_NOT_INSTALLED = 2


@frozen
class RobotConnection:
    """Whether the robot reaches the cloud."""

    state: ConnectionState = ConnectionState.STATE_UNKNOWN


@frozen
class BatteryState:
    """The battery: charge in percent (0 to 100), what it does, and how it is charged."""

    charge_percent: int = 0
    state: BatteryMode = BatteryMode.STATE_UNKNOWN
    charge_method: ChargeMethod = ChargeMethod.CHARGE_METHOD_UNKNOWN


@frozen
class EmergencyStopState:
    """The software emergency stop and the physical button."""

    emergency: Emergency = Emergency.EMERGENCY_UNKNOWN
    button_pressed: Emergency = Emergency.EMERGENCY_UNKNOWN


@frozen
class ErrorCode:
    """One error: its type, how bad it is, and a word for people."""

    code: int = 0
    severity: Severity = Severity.SEVERITY_UNKNOWN
    message: str = ""


@frozen
class ErrorCodes:
    """The errors that are active on a robot; their order means nothing."""

    codes: tuple[ErrorCode, ...] = ()


@frozen
class StuckState:
    """Whether the robot makes no progress, and why."""

    state: Stuck = Stuck.STATE_UNKNOWN
    reason: Reason = Reason.REASON_UNKNOWN


@frozen
class NavigationState:
    """The navigation-related state."""

    stuck_state: StuckState | None = None


@frozen
class Twist:
    """Velocity: forward in m/s, and clockwise seen from above in rad/s."""

    linear_velocity: float = 0.0
    angular_velocity: float = 0.0


@frozen
class TrayState:
    """One tray of a Servi, with its load in kilograms and as a share of the most that it carries."""

    tray_name: str = ""
    load_state: LoadState = LoadState.LOAD_STATE_UNKNOWN
    weight_kg: float = 0.0
    load_ratio: float = 0.0


@frozen
class TrayStates:
    """The trays of a Servi."""

    tray_states: tuple[TrayState, ...] = ()


@frozen
class ServiState:
    """What only a Servi has."""

    tray_states: TrayStates | None = None


@frozen
class ConveyorState:
    """The conveyor of a Carti."""

    index: int = 0
    operation_state: OperationState = OperationState.OPERATION_STATE_UNKNOWN
    payload_state: PayloadState = PayloadState.PAYLOAD_STATE_UNKNOWN
    health_state: HealthState = HealthState.HEALTH_STATE_UNKNOWN
    installation_state: InstallationState = InstallationState.INSTALLATION_STATE_UNKNOWN


@frozen
class CartiState:
    """What only a Carti has."""

    conveyor_state: ConveyorState | None = None


@frozen(cache_hash=True)
class RobotState:
    """All that is known of a robot; what it does not report is None."""

    connection: RobotConnection | None = None
    battery: BatteryState | None = None
    emergency_stop: EmergencyStopState | None = None
    mission: MissionState | None = None
    pose: Pose | None = None
    error_codes: ErrorCodes | None = None
    servi_state: ServiState | None = None
    carti_state: CartiState | None = None
    twist: Twist | None = None
    navigation_state: NavigationState | None = None


@frozen
class Wifi:
    """A Wi-Fi connection: its signal level in dBm, its quality from 0 to 70."""

    ssid: str = ""
    signal_level_dbm: int = 0
    link_quality: int = 0
    security: Security = Security.SECURITY_UNKNOWN


@frozen
class RobotIDs:
    """A list of robot ids."""

    ids: tuple[str, ...] = ()


@frozen
class RobotSelector:
    """Robots by their ids, or all at a location."""

    robot_ids: RobotIDs | None = None
    location_id: str | None = None


@frozen
class StatusRequest:
    """GetRobotStatusRequest."""

    robot_id: str = ""


@frozen
class SubscribeRequest:
    """The request of every subscription."""

    selector: RobotSelector | None = None


@frozen
class StatusResponse:
    """GetRobotStatusResponse."""

    robot_state: RobotState | None = None


@frozen
class BatteryMessage:
    """SubscribeBatteryStatusResponse."""

    metadata: EventMetadata | None = None
    robot_id: str = ""
    battery_state: BatteryState | None = None


@frozen
class NavigationMessage:
    """SubscribeNavigationStatusResponse."""

    metadata: EventMetadata | None = None
    robot_id: str = ""
    navigation_state: NavigationState | None = None


@frozen
class RobotMessage:
    """SubscribeRobotStatusResponse."""

    metadata: EventMetadata | None = None
    robot_id: str = ""
    robot_state: RobotState | None = None


@frozen
class ErrorCodesEntry:
    """ErrorCodesWithMetadata: one robot's entry in a SubscribeErrorCodesResponse."""

    metadata: EventMetadata | None = None
    codes: tuple[ErrorCode, ...] = ()


@frozen
class NetworkEntry:
    """NetworkStateWithMetadata: one robot's entry in a SubscribeNetworkStatusResponse."""

    metadata: EventMetadata | None = None
    connected_wifi: Wifi | None = None


@frozen
class OnlineEntry:
    """RobotConnectionWithMetadata: one robot's entry in a SubscribeOnlineStatusResponse."""

    metadata: EventMetadata | None = None
    connection: RobotConnection | None = None
