"""What happens to missions at the server: clocks, ends and their consequences, and what is sent next.

Every function takes a `Move` and gives the moves that it can lead to, each with the readings that it decided recorded
in its state.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.deciding import counts, split, ways
from missionfsm.isaac.server.independence import Part
from missionfsm.isaac.server.readings import (
    AI_03,
    AI_03_WHEN,
    AI_05,
    AI_06,
    AI_07,
    AI_08,
    AI_11,
    AI_12,
    AI_13,
    AI_15,
    AI_15_WHEN,
    AI_16_UNDER_WAY,
    AI_19,
    AI_24,
    AI_24_WHOLE,
    AI_31,
    AI_36,
    AI_39,
    AI_39_ORDER,
)
from missionfsm.isaac.server.state import (
    DAY,
    DOOM,
    DROP,
    FAILURES,
    LIFECYCLE,
    LOOK,
    RUN,
    SILENCE,
    SILENT,
    START,
    UNDER_WAY,
    WAITS,
    Clock,
    Link,
    Mission,
    Move,
    Sends,
    Server,
    Status,
)
from missionfsm.isaac.shared.line import MICROSECONDS

Moves = Iterator[Move]


def by(state: Server, due: int) -> int:
    """When something that is due at a moment is noticed at the latest, in microseconds."""
    return state.tolerance + (state.next_pass(due) if state.letters(AI_39) == "b" else due)


def looks(move: Move) -> Move:
    """AI-39 b has been decided: clocks that run may strike later than was thought."""
    missions = tuple(
        evolve(one, clocks=tuple(_later(move.state, clock) for clock in one.clocks)) if one.clocks else one
        for one in move.state.missions
    )
    return move.to(evolve(move.state, missions=missions))


def _later(state: Server, clock: Clock) -> Clock:
    """The clock of a server that looks now and then; whole seconds are looked at so anyway."""
    in_a_pass = clock.whole or clock.kind in (DROP, DOOM)
    return clock if clock.hi is None or in_a_pass else evolve(clock, hi=state.next_pass(clock.hi))


def started(move: Move, index: int, kind: str, since: str) -> Move:
    """A clock of a mission starts anew now, if the mission has that timeout and some reading that is left wants it."""
    mission = move.state.missions[index]
    time = {START: mission.start, RUN: mission.run, SILENT: SILENCE}[kind]
    if time is None:
        return move
    (low, high), tolerance = move.at, move.state.tolerance
    clocks = [one for one in mission.clocks if (one.kind, one.since) != (kind, since)]
    if counts(move.state, kind, since, whole=False):
        hi = None if kind == SILENT else by(move.state, time + high)
        clocks.append(Clock(kind, since, max(low, time + low - tolerance), hi))
    seconds = time // MICROSECONDS + 1
    if kind != SILENT and seconds < DAY and counts(move.state, kind, since, whole=True):
        whole = seconds * MICROSECONDS
        clocks.append(
            Clock(kind, since, max(low, whole + low - tolerance), whole + high + LOOK + tolerance, whole=True)
        )
    return _ticking(move, index, clocks)


def _ticking(move: Move, index: int, clocks: Iterable[Clock]) -> Move:
    ordered = tuple(sorted(clocks, key=lambda one: (one.kind, one.since, one.whole)))
    return move if ordered == move.state.missions[index].clocks else move.mission(index, clocks=ordered)


def stopped(move: Move, index: int, *kinds: tuple[str, str]) -> Move:
    """Clocks of a mission, each a kind and a beginning, run no more."""
    mission = move.state.missions[index]
    left = tuple(one for one in mission.clocks if (one.kind, one.since) not in kinds)
    return move if len(left) == len(mission.clocks) else move.mission(index, clocks=left)


_START_CLOCKS = tuple((START, since) for since in ("send", "submit", "ready", "connect"))


def becomes(move: Move, index: int, trigger: str) -> Move:
    """A mission moves on its chart."""
    after = LIFECYCLE.after(trigger, move.state.missions[index].status)
    assert after is not None, f"{trigger} is no move"  # noqa: S101 - callers look first
    return move.mission(index, status=after)


# Ends, and what follows from them.


def ends(move: Move, index: int, trigger: str, *because: str) -> Move:
    """A mission ends; those that wait for it wait no longer, or are doomed."""
    move = becomes(move, index, trigger).mission(index, clocks=())
    status = move.state.missions[index].status
    for other, mission in enumerate(move.state.missions):
        if index in mission.waits:
            doomed = mission.doomed
            if status in FAILURES or index in mission.fated:
                status_then = status if status in FAILURES else Status.FAILED
                doomed = tuple(sorted({*doomed, status_then}, key=lambda one: one.value))
            move = move.mission(other, waits=tuple(one for one in mission.waits if one != index), doomed=doomed)
            if move.state.missions[other].ready:
                move = started(move, other, START, "ready")
    return move.to(move.state, *because)


def cancellations(move: Move, part: Part) -> Moves:
    """A doomed mission is cancelled, or is found to wait (AI-03, AI-36); nothing where no mission is due.

    They make no difference to one another: the first comes first.
    """
    for index in part.missions:
        due = tuple(_cancellation(move, index))
        if due:
            yield from due
            return


def _cancellation(move: Move, index: int) -> Moves:
    mission = move.state.missions[index]
    if mission.status is not Status.QUEUED or not mission.doomed or any(one.kind == DOOM for one in mission.clocks):
        return
    yes, no = split(move, AI_03, _failures_that_cancel(mission))
    if yes is not None:
        now, later = split(yes, AI_36, "a") if mission.waits else (yes, None)
        at_once, noticed = (None, None) if now is None else split(now, AI_03_WHEN, "n")
        if at_once is not None:
            yield ends(at_once, index, "cancel", rules.CANCELED.id)
        soon, waits = (None, None) if noticed is None else split(noticed, AI_03_WHEN, "q")
        if soon is not None:
            yield _to_be_noticed(soon, index, DOOM)
        yield from (one for one in (waits, later) if one is not None and one is not move)
    if no is not None and no is not move:
        yield no


def _failures_that_cancel(mission: Mission) -> str:
    """The letters of AI-03 under which the upstreams that failed cancel a mission."""
    reported = Status.FAILED in mission.doomed
    direct = any(one is not Status.CANCELED for one in mission.doomed)
    return "a" + ("b" if reported else "") + ("c" if direct else "")


def lapses(state: Server, link: Link) -> list[Move]:
    """AI-03.when p: what becomes of a doomed mission that a scheduling pass finds first in an idle robot's queue."""
    if state.letters(AI_03_WHEN) != "p":
        return []
    own = [index for index, one in enumerate(state.missions) if one.robot == link.name]
    queue = [index for index in own if state.missions[index].status is Status.QUEUED]
    if not queue or not state.missions[queue[0]].doomed or busy(state, link):
        return []
    head = state.missions[queue[0]]
    move, _ = split(Move(state), AI_03, _failures_that_cancel(head))
    if move is not None and head.waits:
        move, _ = split(move, AI_36, "a")
    return [] if move is None else [ends(move, queue[0], "cancel", rules.CANCELED.id)]


