"""The messages of the mission API, field by field as they are on the wire (numbers: see the published definitions)."""

from __future__ import annotations

import enum

from attrs import frozen

from missionfsm.bear.wire.protojson import Int64, Timestamp, member


class Command(enum.IntEnum):
    """What UpdateMission may ask for."""

    COMMAND_UNKNOWN = 0
    COMMAND_CANCEL = 1
    COMMAND_PAUSE = 2
    COMMAND_RESUME = 3
    COMMAND_FINISH = 4


class State(enum.IntEnum):
    """The lifecycle state of a mission, as MissionState reports it."""

    STATE_UNKNOWN = 0
    STATE_DEFAULT = 1
    STATE_RUNNING = 2
    STATE_PAUSED = 3
    STATE_CANCELED = 4
    STATE_SUCCEEDED = 5
    STATE_FAILED = 6


class BaseType(enum.IntEnum):
    """Types of base missions."""

    BASE_TYPE_UNKNOWN = 0
    BASE_TYPE_NAVIGATE = 1
    BASE_TYPE_NAVIGATE_AUTO = 2


class ServiType(enum.IntEnum):
    """Types of Servi missions."""

    SERVI_TYPE_UNKNOWN = 0
    SERVI_TYPE_SERVING = 1
    SERVI_TYPE_SERVING_PATROL = 2
    SERVI_TYPE_BUSSING = 3
    SERVI_TYPE_BUSSING_PATROL = 4
    SERVI_TYPE_NAVIGATE = 5
    SERVI_TYPE_NAVIGATE_AUTO = 6


class CartiType(enum.IntEnum):
    """Types of Carti missions."""

    CARTI_TYPE_UNKNOWN = 0
    CARTI_TYPE_TRAVERSE = 1
    CARTI_TYPE_TRAVERSE_PATROL = 2
    CARTI_TYPE_NAVIGATE = 3
    CARTI_TYPE_NAVIGATE_AUTO = 4


class BaseStatus(enum.IntEnum):
    """Feedback of a base mission."""

    STATUS_UNKNOWN = 0
    STATUS_NAVIGATING = 1


class FamilyStatus(enum.IntEnum):
    """Feedback of a Servi or Carti mission."""

    STATUS_UNKNOWN = 0
    STATUS_NAVIGATING = 1
    STATUS_ARRIVED = 2
    STATUS_DOCKING = 3
    STATUS_UNDOCKING = 4


@frozen
class Pose:
    """A place on the map: metres, metres, radians."""

    x_meters: float = 0.0
    y_meters: float = 0.0
    heading_radians: float = 0.0

    def __str__(self) -> str:
        return f"pose ({self.x_meters:g}, {self.y_meters:g}, {self.heading_radians:g})"


@frozen(cache_hash=True)
class Goal:
    """Where to go: a destination of the map by its display name, or a pose."""

    destination_id: str | None = member("goal")
    pose: Pose | None = member("goal")

    def __str__(self) -> str:
        return str(self.pose) if self.pose is not None else self.destination_id or "no goal"


@frozen
class OneGoal:
    """The payload of missions and workflows that have a single goal."""

    goal: Goal | None = None


@frozen
class ManyGoals:
    """The payload of missions and workflows that have a list of goals."""

    goals: tuple[Goal, ...] = ()


@frozen
class Params:
    """Parameters without fields."""


@frozen
class TrayMapping:
    """Which tray is for which goal."""

    tray_name: str = ""
    goal: Goal | None = None


@frozen
class DeliveryParams:
    """Parameters of a delivery mission."""

    tray_mappings: tuple[TrayMapping, ...] = ()


@frozen
class DeliveryMission:
    """A delivery: goals, with trays assigned to them if wanted."""

    goals: tuple[Goal, ...] = ()
    params: DeliveryParams | None = None


@frozen
class GoalsMission:
    """Any other mission with goals and parameters without fields."""

    goals: tuple[Goal, ...] = ()
    params: Params | None = None


@frozen
class BaseMission:
    """Missions of every family."""

    navigate_mission: OneGoal | None = member("mission")
    navigate_auto_mission: ManyGoals | None = member("mission")


