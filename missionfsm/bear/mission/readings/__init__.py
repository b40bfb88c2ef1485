"""Where the Mission page can be read in more than one way, by themes; ``specs/bear-mission.md`` argues each entry.

A name is that of its entry, and letters are those of the entry. An entry with several independent questions has an
ambiguity for each, with a word after its number, and a question that no sentence answers for several calls, situations
or kinds of missions at once has one for each of those (`asked_of_each`; `scope` has those parts). The files import the
kernel and what a state is. Begin with `codes`.
"""

from __future__ import annotations

from missionfsm.bear.mission.readings import (
    charging,
    clearing,
    codes,
    goals,
    messages,
    queue,
    skipping,
    starting,
    unlisted,
    updating,
    workflows,
)
from missionfsm.bear.mission.readings.waived import WAIVED
from missionfsm.kernel.readings import Ambiguity, declared

__all__ = ["AMBIGUITIES", "WAIVED"]

_THEMES = (
    codes,
    queue,
    starting,
    goals,
    workflows,
    charging,
    updating,
    skipping,
    clearing,
    messages,
    unlisted,
)
AMBIGUITIES: tuple[Ambiguity, ...] = tuple(
    sorted(
        dict.fromkeys(one for theme in _THEMES for one in declared(vars(theme), Ambiguity)),
        key=lambda one: one.id.partition(".")[0],
    )
)
"""In the order of the entries."""
