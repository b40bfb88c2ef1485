"""What missions owe to their upstreams."""

from __future__ import annotations

from mission import FAILURES, Mission, Status
from variants import Variant


def _considered(mission: Mission, variant: Variant) -> list[Mission]:
    upstream = mission.upstream
    if variant("upstream-ignored"):
        return []
    if variant("only-first-upstream"):
        return upstream[:1]
    if variant("only-last-upstream"):
        return upstream[-1:]
    if variant("newest-upstream-only"):
        return sorted(upstream, key=lambda other: other.handle)[-1:]
    if variant("third-upstream-ignored"):
        return upstream[:2]
    if variant("same-robot-upstream-ignored"):
        return [other for other in upstream if other.robot != mission.robot]
    if variant("other-robot-upstream-ignored"):
        return [other for other in upstream if other.robot == mission.robot]
    return upstream


def _forgiven(mission: Mission, other: Mission, variant: Variant) -> bool:
    """Whether a fault lets the failed upstream count as done."""
    forgiving = {
        Status.FAILED: "failed-upstream-counts",
        Status.FAILED_TIMEDOUT: "timed-out-upstream-counts",
        Status.FAILED_DISCONNECTED: "lost-upstream-counts",
        Status.FAILED_UPSTREAM: "cancelled-upstream-counts",
    }
    name = forgiving.get(other.status)
    if name is not None and variant(name):
        return True
    return variant("failure-before-submission-runs") and other.handle in mission.ended_before


def _done(mission: Mission, other: Mission, variant: Variant) -> bool:
    if other.status is Status.SUCCESS:
        return not (variant("success-before-submission-missed") and other.handle in mission.ended_before)
    if other.status is Status.RUNNING:
        return variant("running-upstream-suffices") or variant("sent-upstream-suffices")
    if other.status is Status.STARTED:
        return variant("sent-upstream-suffices")
    return _forgiven(mission, other, variant)


def _diamond(upstream: list[Mission]) -> bool:
    for place, one in enumerate(upstream):
        for other in upstream[place + 1 :]:
            if one is not other and any(shared in other.upstream for shared in one.upstream):
                return True
    return False


def is_free(mission: Mission, variant: Variant) -> bool:
    """Whether all upstreams have succeeded."""
    upstream = _considered(mission, variant)
    if variant("repeated-upstream-deadlocks") and len({other.handle for other in upstream}) < len(upstream):
        return False
    if upstream and variant("last-ended-decides"):
        last = max(upstream, key=lambda other: other.ended_order)
        return all(other.ended for other in upstream) and last.status is Status.SUCCESS
    done = [_done(mission, other, variant) for other in upstream]
    either = variant("any-upstream-suffices") or (variant("diamond-opens-early") and _diamond(upstream))
    if upstream and either:
        return any(done)
    return all(done)


def is_lost(mission: Mission, variant: Variant) -> bool:
    """Whether a failed upstream cancels the mission."""
    if variant("failed-upstream-unnoticed"):
        return False
    upstream = _considered(mission, variant)
    if variant("second-failure-unnoticed"):
        upstream = upstream[:1]
    failed = [other for other in upstream if other.status in FAILURES and not _forgiven(mission, other, variant)]
    if variant("abort-unnoticed"):
        failed = [other for other in failed if other.status is not Status.FAILED_TIMEDOUT]
    if variant("lost-unnoticed"):
        failed = [other for other in failed if other.status is not Status.FAILED_DISCONNECTED]
    if variant("cancel-spreads-two-levels"):
        failed = [other for other in failed if other.cancel_level < 2]
    if variant("cancel-does-not-spread"):
        failed = [other for other in failed if other.status is not Status.FAILED_UPSTREAM]
    if variant("cancel-when-all-ended") and not all(other.ended for other in upstream):
        return False
    if variant("last-ended-decides") and not all(other.ended for other in upstream):
        return False
    return bool(failed)


def waiting_for(mission: Mission, missions: list[Mission]) -> int:
    """How many missions that are not over name this one as their upstream."""
    return sum(1 for other in missions if not other.ended and mission in other.upstream)


def also_cancelled(mission: Mission, missions: list[Mission], variant: Variant) -> list[Mission]:
    """What a fault makes of a failure: queued missions that it cancels though they do not depend on it."""
    if mission.status is not Status.FAILED:
        return []
    queued = [other for other in missions if other.status is Status.QUEUED]
    if variant("failure-cancels-queue"):
        return [other for other in queued if other.robot == mission.robot]
    if variant("failure-cancels-siblings"):
        return [other for other in queued if any(shared in mission.upstream for shared in other.upstream)]
    return []
