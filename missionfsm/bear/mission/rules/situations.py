"""Situations of the robot that rules of several calls name."""

from __future__ import annotations

import functools
from collections.abc import Mapping

from missionfsm.bear.mission.inputs import Call
from missionfsm.bear.mission.readings.scope import BLOCKED, GAP, HALTED
from missionfsm.bear.mission.rules.aspects import STATE
from missionfsm.bear.mission.state import MISSION, Situation
from missionfsm.bear.wire.messages import State
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import FAILED_PRECONDITION, Rule


def is_paused(robot: Situation) -> bool:
    """Whether the active mission is paused."""
    return robot.active is not None and robot.active.state is State.STATE_PAUSED


def nothing_listed(robot: Situation) -> bool:
    """Whether the robot lists no mission, be it active, waiting or ended."""
    return robot.active is None and not robot.queued and not robot.ended


def waiting(robot: Situation) -> str:
    """Why missions wait where none is active: a part of AM-07, AM-34 and AM-37."""
    return HALTED if robot.halted else BLOCKED if robot.world.blocked else GAP


def _waits(where: str, robot: Situation, _: Call) -> bool:
    """Whether missions wait and none is active, in this of the situations in which that can be so."""
    return robot.active is None and robot.queued and waiting(robot) == where


def about_waiting(
    operation: str, under: Mapping[str, Assumption], *rules: tuple[str, str, str], code: str = FAILED_PRECONDITION
) -> tuple[Rule, ...]:
    """Refusals because missions wait and none is active, one for each situation in which that can be so.

    Args:
        operation: the call that is refused.
        under: the reading of each situation that makes it refuse.
        rules: of each refusal its situation, its name, and what it says.
        code: the code of all of them.
    """
    return tuple(
        Rule(
            name,
            says,
            "",
            MISSION[operation, "Errors"] if operation != "ClearMissionStatus" else MISSION[operation],
            code,
            functools.partial(_waits, where),
            under[where],
            STATE,
        )
        for where, name, says in rules
    )
