"""Goals that other robots take or leave while the log of a robot says nothing of it.

In a world that is `unwatched`, a NavigateAuto mission may find any of its goals free, or none, whenever it looks. What
contradicts the known world assumes `LOG_03` read as b. Which goals are taken is not remembered: a moment later it may
be different, and worlds would multiply.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator

from attrs import evolve

from missionfsm.bear.mission.outcome import Assumed
from missionfsm.bear.mission.state import World
from missionfsm.bear.wire.messages import Goal
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.spec import Unwatched

LOG_03 = Ambiguity(
    "LOG-03",
    "Did other robots take or leave goals with no line of the log that says so?",
    {"a": "no", "b": "yes, so that a NavigateAuto mission found others free"},
    flagged="b",
)
UNWATCHED = Unwatched(LOG_03, lambda world: evolve(world, unwatched=True))


@functools.lru_cache(maxsize=10_000)
def worlds(world: World, goals: tuple[Goal, ...]) -> tuple[tuple[World, Assumed], ...]:
    """The known world, and the worlds that others may have made of it: one of the goals is free, or none is."""
    return tuple(_worlds(world, goals))


def _worlds(world: World, goals: tuple[Goal, ...]) -> Iterator[tuple[World, Assumed]]:
    yield world, ()
    if world.unwatched and goals:
        names = tuple(dict.fromkeys(goal.destination_id for goal in goals if goal.destination_id))
        taken = (tuple(name for name in names if name != free) for free in names)
        for occupied in (*taken, names):
            yield evolve(world, occupied=occupied), (LOG_03["b"],)


__all__ = ["LOG_03", "UNWATCHED", "worlds"]
