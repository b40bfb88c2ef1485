"""What a later status message tells of a robot before it: where a search through a recording need not look."""

from __future__ import annotations

from missionfsm.bear.mission.state import Robot
from missionfsm.bear.mission.stream import Seen, has_goals
from missionfsm.bear.wire.messages import State
from missionfsm.kernel.codec import Garbled

_ACTIVE = (State.STATE_RUNNING, State.STATE_PAUSED)


def foresees(robot: Robot, names: tuple[int, ...], content: Seen | Garbled, shown: tuple[int, ...]) -> bool:
    """Whether the robot may come to be shown so, by whatever steps; see `Spec.foresees`.

    A mission keeps its id, its kind and its goals, and one that has ended stays as it is. As long as a mission is
    active those that wait behind it go on waiting in their order: nobody takes one away or comes between two of them.
    """
    if isinstance(content, Garbled) or not all(content.named):
        return True
    missions = content.states.missions
    places = {name: place for place, name in enumerate(shown)}
    ended = len(robot.done)
    for position, mission in enumerate(robot.listed):
        place = places.get(names[position])
        if place is None:
            continue
        if position < ended and missions[place].state != mission.state:
            return False
        if not has_goals(mission, missions[place]):
            return False
    if robot.active is None:
        return True
    place = places.get(names[ended])
    if place is None or missions[place].state not in _ACTIVE:
        return True
    waiting, behind = names[ended + 1 :], shown[place + 1 :]
    return any(
        all(
            (name == shown_name or (name < 0 and shown_name not in names)) and has_goals(mission, missions[at])
            for name, shown_name, mission, at in zip(
                waiting, behind[first:], robot.pending, range(place + 1 + first, len(missions)), strict=False
            )
        )
        for first in range(len(behind) - len(waiting) + 1)
    )
