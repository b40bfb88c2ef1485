"""What robots report about their missions."""

from __future__ import annotations

from collections.abc import Iterable

from mission import ACTIVE, Mission, Status
from variants import Variant
from wire import STATUS_TYPE, Received, read_uuid

_HALF = 2**64
_STATES = {"running": Status.RUNNING, "success": Status.SUCCESS, "failure": Status.FAILED}


def _uuid_matches(mission: Mission, uuid: int, variant: Variant) -> bool:
    if variant("report-upper-ignored"):
        return mission.uuid % _HALF == uuid % _HALF
    return mission.uuid == uuid


def _about(missions: list[Mission], connection: int, uuid: int, variant: Variant) -> Mission | None:
    """The mission that a report on that connection is about."""
    sent = [mission for mission in missions if mission.times_sent]
    if variant("report-to-last-sent"):
        return max(sent, key=lambda mission: mission.sent_order, default=None)
    if not variant("report-from-anywhere"):
        sent = [mission for mission in sent if mission.connection == connection]
    if variant("report-uuid-unchecked"):
        return next((mission for mission in sent if mission.active), None)
    found = next((mission for mission in sent if _uuid_matches(mission, uuid, variant)), None)
    if variant("late-report-hits-next") and found is not None and found.ended:
        return next((mission for mission in sent if mission.active), found)
    return found


def _on_its_channel(mission: Mission, channel: str, variant: Variant) -> bool:
    if variant("report-on-any-channel"):
        return True
    if variant("report-channel-fixed"):
        return channel == "mission_status"
    return channel == mission.status_channel


def _state(received: Received, variant: Variant) -> Status | None:
    word = received.payload.get("missionStatus")
    if not isinstance(word, str):
        return None
    state = _STATES.get(word.lower() if variant("report-any-case") else word)
    if state is Status.FAILED and variant("failure-as-success"):
        return Status.SUCCESS
    return state


def _counts(mission: Mission, state: Status, variant: Variant) -> bool:
    """Whether a report of that state changes the mission."""
    if mission.status not in ACTIVE:
        if state is Status.RUNNING:
            return variant("running-reopens") and mission.ended
        if state is Status.FAILED:
            return variant("failure-overrides-success") and mission.status is Status.SUCCESS
        if mission.status is Status.FAILED_TIMEDOUT:
            return variant("success-reopens-abort")
        return variant("success-overrides-failure") and mission.status is Status.FAILED
    if mission.status is Status.STARTED:
        if state is Status.SUCCESS:
            return not variant("success-needs-running")
        if state is Status.FAILED:
            return not variant("failure-needs-running") and not variant("failure-ignored")
        return not variant("running-ignored")
    return not (state is Status.FAILED and variant("failure-ignored"))


def reported(
    received: Received, connection: int, missions: Iterable[Mission], variant: Variant
) -> tuple[Mission, Status, bool] | None:
    """The mission that a line is about, the state that it reports and whether that changes the mission."""
    if not received.may_be(STATUS_TYPE, variant):
        return None
    state = _state(received, variant)
    uuid = read_uuid(received.payload.get("uuid"), variant)
    if state is None or uuid is None:
        return None
    mission = _about(list(missions), connection, uuid, variant)
    if mission is None or not _on_its_channel(mission, received.channel, variant):
        return None
    return mission, state, _counts(mission, state, variant)
