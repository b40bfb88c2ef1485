"""Faults of CreateMission: when it is accepted, what it checks, and which goal a robot selects."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from catalogue import bug
from errors import Refusal, not_now
from model import Json, Kind, Mission, Plan, State, World
from service import Commit, Robot

# the state of the robot


@bug("CreateMission › Errors")
class _CreateWhileRunning(Robot):
    """CreateMission on a robot with a running mission is accepted and queues the new one."""

    def require_free(self) -> None:
        if self.method != "CreateMission" or self.current is None or self.current.state is not State.RUNNING:
            super().require_free()


@bug("CreateMission › Errors")
class _CreateWhilePaused(Robot):
    """CreateMission is accepted while a mission is paused."""

    def require_free(self) -> None:
        if self.method != "CreateMission" or self.current is None or self.current.state is not State.PAUSED:
            super().require_free()


@bug("CreateMission › Errors")
class _CreateReplacesRunning(Robot):
    """CreateMission on a busy robot cancels what runs and waits, and starts the new mission."""

    def require_free(self) -> None:
        if self.method != "CreateMission":
            super().require_free()

    def create(self, plans: list[Plan]) -> list[str]:
        for mission in self.missions:
            mission.state = mission.state if mission.ended else State.CANCELED
        self.current = None
        return super().create(plans)


@bug("CreateMission › Errors")
class _CreateWhileCharging(Robot):
    """A charge does not count as a mission for CreateMission, which takes its place."""

    def require_free(self) -> None:
        if self.current is None or not self.current.kind.charge:
            super().require_free()

    def create(self, plans: list[Plan]) -> list[str]:
        if self.current is not None:
            self.current.state = State.CANCELED
            self.current = None
        return super().create(plans)


@bug("CreateMission › Errors")
class _CreateLooksAtFirstMission(Robot):
    """CreateMission only looks whether the first mission of the list has ended."""

    def require_free(self) -> None:
        if self.method != "CreateMission" or not self.missions or not self.missions[0].ended:
            super().require_free()


@bug("CreateMission › Errors")
class _CreateRefusedAfterCancel(Robot):
    """CreateMission is refused as long as the last mission of the list is a canceled one."""

    def require_free(self) -> None:
        super().require_free()
        if self.missions and self.missions[-1].state is State.CANCELED:
            raise not_now("the last mission was canceled")


@bug("CreateMission › Errors")
class _CreateRefusedAfterFailure(Robot):
    """CreateMission is refused as long as any mission of the list has failed."""

    def require_free(self) -> None:
        super().require_free()
        if any(mission.state is State.FAILED for mission in self.missions):
            raise not_now("a mission has failed")


@bug("CreateMission › Errors")
class _CreateRefusedUntilCleared(Robot):
    """CreateMission is refused until the list of ended missions was cleared."""

    def require_free(self) -> None:
        super().require_free()
        if self.missions:
            raise not_now("the list has to be cleared")


@bug("CreateMission › Errors")
class _CreateBusyAlreadyExists(Robot):
    """CreateMission on a busy robot is answered with ALREADY_EXISTS."""

    def require_free(self) -> None:
        try:
            super().require_free()
        except Refusal as refusal:
            raise Refusal("ALREADY_EXISTS", refusal.message) from None


@bug("CreateMission › Errors")
class _RefusedCreateIsQueued(Robot):
    """A CreateMission that is refused because the robot is busy leaves its mission in the queue."""

    def create_mission(self, request: Json) -> Commit:
        try:
            return super().create_mission(request)
        except Refusal as refusal:
            if refusal.status == "FAILED_PRECONDITION" and self.current is not None:
                self.take_in([self.read_mission_request(request)])
            raise


@bug("CreateMission › Errors")
class _RefusedCreateKeepsBusy(Robot):
    """After a malformed CreateMission the robot refuses the next one as if a mission ran."""

    claimed = False

    def create_mission(self, request: Json) -> Commit:
        if self.claimed:
            self.claimed = False
            raise not_now("another mission is being created")
        self.claimed = True
        commit = super().create_mission(request)
        self.claimed = False
        return commit


# the form of the request


@bug("CreateMission › Errors")
class _UnknownGoalNotFound(Robot):
    """A destination that the map does not have is answered with NOT_FOUND."""

    def read_goal(self, goal: object) -> Json:
        if isinstance(goal, dict) and isinstance(goal.get("destinationId"), str) and len(goal) == 1:
            if goal["destinationId"] and not self.on_map(goal["destinationId"]):
                raise Refusal("NOT_FOUND", "there is no such destination")
        return super().read_goal(goal)


@bug("CreateMission › Request")
class _MapNotConsulted(Robot):
    """Destinations are not compared with the map."""

    def on_map(self, destination: str) -> bool:
        return bool(destination)


@bug("CreateMission › Request")
class _MapOfTheFirstMinute(Robot):
    """Destinations are compared with the map as it was when the robot started."""

    def __init__(self, world: World) -> None:
        super().__init__(world)
        self.names = list(world.destinations)

    def on_map(self, destination: str) -> bool:
        return destination in self.names


@bug("CreateMission › Request")
class _DestinationByPrefix(Robot):
    """A text with which a display name begins passes for a destination."""

    def on_map(self, destination: str) -> bool:
        return bool(destination) and any(name.startswith(destination) for name in self.world.destinations)


@bug("CreateMission › Errors")
class _OnlyFirstGoalChecked(Robot):
    """Of several goals only the first has to be valid."""

    def read_goals(self, goals: object, kind: Kind) -> list[Json]:
        found = self.list_of(goals, "goals")
        return [self.read_goal(found[0]), *[goal for goal in found[1:] if isinstance(goal, dict)]]


@bug("CreateMission › Errors")
class _LastGoalUnchecked(Robot):
    """The last of several goals is not checked."""

    def read_goals(self, goals: object, kind: Kind) -> list[Json]:
        found = self.list_of(goals, "goals")
        if len(found) < 2 or not isinstance(found[-1], dict):
            return super().read_goals(goals, kind)
        return [*[self.read_goal(goal) for goal in found[:-1]], found[-1]]


@bug("CreateMission › Errors")
class _EmptyGoalAccepted(Robot):
    """A goal that is neither a destination nor a pose is accepted."""

    def read_goal(self, goal: object) -> Json:
        return {} if goal == {} else super().read_goal(goal)


@bug("CreateMission › Errors")
class _EmptyGoalListAccepted(Robot):
    """A mission with an empty list of goals is accepted."""

    def read_goals(self, goals: object, kind: Kind) -> list[Json]:
        return [] if goals in ([], None) and not kind.auto else super().read_goals(goals, kind)


@bug("CreateMission › Errors")
class _EmptyPatrolAccepted(Robot):
    """A patrol with an empty list of goals is accepted."""

    def read_goals(self, goals: object, kind: Kind) -> list[Json]:
        return [] if goals in ([], None) and kind.patrol else super().read_goals(goals, kind)

    def go_on(self, mission: Mission) -> None:
        if mission.goals:
            super().go_on(mission)


@bug("CreateMission › Errors")
class _EmptyRequestInternal(Robot):
    """A request without a mission is answered with INTERNAL."""

    def read_mission(self, mission: object) -> Plan:
        if not mission:
            raise Refusal("INTERNAL", "there is no mission")
        return super().read_mission(mission)


@bug("CreateMission › Errors")
class _EmptyRequestAccepted(Robot):
    """A request without a mission creates a navigation to the robot's own place."""

    def read_mission(self, mission: object) -> Plan:
        if not mission:
            here = {"pose": {"xMeters": 0.0, "yMeters": 0.0, "headingRadians": 0.0}}
            return Plan(Kind("base", "BASE_TYPE_NAVIGATE", single=True), [here])
        return super().read_mission(mission)


