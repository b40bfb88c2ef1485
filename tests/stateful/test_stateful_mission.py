"""The Mission page as a machine of plain rules against the fake robot: a second opinion, apart from the model's rules.

The page's sections are in `mission_creating`, `mission_commanding` and `mission_watching`, in its order.
"""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import initialize, multiple
from machines import fails, holds
from mission_base import IDS
from mission_broken import BROKEN
from mission_commanding import Commanding
from mission_creating import Creating
from mission_model import World
from mission_requests import FAMILIES, MISSIONS, PLACES
from mission_watching import Watching

from missionfsm import Robot


class MissionMachine(Creating, Commanding, Watching):
    """Everything that can be asked of a robot, and everything that can happen to it."""

    @initialize(
        target=IDS,
        family=st.sampled_from([*FAMILIES, "servi", "carti"]),
        occupied=st.sampled_from([(), ("table-1",), PLACES]),
        contact_dock=st.sampled_from([True, True, False]),
        charging_location=st.sampled_from([True, True, False]),
        data=st.data(),
    )
    def a_robot(
        self,
        *,
        family: str,
        occupied: tuple[str, ...],
        contact_dock: bool,
        charging_location: bool,
        data: st.DataObject,
    ) -> Any:
        """A robot on which no mission has been run: SubscribeMissionStatus › State enum › STATE_DEFAULT.

        Nearly all that follows is about a robot with missions, so it is given some.
        """
        self.robot = self.make_robot(
            family=family,
            destinations=PLACES,
            occupied=occupied,
            contact_dock=contact_dock,
            charging_location=charging_location,
        )
        self.world = World(family, PLACES, occupied, contact_dock, charging_location, blocked=False)
        self.missions = []
        self.cleared = set()
        self.fault = None
        self.subscriptions = []
        self.seldom = 0
        self.becomes([])
        self.clear_nothing()
        missions = data.draw(st.lists(MISSIONS[family], max_size=3))
        return self.create_batch("CreateMissionBatch", missions) if missions else multiple()


def test_a_robot_does_what_the_page_says() -> None:
    """Whatever is asked of a robot and happens to it, it does what the Mission page says."""
    holds(MissionMachine, share=4)


@pytest.mark.parametrize("robot", BROKEN, ids=lambda robot: robot.__name__)
def test_a_robot_with_one_thing_wrong_is_found(robot: type[Robot]) -> None:
    """Each of some robots that do one thing otherwise than the page says fails the machine."""
    fails(type("BrokenMission", (MissionMachine,), {"make_robot": robot}))