# What is sent next.


def busy(state: Server, link: Link) -> set[str]:
    """The channels of the missions that keep a connection's robot busy."""
    apart = state.letters(AI_16_UNDER_WAY) == "m"  # what goes on on an older connection keeps nobody busy
    return {
        one.channel
        for one in state.missions
        if one.status in UNDER_WAY
        and one.robot == link.name
        and not (apart and one.link is not None and one.link != link.slot)
    }


def dispatches(move: Move, part: Part) -> Moves:
    """Every way to send a mission now to a robot that is there; where that is left to later, the decision alone.

    Robots make no difference to one another, unless they share missions that name none: the first comes first.
    """
    for link in move.state.links:
        if link.serves and link.name is not None and link.slot in part.slots:
            ways = tuple(dispatches_to(move, link))
            yield from ways
            if ways and "b" not in move.state.letters(AI_19):
                return


def dispatches_to(move: Move, link: Link) -> Moves:
    """Every way to send a mission on a connection now."""
    if any(one.robot is None and one.ready for one in move.state.missions):
        anybody, nobody = split(move, AI_19, "b")
        if anybody is not None and nobody is not None:
            yield anybody
            yield nobody
            return
    choices = list(_choices(move, link))
    # Where it is decided whether anything may be sent, that it may be is decided although nothing is sent yet.
    decides = any(index is None and chosen is not move for index, chosen in choices)
    for index, chosen in choices:
        if index is None:
            if chosen is not move:
                yield chosen
            continue
        now, later = split(chosen, AI_39, "a")
        if now is not None:
            yield from sends(now, link, index)
        if later is not None and later.state.letters(AI_39) != chosen.state.letters(AI_39):
            yield looks(later)
        elif later is not None and decides and later.state != move.state:
            yield later


