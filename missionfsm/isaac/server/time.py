"""Time that passes at the server: clocks strike, and what follows happens when they do.

An exact simulation over intervals: everything that is due has an earliest and a latest moment, and the order in which
things happen is any that these allow, in each part of the server by itself (`missionfsm.isaac.server.independence`).
Only what must have happened by the end is decided. What may have happened is left open: its clock says since when it
may have struck, its connection since when a pass may have come. It is decided when something is observed that tells of
it (`unseen`), or turns out not to have happened before (`nothing_open_happened`). Where all moments are exact, which
they are unless AI-39 is read as b, nothing is left open but what falls on the very end.
"""

from __future__ import annotations

import functools
import heapq
import itertools
import math
import operator
from collections.abc import Iterable, Iterator

from attrs import define, evolve, field

from missionfsm.isaac.server.connections import drops, inherited
from missionfsm.isaac.server.deciding import merged, split, unusual, ways
from missionfsm.isaac.server.dispatch import (
    downstream,
    in_vain,
    lapses,
    makes_no_difference,
    possible,
    sends,
    upstream_overdue,
    urgent,
)
from missionfsm.isaac.server.independence import Part, parts
from missionfsm.isaac.server.lifecycle import forgotten, settled, strikes, untimed
from missionfsm.isaac.server.readings import AI_16_UNDER_WAY, AI_39, AI_39_ORDER
from missionfsm.isaac.server.state import DROP, ENDED, PASS_PERIOD, Clock, Link, Mission, Move, Server
from missionfsm.isaac.shared.line import MICROSECONDS
from missionfsm.kernel.values import value

EVER = 10**15
"""Longer ago than anything happened, in microseconds."""

FEW = 8
"""Of so many ways, what falls on the very end of a time has happened rather than not; of more, it is left open."""

MANY = 64
"""More than so many ways in which time may pass are worked out one by one."""

ABOUT = MICROSECONDS
"""By how much the times that a log tells of its lines may be off, in microseconds. The tester's choice."""


@value(cache_hash=True)
class _Moment:
    """A moment on the way, in one part: what was done until then, and what the server has yet to look at.

    Attributes:
        low: the moment at the earliest.
        awaited: slots of connections for which a pass would do something, each with since when, at the earliest and at
            the latest.
    """

    move: Move
    low: int
    awaited: tuple[tuple[int, int, int], ...]


def passes(state: Server, time: int) -> Iterable[Move]:
    """Everything that may have become of a server when so many microseconds have passed.

    Where that is much, it is worked out as it is asked for, with what is read in its usual way first.
    """
    begins = [Move(state)]
    for part in parts(state):
        begins = [other for move in begins for after in _followed(move, part) for other in _in_order(after, part)]
    moves = _all_until(begins, state, time, due=False, most=MANY)
    if moves is None:
        return _one_by_one(begins, state, time)
    if any(_falls_on(move.state, time) for move in moves):  # it has happened rather than not
        moves = (_all_until(begins, state, time, due=True, most=FEW) or []) + moves
    return merged(_apart(moves, time))


def _one_by_one(begins: list[Move], state: Server, time: int) -> Iterator[Move]:
    """The same where it is much, one after the other."""

    def onwards(move: Move, left: tuple[Part, ...]) -> Iterator[Move]:
        if not left:
            yield move
            return
        for after in _until(move, left[0], time, due=False, usual_first=True):
            yield from onwards(after, left[1:])

    moves = (after for move in sorted(begins, key=_unusual) for after in onwards(move, parts(state)))
    yield from _apart(moves, time)


def _apart(moves: Iterable[Move], time: int) -> Iterator[Move]:
    """The moves at the end of a time, each once."""
    found: set[object] = set()
    for move in moves:
        after = _shifted(move, time)
        if (after.state, after.sent) not in found:
            found.add((after.state, after.sent))
            yield after


