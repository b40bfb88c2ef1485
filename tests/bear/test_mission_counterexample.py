"""A broken invariant is shown by a shortest way to a state that breaks it."""

from __future__ import annotations

from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.spec import Invariant
from missionfsm.systems import system
from missionfsm.tools.explore import explore


def test_a_broken_invariant_has_a_shortest_counterexample() -> None:
    """Two missions waiting behind a paused one take four steps, and exploration finds no longer way."""
    wrong = Invariant(
        "nothing-waits-behind-a-paused-mission",
        "Nothing waits behind a paused mission.",
        lambda robot: not (robot.active and robot.active.state.name == "STATE_PAUSED" and len(robot.pending) > 1),
    )
    found = explore(system("bear.mission"), Bounds(missions=3, goals=1, batch=1), invariants=(wrong,)).counterexample
    assert found is not None
    assert (found.invariant, len(found.path), found.state) == (
        "nothing-waits-behind-a-paused-mission",
        4,
        "[PAUSED at goal 0, WAITING, WAITING]",
    )


def test_a_true_invariant_has_none() -> None:
    """What always holds has no counterexample."""
    always = Invariant("bounded", "At most three missions are listed.", lambda robot: len(robot.listed) <= 3)
    assert explore(system("bear.mission"), Bounds(3, 1, 1), invariants=(always,)).counterexample is None
