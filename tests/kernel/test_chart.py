"""Lifecycles as tables, compiled and as `transitions` machines."""

from __future__ import annotations

import enum

import pytest
from hypothesis import given
from hypothesis import strategies as st
from transitions import MachineError

from missionfsm.kernel.chart import Chart


class Door(enum.Enum):
    """What a door can be."""

    SHUT = 1
    OPEN = 2
    GONE = 3


DOOR: Chart[Door] = Chart(
    "door",
    Door.SHUT,
    (
        ("open", Door.SHUT, Door.OPEN),
        ("close", Door.OPEN, Door.SHUT),
        ("close", Door.SHUT, Door.SHUT),
        ("unhinge", Door.OPEN, Door.GONE),
    ),
)


def test_a_chart_lists_its_table() -> None:
    """States, triggers and final states are those of the table, each once, in its order."""
    found = (DOOR.states, DOOR.triggers, DOOR.final)
    assert found == (tuple(Door), ("open", "close", "unhinge"), (Door.GONE,))


def test_a_chart_moves_by_its_table() -> None:
    """Exactly the moves of the table are moves."""
    moves = {
        (trigger, state): DOOR.after(trigger, state)
        for trigger in DOOR.triggers
        for state in DOOR.states
        if DOOR.after(trigger, state) is not None
    }
    assert moves == {(trigger, source): end for trigger, source, end in DOOR.table}


@given(st.lists(st.sampled_from(DOOR.triggers), max_size=12))
def test_the_machine_walks_as_the_chart_does(triggers: list[str]) -> None:
    """The `transitions` machine and the compiled table make the same moves and refuse the same ones."""
    machine, here = DOOR.machine(), DOOR.initial
    for trigger in triggers:
        after = DOOR.after(trigger, here)
        if after is None:
            with pytest.raises(MachineError):
                machine.trigger(trigger)
        else:
            machine.trigger(trigger)
            here = after
        assert machine.state == here.name


def test_the_machine_drives_an_object() -> None:
    """Callbacks of an object of one's own are called, and there are no triggers but the table's."""

    class Reference:
        opened = 0

        def on_enter_OPEN(self) -> None:  # noqa: N802 - as transitions names it
            self.opened += 1

    model = Reference()
    DOOR.machine(model)
    model.open()  # type: ignore[attr-defined]
    assert (model.opened, hasattr(model, "to_GONE")) == (1, False)


def test_a_trigger_leaves_a_state_once() -> None:
    """Two moves with one trigger from one state are refused."""
    with pytest.raises(ValueError, match="chart lamp: press leaves off twice"):
        Chart("lamp", "off", (("press", "off", "on"), ("press", "off", "off")))


def test_every_state_can_be_reached() -> None:
    """A state that no way leads to is refused."""
    with pytest.raises(ValueError, match="chart lamp: lost cannot be reached from off"):
        Chart("lamp", "off", (("press", "off", "on"), ("find", "lost", "off")))
