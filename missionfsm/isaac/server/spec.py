"""The mission server as a `Spec`: what a correct one may do, under any consistent choice of readings.

The names of a state are, for each mission, its handle and its identifier, and then those of the open connections.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Hashable, Iterable, Iterator, Mapping

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.abstraction import canonical, explore_size, idle_search_key, search_key, search_size
from missionfsm.isaac.server.alike import Unit, exchanged, exchanges_for, exchanges_of
from missionfsm.isaac.server.alike import without as without_alike
from missionfsm.isaac.server.clocks import started, zero_means
from missionfsm.isaac.server.connections import connects, drops, hears, is_over, without
from missionfsm.isaac.server.deciding import assumed, merged, split, ways
from missionfsm.isaac.server.describe import describe
from missionfsm.isaac.server.dispatch import urgent
from missionfsm.isaac.server.independence import Part, asked_of, concerned, parts
from missionfsm.isaac.server.inputs import Ask, Connects, Drops, Incoming, Statuses, Submission
from missionfsm.isaac.server.lifecycle import closed
from missionfsm.isaac.server.properties import INVARIANTS, POSSIBILITIES
from missionfsm.isaac.server.readings import (
    AI_05,
    AI_18_UNNAMED,
    AI_19,
    AI_22_STARTED,
    AI_39,
    AMBIGUITIES,
)
from missionfsm.isaac.server.rules import OPERATIONS, RULES
from missionfsm.isaac.server.state import (
    ENDED,
    FAILURES,
    LIFECYCLE,
    PASS_PERIOD,
    RUN,
    START,
    SYSTEM_NAME,
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
    missions_of,
    topic,
)
from missionfsm.isaac.server.stream import agrees, matches, may_be_called, status_answers
from missionfsm.isaac.server.time import calmed, elapsed, nothing_open_happened, passes, unseen
from missionfsm.isaac.shared.drives import Elapsed, Passes, elapses, later
from missionfsm.isaac.shared.line import LineContent
from missionfsm.isaac.shared.stream import sequence
from missionfsm.kernel.abstraction import Abstraction
from missionfsm.kernel.focus import DRIVEN, RETURNED, SETTLED, Focus
from missionfsm.kernel.history import Answer
from missionfsm.kernel.lazily import Lazily
from missionfsm.kernel.readings import UNCONSTRAINED, Assumption
from missionfsm.kernel.rules import OK, Operation, decide
from missionfsm.kernel.spec import Delivery, Drive, Spec
from missionfsm.kernel.step import Opening, Step, Unowed
from missionfsm.kernel.terms import Refs


def _names(server: Server) -> int:
    """How many names a server has."""
    return first_link_ref(server) + len(server.ends)


def _step(
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


# Calls.


def _outcomes(
    operations: Mapping[str, Operation],
    server: Server,
    request: Submission | Statuses,
    refs: Refs,
) -> tuple[Step, ...]:
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
            handle = _names(server)
            step = _step(server, move, new=(handle, handle + 1), assumes=decision.assumes)
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
            )
            known = without_alike(way.state, upstream)
            yield _clocked(way.to(evolve(known, missions=(*known.missions, mission))))


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


# Drives.


def _connect(server: Server, _: Connects, __: Refs) -> tuple[Step, ...]:
    if server.over:
        return ()
    move = connects(Move(server))
    step = _step(server, move, new=(-1,))
    return (evolve(step, opens=(Opening(topic(move.state.links[-1].slot), -1, kind="connection"),)),)


def _link_at(server: Server, ref: int | None) -> int | None:
    position = -1 if ref is None else ref - first_link_ref(server)
    return position if 0 <= position < len(server.links) else None


@functools.lru_cache(maxsize=20_000)
def _line(server: Server, heard: Incoming, refs: Refs) -> tuple[Step, ...]:
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
    return tuple(_step(server, move) for move in moves)


def _disconnect(server: Server, _: Drops, refs: Refs) -> tuple[Step, ...]:
    position = _link_at(server, refs[0] if refs else None)
    if position is None:
        return ()
    if server.links[position].closing:
        return ()
    if server.over:
        return (_step(server, Move(without(server, server.links[position]))),)
    quiet = nothing_open_happened(server, concerned(server, Focus(DRIVEN, Drops(), refs)))
    return tuple(_step(server, move) for move in merged(drops(Move(quiet), quiet.links[position], seen=True)))


@functools.lru_cache(maxsize=20_000)
def _advance(server: Server, event: Passes | Elapsed, _: Refs) -> Iterable[Step]:
    if server.over:
        return (Step(server),)
    if isinstance(event, Elapsed):
        return tuple(_step(server, move) for move in elapsed(server, event.time, event.late))
    return Lazily(_step(server, _with_silence(server, move)) for move in passes(server, event.time))


def _with_silence(before: Server, move: Move) -> Move:
    """The move with what it shows of missions that go on though their robots say nothing."""
    pairs = zip(before.missions, move.state.missions, strict=True)
    goes_on = any(one.status is Status.RUNNING is other.status for one, other in pairs)
    return move.to(move.state, rules.SILENCE.id) if goes_on else move


def _seen_to_end(server: Server, link: Link) -> Step:
    """The end is seen of a connection that the server has closed."""
    links = tuple(one for one in server.links if one is not link)
    return evolve(_step(server, Move(evolve(server, links=links))), drains=(), closes=(topic(link.slot),))


def _closing(server: Server, at: Hashable) -> tuple[Step, ...]:
    """A connection is closed, whenever that is: since it said no name (AI-18.unnamed), or with the server (AI-29)."""
    link = server.link_of_topic(at)
    if link is None:
        return ()
    if link.closing:
        return (_seen_to_end(server, link),)
    over = is_over(Move(server), link)
    steps = () if over is None else (_step(server, over),)
    _, tired = (None, None) if link.name is not None or server.over else split(Move(server), AI_18_UNNAMED, "c")
    if tired is None:
        return steps
    return (*(_step(server, move.to(move.state, rules.UNNAMED.id)) for move in closed(tired, link)), *steps)


def _urgent(server: Server) -> tuple[Step, ...]:
    return next((due for part in parts(server) if (due := _urgent_in(server, part))), ())


def _urgent_in(server: Server, part: Part) -> tuple[Step, ...]:
    # Decisions alone are kept apart: one that was undone would be due again.
    return tuple(_step(server, move) for move in dict.fromkeys(urgent(Move(server), part)))


def _spontaneous(server: Server) -> tuple[Step, ...]:
    others = _exchanged(server, _all_pairs(server))
    return others + tuple(_step(server, move) for part in parts(server) for move in unseen(server, part))


@functools.lru_cache(maxsize=20_000)
def _silent_in(server: Server, part: Part, asked: frozenset[int] | None = frozenset()) -> tuple[Step, ...]:
    return (*_urgent_in(server, part), *(_step(server, move) for move in dict.fromkeys(unseen(server, part, asked))))


def _silent_for(server: Server, focus: Focus) -> tuple[Step, ...]:
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


def _unowed(server: Server, at: Hashable, content: object, refs: Refs) -> tuple[str, ...] | Unowed:
    """What is wrong with a mission that is sent now: before its upstreams, to another robot, or twice."""
    link = server.link_of_topic(at)
    if link is None or not isinstance(content, LineContent) or content.kind != "mission":
        return ()
    known = [mission_of_uuid(server, ref) for ref in refs if ref is not None]
    if known:
        return _once_more([server.missions[index] for index in known if index >= 0])
    return _too_early(link, [one for one in server.missions if _says(content, one)])


def _once_more(meant: list[Mission]) -> tuple[str, ...] | Unowed:
    """Why a mission that was sent before is not due."""
    for one in meant:
        if one.status in ENDED:
            return Unowed((rules.SENT.id,), f"the mission with that uuid has ended, it is {_word(one.status)}")
        if one.sent:
            return Unowed((rules.SENT.id,), "the mission with that uuid was sent already")
    return ()


def _waits(own: list[Mission]) -> tuple[str, ...] | Unowed:
    """Why none of these missions of the robot is due, which are queued."""
    if all(one.ready for one in own):
        return (rules.SENT.id,)
    has = "failed" if all(one.doomed for one in own) else "not succeeded"
    return Unowed((rules.UPSTREAM.id, rules.SENT.id), f"an upstream of the mission with that configuration has {has}")


def _not_queued(meant: list[Mission]) -> Unowed:
    """Why none of these missions is due, of which none is queued."""
    ended = next((one for one in meant if one.status in ENDED and not one.sent), None)
    if ended is not None:
        return Unowed((rules.SENT.id,), f"the mission with that configuration has ended, it is {_word(ended.status)}")
    says = "was sent already, with another uuid" if meant else "was never accepted"
    return Unowed((rules.SENT.id,), f"a mission with that channel and that configuration {says}")


def _too_early(link: Link, meant: list[Mission]) -> tuple[str, ...] | Unowed:
    """Why none of these missions is due on a connection."""
    queued = [one for one in meant if one.queued]
    own = [one for one in queued if link.serves and one.robot == link.name]
    if own:
        return _waits(own)
    if any(one.status is Status.CANCELED and one.robot == link.name for one in meant):
        says = "the mission with that configuration was cancelled, since an upstream of it has failed"
        return Unowed((rules.CANCELED.id, rules.UPSTREAM.id), says)
    if not queued:
        return _not_queued(meant)
    robots = ", ".join(dict.fromkeys(repr(one.robot) for one in queued))
    whose = "has said no name" if link.name is None else f"is that of {link.name!r}"
    return Unowed((rules.UNNAMED.id,), f"the mission with that configuration is for {robots}, the connection {whose}")


def _word(status: Status) -> str:
    return {Status.ABORTED: "timed out", Status.CANCELED: "cancelled", Status.LOST: "lost"}.get(
        status, status.value.lower()
    )


def _says(content: LineContent, mission: Mission) -> bool:
    return (content.channel, content.what) == (mission.channel, mission.config)


_DELIVERY = Delivery(
    unowed=(rules.SENT.id,), unending=(rules.OTHER.id,), malformed=(rules.ENVELOPE.id,), every_time=True
)
"""What is broken by a line that nothing owes, by one that does not come, and by a connection that is ended."""


def _begins(server: Server) -> Server:
    """A server that has just begun: when in its first period the passes begin is not said."""
    return evolve(server, slow=PASS_PERIOD) if "b" in server.letters(AI_39) else server


def specification(operations: Mapping[str, Operation] = OPERATIONS, decided: int = UNCONSTRAINED) -> Spec:
    """The mission server with the rules of these operations, and with these readings decided from the start."""
    left = tuple(
        (one.id, "".join(letters))
        for one in sorted(AMBIGUITIES, key=lambda one: one.id)
        if len(letters := one.possible(decided)) < len(one.readings)
    )
    return Spec(
        system=SYSTEM_NAME,
        title="a mission server",
        initial=lambda world: _begins(
            Server(world.name_channel, left=left, tolerance=world.tolerance, unsteady=world.unsteady)
        ),
        operations=operations,
        outcomes=functools.partial(_outcomes, operations),
        drives=(
            Drive("connect", _connect),
            Drive("line", _line, impossible=(rules.NAMED.id,)),
            Drive(
                "disconnect",
                _disconnect,
                ends=True,
                impossible=(rules.DROPPED.id,),
                undriven=lambda world: evolve(world, unsteady=True),
            ),
            Drive("advance", _advance, later=later, elapses=elapses),
        ),
        urgent=_urgent,
        spontaneous=_spontaneous,
        silent_for=_silent_for,
        calmed=calmed,
        matches=matches,
        delivery=lambda _: _DELIVERY,
        closing=_closing,
        unopened=(rules.UNNAMED.id,),
        unowed=_unowed,
        sequence=sequence,
        names=_names,
        ambiguities=AMBIGUITIES,
        describe=describe,
        rules=RULES,
        charts=(LIFECYCLE,),
        invariants=INVARIANTS,
        possibilities=POSSIBILITIES,
        answers=agrees,
        abstraction=Abstraction(
            search_key=search_key,
            idle_search_key=idle_search_key,
            search_size=search_size,
            explore_size=explore_size,
            canonical=canonical,
        ),
        decided=functools.partial(specification, operations),
        rebuilt=specification,
    )


SPEC = specification()
