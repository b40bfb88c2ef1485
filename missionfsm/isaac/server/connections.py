"""What connections bring: names, statuses, lines that mean nothing. ``MissionSubmission › Robot Identification``."""

from __future__ import annotations

from attrs import evolve

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.clocks import Moves, started
from missionfsm.isaac.server.deciding import split, ways
from missionfsm.isaac.server.inputs import BAD, FOREIGN, NAME, STATUS, Incoming
from missionfsm.isaac.server.lifecycle import acknowledged, back, closed, ends, lost, untimed
from missionfsm.isaac.server.readings import (
    AI_07,
    AI_09,
    AI_10,
    AI_10_FROM,
    AI_14_STATUS,
    AI_16,
    AI_16_AGAIN,
    AI_16_BACK,
    AI_16_OLDER,
    AI_16_UNDER_WAY,
    AI_17,
    AI_17_UNDER_WAY,
    AI_18_EARLY,
    AI_25_TAKEN,
    AI_26,
    AI_37,
    AI_37_EMPTY,
    AI_38,
    AI_39,
    AI_39_FAILED,
    AI_39_ORDER,
)
from missionfsm.isaac.server.state import (
    DROP,
    ENDED,
    NOBODYS,
    PASS_PERIOD,
    START,
    UNDER_WAY,
    Link,
    Mission,
    Move,
    Report,
    Server,
    Status,
)

STATUS_CHANNEL = "mission_status"


def connects(move: Move) -> Move:
    """Somebody connects."""
    slots = {one.slot for one in move.state.ends}
    free = next(slot for slot in range(len(slots) + 1) if slot not in slots)
    return move.to(evolve(move.state, links=(*move.state.links, Link(free))))


def drops(move: Move, link: Link, *, seen: bool = False) -> Moves:
    """A connection drops, or is ended by the server; `seen`: what is sent on it all the same may be seen."""
    waiting = any(one.robot == link.name and one.status is Status.QUEUED for one in move.state.missions)
    because = (rules.DROPPED.id,) if link.serves and waiting else ()
    for after in closed(move.to(move.state, *because), link, seen=seen):
        yield from _succeeded(after, link)


def _succeeded(move: Move, gone: Link) -> Moves:
    """Another connection that said the same name takes over, at once or when it says it again (AI-16.back)."""
    holder = None if gone.over is None else move.state.link_at(gone.over)
    if gone.serves and holder is not None and holder.name == gone.name:
        # The pass comes only now: it finds the older connection, and never knew of the newer.
        unnoticed, _ = split(move, AI_39, "b")
        if unnoticed is not None:
            yield from _served(unnoticed, holder)
    heirs = [one for one in move.state.links if one.name == gone.name and gone.name is not None]
    if not gone.serves or not heirs:
        yield move
        return
    at_once, later = split(move, AI_16_BACK, "p")  # q and r: not before it says it again, or never
    if at_once is not None:
        for heir in reversed(heirs):  # nobody says which of several, the newest or the one that said it last
            yield from _served(at_once, heir)
    if later is not None:
        yield later


def inherited(before: Server, move: Move) -> Moves:
    """A move that may have ended the connection of a robot, with what another of that name becomes then."""
    ended = [one for one in before.links if one.serves and move.state.link_at(one.slot) is None]
    if ended:
        yield from _succeeded(move, ended[0])
    else:
        yield move


def hears(move: Move, link: Link, heard: Incoming, named: int | None, header: int | None) -> Moves:
    """A line arrives on a connection; `named` and `header` as in `Report`."""
    if heard.numeric:
        taken, refused = split(move, AI_25_TAKEN, "a")
        if refused is not None:
            yield from _unreadable(refused, link)
        if taken is None:
            return
        move = taken
    if heard.kind == NAME and heard.channel == move.state.name_channel:
        yield from _says_name(move, link, heard.what)
    elif heard.kind == STATUS:
        yield from _reports(move, link, Report(heard.what, heard.channel, named, header))
    elif heard.kind == BAD:
        yield from _unreadable(move, link)
    elif heard.kind == FOREIGN:
        skipped, closing = split(move, AI_38, "a")
        if skipped is not None:
            yield _nothing(skipped)
        if closing is not None:
            yield from drops(closing, link)
    else:
        yield _nothing(move)


def _nothing(move: Move) -> Move:
    return move.to(move.state, rules.OTHER.id)


