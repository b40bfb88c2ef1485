"""The JSON of what is worth asking of a robot: missions of each kind, and commands."""

from __future__ import annotations

from missionfsm.kernel.codec import JSON

TABLES = ("table-1", "table-2", "table-3")
CANCEL, PAUSE, RESUME, FINISH = COMMANDS = ("COMMAND_CANCEL", "COMMAND_PAUSE", "COMMAND_RESUME", "COMMAND_FINISH")


def goals_at(*names: str) -> list[JSON]:
    """Goals at destinations."""
    return [{"destinationId": name} for name in names]


def base(goal: JSON) -> JSON:
    """A mission that any robot runs, to one goal."""
    return {"baseMission": {"navigateMission": {"goal": goal}}}


def auto(*names: str) -> JSON:
    """A mission to whichever of these is free."""
    return {"baseMission": {"navigateAutoMission": {"goals": goals_at(*names)}}}


def of_family(family: str, which: str, *names: str) -> JSON:
    """A mission of a kind that a family of robots runs."""
    return {f"{family}Mission": {which: {"goals": goals_at(*names)}}}
