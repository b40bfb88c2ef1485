"""The parts of a mission server that do not touch one another, and which of them an observation is about.

Two missions are of one part where one waits for the other, or where the same robot has them and is there, so that one
may keep the other waiting. What happens in one part makes no difference to another: clocks strike and passes come to
each by itself.
"""

from __future__ import annotations

import functools
from collections.abc import Container, Hashable, Iterator

from attrs import define, field

from missionfsm.isaac.server.inputs import NAME, Drops, Incoming, Submission
from missionfsm.isaac.server.readings import AI_19
from missionfsm.isaac.server.state import ENDED, UNDER_WAY, Link, Mission, Server, first_link_ref, missions_of, topic
from missionfsm.kernel.focus import DRIVEN, RETURNED, Focus
from missionfsm.kernel.focus import ENDED as CLOSED
from missionfsm.kernel.terms import Refs
from missionfsm.kernel.values import value


@value(cache_hash=True)
class Part:
    """Missions that have not ended, by their index, and connections, by their slot, that touch one another."""

    missions: tuple[int, ...]
    slots: tuple[int, ...]


@functools.lru_cache(maxsize=20_000)
def parts(server: Server) -> tuple[Part, ...]:
    """The parts of a server, in the order of their first missions, those without any last; none once it has ended."""
    if server.over:
        return ()
    groups = _Groups()
    links = (*server.links, *server.gone)
    open_ones = [index for index, one in enumerate(server.missions) if one.status not in ENDED]
    anybody = "b" in server.letters(AI_19) and any(server.missions[index].robot is None for index in open_ones)
    named = {link.name for link in links if link.name is not None}
    for index in open_ones:
        for other in _touched_by(index, server.missions[index], named, anybody=anybody):
            groups.join(index, other)
    for link in links:
        for other in _touched_by_link(link, anybody=anybody):
            groups.join(("link", link.slot), other)
    found: dict[Hashable, tuple[list[int], list[int]]] = {}
    for index in open_ones:
        found.setdefault(groups.of(index), ([], []))[0].append(index)
    for link in links:
        found.setdefault(groups.of(("link", link.slot)), ([], []))[1].append(link.slot)
    return tuple(Part(tuple(missions), tuple(slots)) for missions, slots in found.values())


def _touched_by(index: int, mission: Mission, named: Container[str | None], *, anybody: bool) -> Iterator[Hashable]:
    """What a mission that has not ended is of one part with: itself at least."""
    yield index
    yield from mission.waits
    if mission.sent_on is not None:
        yield "link", mission.sent_on
    if mission.robot in named or mission.status in UNDER_WAY:
        yield "robot", mission.robot
    if mission.robot is None and anybody:
        yield "anybody"


def _touched_by_link(link: Link, *, anybody: bool) -> Iterator[Hashable]:
    """What a connection is of one part with: itself at least."""
    yield "link", link.slot
    if link.name is not None:
        yield "robot", link.name
    if link.over is not None:
        yield "link", link.over
    if link.serves and anybody:
        yield "anybody"


@define(eq=False)
class _Groups:
    """Things that belong together, as a union-find forest: of each the one above it, or itself at the top."""

    above: dict[Hashable, Hashable] = field(factory=dict)

    def of(self, one: Hashable) -> Hashable:
        """What stands for the group of a thing."""
        above = self.above
        while (higher := above.setdefault(one, one)) != one:
            above[one] = above.setdefault(higher, higher)
            one = higher
        return one

    def join(self, one: Hashable, other: Hashable) -> None:
        """The groups of two things are one."""
        self.above[self.of(other)] = self.of(one)


@functools.lru_cache(maxsize=20_000)
def concerned(server: Server, focus: Focus) -> tuple[Part, ...]:
    """The parts that something observed has to do with, as far as it does not show all statuses."""
    missions, slots, names = _about(server, focus)
    slots |= {link.slot for link in server.links if link.name is not None and link.name in names}
    return tuple(
        part
        for part in parts(server)
        if not missions.isdisjoint(part.missions)
        or not slots.isdisjoint(part.slots)
        or any(server.missions[index].robot in names for index in part.missions)
    )


def asked_of(server: Server, focus: Focus) -> frozenset[int] | None:
    """The missions that something observed asks more of than what else happens; None: all, as where a server ends."""
    return None if focus.kind == CLOSED else frozenset(_about(server, focus)[0])


def _about(server: Server, focus: Focus) -> tuple[set[int], set[int], set[str | None]]:
    """The missions, connections and robots that something observed tells of."""
    missions: set[int] = set()
    slots = {link.slot for link in server.ends if topic(link.slot) in focus.topics}
    names: set[str | None] = set()
    asked = ((focus.what, focus.refs),) if focus.kind in (RETURNED, DRIVEN) else ()
    for what, refs in (*asked, *focus.calls):
        missions |= missions_of(server, refs)
        if isinstance(what, Submission):
            names.add(what.robot)
        elif isinstance(what, Incoming | Drops):
            slots |= _slots(server, refs)
            if isinstance(what, Incoming) and what.kind == NAME:
                names |= {what.what, what.what.strip()}
    return missions, slots, names


def _slots(server: Server, refs: Refs) -> set[int]:
    first = first_link_ref(server)
    return {server.ends[ref - first].slot for ref in refs if ref is not None and ref >= first}
