"""Faults of what the status shows of the missions."""

from __future__ import annotations

from catalogue import bug
from model import Json, Kind, Mission, Plan, State
from service import Robot

# the list and its index


@bug("MissionStates")
class _ListReversed(Robot):
    """Missions are listed from the last to the first."""

    def listed(self) -> list[Mission]:
        return super().listed()[::-1]


@bug("MissionStates")
class _QueueNotListed(Robot):
    """Missions that wait are not listed."""

    def listed(self) -> list[Mission]:
        return [mission for mission in super().listed() if mission.state is not State.DEFAULT]


@bug("MissionStates")
class _FailedNotListed(Robot):
    """Missions that failed are not listed."""

    def listed(self) -> list[Mission]:
        return [mission for mission in super().listed() if mission.state is not State.FAILED]


@bug("MissionStates")
class _ActiveListedFirst(Robot):
    """The active mission is listed before those that were assigned earlier."""

    def listed(self) -> list[Mission]:
        return sorted(super().listed(), key=lambda mission: mission is not self.current)


@bug("MissionStates")
class _IndexFromOne(Robot):
    """The index of the active mission counts from one."""

    def current_index(self) -> int:
        index = super().current_index()
        return index if index < 0 else index + 1


@bug("MissionStates")
class _IndexZeroWhenIdle(Robot):
    """The index is 0 when no mission is active."""

    def current_index(self) -> int:
        return max(super().current_index(), 0)


@bug("MissionStates")
class _IndexStaysAfterEnd(Robot):
    """When the last mission has ended, the index still names it."""

    def current_index(self) -> int:
        index = super().current_index()
        return len(self.listed()) - 1 if index < 0 and self.missions else index


@bug("MissionStates")
class _IndexStaysAfterFailure(Robot):
    """When the last mission has failed, the index still names it."""

    def current_index(self) -> int:
        last = self.missions[-1] if self.missions else None
        if self.current is None and last is not None and last.state is State.FAILED:
            return len(self.missions) - 1
        return super().current_index()


@bug("MissionStates")
class _IndexAlwaysFirst(Robot):
    """The index is 0 whichever mission is active."""

    def current_index(self) -> int:
        return min(super().current_index(), 0)


@bug("MissionStates")
class _IndexOfLast(Robot):
    """The index names the last mission of the list, also when that one waits."""

    def current_index(self) -> int:
        return len(self.listed()) - 1 if self.current is not None else -1


@bug("MissionStates")
class _IndexWithoutEnded(Robot):
    """The index does not count missions that have ended without success."""

    def current_index(self) -> int:
        index = super().current_index()
        uncounted = [m for m in self.listed()[: max(index, 0)] if m.state in (State.CANCELED, State.FAILED)]
        return index - len(uncounted)


@bug("MissionStates")
class _NoIndexWhilePaused(Robot):
    """While the active mission is paused, another one is named as active: the next of the list."""

    def current_index(self) -> int:
        index = super().current_index()
        paused = self.current is not None and self.current.state is State.PAUSED
        return index + 1 if paused and index + 1 < len(self.listed()) else index


# states


@bug("MissionState › State enum")
class _QueuedShowsRunning(Robot):
    """A mission that waits is shown as running."""

    def shown_state(self, mission: Mission) -> State:
        return State.RUNNING if mission.state is State.DEFAULT else mission.state


@bug("MissionState › State enum")
class _QueuedShowsPaused(Robot):
    """A mission that waits is shown as paused."""

    def shown_state(self, mission: Mission) -> State:
        return State.PAUSED if mission.state is State.DEFAULT else mission.state


@bug("MissionState › State enum")
class _FirstGoalShowsDefault(Robot):
    """A mission out of the queue is shown in the initial state until it has reached its first goal."""

    def shown_state(self, mission: Mission) -> State:
        fresh = mission.state is State.RUNNING and mission.goal_index == 0 and mission is not self.missions[0]
        return State.DEFAULT if fresh and not mission.kind.charge else mission.state


