"""The robot: its codelets, its connection to the server and its time."""

from __future__ import annotations

from dataclasses import dataclass

from codelet import FAILURE, RUNNING, SECOND, SUCCESS, MissionCodelet
from variants import Options
from wire import STATUS_PROTO, TEXT_PROTO, Composer, Json, Uuid, parse_line, uuid_payload

_START = 1_600_000_000 * SECOND


@dataclass(frozen=True)
class Names:
    """How the robot and its channels are called."""

    name: str = "robot"
    channel: str = "mission"
    status_channel: str = "mission_status"
    name_channel: str = "name"

    @classmethod
    def from_world(cls, world: Json) -> Names:
        """The names that a world gives, defaults where it gives none."""
        standard = cls()
        return cls(
            str(world.get("name", standard.name)),
            str(world.get("channel", standard.channel)),
            str(world.get("statusChannel", standard.status_channel)),
            str(world.get("nameChannel", standard.name_channel)),
        )


class Robot:
    """A robot that is connected from its start on; what it sends is gathered in `outbox`."""

    def __init__(self, options: Options, names: Names) -> None:
        self._options = options
        self._names = names
        self._composer = Composer(options)
        self._codelet = MissionCodelet(options, self._tell)
        self._now = _START
        self._connected = False
        self._connections = 0
        self._statuses = 0
        self._running = False
        self._choked = False
        self._kept: list[tuple[Uuid, str]] = []
        self._name_due = _START
        self.outbox: list[str] = []
        self.connect()

    def connect(self) -> bool:
        """The connection to the server comes up."""
        if self._connected:
            return False
        on = self._options.on
        self._connected = True
        self._connections += 1
        if not on("name-waits-for-tick"):
            self._say_name()
            self._name_due = self._now + self._name_period()
        elif self._connections == 1:
            self._name_due = self._now + self._name_period()
        if on("running-before-mission") and self._connections == 1:
            self._tell(Uuid(0, 0), RUNNING)
        kept, self._kept = self._kept, []
        for uuid, status in kept:
            self._tell(uuid, status)
        return True

    def disconnect(self) -> bool:
        """The connection drops; what is said now is not heard."""
        if not self._connected:
            return False
        self._connected = False
        self._codelet.abandon(self._now)
        return True

    def receive(self, line: str) -> bool:
        """The server sends a line."""
        if not self._connected:
            return False
        message = parse_line(line)
        if message is None:
            self._choked = self._choked or (self._options.on("deaf-after-rubbish") and bool(line.strip()))
            return True
        channel = "mission" if self._options.on("mission-channel-fixed") else self._names.channel
        known = message.channel == channel or self._options.on("mission-on-any-channel")
        if self._options.on("mission-channel-by-prefix"):
            known = message.channel.startswith(channel)
        if self._choked or not known:
            return True
        if self._options.on("deaf-after-reconnect") and self._connections > 1:
            return True
        self._codelet.receive(message, self._now)
        self._join_lines()
        return True

    def _join_lines(self) -> None:
        if self._options.on("two-messages-in-a-line") and len(self.outbox) > 1:
            self.outbox = ["".join(self.outbox)]

    def behavior(self, success: bool) -> bool:
        """The behavior tree stops."""
        return self._codelet.behavior_ended(success, self._now)

    def advance(self, seconds: float) -> None:
        """Let time pass, and do on the way what is due."""
        end = self._now + round(seconds * SECOND)
        while True:
            due = self._codelet.next_due()
            moment = self._name_due if due is None else min(due, self._name_due)
            if moment > end:
                break
            self._now = max(self._now, moment)
            if self._name_due <= self._now:
                self._say_name_again()
            if due is not None and due <= self._now:
                self._codelet.work(self._now)
        self._now = end

    def _name_period(self) -> int:
        on = self._options.on
        if on("name-four-a-second"):
            return SECOND // 4
        if on("name-every-ten-seconds"):
            return 10 * SECOND
        return SECOND

    def _say_name_again(self) -> None:
        on = self._options.on
        self._name_due = self._now + self._name_period()
        if on("name-once") or (on("name-silent-in-mission") and self._running):
            return
        if on("name-silent-after-mission") and self._statuses > 0:
            return
        self._say_name()

    def _say_name(self) -> None:
        on = self._options.on
        if not self._connected or on("name-never"):
            return
        if on("name-lost-on-reconnect") and self._connections > 1:
            return
        channel = "name" if on("name-channel-fixed") else self._names.name_channel
        name = "robot" if on("name-fixed") else self._names.name
        payload = {"name": name} if on("text-field-misnamed") else {"text": name}
        self.outbox.append(self._composer.line(channel, TEXT_PROTO, payload, self._now))

    def _tell(self, uuid: Uuid, status: str) -> None:
        on = self._options.on
        self._running = status == RUNNING
        if not self._connected:
            if on("all-statuses-kept") or (on("final-status-kept") and status != RUNNING):
                self._kept.append((uuid, status))
            if on("disconnect-fails-mission") and status != RUNNING:
                self._kept.append((uuid, status))
            return
        self._statuses += 1
        if on("statuses-stop-after-reconnect") and self._connections > 1:
            return
        payload = {"uuid": uuid_payload(self._options, uuid), "missionStatus": self._word(status)}
        if on("status-without-uuid") and status == FAILURE:
            payload.pop("uuid")
        self.outbox.append(self._composer.line(self._status_channel(), STATUS_PROTO, payload, self._now))

    def _word(self, status: str) -> str:
        on = self._options.on
        if on("statuses-in-capitals"):
            return status.upper()
        return "succeeded" if on("success-misspelt") and status == SUCCESS else status

    def _status_channel(self) -> str:
        on = self._options.on
        if on("status-on-mission-channel"):
            return self._names.channel
        return "mission_status" if on("status-channel-fixed") else self._names.status_channel