@frozen
class ServiMission:
    """Missions of the Servi family."""

    delivery_mission: DeliveryMission | None = member("mission")
    bussing_mission: GoalsMission | None = member("mission")
    delivery_patrol_mission: GoalsMission | None = member("mission")
    bussing_patrol_mission: GoalsMission | None = member("mission")
    navigate_mission: OneGoal | None = member("mission")
    navigate_auto_mission: ManyGoals | None = member("mission")


@frozen
class CartiMission:
    """Missions of the Carti family."""

    traverse_mission: GoalsMission | None = member("mission")
    traverse_patrol_mission: GoalsMission | None = member("mission")
    navigate_mission: OneGoal | None = member("mission")
    navigate_auto_mission: ManyGoals | None = member("mission")


@frozen
class Mission:
    """One mission of one family."""

    base_mission: BaseMission | None = member("mission")
    servi_mission: ServiMission | None = member("mission")
    carti_mission: CartiMission | None = member("mission")


@frozen
class MissionRequest:
    """CreateMissionRequest and AppendMissionRequest."""

    mission: Mission | None = None


@frozen
class BatchRequest:
    """CreateMissionBatchRequest and AppendMissionBatchRequest."""

    missions: tuple[MissionRequest, ...] = ()


@frozen
class ServiWorkflow:
    """Preset workflows of the Servi family."""

    delivery: ManyGoals | None = member("workflow")
    delivery_patrol: ManyGoals | None = member("workflow")
    bussing: ManyGoals | None = member("workflow")
    bussing_patrol: ManyGoals | None = member("workflow")
    birthday: OneGoal | None = member("workflow")
    hosting: ManyGoals | None = member("workflow")
    hosting_patrol: ManyGoals | None = member("workflow")


@frozen
class CartiWorkflow:
    """Preset workflows of the Carti family."""

    traverse: ManyGoals | None = member("workflow")
    traverse_patrol: ManyGoals | None = member("workflow")


@frozen
class MissionWorkflow:
    """One workflow of one family."""

    servi_workflow: ServiWorkflow | None = member("workflow")
    carti_workflow: CartiWorkflow | None = member("workflow")


@frozen
class WorkflowRequest:
    """CreateMissionWorkflowRequest."""

    mission_workflow: MissionWorkflow | None = None


@frozen
class MissionCommand:
    """Which mission, and what to do with it."""

    mission_id: str = ""
    command: Command = Command.COMMAND_UNKNOWN


@frozen
class UpdateRequest:
    """UpdateMissionRequest."""

    mission_command: MissionCommand | None = None


@frozen
class Empty:
    """A request without fields."""


@frozen
class MissionIds:
    """The answer of calls that make or clear several missions."""

    mission_ids: tuple[str, ...] = ()


@frozen
class MissionId:
    """The answer of calls that concern one mission."""

    mission_id: str = ""


@frozen
class EventMetadata:
    """When an event was recorded, and its number in the robot's sequence."""

    timestamp: Timestamp | None = None
    sequence_number: Int64 = Int64(0)


@frozen
class BaseFeedback:
    """Feedback of a base mission."""

    status: BaseStatus = BaseStatus.STATUS_UNKNOWN


@frozen
class FamilyFeedback:
    """Feedback of a Servi or Carti mission."""

    status: FamilyStatus = FamilyStatus.STATUS_UNKNOWN


@frozen
class MissionFeedback:
    """What a mission says of itself while it runs."""

    base_feedback: BaseFeedback | None = member("feedback")
    servi_feedback: FamilyFeedback | None = member("feedback")
    carti_feedback: FamilyFeedback | None = member("feedback")


@frozen
class MissionType:
    """The type of a mission, in the enum of its family."""

    base_type: BaseType | None = member("type")
    servi_type: ServiType | None = member("type")
    carti_type: CartiType | None = member("type")


@frozen(cache_hash=True)
class MissionState:
    """One listed mission."""

    mission_id: str = ""
    state: State = State.STATE_UNKNOWN
    goals: tuple[Goal, ...] = ()
    current_goal_index: int = 0
    mission_feedback: MissionFeedback | None = None
    mission_type: MissionType | None = None
    owner: str = ""


@frozen
class MissionStates:
    """All listed missions, first to last, and which of them is active."""

    missions: tuple[MissionState, ...] = ()
    current_mission_index: int = 0


@frozen
class MissionStatus:
    """SubscribeMissionStatusResponse."""

    metadata: EventMetadata | None = None
    mission_states: MissionStates | None = None
