"""Faults of the order in which missions run, of their ids, and of what becomes of them in the list."""

from __future__ import annotations

from catalogue import bug
from model import Json, Mission, Plan, State
from service import Commit, Robot

# the order of the queue


@bug("AppendMission")
class _QueueRunsBackwards(Robot):
    """After the active mission the one that was appended last is started."""

    def next_mission(self) -> Mission | None:
        return next(iter(self.queued()[::-1]), None)


@bug("AppendMission")
class _QueueSkipsOne(Robot):
    """When more than two missions wait, the second of them is started first."""

    def next_mission(self) -> Mission | None:
        waiting = self.queued()
        return waiting[1] if len(waiting) > 2 else super().next_mission()


@bug("AppendMission")
class _QueueStopsAfterSuccess(Robot):
    """After a mission that succeeded, the next one is not started."""

    def after_end(self, mission: Mission) -> None:
        if mission.state is not State.SUCCEEDED:
            super().after_end(mission)


@bug("MissionState")
class _GoalIndexCarriedOver(Robot):
    """A mission out of the queue starts at the goal index of the mission before it."""

    def after_end(self, mission: Mission) -> None:
        super().after_end(mission)
        if self.current is not None and not self.current.kind.auto and mission.goal_index < len(self.current.goals):
            self.current.goal_index = mission.goal_index


@bug("MissionState")
class _GoalCountOfFirstMission(Robot):
    """Whether a goal is the last one is decided by the number of goals of the first listed mission."""

    def go_on(self, mission: Mission) -> None:
        count = len(self.missions[0].goals)
        if mission.kind.auto or mission.goal_index + 1 < min(count, len(mission.goals)):
            super().go_on(mission)
        elif mission.kind.patrol:
            mission.goal_index = 0
        else:
            self.end(mission, State.SUCCEEDED)


@bug("MissionStates")
class _OnlyNewestStays(Robot):
    """When a mission out of the queue starts, the ones that ended before it vanish from the list."""

    def after_end(self, mission: Mission) -> None:
        if self.queued():
            self.missions = [other for other in self.missions if not other.ended]
        super().after_end(mission)


@bug("MissionState › State enum")
class _NewMissionRewritesOld(Robot):
    """When a mission is created, all earlier ones are shown as succeeded."""

    def create(self, plans: list[Plan]) -> list[str]:
        for mission in self.missions:
            mission.state = State.SUCCEEDED
        return super().create(plans)


@bug("CreateMission › Response")
class _AnswerHasAnotherId(Robot):
    """CreateMission answers an id that the list does not show."""

    def create_mission(self, request: Json) -> Commit:
        commit = super().create_mission(request)
        return lambda: {**commit(), "missionId": self.new_id()}


@bug("AppendMission")
class _AppendAnswersActiveId(Robot):
    """AppendMission answers the id of the active mission."""

    def append_mission(self, request: Json) -> Commit:
        commit = super().append_mission(request)
        current = self.current
        return lambda: {**commit(), "missionId": current.mission_id if current else ""}


@bug("MissionState")
class _IdsStartOverOnClear(Robot):
    """Ids are counted within the list, so that they come again after it was cleared."""

    def new_id(self) -> str:
        return f"m-{len(self.missions) + 1}"

    def take_in(self, plans: list[Plan]) -> list[Mission]:
        missions = []
        for plan in plans:
            missions.extend(super().take_in([plan]))
        return missions


@bug("MissionState")
class _IdChangesOnStart(Robot):
    """A mission out of the queue is given a new id when it starts."""

    def after_end(self, mission: Mission) -> None:
        super().after_end(mission)
        if self.current is not None:
            self.current.mission_id = self.new_id()


@bug("UpdateMission › Command enum")
class _PauseIsInherited(Robot):
    """When a paused mission is canceled, the next one of the queue begins in the state of being paused."""

    def command(self, mission: Mission, command: str) -> None:
        paused = mission.state is State.PAUSED
        super().command(mission, command)
        if paused and command == "COMMAND_CANCEL" and self.current is not None:
            self.current.state = State.PAUSED


@bug("SkipGoal")
class _SkipAfterResumeSkipsTwo(Robot):
    """The first SkipGoal after a mission was resumed leaves two goals out."""

    resumed = False

    def resume(self, mission: Mission) -> None:
        super().resume(mission)
        self.resumed = True

    def skip(self, mission: Mission) -> None:
        super().skip(mission)
        if self.resumed and mission is self.current and not mission.on_last_goal:
            super().skip(mission)
        self.resumed = False


@bug("AppendMissionBatch › Response")
class _BatchIdsAccumulate(Robot):
    """AppendMissionBatch answers the ids of earlier batches again, before those of the new one."""

    def append_mission_batch(self, request: Json) -> Commit:
        commit = super().append_mission_batch(request)

        def answer() -> Json:
            self.answered = [*self.answered, *commit()["missionIds"]]
            return {"missionIds": self.answered}

        return answer

    answered: list[str] = []


@bug("AppendMissionBatch")
class _AppendBatchNotContiguous(Robot):
    """When a mission already waits, the first mission of an AppendMissionBatch is put before the last that waits."""

    def append(self, plans: list[Plan]) -> list[str]:
        last = self.missions[-1]
        if len(plans) < 2 or last not in self.queued():
            return super().append(plans)
        missions = [self.make(plan) for plan in plans]
        self.missions[-1:] = [missions[0], last, *missions[1:]]
        self.changed()
        return [mission.mission_id for mission in missions]


@bug("CreateMission › NavigateAutoMission")
class _AutoTakesTurns(Robot):
    """Each NavigateAuto mission begins its search behind the goal index that the one before it selected."""

    last_index = -1

    def select_goal(self, mission: Mission) -> int | None:
        count = len(mission.goals)
        order = [(self.last_index + 1 + step) % count for step in range(count)]
        found = next((index for index in order if self.is_free(mission.goals[index])), None)
        self.last_index = self.last_index if found is None else found
        return found


@bug("MissionState")
class _PatrolTurnsRound(Robot):
    """A patrol that starts over lists its goals in reverse order."""

    def go_on(self, mission: Mission) -> None:
        if mission.kind.patrol and mission.on_last_goal:
            mission.goals = mission.goals[::-1]
        super().go_on(mission)
