"""Choices about what the status shows of a mission."""

from __future__ import annotations

import secrets
import struct

from catalogue import choice
from model import Json, Mission, Plan, State
from service import Robot

# states and indices


@choice("MissionState › State enum")
class _QueuedStateUnknown(Robot):
    """A mission that waits has no documented state, so its state is not returned."""

    def shown_state(self, mission: Mission) -> State:
        return State.UNKNOWN if mission.state is State.DEFAULT else mission.state


@choice("MissionState › State enum")
class _IdlePlaceholder(Robot):
    """A robot that lists no mission shows one nameless entry in the initial state."""

    def mission_states(self) -> Json:
        states = super().mission_states()
        if not states["missions"]:
            states["missions"] = [{"missionId": "", "state": "STATE_DEFAULT", "goals": [], "currentGoalIndex": 0}]
        return states


@choice("MissionState")
class _GoalIndexZeroAtEnd(Robot):
    """A mission that has ended shows its first goal as the current one again."""

    def shown_goal_index(self, mission: Mission) -> int:
        return 0 if mission.ended else mission.goal_index


@choice("MissionState")
class _GoalIndexNoneAtEnd(Robot):
    """A mission that has ended has no active goal, which is shown as -1."""

    def shown_goal_index(self, mission: Mission) -> int:
        return -1 if mission.ended else mission.goal_index


@choice("MissionState")
class _GoalIndexNoneInQueue(Robot):
    """A mission that waits has no active goal, which is shown as -1."""

    def shown_goal_index(self, mission: Mission) -> int:
        return -1 if mission.state is State.DEFAULT else mission.goal_index


@choice("MissionState")
class _ChargeGoalIndexNone(Robot):
    """A charge has no goals, so its current one is shown as -1."""

    def shown_goal_index(self, mission: Mission) -> int:
        return -1 if mission.kind.charge else mission.goal_index


# the charge


@choice("MissionType")
class _ChargeTypeUnknown(Robot):
    """A charge shows the unknown base type."""

    def shown_type(self, mission: Mission) -> Json:
        return {"baseType": "BASE_TYPE_UNKNOWN"} if mission.kind.charge else super().shown_type(mission)


@choice("MissionType")
class _ChargeTypeUnknownOfFamily(Robot):
    """A charge shows the unknown type of the robot's family."""

    def shown_type(self, mission: Mission) -> Json:
        family = self.world.family
        if mission.kind.charge:
            return {f"{family}Type": f"{family.upper()}_TYPE_UNKNOWN"}
        return super().shown_type(mission)


@choice("MissionType")
class _ChargeTypeNavigate(Robot):
    """A charge shows the type of a navigation of the robot's family, to the charger."""

    def shown_type(self, mission: Mission) -> Json:
        family = self.world.family
        if mission.kind.charge:
            return {f"{family}Type": f"{family.upper()}_TYPE_NAVIGATE"}
        return super().shown_type(mission)


@choice("ChargeRobot › Response")
class _ChargeShowsItsGoal(Robot):
    """A charge lists the charger as its goal."""

    def shown_goals(self, mission: Mission) -> list[Json]:
        return [{"destinationId": "contact-charger"}] if mission.kind.charge else super().shown_goals(mission)


# ids, owners, coordinates


@choice("MissionState")
class _IdsAreCounted(Robot):
    """Ids are a word and a number that grows for as long as the program runs."""

    last_id = 0

    def new_id(self) -> str:
        type(self).last_id += 1
        return f"mission-{self.last_id}"


@choice("MissionState")
class _IdsAreShort(Robot):
    """Ids are ten random hexadecimal digits."""

    def new_id(self) -> str:
        return secrets.token_hex(5)


@choice("MissionState")
class _OwnerNamesTheVersion(Robot):
    """The owner of missions that were created over the API is shown with its version."""

    def shown_owner(self, mission: Mission) -> str:
        return "api/v1"


@choice("MissionState")
class _OwnerOfChargeIsRobot(Robot):
    """A charge is owned by the robot itself, whoever asked for it."""

    def shown_owner(self, mission: Mission) -> str:
        return "robot" if mission.kind.charge else super().shown_owner(mission)


@choice("MissionState")
class _OwnerOfWorkflowIsPreset(Robot):
    """Missions of a workflow are owned by the preset that made them."""

    def make(self, plan: Plan) -> Mission:
        mission = super().make(plan)
        mission.owner = "preset" if self.method == "CreateMissionWorkflow" else mission.owner
        return mission


@choice("SubscribeMissionStatus › JSON Response Example")
class _PosesInSinglePrecision(Robot):
    """Coordinates are kept in 32 bits and shown as such."""

    def read_number(self, value: object) -> float:
        number: float = struct.unpack("f", struct.pack("f", super().read_number(value)))[0]
        return number
