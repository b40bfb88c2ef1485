"""Reading of requests: what is malformed is refused here, before anything else looks at it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import Any

from errors import invalid
from model import COMMANDS, MISSION_KINDS, WORKFLOW_KINDS, Json, Kind, Plan, RobotData

LARGEST_FLOAT = 3.4028235e38


def snake(name: str) -> str:
    """The field's own name for a lowerCamelCase one."""
    return re.sub(r"[A-Z]", lambda match: "_" + match.group().lower(), name)


class RequestReader(RobotData):
    """Turns request messages into plans and commands."""

    def fields(self, message: object, known: Iterable[str]) -> Json:
        """The members of a message by their lowerCamelCase names, without those that are null."""
        if not isinstance(message, dict):
            raise invalid("a message has to be an object")
        names = {form: name for name in known for form in (name, snake(name))}
        found: Json = {}
        for given, value in message.items():
            if value is None:
                continue
            if given not in names:
                self.unknown_field(given)
            elif names[given] in found:
                raise invalid(f"{given} is given twice")
            else:
                found[names[given]] = value
        return found

    def unknown_field(self, name: str) -> None:
        """Judge a field that the message does not have."""
        raise invalid(f"there is no field {name}")

    def one_of(self, message: object, members: Iterable[str], beside: tuple[str, ...] = ()) -> tuple[str, Any]:
        """The one member of a oneof that is set, and its value."""
        found = {name: value for name, value in self.fields(message, (*members, *beside)).items() if name not in beside}
        return self.only_member(found)

    def only_member(self, found: Json) -> tuple[str, Any]:
        """Insist on exactly one member."""
        if len(found) != 1:
            raise invalid("exactly one of the types has to be set")
        return next(iter(found.items()))

    def list_of(self, value: object, what: str) -> list[Any]:
        """Insist on a list that is not empty."""
        if not isinstance(value, list) or not value:
            raise invalid(f"{what} has to be a list that is not empty")
        return value

    # goals

    def read_goal(self, goal: object) -> Json:
        """One goal: a destination on the map, or a pose."""
        name, value = self.only_member(self.fields(goal, ("destinationId", "pose")))
        if name == "pose":
            return {"pose": self.read_pose(value)}
        if not isinstance(value, str) or not self.on_map(value):
            raise invalid("the destination is not on the map")
        return {"destinationId": value}

    def on_map(self, destination: str) -> bool:
        """Whether the map has a destination with that display name."""
        return destination in self.world.destinations

    def read_pose(self, pose: object) -> Json:
        """A pose; what is left out is zero."""
        found = self.fields(pose, ("xMeters", "yMeters", "headingRadians"))
        return {name: self.read_number(found.get(name, 0.0)) for name in ("xMeters", "yMeters", "headingRadians")}

    def read_number(self, value: object) -> float:
        """A finite number, also as text."""
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            raise invalid("a coordinate has to be a number")
        try:
            number = float(value)
        except (ValueError, OverflowError):
            raise invalid("a coordinate has to be a number") from None
        if not math.isfinite(number) or abs(number) > LARGEST_FLOAT:
            raise invalid("a coordinate has to be finite, in 32 bits")
        return number

    def read_goals(self, goals: object, kind: Kind) -> list[Json]:
        """The goals of a mission of that kind."""
        return [self.read_goal(goal) for goal in self.list_of(goals, "goals")]

    def read_goal_fields(self, body: object, kind: Kind, beside: tuple[str, ...]) -> tuple[list[Json], Json]:
        """The goals of a mission or workflow, and the other fields that it has."""
        found = self.fields(body, ("goal" if kind.single else "goals", *beside))
        goals = [self.read_goal(found.get("goal"))] if kind.single else self.read_goals(found.get("goals"), kind)
        return goals, found

    # missions

    def read_mission_request(self, request: object) -> Plan:
        """A CreateMissionRequest or an AppendMissionRequest."""
        return self.read_mission(self.fields(request, ("mission",)).get("mission"))

    def read_mission(self, mission: object) -> Plan:
        """The wrapper of all mission types."""
        families = [f"{family}Mission" for family in MISSION_KINDS]
        wrapper, inner = self.one_of(mission, families, beside=("extension",))
        family = wrapper.removesuffix("Mission")
        self.check_family(family)
        name, body = self.one_of(inner, MISSION_KINDS[family])
        return self.read_body(MISSION_KINDS[family][name], body)

    def check_family(self, family: str) -> None:
        """Base missions suit every robot, the others their own family alone."""
        if family not in ("base", self.world.family):
            raise invalid(f"this robot takes no {family} missions")

    def read_body(self, kind: Kind, body: object) -> Plan:
        """The goals and parameters of one mission."""
        beside = () if kind.single or kind.auto else ("params",)
        goals, found = self.read_goal_fields(body, kind, beside)
        self.read_params(kind, found.get("params", {}), goals)
        return Plan(kind, goals)

    def read_params(self, kind: Kind, params: object, goals: list[Json]) -> None:
        """Parameters: a delivery may map trays to goals, the others have none."""
        delivery = kind.type_name == "SERVI_TYPE_SERVING"
        found = self.fields(params, ("trayMappings",) if delivery else ())
        mappings = found.get("trayMappings", [])
        if not isinstance(mappings, list):
            raise invalid("trayMappings has to be a list")
        for mapping in mappings:
            self.read_tray_mapping(mapping, goals)

    def read_tray_mapping(self, mapping: object, goals: list[Json]) -> None:
        """One tray and the goal that its load is for."""
        found = self.fields(mapping, ("trayName", "goal"))
        if not isinstance(found.get("trayName", ""), str):
            raise invalid("the name of a tray has to be text")
        self.read_goal(found.get("goal"))

    def read_batch(self, request: object) -> list[Plan]:
        """A batch: every entry wraps a mission."""
        entries = self.list_of(self.fields(request, ("missions",)).get("missions"), "missions")
        return self.read_entries(entries)

    def read_entries(self, entries: list[Any]) -> list[Plan]:
        """All entries of a batch; one that is malformed spoils it."""
        return [self.read_mission_request(entry) for entry in entries]

    # workflows

    def read_workflow(self, request: object) -> list[Plan]:
        """A preset workflow, as the missions that it stands for."""
        workflow = self.fields(request, ("missionWorkflow",)).get("missionWorkflow")
        wrapper, inner = self.one_of(workflow, [f"{family}Workflow" for family in WORKFLOW_KINDS])
        family = wrapper.removesuffix("Workflow")
        self.check_workflow_family(family)
        name, body = self.one_of(inner, WORKFLOW_KINDS[family])
        return self.plan_workflow(name, WORKFLOW_KINDS[family][name], body)

    def check_workflow_family(self, family: str) -> None:
        """A workflow suits its own family alone."""
        if family != self.world.family:
            raise invalid(f"this robot has no {family} workflows")

    def plan_workflow(self, name: str, kind: Kind, body: object) -> list[Plan]:
        """The missions that a workflow creates."""
        goals, _ = self.read_goal_fields(body, kind, ())
        return [Plan(kind, goals)]

    # commands

    def read_command(self, request: object) -> tuple[str, str]:
        """The id and the command of an UpdateMissionRequest."""
        message = self.fields(request, ("missionCommand",)).get("missionCommand")
        found = self.fields(message, ("missionId", "command"))
        return self.read_mission_id(found.get("missionId")), self.read_command_name(found.get("command", 0))

    def read_mission_id(self, value: object) -> str:
        """An id that is there."""
        if not isinstance(value, str) or not value:
            raise invalid("the id of the mission is required")
        return value

    def read_command_name(self, value: object) -> str:
        """A command that is set, by name or by number."""
        name = value
        if isinstance(value, int) and not isinstance(value, bool) and 0 <= value < len(COMMANDS):
            name = COMMANDS[value]
        if not isinstance(name, str) or name not in COMMANDS[1:]:
            raise invalid("there is no such command")
        return name

    def read_nothing(self, request: object) -> None:
        """A request without fields."""
        self.fields(request, ())