def _in_order(move: Move, part: Part) -> list[Move]:
    """AI-39.order is decided where a pass is about to send to a name that none need have taken up."""
    held = any(
        link.held[1] and link.slot in part.slots and _waits_for_pass(move.state, link) for link in move.state.links
    )
    return [way for _, way in ways(move, AI_39_ORDER, "n", "s")] if held else [move]


def _all_until(
    begins: list[Move], state: Server, time: int, *, due: bool, most: int | None = None
) -> list[Move] | None:
    """What may have become of all parts at a time; None where that is more than `most`."""
    moves = begins
    for part in parts(state):
        found = itertools.chain.from_iterable(_until(move, part, time, due=due) for move in moves)
        few = list(found if most is None else itertools.islice(found, most + 1))
        if most is not None and len(few) > most:
            return None
        moves = list(merged(few))
    return moves


def _falls_on(state: Server, time: int) -> bool:
    """Whether a clock that has not struck is due at this very moment at the latest."""
    return any(clock.hi == time for index in range(len(state.missions)) for clock in _counting(state, index))


def _counting(state: Server, index: int) -> tuple[Clock, ...]:
    """The clocks of a mission that may bring about anything yet."""
    mission = state.missions[index]
    return () if mission.overdue else mission.ticking


def _followed(move: Move, part: Part) -> list[Move]:
    """What follows at once in a part, at the moment of the move."""
    found: dict[Move, None] = {}
    todo = [move]
    while todo:
        here = todo.pop()
        follows = _urgent(here.state, here.at, part)
        if not follows:
            found[_tidy(here)] = None
        todo += [Move(one.state, here.sent + one.sent, here.rules + one.rules, one.at) for one in reversed(follows)]
    return list(found)


@functools.lru_cache(maxsize=50_000)
def _urgent(state: Server, at: tuple[int, int], part: Part) -> tuple[Move, ...]:
    return urgent(Move(state, at=at), part)


def _tidy(move: Move) -> Move:
    """The same with rules once each, and lines by connection: their order across connections means nothing."""
    return evolve(move, rules=tuple(sorted(set(move.rules))), sent=tuple(sorted(move.sent, key=lambda one: one[0])))


def _until(move: Move, part: Part, time: int, *, due: bool, usual_first: bool = False) -> Iterator[Move]:
    """What may have become of a part at a time, with all decided that must have happened by then.

    Args:
        due: whether a clock that must have struck by that very moment has; passes have come.
        usual_first: whether what is read in its usual way comes first.
    """
    todo = _ToDo(usual_first)
    todo.add([_moment(evolve(move, at=(0, 0)), -EVER, part, ())])
    for here in todo:
        strike, comes = _latest(here, part)
        if comes > time and (strike > time or (strike == time and not due)):
            since = {slot: first for slot, first, _ in here.awaited if first <= time}
            after = here.move
            for slot in part.slots:
                link = after.state.link_at(slot)
                if link is not None and link.pass_since != since.get(slot):
                    after = after.with_link(slot, pass_since=since.get(slot))
            yield evolve(after, at=(0, 0))
            continue
        todo.add(list(_next(here, part, int(min(strike, comes)))))


@define(eq=False)
class _ToDo:
    """Moments to go on from, each once: the first of those that were found last.

    Attributes:
        usual: whether those come before that which leave most questions to be read in their usual way.
    """

    usual: bool
    seen: set[_Moment] = field(factory=set)
    heap: list[tuple[int, int, _Moment]] = field(factory=list)
    added: int = 0

    def add(self, found: list[_Moment]) -> None:
        for one in reversed(found):
            order = _unusual(one.move) if self.usual else 0
            self.added += 1
            heapq.heappush(self.heap, (order, -self.added, one))

    def __iter__(self) -> Iterator[_Moment]:
        while self.heap:
            _, _, here = heapq.heappop(self.heap)
            if here not in self.seen:
                self.seen.add(here)
                yield here


def _unusual(move: Move) -> int:
    """How many questions cannot be read in their usual way any more."""
    return unusual(move.state.left)


