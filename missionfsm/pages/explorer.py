"""A system to click through: every state within bounds, what can be done there, what comes of it and why."""

from __future__ import annotations

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.system import System
from missionfsm.pages.graph import Graph
from missionfsm.pages.render import rendered
from missionfsm.tools.check.narrate import as_pytest

STAND_IN = "the history"
"""Where the page puts a history into the text of a test."""


def explorer_page(system: System, bounds: Bounds, assumed: int, made: str = "") -> str:
    """The page to click through a system with.

    Args:
        assumed: the readings that are possible (see `missionfsm.kernel.readings`).
        made: when, by which version and by which command the page is made.
    """
    graph = Graph(system, bounds, assumed).data()
    steps = sum(len(moves) // 3 for _, _, moves in graph["states"])
    test = as_pytest((STAND_IN,), "the_conversation_is_explained")
    return rendered(
        "explorer.html",
        spec=system.spec,
        bounds=bounds,
        states=len(graph["states"]),
        steps=steps,
        whole=graph["whole"],
        graph={**graph, "test": test, "standIn": STAND_IN},
        made=made,
    )
