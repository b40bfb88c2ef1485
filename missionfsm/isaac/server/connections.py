"""What connections bring: names and lines. ``MissionSubmission › Robot Identification``."""

from __future__ import annotations

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.clocks import Moves, started
from missionfsm.isaac.server.deciding import split, ways
from missionfsm.isaac.server.inputs import BAD, BLANK, FOREIGN, NAME, STATUS, Incoming
from missionfsm.isaac.server.losing import back, closed, lost, shared, unconnected, untimed, yet_to_be_seen
from missionfsm.isaac.server.readings import (
    AI_10,
    AI_10_FROM,
    AI_11,
    AI_16,
    AI_16_AGAIN,
    AI_16_BACK,
    AI_16_OLDER,
    AI_16_UNDER_WAY,
    AI_17,
    AI_17_UNDER_WAY,
    AI_25_TAKEN,
    AI_26,
    AI_26_BLANK,
    AI_27_TAKEN,
    AI_28_TAKEN,
    AI_29,
    AI_37,
    AI_37_EMPTY,
    AI_38,
    AI_39,
    AI_39_ORDER,
)
from missionfsm.isaac.server.reports import believed, means_nothing, reports
from missionfsm.isaac.server.state import ENDED, PASS_PERIOD, START, UNDER_WAY, Link, Move, Report, Server
from missionfsm.kernel.readings import Ambiguity


def connects(move: Move) -> Move:
    """Somebody connects."""
    slots = {one.slot for one in move.state.ends}
    free = next(slot for slot in range(len(slots) + 1) if slot not in slots)
    return move.to(evolve(move.state, links=(*move.state.links, Link(free))))


def drops(move: Move, link: Link, *, seen: bool = False) -> Moves:
    """A connection drops, or is ended by the server; `seen`: what is sent on it all the same may be seen."""
    waiting = any(one.robot == link.name and one.queued for one in move.state.missions)
    because = (rules.DROPPED.id,) if link.serves and waiting else ()
    for after in closed(move.to(move.state, *because), link, seen=seen):
        yield from _succeeded(after if seen else yet_to_be_seen(after, link, move.state), link)


def without(server: Server, link: Link) -> Server:
    """A server that has ended, without a connection."""
    return evolve(server, over=True, gone=(), links=tuple(one for one in server.links if one.slot != link.slot))


def is_over(move: Move, link: Link) -> Move | None:
    """The server ends, which is seen on a connection: once its missions are done, or at any time (AI-29)."""
    if move.state.over:
        return move.to(without(move.state, link))
    missions = move.state.missions
    here: Move | None = move
    if not missions or any(one.status not in ENDED for one in missions):
        here, _ = split(move, AI_29, "s")
    return None if here is None else here.to(without(here.state, link))


def _succeeded(move: Move, gone: Link) -> Moves:
    """Another connection that said the same name takes over, at once or when it says it again (AI-16.back)."""
    holder = None if gone.over is None else move.state.link_at(gone.over)
    if gone.serves and holder is not None and holder.name == gone.name:
        # The pass comes only now: it finds the older connection, and never knew of the newer.
        unnoticed, _ = split(move, AI_39, "b")
        if unnoticed is not None:
            yield from _served(unnoticed, holder)
    heirs = _heirs(move.state, gone)
    if not heirs:
        yield move
        return
    at_once, later = split(move, AI_16_BACK, "p")  # else not before it says it again, or never
    if at_once is not None:
        for heir in reversed(heirs):  # nobody says which of several, the newest or the one that said it last
            yield from _served(at_once, heir)
    if later is not None:
        yield later


def _heirs(server: Server, gone: Link) -> list[Link]:
    """The connections of which one may be the robot now: none, where there is one left that is it."""
    heirs = [one for one in server.links if one.name == gone.name and gone.name is not None]
    return [] if not gone.serves or any(one.serves for one in heirs) else heirs


def inherited(before: Server, move: Move) -> Moves:
    """A move that may have ended the connection of a robot, with what another of that name becomes then."""
    still = {one.slot for one in move.state.links if not one.closing}
    ended = [one for one in before.links if one.serves and one.slot not in still]
    if ended:
        yield from _succeeded(move, ended[0])
    else:
        yield move


def hears(move: Move, link: Link, heard: Incoming, named: int | None, header: int | None) -> Moves:
    """A line arrives on a connection; `named` and `header` as in `Report`."""
    if heard.garbled:
        # It need not be treated like the next one: no sentence is about it.
        yield from _unreadable(move, link, AI_26)
    if heard.kind == STATUS and not heard.named:
        yield from _closed_on_nobodys(move, link)
    for written, question in (
        (heard.numeric, AI_25_TAKEN),
        (heard.untyped, AI_27_TAKEN),
        (heard.odd, AI_28_TAKEN),
    ):
        taken, refused = split(move, question, "a") if written else (move, None)
        if refused is not None:
            yield from _unreadable(refused, link, AI_26)
        if taken is None:
            return
        move = taken
    if heard.kind == NAME and heard.channel == move.state.name_channel:
        yield from _says_name(move, link, heard.what)
    elif heard.kind == STATUS:
        yield from reports(move, link, Report(heard.what, heard.channel, named, header))
    elif heard.kind in (BAD, BLANK):
        yield from _unreadable(move, link, AI_26 if heard.kind == BAD else AI_26_BLANK)
    elif heard.kind == FOREIGN:
        yield from _passed_over(move, link, AI_38, "a")
    else:
        yield means_nothing(move)