def _moment(move: Move, low: int, part: Part, awaited: tuple[tuple[int, int, int], ...]) -> _Moment:
    """The moment after a move, with the passes that are waited for."""
    known = {slot: (first, last) for slot, first, last in awaited}
    found = []
    for slot in part.slots:
        link = move.state.link_at(slot)
        if link is not None and _waits_for_pass(move.state, link):
            first, last = known.get(slot, move.at)
            since = first if link.pass_since is None else min(first, -link.pass_since)
            found.append((slot, max(since, _held(move.state, link)), last))
    return _Moment(move, low, tuple(found))


def _waits_for_pass(state: Server, link: Link) -> bool:
    """Whether a scheduling pass would send something on a connection or cancel something for it."""
    later = _sends_later(state, link)
    return link.serves and bool((later and possible(state, link)) or lapses(state, link))


def _sends_later(state: Server, link: Link) -> bool:
    """Whether what can be sent on a connection is sent when the server looks."""
    return state.letters(AI_39) == "b" or state.lets_rest(link)


def _waits_quietly(state: Server, link: Link) -> bool:
    """Whether a pass may do something for a connection that sends nothing: cancel, or give up what has no time."""
    later = _sends_later(state, link)
    no_time = later and any(state.missions[index].start == 0 for index, _ in possible(state, link))
    return link.serves and bool(no_time or lapses(state, link))


def _held(state: Server, link: Link) -> int:
    """Before when no pass sends on a connection since none has taken up its name (AI-39.order s), in microseconds."""
    return link.held[0] - state.tolerance if link.held[0] and state.letters(AI_39_ORDER) == "s" else -EVER


def _pass(state: Server, slot: int, last: int) -> int:
    """Until when a scheduling pass has come for a connection that waits for one since a moment, in microseconds."""
    link = state.link_at(slot)
    if link is not None:
        last = max(last, link.held[1])
    return state.next_pass(last) + state.tolerance


def _in_vain(state: Server, part: Part) -> list[Link]:
    """The connections that dropped on which the pass that notices it may send before."""
    gone = [one for one in state.gone if one.serves and one.slot in part.slots]
    return [one for one in gone if state.letters(AI_39) == "b" and possible(state, one)]


def _overlooked(state: Server, part: Part) -> list[tuple[Link, Link]]:
    """The connections that were taken over, with those that did, of which the pass that notices it sends before."""
    if state.letters(AI_39) != "b" or "s" not in state.letters(AI_39_ORDER):
        return []
    pairs = [
        (evolve(older, serves=True), link)
        for link in state.links
        if link.slot in part.slots and link.over is not None and (older := state.link_at(link.over)) is not None
    ]
    return [(older, link) for older, link in pairs if possible(state, older)]


def _latest(here: _Moment, part: Part) -> tuple[float, float]:
    """Until when a clock has to have struck in a part, and a pass to have come, at the latest."""
    state = here.move.state
    due = (clock.hi for index in part.missions for clock in _counting(state, index) if clock.hi is not None)
    looks = [_pass(state, slot, last) for slot, _, last in here.awaited]
    looks += [gone.fresh for gone in _in_vain(state, part)]
    looks += [link.fresh for _, link in _overlooked(state, part)]
    return min(due, default=math.inf), min(looks, default=math.inf)


def _next(here: _Moment, part: Part, until: int) -> Iterator[_Moment]:
    """Everything that may happen next in a part, no later than `until`.

    What ends a mission and makes no difference to anything else until then may as well happen later: it is left open.
    Where it must have happened by then it comes first of all.
    """
    state = here.move.state
    found = [(index, one) for index in part.missions for one in _counting(state, index) if one.lo <= until]
    idle = [(index, one) for index, one in found if makes_no_difference(state, index, one, until)]
    for index, clock in idle:
        if clock.hi is not None and clock.hi <= until:
            yield from _ends_quietly(here, part, index, clock)
            return
    for index, clock in found:
        if (index, clock) not in idle:
            yield from _strike(here, part, index, clock, until)
    yield from _passes(here, part, until)
    yield from _unnoticed(here, part, until)


