"""Choices about the queue: what follows on an end, how goals are taken, and what a skip does."""

from __future__ import annotations

from catalogue import choice
from errors import Refusal, not_now
from model import Json, Kind, Mission, Plan, State
from service import Robot

# after the end of a mission


class _QueueEnder(Robot):
    """Ends the waiting missions with the one before them."""

    trigger = State.CANCELED
    outcome = State.CANCELED

    def after_end(self, mission: Mission) -> None:
        if mission.state is self.trigger:
            for waiting in self.queued():
                waiting.state = self.outcome
        super().after_end(mission)


@choice("UpdateMission › Command enum")
class _CancelCancelsQueue(_QueueEnder):
    """To cancel the active mission cancels all that wait behind it."""


@choice("MissionState › State enum")
class _FailureCancelsQueue(_QueueEnder):
    """When a mission fails, all that wait behind it are canceled."""

    trigger = State.FAILED


@choice("MissionState › State enum")
class _FailureFailsQueue(_QueueEnder):
    """When a mission fails, all that wait behind it fail with it."""

    trigger = State.FAILED
    outcome = State.FAILED


@choice("UpdateMission › Command enum")
class _CancelHoldsQueue(Robot):
    """After a cancel the queue stands still until something is appended, or it is cleared."""

    def after_end(self, mission: Mission) -> None:
        if mission.state is not State.CANCELED:
            super().after_end(mission)


@choice("MissionState › State enum")
class _FailureHoldsQueue(Robot):
    """After a failure the queue stands still until something is appended, or it is cleared."""

    def after_end(self, mission: Mission) -> None:
        if mission.state is not State.FAILED:
            super().after_end(mission)


@choice("AppendMission › Errors")
class _AppendAfterEnd(Robot):
    """Missions that have ended count as being in the queue until they are cleared: what is appended starts."""

    def require_queue(self) -> None:
        if not self.missions:
            super().require_queue()


@choice("MissionStates")
class _NewStartDropsEnded(Robot):
    """A mission that is created on a free robot opens a new list; those that have ended are no longer in it."""

    def create(self, plans: list[Plan]) -> list[str]:
        self.missions = [mission for mission in self.missions if not mission.ended]
        return super().create(plans)


@choice("ChargeRobot")
class _ChargeDropsEnded(Robot):
    """A charge opens a new list; the missions that ended before it are no longer in it."""

    def create(self, plans: list[Plan]) -> list[str]:
        if plans[0].kind.charge:
            self.missions = [mission for mission in self.missions if not mission.ended]
        return super().create(plans)


@choice("CreateMissionBatch › Errors")
class _BlockedFailsInTurn(Robot):
    """A queued mission whose turn comes while the robot cannot start missions fails."""

    def start(self, mission: Mission) -> None:
        super().start(mission)
        if self.world.blocked and mission is self.current:
            self.end(mission, State.FAILED)


@choice("CreateMissionBatch › Errors")
class _BlockedHoldsQueue(Robot):
    """A queued mission whose turn comes while the robot cannot start missions waits until it is able again."""

    def begin(self) -> None:
        if not self.world.blocked:
            super().begin()

    def look_around(self) -> None:
        self.begin()


@choice("UpdateMission › Command enum")
class _ResumeStartsOver(Robot):
    """A mission that is resumed sets out for its first goal again."""

    def resume(self, mission: Mission) -> None:
        super().resume(mission)
        if not mission.kind.auto:
            mission.goal_index = 0


# goals and the map


@choice("CreateMission › NavigateAutoMission")
class _AutoWaitsForFreeGoal(Robot):
    """A NavigateAuto mission without a free goal runs without heading for one until a goal is free."""

    waiting: Mission | None = None

    def nothing_free(self, mission: Mission) -> None:
        mission.feedback = ""
        self.waiting = mission

    def look_around(self) -> None:
        mission = self.waiting
        if mission is None or mission is not self.current:
            return
        found = self.select_goal(mission)
        if found is not None:
            mission.goal_index = found
            mission.feedback = self.first_feedback(mission)
            self.waiting = None

    def goal_reached(self) -> bool:
        if self.waiting is not None and self.waiting is self.current:
            return False
        return super().goal_reached()


