"""Missions to send a robot on, as typed messages: ``navigate("table-1")``, ``delivery("table-1", "table-2")``.

A place is the display name of a destination on the robot's map, or a `Pose`. The names are those of the Mission page;
`missionfsm.fakes.workflows` has the presets. Nothing is checked here: that is what the robot is for.
"""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.bear.mission.state import Family
from missionfsm.bear.wire.messages import (
    BaseMission,
    CartiMission,
    DeliveryMission,
    DeliveryParams,
    Goal,
    GoalsMission,
    ManyGoals,
    Mission,
    OneGoal,
    Pose,
    ServiMission,
    TrayMapping,
)

Place = str | Pose | Goal
"""Where to go: a display name on the map, a pose on it, or a goal message."""


def goal(place: Place) -> Goal:
    """The goal message of a place."""
    if isinstance(place, Goal):
        return place
    return Goal(pose=place) if isinstance(place, Pose) else Goal(destination_id=place)


def goals(places: tuple[Place, ...]) -> tuple[Goal, ...]:
    """The goal messages of places."""
    return tuple(goal(place) for place in places)


def navigate(place: Place, *, family: Family | str = Family.BASE) -> Mission:
    """Go to one place. The mission is the base one, which every family has, or that of a `family`."""
    inner = OneGoal(goal(place))
    match Family(family):
        case Family.SERVI:
            return Mission(servi_mission=ServiMission(navigate_mission=inner))
        case Family.CARTI:
            return Mission(carti_mission=CartiMission(navigate_mission=inner))
        case Family.BASE:
            return Mission(base_mission=BaseMission(navigate_mission=inner))


def navigate_auto(*places: Place, family: Family | str = Family.BASE) -> Mission:
    """Go to the first of these places that nobody occupies or claims."""
    inner = ManyGoals(goals(places))
    match Family(family):
        case Family.SERVI:
            return Mission(servi_mission=ServiMission(navigate_auto_mission=inner))
        case Family.CARTI:
            return Mission(carti_mission=CartiMission(navigate_auto_mission=inner))
        case Family.BASE:
            return Mission(base_mission=BaseMission(navigate_auto_mission=inner))


def delivery(*places: Place, trays: Mapping[str, Place] | None = None) -> Mission:
    """Servi: go to these places in order, stopping at each; `trays` says which tray is for which place."""
    mappings = tuple(TrayMapping(name, goal(place)) for name, place in (trays or {}).items())
    params = DeliveryParams(mappings) if mappings else None
    return Mission(servi_mission=ServiMission(delivery_mission=DeliveryMission(goals(places), params)))


def delivery_patrol(*places: Place) -> Mission:
    """Servi: go round these places until everything is delivered."""
    return Mission(servi_mission=ServiMission(delivery_patrol_mission=GoalsMission(goals(places))))


def bussing(*places: Place) -> Mission:
    """Servi: go to these places in order and collect."""
    return Mission(servi_mission=ServiMission(bussing_mission=GoalsMission(goals(places))))


def bussing_patrol(*places: Place) -> Mission:
    """Servi: go round these places until enough is collected."""
    return Mission(servi_mission=ServiMission(bussing_patrol_mission=GoalsMission(goals(places))))


def traverse(*places: Place) -> Mission:
    """Carti: go to these places in order."""
    return Mission(carti_mission=CartiMission(traverse_mission=GoalsMission(goals(places))))


def traverse_patrol(*places: Place) -> Mission:
    """Carti: go round these places."""
    return Mission(carti_mission=CartiMission(traverse_patrol_mission=GoalsMission(goals(places))))
