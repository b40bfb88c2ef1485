"""Faults of UpdateMission."""

from __future__ import annotations

from catalogue import bug
from errors import Refusal, invalid, not_found, not_now
from model import Json, Mission, State
from service import Commit, Robot

# what a command does


@bug("MissionState › State enum")
class _CancelShowsFailed(Robot):
    """A mission that was canceled is shown as failed."""

    def command(self, mission: Mission, command: str) -> None:
        if command == "COMMAND_CANCEL":
            self.end(mission, State.FAILED)
        else:
            super().command(mission, command)


@bug("UpdateMission › Command enum")
class _CancelShowsSucceeded(Robot):
    """A mission that was canceled on its last goal is shown as succeeded."""

    def command(self, mission: Mission, command: str) -> None:
        if command == "COMMAND_CANCEL" and mission.on_last_goal and not mission.kind.charge:
            self.end(mission, State.SUCCEEDED)
        else:
            super().command(mission, command)


@bug("UpdateMission › Command enum")
class _FinishShowsCanceled(Robot):
    """A mission that was finished is shown as canceled."""

    def command(self, mission: Mission, command: str) -> None:
        self.end(mission, State.CANCELED) if command == "COMMAND_FINISH" else super().command(mission, command)


@bug("UpdateMission › Command enum")
class _FinishGoesOneGoalOn(Robot):
    """To finish a mission only takes it to its next goal."""

    def command(self, mission: Mission, command: str) -> None:
        if command == "COMMAND_FINISH" and not mission.kind.charge:
            self.go_on(mission)
        else:
            super().command(mission, command)


@bug("UpdateMission › Command enum")
class _PatrolCannotFinish(Robot):
    """To finish a patrol is accepted and it goes on."""

    def command(self, mission: Mission, command: str) -> None:
        if command != "COMMAND_FINISH" or not mission.kind.patrol:
            super().command(mission, command)


@bug("UpdateMission › Command enum")
class _CancelPausedOnly(Robot):
    """To cancel a running mission only pauses it; to cancel it once more ends it."""

    def command(self, mission: Mission, command: str) -> None:
        if command == "COMMAND_CANCEL" and mission.state is State.RUNNING:
            self.pause(mission)
        else:
            super().command(mission, command)


@bug("UpdateMission › Command enum")
class _PauseShowsRunning(Robot):
    """A paused mission is shown as running."""

    def shown_state(self, mission: Mission) -> State:
        return State.RUNNING if mission.state is State.PAUSED else mission.state


@bug("UpdateMission › Command enum")
class _PauseEndsMission(Robot):
    """To pause a mission out of the queue cancels it."""

    def pause(self, mission: Mission) -> None:
        if mission is self.missions[0]:
            super().pause(mission)
        else:
            self.end(mission, State.CANCELED)


@bug("UpdateMission › Command enum")
class _ResumeOnlyOnce(Robot):
    """A mission that was paused for the second time stays paused when it is resumed."""

    def resume(self, mission: Mission) -> None:
        if mission.mission_id not in self.resumed:
            super().resume(mission)
        self.resumed = [*self.resumed, mission.mission_id]

    resumed: list[str] = []


@bug("UpdateMission › Command enum")
class _ResumeTakesNextGoal(Robot):
    """A mission that is resumed has lost the goal that it was heading for."""

    def resume(self, mission: Mission) -> None:
        super().resume(mission)
        if not mission.kind.auto and not mission.on_last_goal:
            mission.goal_index += 1


@bug("UpdateMission › Command enum")
class _ResumePatrolStaysPaused(Robot):
    """To resume a patrol is accepted and it stays paused."""

    def resume(self, mission: Mission) -> None:
        if not mission.kind.patrol:
            super().resume(mission)


