"""Which mission goes to which robot, and when missions end."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

from connections import Connection, Connections
from dependencies import also_cancelled, is_free, is_lost, waiting_for
from limits import run_limit_at, start_limit_at
from mission import FAILURES, SECOND, Mission, Status
from variants import Variant
from wire import mission_lines

_GRACE = 10 * SECOND


class Dispatch:
    """The queues of all robots."""

    def __init__(
        self,
        missions: dict[int, Mission],
        connections: Connections,
        emit_line: Callable[[Connection, str], None],
        order: Iterator[int],
        messages: Iterator[int],
        variant: Variant,
    ) -> None:
        """Queues over the missions and connections given, which others add to."""
        self._missions = missions
        self._connections = connections
        self._emit_line = emit_line
        self._order = order
        self._messages = messages
        self._variant = variant
        self._stalled: set[str] = set()
        self._held: dict[str, Mission] = {}
        self._paused_until: dict[str, int] = {}
        self._marked_idle: set[str] = set()
        self._drops: dict[str, int] = {}
        self._never: set[int] = set()

    # limits

    def timed(self, mission: Mission) -> bool:
        """Whether limits are kept for the mission."""
        still = self._variant("completed-still-aborted") and mission.status is Status.SUCCESS
        return still or not mission.ended

    def limits(self) -> list[tuple[int, Mission]]:
        """The moments at which missions are aborted if nothing else happens, with the missions."""
        found: list[tuple[int, Mission]] = []
        sent = [mission for mission in self._missions.values() if mission.times_sent]
        last = max(sent, key=lambda mission: mission.sent_order, default=None)
        for mission in self._missions.values():
            if not self.timed(mission) or (self._variant("one-timer") and mission is not last):
                continue
            run_limit = mission.run_limit
            if self._variant("robot-limit-shared"):
                run_limit = next(other for other in self._missions.values() if other.robot == mission.robot).run_limit
            grace = None
            if self._variant("drop-has-grace") and mission.dropped_at is not None:
                grace = mission.dropped_at + _GRACE
            start, run = start_limit_at(mission, self._variant), run_limit_at(mission, run_limit, self._variant)
            found += [(time, mission) for time in (start, run, grace) if time is not None]
        return sorted(found, key=lambda entry: (entry[0], entry[1].handle))

    def delays(self, now: int) -> list[int]:
        """Moments after which something that waits for time alone may be done."""
        found = [time for time in self._paused_until.values() if time > now]
        if self._variant("cancel-after-second"):
            found += [
                mission.ended_at + SECOND
                for mission in self._missions.values()
                if mission.status in FAILURES and mission.ended_at + SECOND > now
            ]
        return found

    # ends

    def end(self, mission: Mission, status: Status, now: int) -> None:
        """A mission is over."""
        mission.status = status
        mission.ended_at = now
        mission.ended_order = next(self._order)
        mission.dropped_at = None
        reported_failure, aborted = status is Status.FAILED, status is Status.FAILED_TIMEDOUT
        stalling = {
            Status.FAILED: "stalls-after-failure",
            Status.FAILED_TIMEDOUT: "stalls-after-abort",
            Status.FAILED_DISCONNECTED: "stalls-after-drop",
        }
        if status in stalling and self._variant(stalling[status]):
            self._stalled.add(mission.robot)
        if aborted and self._variant("held-after-abort"):
            self._held[mission.robot] = mission
        if reported_failure and self._variant("pause-after-failure"):
            self._paused_until[mission.robot] = now + SECOND
        for other in also_cancelled(mission, list(self._missions.values()), self._variant):
            self.end(other, Status.FAILED_UPSTREAM, now)

    def retry(self, mission: Mission) -> None:
        """Queue a mission that is over once more, but not a third time."""
        if not mission.retried:
            mission.retried = True
            mission.status = Status.QUEUED

    def release(self, mission: Mission) -> None:
        """A robot reported the end of a mission that is over for the server."""
        if self._held.get(mission.robot) is mission:
            del self._held[mission.robot]

    def left(self, robot: str) -> None:
        """A robot's connection dropped."""
        self._drops[robot] = next(self._order)

    def arrived(self, connection: Connection, others: list[int], now: int) -> None:
        """A robot said its name; others of that name have the connections given."""
        robot = connection.name or ""
        self._held.pop(robot, None)
        for mission in self._missions.values():
            if mission.robot != robot:
                continue
            away = robot in self._drops and mission.submitted_order > self._drops[robot]
            if away and self._variant("away-missions-not-sent"):
                self._never.add(mission.handle)
            if mission.status is Status.SUCCESS and self._variant("return-replays"):
                self.send_lines(mission, connection, now)
            if not mission.active:
                continue
            adopted = self._variant("newer-adopts") and mission.connection in others
            if adopted or mission.dropped_at is not None:
                mission.connection = connection.number
                mission.dropped_at = None

    def cancel(self, now: int) -> bool:
        """Cancel what has lost an upstream and note what became free; whether anything changed."""
        changed = False
        for mission in list(self._missions.values()):
            if mission.status is not Status.QUEUED:
                continue
            if mission.ready_order is None and is_free(mission, self._variant):
                mission.ready_order = next(self._order)
            if self._variant("cancel-at-turn") or not is_lost(mission, self._variant):
                continue
            if self._variant("cancel-after-second"):
                failed = [other.ended_at for other in mission.upstream if other.status in FAILURES]
                if now < min(failed) + SECOND:
                    continue
            mission.cancel_level = 1 + max((other.cancel_level for other in mission.upstream), default=0)
            self.end(mission, Status.FAILED_UPSTREAM, now)
            if self._variant("cancel-marks-idle"):
                self._marked_idle.add(mission.robot)
            changed = True
        return changed

    # sending

    def send(self, now: int) -> bool:
        """Send what may go; whether anything changed."""
        changed = False
        for robot in dict.fromkeys(mission.robot for mission in self._missions.values()):
            connection = self._connections.serving(robot)
            if connection is None or not self._idle(robot, connection, now):
                continue
            mission = self._next(robot, connection)
            if mission is None:
                continue
            if self._variant("cancel-at-turn") and is_lost(mission, self._variant):
                self.end(mission, Status.FAILED_UPSTREAM, now)
            else:
                self._send(mission, connection, now)
            changed = True
        return changed

    def _idle(self, robot: str, connection: Connection, now: int) -> bool:
        variant = self._variant
        if robot in self._stalled or robot in self._held or self._paused_until.get(robot, now) > now:
            return False
        if variant("one-mission-a-connection") and connection.missions_sent:
            return False
        if variant("sent-all-at-once") or robot in self._marked_idle:
            return True
        active = [mission for mission in self._missions.values() if mission.active]
        if variant("sent-after-acknowledgement"):
            active = [mission for mission in active if mission.status is Status.STARTED]
        if variant("one-robot-at-a-time"):
            return not active
        return not any(mission.robot == robot for mission in active)

    def _next(self, robot: str, connection: Connection) -> Mission | None:
        variant = self._variant
        queue = [mission for mission in self._missions.values() if mission.robot == robot and self._in_queue(mission)]
        if variant("later-missions-not-sent"):
            queue = [mission for mission in queue if mission.submitted_order < connection.named_order]
        if variant("earlier-missions-not-sent"):
            queue = [mission for mission in queue if mission.submitted_order > connection.named_order]
        queue = [mission for mission in queue if mission.handle not in self._never]
        if variant("head-blocks"):
            queue = queue[:1]
        if variant("cancelled-blocks-queue"):
            queue = list(itertools.takewhile(lambda mission: mission.status is Status.QUEUED, queue))
        free = [mission for mission in queue if self._may_go(mission)]
        if variant("newest-first"):
            free.reverse()
        if variant("ready-order"):
            free.sort(key=lambda mission: mission.ready_order or 0)
        if variant("most-downstream-first"):
            free.sort(key=lambda mission: -waiting_for(mission, list(self._missions.values())))
        if variant("shortest-limit-first"):
            free.sort(key=lambda mission: float("inf") if mission.run_limit is None else mission.run_limit)
        return free[0] if free else None

    def _in_queue(self, mission: Mission) -> bool:
        if mission.status is Status.FAILED_UPSTREAM and not mission.times_sent:
            return self._variant("cancelled-still-sent") or self._variant("cancelled-blocks-queue")
        return mission.status is Status.QUEUED

    def _may_go(self, mission: Mission) -> bool:
        if mission.status is Status.FAILED_UPSTREAM:
            return self._variant("cancelled-still-sent")
        lost = self._variant("cancel-at-turn") and is_lost(mission, self._variant)
        return lost or is_free(mission, self._variant)

    def _send(self, mission: Mission, connection: Connection, now: int) -> None:
        if mission.status is Status.QUEUED:
            mission.status = Status.STARTED
        mission.connection = connection.number
        mission.sent_at = now
        mission.sent_order = next(self._order)
        mission.times_sent += 1
        connection.missions_sent += 1
        self._marked_idle.discard(mission.robot)
        self.send_lines(mission, connection, now)

    def send_lines(self, mission: Mission, connection: Connection, now: int) -> None:
        """Put a mission on the wire."""
        targets = [connection]
        if self._variant("sent-to-all"):
            targets = [other for other in self._connections.open_ones() if other.name is not None]
        for line in mission_lines(mission, next(self._messages), now, self._variant):
            for target in targets:
                self._emit_line(target, line)