def possible(state: Server, link: Link) -> list[tuple[int, Move]]:
    """What a server that looks now and then (AI-39 b) may send on a connection when it looks."""
    return [(index, chosen) for index, chosen in _choices(Move(state), link) if index is not None]


def _choices(move: Move, link: Link) -> Iterator[tuple[int | None, Move]]:
    """Missions that may be sent on a connection, each with what that decides; None for deciding to send nothing."""
    missions = move.state.missions
    own = [index for index, one in enumerate(missions) if one.robot == link.name]
    if "b" in move.state.letters(AI_19):
        own = [index for index, one in enumerate(missions) if one.robot in (link.name, None)]
    queue = [index for index in own if missions[index].status is Status.QUEUED]
    if not any(missions[index].ready for index in queue):
        return
    taken = busy(move.state, link)
    if not taken:
        yield from _from_free(move, queue)
        return
    apart = _lanes(missions, [index for index in queue if missions[index].channel not in taken])
    holding = "a" if any(missions[index].ready for lane in apart for index in lane) else "ac"
    held, several = split(move, AI_11, holding)
    if several is not None:
        for letter, way in ways(several, AI_11, "b", "c"):
            yield from _from_lane(way, queue) if letter == "b" else _from_lanes(way, apart)
    if held is not None:
        yield None, held


def _lanes(missions: tuple[Mission, ...], queue: list[int]) -> list[list[int]]:
    """The missions of a queue, those of each channel by themselves."""
    lanes: dict[str, list[int]] = {}
    for index in queue:
        lanes.setdefault(missions[index].channel, []).append(index)
    return list(lanes.values())


def _from_lanes(move: Move, lanes: list[list[int]]) -> Iterator[tuple[int | None, Move]]:
    """What may be sent of several queues that do not wait for one another."""
    missions = move.state.missions
    surely = any(missions[lane[0]].ready for lane in lanes)
    for lane in lanes:
        for index, way in _from_lane(move, lane):
            if index is not None or not surely:
                yield index, way


def _from_free(move: Move, queue: list[int]) -> Iterator[tuple[int | None, Move]]:
    """Nothing is under way: the queue as one, or (AI-11 c) by channels, where that makes a difference."""
    missions = move.state.missions
    lanes = _lanes(missions, queue)
    if len(lanes) == 1:
        yield from _from_lane(move, queue)
        return
    first = queue[0]
    if missions[first].ready:
        yield first, move
    found: dict[int | None, list[Move]] = {}
    whole, apart = split(move, AI_11, "ab")
    if whole is not None:
        for index, way in _from_lane(whole, queue):
            found.setdefault(index, []).append(way)
    if apart is not None:
        for index, way in _from_lanes(apart, lanes):
            found.setdefault(index, []).append(way)
    for index, moves in found.items():
        if index != first:
            yield from ((index, way) for way in dict.fromkeys(moves))


def _from_lane(move: Move, queue: list[int]) -> Iterator[tuple[int | None, Move]]:
    """Of missions in the order of submission: the first that is ready, or (AI-13 b) another that is."""
    missions = move.state.missions
    ready = [index for index in queue if missions[index].ready]
    if not ready:
        return
    overtakes, holds = (move, None) if ready[0] == queue[0] else split(move, AI_12, "a")
    if overtakes is not None:
        yield ready[0], overtakes
    if len(ready) > 1:
        any_order, _ = split(move, AI_13, "b")
        free = None if any_order is None else split(any_order, AI_12, "a")[0]
        if free is not None:
            yield from ((index, free) for index in ready[1:])
    if holds is not None:
        yield None, holds


def sends(move: Move, link: Link, index: int) -> Moves:
    """A mission is sent on a connection."""
    mission = move.state.missions[index]
    if mission.start == 0 and "a" in move.state.letters(AI_05):
        # Nothing can be acknowledged before no time has passed, so a server may as well not set the robot going.
        ours, _ = split(move, AI_05, "a")
        needs = None if ours is None else split(ours, AI_07, "ab")[0]
        needs = None if needs is None else split(needs, AI_24_WHOLE, "x")[0]
        if needs is not None:
            yield ends(needs, index, "time out", rules.ABORTED.id)
    if mission.robot is None:
        chosen, _ = split(move, AI_19, "b")
        if chosen is None:
            return
        move = chosen.mission(index, robot=link.name)
    move = becomes(move, index, "send").mission(index, link=link.slot, sent=True)
    for kind, since in ((START, "send"), (RUN, "send"), (RUN, WAITS)):
        move = started(move, index, kind, since)
    because = [rules.SENT.id, rules.UNNAMED.id]
    if mission.depends:
        because.append(rules.UPSTREAM.id)
    view = Sends(mission.channel, mission.config)
    yield move.emit(link.slot, index, view).to(move.state, *because)


