"""What takes effect at the server where nothing refuses: calls and drives, as steps.

The names of a state are, for each mission, its handle and its identifier, and then those of the open connections.
"""

from __future__ import annotations

import functools
from collections.abc import Hashable, Iterable, Iterator, Mapping

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.alike import without as without_alike
from missionfsm.isaac.server.clocks import started, zero_means
from missionfsm.isaac.server.connections import connects, drops, hears, is_over, without
from missionfsm.isaac.server.deciding import assumed, merged, split, ways
from missionfsm.isaac.server.elapsing import elapsed
from missionfsm.isaac.server.independence import concerned
from missionfsm.isaac.server.inputs import Ask, Connects, Drops, Incoming, Statuses, Submission
from missionfsm.isaac.server.losing import closed
from missionfsm.isaac.server.readings import AI_04_NEW, AI_05, AI_18_UNNAMED, AI_19, AI_22_STARTED
from missionfsm.isaac.server.rules import OPERATIONS
from missionfsm.isaac.server.state import (
    ENDED,
    FAILURES,
    RUN,
    START,
    Link,
    Mission,
    Move,
    Server,
    Status,
    emissions,
    first_link_ref,
    handle_ref,
    mission_of_handle,
    mission_of_uuid,
    topic,
)
from missionfsm.isaac.server.stream import status_answers
from missionfsm.isaac.server.time import passes
from missionfsm.isaac.server.unseen import nothing_open_happened
from missionfsm.isaac.shared.drives import Elapsed, Passes
from missionfsm.kernel.focus import DRIVEN, RETURNED, Focus
from missionfsm.kernel.history import Answer
from missionfsm.kernel.lazily import Lazily
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import OK, Operation, decide
from missionfsm.kernel.step import Opening, Step
from missionfsm.kernel.terms import Refs


def names_of(server: Server) -> int:
    """How many names a server has."""
    return first_link_ref(server) + len(server.ends)


def as_step(
    before: Server,
    move: Move,
    *,
    new: tuple[int, ...] = (),
    assumes: tuple[Assumption, ...] = (),
) -> Step:
    """A move as a step; `new` are references to the names that `after` has beyond `before`."""
    after = move.state
    if after is before and not move.sent:
        return Step(before, rules=move.rules, assumes=assumes)
    missions, positions = first_link_ref(before), {one.slot: at for at, one in enumerate(before.ends)}
    names = [*range(missions), *(one for one in new if one >= 0)]
    fresh = [one for one in new if one < 0]
    names += [missions + positions[one.slot] if one.slot in positions else fresh[0] for one in after.ends]
    kept = {one.slot for one in after.ends}
    return Step(
        after,
        names=tuple(names),
        emits=emissions(move),
        drains=tuple(topic(one.slot) for one in before.ends if one.slot not in kept),
        rules=tuple(dict.fromkeys(move.rules)),
        assumes=(*assumes, *assumed(before, after)),
    )


def outcomes(
    operations: Mapping[str, Operation],
    server: Server,
    request: Submission | Statuses,
    refs: Refs,
) -> tuple[Step, ...]:
    """The ways in which a call is answered, and what it brings about."""
    if server.over and not (isinstance(request, Statuses) and all(one.status in ENDED for one in server.missions)):
        return ()  # a server that was stopped answers nothing
    if isinstance(request, Statuses):
        return tuple(status_answers(server))
    return _submitted(operations["submit"], server, request, tuple(mission_of_handle(server, ref) for ref in refs))


@functools.lru_cache(maxsize=20_000)
def _submitted(operation: Operation, server: Server, request: Submission, upstream: Refs) -> tuple[Step, ...]:
    ask = Ask(request, upstream)
    found: list[Step] = []
    handles = tuple(None if one is None else handle_ref(one) for one in upstream)
    quiet = nothing_open_happened(server, concerned(server, Focus(RETURNED, request, handles)))
    for decision in decide(operation.blocking(server, ask)):
        if decision.code is not None:
            found.append(decision.refused(server))
            continue
        for move in _taken(quiet, request, tuple(sorted({one for one in upstream if one is not None}))):
            handle = names_of(server)
            step = as_step(server, move, new=(handle, handle + 1), assumes=decision.assumes)
            found.append(evolve(step, answer=Answer(OK), refs=(handle,), kinds=("mission", "uuid")))
    return tuple(found)


def _taken(server: Server, request: Submission, upstream: tuple[int, ...]) -> Iterator[Move]:
    """A mission is queued."""
    promised = tuple(rule.id for rule in OPERATIONS["submit"].promises)
    for letter, move in zero_means(Move(server, rules=promised), request.start, request.run):
        start, run = ((None if letter == "b" and time == 0 else time) for time in (request.start, request.run))
        here: Move | None = move
        if request.robot is None:
            here, _ = split(move, AI_19, "ab")
        if here is None:
            continue
        for doomed, fated, way in _upstreams(here, upstream):
            waits = tuple(one for one in upstream if way.state.missions[one].status not in ENDED and one not in doomed)
            failed = {way.state.missions[one].status for one in upstream if way.state.missions[one].status in FAILURES}
            failed |= {Status.FAILED} if doomed else set()
            mission = Mission(
                request.robot,
                request.channel,
                request.status_channel,
                request.config,
                start,
                run,
                waits,
                tuple(sorted(failed, key=lambda one: one.value)),
                depends=bool(upstream),
                fated=fated,
                new=_not_looked_at(way.state),
            )
            known = without_alike(way.state, upstream)
            yield _clocked(way.to(evolve(known, missions=(*known.missions, mission))))