def _closed_on_nobodys(move: Move, link: Link) -> Moves:
    """A status without a mission cannot be read by who goes by the one in the payload alone (AI-10 b, AI-26 f)."""
    nobodys, _ = split(move, AI_10, "b")
    closing = None if nobodys is None else split(nobodys, AI_26, "f")[0]
    if closing is not None:
        yield from drops(closing, link)


def _unreadable(move: Move, link: Link, question: Ambiguity) -> Moves:
    yield from _passed_over(move, link, question, "e")


def _passed_over(move: Move, link: Link, question: Ambiguity, letters: str) -> Moves:
    """A line means nothing where a question is read in one of these ways; where it is not, its connection is closed."""
    skipped, closing = split(move, question, letters)
    if skipped is not None:
        yield means_nothing(skipped)
    if closing is not None:
        yield from drops(closing, link)


# Names.


def _says_name(move: Move, link: Link, text: str) -> Moves:
    if text == text.strip():
        yield from _says_key(move, link, text)
        return
    for letter, way in ways(move, AI_37, "a", "b"):
        yield from _says_key(way, link, text if letter == "a" else text.strip())


def _says_key(move: Move, link: Link, key: str) -> Moves:
    """What a name does, its space taken away or not; one that is empty is none, or no robot's (AI-37.empty)."""
    if not key:
        none, nobodys = split(move, AI_37_EMPTY, "d")
        if none is not None:
            yield means_nothing(none)
        if nobodys is None:
            return
        move = nobodys
    yield from _named(move, link, key)


def _named(move: Move, link: Link, key: str) -> Moves:
    move = move.to(move.state, rules.NAMED.id)
    if link.serves and link.name != key:
        yield from _renamed(move, link, key)
    elif link.serves:
        yield move
    elif link.name is None:
        yield from _claims(move, link, key)
    elif link.name == key:
        there = move.state.serving(key) is not None
        again, never = split(move, AI_16_AGAIN, "u") if there else split(move, AI_16_BACK, "pqs")
        if again is not None:
            yield from _claims(again, link, key)
        if never is not None:
            yield never
    else:
        yield from _named_otherwise(move, link, key)


def _renamed(move: Move, link: Link, key: str) -> Moves:
    """A robot says another name: it keeps its own (AI-17), or takes the other, or loses its connection."""
    ignored, bound, closing = _other_name(move)
    if ignored is not None:
        yield ignored
    if closing is not None:
        yield from drops(closing, link)
    if bound is None:
        return
    under_way = any(one.status in UNDER_WAY and one.sent_on == link.slot for one in bound.state.missions)
    stays, dropping = split(bound, AI_17_UNDER_WAY, "k") if under_way else (None, bound)
    left = () if stays is None else (unconnected(stays, link),)
    for after in (*left, *(() if dropping is None else lost(dropping, link))):
        for free in _succeeded(after.with_link(link.slot, name=None, serves=False), link):
            yield from _claims(free, link, key)


def _other_name(move: Move) -> tuple[Move | None, Move | None, Move | None]:
    """AI-17: the move in which another name is ignored, the one in which it is taken, and where it closes."""
    ignored, rest = split(move, AI_17, "a")
    bound, closing = (None, None) if rest is None else split(rest, AI_17, "b")
    return ignored, bound, closing


def _named_otherwise(move: Move, link: Link, key: str) -> Moves:
    """It said a name that another connection has: it keeps that (AI-17), or has none (AI-16.back q)."""
    keeps, without = split(move, AI_16_BACK, "prs")
    if without is not None:
        yield from _claims(without, link, key)
    ignored, bound, closing = (None, None, None) if keeps is None else _other_name(keeps)
    if ignored is not None:
        yield ignored
    if closing is not None:
        yield from drops(closing, link)
    if bound is not None:
        yield from _claims(bound, link, key)


def _claims(move: Move, link: Link, key: str) -> Moves:
    """A connection that serves no robot says a name."""
    holder = move.state.serving(key)
    passes = "b" in move.state.letters(AI_39) and "s" in move.state.letters(AI_39_ORDER)
    move = move.with_link(link.slot, name=key, held=(PASS_PERIOD, move.state.next_pass(0)) if passes else (0, 0))
    if holder is None:
        yield from _served(move, link)
        return
    slots = [one.slot for one in move.state.links]
    newer = slots.index(link.slot) > slots.index(holder.slot)
    for letter, way in ways(move, AI_16, "a", "b", "d", "n", "s"):
        if letter == "n" and "b" in way.state.letters(AI_39):
            fresh = way.state.next_pass(way.at[1])
            yield from _takes_over(
                way.with_link(link.slot, over=holder.slot, fresh=fresh), link, holder, unnoticed=True
            )
        elif letter == "n" or (letter == "a" and newer):
            yield from _takes_over(way, link, holder)
        elif letter == "d":
            yield from (yet_to_be_seen(one, link, way.state) for one in closed(way, Link(link.slot)))
        elif letter == "s":
            yield from _served(way, link)
        else:
            yield from _stands_by(way, link)