def _passes(here: _Moment, part: Part, until: int) -> Iterator[_Moment]:
    """A scheduling pass comes to a connection."""
    for slot, first, last in here.awaited:
        when = (max(here.low, first), min(_pass(here.move.state, slot, last), until))
        if when[0] <= when[1]:
            rest = tuple(one for one in here.awaited if one[0] != slot)
            for after in _after_pass(evolve(here.move, at=when), slot, part):
                yield _moment(after, when[0], part, rest)


def _unnoticed(here: _Moment, part: Part, until: int) -> Iterator[_Moment]:
    """Something is sent that reaches nobody, since no pass has noticed yet who is there; or a pass notices it."""
    state = here.move.state
    for gone in _in_vain(state, part):
        when = (here.low, max(here.low, min(gone.fresh, until)))
        for sent in in_vain(evolve(here.move, at=when), gone):
            yield from (_moment(after, when[0], part, here.awaited) for after in _followed(sent, part))
        if gone.fresh <= until:
            yield _moment(forgotten(here.move, gone), here.low, part, here.awaited)
    for older, link in _overlooked(state, part):
        when = (here.low, max(here.low, min(link.fresh, until)))
        for after in _sent_before(evolve(here.move, at=when), older, link):
            yield _moment(after, when[0], part, here.awaited)
        if link.fresh <= until:
            yield _moment(_taken_up(here.move, link), here.low, part, here.awaited)


def _sent_before(move: Move, older: Link, link: Link) -> Iterator[Move]:
    """A pass sends on a connection, and then takes up that another has taken over (AI-39.order s)."""
    for index, chosen in possible(move.state, older):
        here, _ = split(move.to(chosen.state), AI_39_ORDER, "s")
        if here is not None:
            for after in sends(here, older, index):
                yield _taken_up(after, link)


def _taken_up(move: Move, link: Link) -> Move:
    """A pass has noticed that a connection took over from another."""
    after = move.with_link(link.slot, over=None, fresh=0)
    if link.over is not None and move.state.letters(AI_16_UNDER_WAY) == "m":
        return untimed(after, link.over)
    return after


def _after_pass(move: Move, slot: int, part: Part) -> Iterator[Move]:
    """What a scheduling pass does for a connection at the moment of the move."""
    link = move.state.link_at(slot)
    if link is None:
        return
    here = move if link.pass_since is None else move.with_link(slot, pass_since=None)
    quiet = link.pass_since == 0
    link = evolve(link, pass_since=None)
    for lapsed in lapses(here.state, link):
        yield from _followed(Move(lapsed.state, here.sent, here.rules + lapsed.rules, here.at), part)
    rested = here.with_link(slot, rests=0) if link.rests else here
    for index, chosen in possible(rested.state, evolve(link, rests=0)) if _sends_later(here.state, link) else ():
        for after in sends(rested.to(chosen.state), link, index):
            if not quiet or len(after.sent) == len(here.sent):
                yield from _followed(after, part)


def _strike(here: _Moment, part: Part, index: int, clock: Clock, until: int) -> Iterator[_Moment]:
    low = max(here.low, clock.lo)
    when = (low, max(low, until if clock.hi is None else min(clock.hi, until)))
    due = clock.hi is not None and clock.hi <= until
    aborting, meaningless = strikes(evolve(here.move, at=when), index, clock, due=due)
    for one in aborting:
        for heard in inherited(here.move.state, one):
            yield from (_moment(after, low, part, here.awaited) for after in _followed(heard, part))
    if due:
        for one in meaningless:
            yield from (_moment(after, here.low, part, here.awaited) for after in _followed(one, part))


def _ends_quietly(here: _Moment, part: Part, index: int, clock: Clock) -> Iterator[_Moment]:
    """A clock has struck that makes no difference; how a mission has ended is left open where others are about it."""
    state = here.move.state
    mission = state.missions[index]
    held = bool(mission.waits or mission.doomed or downstream(state.missions, index))
    move = evolve(here.move, at=(clock.lo, clock.hi if clock.hi is not None else clock.lo))
    for one in (*(both := strikes(move, index, clock, due=True, held=held))[0], *both[1]):
        yield from (_moment(after, here.low, part, here.awaited) for after in _followed(one, part))


