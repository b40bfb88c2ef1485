"""The mission server as the page's sample uses it. MissionSubmission › Sample Usage.

:class:`MissionServer` listens in a thread of its own; every method may be called from any thread. For programs that
have an event loop, :class:`AsyncMissionServer` is the same on that loop::

    with MissionServer(port=9998, name_channel="name") as server:
        first = Mission(robot="carter-01", channel="mission", config={...})
        second = Mission(robot="carter-02", channel="mission", config={...}, upstream=[first])
        server.submit(first)
        server.submit(second)
        server.wait()
"""

import asyncio
import math
import threading
from collections.abc import Coroutine, Iterable, Mapping
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeVar
from weakref import WeakValueDictionary

from missionfsm.adapters.isaac.tcp import DEFAULT_PORT, LOOPBACK, TcpMissionServer, fresh_uuid
from missionfsm.isaac.runtime.missions import DEFAULT_START_TIMEOUT, Effect, MissionRequest, Refused, StatusChanged
from missionfsm.isaac.runtime.missions import Status as MissionStatus
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.wire import strictjson

if TYPE_CHECKING:
    from missionfsm.isaac.wire.messages import Uuid

T = TypeVar("T")


class MissionRefusedError(ValueError):
    """The server did not take a mission; missions upstream of it may have been made known to it."""


class Mission:
    """A mission, with the documented keys and defaults. Its `status` changes once it is submitted.

    `config` is any JSON object. Timeouts are seconds, 0 … inf. ValueError for what cannot be sent.
    """

    Status = MissionStatus

    def __init__(  # noqa: PLR0913 - the documented keys
        self,
        robot: str | None = None,
        channel: str = "mission",
        config: Mapping[str, Any] | None = None,
        upstream: Iterable["Mission"] = (),
        *,
        status_channel: str | None = None,
        start_timeout: float = DEFAULT_START_TIMEOUT,
        timeout: float = math.inf,
    ) -> None:
        self.upstream = tuple(upstream)
        self.uuid: Uuid = fresh_uuid()
        self.request = MissionRequest(
            robot=robot,
            channel=channel,
            status_channel=status_channel,
            config=_config_text({} if config is None else config),
            start_timeout=start_timeout,
            timeout=timeout,
            upstream=tuple(mission.uuid for mission in self.upstream),
        )
        self._status = MissionStatus.CREATED
        self._server: object = None

    @property
    def status(self) -> MissionStatus:
        """Where the mission stands; may be read from any thread."""
        return self._status

    @property
    def robot(self) -> str | None:
        """The robot that the mission is for."""
        return self.request.robot

    def __repr__(self) -> str:
        return f"<Mission {self.uuid} for {self.request.robot!r}: {self._status.value}>"


class AsyncMissionServer:
    """The mission server on the running event loop: `await start()`, or ``async with``."""

    def __init__(
        self,
        port: int = DEFAULT_PORT,
        name_channel: str = "name",
        *,
        host: str = LOOPBACK,
        profile: Profile = DOCUMENTED,
    ) -> None:
        self._settings = (host, port, name_channel, profile)
        self._tcp: TcpMissionServer | None = None
        self._missions: WeakValueDictionary[Uuid, Mission] = WeakValueDictionary()
        self._changed = asyncio.Event()
        self._closed = False

    async def start(self) -> None:
        """Listen. OSError where the address cannot be had."""
        host, port, name_channel, profile = self._settings
        self._tcp = TcpMissionServer(
            host=host, port=port, name_channel=name_channel, profile=profile, observer=self._observe
        )
        await self._tcp.start()

    async def close(self) -> None:
        """Stop listening and drop all robots; missions keep their status, and nobody waits for them any more."""
        self._closed = True
        self._changed.set()
        if self._tcp is not None:
            await self._tcp.close()

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

    def submit(self, mission: Mission) -> None:
        """Run the mission when its upstreams have succeeded and its robot is there. MissionRefusedError if refused."""
        tcp = self._running()
        for one in _upstreams_first(mission):
            if one._server is not None and one._server is not self:  # noqa: SLF001 - our own class
                msg = f"{one!r} belongs to another server"
                raise MissionRefusedError(msg)
            if one._server is None:  # noqa: SLF001
                _raise(tcp.create(one.request, one.uuid))
                one._server = self  # noqa: SLF001
                self._missions[one.uuid] = one
        _raise(tcp.submit(mission.uuid))

    async def wait(self, *missions: Mission, timeout: float | None = None) -> bool:  # noqa: ASYNC109 - the blocking twin has it
        """Until these missions, or all submitted ones, have ended; False after `timeout` seconds, or on close."""
        try:
            async with asyncio.timeout(timeout):
                while not self._closed and not self._all_ended(missions):
                    self._changed.clear()
                    await self._changed.wait()
        except TimeoutError:
            pass
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
        if isinstance(effect, StatusChanged):
            mission = self._missions.get(effect.mission)
            if mission is not None:
                mission._status = effect.status  # noqa: SLF001 - our own class
            self._changed.set()


