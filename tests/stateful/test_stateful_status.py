"""The Robot Status page as a machine of plain rules against the fake fleet: see `status_machine`."""

from __future__ import annotations

import pytest
from machines import fails, holds
from status_broken import BROKEN
from status_machine import StatusMachine

from missionfsm import Fleet


def test_a_fleet_does_what_the_page_says() -> None:
    """Whatever is asked of a fleet and happens to it, it does what the Robot Status page says."""
    holds(StatusMachine, share=4)


@pytest.mark.parametrize("fleet", BROKEN, ids=lambda fleet: fleet.__name__)
def test_a_fleet_with_one_thing_wrong_is_found(fleet: type[Fleet]) -> None:
    """Each of some fleets that do one thing otherwise than the page says fails the machine."""
    fails(type("BrokenStatus", (StatusMachine,), {"make_fleet": fleet}))