@bug("MissionState › State enum")
class _FailureShowsCanceled(Robot):
    """A mission that failed is shown as canceled."""

    def shown_state(self, mission: Mission) -> State:
        return State.CANCELED if mission.state is State.FAILED else mission.state


@bug("MissionState › State enum")
class _PausedFailureStaysPaused(Robot):
    """A mission that fails while it is paused is shown as paused for good."""

    def mission_failed(self) -> bool:
        mission = self.current
        if mission is None or mission.state is not State.PAUSED:
            return super().mission_failed()
        self.current = None
        self.begin()
        self.changed()
        return True


@bug("MissionState › State enum")
class _PatrolSuccessShowsCanceled(Robot):
    """A patrol that ended well is shown as canceled."""

    def shown_state(self, mission: Mission) -> State:
        patrol_done = mission.kind.patrol and mission.state is State.SUCCEEDED
        return State.CANCELED if patrol_done else mission.state


@bug("MissionState › State enum")
class _LastGoalShowsSucceeded(Robot):
    """A mission of several goals is shown as succeeded as soon as it heads for the last of them."""

    def shown_state(self, mission: Mission) -> State:
        early = mission is self.current and not mission.kind.patrol and not mission.kind.auto
        early = early and len(mission.goals) > 1 and mission.on_last_goal
        return State.SUCCEEDED if early else mission.state


@bug("MissionState › State enum")
class _ChargeSuccessShowsFailed(Robot):
    """A charge that is full is shown as failed."""

    def shown_state(self, mission: Mission) -> State:
        full = mission.kind.charge and mission.state is State.SUCCEEDED
        return State.FAILED if full else mission.state


# goals


@bug("MissionState")
class _GoalsReversed(Robot):
    """The goals of Carti missions are listed in reverse order."""

    def shown_goals(self, mission: Mission) -> list[Json]:
        goals = super().shown_goals(mission)
        return goals[::-1] if mission.kind.member == "carti" else goals


@bug("MissionState")
class _GoalsSorted(Robot):
    """Goals are listed in alphabetical order."""

    def shown_goals(self, mission: Mission) -> list[Json]:
        return sorted(super().shown_goals(mission), key=lambda goal: str(goal.get("destinationId", "")))


@bug("MissionState")
class _GoalsWithoutRepeats(Robot):
    """A goal that is given twice is listed once."""

    def shown_goals(self, mission: Mission) -> list[Json]:
        goals: list[Json] = []
        for goal in super().shown_goals(mission):
            if goal not in goals:
                goals.append(goal)
        return goals


@bug("MissionState")
class _GoalsLeftOnly(Robot):
    """Only the goals that are still to come are listed."""

    def shown_goals(self, mission: Mission) -> list[Json]:
        goals = super().shown_goals(mission)
        return goals if mission.kind.auto or mission.ended else goals[mission.goal_index :]


@bug("MissionState")
class _QueuedGoalsHidden(Robot):
    """A mission that waits is listed without its goals."""

    def shown_goals(self, mission: Mission) -> list[Json]:
        return [] if mission.state is State.DEFAULT else super().shown_goals(mission)


@bug("MissionState")
class _AutoGoalsNarrowed(Robot):
    """A NavigateAuto mission lists the goal that it selected, alone."""

    def shown_goals(self, mission: Mission) -> list[Json]:
        goals = super().shown_goals(mission)
        chosen = mission.kind.auto and mission.state is not State.DEFAULT
        return goals[mission.goal_index : mission.goal_index + 1] if chosen else goals


@bug("MissionState")
class _PosesHidden(Robot):
    """Goals that are poses are not listed."""

    def shown_goals(self, mission: Mission) -> list[Json]:
        return [goal for goal in super().shown_goals(mission) if "pose" not in goal]