def _shifted(move: Move, time: int) -> Move:
    """The end of it: clocks say how much is left from here on."""
    missions = tuple(_with_clocks_shifted(one, time) for one in move.state.missions)
    after = evolve(_tidy(move), state=evolve(move.state, missions=missions), at=(0, 0))
    for link in move.state.links:
        if link.pass_since is not None:
            after = after.with_link(link.slot, pass_since=time - link.pass_since)
        if link.rests:
            after = after.with_link(link.slot, rests=max(0, link.rests - time))
        if link.fresh:
            after = _takeover_noticed(after, link, time)
        if link.held[1]:
            first, last = link.held
            after = after.with_link(link.slot, held=(max(0, first - time), max(0, last - time)))
    state = after.state
    if state.slow or state.gone:
        gone = tuple(_gone(one, time) for one in state.gone if one.fresh > time or (one.fresh and one.slot >= 0))
        after = after.to(evolve(state, slow=max(0, state.slow - time), gone=gone))
    return after


def _with_clocks_shifted(mission: Mission, time: int) -> Mission:
    """A mission whose clocks say how much is left so much later."""
    if mission.was is not None:
        status, left, fresh = mission.was
        mission = evolve(mission, was=(status, left - time, fresh and not time) if left > time else None)
    if not mission.clocks:
        return mission
    if mission.overdue:
        return _with_clocks_stopped(mission, time)
    clocks = (
        evolve(clock, lo=clock.lo - time, hi=None if clock.hi is None else max(0, clock.hi - time))
        for clock in mission.clocks
    )
    return evolve(mission, clocks=tuple(clocks))


def _with_clocks_stopped(mission: Mission, time: int) -> Mission:
    """A mission that has ended, nobody knows how: of its clocks only which came first matters, not how long ago."""
    latest = max(clock.lo for clock in mission.clocks)
    by = min(time, max(0, latest))
    clocks = (evolve(one, lo=one.lo - by, hi=None if one.hi is None else one.hi - by) for one in mission.clocks)
    return evolve(mission, clocks=tuple(clocks))


def _gone(link: Link, time: int) -> Link:
    """A connection that dropped, so much later; it is forgotten only later still: what was sent on it may be seen."""
    left = max(0, link.fresh - time)
    return evolve(link, fresh=left, serves=link.serves and left > 0)


def _takeover_noticed(move: Move, link: Link, time: int) -> Move:
    """A connection that took over from another, so much later: a pass has noticed it after a while."""
    if link.fresh <= time:
        return _taken_up(move, link)
    return move.with_link(link.slot, fresh=link.fresh - time)


def elapsed(state: Server, time: int | None, late: int | None) -> tuple[Move, ...]:
    """The server so much later as its log tells, or any time later: what is due may have happened, and need not.

    Where `late` is given, what is due for longer has happened, and clocks say since when they are over (`known`).
    """
    long = EVER if time is None else time
    if late is None:
        return (Move(_loosened(state, long, known=False)),)
    begins = [Move(state)]
    for part in parts(state):
        begins = [after for move in begins for after in _followed(move, part)]
    here = [evolve(move, state=_loosened(move.state, long, known=True)) for move in begins]
    return merged(after for move in here for after in _overdue(move, max(late, ABOUT)))


def _loosened(state: Server, time: int, *, known: bool) -> Server:
    """The server so much later, with nothing decided of what may have happened; `known` as in `elapsed`."""
    missions = (
        _with_clocks_loosened(one, time, known=known) if one.clocks or one.was else one for one in state.missions
    )
    links = tuple(_looked_after(state, link, time) for link in state.links)
    return evolve(state, missions=tuple(missions), links=links)


