"""The parts of a mission server that do not touch one another, and which of them an observation is about.

Two missions are of one part where one waits for the other, or where the same robot has them and is there, so that one
may keep the other waiting. What happens in one part makes no difference to another: clocks strike and passes come to
each by itself.
"""

from __future__ import annotations

import functools
from collections.abc import Hashable

from missionfsm.isaac.server.inputs import NAME, Drops, Incoming, Submission
from missionfsm.isaac.server.readings import AI_19
from missionfsm.isaac.server.state import ENDED, UNDER_WAY, Server, topic
from missionfsm.kernel.focus import DRIVEN, RETURNED, Focus
from missionfsm.kernel.terms import Refs
from missionfsm.kernel.values import value


@value(cache_hash=True)
class Part:
    """Missions that have not ended, by their index, and connections, by their slot, that touch one another."""

    missions: tuple[int, ...]
    slots: tuple[int, ...]


@functools.lru_cache(maxsize=20_000)
def parts(server: Server) -> tuple[Part, ...]:
    """The parts of a server, in the order of their first missions, those without any last."""
    groups: dict[Hashable, Hashable] = {}

    def group(one: Hashable) -> Hashable:
        while (above := groups.setdefault(one, one)) != one:
            groups[one] = groups.setdefault(above, above)
            one = above
        return one

    def join(one: Hashable, other: Hashable) -> None:
        groups[group(other)] = group(one)

    named = {link.name for link in (*server.links, *server.gone) if link.name is not None}
    anybody = "b" in server.letters(AI_19)
    open_ones = [index for index, one in enumerate(server.missions) if one.status not in ENDED]
    for index in open_ones:
        one = server.missions[index]
        group(index)
        for upstream in one.waits:
            join(index, upstream)
        if one.link is not None:
            join(index, ("link", one.link))
        if one.robot in named or one.status in UNDER_WAY:
            join(index, ("robot", one.robot))
        if one.robot is None and anybody:
            join(index, "anybody")
    for link in (*server.links, *server.gone):
        join(("link", link.slot), ("link", link.slot))
        if link.name is not None:
            join(("link", link.slot), ("robot", link.name))
        if link.over is not None:
            join(("link", link.slot), ("link", link.over))
        if link.serves and anybody and "anybody" in groups:
            join(("link", link.slot), "anybody")
    missions: dict[Hashable, list[int]] = {}
    slots: dict[Hashable, list[int]] = {}
    for index in open_ones:
        missions.setdefault(group(index), []).append(index)
    for link in (*server.links, *server.gone):
        slots.setdefault(group(("link", link.slot)), []).append(link.slot)
    return tuple(
        Part(tuple(missions.get(one, ())), tuple(slots.get(one, ()))) for one in dict.fromkeys((*missions, *slots))
    )


@functools.lru_cache(maxsize=20_000)
def concerned(server: Server, focus: Focus) -> tuple[Part, ...]:
    """The parts that something observed has to do with, as far as it does not show all statuses."""
    missions: set[int] = set()
    slots: set[int] = set()
    names: set[str | None] = set()
    for at in focus.topics:
        slots |= {link.slot for link in server.ends if topic(link.slot) == at}
    asked = ((focus.what, focus.refs),) if focus.kind in (RETURNED, DRIVEN) else ()
    for what, refs in (*asked, *focus.calls):
        meant = _missions(server, refs)
        missions |= meant
        if isinstance(what, Submission):
            names.add(what.robot)
        elif isinstance(what, Incoming | Drops):
            slots |= _slots(server, refs)
            if isinstance(what, Incoming) and what.kind == NAME:
                names |= {what.what, what.what.strip()}
    return tuple(
        part
        for part in parts(server)
        if not missions.isdisjoint(part.missions)
        or not slots.isdisjoint(part.slots)
        or any(server.missions[index].robot in names for index in part.missions)
        or any(link.name in names for link in server.links if link.slot in part.slots and link.name is not None)
    )


def _missions(server: Server, refs: Refs) -> set[int]:
    return {ref // 2 for ref in refs if ref is not None and 0 <= ref < 2 * len(server.missions)}


def _slots(server: Server, refs: Refs) -> set[int]:
    first = 2 * len(server.missions)
    return {server.ends[ref - first].slot for ref in refs if ref is not None and ref >= first}
