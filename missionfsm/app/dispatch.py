"""The missions of one file, on a mission server of their own, until all have ended or somebody ends it."""

from __future__ import annotations

import asyncio
import collections
import contextlib
import logging
import signal
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from missionfsm.adapters.isaac.journal import Journal
from missionfsm.adapters.isaac.lines import LOG
from missionfsm.adapters.isaac.settings import LOOPBACK, Settings
from missionfsm.adapters.isaac.statuspage import StatusPage, answers
from missionfsm.adapters.isaac.tcp import TcpMissionServer, fresh_uuid
from missionfsm.app.ending import told_to_end
from missionfsm.isaac.runtime.graph import topological_order
from missionfsm.isaac.runtime.log import Entry, Level, Narrator
from missionfsm.isaac.runtime.missionfile import MissionFile
from missionfsm.isaac.runtime.missions import INCOMPLETE, Effect, Snapshot, Status, StatusChanged
from missionfsm.isaac.wire.messages import Uuid
from missionfsm.kernel.codec import UnreadableError

_LOOPBACK = ("127.", "localhost:", "[::1]:")


class JournalMismatchError(Exception):
    """A journal holds other missions than the file, in words for people."""


class Dispatch:
    """See the module.

    Attributes:
        statuses: where each mission of the file stands.
        ended_by: the signal that ended it, if one did.
    """

    def __init__(self, file: MissionFile, settings: Settings) -> None:
        self.file = file
        self.statuses = [Status.CREATED] * len(file.missions)
        self.ended_by: signal.Signals | None = None
        self.narrator = Narrator([entry.robot for entry in file.missions])
        self._settings = settings
        self._tell: Callable[[Entry], None] = lambda _: None
        self._unfinished = len(self.statuses)
        self._done = asyncio.Event()

    @property
    def unfinished(self) -> int:
        """How many missions have not ended."""
        return self._unfinished

    @property
    def succeeded(self) -> int:
        """How many missions have succeeded."""
        return self.statuses.count(Status.SUCCESS)

    async def run(self, tell: Callable[[Entry], None]) -> None:
        """Serve until all missions have ended. OSError where the address cannot be had.

        `tell` gets an entry for all that happens, on the event loop; it must not wait.
        """
        self._tell = tell
        journal = None if self._settings.journal is None else Journal(self._settings.journal)
        try:
            await self._serve(journal)
        finally:
            if journal is not None:
                journal.close()

    async def _serve(self, journal: Journal | None) -> None:
        settings = self._settings
        kept = () if journal is None else journal.missions()
        uuids = self._kept(kept) if kept else tuple(fresh_uuid() for _ in self.statuses)
        self.narrator.name(uuids)
        for mission in kept:
            self._stands(mission)
        server = TcpMissionServer(settings, journal=journal, observer=self._observe)
        self.narrator.peer = server.peer
        await server.start()
        try:
            with told_to_end(self._end), self._warnings(), contextlib.ExitStack() as cleanup:
                self._say_where(server)
                if settings.http is not None:
                    page = self._page(server, settings.http)
                    cleanup.callback(page.close)
                    address = f"http://{LOOPBACK}:{page.port}/"
                    self._tell(Entry("status-page", f"status page at {address}", Level.INFO, {"address": address}))
                refused = None if kept else server.submit_file(self.file, uuids)
                if refused is not None:  # the file was read with this profile, so this does not happen
                    raise RuntimeError(str(refused))
                server.failed.add_done_callback(lambda _: self._done.set())
                if self._unfinished:
                    await self._done.wait()
                if server.failed.done():
                    raise server.failed.result()
        finally:
            await server.close()
        failed = len(self.statuses) - self.succeeded
        if self.ended_by is None:
            fields = {"succeeded": self.succeeded, "failed": failed}
            self._tell(Entry("summary", f"{self.succeeded} succeeded, {failed} did not", Level.INFO, fields))

    def _kept(self, kept: Sequence[Snapshot]) -> tuple[Uuid, ...]:
        """The identifiers of the file's missions in a journal that holds them."""
        order = topological_order([entry.upstream for entry in self.file.missions])
        if len(kept) != len(order):
            raise JournalMismatchError(f"holds {len(kept)} missions and the file {len(order)}; take another journal")
        uuids = dict(zip(order, (mission.uuid for mission in kept), strict=True))
        found = tuple(uuids[index] for index in range(len(order)))
        for index, mission in zip(order, kept, strict=True):
            if self.file.missions[index].request(found) != mission.request:
                raise JournalMismatchError(f"holds another missions[{index}] than the file; take another journal")
        return found

    def _stands(self, mission: Snapshot) -> None:
        """Take note of where a mission stood when the last server ended."""
        number = self.narrator.number(mission.uuid)
        self.statuses[number] = mission.status
        self._unfinished -= mission.status.terminal
        fields = {"mission": number, "uuid": str(mission.uuid), "status": mission.status.value}
        says = f"missions[{number}] {mission.request.robot}: {mission.status.value}, as the journal has it"
        self._tell(Entry("restored", says, Level.INFO, {**fields, "robot": mission.request.robot}))

    def _say_where(self, server: TcpMissionServer) -> None:
        for address in server.addresses:
            self._tell(Entry("listening", f"listening on {address}", Level.INFO, {"address": address}))
        if all(address.startswith(_LOOPBACK) for address in server.addresses):
            says = "only programs on this machine can connect; --host :: lets robots in from elsewhere"
            self._tell(Entry("loopback", says))
        elif self._settings.tokens is None:
            says = "whoever can connect can say any robot's name; --token FILE asks for a token"
            self._tell(Entry("open", says, Level.WARNING))

    def _page(self, server: TcpMissionServer, port: int) -> StatusPage:
        try:
            return StatusPage(port, answers(lambda: self.status(server)))
        except OSError as error:
            raise UnreadableError(f"--http: cannot listen on {LOOPBACK}:{port}: {error.strerror or error}") from None

    def status(self, server: TcpMissionServer) -> dict[str, Any]:
        """Where everything stands, as JSON: missions in the order of the file, robots, how many have which status."""
        counts = collections.Counter(self.statuses)
        missions = [
            {"mission": number, "robot": entry.robot, "status": status.value, "upstream": list(entry.upstream)}
            for number, (entry, status) in enumerate(zip(self.file.missions, self.statuses, strict=True))
        ]
        robots = [{"robot": name, "peer": peer} for name, peer in server.robots()]
        return {"counts": {one.value: counts[one] for one in Status}, "robots": robots, "missions": missions}

    def _observe(self, effect: Effect) -> None:
        if isinstance(effect, StatusChanged):
            self.statuses[self.narrator.number(effect.mission)] = effect.status
            self._unfinished += (effect.status in INCOMPLETE) - (effect.before in INCOMPLETE)
        self._tell(self.narrator.tell(effect))
        if not self._unfinished:
            self._done.set()

    def _end(self, by: signal.Signals) -> None:
        self.ended_by = by
        self._done.set()

    @contextlib.contextmanager
    def _warnings(self) -> Iterator[None]:
        """What the connections warn of is told as well, and goes nowhere else."""
        handler = _Handler(self._tell)
        propagates, LOG.propagate = LOG.propagate, False
        LOG.addHandler(handler)
        try:
            yield
        finally:
            LOG.removeHandler(handler)
            LOG.propagate = propagates


class _Handler(logging.Handler):
    def __init__(self, tell: Callable[[Entry], None]) -> None:
        super().__init__(logging.WARNING)
        self._tell_entry = tell

    def emit(self, record: logging.LogRecord) -> None:
        level = Level.ERROR if record.levelno >= logging.ERROR else Level.WARNING
        self._tell_entry(Entry("connection-dropped", record.getMessage(), level))
