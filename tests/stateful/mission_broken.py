"""Robots with one thing wrong each: the machine has to find it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from attrs import evolve

from missionfsm import FailedPrecondition, InvalidArgument, NotFound, Robot, State
from missionfsm.bear.wire.messages import EventMetadata, MissionStates, MissionStatus
from missionfsm.bear.wire.protojson import Int64


class CreatesInFrontOfNobody(Robot):
    """CreateMission is taken for AppendMission where a mission runs."""

    def call(self, method: str, params: Any) -> Any:
        try:
            return super().call(method, params)
        except FailedPrecondition:
            if method != "CreateMission":
                raise
            return super().call("AppendMission", params)


class AppendsWhatItCan(Robot):
    """AppendMissionBatch is not atomic."""

    def call(self, method: str, params: Any) -> Any:
        try:
            return super().call(method, params)
        except InvalidArgument:
            if method == "AppendMissionBatch":
                for entry in params["missions"]:
                    super().call("AppendMission", entry)
            raise


class ReversesIds(Robot):
    """The ids of a batch are not in the order of the request."""

    def call(self, method: str, params: Any) -> Any:
        answer = super().call(method, params)
        return {"missionIds": answer["missionIds"][::-1]} if method == "CreateMissionBatch" else answer


class UpdatesQueued(Robot):
    """UpdateMission of a queued mission is taken, and nothing comes of it."""

    def call(self, method: str, params: Any) -> Any:
        try:
            return super().call(method, params)
        except NotFound:
            if method != "UpdateMission":
                raise
            return {}


class UpdatesEnded(Robot):
    """UpdateMission of a mission that has ended is taken."""

    def call(self, method: str, params: Any) -> Any:
        if method == "UpdateMission":
            command = params.get("missionCommand")
            ended = (State.STATE_CANCELED, State.STATE_SUCCEEDED, State.STATE_FAILED)
            if isinstance(command, dict) and command.get("command") in (1, "COMMAND_CANCEL"):
                for one in self.status.missions:
                    if one.mission_id == command.get("missionId") and one.state in ended:
                        return {}
        return super().call(method, params)


class CancelSucceeds(Robot):
    """COMMAND_CANCEL does what COMMAND_FINISH does."""

    def call(self, method: str, params: Any) -> Any:
        command = params.get("missionCommand") if method == "UpdateMission" else None
        if isinstance(command, dict) and command.get("command") in (1, "COMMAND_CANCEL"):
            params = {"missionCommand": {**command, "command": "COMMAND_FINISH"}}
        return super().call(method, params)


class ResumesWhatRuns(Robot):
    """COMMAND_RESUME of a running mission is taken."""

    def call(self, method: str, params: Any) -> Any:
        try:
            return super().call(method, params)
        except FailedPrecondition:
            command = params.get("missionCommand") if method == "UpdateMission" else None
            running = any(one.state is State.STATE_RUNNING for one in self.status.missions)
            if running and isinstance(command, dict) and command.get("command") in (3, "COMMAND_RESUME"):
                return {}
            raise


class SkipsNothing(Robot):
    """SkipGoal is answered, and the goal stays."""

    def call(self, method: str, params: Any) -> Any:
        if method == "SkipGoal" and self.status.current_mission_index >= 0:
            mission = self.status.missions[self.status.current_mission_index]
            if mission.state is State.STATE_RUNNING and len(mission.goals) > 1:
                return {"missionId": mission.mission_id}
        return super().call(method, params)


class ForgetsWhatItCleared(Robot):
    """ClearMissionStatus answers with no ids."""

    def call(self, method: str, params: Any) -> Any:
        answer = super().call(method, params)
        return {"missionIds": []} if method == "ClearMissionStatus" else answer


class LosesGoals(Robot):
    """A workflow is created without its last goal."""

    def call(self, method: str, params: Any) -> Any:
        if method == "CreateMissionWorkflow" and isinstance(params, dict):
            for arm in (params.get("missionWorkflow") or {}).values():
                for payload in arm.values() if isinstance(arm, dict) else ():
                    if isinstance(payload, dict) and len(payload.get("goals", ())) > 1:
                        payload["goals"].pop()
        return super().call(method, params)


class PatrolsOnce(Robot):
    """A patrol ends after its last goal."""

    def goal_reached(self) -> bool:
        for mission in self.status.missions:
            kind = mission.mission_type
            names = () if kind is None else (kind.base_type, kind.servi_type, kind.carti_type)
            patrol = any(one is not None and one.name.endswith("PATROL") for one in names)
            last = mission.current_goal_index == len(mission.goals) - 1
            if mission.state is State.STATE_RUNNING and patrol and last:
                return self.mission_succeeded()
        return super().goal_reached()


class NothingIsActive(Robot):
    """The index is 0 where it should be -1."""

    @property
    def status(self) -> MissionStates:
        found = super().status
        return evolve(found, current_mission_index=max(0, found.current_mission_index))


class MissesUpdates(Robot):
    """Subscribers are not shown what is paused."""

    def updates(self, callback: Callable[[MissionStatus], object] | None = None) -> Any:
        def some(update: MissionStatus) -> None:
            states = update.mission_states
            paused = states is not None and any(one.state is State.STATE_PAUSED for one in states.missions)
            if callback is not None and not paused:
                callback(update)

        return super().updates(some)


class CountsDown(Robot):
    """Sequence numbers do not grow."""

    def updates(self, callback: Callable[[MissionStatus], object] | None = None) -> Any:
        def numbered(update: MissionStatus) -> None:
            if callback is not None:
                callback(evolve(update, metadata=EventMetadata(None, Int64(5))))

        return super().updates(numbered)


BROKEN: tuple[type[Robot], ...] = (
    CreatesInFrontOfNobody,
    AppendsWhatItCan,
    ReversesIds,
    UpdatesQueued,
    UpdatesEnded,
    CancelSucceeds,
    ResumesWhatRuns,
    SkipsNothing,
    ForgetsWhatItCleared,
    LosesGoals,
    PatrolsOnce,
    NothingIsActive,
    MissesUpdates,
    CountsDown,
)
