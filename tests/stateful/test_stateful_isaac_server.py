"""The mission server of the Mission Submission page as a machine of plain rules: see `isaac_server_machine`."""

from __future__ import annotations

import pytest
from isaac_server_broken import BROKEN
from isaac_server_machine import ServerMachine
from machines import fails, holds

from missionfsm.isaac.runtime.server import MissionServerCore


def test_a_server_does_what_the_page_says() -> None:
    """Whatever is submitted to a server and whatever robots say, it does what the Mission Submission page says."""
    holds(ServerMachine, share=3)


@pytest.mark.parametrize("server", BROKEN, ids=lambda server: server.__name__)
def test_a_server_with_one_thing_wrong_is_found(server: type[MissionServerCore]) -> None:
    """Each of some servers that do one thing otherwise than the page says fails the machine."""
    fails(type("BrokenServer", (ServerMachine,), {"make_server": server}))