def _unreadable(move: Move, link: Link) -> Moves:
    skipped, closing = split(move, AI_26, "e")
    if skipped is not None:
        yield _nothing(skipped)
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
            yield _nothing(none)
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
        again, never = split(move, AI_16_AGAIN, "u") if there else split(move, AI_16_BACK, "pq")
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
    left = () if stays is None else (stays,)
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
    keeps, without = split(move, AI_16_BACK, "pr")
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
    for letter, way in ways(move, AI_16, "a", "b", "d", "n"):
        if letter == "n" and "b" in way.state.letters(AI_39):
            fresh = way.state.next_pass(way.at[1])
            yield from _takes_over(
                way.with_link(link.slot, over=holder.slot, fresh=fresh), link, holder, unnoticed=True
            )
        elif letter == "n" or (letter == "a" and newer):
            yield from _takes_over(way, link, holder)
        elif letter == "d":
            yield from closed(way, Link(link.slot))
        else:
            yield way


def _takes_over(move: Move, link: Link, holder: Link, *, unnoticed: bool = False) -> Moves:
    kept_open, closing = split(move, AI_16_OLDER, "v")
    if closing is not None:
        for after in closed(closing, holder):
            yield from _served(after, link)
    if kept_open is not None:
        yield from _displaces(kept_open, link, holder, unnoticed=unnoticed)


def _displaces(move: Move, link: Link, holder: Link, *, unnoticed: bool) -> Moves:
    """A connection becomes the robot in the place of another, which is kept."""
    displaced = move.with_link(holder.slot, serves=False)
    under_way = any(
        (one.status in UNDER_WAY or one.lingers) and one.sent_on == holder.slot for one in move.state.missions
    )
    kept = any(
        one.status in UNDER_WAY and one.sent_on is None and one.robot == holder.name for one in move.state.missions
    )
    if not under_way and not kept:
        yield from _served(displaced, link)
        return
    for letter, way in ways(displaced, AI_16_UNDER_WAY, "k", "l", "m", "n"):
        if letter == "k":
            yield from _served(way, link)
        elif letter == "n":
            yield from _served(_adopted(way, holder, link), link)
        elif letter == "l":
            for after in lost(way, holder):
                yield from _served(after, link)
        else:
            yield from _served(_untied(way, holder) if unnoticed else untimed(way, holder.slot), link)


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
    for index, mission in enumerate(move.state.missions):
        if mission.robot == found.name and mission.status is Status.QUEUED:
            move = started(move, index, START, "connect")
    moves = list(back(move, found.name))
    for report in found.early:
        moves = [after for one in moves for after in _believed(one, link.slot, report)]
    yield from moves


# Statuses.


def _reports(move: Move, link: Link, report: Report) -> Moves:
    if (
        not link.serves
        and (link.name is None or "q" in move.state.letters(AI_16_BACK))
        and _could_matter(move.state, report)
    ):
        ignored, kept = split(move, AI_18_EARLY, "a")
        if kept is not None:
            early = (*link.early, report) if report not in link.early else link.early
            yield kept.with_link(link.slot, early=early)
        if ignored is None:
            return
        move = ignored
    yield from _believed(move, link.slot, report)


def _could_matter(state: Server, report: Report) -> bool:
    meant = {report.named, report.header} - {None, NOBODYS}
    if not meant:
        return any(one.status in UNDER_WAY for one in state.missions)
    return any(state.missions[index].sent for index in meant if index is not None)


def _believed(move: Move, slot: int, report: Report) -> Moves:
    """What a status does, on whichever connections one is heard that names its mission (AI-10.from)."""
    link = move.state.link_at(slot)
    assert link is not None, "the connection is open"  # noqa: S101 - callers have it from the state
    own, anywhere = (move, None) if not _from_elsewhere(move.state, link, report) else split(move, AI_10_FROM, "r")
    if own is not None:
        yield from _matched(own, link, report, anywhere=False)
    if anywhere is not None:
        yield from _matched(anywhere, link, report, anywhere=True)


def _from_elsewhere(state: Server, link: Link, report: Report) -> bool:
    """Whether a status names a mission that was sent and is none of those that its connection may report on."""
    named = {report.named, report.header} - {None, NOBODYS}
    return any(_was_sent(state, one) and not _may_report(state, link, one) for one in named if one is not None)


def _was_sent(state: Server, index: int) -> bool:
    """Whether a mission was sent, and no drop of its connection has yet to be noticed."""
    mission = state.missions[index]
    return mission.sent and not any(one.kind == DROP for one in mission.clocks)