def _stands_by(move: Move, link: Link) -> Moves:
    """A connection has said its name and is not the robot: what it said too early may be taken up (AI-10.from n, w)."""
    yield move
    found = move.state.link_at(link.slot)
    heard, _ = split(move, AI_10_FROM, "nw") if found is not None and found.early else (None, move)
    if heard is not None and found is not None:
        yield from _taken_up(heard.with_link(link.slot, early=()), link, found.early)


def _taken_up(move: Move, link: Link, early: tuple[Report, ...]) -> Moves:
    """Statuses that came before the name, and were kept, are heard."""
    moves = [move]
    for report in early:
        moves = [after for one in moves for after in believed(one, link.slot, report)]
    yield from moves


def _takes_over(move: Move, link: Link, holder: Link, *, unnoticed: bool = False) -> Moves:
    kept_open, closing = split(move, AI_16_OLDER, "v")
    if closing is not None:
        for after in closed(closing, holder):
            yield from _served(yet_to_be_seen(after, holder, closing.state), link)
    if kept_open is not None:
        yield from _displaces(kept_open, link, holder, unnoticed=unnoticed)


def _displaces(move: Move, link: Link, holder: Link, *, unnoticed: bool) -> Moves:
    """A connection becomes the robot in the place of another, which is kept."""
    displaced = move.with_link(holder.slot, serves=False)
    kept = _kept(move.state, holder)
    if not kept and not _carries(move.state, holder):
        yield from _served(displaced, link)
        return
    for letter, way in ways(displaced, AI_16_UNDER_WAY, "k", "l", "m", "n"):
        if letter == "k":
            yield from _served(way, link)
            if kept:
                yield from _served(_bound(way, holder), link)
        elif letter == "n":
            yield from _served(_adopted(way, holder, link), link)
        elif letter == "l":
            for after in lost(way, holder):
                yield from _served(after, link)
        else:
            yield from _served(_untied(way, holder) if unnoticed else untimed(way, holder.slot), link)


def _carries(server: Server, holder: Link) -> bool:
    """Whether a mission that was sent on a connection is under way, or keeps its robot busy."""
    return any((one.status in UNDER_WAY or one.lingers) and one.sent_on == holder.slot for one in server.missions)


def _kept(server: Server, holder: Link) -> bool:
    """Whether a mission of its robot is under way that outlived the connection on which it was sent."""
    return any(one.status in UNDER_WAY and one.sent_on is None and one.robot == holder.name for one in server.missions)


def _bound(move: Move, holder: Link) -> Move:
    """What outlived its connection has gone on on the one with which its robot was back, and stays there."""
    for index, mission in enumerate(move.state.missions):
        if mission.status in UNDER_WAY and mission.sent_on is None and mission.robot == holder.name:
            move = move.with_mission(index, sent_on=holder.slot)
    return move


def _adopted(move: Move, holder: Link, link: Link) -> Move:
    """What was sent on an older connection goes on on the newer one (AI-16.under-way n)."""
    for index, mission in enumerate(move.state.missions):
        if mission.sent_on == holder.slot:
            move = move.with_mission(index, sent_on=link.slot)
    return move


def _untied(move: Move, holder: Link) -> Move:
    """What was sent on an older connection may time out or not until a pass has noticed that another took over."""
    for index, mission in enumerate(move.state.missions):
        if mission.status in UNDER_WAY and mission.sent_on == holder.slot:
            move = move.with_mission(index, clocks=tuple(evolve(one, hi=None) for one in mission.clocks))
    return move


def _served(move: Move, link: Link) -> Moves:
    """A connection becomes the robot; what it said too early and was kept is taken up."""
    found = move.state.link_at(link.slot)
    assert found is not None, "the connection is open"  # noqa: S101 - callers have it from the state
    move = move.with_link(link.slot, serves=True, early=())
    there = shared(move.state, link, found.name)
    for index, mission in enumerate(move.state.missions):
        over = any(one.since == "connect" and (one.hi is None or one.hi < 0) for one in mission.clocks)
        if not (there or over) and mission.robot == found.name and mission.queued:
            move = started(move, index, START, "connect")
    for after in back(move, found.name):
        yield from _taken_up(_at_once(after, found.name), link, found.early)


def _at_once(move: Move, robot: str | None) -> Move:
    """AI-11 d: all that are ready for a robot now, when its connection is named, need not wait for one another."""
    ready = [at for at, one in enumerate(move.state.missions) if one.robot == robot and one.ready]
    if "d" in move.state.letters(AI_11):
        for index in ready:
            move = move.with_mission(index, at_once=True)
    return move
