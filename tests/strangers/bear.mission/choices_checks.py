"""Choices about checks: which comes first, which code a refusal has, and what counts as malformed."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

from catalogue import choice
from errors import Refusal, invalid, not_found, not_now
from model import Json, Kind, Mission, State
from service import Commit, Robot

# the order of two checks


@choice("CreateMission › Errors")
class _CreateStateFirst(Robot):
    """A malformed CreateMission to a busy robot is refused for the robot's state, not for its form."""

    def state_first(self) -> bool:
        return self.method == "CreateMission"


@choice("CreateMissionBatch › Errors")
class _BatchStateFirst(Robot):
    """A malformed CreateMissionBatch to a busy robot is refused for the robot's state, not for its form."""

    def state_first(self) -> bool:
        return self.method == "CreateMissionBatch"


@choice("CreateMissionWorkflow › Errors")
class _WorkflowStateFirst(Robot):
    """A malformed CreateMissionWorkflow to a busy robot is refused for the robot's state, not for its form."""

    def state_first(self) -> bool:
        return self.method == "CreateMissionWorkflow"


@choice("AppendMission › Errors")
class _AppendStateFirst(Robot):
    """A malformed AppendMission to an empty queue is refused for the empty queue, not for its form."""

    def state_first(self) -> bool:
        return self.method == "AppendMission"


@choice("AppendMissionBatch › Errors")
class _AppendBatchStateFirst(Robot):
    """A malformed AppendMissionBatch to an empty queue is refused for the empty queue, not for its form."""

    def state_first(self) -> bool:
        return self.method == "AppendMissionBatch"


@choice("ClearMissionStatus › Errors")
class _ClearStateFirst(Robot):
    """A ClearMissionStatus with a stray field on a busy robot is refused for the robot's state."""

    def state_first(self) -> bool:
        return self.method == "ClearMissionStatus"


@choice("UpdateMission › Errors")
class _UpdateStateFirst(Robot):
    """Without an active mission every UpdateMission, also a malformed one, is a failed precondition."""

    def update_mission(self, request: Json) -> Commit:
        if self.current is None and not self.queued():
            raise self.none_active()
        return super().update_mission(request)


@choice("UpdateMission › Errors")
class _UpdateTargetFirst(Robot):
    """The id of a queued mission is refused as such before the command is looked at."""

    def read_command_name(self, value: object) -> str:
        if self.named is not None and self.named in self.queued():
            raise self.queued_named()
        return super().read_command_name(value)

    def read_mission_id(self, value: object) -> str:
        mission_id = super().read_mission_id(value)
        self.named = self.find(mission_id)
        return mission_id

    named: Mission | None = None


@choice("ChargeRobot › Errors")
class _ChargeMapFirst(Robot):
    """A busy robot whose map has no charging location answers that there is none."""

    def charge_checks(self) -> list[Callable[[], None]]:
        return [self.require_charger, self.require_idle, self.require_dock]


@choice("ChargeRobot › Errors")
class _ChargeDockLast(Robot):
    """Without a dock and without a charging location, the missing location is what is answered."""

    def charge_checks(self) -> list[Callable[[], None]]:
        return [self.require_idle, self.require_charger, self.require_dock]


# the code of a refusal


@choice("ChargeRobot")
class _NoDockNotFound(Robot):
    """A robot without a contact dock answers ChargeRobot with NOT_FOUND."""

    def require_dock(self) -> None:
        if not self.world.contact_dock:
            raise not_found("there is no contact dock")


@choice("ChargeRobot")
class _NoDockUnimplemented(Robot):
    """A robot without a contact dock answers ChargeRobot with UNIMPLEMENTED, as it does not support the call."""

    def require_dock(self) -> None:
        if not self.world.contact_dock:
            raise Refusal("UNIMPLEMENTED", "this robot cannot charge by contact")


@choice("CreateMission › Request")
class _OtherFamilyPrecondition(Robot):
    """A mission for another robot family is well formed but does not fit, so it is a failed precondition."""

    def check_family(self, family: str) -> None:
        if family not in ("base", self.world.family):
            raise not_now("the mission is for another family")


@choice("UpdateMission › Errors")
class _UnknownIdNotFound(Robot):
    """While a mission is active, an id that no mission has is NOT_FOUND."""

    def unknown_named(self) -> Refusal:
        return not_found("there is no such mission")


@choice("UpdateMission › Errors")
class _IdleUnknownIdInvalid(Robot):
    """Without an active mission, an id that no mission has is an incorrect argument."""

    def none_active(self) -> Refusal:
        return invalid("there is no mission with that id")


@choice("UpdateMission › Errors")
class _IdleUnknownIdNotFound(Robot):
    """Without an active mission, an id that no mission has is NOT_FOUND."""

    def none_active(self) -> Refusal:
        return not_found("there is no mission with that id")


@choice("UpdateMission › Errors")
class _EndedIdNotFound(Robot):
    """While another mission is active, the id of one that has ended is NOT_FOUND."""

    def ended_named(self) -> Refusal:
        return super().ended_named() if self.current is None else not_found("that mission is not the active one")


@choice("UpdateMission › Errors")
class _EndedIdInvalid(Robot):
    """While another mission is active, the id of one that has ended does not match it and is an incorrect argument."""

    def ended_named(self) -> Refusal:
        return super().ended_named() if self.current is None else invalid("the id is not that of the running mission")


