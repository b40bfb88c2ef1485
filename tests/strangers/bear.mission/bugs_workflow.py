"""Faults of workflows and of charging."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from catalogue import bug
from errors import Refusal, invalid, not_found, not_now
from model import WORKFLOW_KINDS, Json, Kind, Mission, Plan, State, World
from service import Commit, Robot

# CreateMissionWorkflow


@bug("CreateMissionWorkflow › Errors")
class _WorkflowWhileRunning(Robot):
    """CreateMissionWorkflow on a robot with a running mission queues its missions."""

    def require_workflow(self) -> None:
        if self.current is None or self.current.state is not State.RUNNING:
            super().require_workflow()


@bug("CreateMissionWorkflow › Errors")
class _WorkflowWhileCharging(Robot):
    """CreateMissionWorkflow during a charge queues its missions."""

    def require_workflow(self) -> None:
        if self.current is None or not self.current.kind.charge:
            super().require_workflow()


@bug("CreateMissionWorkflow › Errors")
class _WorkflowOfOtherFamily(Robot):
    """Workflows of the other family are accepted."""

    def check_workflow_family(self, family: str) -> None:
        return


@bug("CreateMissionWorkflow › Errors")
class _WorkflowOnBaseUnit(Robot):
    """A robot of the base family takes Servi workflows."""

    def check_workflow_family(self, family: str) -> None:
        if self.world.family != "base" or family != "servi":
            super().check_workflow_family(family)


@bug("CreateMissionWorkflow › Errors")
class _WorkflowFamilyPrecondition(Robot):
    """A workflow of another family is answered with FAILED_PRECONDITION."""

    def check_workflow_family(self, family: str) -> None:
        if family != self.world.family:
            raise not_now("the workflow is for another family")


@bug("CreateMissionWorkflow")
class _TwoWorkflowsAccepted(Robot):
    """Of two workflow types that are set the first is taken."""

    def one_of(self, message: object, members: Iterable[str], beside: tuple[str, ...] = ()) -> tuple[str, Any]:
        found = self.fields(message, (*members, *beside))
        if self.method == "CreateMissionWorkflow" and len(found) > 1:
            return next(iter(found.items()))
        return super().one_of(message, members, beside)


@bug("CreateMissionWorkflow › Errors")
class _EmptyWorkflowInternal(Robot):
    """A workflow request without a workflow is answered with INTERNAL."""

    def read_workflow(self, request: object) -> list[Plan]:
        if not self.fields(request, ("missionWorkflow",)).get("missionWorkflow"):
            raise Refusal("INTERNAL", "there is no workflow")
        return super().read_workflow(request)


@bug("CreateMissionWorkflow › Servi workflow types")
class _HostingMissing(Robot):
    """The hosting workflow is refused as unknown."""

    def plan_workflow(self, name: str, kind: Kind, body: object) -> list[Plan]:
        if name == "hosting":
            raise invalid("there is no such workflow")
        return super().plan_workflow(name, kind, body)


@bug("CreateMissionWorkflow › Servi workflow types")
class _BirthdayTakesList(Robot):
    """The birthday workflow takes a list of goals."""

    def plan_workflow(self, name: str, kind: Kind, body: object) -> list[Plan]:
        if name == "birthday" and isinstance(body, dict) and "goals" in body:
            return [Plan(kind, self.read_goals(body["goals"], kind))]
        return super().plan_workflow(name, kind, body)


@bug("CreateMissionWorkflow › Servi workflow types")
class _BussingWorkflowDelivers(Robot):
    """The bussing workflow creates a serving mission."""

    def plan_workflow(self, name: str, kind: Kind, body: object) -> list[Plan]:
        plans = super().plan_workflow(name, kind, body)
        return [Plan(WORKFLOW_KINDS["servi"]["delivery"], plans[0].goals)] if name == "bussing" else plans


@bug("CreateMissionWorkflow › Carti workflow types")
class _TraversePatrolWorkflowEnds(Robot):
    """The traverse patrol workflow creates a mission of type Traverse."""

    def plan_workflow(self, name: str, kind: Kind, body: object) -> list[Plan]:
        plans = super().plan_workflow(name, kind, body)
        return [Plan(WORKFLOW_KINDS["carti"]["traverse"], plans[0].goals)] if name == "traversePatrol" else plans


@bug("CreateMissionWorkflow › Response")
class _WorkflowAnswersNoIds(Robot):
    """CreateMissionWorkflow answers without ids."""

    def create_mission_workflow(self, request: Json) -> Commit:
        commit = super().create_mission_workflow(request)
        return lambda: {"missionIds": commit()["missionIds"][:0]}


# ChargeRobot


@bug("ChargeRobot › Errors")
class _ChargeWhileRunning(Robot):
    """ChargeRobot on a robot with a running mission queues the charge."""

    def require_idle(self) -> None:
        if self.current is None or self.current.state is not State.RUNNING:
            super().require_idle()


@bug("ChargeRobot › Errors")
class _ChargeCancelsMission(Robot):
    """ChargeRobot cancels the active mission by itself and charges."""

    def require_idle(self) -> None:
        return

    def create(self, plans: list[Plan]) -> list[str]:
        if plans[0].kind.charge and self.current is not None:
            self.current.state = State.CANCELED
            self.current = None
        return super().create(plans)


@bug("ChargeRobot › Errors")
class _ChargeWithoutLocation(Robot):
    """ChargeRobot is accepted without a charging location on the map."""

    def require_charger(self) -> None:
        return


@bug("ChargeRobot › Errors")
class _ChargeNoLocationPrecondition(Robot):
    """Without a charging location on the map ChargeRobot is answered with FAILED_PRECONDITION."""

    def require_charger(self) -> None:
        if not self.world.charging_location:
            raise not_now("there is no charging location")


@bug("ChargeRobot")
class _ChargeWithoutDock(Robot):
    """A robot without a contact dock accepts ChargeRobot."""

    def require_dock(self) -> None:
        return


@bug("ChargeRobot › Errors")
class _ChargeLocationIsStale(Robot):
    """ChargeRobot goes by the charging location that the map had when the robot started."""

    def __init__(self, world: World) -> None:
        super().__init__(world)
        self.had_location = world.charging_location

    def require_charger(self) -> None:
        if not self.had_location:
            raise not_found("there is no charging location")


@bug("ChargeRobot › Response")
class _ChargeNotListed(Robot):
    """The status does not list charges."""

    def listed(self) -> list[Mission]:
        return [mission for mission in super().listed() if not mission.kind.charge]


@bug("ChargeRobot › Response")
class _ChargeAnswersAnotherId(Robot):
    """ChargeRobot answers an id that the list does not show."""

    def charge_robot(self, request: Json) -> Commit:
        commit = super().charge_robot(request)
        return lambda: {**commit(), "missionId": self.new_id()}


@bug("ChargeRobot › Errors")
class _ChargeRefusedAfterEnd(Robot):
    """ChargeRobot is refused while the mission before it is still listed, though it has ended."""

    def require_idle(self) -> None:
        super().require_idle()
        if self.missions:
            raise not_now("a mission is listed")


@bug("ChargeRobot › Errors")
class _ChargeCannotBeCanceled(Robot):
    """A charge cannot be canceled: UpdateMission takes it for no mission."""

    def update_target(self, mission_id: str) -> Mission:
        mission = super().update_target(mission_id)
        if mission.kind.charge:
            raise not_now("no mission is active")
        return mission


@bug("ChargeRobot")
class _ChargeOnlyWhenIdleForever(Robot):
    """A second charge is refused with FAILED_PRECONDITION, as the robot takes itself for charged."""

    def require_idle(self) -> None:
        super().require_idle()
        if any(mission.kind.charge and mission.state is State.SUCCEEDED for mission in self.missions):
            raise not_now("the robot has been charged")