@bug("MissionState")
class _HeadingLost(Robot):
    """The heading of a pose is lost."""

    def read_pose(self, pose: object) -> Json:
        return {**super().read_pose(pose), "headingRadians": 0.0}


@bug("MissionState")
class _HeadingInDegrees(Robot):
    """The heading of a pose is shown in degrees."""

    def read_pose(self, pose: object) -> Json:
        found = super().read_pose(pose)
        return {**found, "headingRadians": round(found["headingRadians"] * 57.29578, 3)}


# the goal index


@bug("MissionState")
class _GoalIndexFromOne(Robot):
    """The index of the current goal counts from one."""

    def shown_goal_index(self, mission: Mission) -> int:
        return mission.goal_index + 1


@bug("MissionState")
class _GoalIndexStopsBeforeLast(Robot):
    """The index of the current goal never names the last of several goals."""

    def shown_goal_index(self, mission: Mission) -> int:
        return min(mission.goal_index, max(len(mission.goals) - 2, 0))


@bug("MissionState")
class _GoalIndexZeroInQueue(Robot):
    """For missions out of the queue the index of the current goal stays 0."""

    def shown_goal_index(self, mission: Mission) -> int:
        return mission.goal_index if mission is self.missions[0] else 0


@bug("MissionState")
class _GoalIndexZeroWhilePaused(Robot):
    """While a mission is paused, the index of its current goal is 0."""

    def shown_goal_index(self, mission: Mission) -> int:
        return 0 if mission.state is State.PAUSED else mission.goal_index


@bug("MissionState")
class _AutoGoalIndexZero(Robot):
    """For NavigateAuto missions the index of the current goal is 0 whichever was selected."""

    def shown_goal_index(self, mission: Mission) -> int:
        return 0 if mission.kind.auto else mission.goal_index


@bug("carti.CartiType enum")
class _CartiPatrolEnds(Robot):
    """A traverse patrol ends after one round."""

    def go_on(self, mission: Mission) -> None:
        if mission.kind.type_name == "CARTI_TYPE_TRAVERSE_PATROL" and mission.on_last_goal:
            self.end(mission, State.SUCCEEDED)
        else:
            super().go_on(mission)


@bug("servi.ServiType enum")
class _PatrolRestartsAtSecond(Robot):
    """A patrol that starts over leaves its first goal out."""

    def go_on(self, mission: Mission) -> None:
        restart = mission.kind.patrol and mission.on_last_goal and len(mission.goals) > 1
        super().go_on(mission)
        if restart:
            mission.goal_index = 1


@bug("servi.ServiType enum")
class _PatrolEndsAfterTwoRounds(Robot):
    """A patrol ends by itself after two rounds."""

    def go_on(self, mission: Mission) -> None:
        if mission.kind.patrol and mission.on_last_goal:
            self.rounds = {**self.rounds, mission.mission_id: self.rounds.get(mission.mission_id, 0) + 1}
            if self.rounds[mission.mission_id] >= 2:
                self.end(mission, State.SUCCEEDED)
                return
        super().go_on(mission)

    rounds: dict[str, int] = {}


@bug("carti.CartiType enum")
class _TraverseLoops(Robot):
    """A traverse mission starts over after its last goal."""

    def go_on(self, mission: Mission) -> None:
        if mission.kind.type_name == "CARTI_TYPE_TRAVERSE" and mission.on_last_goal:
            mission.goal_index = 0
        else:
            super().go_on(mission)


def _renamed(kind: Kind, type_name: str) -> Kind:
    return Kind(kind.member, type_name, kind.patrol, kind.auto, kind.charge, kind.single)


@bug("MissionState")
class _AppendedTypeOfActive(Robot):
    """A mission that is appended is listed with the type of the active one, if both are of one family."""

    def make(self, plan: Plan) -> Mission:
        mission = super().make(plan)
        active = self.current
        if active is not None and active.kind.member == plan.kind.member and self.method.startswith("Append"):
            mission.kind = _renamed(mission.kind, active.kind.type_name)
        return mission
