"""What the robot keeps: its world, its missions, and the kinds of mission that there are."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Any

Json = dict[str, Any]


class State(Enum):
    """The lifecycle states of a mission, by their wire names."""

    UNKNOWN = "STATE_UNKNOWN"
    DEFAULT = "STATE_DEFAULT"
    RUNNING = "STATE_RUNNING"
    PAUSED = "STATE_PAUSED"
    CANCELED = "STATE_CANCELED"
    SUCCEEDED = "STATE_SUCCEEDED"
    FAILED = "STATE_FAILED"


ENDED = (State.CANCELED, State.SUCCEEDED, State.FAILED)
ACTIVE = (State.RUNNING, State.PAUSED)


@dataclass(frozen=True)
class Kind:
    """A kind of mission: whose it is, how it is called on the wire, and how it treats its goals."""

    member: str
    type_name: str
    patrol: bool = False
    auto: bool = False
    charge: bool = False
    single: bool = False


MISSION_KINDS: dict[str, dict[str, Kind]] = {
    "base": {
        "navigateMission": Kind("base", "BASE_TYPE_NAVIGATE", single=True),
        "navigateAutoMission": Kind("base", "BASE_TYPE_NAVIGATE_AUTO", auto=True),
    },
    "servi": {
        "deliveryMission": Kind("servi", "SERVI_TYPE_SERVING"),
        "bussingMission": Kind("servi", "SERVI_TYPE_BUSSING"),
        "deliveryPatrolMission": Kind("servi", "SERVI_TYPE_SERVING_PATROL", patrol=True),
        "bussingPatrolMission": Kind("servi", "SERVI_TYPE_BUSSING_PATROL", patrol=True),
        "navigateMission": Kind("servi", "SERVI_TYPE_NAVIGATE", single=True),
        "navigateAutoMission": Kind("servi", "SERVI_TYPE_NAVIGATE_AUTO", auto=True),
    },
    "carti": {
        "traverseMission": Kind("carti", "CARTI_TYPE_TRAVERSE"),
        "traversePatrolMission": Kind("carti", "CARTI_TYPE_TRAVERSE_PATROL", patrol=True),
        "navigateMission": Kind("carti", "CARTI_TYPE_NAVIGATE", single=True),
        "navigateAutoMission": Kind("carti", "CARTI_TYPE_NAVIGATE_AUTO", auto=True),
    },
}

WORKFLOW_KINDS: dict[str, dict[str, Kind]] = {
    "servi": {
        "delivery": Kind("servi", "SERVI_TYPE_SERVING"),
        "deliveryPatrol": Kind("servi", "SERVI_TYPE_SERVING_PATROL", patrol=True),
        "bussing": Kind("servi", "SERVI_TYPE_BUSSING"),
        "bussingPatrol": Kind("servi", "SERVI_TYPE_BUSSING_PATROL", patrol=True),
        "birthday": Kind("servi", "SERVI_TYPE_UNKNOWN", single=True),
        "hosting": Kind("servi", "SERVI_TYPE_UNKNOWN"),
        "hostingPatrol": Kind("servi", "SERVI_TYPE_UNKNOWN", patrol=True),
    },
    "carti": {
        "traverse": Kind("carti", "CARTI_TYPE_TRAVERSE"),
        "traversePatrol": Kind("carti", "CARTI_TYPE_TRAVERSE_PATROL", patrol=True),
    },
}

COMMANDS = ("COMMAND_UNKNOWN", "COMMAND_CANCEL", "COMMAND_PAUSE", "COMMAND_RESUME", "COMMAND_FINISH")


@dataclass(frozen=True)
class Plan:
    """What a request asks for: a kind of mission and its goals."""

    kind: Kind
    goals: list[Json]


@dataclass
class Mission:
    """A mission that was accepted."""

    mission_id: str
    kind: Kind
    goals: list[Json]
    state: State = State.DEFAULT
    goal_index: int = 0
    feedback: str = ""
    owner: str = "api"

    @property
    def ended(self) -> bool:
        """Whether the mission is in a terminal state."""
        return self.state in ENDED

    @property
    def on_last_goal(self) -> bool:
        """Whether no goal follows the current one."""
        return self.goal_index + 1 >= len(self.goals)


@dataclass
class World:
    """What surrounds the robot, as far as missions depend on it."""

    family: str = "servi"
    contact_dock: bool = True
    charging_location: bool = True
    destinations: list[str] = field(default_factory=lambda: ["table-1", "table-2", "table-3"])
    occupied: list[str] = field(default_factory=list)
    blocked: bool = False

    def change(self, fields: Json) -> None:
        """Take over the members that are given; a wrong type is a ValueError and changes nothing."""
        known: dict[str, tuple[str, type]] = {
            "family": ("family", str),
            "contactDock": ("contact_dock", bool),
            "chargingLocation": ("charging_location", bool),
            "destinations": ("destinations", list),
            "occupied": ("occupied", list),
            "blocked": ("blocked", bool),
        }
        given = {name: value for name, value in fields.items() if value is not None}
        for name, value in given.items():
            if name not in known or not isinstance(value, known[name][1]):
                raise ValueError(f"the world has no such {name}")
        if given.get("family", self.family) not in MISSION_KINDS:
            raise ValueError("the family is base, servi or carti")
        for name, value in given.items():
            setattr(self, known[name][0], list(value) if isinstance(value, list) else value)


class RobotData:
    """The data that every part of the robot works on."""

    def __init__(self, world: World) -> None:
        """Begin in that world without a mission."""
        self.world = world
        self.method = ""
        self.missions: list[Mission] = []
        self.current: Mission | None = None

    def queued(self) -> list[Mission]:
        """The missions that wait for their turn, first one first."""
        return [mission for mission in self.missions if mission.state is State.DEFAULT]

    def find(self, mission_id: str) -> Mission | None:
        """The listed mission with that id."""
        for mission in self.missions:
            if mission.mission_id == mission_id:
                return mission
        return None