def _matched(move: Move, link: Link, report: Report, *, anywhere: bool) -> Moves:
    """What a status does, for each way in which it may be matched to a mission (AI-10)."""
    targets: dict[tuple[int, ...], str] = {}
    current = _current(move.state, link, report)
    by_payload = current if report.named is None else (report.named,)
    for letter, found in (
        ("a", by_payload),
        ("b", () if report.named is None else by_payload),
        ("c", () if report.header is None else (report.header,)),
        ("d", current),
    ):
        meant = tuple(
            index
            for index in found
            if index >= 0 and (_may_report(move.state, link, index) or (anywhere and _was_sent(move.state, index)))
        )
        targets[meant] = targets.get(meant, "") + letter
    for meant, letters in targets.items():
        way, _ = split(move, AI_10, letters)
        if way is None:
            continue
        after = [] if meant else [_nothing(way)]
        for index in meant:
            after += _on_channel(way, index, report)
        for one in after:
            yield from _heard_out(one, link, report)


def _heard_out(move: Move, link: Link, report: Report) -> Moves:
    """AI-08 d: how a mission ended that was aborted may be told in words that are about none, or about another."""
    yield move
    missions = move.state.missions
    lingering = [index for index, one in enumerate(missions) if one.lingers and one.robot == link.name]
    if lingering and report.status != "running":
        for index in lingering:
            move = move.with_mission(index, lingers=False)
        yield move


def _current(state: Server, link: Link, report: Report) -> tuple[int, ...]:
    """The missions under way that a status on a channel may be about if it names none."""
    return tuple(
        index
        for index, one in enumerate(state.missions)
        if one.status in UNDER_WAY
        and _may_report(state, link, index)
        and report.channel in (one.status_channel or STATUS_CHANNEL, one.status_channel or f"{one.channel}_status")
    )


def _may_report(state: Server, link: Link, index: int) -> bool:
    """Whether a connection is listened to about a mission: that of its robot, or the one that it was sent on."""
    mission = state.missions[index]
    if not _was_sent(state, index):
        return False
    elsewhere = (
        mission.sent_on is not None and mission.sent_on != link.slot and state.link_at(mission.sent_on) is not None
    )
    if link.serves and mission.robot == link.name:
        return not elsewhere or mission.status in ENDED
    return mission.sent_on == link.slot


def _on_channel(move: Move, index: int, report: Report) -> Moves:
    mission = move.state.missions[index]
    documented = mission.status_channel or STATUS_CHANNEL
    shipped = mission.status_channel or f"{mission.channel}_status"
    if documented == shipped:
        yield from _happens(move, index, report) if report.channel == documented else (_nothing(move),)
        return
    for letter, way in ways(move, AI_14_STATUS, "a", "b"):
        wanted = documented if letter == "a" else shipped
        yield from _happens(way, index, report) if report.channel == wanted else (_nothing(way),)


def _happens(move: Move, index: int, report: Report) -> Moves:
    """What a status does to the mission that it is about."""
    mission = move.state.missions[index]
    if mission.status not in UNDER_WAY:
        yield from _late(move, index, mission, report)
    elif report.status == "running":
        yield acknowledged(move.to(move.state, rules.RUNNING.id), index)
    else:
        heard, deaf = (move, None) if mission.status is Status.RUNNING else split(move, AI_07, "ac")
        if heard is not None:
            trigger = "report success" if report.status == "success" else "report failure"
            ended = ends(heard, index, trigger, rules.FINAL.id)
            yield ended if report.status == "success" else _rests(ended, mission)
        if deaf is not None:
            yield _nothing(deaf)


def _rests(move: Move, mission: Mission) -> Move:
    """AI-39.failed: a robot that has reported a failure may be given no other mission for a second."""
    link = move.state.serving(mission.robot)
    letters = move.state.letters
    if link is None or letters(AI_39) != "a" or "b" not in letters(AI_39_FAILED):
        return move
    return move.with_link(link.slot, rests=PASS_PERIOD)


def _late(move: Move, index: int, mission: Mission, report: Report) -> Moves:
    """A status of a mission that has ended, or that is queued again."""
    final = {"success": Status.SUCCESS, "failure": Status.FAILED}.get(report.status)
    move = move.to(move.state, rules.LATE.id)
    if final is not None and mission.lingers:
        move = move.with_mission(index, lingers=False)
    if final is None or mission.status not in ENDED or mission.status is final:
        yield move
        return
    ignored, believed = split(move, AI_09, "ac" if mission.status is not Status.ABORTED else "a")
    if ignored is not None:
        yield ignored
    if believed is not None:
        yield believed.with_mission(index, status=final)
