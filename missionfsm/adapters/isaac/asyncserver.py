"""A mission server for asyncio, that plans, sends and waits for missions as the page of the vendor says."""

import asyncio
import collections
import contextlib
import ssl
from collections.abc import AsyncIterator, Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self
from weakref import WeakValueDictionary

from missionfsm.adapters.isaac.journal import Journal
from missionfsm.adapters.isaac.lines import LOG
from missionfsm.adapters.isaac.mission import Mission, MissionRefusedError, not_submitted
from missionfsm.adapters.isaac.settings import DEFAULT_PORT, LOOPBACK, Settings
from missionfsm.adapters.isaac.statuspage import StatusPage, answers
from missionfsm.adapters.isaac.tcp import TcpMissionServer
from missionfsm.isaac.runtime.missions import Effect, Refused, StatusChanged
from missionfsm.isaac.runtime.missions import Status as MissionStatus
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.wire.framing import MAX_LINE
from missionfsm.isaac.wire.messages import Uuid

Callback = Callable[[Mission, MissionStatus], object]
"""Is called with a mission and its new status."""


class AsyncMissionServer:
    """The mission server on the running event loop: `await start()`, or ``async with``.

    Args:
        port: where robots connect; 0 is any free one.
        name_channel: where they say their names.
        host: the address that is listened on; ``::`` is every one of this machine.
        profile: the readings that are followed.
        line_limit: bytes of the longest line that is read or sent; a mission that needs more is refused.
        journal: a file in which everything that was accepted survives the server. What it has is in `missions`.
        resume: what becomes of a mission that was under way when the last server died: "rerun" or "fail".
        tokens: for each robot's name the token that a connection says before it; None lets anybody be anybody.
        tls: how the server shows who it is; everything is encrypted then (`missionfsm.adapters.isaac.secrets`).
        http: the port of loopback on which a page shows where all stands, read only; 0 is any free one (`http_port`).
    """

    def __init__(  # noqa: PLR0913 - all but the page's two by keyword
        self,
        port: int = DEFAULT_PORT,
        name_channel: str = "name",
        *,
        host: str = LOOPBACK,
        profile: Profile = DOCUMENTED,
        line_limit: int = MAX_LINE,
        journal: str | Path | None = None,
        resume: str = "fail",
        tokens: Mapping[str, str] | None = None,
        tls: ssl.SSLContext | None = None,
        http: int | None = None,
    ) -> None:
        self._settings = Settings(host, port, name_channel, profile, line_limit, journal, resume, tokens, tls, http)
        self._page: StatusPage | None = None
        self._tcp: TcpMissionServer | None = None
        self._journal: Journal | None = None
        self._missions: WeakValueDictionary[Uuid, Mission] = WeakValueDictionary()
        self._restored: dict[Uuid, Mission] = {}
        self._callbacks: list[Callback] = []
        self._followers: dict[Uuid, list[asyncio.Queue[MissionStatus | None]]] = {}
        self._changed = asyncio.Event()
        self._closed = False

    async def start(self) -> None:
        """Listen. OSError where the address cannot be had, JournalError where the journal cannot."""
        settings = self._settings
        if settings.journal is not None:
            self._journal = Journal(settings.journal)
            for kept in self._journal.missions():
                upstream = [self._restored[one] for one in kept.request.upstream if one in self._restored]
                self._restored[kept.uuid] = self._missions[kept.uuid] = Mission.restored(kept, upstream, self)
        self._tcp = TcpMissionServer(settings, journal=self._journal, observer=self._observe)
        self._tcp.failed.add_done_callback(lambda _: self._changed.set())
        await self._tcp.start()
        if settings.http is not None:
            self._page = StatusPage(settings.http, answers(self._standing))

    async def close(self) -> None:
        """Stop listening and drop all robots; missions keep their status, and nobody waits for them any more."""
        self._closed = True
        self._changed.set()
        for followers in self._followers.values():
            for follower in followers:
                follower.put_nowait(None)
        if self._page is not None:
            await asyncio.to_thread(self._page.close)  # a page that is being made is made on this loop
            self._page = None
        if self._tcp is not None:
            await self._tcp.close()
        if self._journal is not None:
            self._journal.close()

    async def __aenter__(self) -> Self:
        await self.start()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return self._running().port

    @property
    def http_port(self) -> int | None:
        """The port of the status page, if there is one."""
        return None if self._page is None else self._page.port

    def _standing(self) -> dict[str, Any]:
        """Where everything stands, for the status page: missions in the order of creation, without forgotten ones."""
        tcp = self._running()
        stands = [tcp.core.snapshot(uuid) for uuid, _ in tcp.core.statuses()]
        numbers = {one.uuid: number for number, one in enumerate(stands)}
        counts = collections.Counter(one.status for one in stands)
        missions = [
            {
                "mission": numbers[one.uuid],
                "robot": one.request.robot,
                "status": one.status.value,
                "upstream": [numbers[upstream] for upstream in one.request.upstream if upstream in numbers],
            }
            for one in stands
        ]
        robots = [{"robot": name, "peer": peer} for name, peer in tcp.robots()]
        return {"counts": {one.value: counts[one] for one in MissionStatus}, "robots": robots, "missions": missions}

    @property
    def missions(self) -> tuple[Mission, ...]:
        """What the journal had when the server started, without what was forgotten since."""
        return tuple(self._restored.values())

    def get_robots(self) -> list[str]:
        """The names of the robots that are connected."""
        return [robot.robot for robot in self._running().core.robots() if robot.connection is not None]

    def submit(self, mission: Mission) -> None:
        """Run the mission when its upstreams have succeeded and its robot is there. MissionRefusedError if refused."""
        tcp = self._running()
        for one in not_submitted(mission):
            if one.server is not None and one.server is not self:
                msg = f"{one!r} belongs to another server"
                raise MissionRefusedError(msg)
            if one.server is None:
                raise_refused(tcp.create(one.outstanding_request(), one.uuid))
                one.server = self
                self._missions[one.uuid] = one
        raise_refused(tcp.submit(mission.uuid))

    def cancel(self, mission: Mission) -> None:
        """Give a submitted mission up, and what waits for it. MissionRefusedError where it has ended.

        A robot that runs it is not told, for the documents have no words for it: its next mission preempts it.
        """
        raise_refused(self._running().cancel(mission.uuid))

    def retry(self, mission: Mission) -> None:
        """Run a mission that failed once more, and what was cancelled because of it. MissionRefusedError if refused."""
        raise_refused(self._running().retry(mission.uuid))

    def forget(self, *missions: Mission) -> int:
        """Remember nothing more of these missions, or of all that have ended and that nothing waits for. How many.

        A mission keeps its status. It may still be named as upstream if it has succeeded. MissionRefusedError for one
        that was named here and cannot be forgotten.
        """
        tcp = self._running()
        ended = [uuid for uuid, status in tcp.core.statuses() if status.terminal] if not missions else []
        gone = 0
        for uuid in [mission.uuid for mission in missions] or ended:
            refused = tcp.forget(uuid)
            if missions:
                raise_refused(refused)
            if refused is None:
                gone += 1
                self._restored.pop(uuid, None)
                if (mission := self._missions.pop(uuid, None)) is not None:
                    mission.forgotten = True
        return gone

    def on_status(self, callback: Callback) -> Callable[[], None]:
        """Have a callback called at every change of status, on the event loop; it must not wait.

        What is returned ends that. An exception of a callback is logged and hurts nobody else.
        """
        self._callbacks.append(callback)
        return lambda: self._callbacks.remove(callback)

    async def statuses(self, mission: Mission) -> AsyncIterator[MissionStatus]:
        """The status of a mission and each that follows, until it has ended or the server is closed."""
        follower: asyncio.Queue[MissionStatus | None] = asyncio.Queue()
        followers = self._followers.setdefault(mission.uuid, [])
        followers.append(follower)
        try:
            status: MissionStatus | None = mission.status
            while status is not None:
                yield status
                if status.terminal or self._closed:
                    return
                status = await follower.get()
        finally:
            followers.remove(follower)
            if not followers:
                self._followers.pop(mission.uuid, None)

    async def wait(self, *missions: Mission, timeout: float | None = None) -> bool:  # noqa: ASYNC109 - the blocking twin has it
        """Until these missions, or all submitted ones, have ended; False after `timeout` seconds, or on close.

        JournalError where the journal could not be written, which ends the server.
        """
        failed = self._running().failed
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(timeout):
                while not self._closed and not self._all_ended(missions) and not failed.done():
                    self._changed.clear()
                    await self._changed.wait()
        if failed.done():
            raise failed.result()
        return self._all_ended(missions)

    def _all_ended(self, missions: tuple[Mission, ...]) -> bool:
        if missions:
            return all(one.status.terminal for one in missions)
        return self._running().core.unfinished == 0

    def _running(self) -> TcpMissionServer:
        if self._tcp is None:
            msg = "the server is not started; await start() first"
            raise RuntimeError(msg)
        return self._tcp

    def _observe(self, effect: Effect) -> None:
        if not isinstance(effect, StatusChanged):
            return
        self._changed.set()
        mission = self._missions.get(effect.mission)
        if mission is None:
            return
        mission.status = effect.status
        for follower in self._followers.get(effect.mission, ()):
            follower.put_nowait(effect.status)
        for callback in tuple(self._callbacks):
            try:
                callback(mission, effect.status)
            except Exception:  # noqa: BLE001 - whatever it is, the server goes on
                LOG.exception("a callback failed at %r", mission)


def raise_refused(refused: Refused | None) -> None:
    """MissionRefusedError where something was refused."""
    if refused is not None:
        raise MissionRefusedError(str(refused))