@bug("UpdateMission › Command enum")
class _PausedMissionCannotBeCanceled(Robot):
    """To cancel a paused mission is a failed precondition."""

    def require_fitting(self, mission: Mission, command: str) -> None:
        super().require_fitting(mission, command)
        if command == "COMMAND_CANCEL" and mission.state is State.PAUSED:
            raise not_now("the mission is paused")


@bug("UpdateMission › Command enum")
class _FinishUnsupported(Robot):
    """The command to finish is refused as unknown."""

    def read_command_name(self, value: object) -> str:
        name = super().read_command_name(value)
        if name == "COMMAND_FINISH":
            raise invalid("there is no such command")
        return name


@bug("UpdateMission › Command enum")
class _CommandsOffByOne(Robot):
    """Pause and resume are mixed up."""

    def read_command_name(self, value: object) -> str:
        name = super().read_command_name(value)
        mixed = {"COMMAND_PAUSE": "COMMAND_RESUME", "COMMAND_RESUME": "COMMAND_PAUSE"}
        return mixed.get(name, name)


# what is refused


@bug("UpdateMission")
class _QueuedCanBeCanceled(Robot):
    """A queued mission can be canceled."""

    def update_target(self, mission_id: str) -> Mission:
        named = self.find(mission_id)
        return named if named is not None and named in self.queued() else super().update_target(mission_id)

    def require_fitting(self, mission: Mission, command: str) -> None:
        if mission is not self.current and command != "COMMAND_CANCEL":
            raise self.queued_named()
        super().require_fitting(mission, command)

    def command(self, mission: Mission, command: str) -> None:
        if mission is self.current:
            super().command(mission, command)
        else:
            mission.state = State.CANCELED


@bug("UpdateMission")
class _QueuedPrecondition(Robot):
    """A command to a queued mission is answered with FAILED_PRECONDITION."""

    def queued_named(self) -> Refusal:
        return not_now("the mission waits")


@bug("UpdateMission")
class _QueuedInvalid(Robot):
    """A command to a queued mission is answered with INVALID_ARGUMENT."""

    def queued_named(self) -> Refusal:
        return invalid("the mission is not the running one")


@bug("UpdateMission")
class _QueuedBehindPausedPrecondition(Robot):
    """While the active mission is paused, a command to a queued one is answered with FAILED_PRECONDITION."""

    def queued_named(self) -> Refusal:
        if self.current is not None and self.current.state is State.PAUSED:
            return not_now("the robot is paused")
        return super().queued_named()


@bug("UpdateMission › Request")
class _IdNotCompared(Robot):
    """A command with whatever id is carried out on the active mission."""

    def update_target(self, mission_id: str) -> Mission:
        return self.current if self.current is not None else super().update_target(mission_id)


@bug("UpdateMission › Request")
class _UnknownIdMeansActive(Robot):
    """An id that no mission has is taken for that of the active one."""

    def update_target(self, mission_id: str) -> Mission:
        if self.current is not None and self.find(mission_id) is None:
            return self.current
        return super().update_target(mission_id)


@bug("UpdateMission › Request")
class _MissingIdMeansActive(Robot):
    """A command without an id is carried out on the active mission."""

    def read_mission_id(self, value: object) -> str:
        if value in (None, "") and self.current is not None:
            return self.current.mission_id
        return super().read_mission_id(value)


@bug("UpdateMission › Errors")
class _EndedCanBeFinished(Robot):
    """A command to cancel or finish a mission that has ended is accepted and changes its state."""

    def update_target(self, mission_id: str) -> Mission:
        named = self.find(mission_id)
        return named if named is not None and named.ended else super().update_target(mission_id)

    def command(self, mission: Mission, command: str) -> None:
        if mission.ended:
            mission.state = State.CANCELED if command == "COMMAND_CANCEL" else State.SUCCEEDED
        else:
            super().command(mission, command)


