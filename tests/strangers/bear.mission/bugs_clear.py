"""Faults of clearing and skipping."""

from __future__ import annotations

from catalogue import bug
from errors import invalid, not_found, not_now
from model import Json, Mission, Plan, State
from service import Commit, Robot

# ClearMissionStatus


@bug("ClearMissionStatus › Errors")
class _ClearWhileRunning(Robot):
    """ClearMissionStatus is accepted while a mission runs, which goes on unseen."""

    def require_nothing_active(self) -> None:
        if self.current is None or self.current.state is not State.RUNNING:
            super().require_nothing_active()


@bug("ClearMissionStatus › Errors")
class _ClearWhilePaused(Robot):
    """ClearMissionStatus while a mission is paused cancels and clears it."""

    def require_nothing_active(self) -> None:
        if self.current is None or self.current.state is not State.PAUSED:
            super().require_nothing_active()

    def clear(self) -> list[str]:
        self.current = None
        return super().clear()


@bug("ClearMissionStatus › Errors")
class _ClearWhileCharging(Robot):
    """ClearMissionStatus is accepted during a charge, which ends."""

    def require_nothing_active(self) -> None:
        if self.current is None or not self.current.kind.charge:
            super().require_nothing_active()

    def clear(self) -> list[str]:
        self.current = None
        return super().clear()


@bug("ClearMissionStatus › Response")
class _ClearAnswersLastId(Robot):
    """ClearMissionStatus answers the id of the last mission alone."""

    def clear(self) -> list[str]:
        return super().clear()[-1:]


@bug("ClearMissionStatus › Response")
class _ClearAnswersNoIds(Robot):
    """ClearMissionStatus answers without ids."""

    def clear(self) -> list[str]:
        return super().clear()[:0]


@bug("ClearMissionStatus")
class _ClearKeepsList(Robot):
    """ClearMissionStatus answers the ids and leaves the missions listed."""

    def clear(self) -> list[str]:
        return [mission.mission_id for mission in self.missions]


@bug("ClearMissionStatus")
class _ClearKeepsLast(Robot):
    """ClearMissionStatus leaves the last mission listed when there are several."""

    def clear(self) -> list[str]:
        kept = self.missions[-1:] if len(self.missions) > 1 else []
        ids = super().clear()
        self.missions = kept
        self.changed()
        return ids


@bug("ClearMissionStatus")
class _ClearKeepsCanceled(Robot):
    """ClearMissionStatus removes no canceled missions."""

    def clear(self) -> list[str]:
        kept = [mission for mission in self.missions if mission.state is State.CANCELED]
        ids = [mission.mission_id for mission in self.missions if mission not in kept]
        self.missions = kept
        self.changed()
        return ids


@bug("SubscribeMissionStatus")
class _ClearIsNotAnnounced(Robot):
    """No update follows on ClearMissionStatus."""

    def clear(self) -> list[str]:
        ids = [mission.mission_id for mission in self.missions]
        self.missions = []
        return ids


@bug("ClearMissionStatus › Errors")
class _ClearRefusedAfterFailure(Robot):
    """ClearMissionStatus is refused when a mission has failed."""

    def require_nothing_active(self) -> None:
        super().require_nothing_active()
        if any(mission.state is State.FAILED for mission in self.missions):
            raise not_now("a mission has failed")


@bug("ClearMissionStatus")
class _RefusedClearClearsEnded(Robot):
    """A ClearMissionStatus that is refused has removed the missions that have ended."""

    def clear_mission_status(self, request: Json) -> Commit:
        self.missions = [mission for mission in self.missions if not mission.ended]
        return super().clear_mission_status(request)


@bug("ClearMissionStatus")
class _ClearedComeBack(Robot):
    """Missions that were cleared are listed again when the next mission is created."""

    def clear(self) -> list[str]:
        self.kept = list(self.missions)
        return super().clear()

    def create(self, plans: list[Plan]) -> list[str]:
        self.missions = [*self.kept, *self.missions]
        self.kept = []
        return super().create(plans)

    kept: list[Mission] = []


@bug("ClearMissionStatus › Errors")
class _ClearBusyInvalid(Robot):
    """ClearMissionStatus on a busy robot is answered with INVALID_ARGUMENT."""

    def require_nothing_active(self) -> None:
        if self.current is not None:
            raise invalid("a mission is active")


# SkipGoal


@bug("SkipGoal › Errors")
class _SkipWhilePaused(Robot):
    """SkipGoal is accepted while the mission is paused."""

    def skip_target(self) -> Mission:
        if self.current is not None and self.current.state is State.PAUSED:
            return self.current
        return super().skip_target()


@bug("SkipGoal › Errors")
class _SkipIdleNotFound(Robot):
    """SkipGoal without a mission is answered with NOT_FOUND."""

    def skip_target(self) -> Mission:
        if self.current is None:
            raise not_found("there is no mission")
        return super().skip_target()


@bug("SkipGoal")
class _SkipTwoGoals(Robot):
    """SkipGoal leaves two goals out when more than one is to come."""

    def skip(self, mission: Mission) -> None:
        super().skip(mission)
        if mission is self.current and not mission.on_last_goal:
            super().skip(mission)


@bug("SkipGoal")
class _SkipEndsMission(Robot):
    """SkipGoal ends the mission, whatever goals are to come."""

    def skip(self, mission: Mission) -> None:
        self.end(mission, State.SUCCEEDED)


@bug("SkipGoal")
class _SkipDoesNothing(Robot):
    """SkipGoal is accepted and the mission keeps its goal."""

    def skip(self, mission: Mission) -> None:
        return


@bug("SkipGoal")
class _SkipDropsGoal(Robot):
    """SkipGoal takes the goal out of the mission's list."""

    def skip(self, mission: Mission) -> None:
        if mission.kind.auto or mission.on_last_goal:
            super().skip(mission)
        else:
            mission.goals = [goal for index, goal in enumerate(mission.goals) if index != mission.goal_index]


@bug("SkipGoal › Response")
class _SkipAnswersFirstId(Robot):
    """SkipGoal answers the id of the first listed mission."""

    def skip_goal(self, request: Json) -> Commit:
        commit = super().skip_goal(request)
        first = self.missions[0].mission_id
        return lambda: {**commit(), "missionId": first}


@bug("SkipGoal › Response")
class _SkipAnswersNextId(Robot):
    """SkipGoal over the last goal answers the id of the mission that starts thereby."""

    def skip_goal(self, request: Json) -> Commit:
        commit = super().skip_goal(request)

        def answer() -> Json:
            shown = commit()
            return {"missionId": self.current.mission_id} if self.current is not None else shown

        return answer


@bug("SkipGoal › Errors")
class _SkipOnlyInFirstMission(Robot):
    """SkipGoal takes the robot for idle when the first listed mission has ended."""

    def skip_target(self) -> Mission:
        mission = super().skip_target()
        if mission is not self.missions[0]:
            raise not_now("no mission is running")
        return mission


@bug("SubscribeMissionStatus")
class _SkipIsNotAnnounced(Robot):
    """No update follows on SkipGoal while the mission goes on."""

    def skip(self, mission: Mission) -> None:
        super().skip(mission)
        self.silent = mission is self.current

    def changed(self) -> None:
        if not self.silent:
            super().changed()
        self.silent = False

    silent = False