@bug("CreateMission › Request")
class _TwoFamiliesAccepted(Robot):
    """Of two mission wrappers that are set in one request the first is taken."""

    def one_of(self, message: object, members: Iterable[str], beside: tuple[str, ...] = ()) -> tuple[str, Any]:
        found = {name: value for name, value in self.fields(message, (*members, *beside)).items() if name not in beside}
        if beside and len(found) > 1:
            return next(iter(found.items()))
        return self.only_member(found)


@bug("CreateMission › Request")
class _TwoTypesAccepted(Robot):
    """Of two mission types that are set within one family the last is taken."""

    def one_of(self, message: object, members: Iterable[str], beside: tuple[str, ...] = ()) -> tuple[str, Any]:
        found = {name: value for name, value in self.fields(message, (*members, *beside)).items() if name not in beside}
        if not beside and len(found) > 1 and self.method == "CreateMission":
            return list(found.items())[-1]
        return self.only_member(found)


@bug("CreateMission › Errors")
class _NavigateTakesList(Robot):
    """A Navigate mission that has a list of goals in place of its goal is accepted and takes the first."""

    def read_body(self, kind: Kind, body: object) -> Plan:
        if kind.single and isinstance(body, dict) and isinstance(body.get("goals"), list) and body["goals"]:
            return Plan(kind, [self.read_goal(body["goals"][0])])
        return super().read_body(kind, body)


