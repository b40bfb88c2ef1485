"""How a robot's connection begins: with a client that has done nothing yet, or, in a log that begins anywhere, in use.

A client that was in use may run a mission, and may have statuses to say of missions that ended before the log began:
those that waited for the codelet's tick, or for a connection. Of which missions they are shows once they are said.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator

from attrs import evolve

from missionfsm.isaac.robot import due
from missionfsm.isaac.robot.state import TICK, Codelet
from missionfsm.kernel.language import Opening, Step
from missionfsm.kernel.spec import Middle


@functools.lru_cache(maxsize=1_000)
def begins(here: Codelet) -> tuple[Step, ...]:
    """The connection, which is there from the start, is opened like any other."""
    if here.begun:
        return ()
    if here.in_use:
        return tuple(_goes_on(evolve(here, begun=True, in_use=False, used=True, earlier=TICK)))
    return (_opened(evolve(here, begun=True, connected=True)),)


def _goes_on(here: Codelet) -> Iterator[Step]:
    """A client that was in use goes on, with or without a mission and a connection."""
    missions = ((False, False), (True, True), (True, False))
    for connected, (running, named) in itertools.product((True, False), missions):
        yield _opened(evolve(here, connected=connected, running=running, named=named))


def _opened(after: Codelet) -> Step:
    """The step after which the connection was opened; the identifier of a mission that runs is a name that is new."""
    about = 1 if after.named else None
    reports = (due.may_report(after, about),) if after.running and after.connected else ()
    openings = (
        Opening(due.STATUSES, 0, (*due.of_before(after), *reports), kind="connection"),
        Opening(due.NAMES, 0, (due.introduction(after.world, offer=True),), kind="connection"),
        Opening(due.OTHERS, 0, (due.anything(after.world),), kind="connection"),
    )
    return Step(after, names=() if about is None else (about,), opens=openings)


MIDDLE = Middle(used=lambda here: evolve(here, in_use=True))
"""A log of a robot may begin anywhere."""
