"""What some state has to come to, of each of several values."""

from __future__ import annotations

from enum import Enum

from missionfsm.kernel.possibilities import each_met


class Light(Enum):
    DIM = 1
    FULL = 2


def test_each_value_has_a_possibility_of_its_own() -> None:
    """A possibility is named after its value and met by a state that has it, among others or alone."""
    found = each_met(Light, iter, "a-light-is-{}", "Some light is {}.")
    assert [(one.name, one.says) for one in found] == [
        ("a-light-is-dim", "Some light is DIM."),
        ("a-light-is-full", "Some light is FULL."),
    ]
    states = ((), (Light.DIM,), (Light.DIM, Light.FULL))
    assert [[one.holds(state) for one in found] for state in states] == [[False, False], [True, False], [True, True]]
