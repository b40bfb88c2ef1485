"""Missions that are run again: after a failure, or after a restart of the server. Works on the records; pure."""

from collections.abc import Callable, Iterable, Sequence

from missionfsm.isaac.runtime.missions import Snapshot, Status
from missionfsm.isaac.runtime.records import MissionRecord
from missionfsm.isaac.runtime.scheduler import Scheduler
from missionfsm.isaac.wire.messages import Uuid

_UNDER_WAY = (Status.STARTED, Status.RUNNING)


def runnable_again(scheduler: Scheduler, mission: MissionRecord) -> list[MissionRecord]:
    """A mission that failed and all that was cancelled because of it and can go now, upstreams first.

    Nothing where the mission itself has an upstream that failed.
    """

    def hopeful(upstream: Uuid) -> bool:
        found = scheduler.missions.get(upstream)
        return upstream in again or (found is not None and (not found.ended or found.status is Status.SUCCESS))

    again: dict[Uuid, MissionRecord] = {}
    if not mission.was_sent and not all(map(hopeful, mission.request.upstream)):
        return []
    again[mission.uuid] = mission
    for other in scheduler.missions.values():  # in the order of creation, which is one of the dependencies
        if other.status is not Status.FAILED_UPSTREAM or other.uuid in again:
            continue
        upstream = other.request.upstream
        if not again.keys().isdisjoint(upstream) and all(map(hopeful, upstream)):
            again[other.uuid] = other
    return list(again.values())


def run_again(scheduler: Scheduler, missions: Sequence[MissionRecord], attempt: Uuid) -> None:
    """Queue missions that have ended once more, the first of them under another identifier."""
    first = missions[0]
    scheduler.attempts.pop(first.attempt, None)
    scheduler.attempts[attempt] = first
    first.attempt = attempt
    for mission in missions:
        scheduler.unqueue(mission)
        _renew(mission)
    for mission in missions:
        _depend(scheduler, mission)
        if scheduler.profile.ai_04 == "b":
            scheduler.change(mission, Status.CREATED)
        scheduler.admit(mission)


def restore(
    scheduler: Scheduler, made: Iterable[tuple[MissionRecord, Snapshot]], resume: str, fresh: Callable[[], Uuid]
) -> None:
    """Put records that were made anew where their snapshots stood, see `MissionServerCore.restore`."""
    waiting: list[tuple[int, MissionRecord]] = []
    failed: list[MissionRecord] = []
    for mission, snapshot in made:
        mission.status = snapshot.status
        if snapshot.status.terminal:
            mission.number = snapshot.number
            mission.ended = True
            mission.was_sent = snapshot.status is not Status.FAILED_UPSTREAM
            scheduler.submitted = max(scheduler.submitted, snapshot.number + 1)
            continue
        _depend(scheduler, mission)
        if snapshot.status in _UNDER_WAY and resume == "fail":
            scheduler.enter(mission, snapshot.number)
            failed.append(mission)
        elif snapshot.number >= 0:
            waiting.append((snapshot.number, mission))
            if snapshot.status in _UNDER_WAY:
                scheduler.attempts.pop(mission.attempt, None)
                mission.attempt = fresh()
                scheduler.attempts[mission.attempt] = mission
    for number, mission in sorted(waiting, key=lambda one: one[0]):
        scheduler.admit(mission, number)
    for mission in failed:
        scheduler.finish(mission, Status.FAILED_DISCONNECTED)


def _renew(mission: MissionRecord) -> None:
    mission.waiting = 0
    mission.doomed = mission.ended = mission.was_sent = mission.acknowledged = mission.untimed = False
    mission.connection = None


def _depend(scheduler: Scheduler, mission: MissionRecord) -> None:
    for upstream in dict.fromkeys(mission.request.upstream):
        found = scheduler.missions.get(upstream)
        if found is not None:  # what was forgotten had succeeded
            scheduler.depend(mission, found)
