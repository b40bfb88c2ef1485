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
import queue
import ssl
import threading
from collections.abc import Callable, Coroutine, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar

from missionfsm.adapters.isaac.asyncserver import AsyncMissionServer, Callback
from missionfsm.adapters.isaac.lines import LOG
from missionfsm.adapters.isaac.mission import Mission, MissionRefusedError
from missionfsm.adapters.isaac.settings import DEFAULT_PORT, LOOPBACK
from missionfsm.isaac.runtime.missions import Status as MissionStatus
from missionfsm.isaac.runtime.profile import DOCUMENTED, Profile
from missionfsm.isaac.wire.framing import MAX_LINE

__all__ = ["AsyncMissionServer", "Mission", "MissionRefusedError", "MissionServer"]


T = TypeVar("T")


class MissionServer:
    """The mission server in a thread of its own. Listens from the moment it is made; OSError if it cannot.

    Close it, or use it in a ``with``; a program that ends without closing it ends all the same. The arguments are
    those of :class:`AsyncMissionServer`.
    """

    def __init__(  # noqa: PLR0913 - as there
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
        def made() -> AsyncMissionServer:
            return AsyncMissionServer(
                port,
                name_channel,
                host=host,
                profile=profile,
                line_limit=line_limit,
                journal=journal,
                resume=resume,
                tokens=tokens,
                tls=tls,
                http=http,
            )

        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="missionfsm-server", daemon=True)
        self._lock = threading.Lock()
        self._closed = False
        self._thread.start()
        try:
            self._server = self._call(self._start(made))
        except BaseException:
            self._stop()
            raise

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return self._server.port

    @property
    def http_port(self) -> int | None:
        """The port of the status page, if there is one."""
        return self._server.http_port

    def submit(self, mission: Mission) -> None:
        """Run the mission when its upstreams have succeeded and its robot is there. MissionRefusedError if refused."""
        self._on_loop(lambda: self._server.submit(mission))

    def cancel(self, mission: Mission) -> None:
        """See `AsyncMissionServer.cancel`."""
        self._on_loop(lambda: self._server.cancel(mission))

    def retry(self, mission: Mission) -> None:
        """See `AsyncMissionServer.retry`."""
        self._on_loop(lambda: self._server.retry(mission))

    def forget(self, *missions: Mission) -> int:
        """See `AsyncMissionServer.forget`."""
        return self._on_loop(lambda: self._server.forget(*missions))

    def get_robots(self) -> list[str]:
        """The names of the robots that are connected."""
        return self._on_loop(self._server.get_robots)

    @property
    def missions(self) -> tuple[Mission, ...]:
        """What the journal had when the server started, without what was forgotten since."""
        return self._on_loop(lambda: self._server.missions)

    def on_status(self, callback: Callback) -> Callable[[], None]:
        """Have a callback called at every change of status, in a thread of its own, so that it may take its time.

        What is returned ends that. An exception of a callback is logged and hurts nobody else.
        """
        changes: queue.SimpleQueue[tuple[Mission, MissionStatus] | None] = queue.SimpleQueue()

        def run() -> None:
            while (change := changes.get()) is not None:
                try:
                    callback(*change)
                except Exception:  # noqa: BLE001 - whatever it is, the server goes on
                    LOG.exception("a callback failed at %r", change[0])

        thread = threading.Thread(target=run, name="missionfsm-callback", daemon=True)
        thread.start()

        def put(mission: Mission, status: MissionStatus) -> None:
            changes.put((mission, status))

        ends = self._on_loop(lambda: self._server.on_status(put))

        def end() -> None:
            self._on_loop(ends)
            changes.put(None)
            if thread is not threading.current_thread():
                thread.join()

        return end

    def _on_loop(self, work: Callable[[], T]) -> T:
        async def run() -> T:
            return work()

        return self._call(run())

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
    async def _start(made: Callable[[], AsyncMissionServer]) -> AsyncMissionServer:
        server = made()
        try:
            await server.start()
        except BaseException:
            await server.close()
            raise
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
        self._loop.run_until_complete(self._loop.shutdown_default_executor())  # a host's address was looked up there
        self._loop.close()
