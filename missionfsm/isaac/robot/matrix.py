"""In which situations of a robot a tester should have had what happen: lines of every kind, ends, times, drops."""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.isaac.robot.inputs import Arrives, Event
from missionfsm.isaac.robot.scripts import script
from missionfsm.isaac.robot.state import NAME_BOUND, RUNNING_BOUND, TICK, Codelet
from missionfsm.isaac.shared.drives import Passes
from missionfsm.kernel.language import Bounds, Happening, Matrix, Refs, ScriptStep


def situation(here: Codelet, _: object = ()) -> str:
    """The situation that a codelet is in."""
    if not here.connected:
        return "away on a mission" if here.running else "away"
    if here.running:
        return "running"
    return "idle again" if here.used else "idle"


def columns(here: Codelet, _: object, event: Event, refs: Refs) -> tuple[str, ...]:
    """The kind of action that an event is an example of."""
    if isinstance(event, Passes):
        return (_of_time(event.time),)
    if isinstance(event, Happening):
        return (event.name,)
    return (_of_line(here, event, refs),)


def _of_time(time: int) -> str:
    if time < TICK:
        return "less than a tick passes"
    if time < RUNNING_BOUND:
        return "a tick passes"
    return "RUNNING is due" if time < NAME_BOUND else "a name is due"


def _of_line(here: Codelet, event: Arrives, refs: Refs) -> str:
    where = "" if event.channel == here.world.channel else " on another channel"
    if event.foreign:
        return f"a message of another type{where}"
    if event.mission is None:
        return "a line that is no message"
    if event.named and here.mission and refs[:1] == here.mission:
        return "the mission that runs arrives again"
    numbers = " in numbers" if event.numeric else ""
    return f"a mission whose configuration is {event.mission} arrives{numbers}{where}"


WAYS: Mapping[str, tuple[tuple[ScriptStep, ...], ...]] = {
    "idle": (script(""),),
    "running": (script("mission settle"), script("mission 1s mission settle")),
    "idle again": (script("mission settle succeeds settle"), script("mission 1s fails settle")),
    "away": (script("drops settle"), script("mission settle succeeds settle drops settle")),
    "away on a mission": (script("mission 1s settle drops settle"), script("mission mission 1s settle drops settle")),
}

MATRIX = Matrix(situation, columns, WAYS, Bounds(), script("1s")[0])
