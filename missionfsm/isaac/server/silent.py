"""What happens at the server without anybody's doing: what follows at once, and what may have happened unseen.

Before an observation only that is thought of which the observation can tell of (`silent_for`).
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Hashable, Iterable, Iterator

from missionfsm.isaac.server.alike import Unit, exchanged, exchanges_for, exchanges_of
from missionfsm.isaac.server.dispatch import urgent
from missionfsm.isaac.server.effects import as_step
from missionfsm.isaac.server.independence import Part, asked_of, concerned, parts
from missionfsm.isaac.server.inputs import Statuses, Submission
from missionfsm.isaac.server.state import Mission, Move, Server, first_link_ref, missions_of, topic
from missionfsm.isaac.server.stream import may_be_called
from missionfsm.isaac.server.unseen import unseen
from missionfsm.kernel.focus import RETURNED, SETTLED, Focus
from missionfsm.kernel.step import Step


def urgent_steps(server: Server) -> tuple[Step, ...]:
    """What follows at once from where things stand, in the first part where anything does."""
    return next((due for part in parts(server) if (due := _urgent_in(server, part))), ())


def _urgent_in(server: Server, part: Part) -> tuple[Step, ...]:
    # Decisions alone are kept apart: one that was undone would be due again.
    return tuple(as_step(server, move) for move in dict.fromkeys(urgent(Move(server), part)))


def spontaneous_steps(server: Server) -> tuple[Step, ...]:
    """What may have happened unseen, in any part."""
    others = _exchanged(server, _all_pairs(server))
    return others + tuple(as_step(server, move) for part in parts(server) for move in unseen(server, part))


@functools.lru_cache(maxsize=20_000)
def _silent_in(server: Server, part: Part, asked: frozenset[int] | None = frozenset()) -> tuple[Step, ...]:
    return (*_urgent_in(server, part), *(as_step(server, move) for move in dict.fromkeys(unseen(server, part, asked))))


def silent_for(server: Server, focus: Focus) -> tuple[Step, ...]:
    """What may have happened before an observation, in the parts that it is about.

    What settled can tell of is urgent, and what can keep that from happening. All statuses tell of all parts, and
    of one after the other: of the first that is not shown as it stands.
    """
    if focus.kind == SETTLED:
        return _before_rest(server, focus)
    others = _exchanged(server, _pairs(server, focus)) if server.alike else ()
    if focus.kind == RETURNED and isinstance(focus.what, Statuses):
        return (*others, *_silent_before(server, focus))
    asked = asked_of(server, focus)
    return others + tuple(step for part in concerned(server, focus) for step in _silent_in(server, part, asked))


def _before_rest(server: Server, focus: Focus) -> tuple[Step, ...]:
    if focus.topics and not _may_be_rid(server, focus.topics):
        return ()
    for part in parts(server):
        due = _urgent_in(server, part)
        if due:
            return _silent_in(server, part) if _may_be_late(server, part) else due
    return ()


def _may_be_rid(server: Server, topics: tuple[Hashable, ...]) -> bool:
    """Whether connections that owe what has to be seen may be gone before anything else is seen.

    Only a clock that strikes ends one by itself (AI-08 c): one that may have struck, or starts and strikes at once.
    """
    if server.unsteady:
        return True
    slots = {link.slot for link in server.ends if topic(link.slot) in topics}
    ending = (
        slot
        for part in parts(server)
        if any(_may_strike(server, server.missions[index]) for index in part.missions)
        for slot in part.slots
    )
    return slots <= set(ending)


def _may_strike(server: Server, mission: Mission) -> bool:
    at_once = any(time is not None and time <= server.tolerance for time in (mission.start, mission.run))
    return at_once or any(clock.lo <= 0 for clock in mission.clocks)


def _may_be_late(server: Server, part: Part) -> bool:
    """Whether a mission that is about to be sent may have timed out before that."""
    waiting = (server.missions[index] for index in part.missions if server.missions[index].queued)
    return any(clock.lo <= 0 for one in waiting for clock in one.ticking)


def _exchanged(server: Server, pairs: Iterable[tuple[Unit, Unit]]) -> tuple[Step, ...]:
    """Missions that were alike may have been one another all the time; a uuid goes with what became of its mission."""
    return tuple(_exchange(server, *pair) for pair in pairs)


def _exchange(server: Server, one: Unit, other: Unit) -> Step:
    after, places = exchanged(server, one, other)
    first = first_link_ref(server)
    names = (
        *(ref if ref % 2 == 0 else 2 * places.get(ref // 2, ref // 2) + 1 for ref in range(first)),
        *range(first, first + len(server.ends)),
    )
    return Step(after, names=names)


def _pairs(server: Server, focus: Focus) -> Iterator[tuple[Unit, Unit]]:
    """The units that may have changed places, as far as something observed tells of that."""
    asked = ((focus.what, focus.refs),) if focus.kind == RETURNED else ()
    seen = None if focus.answer is None else focus.answer.shape
    if asked and isinstance(focus.what, Statuses) and isinstance(seen, tuple) and len(seen) == len(server.missions):
        yield from exchanges_for(server, lambda index, place: may_be_called(server, index, seen[place]))
    for what, refs in (*asked, *focus.calls):
        if isinstance(what, Submission):
            for index in sorted(missions_of(server, refs)):
                yield from exchanges_of(server, index)
    if any(isinstance(what, Statuses) for what, _ in focus.calls):
        yield from _all_pairs(server)


def _all_pairs(server: Server) -> Iterator[tuple[Unit, Unit]]:
    return (pair for units in server.alike for pair in itertools.combinations(units, 2))


def _silent_before(server: Server, focus: Focus) -> tuple[Step, ...]:
    seen = None if focus.answer is None else focus.answer.shape
    if not isinstance(seen, tuple) or len(seen) != len(server.missions):
        return ()
    for part in parts(server):
        other = frozenset(index for index in part.missions if not may_be_called(server, index, seen[index]))
        if other:
            return _silent_in(server, part, other)
    return ()