def _with_clocks_loosened(mission: Mission, time: int, *, known: bool) -> Mission:
    clocks = (
        evolve(
            clock,
            lo=clock.lo - time if clock.lo - time > ABOUT else min(clock.lo, 0),
            hi=clock.hi - time if known and clock.hi is not None else None,
        )
        for clock in mission.clocks
    )
    was = mission.was and (*mission.was[:2], False)
    return evolve(mission, clocks=tuple(clocks), was=was)


def _overdue(move: Move, late: int) -> Iterator[Move]:
    """The moves after all that is due for longer than that has happened."""
    seen: set[Move] = set()
    todo = [move]
    while todo:
        here = todo.pop()
        if here in seen:
            continue
        seen.add(here)
        follows = [after for part in parts(here.state) for after in _late(here, part, late)]
        if not follows:
            yield here
        todo += follows


def _late(here: Move, part: Part, late: int) -> Iterator[Move]:
    """What happens next in a part of what should have happened long ago: a clock strikes, a pass comes."""
    state = here.state
    for index, clock in _long_over(state, part, late):
        aborting, meaningless = strikes(evolve(here, at=(clock.lo, 0)), index, clock, due=True)
        struck = (*(heard for one in aborting for heard in inherited(state, one)),)
        for one in (*struck, *(_a_pass_later(other, index, clock) for other in meaningless)):
            yield from (_pass_due_since(state, after, part, late) for after in _followed(one, part))
    for slot in part.slots:
        link = state.link_at(slot)
        if link is not None and link.pass_since is not None and link.pass_since >= late + PASS_PERIOD:
            for one in _after_pass(evolve(here, at=(-link.pass_since, 0)), slot, part):
                yield _pass_due_since(state, one, part, late)


def _long_over(state: Server, part: Part, late: int) -> list[tuple[int, Clock]]:
    """The clocks of missions that were over so long ago; of those that make no difference the first is enough."""
    due = [
        (index, clock)
        for index in part.missions
        for clock in _counting(state, index)
        if clock.hi is not None and clock.hi <= -late
    ]
    return [one for one in due if not makes_no_difference(state, *one, 0)] or due[:1]


def _pass_due_since(before: Server, move: Move, part: Part, late: int) -> Move:
    """After something that was due long ago: a pass that was waited for still is; one for what follows may be over."""
    for slot in part.slots:
        link, was = move.state.link_at(slot), before.link_at(slot)
        if link is None:
            continue
        since = None if was is None or link.pass_since is None else was.pass_since
        look = (since or late) if _waits_for_pass(move.state, link) else None
        if look != link.pass_since:
            move = move.with_link(slot, pass_since=look)
    return evolve(move, at=(0, 0))


def _a_pass_later(move: Move, index: int, clock: Clock) -> Move:
    """A move in which a clock did not strike: if it runs on, it has to no later than a pass after it should have."""
    later = 0 if clock.hi is None else clock.hi + PASS_PERIOD
    clocks = (
        evolve(one, hi=later) if (one.kind, one.since, one.whole) == (clock.kind, clock.since, clock.whole) else one
        for one in move.state.missions[index].clocks
    )
    return move.with_mission(index, clocks=tuple(clocks))


def _looked_after(state: Server, link: Link, time: int) -> Link:
    """A connection for which a pass may have come within a time."""
    if not _waits_for_pass(state, link):
        return link
    return evolve(link, pass_since=min(EVER, time + (link.pass_since or 0)))


def unseen(state: Server, part: Part, asked: frozenset[int] | None = None) -> Iterator[Move]:
    """What may have happened in a part by now though it need not.

    Clocks that have struck, passes that have come, and where nobody says when they do, connections that have dropped.

    Args:
        asked: missions of which more is asked than what else happens; None: all of them.
    """
    yield from _unsaid(state, part, asked)
    if state.unsteady:
        for link in state.links:
            if link.slot in part.slots:
                yield from drops(Move(state), link, seen=True)