@choice("CreateMission › NavigateAutoMission")
class _AutoRefusedWithoutFreeGoal(Robot):
    """To create a NavigateAuto mission while none of its goals is free is a failed precondition."""

    def read_body(self, kind: Kind, body: object) -> Plan:
        plan = super().read_body(kind, body)
        if kind.auto and self.method.startswith("Create") and not any(self.is_free(goal) for goal in plan.goals):
            raise not_now("no goal is free")
        return plan


@choice("CreateMission › NavigateAutoMission")
class _AutoSelectsOnAcceptance(Robot):
    """A NavigateAuto mission selects its goal when it is accepted, also if it has to wait for its turn."""

    selected: dict[str, int | None] = {}

    def make(self, plan: Plan) -> Mission:
        mission = super().make(plan)
        if plan.kind.auto:
            found = super().select_goal(mission)
            self.selected = {**self.selected, mission.mission_id: found}
            mission.goal_index = found or 0
        return mission

    def select_goal(self, mission: Mission) -> int | None:
        found = self.selected.get(mission.mission_id)
        return super().select_goal(mission) if found is None else found


@choice("CreateMission › NavigateAutoMission")
class _AutoSelectsAnew(Robot):
    """A running NavigateAuto mission turns to another free goal when its own becomes occupied."""

    def look_around(self) -> None:
        mission = self.current
        if mission is not None and mission.kind.auto and not self.is_free(mission.goals[mission.goal_index]):
            found = self.select_goal(mission)
            mission.goal_index = mission.goal_index if found is None else found


@choice("CreateMission › NavigateAutoMission")
class _AutoFallsBackToFirst(Robot):
    """A NavigateAuto mission without a free goal heads for the first one and queues up there."""

    def nothing_free(self, mission: Mission) -> None:
        mission.goal_index = 0


class _MapWatcher(Robot):
    """Notices that the goal of the active mission has left the map."""

    def off_map(self, goal: Json) -> bool:
        return "destinationId" in goal and not self.on_map(goal["destinationId"])

    def lost_goal(self) -> Mission | None:
        mission = self.current
        if mission is None or mission.kind.charge or not self.off_map(mission.goals[mission.goal_index]):
            return None
        return mission


@choice("CreateMission › Request")
class _GoalOffMapFails(_MapWatcher):
    """A mission fails when the goal that it is heading for leaves the map."""

    def look_around(self) -> None:
        mission = self.lost_goal()
        if mission is not None:
            self.end(mission, State.FAILED)


@choice("CreateMission › Request")
class _GoalOffMapIsPassedBy(_MapWatcher):
    """A mission goes on to its next goal when its own leaves the map, and fails if none is left."""

    def look_around(self) -> None:
        mission = self.lost_goal()
        for _ in mission.goals if mission is not None else []:
            if mission is None or mission is not self.lost_goal():
                return
            if mission.kind.auto or (mission.on_last_goal and not mission.kind.patrol):
                break
            self.go_on(mission)
        if mission is not None and mission is self.lost_goal():
            self.end(mission, State.FAILED)


@choice("AppendMission")
class _QueuedOffMapFails(_MapWatcher):
    """A queued mission fails in its turn if one of its goals has left the map by then."""

    def start(self, mission: Mission) -> None:
        super().start(mission)
        if mission is self.current and any(self.off_map(goal) for goal in mission.goals):
            self.end(mission, State.FAILED)


# SkipGoal


@choice("SkipGoal")
class _SkipLastRefused(Robot):
    """Where no goal follows, SkipGoal is a failed precondition; a patrol always has a next goal."""

    def skip_target(self) -> Mission:
        mission = super().skip_target()
        if not mission.kind.patrol and (mission.kind.auto or mission.on_last_goal):
            raise not_now("no goal follows")
        return mission


