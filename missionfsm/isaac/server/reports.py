"""What statuses do that robots report, and which missions they are about. ``MissionSubmission › Mission Codelet``."""

from __future__ import annotations

from missionfsm.isaac.server import rules
from missionfsm.isaac.server.alike import one_of_each
from missionfsm.isaac.server.clocks import Moves
from missionfsm.isaac.server.deciding import split, ways
from missionfsm.isaac.server.lifecycle import acknowledged, ends
from missionfsm.isaac.server.readings import (
    AI_07,
    AI_09,
    AI_10,
    AI_10_FROM,
    AI_14_STATUS,
    AI_16_BACK,
    AI_18_EARLY,
    AI_39,
    AI_39_REPORTS,
)
from missionfsm.isaac.server.state import (
    DROP,
    ENDED,
    NOBODYS,
    UNDER_WAY,
    Link,
    Mission,
    Move,
    Report,
    Server,
    Status,
)

STATUS_CHANNEL = "mission_status"


def means_nothing(move: Move) -> Move:
    """A line changes nothing."""
    return move.to(move.state, rules.OTHER.id)


def reports(move: Move, link: Link, report: Report) -> Moves:
    """A status arrives on a connection; one that comes before its name may be kept (AI-18.early)."""
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
    yield from believed(move, link.slot, report)


def _could_matter(state: Server, report: Report) -> bool:
    meant = {report.named, report.header} - {None, NOBODYS}
    if not meant:
        return any(one.status in UNDER_WAY for one in state.missions)
    return any(state.missions[index].sent for index in meant if index is not None)


def believed(move: Move, slot: int, report: Report) -> Moves:
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


def _may_be_meant(state: Server, link: Link, index: int, *, anywhere: bool) -> bool:
    """Whether a status on a connection may be about a mission."""
    return index >= 0 and (_may_report(state, link, index) or (anywhere and _was_sent(state, index)))


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
        meant = tuple(index for index in found if _may_be_meant(move.state, link, index, anywhere=anywhere))
        targets[meant] = targets.get(meant, "") + letter
    for meant, letters in targets.items():
        way, _ = split(move, AI_10, letters)
        if way is None:
            continue
        after = [] if meant else [means_nothing(way)]
        # By the channel alone (AI-10 d) no uuid tells missions apart that are alike.
        for index in one_of_each(way.state, meant) if way.state.letters(AI_10) == "d" else meant:
            after += _on_channel(way, index, report)
        for one in after:
            yield from _heard_out(one, link, report)


def _heard_out(move: Move, link: Link, report: Report) -> Moves:
    """AI-08 d, e: how a mission ended that was aborted may be told in words that are about none, or about another."""
    yield move
    missions = move.state.missions
    lingering = [index for index, one in enumerate(missions) if one.lingers and one.robot == link.name]
    if lingering and report.status != "running":
        for index in lingering:
            move = move.with_mission(index, lingers="")
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
        yield from _happens(move, index, report) if report.channel == documented else (means_nothing(move),)
        return
    for letter, way in ways(move, AI_14_STATUS, "a", "b"):
        wanted = documented if letter == "a" else shipped
        yield from _happens(way, index, report) if report.channel == wanted else (means_nothing(way),)


def _happens(move: Move, index: int, report: Report) -> Moves:
    """What a status does to the mission that it is about."""
    mission = move.state.missions[index]
    if mission.status not in UNDER_WAY:
        yield from _late(move, index, mission, report)
    elif report.status == "running":
        yield _unlooked_at(acknowledged(move.to(move.state, rules.RUNNING.id), index), index, mission)
    else:
        heard, deaf = (move, None) if mission.status is Status.RUNNING else split(move, AI_07, "ac")
        if heard is not None:
            trigger = "report success" if report.status == "success" else "report failure"
            yield _unlooked_at(ends(heard, index, trigger, rules.FINAL.id), index, mission)
        if deaf is not None:
            yield means_nothing(deaf)


def _unlooked_at(move: Move, index: int, before: Mission) -> Move:
    """AI-39.reports: what is reported may be shown only once a scheduling pass has come."""
    letters = move.state.letters
    if (
        "b" not in letters(AI_39)
        or "b" not in letters(AI_39_REPORTS)
        or before.status is move.state.missions[index].status
    ):
        return move
    was = before.status if before.was is None else before.was[0]
    return move.with_mission(index, was=(was, move.state.next_pass(0) + move.state.tolerance, True))


def _late(move: Move, index: int, mission: Mission, report: Report) -> Moves:
    """A status of a mission that has ended, or that is queued again."""
    final = {"success": Status.SUCCESS, "failure": Status.FAILED}.get(report.status)
    move = move.to(move.state, rules.LATE.id)
    if final is not None and mission.lingers:
        move = move.with_mission(index, lingers="")
    if final is None or mission.status not in ENDED or mission.status is final:
        yield move
        return
    ignored, believed = split(move, AI_09, "ac" if mission.status is not Status.ABORTED else "a")
    if ignored is not None:
        yield ignored
    if believed is not None:
        yield believed.with_mission(index, status=final)
