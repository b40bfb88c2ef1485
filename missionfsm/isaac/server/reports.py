"""What statuses do that robots report, and which missions they are about. ``MissionSubmission › Mission Codelet``."""

from __future__ import annotations

from collections.abc import Iterator

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
    """What a status does, on whichever connections one is heard (AI-10.from) and however it is matched (AI-10)."""
    link = move.state.link_at(slot)
    assert link is not None, "the connection is open"  # noqa: S101 - callers have it from the state
    found: dict[tuple[int, ...], dict[str, str]] = {}
    for heard, matched, meant in _meanings(move.state, link, report):
        matches = found.setdefault(meant, {})
        if matched not in matches.get(heard, ""):
            matches[heard] = matches.get(heard, "") + matched
    for meant, matches in found.items():
        same: dict[str, str] = {}
        for heard, letters in matches.items():
            same[letters] = same.get(letters, "") + heard
        for matched, letters in same.items():
            here, _ = split(move, AI_10_FROM, letters)
            way = None if here is None else split(here, AI_10, matched)[0]
            if way is not None:
                yield from _means(way, link, report, meant)


def _meanings(state: Server, link: Link, report: Report) -> Iterator[tuple[str, str, tuple[int, ...]]]:
    """The missions that a status is about, for each letter of AI-10.from and each of AI-10.

    Where any connection is heard of a mission that is named, nobody says which is heard of one that is not.
    """
    for heard, unnamed in (("r", "r"), ("n", "n"), ("w", "rn")):
        named, header = (
            () if one is None or not _may_report(state, link, one, heard) else (one,)
            for one in (report.named, report.header)
        )
        for where in unnamed:
            current = tuple(index for index in _current(state, report) if _may_report(state, link, index, where))
            yield heard, "a", current if report.named is None else named
            yield heard, "b", named
            yield heard, "c", header
            yield heard, "d", current


def _means(move: Move, link: Link, report: Report, missions: tuple[int, ...]) -> Moves:
    """What a status does that is about one of these missions, or about none."""
    after = [] if missions else [means_nothing(move)]
    # By the channel alone (AI-10 d) no uuid tells missions apart that are alike.
    for index in one_of_each(move.state, missions) if move.state.letters(AI_10) == "d" else missions:
        after += _on_channel(move, index, report)
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


def _current(state: Server, report: Report) -> tuple[int, ...]:
    """The missions under way that a status on a channel may be about if it names none."""
    return tuple(
        index
        for index, one in enumerate(state.missions)
        if one.status in UNDER_WAY
        and report.channel in (one.status_channel or STATUS_CHANNEL, one.status_channel or f"{one.channel}_status")
    )


def _may_report(state: Server, link: Link, index: int, letter: str) -> bool:
    """Whether a connection is listened to about a mission, as a letter of AI-10.from has it."""
    if index < 0 or not _was_sent(state, index):
        return False
    mission = state.missions[index]
    if letter == "w" or mission.sent_on == link.slot:
        return True
    if link.name is None or mission.robot != link.name:
        return False
    elsewhere = mission.sent_on is not None and state.link_at(mission.sent_on) is not None
    return letter == "n" or (link.serves and (not elsewhere or mission.status in ENDED))


def _was_sent(state: Server, index: int) -> bool:
    """Whether a mission was sent, and no drop of its connection has yet to be noticed."""
    mission = state.missions[index]
    return mission.sent and not any(one.kind == DROP for one in mission.clocks)


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