def urgent(move: Move, part: Part) -> tuple[Move, ...]:
    """What follows from where things stand in a part of the server, one thing at a time."""
    due = tuple(cancellations(move, part))
    return due or tuple(dispatches(move, part))


# Clocks that strike.


def strikes(move: Move, index: int, clock: Clock) -> tuple[tuple[Move, ...], tuple[Move, ...]]:
    """Where a clock that is over aborts its mission, and where it means nothing (it runs no more)."""
    mission = move.state.missions[index]
    aborting: list[Move] = []
    meaningless: list[Move] = []

    def ask(here: Move | None, *questions: tuple[object, str]) -> None:
        """The answers to all questions have to be among the letters; the first that is not makes it meaningless."""
        for question, letters in questions:
            if here is None:
                return
            here, no = split(here, question, letters)  # type: ignore[arg-type]
            if no is not None:
                meaningless.append(no)
        if here is not None:
            aborting.append(here)

    if clock.kind == DROP:
        return tuple(_noticed(move, index)), ()
    if clock.kind == DOOM:
        return (ends(move, index, "cancel", rules.CANCELED.id),), ()
    unlike: Move | None = None
    if clock.kind != SILENT:
        alike, unlike = split(move, AI_24_WHOLE, "w" if clock.whole else "x")
        if alike is None:
            return (), (move,)
        move = alike
    if clock.kind == SILENT:
        ask(move, (AI_31, "a"))
    elif clock.kind == START:
        letter = {"send": "a", "submit": "b", "ready": "c", "connect": "d"}[clock.since]
        ask(move, (AI_05, letter), *(((AI_07, "ab"),) if mission.status is Status.STARTED else ()))
    elif clock.since == "send":
        by_send, not_by_send = split(move, AI_06, "b")
        if by_send is not None:
            aborting.append(by_send)
        ask(not_by_send, (AI_06, "a"), (AI_07, "c"))
    elif clock.since == WAITS:
        ask(move, (AI_06, "d"))
    elif clock.since == "status":
        ask(move, (AI_06, "a"), (AI_07, "ab"))
    else:
        ask(move, (AI_06, "c"))
    kind = (clock.kind, clock.since)
    return (
        tuple(one for here in aborting for one in aborted(here, index, clock.kind)),
        (*(stopped(here, index, kind) for here in meaningless), *(() if unlike is None else (unlike,))),
    )


def _noticed(move: Move, index: int) -> Moves:
    """A scheduling pass notices that the connection of a mission has dropped (AI-15.when p)."""
    for one in move.state.gone:
        if one.serves and one.name == move.state.missions[index].robot:
            move = forgotten(move, one)
    for letter, way in ways(move, AI_15, "c", "b"):
        here = stopped(way, index, (DROP, "drop"))
        yield ends(here, index, "lose") if letter == "c" else _again(here, index)


def aborted(move: Move, index: int, kind: str) -> Moves:
    """A mission is aborted; its robot is not told, or (AI-08 c) loses its connection."""
    because = {START: rules.ABORTED, RUN: rules.OVERRUN, SILENT: rules.SILENCE}[kind].id
    mission = move.state.missions[index]
    after = ends(move, index, "time out", because)
    link = None if mission.link is None else move.state.link(mission.link)
    if link is None and mission.status in UNDER_WAY:
        link = move.state.serving(mission.robot)
    if link is None or mission.status not in UNDER_WAY:
        yield after
        return
    quiet, closing = split(after, AI_08, "a")
    if quiet is not None:
        yield quiet
    if closing is not None:
        yield from closed(closing, link)


def untimed(move: Move, slot: int) -> Move:
    """What was sent on an older connection goes on there without its timeouts (AI-16.under-way m)."""
    for index, mission in enumerate(move.state.missions):
        if mission.status in UNDER_WAY and mission.link == slot:
            move = move.mission(index, start=None, run=None, clocks=())
    return move


# Connections that go.


