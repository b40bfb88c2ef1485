"""The robot's side of the Mission Submission page as a machine of plain rules: see `isaac_robot_machine`."""

from __future__ import annotations

import pytest
from isaac_robot_broken import BROKEN
from isaac_robot_machine import RobotMachine
from machines import fails, holds

from missionfsm.isaac.runtime.robot import RobotCore


def test_a_robot_does_what_the_page_says() -> None:
    """Whatever a robot is sent and however its missions go, it does what the Mission Submission page says."""
    holds(RobotMachine, share=3)


@pytest.mark.parametrize("robot", BROKEN, ids=lambda robot: robot.__name__)
def test_a_robot_with_one_thing_wrong_is_found(robot: type[RobotCore]) -> None:
    """Each of some robots that do one thing otherwise than the page says fails the machine."""
    fails(type("BrokenRobot", (RobotMachine,), {"make_robot": robot}))
