"""When the limits of a mission strike."""

from __future__ import annotations

from mission import SECOND, Mission, Status
from variants import Variant

_DAY = 86_400 * SECOND


def _whole(time: int) -> int:
    return -(-time // SECOND) * SECOND


def _strikes(since: int, limit: int, variant: Variant) -> int | None:
    if variant("day-wraps") and limit >= _DAY:
        return None
    if variant("limit-rounded-up"):
        limit = _whole(limit)
    if variant("limit-whole-seconds-exceeded"):
        limit = (limit // SECOND + 1) * SECOND
    if variant("limit-strictly-after") or (variant("limit-zero-waits") and limit == 0):
        limit += 1
    if variant("limits-every-second") or variant("pass-every-second"):
        return _whole(since + limit)
    return since + limit


def start_limit_at(mission: Mission, variant: Variant) -> int | None:
    """The moment at which the mission is aborted if it has not been acknowledged."""
    limit = mission.run_limit if variant("limits-swapped") else mission.start_limit
    if limit is None or variant("start-limit-ignored"):
        return None
    if variant("start-limit-in-minutes"):
        limit *= 60
    if variant("start-limit-from-submission"):
        waiting = mission.status in (Status.QUEUED, Status.STARTED)
        return _strikes(mission.submitted_at, limit, variant) if waiting else None
    if variant("start-limit-as-heartbeat") and mission.status is Status.RUNNING:
        return _strikes(mission.heard_at, limit, variant)
    if variant("acknowledged-still-aborted") and mission.status is Status.RUNNING:
        return _strikes(mission.sent_at, limit, variant)
    return _strikes(mission.sent_at, limit, variant) if mission.status is Status.STARTED else None


def run_limit_at(mission: Mission, run_limit: int | None, variant: Variant) -> int | None:
    """The moment at which the mission is aborted if it has not been completed."""
    limit = mission.start_limit if variant("limits-swapped") else run_limit
    if limit is None or variant("run-limit-ignored"):
        return None
    if variant("run-limit-in-milliseconds"):
        limit //= 1000
    if variant("run-limit-doubled"):
        limit *= 2
    if variant("run-limit-from-submission"):
        return _strikes(mission.submitted_at, limit, variant) if mission.active else None
    if variant("run-limit-from-sending"):
        return _strikes(mission.sent_at, limit, variant) if mission.active else None
    running = mission.status is Status.RUNNING
    if variant("completed-still-aborted") and mission.status is Status.SUCCESS:
        running = mission.running_at >= mission.sent_at
    return _strikes(mission.running_at, limit, variant) if running else None