@bug("CreateMission › Errors")
class _AutoTakesSingleGoal(Robot):
    """A NavigateAuto mission that has a goal in place of its list is accepted."""

    def read_body(self, kind: Kind, body: object) -> Plan:
        if kind.auto and isinstance(body, dict) and list(body) == ["goal"]:
            return Plan(kind, [self.read_goal(body["goal"])])
        return super().read_body(kind, body)


# the family


@bug("CreateMission › Request")
class _BaseMissionRefusedOnServi(Robot):
    """A Servi takes no base missions."""

    def check_family(self, family: str) -> None:
        super().check_family("carti" if family == "base" and self.world.family == "servi" else family)


@bug("CreateMission › Request")
class _BaseMissionRefusedOnCarti(Robot):
    """A Carti takes no base missions."""

    def check_family(self, family: str) -> None:
        super().check_family("servi" if family == "base" and self.world.family == "carti" else family)


@bug("CreateMission › Request")
class _FamilyNotChecked(Robot):
    """Missions of every family are accepted."""

    def check_family(self, family: str) -> None:
        return


@bug("CreateMission › Request")
class _BaseUnitTakesServi(Robot):
    """A robot of the base family takes Servi missions."""

    def check_family(self, family: str) -> None:
        if self.world.family != "base" or family != "servi":
            super().check_family(family)


# NavigateAuto


@bug("CreateMission › NavigateAutoMission")
class _AutoTakesFirst(Robot):
    """NavigateAuto takes the first goal, occupied or not."""

    def is_free(self, goal: Json) -> bool:
        return True


@bug("CreateMission › NavigateAutoMission")
class _AutoTakesLastFree(Robot):
    """NavigateAuto takes the last free goal of its list."""

    def select_goal(self, mission: Mission) -> int | None:
        free = [index for index, goal in enumerate(mission.goals) if self.is_free(goal)]
        return free[-1] if free else None


@bug("CreateMission › NavigateAutoMission")
class _AutoTriesFirstTwo(Robot):
    """NavigateAuto gives up after the first two goals."""

    def select_goal(self, mission: Mission) -> int | None:
        found = super().select_goal(mission)
        return found if found is not None and found < 2 else None


@bug("CreateMission › NavigateAutoMission")
class _AutoOccupancyIsStale(Robot):
    """NavigateAuto goes by what was occupied when the robot started."""

    def __init__(self, world: World) -> None:
        super().__init__(world)
        self.held = list(world.occupied)

    def is_free(self, goal: Json) -> bool:
        return goal.get("destinationId") not in self.held


@bug("CreateMission › NavigateAutoMission")
class _QueuedAutoTakesFirst(Robot):
    """A NavigateAuto mission that had to wait in the queue takes its first goal, occupied or not."""

    def begin(self) -> None:
        mission = self.next_mission()
        super().begin()
        if mission is not None and mission is self.current and mission.kind.auto:
            mission.goal_index = 0


@bug("CreateMission › NavigateAutoMission")
class _BaseAutoTakesFirst(Robot):
    """A NavigateAuto mission of the base family takes its first goal, occupied or not."""

    def select_goal(self, mission: Mission) -> int | None:
        return 0 if mission.kind.member == "base" else super().select_goal(mission)