def _unsaid(state: Server, part: Part, asked: frozenset[int] | None) -> Iterator[Move]:
    for struck in _struck(state, part, asked):
        yield from (_pass_possible_since(after, part) for after in _followed(struck, part))
    for slot in part.slots:
        link = state.link_at(slot)
        if link is not None and link.pass_since is not None:
            for one in _after_pass(Move(state, at=(-link.pass_since, 0)), slot, part):
                yield _pass_possible_since(one, part)
    for gone in _in_vain(state, part):
        for one in in_vain(Move(state, at=(-PASS_PERIOD, 0)), gone):
            yield from (_pass_possible_since(after, part) for after in _followed(one, part))
    for older, link in _overlooked(state, part):
        yield from (
            _pass_possible_since(after, part) for after in _sent_before(Move(state, at=(-PASS_PERIOD, 0)), older, link)
        )


def _struck(state: Server, part: Part, asked: frozenset[int] | None) -> Iterator[Move]:
    """A clock has struck by now."""
    yield from _told_apart(state, part, asked)
    for index in part.missions:
        anyway = asked is None or index in asked
        for clock in _counting(state, index):
            if clock.lo <= 0 and (anyway or not makes_no_difference(state, index, clock, 0)):
                for one in strikes(Move(state, at=(clock.lo, 0)), index, clock, due=False)[0]:
                    yield from inherited(state, one)


def _told_apart(state: Server, part: Part, asked: frozenset[int] | None) -> Iterator[Move]:
    """How the first mission has ended of those of which that was left open and which tell something of the others."""
    missions = state.missions
    about = [index for index in part.missions if asked is None or index in asked]
    ended = {at for index in about for at in ((index,) if missions[index].overdue else ())}
    ended |= {at for index in about for at in upstream_overdue(missions, index)}
    if ended:
        yield from settled(Move(state), min(ended))


def _pass_possible_since(move: Move, part: Part) -> Move:
    """After something that happened unseen: a pass may have come since."""
    low = move.at[0]
    for slot in part.slots:
        link = move.state.link_at(slot)
        if link is None:
            continue
        look = None
        if _waits_for_pass(move.state, link) if low < 0 else _waits_quietly(move.state, link):
            look = -low if link.pass_since is None else min(link.pass_since, -low)
        if look != link.pass_since:
            move = move.with_link(slot, pass_since=look)
    return evolve(move, at=(0, 0))


def calmed(state: Server) -> Server:
    """The server once all has been seen that was sent: what was cancelled in a pass would not have been."""
    after = nothing_open_happened(state)
    for link in state.links:
        if link.pass_since is not None and _waits_quietly(after, link):
            after = Move(after).with_link(link.slot, pass_since=0).state
    return after


def nothing_open_happened(state: Server, only: tuple[Part, ...] | None = None) -> Server:
    """The server where nothing that is left open has happened before now, in some of its parts or in all.

    When a drop is noticed is left open: what follows may look as before.
    """
    if only is None:
        only = (Part(tuple(range(len(state.missions))), tuple(link.slot for link in state.links)),)
    missions, links = list(state.missions), list(state.links)
    for part in only:
        for index in part.missions:
            missions[index] = _none_struck(missions[index])
        links = [
            evolve(one, pass_since=None) if one.pass_since is not None and one.slot in part.slots else one
            for one in links
        ]
    unchanged = all(map(operator.is_, missions, state.missions)) and all(map(operator.is_, links, state.links))
    return state if unchanged else evolve(state, missions=tuple(missions), links=tuple(links))


def _none_struck(mission: Mission) -> Mission:
    """The mission of which no clock has struck before now."""
    if mission.status in ENDED or mission.overdue or not any(_may_have_struck(clock) for clock in mission.clocks):
        return mission
    clocks = (evolve(clock, lo=0) if _may_have_struck(clock) else clock for clock in mission.clocks)
    return evolve(mission, clocks=tuple(clocks))


def _may_have_struck(clock: Clock) -> bool:
    return clock.lo < 0 and clock.kind != DROP