class MissionServer:
    """The mission server in a thread of its own. Listens from the moment it is made; OSError if it cannot.

    Close it, or use it in a ``with``; a program that ends without closing it ends all the same.
    """

    def __init__(
        self,
        port: int = DEFAULT_PORT,
        name_channel: str = "name",
        *,
        host: str = LOOPBACK,
        profile: Profile = DOCUMENTED,
    ) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="missionfsm-server", daemon=True)
        self._lock = threading.Lock()
        self._closed = False
        self._thread.start()
        try:
            self._server = self._call(self._make(port, name_channel, host, profile))
        except BaseException:
            self._stop()
            raise

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return self._server.port

    def submit(self, mission: Mission) -> None:
        """Run the mission when its upstreams have succeeded and its robot is there. MissionRefusedError if refused."""

        async def submit() -> None:
            self._server.submit(mission)

        self._call(submit())

    def wait(self, *missions: Mission, timeout: float | None = None) -> bool:
        """Until these missions, or all submitted ones, have ended; False after `timeout` seconds, or on close."""
        return self._call(self._server.wait(*missions, timeout=timeout))

    def close(self) -> None:
        """Stop listening and drop all robots; missions keep their status. A second time is no matter."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            future = asyncio.run_coroutine_threadsafe(self._server.close(), self._loop)
        try:
            future.result()
        finally:
            self._stop()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @staticmethod
    async def _make(port: int, name_channel: str, host: str, profile: Profile) -> AsyncMissionServer:
        server = AsyncMissionServer(port, name_channel, host=host, profile=profile)
        await server.start()
        return server

    def _call(self, work: Coroutine[Any, Any, T]) -> T:
        with self._lock:
            if self._closed:
                work.close()
                msg = "the server is closed"
                raise RuntimeError(msg)
            future = asyncio.run_coroutine_threadsafe(work, self._loop)
        try:
            return future.result()
        except BaseException:  # Ctrl-C while waiting: leave nothing behind on the loop
            future.cancel()
            raise

    def _stop(self) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        tasks = asyncio.all_tasks(self._loop)
        if tasks:  # those who wait are told that the server has closed
            _, late = self._loop.run_until_complete(asyncio.wait(tasks, timeout=1.0))
            for task in late:
                task.cancel()
            if late:
                self._loop.run_until_complete(asyncio.wait(late))
        self._loop.close()


def _config_text(config: Mapping[str, Any]) -> str:
    try:
        text = strictjson.compact(dict(config))
    except (TypeError, ValueError, RecursionError) as error:
        msg = f"config is not JSON: {error}"
        raise ValueError(msg) from None
    problem = next(strictjson.faults(strictjson.parse(text), "config"), None)
    if problem is not None:
        msg = f"{problem[0]} {problem[1]}"
        raise ValueError(msg)
    return text


def _upstreams_first(mission: Mission) -> list[Mission]:
    order: dict[Uuid, Mission] = {}
    stack = [(mission, False)]
    while stack:
        one, expanded = stack.pop()
        if expanded:
            order.setdefault(one.uuid, one)
        elif one.uuid not in order and (one._server is None or one is mission):  # noqa: SLF001 - our own class
            stack.append((one, True))
            stack.extend((upstream, False) for upstream in reversed(one.upstream))
    return list(order.values())


def _raise(refused: Refused | None) -> None:
    if refused is not None:
        raise MissionRefusedError(str(refused))