# a robot that cannot start missions


@choice("CreateMissionBatch › Errors")
class _BlockedMattersToBatches(Robot):
    """Only CreateMissionBatch minds that the robot cannot start missions; the other calls are accepted and run."""

    def require_able(self) -> None:
        if self.method == "CreateMissionBatch":
            super().require_able()


@choice("CreateMissionWorkflow › Errors")
class _BlockedIgnoredByWorkflows(Robot):
    """A workflow is accepted by a robot that is unable to start other missions."""

    def require_able(self) -> None:
        if self.method != "CreateMissionWorkflow":
            super().require_able()


@choice("ChargeRobot › Errors")
class _BlockedCanCharge(Robot):
    """A robot that is unable to start missions can still be sent to its charger."""

    def require_able(self) -> None:
        if self.method != "ChargeRobot":
            super().require_able()


@choice("CreateMission › Errors")
class _BlockedIsInternal(Robot):
    """Outside of batches, a robot that cannot start missions answers INTERNAL."""

    def require_able(self) -> None:
        if self.world.blocked and self.method != "CreateMissionBatch":
            raise Refusal("INTERNAL", "the mission could not be started")
        super().require_able()


@choice("CreateMission › Errors")
class _BlockedFailsTheMission(Robot):
    """Outside of batches, a mission for a robot that cannot start any is accepted and fails at once."""

    def require_able(self) -> None:
        if self.method == "CreateMissionBatch":
            super().require_able()

    def start(self, mission: Mission) -> None:
        super().start(mission)
        if self.world.blocked and mission is self.current:
            self.end(mission, State.FAILED)


# what is malformed


@choice("CreateMission › Errors")
class _UnknownFieldsIgnored(Robot):
    """Fields that a message does not have are passed over, as protobuf parsers may do."""

    def unknown_field(self, name: str) -> None:
        return


@choice("ClearMissionStatus › Request")
class _EmptyRequestsTakeAnything(Robot):
    """Where a request takes no fields, whatever it holds is passed over."""

    def read_nothing(self, request: object) -> None:
        return


@choice("CreateMission › Errors")
class _PatrolNeedsTwoGoals(Robot):
    """A patrol over a single goal does not suit its mission type and is refused as malformed."""

    def read_goals(self, goals: object, kind: Kind) -> list[Json]:
        found = super().read_goals(goals, kind)
        if kind.patrol and len(found) < 2:
            raise invalid("a patrol needs two goals")
        return found


@choice("CreateMission › Errors")
class _RepeatedGoalRefused(Robot):
    """A list in which a goal directly follows itself holds an invalid goal."""

    def read_goals(self, goals: object, kind: Kind) -> list[Json]:
        found = super().read_goals(goals, kind)
        if any(first == second for first, second in pairwise(found)):
            raise invalid("a goal follows itself")
        return found


@choice("CreateMission › Request")
class _TrayGoalsMustBeListed(Robot):
    """A tray may only be mapped to a goal of its mission."""

    def read_tray_mapping(self, mapping: object, goals: list[Json]) -> None:
        super().read_tray_mapping(mapping, goals)
        goal = self.fields(mapping, ("trayName", "goal")).get("goal")
        if self.read_goal(goal) not in goals:
            raise invalid("a tray is mapped to another goal")


@choice("CreateMission › Request")
class _TrayGoalMayBeMissing(Robot):
    """A tray mapping without a goal is accepted, for a tray that carries nothing."""

    def read_tray_mapping(self, mapping: object, goals: list[Json]) -> None:
        found = self.fields(mapping, ("trayName", "goal"))
        super().read_tray_mapping({"goal": goals[0], **found}, goals)


@choice("CreateMission › Request")
class _DestinationsIgnoreCase(Robot):
    """A destination matches its display name in upper and lower case alike."""

    def on_map(self, destination: str) -> bool:
        return destination.lower() in [name.lower() for name in self.world.destinations]


@choice("UpdateMission › Command enum")
class _PauseAgainAccepted(Robot):
    """To pause a paused mission is accepted and changes nothing."""

    def require_fitting(self, mission: Mission, command: str) -> None:
        if command != "COMMAND_PAUSE":
            super().require_fitting(mission, command)


@choice("UpdateMission › Command enum")
class _ResumeAgainAccepted(Robot):
    """To resume a running mission is accepted and changes nothing."""

    def require_fitting(self, mission: Mission, command: str) -> None:
        if command != "COMMAND_RESUME":
            super().require_fitting(mission, command)


@choice("UpdateMission › Command enum")
class _FinishNeedsRunning(Robot):
    """Only a running mission can be finished; a paused one has to be resumed or canceled."""

    def require_fitting(self, mission: Mission, command: str) -> None:
        super().require_fitting(mission, command)
        if command == "COMMAND_FINISH" and mission.state is State.PAUSED:
            raise not_now("the mission is paused")


@choice("ChargeRobot")
class _ChargeCannotPause(Robot):
    """A charge can be canceled and finished but not paused."""

    def require_fitting(self, mission: Mission, command: str) -> None:
        super().require_fitting(mission, command)
        if command == "COMMAND_PAUSE" and mission.kind.charge:
            raise not_now("a charge cannot be paused")
