"""A system to click through: every state within bounds, what can be done there, what comes of it and why."""

from __future__ import annotations

from missionfsm.kernel.system import System
from missionfsm.pages.graph import Graph
from missionfsm.pages.render import rendered
from missionfsm.tools.check.narrate import as_pytest
from missionfsm.tools.explore.explore import Exploration

STAND_IN = "the history"
"""Where the page puts a history into the text of a test."""


def explorer_page(system: System, explored: Exploration, assumed: int, made: str = "") -> str:
    """The page to click through a system with.

    Args:
        explored: what exploring the system came to; the page tells its numbers and keeps to its bounds.
        assumed: the readings that are possible (see `missionfsm.kernel.readings`).
        made: when, by which version and by which command the page is made.
    """
    graph = Graph(system, explored.bounds, assumed).data()
    test = as_pytest((STAND_IN,), "the_conversation_is_explained")
    return rendered(
        "explorer.html",
        spec=system.spec,
        bounds=explored.bounds,
        explored=explored,
        held=graph["held"],
        graph={**graph, "test": test, "standIn": STAND_IN},
        made=made,
    )
