"""Missions that are alike: where any of several that are ready may go first (AI-13 b), nobody need know which did.

The first goes for all of them, and it is remembered that they were alike (`Server.alike`). In whatever became of them
any two may change places, together with those that wait for them. Only what mentions handles tells which is which.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from attrs import evolve

from missionfsm.isaac.server.state import Link, Mission, Server

Unit = tuple[int, ...]
"""A mission, and those that wait for it, in an order that is that of the units that it may change places with."""


def _exchange(one: Unit, other: Unit) -> dict[int, int]:
    return dict(zip((*one, *other), (*other, *one), strict=True))


def _moved(missions: tuple[Mission, ...], places: Mapping[int, int]) -> tuple[Mission, ...]:
    """The missions where some have each other's places."""

    def each(indices: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(sorted(places.get(index, index) for index in indices))

    after = list(missions)
    for index, one in enumerate(missions):
        after[places.get(index, index)] = (
            evolve(one, waits=each(one.waits), fated=each(one.fated)) if one.waits or one.fated else one
        )
    return tuple(after)


def exchanged(server: Server, one: Unit, other: Unit) -> tuple[Server, dict[int, int]]:
    """The server where the missions of two units have each other's places, and which have whose."""
    places = _exchange(one, other)
    links = tuple(_meaning(one, places) for one in server.links)
    return evolve(server, missions=_moved(server.missions, places), links=links), places


def _meaning(link: Link, places: Mapping[int, int]) -> Link:
    """A connection whose early statuses are about missions that have each other's places."""

    def moved(index: int | None) -> int | None:
        return None if index is None else places.get(index, index)

    if not link.early:
        return link
    early = (evolve(one, named=moved(one.named), header=moved(one.header)) for one in link.early)
    return evolve(link, early=tuple(early))


def _units(missions: tuple[Mission, ...], one: int, other: int) -> tuple[Unit, Unit] | None:
    """The units of two missions that are alike, with all that waits for them; None where they are not."""
    pairs, sides = [(one, other)], {one, other}
    for mine, its in pairs:
        waiting, others = ([at for at, it in enumerate(missions) if up in it.waits] for up in (mine, its))
        own = [at for at in waiting if at not in others and at not in sides]
        theirs = [at for at in others if at not in waiting and at not in sides]
        if len(own) != len(theirs):
            return None
        pairs += zip(own, theirs, strict=True)
        sides |= {*own, *theirs}
    units = tuple(mine for mine, _ in pairs), tuple(its for _, its in pairs)
    return units if _moved(missions, _exchange(*units)) == missions else None


def first_of_alike(server: Server, ready: Sequence[int]) -> Iterator[tuple[int, Server]]:
    """Of missions that are ready the first of those that are alike, each with what is remembered of that."""
    left = list(ready)
    while left:
        first, *left = left
        group = next((units for units in server.alike if any(unit[0] == first for unit in units)), None)
        found = _alike(server, first, left) if group is None else _still_alike(server, first, left, group)
        left = [index for index in left if index not in {unit[0] for unit in found}]
        yield first, server if group or not found else evolve(server, alike=(*server.alike, tuple(found)))


def _still_alike(server: Server, first: int, others: Sequence[int], group: tuple[Unit, ...]) -> list[Unit]:
    """The units of a mission, and of those others of its group that are still like it."""
    heads = {unit[0] for unit in group}
    return _collected(_units(server.missions, first, other) for other in others if other in heads)


def _alike(server: Server, first: int, others: Sequence[int]) -> list[Unit]:
    """The units of a mission of no group, and of those others of none that are like it; none where nothing is."""
    taken = {index for units in server.alike for unit in units for index in unit}
    if first in taken:
        return []
    pairs = (_units(server.missions, first, other) for other in others)
    return _collected(both for both in pairs if both is not None and taken.isdisjoint((*both[0], *both[1])))


def _collected(pairs: Iterable[tuple[Unit, Unit] | None]) -> list[Unit]:
    """The units of pairs that have one unit in common, as long as they share no mission."""
    found: list[Unit] = []
    for both in pairs:
        if both is None:
            continue
        if not found:
            found += both
        elif found[0] == both[0] and not any(set(one) & set(both[1]) for one in found):
            found.append(both[1])
    return found


def one_of_each(server: Server, indices: Sequence[int]) -> tuple[int, ...]:
    """Those among missions that are like no other before them, where nothing but handles tells them apart."""
    if not server.alike:
        return tuple(indices)
    found: dict[object, int] = {}
    for index in indices:
        unit = next(((at, one) for at, units in enumerate(server.alike) for one in units if one[0] == index), None)
        key = index if unit is None else (unit[0], _standing(server.missions, unit[1]))
        found.setdefault(key, index)
    return tuple(found.values())


def exchanges_for(server: Server, fits: Callable[[int, int], bool]) -> Iterator[tuple[Unit, Unit]]:
    """Units that may have changed places, so that the first mission is right of those that are not as they are shown.

    Args:
        fits: whether a mission would be right in the place of another.
    """
    for units in server.alike:
        for one in units:
            if all(fits(index, index) for index in one):
                continue
            known: set[tuple[Mission, ...]] = set()
            for other in units:
                like = _standing(server.missions, other)
                if other != one and like not in known and all(map(fits, other, one)):
                    known.add(like)
                    yield one, other
            return


def _standing(missions: tuple[Mission, ...], unit: Unit) -> tuple[Mission, ...]:
    """How the missions of a unit stand, whichever they are."""
    places = {index: -1 - at for at, index in enumerate(unit)}
    return tuple(
        evolve(missions[index], waits=tuple(places.get(at, at) for at in missions[index].waits)) for index in unit
    )


def exchanges_of(server: Server, index: int) -> Iterator[tuple[Unit, Unit]]:
    """All units with which that of a mission may have changed places."""
    for units in server.alike:
        for one in units:
            if index in one:
                yield from ((one, other) for other in units if other != one)


def told_apart(server: Server, words: Sequence[object]) -> Server:
    """The server once it is known what each mission is called: those called otherwise are not alike any more."""
    if not server.alike:
        return server
    groups = []
    for units in server.alike:
        called: dict[tuple[object, ...], list[Unit]] = {}
        for unit in units:
            called.setdefault(tuple(words[index] for index in unit), []).append(unit)
        groups += [tuple(same) for same in called.values() if len(same) > 1]
    return evolve(server, alike=tuple(groups))


def without(server: Server, indices: Sequence[int]) -> Server:
    """The server once something else depends on some of the missions: these are like no others any more."""
    if not server.alike:
        return server
    groups = (tuple(unit for unit in units if not set(unit) & set(indices)) for units in server.alike)
    return evolve(server, alike=tuple(one for one in groups if len(one) > 1))
