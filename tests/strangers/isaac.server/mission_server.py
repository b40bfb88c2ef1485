"""The mission server: submission, connections, reports and the passing of time."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import Any

from connections import Connection, Connections
from dispatch import Dispatch
from mission import FAILURES, SECOND, Mission, Status
from reports import reported
from submission import Submission
from variants import Variant
from wire import TEXT_TYPE, Received, new_uuid, read_line, text_lines

Emit = Callable[[str, dict[str, Any]], None]
"""Tells the outside what was sent (`line`) and what was ended (`closed`)."""


class Numbers:
    """Handles, connections and messages, counted over the whole process."""

    def __init__(self) -> None:
        """Nothing counted yet."""
        self.missions: Iterator[int] = itertools.count(1)
        self.connections: Iterator[int] = itertools.count(1)
        self.messages: Iterator[int] = itertools.count(1)


class MissionServer:
    """One mission server; its clock stands still but for `advance`."""

    def __init__(self, name_channel: str, numbers: Numbers, emit: Emit, variant: Variant) -> None:
        """A server without missions and connections, at time zero."""
        self._name_channel = "name" if variant("name-channel-fixed") else name_channel
        self._numbers = numbers
        self._emit = emit
        self._variant = variant
        self._now = 0
        self._order = itertools.count(1)
        self._missions: dict[int, Mission] = {}
        self._connections = Connections(variant)
        self._dispatch = Dispatch(
            self._missions, self._connections, self._emit_line, self._order, numbers.messages, variant
        )
        self._waiting: list[Callable[[], None]] = []
        self._first_runs: dict[str, int] = {}
        self._unseen = False
        self._stopped = False

    def submit(self, request: Any) -> int:
        """Queue a mission and return its handle, or raise MissionRefused."""
        checked = Submission(request, self._missions, self._variant)
        handle = next(self._numbers.missions)
        seed = f"mission {handle}"
        if self._variant("uuid-from-content"):
            seed = f"{checked.robot} {checked.config}"
        self._missions[handle] = Mission(
            handle=handle,
            robot=checked.robot,
            channel=checked.channel,
            status_channel=checked.status_channel,
            config=checked.config,
            start_limit=checked.start_limit,
            run_limit=checked.run_limit,
            upstream=checked.upstream,
            uuid=new_uuid(seed),
            submitted_at=self._now,
            submitted_order=next(self._order),
            ended_before=frozenset(mission.handle for mission in self._missions.values() if mission.ended),
        )
        self._changed()
        return handle

    def statuses(self) -> dict[int, str]:
        """The status of every mission as shown to the outside."""
        return {handle: self._shown(mission) for handle, mission in self._missions.items()}

    def _shown(self, mission: Mission) -> str:
        variant, status = self._variant, mission.status
        plain = {
            Status.FAILED_TIMEDOUT: "time-out-shows-failed",
            Status.FAILED_UPSTREAM: "cancel-shows-failed",
            Status.FAILED_DISCONNECTED: "drop-shows-failed",
        }
        if status in plain and variant(plain[status]):
            return Status.FAILED.value
        if status is Status.STARTED and variant("shown-running-early"):
            return Status.RUNNING.value
        waits = any(other.status is not Status.SUCCESS for other in mission.upstream)
        if status is Status.QUEUED and waits and variant("waiting-shows-created"):
            return Status.CREATED.value
        return status.value

    def connect(self) -> int:
        """A robot connects; the connection's number."""
        connection = self._connections.add(next(self._numbers.connections), self._now)
        if self._variant("greets"):
            self._send_text(connection, "")
        self._changed()
        return connection.number

    def disconnect(self, number: int) -> bool:
        """A connection drops; false where it is not open."""
        connection = self._connections.get(number)
        if connection is None:
            return False
        connection.open = False
        self._notice(lambda: self._dropped(connection))
        return True

    def line(self, number: int, line: str) -> bool:
        """A robot sends a line; false where the connection is not open."""
        connection = self._connections.get(number)
        if connection is None:
            return False
        if connection.deaf or self._stopped:
            return True
        if self._variant("any-line-restarts-start"):
            for mission in self._missions.values():
                if mission.connection == number and mission.status is Status.STARTED:
                    mission.sent_at = self._now
        received = read_line(line)
        if received is None:
            self._unreadable(connection)
        elif self._is_name(received):
            name = self._connections.spoken(str(received.payload["text"]))
            self._notice(lambda: self._named(connection, name))
        else:
            self._report(received, connection)
        return True

    def advance(self, time: int) -> None:
        """Let time pass, in nanoseconds."""
        end = self._now + time
        while not self._stopped:
            due = self._next_due()
            if due is None or due > end:
                break
            self._now = max(self._now, due)
            self._work(self._now % SECOND == 0)
        self._now = end

    # the course of time

    def _next_due(self) -> int | None:
        due = [time for time, _ in self._dispatch.limits()]
        due += [time for time, _ in self._connections.patience_ends()]
        due += self._dispatch.delays(self._now)
        passes = self._variant("pass-every-second")
        if passes:
            due = [-(-time // SECOND) * SECOND for time in due]
        if self._unseen and (passes or self._variant("sends-every-second")):
            due.append((self._now // SECOND + 1) * SECOND)
        return min(due, default=None)

    def _changed(self) -> None:
        self._work(False)

    def _notice(self, what: Callable[[], None]) -> None:
        self._waiting.append(what)
        self._changed()

    def _work(self, in_pass: bool) -> None:
        """Do all that is due now; some of it only in a pass at a whole second."""
        if self._variant("pass-every-second") and not in_pass:
            self._unseen = True
            return
        sending = in_pass or not self._variant("sends-every-second")
        self._unseen = not sending
        busy = True
        while busy and not self._stopped:
            busy = False
            while self._waiting:
                self._waiting.pop(0)()
                busy = True
            for time, mission in self._dispatch.limits():
                if time <= self._now and self._dispatch.timed(mission):
                    self._abort(mission)
                    busy = True
            for time, connection in self._connections.patience_ends():
                if time <= self._now:
                    self._close(connection)
                    busy = True
            busy |= self._dispatch.cancel(self._now)
            busy |= sending and self._dispatch.send(self._now)

    def _abort(self, mission: Mission) -> None:
        variant = self._variant
        if variant("abort-counts-as-success") and mission.status is Status.RUNNING:
            self._dispatch.end(mission, Status.SUCCESS, self._now)
            return
        unacknowledged = mission.status is Status.STARTED
        lost = mission.dropped_at is not None and variant("drop-has-grace")
        grace_over = lost and self._now >= (mission.dropped_at or 0) + 10 * SECOND
        self._dispatch.end(mission, Status.FAILED_DISCONNECTED if grace_over else Status.FAILED_TIMEDOUT, self._now)
        if variant("abort-sends-again") and unacknowledged:
            self._dispatch.retry(mission)
        connection = self._connections.get(mission.connection) if mission.connection is not None else None
        if variant("abort-closes") and connection is not None:
            self._close(connection)

    # connections

    def _emit_line(self, connection: Connection, line: str) -> None:
        if connection.open:
            self._emit("line", {"connection": connection.number, "line": line})

    def _send_text(self, connection: Connection, text: str) -> None:
        number = next(self._numbers.messages)
        for line in text_lines(self._name_channel, text, number, self._now, self._variant):
            self._emit_line(connection, line)

    def _close(self, connection: Connection) -> None:
        connection.open = False
        self._emit("closed", {"connection": connection.number})
        self._waiting.append(lambda: self._dropped(connection))

    def _unreadable(self, connection: Connection) -> None:
        if self._variant("rubbish-stops-server"):
            self._stopped = True
        if self._variant("rubbish-closes"):
            self._close(connection)
            self._changed()

    def _is_name(self, received: Received) -> bool:
        on_channel = received.channel == self._name_channel or self._variant("name-on-any-channel")
        text = isinstance(received.payload.get("text"), str)
        return on_channel and text and received.may_be(TEXT_TYPE, self._variant)

    def _named(self, connection: Connection, name: str) -> None:
        variant = self._variant
        if not connection.open or (not name and not variant("empty-name-taken")):
            return
        if connection.name is not None and not self._named_again(connection, name):
            return
        others = [other for other in self._connections.named(name) if other is not connection]
        if others and variant("second-of-name-refused"):
            self._close(connection)
            return
        for other in others:
            other.retired = True
            if variant("newer-replaces"):
                self._close(other)
        if variant("drop-noticed-on-return"):
            self._fail_dropped(name)
        connection.name = name
        connection.named_order = next(self._order)
        self._dispatch.arrived(connection, [other.number for other in others], self._now)
        if variant("echoes-name"):
            self._send_text(connection, name)

    def _fail_dropped(self, robot: str) -> None:
        for mission in list(self._missions.values()):
            there = mission.connection is not None and self._connections.get(mission.connection) is not None
            if mission.active and mission.robot == robot and not there:
                self._dispatch.end(mission, Status.FAILED_DISCONNECTED, self._now)

    def _named_again(self, connection: Connection, name: str) -> bool:
        """Whether a connection that has a name takes this one."""
        variant = self._variant
        if connection.name == name:
            if variant("name-again-takes-over"):
                connection.named_order = next(self._order)
            for mission in list(self._missions.values()):
                if mission.connection == connection.number and mission.active:
                    if variant("resent-on-name"):
                        self._dispatch.send_lines(mission, connection, self._now)
                    if variant("name-again-fails"):
                        self._dispatch.end(mission, Status.FAILED_DISCONNECTED, self._now)
            return False
        if variant("changed-name-closes"):
            self._close(connection)
        return variant("name-may-change")

    def _dropped(self, connection: Connection) -> None:
        variant = self._variant
        if variant("old-drop-loses-robot") and connection.name is not None:
            for other in self._connections.named(connection.name):
                other.deaf = True
        if connection.name is not None:
            self._dispatch.left(connection.name)
        for mission in list(self._missions.values()):
            queued_too = variant("drop-fails-queued") and mission.robot == connection.name
            if queued_too and mission.status is Status.QUEUED:
                self._dispatch.end(mission, Status.FAILED_DISCONNECTED, self._now)
            if not mission.active or (mission.connection != connection.number and not variant("drop-fails-all")):
                continue
            unacknowledged = mission.status is Status.STARTED
            if variant("drop-requeues") or (variant("drop-requeues-unacknowledged") and unacknowledged):
                mission.status = Status.QUEUED
                mission.connection = None
            elif variant("drop-noticed-on-return"):
                continue
            elif variant("drop-keeps-mission") or variant("drop-has-grace"):
                mission.dropped_at = self._now
            else:
                self._dispatch.end(mission, Status.FAILED_DISCONNECTED, self._now)

    # reports

    def _report(self, received: Received, connection: Connection) -> None:
        found = reported(received, connection.number, self._missions.values(), self._variant)
        if found is None:
            return
        if self._variant("reports-of-return-ignored") and not self._connections.is_first_of_name(connection):
            return
        mission, state, counts = found
        if state is not Status.RUNNING and not mission.active:
            self._dispatch.release(mission)
        if counts:
            self._apply(mission, state)
        self._changed()

    def _apply(self, mission: Mission, state: Status) -> None:
        variant = self._variant
        if state is Status.RUNNING:
            if mission.status is not Status.RUNNING or variant("run-limit-restarts"):
                mission.running_at = self._now
                first = self._first_runs.setdefault(mission.robot, self._now)
                if variant("run-clock-kept"):
                    mission.running_at = first
            mission.status = Status.RUNNING
            mission.heard_at = self._now
            return
        self._dispatch.end(mission, state, self._now)
        again = variant("failed-mission-retried") and mission.status in FAILURES
        if again or (variant("resent-after-success") and mission.status is Status.SUCCESS):
            self._dispatch.retry(mission)
