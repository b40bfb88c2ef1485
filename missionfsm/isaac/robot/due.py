"""What a robot has to say: statuses that are due, its name, and when each is sent.

Statuses, names and what else is sent are three topics of the one connection. A status is sent at once or on the
codelet's own tick (AI-31), and one that waits holds up those behind it.
"""

from __future__ import annotations

from collections.abc import Iterator

from attrs import evolve, frozen

from missionfsm.isaac.robot import readings, rules
from missionfsm.isaac.robot.state import Codelet, Earlier, Introduction, Other, Report, Waiting, World
from missionfsm.kernel.language import Ambiguity, Assumption, Emission, Rule, Step

STATUSES, NAMES, OTHERS = TOPICS = ("statuses", "names", "others")
"""The topics of the one connection: statuses, names and what else is sent come in any order among one another."""

MAX_WAITING = 32
"""How many statuses wait before the codelet is taken to have ticked when another one is due."""

FINAL = {"success": rules.SUCCESS, "failure": rules.FAILURE}


@frozen
class Status:
    """A status that is due: what it says, of the mission with which identifier (None for none), and when it is sent."""

    status: str
    about: int | None
    when: Ambiguity
    offered: bool = False
    """Whether RUNNING may come before it."""


Statuses = tuple[Status, ...]


def emission(world: World, status: str, about: int | None, *, offer: bool = False) -> Emission:
    """A status on its channel: one that is owed, or (`offer`) one that may come, and again."""
    view = Report(status, about is not None, world.status_channel)
    return Emission(STATUSES, view, () if about is None else (about,), stays=offer, certain=not offer)


def may_report(here: Codelet, about: int | None) -> Emission:
    """RUNNING, which may be said, and again."""
    return emission(here.world, "running", about, offer=True)


def of_before(here: Codelet) -> tuple[Emission, ...]:
    """Statuses of missions from before the log, which may be said in the time that there is left for them."""
    return (Emission(STATUSES, Earlier(here.world.status_channel), (), stays=True),) if here.earlier else ()


def introduction(world: World, *, offer: bool = False) -> Emission:
    """The name that is owed, or may be said."""
    return Emission(NAMES, Introduction(world.name, world.name_channel), (), stays=offer, certain=not offer)


def anything(world: World) -> Emission:
    """What the application around the codelet may send besides."""
    return Emission(OTHERS, Other(world.channels), (), stays=True)


def _said(here: Codelet, status: str, about: int | None, *, offered: bool) -> tuple[Emission, ...]:
    """A status, behind RUNNING where that may come before it."""
    owed = emission(here.world, status, about)
    return (may_report(here, about), owed) if offered else (owed,)


def all_waiting(here: Codelet) -> Iterator[Emission]:
    """The statuses that waited, in order."""
    places = iter(here.waits)
    for one in here.waiting:
        yield from _said(here, one.status, next(places) if one.named else None, offered=one.offered)


def concluded(
    here: Codelet, after: Codelet, mission: int | None, due: Statuses, because: tuple[Rule, ...]
) -> Iterator[Step]:
    """The ways in which statuses become due: each is sent at once, or with those before it waits for the tick.

    Args:
        after: the codelet after it, what waits left out.
        mission: the reference to the identifier of the mission that runs then; None for none.
        due: the statuses, in order.
    """
    runs = () if mission is None else (mission,)
    ids = tuple(one.id for one in because)
    if not here.connected:
        yield from _unconnected(here, after, runs, due, ids)
        return
    for now, later, assumes in _divided(due):
        flushed = bool(now) or not (here.waiting or later) or len(here.waiting) >= MAX_WAITING
        waiting = (*(() if flushed else here.waiting), *(_waits(one) for one in later))
        waited = 0 if flushed else here.waited
        emits = (
            *(all_waiting(here) if flushed else ()),
            *_sent(here, now),
            *((may_report(here, mission),) if after.running and not waiting else ()),
        )
        names = (*(() if flushed else here.waits), *_names_in(later), *runs)
        conclusion = evolve(after, waiting=waiting, waited=waited)
        yield Step(conclusion, names=names, emits=emits, rules=ids, assumes=assumes)


def _divided(
    due: Statuses,
) -> Iterator[tuple[Statuses, Statuses, tuple[Assumption, ...]]]:
    """Those that are sent at once and those that wait, with what that assumes: one that waits holds up those behind."""
    for sent in range(len(due), -1, -1):
        now, later = due[:sent], due[sent:]
        assumes = (*(one.when["a"] for one in now[-1:]), *(one.when["b"] for one in later[:1]))
        if len({one.ambiguity for one in assumes}) == len(assumes):
            yield now, later, assumes


def _sent(here: Codelet, due: Statuses) -> Iterator[Emission]:
    return (line for one in due for line in _said(here, one.status, one.about, offered=one.offered))


def _names_in(due: Statuses) -> Iterator[int]:
    return (one.about for one in due if one.about is not None)


def _waits(due: Status) -> Waiting:
    preempted = due.when == readings.AI_31_SENT["preempted"]
    unread = preempted or due.when == readings.AI_31_SENT["unusable"]
    return Waiting(due.status, due.about is not None, due.offered, preempted=preempted, unread=unread)


def _unconnected(
    here: Codelet, after: Codelet, runs: tuple[int, ...], due: Statuses, ids: tuple[str, ...]
) -> Iterator[Step]:
    ids = (*ids, rules.LINKED.id)
    before = here.waits
    yield Step(
        evolve(after, waiting=here.waiting), names=(*before, *runs), rules=ids, assumes=(readings.AI_15_STATUS["a"],)
    )
    reports = tuple(_waits(one) for one in due)
    names = (*before, *_names_in(due), *runs)
    kept = Step(evolve(after, waiting=(*here.waiting, *reports)), names=names, rules=ids)
    yield evolve(kept, assumes=(readings.AI_15_STATUS["b"],))
    # What waits for the codelet's tick is not due before that: whether it is lost shows only where time passes.
    yield evolve(kept, assumes=tuple(one.when["b"] for one in due[:1]))
