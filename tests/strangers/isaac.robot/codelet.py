"""The mission codelet: runs one mission at a time and tells its status."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from configuration import usable
from variants import Options
from wire import MISSION_PROTO, Incoming, Uuid, parse_uuid

SECOND = 1_000_000_000
RUNNING, SUCCESS, FAILURE = "running", "success", "failure"
Tell = Callable[[Uuid, str], None]


@dataclass
class Mission:
    """A mission that runs."""

    uuid: Uuid
    due: int
    told: int = 0


class MissionCodelet:
    """Starts a mission for each MissionProto and reports through `tell` on what runs."""

    def __init__(self, options: Options, tell: Tell) -> None:
        self._options = options
        self._tell = tell
        self._current: Mission | None = None
        self._ended: tuple[Uuid, str, int] | None = None
        self._last: tuple[Uuid, str, int] | None = None
        self._waiting: list[tuple[Uuid, Any]] = []
        self._ghost: Mission | None = None
        self._first: Uuid | None = None
        self._preemptions = 0
        self._mute = False

    def receive(self, message: Incoming, now: int) -> None:
        """A message on the mission channel."""
        on = self._options.on
        if message.proto is None and on("proto-required"):
            return
        if message.proto not in (None, MISSION_PROTO) and not on("proto-not-looked-at"):
            return
        uuid = self._uuid(message.payload.get("uuid"))
        if uuid is None:
            return
        config = message.payload.get("config")
        if on("bad-config-ignored") and not usable(self._options, config):
            return
        self._finish_ended()
        if self._last is not None and self._deaf(self._last[1]):
            return
        if self._current is not None and not self._preempt(uuid, config, now):
            return
        self._start(uuid, config, now)

    def _uuid(self, value: Any) -> Uuid | None:
        if value is None:
            return None if self._options.on("missing-uuid-ignored") else Uuid(0, 0)
        return parse_uuid(value, texts_only=self._options.on("uuid-numbers-refused"))

    def _deaf(self, last_status: str) -> bool:
        if self._options.on("one-mission-only"):
            return True
        return self._options.on("deaf-after-failure") and last_status == FAILURE and self._current is None

    def _preempt(self, uuid: Uuid, config: Any, now: int) -> bool:
        on = self._options.on
        old = self._current
        assert old is not None
        if on("preemption-ignored"):
            return False
        if on("same-uuid-ignored") and uuid == old.uuid:
            return False
        if on("preemption-waits"):
            self._waiting.append((uuid, config))
            return False
        self._preemptions += 1
        self._current = None
        if on("preempted-goes-on"):
            self._ghost = old
            return True
        if on("new-told-before-old"):
            self._start(uuid, config, now)
            self._tell(old.uuid, FAILURE)
            return False
        status = SUCCESS if on("preempted-as-success") else FAILURE
        quiet = on("preempted-untold") or (on("second-preemption-untold") and self._preemptions > 1)
        if not quiet:
            self._tell(uuid if on("preempted-under-new-uuid") else old.uuid, status)
        if on("preempted-told-twice"):
            self._tell(old.uuid, status)
        if on("new-not-started"):
            self._current = None
            return False
        if on("old-uuid-after-preemption"):
            self._start(old.uuid, config, now)
            return False
        return True

    def _start(self, uuid: Uuid, config: Any, now: int) -> None:
        on = self._options.on
        self._first = self._first or uuid
        if on("uuid-of-first-mission"):
            uuid = self._first
        if not usable(self._options, config):
            if on("bad-config-running-first"):
                self._tell(uuid, RUNNING)
            self._end(uuid, FAILURE, now)
            return
        self._current = Mission(uuid, now)
        self._mute = False
        waits = on("running-waits") or (on("running-waits-after-preemption") and self._preemptions > 0)
        if waits:
            self._current.due = now + self._period(self._current)
        elif on("status-on-the-second"):
            self._say_running(self._current)
            self._current.due = (now // SECOND + 1) * SECOND
        else:
            self.work(now)

    def _period(self, mission: Mission) -> int:
        on = self._options.on
        if on("status-ten-a-second"):
            return SECOND // 10
        if on("status-twice-a-second"):
            return SECOND // 2
        if on("status-every-four-seconds"):
            return 4 * SECOND
        if on("status-uneven"):
            return (7 if mission.told % 2 else 13) * SECOND // 10
        if on("status-ever-slower"):
            return SECOND << min(mission.told, 40)
        return SECOND

    def next_due(self) -> int | None:
        """When the codelet has something to do next."""
        times = [mission.due for mission in (self._current, self._ghost) if mission is not None]
        if self._ended is not None:
            times.append(self._ended[2])
        if self._last is not None and self._options.on("final-status-repeats") and self._current is None:
            times.append(self._last[2])
        if self._last is not None and self._options.on("running-after-end") and self._current is None:
            times.append(self._last[2])
        return min(times, default=None)

    def work(self, now: int) -> None:
        """Do what is due."""
        on = self._options.on
        if self._ended is not None and self._ended[2] <= now:
            self._finish_ended()
        for mission in (self._ghost, self._current):
            if mission is not None and mission.due <= now:
                self._say_running(mission)
                mission.due = now + self._period(mission)
        if self._last is not None and self._last[2] <= now and self._current is None:
            uuid, status, _ = self._last
            if on("final-status-repeats") or on("running-after-end"):
                self._tell(uuid, RUNNING if on("running-after-end") else status)
            self._last = (uuid, status, now + SECOND)

    def _say_running(self, mission: Mission) -> None:
        on = self._options.on
        mission.told += 1
        if on("never-running") or self._mute:
            return
        if on("running-once") and mission.told > 1:
            return
        if on("running-ends-after-ten") and mission.told > 10:
            return
        if on("later-missions-without-running") and (self._preemptions > 0 or self._last is not None):
            return
        self._tell(mission.uuid, RUNNING)

    def behavior_ended(self, success: bool, now: int) -> bool:
        """The behavior tree stopped; tells whether a mission ran."""
        on = self._options.on
        if self._current is None:
            return False
        uuid = self._current.uuid
        self._current = None
        status = SUCCESS if success else FAILURE
        if on("outcomes-swapped"):
            status = FAILURE if success else SUCCESS
        elif on("failure-as-success"):
            status = SUCCESS
        elif on("success-after-failure-wrong") and self._last is not None and self._last[1] == FAILURE:
            status = FAILURE
        if on("final-at-next-tick"):
            self._ended = (uuid, status, now + SECOND // 10)
            return True
        if on("failure-told-with-next-mission") and status == FAILURE:
            self._ended = (uuid, status, 2**80)
            return True
        self._end(uuid, status, now)
        if on("failed-mission-tried-again") and status == FAILURE:
            self._current = Mission(uuid, now + SECOND)
        if self._waiting:
            self._start(*self._waiting.pop(0), now)
        return True

    def _finish_ended(self) -> None:
        if self._ended is not None:
            uuid, status, due = self._ended
            self._ended = None
            self._end(uuid, status, due)

    def _end(self, uuid: Uuid, status: str, now: int) -> None:
        on = self._options.on
        self._last = (uuid, status, now + SECOND)
        if self._mute or on("final-missing"):
            return
        if (on("success-untold") and status == SUCCESS) or (on("failure-untold") and status == FAILURE):
            return
        self._tell(uuid, status)
        if on("final-twice"):
            self._tell(uuid, status)
        if on("running-just-after-final"):
            self._tell(uuid, RUNNING)

    def abandon(self, now: int) -> None:
        """The connection dropped while, perhaps, a mission ran."""
        on = self._options.on
        if on("disconnect-silences-mission"):
            self._mute = True
        if on("disconnect-fails-mission") and self._current is not None:
            uuid = self._current.uuid
            self._current = None
            self._end(uuid, FAILURE, now)
