"""The journal of a mission server: the missions that it accepted and their ends, in an SQLite file that outlives it.

A change is on the disk before anybody hears of it: before a mission is sent, before a submission is answered, before
an end is told. So whatever moment a server dies at, the next one on the same journal loses nothing that was accepted
and runs nothing again that was reported done.
"""

from __future__ import annotations

import contextlib
import json
import sqlite3
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final, Self

import attrs

from missionfsm.isaac.runtime.missions import Effect, MissionRequest, Snapshot, Status, StatusChanged
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire.messages import Uuid

_APPLICATION: Final = 0x6D66736A  # "mfsj", which `file` shows
_VERSION: Final = 1
_TABLE: Final = """
CREATE TABLE missions (
    id INTEGER PRIMARY KEY,              -- in the order of creation: upstreams first
    uuid TEXT NOT NULL UNIQUE,
    robot TEXT, channel TEXT NOT NULL, status_channel TEXT, config TEXT NOT NULL,
    start_timeout REAL NOT NULL, timeout REAL NOT NULL,  -- seconds; Inf is none
    upstream TEXT NOT NULL,              -- their uuids, as a JSON list
    status TEXT NOT NULL,                -- RUNNING is written as STARTED
    attempt TEXT NOT NULL,               -- what the robot knows it by
    number INTEGER NOT NULL              -- in the order of submission; -1 before
)
"""


class JournalError(Exception):
    """A journal cannot be read or written, in words for people."""


class Journal:
    """A file with the missions of one server; made where there is none. JournalError if it cannot be had.

    One server at a time: the file is locked until it is closed, or its process dies.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = str(path)
        with self._as_journal_error():
            self._sql = sqlite3.connect(self.path, timeout=0.0, isolation_level=None, check_same_thread=False)
        try:
            with self._as_journal_error():
                self._open()
        except JournalError:
            self._sql.close()
            raise

    def _open(self) -> None:
        run = self._sql.execute
        run("PRAGMA locking_mode = EXCLUSIVE")
        run("PRAGMA journal_mode = WAL")
        run("PRAGMA synchronous = FULL")
        run("BEGIN EXCLUSIVE")
        (application,), (version,) = run("PRAGMA application_id").fetchone(), run("PRAGMA user_version").fetchone()
        empty = not run("SELECT 1 FROM sqlite_master").fetchone()
        if empty:
            run(_TABLE)
            run(f"PRAGMA application_id = {_APPLICATION}")
            run(f"PRAGMA user_version = {_VERSION}")
        elif application != _APPLICATION or version != _VERSION:
            raise JournalError(f"{self.path}: is no journal of this version of missionfsm")
        run("COMMIT")

    def missions(self) -> tuple[Snapshot, ...]:
        """All that is in it, in the order of creation."""
        with self._as_journal_error():
            rows = self._sql.execute(
                "SELECT uuid, robot, channel, status_channel, config, start_timeout, timeout, upstream, "
                "status, attempt, number FROM missions ORDER BY id"
            ).fetchall()
            return tuple(_Row(*row).snapshot() for row in rows)

    def write(self, new: Iterable[Snapshot] = (), changed: Iterable[Snapshot] = (), gone: Iterable[Uuid] = ()) -> None:
        """Write new, changed and forgotten missions, all or none of them; on return they are on the disk."""
        with self._as_journal_error():
            self._sql.execute("BEGIN")
            self._sql.executemany(
                "INSERT INTO missions (uuid, robot, channel, status_channel, config, start_timeout, timeout, upstream, "
                "status, attempt, number) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                (attrs.astuple(_Row.of(one)) for one in new),
            )
            self._sql.executemany(
                "UPDATE missions SET status = ?, attempt = ?, number = ? WHERE uuid = ?",
                ((_status(one), str(one.attempt), one.number, str(one.uuid)) for one in changed),
            )
            self._sql.executemany("DELETE FROM missions WHERE uuid = ?", ((str(uuid),) for uuid in gone))
            self._sql.execute("COMMIT")

    def close(self) -> None:
        """Let go of the file."""
        self._sql.close()

    @contextlib.contextmanager
    def _as_journal_error(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, ValueError, KeyError, TypeError) as error:
            with contextlib.suppress(sqlite3.Error, AttributeError):
                self._sql.rollback()
            locked = "another server has it open" if "locked" in str(error) else str(error)
            raise JournalError(f"{self.path}: {locked}") from None


class Bookkeeper:
    """Keeps a journal of what a server decides. Each method is called before anybody hears of what it writes."""

    def __init__(self, core: MissionServerCore, journal: Journal) -> None:
        self._core = core
        self._journal = journal
        self._new: dict[Uuid, None] = {}
        self._created: dict[Uuid, None] = {}  # written or to be written, and not submitted

    def restore(self, snapshots: Iterable[Snapshot]) -> None:
        """These are written already."""
        self._created = {one.uuid: None for one in snapshots if one.number < 0}

    def create(self, mission: Uuid) -> None:
        """A mission was made known; it is written with what is decided next."""
        self._new[mission] = self._created[mission] = None

    def note(self, effects: Iterable[Effect], *, submitted: bool = False) -> None:
        """Write what was decided. RUNNING is not: the journal does not tell it from STARTED.

        Args:
            effects: what the server decided.
            submitted: whether a submission led to it.
        """
        changed = {
            one.mission: None
            for one in effects
            if isinstance(one, StatusChanged) and one.status is not Status.RUNNING and one.mission not in self._new
        }
        if submitted:
            now = [mission for mission in self._created if self._core.submitted(mission)]
            for mission in now:
                del self._created[mission]
            changed |= {mission: None for mission in now if mission not in self._new}
        if self._new or changed:
            self._journal.write(map(self._core.snapshot, self._new), map(self._core.snapshot, changed))
            self._new.clear()

    def forget(self, missions: Iterable[Uuid]) -> None:
        """Missions are forgotten."""
        self._journal.write(gone=missions)


def _status(mission: Snapshot) -> str:
    status = Status.STARTED if mission.status is Status.RUNNING else mission.status
    return str(status.value)


@attrs.frozen
class _Row:
    """A row of the table of missions."""

    uuid: str
    robot: str | None
    channel: str
    status_channel: str | None
    config: str
    start_timeout: float
    timeout: float
    upstream: str
    status: str
    attempt: str
    number: int

    @classmethod
    def of(cls, mission: Snapshot) -> Self:
        """The row of a mission."""
        request = mission.request
        upstream = json.dumps([str(one) for one in request.upstream])
        return cls(
            str(mission.uuid),
            request.robot,
            request.channel,
            request.status_channel,
            request.config,
            request.start_timeout,
            request.timeout,
            upstream,
            _status(mission),
            str(mission.attempt),
            mission.number,
        )

    def snapshot(self) -> Snapshot:
        """The mission."""
        upstream = tuple(map(_uuid, json.loads(self.upstream)))
        request = MissionRequest(
            self.robot,
            self.channel,
            self.status_channel,
            self.config,
            self.start_timeout,
            self.timeout,
            upstream,
        )
        return Snapshot(_uuid(self.uuid), request, Status[self.status], _uuid(self.attempt), self.number)


def _uuid(text: str) -> Uuid:
    return Uuid.of(int(text.replace("-", ""), 16))