@choice("SkipGoal")
class _SkipLastCancels(Robot):
    """A mission whose last goal is skipped has not been completed and counts as canceled."""

    def skip(self, mission: Mission) -> None:
        if not mission.kind.patrol and (mission.kind.auto or mission.on_last_goal):
            self.end(mission, State.CANCELED)
        else:
            super().skip(mission)


@choice("SkipGoal")
class _SkipAutoTakesNextFree(Robot):
    """A NavigateAuto mission whose goal is skipped turns to the next free goal of its list, if there is one."""

    def skip(self, mission: Mission) -> None:
        later = range(mission.goal_index + 1, len(mission.goals))
        found = next((index for index in later if mission.kind.auto and self.is_free(mission.goals[index])), None)
        if found is None:
            super().skip(mission)
        else:
            mission.goal_index = found


@choice("SkipGoal")
class _SkipAutoRefused(Robot):
    """A NavigateAuto mission selects its goal by itself, so SkipGoal is a failed precondition there."""

    def skip_target(self) -> Mission:
        mission = super().skip_target()
        if mission.kind.auto:
            raise not_now("the mission selects its goal by itself")
        return mission


@choice("SkipGoal › Errors")
class _SkipChargeInternal(Robot):
    """SkipGoal during a charge is an operation that fails: INTERNAL."""

    def skip_target(self) -> Mission:
        if self.current is not None and self.current.kind.charge and self.current.state is State.RUNNING:
            raise Refusal("INTERNAL", "the goal could not be skipped")
        return super().skip_target()


@choice("SkipGoal")
class _SkipChargeEndsIt(Robot):
    """SkipGoal during a charge ends it, as nothing follows."""

    def skip_target(self) -> Mission:
        mission = self.current
        if mission is not None and mission.kind.charge and mission.state is State.RUNNING:
            return mission
        return super().skip_target()


# workflows


@choice("CreateMissionWorkflow")
class _WorkflowMissionPerGoal(Robot):
    """A workflow that is no patrol becomes one mission for each of its goals."""

    def plan_workflow(self, name: str, kind: Kind, body: object) -> list[Plan]:
        plans = super().plan_workflow(name, kind, body)
        return plans if kind.patrol else [Plan(kind, [goal]) for goal in plans[0].goals]


@choice("CreateMissionWorkflow")
class _WorkflowReturns(Robot):
    """A workflow that is no patrol is followed by a second mission, which drives to the return point."""

    def plan_workflow(self, name: str, kind: Kind, body: object) -> list[Plan]:
        plans = super().plan_workflow(name, kind, body)
        home = {"pose": {"xMeters": 0.0, "yMeters": 0.0, "headingRadians": 0.0}}
        back = Kind(kind.member, f"{kind.member.upper()}_TYPE_NAVIGATE", single=True)
        return plans if kind.patrol else [*plans, Plan(back, [home])]


class _WorkflowTyped(Robot):
    """Shows some workflows with a type of the enum."""

    types: dict[str, str] = {}

    def plan_workflow(self, name: str, kind: Kind, body: object) -> list[Plan]:
        plans = super().plan_workflow(name, kind, body)
        shown = Kind(kind.member, self.types.get(name, kind.type_name), patrol=kind.patrol, single=kind.single)
        return [Plan(shown, plan.goals) for plan in plans]


@choice("CreateMissionWorkflow › Servi workflow types")
class _BirthdayIsServing(_WorkflowTyped):
    """A birthday workflow is shown as a serving mission, for want of a type of its own."""

    types = {"birthday": "SERVI_TYPE_SERVING"}


@choice("CreateMissionWorkflow › Servi workflow types")
class _BirthdayIsNavigation(_WorkflowTyped):
    """A birthday workflow is shown as a navigation to its single goal, for want of a type of its own."""

    types = {"birthday": "SERVI_TYPE_NAVIGATE"}


@choice("CreateMissionWorkflow › Servi workflow types")
class _HostingIsServing(_WorkflowTyped):
    """Hosting workflows are shown as serving missions, for want of types of their own."""

    types = {"hosting": "SERVI_TYPE_SERVING", "hostingPatrol": "SERVI_TYPE_SERVING_PATROL"}