@bug("UpdateMission › Errors")
class _CanceledCanBeResumed(Robot):
    """A canceled mission that is resumed runs again when the robot is idle."""

    def update_mission(self, request: Json) -> Commit:
        mission_id, command = self.read_command(request)
        named = self.find(mission_id)
        if command != "COMMAND_RESUME" or named is None or named.state is not State.CANCELED or self.current:
            return super().update_mission(request)

        def commit() -> Json:
            named.state = State.RUNNING
            self.current = named
            self.changed()
            return {}

        return commit


@bug("UpdateMission › Errors")
class _CancelEndedAccepted(Robot):
    """To cancel a mission that has ended is accepted and does nothing."""

    def update_mission(self, request: Json) -> Commit:
        mission_id, command = self.read_command(request)
        named = self.find(mission_id)
        if command == "COMMAND_CANCEL" and named is not None and named.ended:
            return lambda: {}
        return super().update_mission(request)


@bug("UpdateMission › Errors")
class _IdleUpdateAccepted(Robot):
    """Without an active mission every well-formed command is accepted and does nothing."""

    def update_mission(self, request: Json) -> Commit:
        self.read_command(request)
        return super().update_mission(request) if self.current is not None else lambda: {}


@bug("UpdateMission › Errors")
class _UnknownCommandAccepted(Robot):
    """A command that is not set is accepted and does nothing."""

    def read_command_name(self, value: object) -> str:
        return "" if value in (0, "COMMAND_UNKNOWN") else super().read_command_name(value)

    def command(self, mission: Mission, command: str) -> None:
        if command:
            super().command(mission, command)


@bug("UpdateMission › Errors")
class _UnknownCommandPrecondition(Robot):
    """A command that does not exist is answered with FAILED_PRECONDITION."""

    def read_command_name(self, value: object) -> str:
        try:
            return super().read_command_name(value)
        except Refusal as refusal:
            raise not_now(refusal.message) from None


@bug("UpdateMission › Errors")
class _EmptyUpdateNotFound(Robot):
    """An UpdateMission without a command message is answered with NOT_FOUND."""

    def read_command(self, request: object) -> tuple[str, str]:
        if not self.fields(request, ("missionCommand",)).get("missionCommand"):
            raise not_found("there is no mission to update")
        return super().read_command(request)


@bug("UpdateMission › Errors")
class _RefusedCommandPauses(Robot):
    """A command that is refused for its unknown id leaves the active mission paused."""

    def unknown_named(self) -> Refusal:
        if self.current is not None and self.current.state is State.RUNNING:
            self.current.state = State.PAUSED
        return super().unknown_named()


@bug("UpdateMission › Errors")
class _RefusedPauseTakesNextGoal(Robot):
    """A pause that is refused, as the mission is already paused, makes the mission lose a goal."""

    def require_fitting(self, mission: Mission, command: str) -> None:
        if command == "COMMAND_PAUSE" and mission.state is State.PAUSED and not mission.on_last_goal:
            mission.goal_index += 1
        super().require_fitting(mission, command)


@bug("UpdateMission › Errors")
class _UpdateOnlyFirstMission(Robot):
    """Only the first listed mission can be commanded; an active one behind it is taken for queued."""

    def update_target(self, mission_id: str) -> Mission:
        mission = super().update_target(mission_id)
        if mission is not self.missions[0]:
            raise self.queued_named()
        return mission


@bug("SubscribeMissionStatus")
class _PauseIsNotAnnounced(Robot):
    """No update follows when a mission is paused."""

    def pause(self, mission: Mission) -> None:
        super().pause(mission)
        self.silent = True

    def changed(self) -> None:
        if not self.silent:
            super().changed()
        self.silent = False

    silent = False


@bug("SubscribeMissionStatus")
class _ResumeIsNotAnnounced(Robot):
    """No update follows when a mission is resumed."""

    def resume(self, mission: Mission) -> None:
        super().resume(mission)
        self.silent = True

    def changed(self) -> None:
        if not self.silent:
            super().changed()
        self.silent = False

    silent = False
