"""Preset workflows as typed messages, as on a robot's touchscreen: ``workflows.birthday("table-1")``.

A place is what it is in `missionfsm.fakes.missions`.
"""

from __future__ import annotations

from missionfsm.bear.wire.messages import CartiWorkflow, ManyGoals, MissionWorkflow, OneGoal, ServiWorkflow
from missionfsm.fakes.missions import Place, goal, goals


def delivery(*places: Place) -> MissionWorkflow:
    """Servi: deliver to these places."""
    return MissionWorkflow(servi_workflow=ServiWorkflow(delivery=ManyGoals(goals(places))))


def delivery_patrol(*places: Place) -> MissionWorkflow:
    """Servi: deliver going round these places."""
    return MissionWorkflow(servi_workflow=ServiWorkflow(delivery_patrol=ManyGoals(goals(places))))


def bussing(*places: Place) -> MissionWorkflow:
    """Servi: collect from these places."""
    return MissionWorkflow(servi_workflow=ServiWorkflow(bussing=ManyGoals(goals(places))))


def bussing_patrol(*places: Place) -> MissionWorkflow:
    """Servi: collect going round these places."""
    return MissionWorkflow(servi_workflow=ServiWorkflow(bussing_patrol=ManyGoals(goals(places))))


def birthday(place: Place) -> MissionWorkflow:
    """Servi: celebrate at one place."""
    return MissionWorkflow(servi_workflow=ServiWorkflow(birthday=OneGoal(goal(place))))


def hosting(*places: Place) -> MissionWorkflow:
    """Servi: lead guests to these places."""
    return MissionWorkflow(servi_workflow=ServiWorkflow(hosting=ManyGoals(goals(places))))


def hosting_patrol(*places: Place) -> MissionWorkflow:
    """Servi: host going round these places."""
    return MissionWorkflow(servi_workflow=ServiWorkflow(hosting_patrol=ManyGoals(goals(places))))


def traverse(*places: Place) -> MissionWorkflow:
    """Carti: go to these places in order."""
    return MissionWorkflow(carti_workflow=CartiWorkflow(traverse=ManyGoals(goals(places))))


def traverse_patrol(*places: Place) -> MissionWorkflow:
    """Carti: go round these places."""
    return MissionWorkflow(carti_workflow=CartiWorkflow(traverse_patrol=ManyGoals(goals(places))))
