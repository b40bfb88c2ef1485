"""The calls of the mission service, and what the surroundings can do to the robot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from errors import Refusal, invalid, not_found, not_now
from missions import MissionQueue
from model import Json, Kind, Mission, Plan, State
from reader import RequestReader

T = TypeVar("T")
Commit = Callable[[], Json]

UNARY_CALLS = {
    "CreateMission": "create_mission",
    "CreateMissionBatch": "create_mission_batch",
    "CreateMissionWorkflow": "create_mission_workflow",
    "AppendMission": "append_mission",
    "AppendMissionBatch": "append_mission_batch",
    "ChargeRobot": "charge_robot",
    "ClearMissionStatus": "clear_mission_status",
    "SkipGoal": "skip_goal",
    "UpdateMission": "update_mission",
}
NO_DEADLINE = ("ClearMissionStatus", "SkipGoal")


@dataclass(frozen=True)
class Fault:
    """A failure that waits for the next call that would have succeeded."""

    status: str
    applied: bool

    def concerns(self, method: str) -> bool:
        """Whether the call documents the status."""
        return self.status == "INTERNAL" or method not in NO_DEADLINE


class Robot(RequestReader, MissionQueue):
    """A robot that takes missions."""

    fault: Fault | None = None

    def call(self, method: str, request: Json) -> Json:
        """Answer a unary call, or raise its refusal. Nothing is changed before all checks are passed."""
        self.method = method
        commit: Commit = getattr(self, UNARY_CALLS[method])(request)
        fault = self.fault
        if fault is None or not fault.concerns(method):
            return commit()
        self.fault = None
        self.fail(fault, commit)
        raise Refusal(fault.status, "the mission system failed")

    def fail(self, fault: Fault, commit: Commit) -> None:
        """Let a failing call have its effect, or not."""
        if fault.applied:
            commit()

    def checked(self, read: Callable[[], T], state: Callable[[], None]) -> T:
        """Check the request and the robot's state, in the order of this robot."""
        if self.state_first():
            state()
            return read()
        value = read()
        state()
        return value

    def state_first(self) -> bool:
        """Whether the robot's state is looked at before the request."""
        return False

    # CreateMission and its relatives

    def require_free(self) -> None:
        """No mission may be running, paused or queued."""
        if self.current is not None or self.queued():
            raise not_now("a mission runs or waits already")
        self.require_able()

    def require_able(self) -> None:
        """The robot has to be able to start a mission."""
        if self.world.blocked:
            raise not_now("the robot cannot start missions now")

    def create_mission(self, request: Json) -> Commit:
        """Create one mission."""
        plan = self.checked(lambda: self.read_mission_request(request), self.require_free)
        return lambda: {"missionId": self.create([plan])[0]}

    def create_mission_batch(self, request: Json) -> Commit:
        """Create several missions, or none."""
        plans = self.checked(lambda: self.read_batch(request), self.require_free)
        return lambda: {"missionIds": self.create(plans)}

    def require_workflow(self) -> None:
        """No mission may be running or paused."""
        if self.current is not None:
            raise not_now("another mission is running")
        self.require_able()

    def create_mission_workflow(self, request: Json) -> Commit:
        """Create the missions of a preset."""
        plans = self.checked(lambda: self.read_workflow(request), self.require_workflow)
        return lambda: {"missionIds": self.create(plans)}

    # AppendMission and its relative

    def require_queue(self) -> None:
        """There has to be a mission to queue behind."""
        if self.current is None and not self.queued():
            raise not_now("nothing runs or waits that one could queue behind")

    def append_mission(self, request: Json) -> Commit:
        """Append one mission."""
        plan = self.checked(lambda: self.read_mission_request(request), self.require_queue)
        return lambda: {"missionId": self.append([plan])[0]}

    def append_mission_batch(self, request: Json) -> Commit:
        """Append several missions, or none."""
        plans = self.checked(lambda: self.read_batch(request), self.require_queue)
        return lambda: {"missionIds": self.append(plans)}

    # ChargeRobot

    def charge_checks(self) -> list[Callable[[], None]]:
        """What has to hold before the robot charges, in the order in which it is looked at."""
        return [self.require_idle, self.require_dock, self.require_charger]

    def require_idle(self) -> None:
        """No mission may be running or paused."""
        if self.current is not None:
            raise not_now("a mission is running")
        self.require_able()

    def require_dock(self) -> None:
        """The robot has to have a contact dock."""
        if not self.world.contact_dock:
            raise not_now("this robot has no contact dock")

    def require_charger(self) -> None:
        """The map has to have a charging location."""
        if not self.world.charging_location:
            raise not_found("the map has no charging location")

    def charge_plan(self) -> Plan:
        """The mission that a charge is."""
        return Plan(Kind(self.world.family, "", charge=True), [])

    def charge_robot(self, request: Json) -> Commit:
        """Send the robot to its charger."""
        for check in self.charge_checks():
            check()
        return lambda: {"missionId": self.create([self.charge_plan()])[0]}

    # ClearMissionStatus and SkipGoal

    def require_nothing_active(self) -> None:
        """No mission may be running or paused."""
        if self.current is not None:
            raise not_now("a mission is running or paused")

    def clear_mission_status(self, request: Json) -> Commit:
        """Forget the missions."""
        self.checked(lambda: self.read_nothing(request), self.require_nothing_active)
        return lambda: {"missionIds": self.clear()}

    def skip_target(self) -> Mission:
        """The running mission, whose goal is to be skipped."""
        if self.current is None or self.current.state is not State.RUNNING:
            raise not_now("no mission is running")
        if self.current.kind.charge:
            raise not_now("a charge has no goals")
        return self.current

    def skip_goal(self, request: Json) -> Commit:
        """Skip the current goal."""
        mission = self.skip_target()

        def commit() -> Json:
            self.skip(mission)
            self.changed()
            return {"missionId": mission.mission_id}

        return commit

    def skip(self, mission: Mission) -> None:
        """Leave the current goal out."""
        self.go_on(mission)

    # UpdateMission

    def update_mission(self, request: Json) -> Commit:
        """Command the active mission."""
        mission_id, command = self.read_command(request)
        mission = self.update_target(mission_id)
        self.require_fitting(mission, command)

        def commit() -> Json:
            self.command(mission, command)
            self.changed()
            return {}

        return commit

    def update_target(self, mission_id: str) -> Mission:
        """The active mission, if that is the one that is named."""
        named = self.find(mission_id)
        if named is not None and named.ended:
            raise self.ended_named()
        if named is not None and named is not self.current:
            raise self.queued_named()
        if self.current is None:
            raise self.none_active()
        if named is None:
            raise self.unknown_named()
        return named

    def ended_named(self) -> Refusal:
        """The refusal for a mission that has ended."""
        return not_now("the mission has ended")

    def none_active(self) -> Refusal:
        """The refusal where no mission is active."""
        return not_now("no mission is active")

    def unknown_named(self) -> Refusal:
        """The refusal for an id that no mission has."""
        return invalid("there is no mission with that id")

    def queued_named(self) -> Refusal:
        """The refusal for a mission that waits."""
        return not_found("the mission is not the active one")

    def require_fitting(self, mission: Mission, command: str) -> None:
        """The command has to suit the state of the mission."""
        needed = {"COMMAND_PAUSE": State.RUNNING, "COMMAND_RESUME": State.PAUSED}.get(command, mission.state)
        if mission.state is not needed:
            raise not_now("the command does not suit the state of the mission")

    def command(self, mission: Mission, command: str) -> None:
        """Carry a command out."""
        if command == "COMMAND_PAUSE":
            self.pause(mission)
        elif command == "COMMAND_RESUME":
            self.resume(mission)
        elif command == "COMMAND_CANCEL":
            self.end(mission, State.CANCELED)
        else:
            self.end(mission, State.SUCCEEDED)

    def pause(self, mission: Mission) -> None:
        """Pause the mission."""
        mission.state = State.PAUSED

    def resume(self, mission: Mission) -> None:
        """Let the mission go on where it was."""
        mission.state = State.RUNNING

    # SubscribeMissionStatus

    def subscribe(self, request: Json, stream: int) -> None:
        """Open a stream, or raise the refusal."""
        self.method = "SubscribeMissionStatus"
        self.read_nothing(request)
        self.open_stream(stream)

    # what the surroundings do

    def goal_reached(self) -> bool:
        """The running mission is done with its goal."""
        mission = self.current
        if mission is None or mission.state is not State.RUNNING or mission.kind.charge:
            return False
        self.reach(mission)
        self.changed()
        return True

    def reach(self, mission: Mission) -> None:
        """The mission has arrived at its goal and is done there."""
        self.go_on(mission)

    def mission_succeeded(self) -> bool:
        """The running mission ends well."""
        mission = self.current
        if mission is None or mission.state is not State.RUNNING:
            return False
        self.end(mission, State.SUCCEEDED)
        self.changed()
        return True

    def mission_failed(self) -> bool:
        """The active mission ends in failure."""
        mission = self.current
        if mission is None:
            return False
        self.end(mission, State.FAILED)
        self.changed()
        return True

    def world_changed(self, fields: Json) -> None:
        """The world is another one; ValueError where the members are wrong."""
        self.world.change(fields)
        self.look_around()
        self.changed()

    def look_around(self) -> None:
        """React to a world that has changed: missions go on as they were."""