def closed(move: Move, link: Link, *, seen: bool = False) -> Moves:
    """A connection is gone; `seen`: what is sent on it all the same may be seen."""
    state = move.state
    # A connection that took over from this one unnoticed took over from the one before, if that is still there.
    links = tuple(
        one if one.over != link.slot else evolve(one, over=link.over, fresh=one.fresh if link.over is not None else 0)
        for one in state.links
        if one.slot != link.slot
    )
    gone = state.gone
    if link.serves and "b" in state.letters(AI_39) and "s" in state.letters(AI_39_ORDER):
        until = state.next_pass(move.at[1]) + state.tolerance
        slot = link.slot if seen else min((0, *(one.slot for one in gone))) - 1
        gone = (*gone, Link(slot, link.name, serves=True, fresh=until))
    yield from lost(move.to(evolve(state, links=links, gone=gone)), link)


def in_vain(move: Move, gone: Link) -> Moves:
    """AI-39.order s: a pass sends on a connection that has dropped, and then notices that."""
    choices = _choices(move, gone) if move.state.letters(AI_39) == "b" else ()
    for index, chosen in choices:
        here, _ = (None, None) if index is None else split(forgotten(chosen, gone), AI_39_ORDER, "s")
        if index is None or here is None:
            continue
        for after in sends(here, gone, index):
            unheard = evolve(after, sent=move.sent)
            if after.state.missions[index].status is not Status.STARTED:
                yield unheard
                continue
            if gone.slot >= 0:
                unheard = after
            for letter, way in ways(unheard.mission(index, link=None), AI_15, "c", "a", "b"):
                if letter == "c":
                    yield ends(way, index, "lose")
                else:
                    yield way if letter == "a" else _again(way, index)


def forgotten(move: Move, gone: Link) -> Move:
    """A pass has noticed that a connection dropped."""
    rest = (evolve(one, serves=False) if one.slot == gone.slot else one for one in move.state.gone)
    return move.to(evolve(move.state, gone=tuple(one for one in rest if one.serves or one.slot >= 0)))


def lost(move: Move, link: Link) -> Moves:
    """A connection is no robot's any more: what was sent on it goes on, is sent again, or has failed (AI-15)."""
    missions = move.state.missions
    if link.serves:
        for index, mission in enumerate(missions):
            if mission.robot == link.name and mission.status is Status.QUEUED:
                move = stopped(move, index, (START, "connect"))
    affected = [index for index, one in enumerate(missions) if one.status in UNDER_WAY and _was_on(one, link)]
    if not affected:
        yield move
        return
    for letter, way in ways(move, AI_15, "c", "a", "b"):
        here: Move | None = way
        later: Move | None = None
        if letter != "a":
            here, later = split(way, AI_15_WHEN, "n")
        for index in affected:
            if later is not None:
                later = _to_be_noticed(later.mission(index, link=None), index, DROP)
            if here is not None and letter == "a":
                here = here.mission(index, link=None)
            elif here is not None and letter == "c":
                here = ends(here.mission(index, link=None), index, "lose")
            elif here is not None:
                here = _again(here, index)
        yield from (one for one in (here, later) if one is not None)


def _to_be_noticed(move: Move, index: int, kind: str) -> Move:
    """The next scheduling pass notices a drop or a failed upstream; one that is to come notices all."""
    low, high = move.at
    clocks = move.state.missions[index].clocks
    if any(one.kind == kind for one in clocks):
        return move
    if not move.state.tolerance:
        low += 1  # no pass comes while no time passes
    return _ticking(move, index, (*clocks, Clock(kind, kind, low, move.state.next_pass(high) + move.state.tolerance)))


def _was_on(mission: Mission, link: Link) -> bool:
    return mission.link == link.slot or (link.serves and mission.link is None and mission.robot == link.name)


def _again(move: Move, index: int) -> Move:
    move = becomes(move, index, "send again later").mission(index, link=None)
    gone = (
        (START, "send"),
        (START, "ready"),
        (START, "connect"),
        (RUN, "send"),
        (RUN, WAITS),
        (RUN, "status"),
        (SILENT, "status"),
        (DROP, "drop"),
    )
    return started(stopped(move, index, *gone), index, START, "ready")


def acknowledged(move: Move, index: int) -> Move:
    """RUNNING was reported: the start timeout is over, and the run timeout counts."""
    first = move.state.missions[index].status is Status.STARTED
    if first:
        move = stopped(becomes(move, index, "report running"), index, *_START_CLOCKS)
        move = started(move, index, RUN, "status")
    return started(move, index, SILENT, "status")


def zero_means(move: Move, *times: int | None) -> Iterator[tuple[str, Move]]:
    """AI-24: whether a timeout of 0 elapses at once or is none; not asked where no timeout is 0."""
    if 0 not in times:
        yield "a", move
    else:
        yield from ways(move, AI_24, "a", "b")


__all__ = ["Mission", "Moves", "urgent"]