def _not_looked_at(server: Server) -> bool | None:
    """AI-04.new: that no pass has looked at what is submitted now, as `Mission.new` says it."""
    return not server.tolerance if "b" in server.letters(AI_04_NEW) else None


def _upstreams(move: Move, upstream: tuple[int, ...]) -> Iterator[tuple[tuple[int, ...], tuple[int, ...], Move]]:
    """AI-22.started: the upstreams that are as good as failed now, and once they have ended, where that is so read."""
    unheard = tuple(one for one in upstream if move.state.missions[one].status is Status.STARTED)
    if not unheard:
        yield (), (), move
        return
    for letter, way in ways(move, AI_22_STARTED, "a", "i", "j"):
        yield unheard if letter == "i" else (), unheard if letter == "j" else (), way


def _clocked(move: Move) -> Move:
    index = len(move.state.missions) - 1
    mission = move.state.missions[index]
    move = started(started(move, index, START, "submit"), index, RUN, "submit")
    if move.state.serving(mission.robot) is not None and "d" in move.state.letters(AI_05):
        move = started(move, index, START, "connect")
    return started(move, index, START, "ready") if mission.ready else move


def connect(server: Server, _: Connects, __: Refs) -> tuple[Step, ...]:
    """A connection is made, which nobody has given a name."""
    if server.over:
        return ()
    move = connects(Move(server))
    step = as_step(server, move, new=(-1,))
    return (evolve(step, opens=(Opening(topic(move.state.links[-1].slot), -1, kind="connection"),)),)


def _link_at(server: Server, ref: int | None) -> int | None:
    position = -1 if ref is None else ref - first_link_ref(server)
    return position if 0 <= position < len(server.links) else None


@functools.lru_cache(maxsize=20_000)
def line(server: Server, heard: Incoming, refs: Refs) -> tuple[Step, ...]:
    """A line comes on a connection."""
    position = _link_at(server, refs[0] if refs else None)
    if position is None:
        return ()
    if server.over:
        return (Step(server),)
    if server.links[position].closing:
        return ()
    named = mission_of_uuid(server, refs[1]) if heard.named else None
    header = mission_of_uuid(server, refs[-1]) if heard.header else None
    quiet = nothing_open_happened(server, concerned(server, Focus(DRIVEN, heard, refs)))
    moves = merged(hears(Move(quiet), quiet.links[position], heard, named, header))
    return tuple(as_step(server, move) for move in moves)


def disconnect(server: Server, _: Drops, refs: Refs) -> tuple[Step, ...]:
    """A connection drops."""
    position = _link_at(server, refs[0] if refs else None)
    if position is None:
        return ()
    if server.links[position].closing:
        return ()
    if server.over:
        return (as_step(server, Move(without(server, server.links[position]))),)
    quiet = nothing_open_happened(server, concerned(server, Focus(DRIVEN, Drops(), refs)))
    return tuple(as_step(server, move) for move in merged(drops(Move(quiet), quiet.links[position], seen=True)))


@functools.lru_cache(maxsize=20_000)
def advance(server: Server, event: Passes | Elapsed, _: Refs) -> Iterable[Step]:
    """Time passes that a tester lets pass, or has passed by the times of a log."""
    if server.over:
        return (Step(server),)
    if isinstance(event, Elapsed):
        return tuple(as_step(server, move) for move in elapsed(server, event.time, event.late))
    return Lazily(as_step(server, _with_silence(server, move)) for move in passes(server, event.time))


def _with_silence(before: Server, move: Move) -> Move:
    """The move with what it shows of missions that go on though their robots say nothing."""
    pairs = zip(before.missions, move.state.missions, strict=True)
    goes_on = any(one.status is Status.RUNNING is other.status for one, other in pairs)
    return move.to(move.state, rules.SILENCE.id) if goes_on else move


def _seen_to_end(server: Server, link: Link) -> Step:
    """The end is seen of a connection that the server has closed."""
    links = tuple(one for one in server.links if one is not link)
    return evolve(as_step(server, Move(evolve(server, links=links))), drains=(), closes=(topic(link.slot),))


def closing(server: Server, at: Hashable) -> tuple[Step, ...]:
    """A connection is closed, whenever that is: since it said no name (AI-18.unnamed), or with the server (AI-29)."""
    link = server.link_of_topic(at)
    if link is None:
        return ()
    if link.closing:
        return (_seen_to_end(server, link),)
    over = is_over(Move(server), link)
    steps = () if over is None else (as_step(server, over),)
    _, tired = (None, None) if link.name is not None or server.over else split(Move(server), AI_18_UNNAMED, "c")
    if tired is None:
        return steps
    return (*(as_step(server, move.to(move.state, rules.UNNAMED.id)) for move in closed(tired, link)), *steps)
