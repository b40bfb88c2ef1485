"""Missions and their states."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any

SECOND = 1_000_000_000
"""One second in the nanoseconds that all times of this program are counted in."""


class Status(Enum):
    """Where a mission stands."""

    CREATED = "CREATED"
    QUEUED = "QUEUED"
    STARTED = "STARTED"
    RUNNING = "RUNNING"
    SUCCESS = "SUCCESS"
    FAILED = "FAILED"
    FAILED_DISCONNECTED = "FAILED_DISCONNECTED"
    FAILED_TIMEDOUT = "FAILED_TIMEDOUT"
    FAILED_UPSTREAM = "FAILED_UPSTREAM"


ACTIVE = frozenset({Status.STARTED, Status.RUNNING})
"""Sent to a robot and not over."""

FAILURES = frozenset({Status.FAILED, Status.FAILED_DISCONNECTED, Status.FAILED_TIMEDOUT, Status.FAILED_UPSTREAM})
"""Over without success."""

ENDED = FAILURES | {Status.SUCCESS}
"""Over."""


class MissionRefused(Exception):
    """A submitted mission is not acceptable; the text says why."""


@dataclass
class Mission:
    """A submitted mission; limits and times are in nanoseconds, a limit of None never ends."""

    handle: int
    robot: str
    channel: str
    status_channel: str
    config: Any
    start_limit: int | None
    run_limit: int | None
    upstream: list[Mission]
    uuid: int
    submitted_at: int
    submitted_order: int
    ended_before: frozenset[int] = frozenset()
    status: Status = Status.QUEUED
    connection: int | None = None
    sent_at: int = 0
    sent_order: int = 0
    running_at: int = 0
    heard_at: int = 0
    ended_at: int = 0
    ended_order: int = 0
    ready_order: int | None = None
    dropped_at: int | None = None
    times_sent: int = 0
    cancel_level: int = 0
    retried: bool = False

    @property
    def active(self) -> bool:
        """Whether a robot has the mission now."""
        return self.status in ACTIVE

    @property
    def ended(self) -> bool:
        """Whether the mission is over."""
        return self.status in ENDED
