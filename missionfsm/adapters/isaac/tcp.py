"""Mission server and robot on real sockets. MissionSubmission › JsonTcpServer Class, JsonTcpClient Codelet.

Here are the sockets, the clock and the dice; what is done with them is decided by the very same
:class:`~missionfsm.isaac.runtime.server.MissionServerCore` and :class:`~missionfsm.isaac.runtime.robot.RobotCore` that
run under the oracle. Everything happens on one event loop; nothing here blocks it, and no peer can hold up another:
reading is cut into slices, writing never waits, a peer that does not read is dropped.
"""

import asyncio
import contextlib
import errno
import os
import random
import socket
import time
import uuid as uuids
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Final

from missionfsm.adapters.isaac.journal import Bookkeeper, Journal, JournalError
from missionfsm.adapters.isaac.lines import LOG, Alarm, LineConnection, address
from missionfsm.adapters.isaac.settings import Dialling, Settings
from missionfsm.isaac.runtime.graph import topological_order
from missionfsm.isaac.runtime.missionfile import MissionFile, submit_all
from missionfsm.isaac.runtime.missions import Close, Effect, Ignored, MissionRequest, Refused, Send
from missionfsm.isaac.runtime.robot import RobotCore, RobotEffect, Transmit
from missionfsm.isaac.runtime.server import MissionServerCore
from missionfsm.isaac.wire.framing import MAX_LINE, Decoder, WireError, encode
from missionfsm.isaac.wire.messages import Message, Payload, Uuid, stamp

BACKLOG: Final = 1024
_NOT_HERE: Final = (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT)
_GRACE: Final = 0.5  # seconds for what is written to go out when the server closes


def fresh_uuid() -> Uuid:
    """An identifier that nobody has used."""
    return Uuid.of(uuids.uuid4().int)


def _nothing(_: object) -> None:
    """Observe nothing."""


async def listening(host: str, port: int) -> tuple[socket.socket, ...]:
    """Sockets bound to every address of a host, all on one port; ``::`` takes IPv4 as well. OSError if there is none.

    Port 0 is any free one. No host is every address of this machine.
    """
    host = host or ("::" if socket.has_dualstack_ipv6() else "0.0.0.0")  # noqa: S104 - what no host means
    loop = asyncio.get_running_loop()
    found = await loop.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    sockets: list[socket.socket] = []
    for family, _, _, _, name in dict.fromkeys(found):
        place = (name[0], sockets[0].getsockname()[1] if sockets else port, *name[2:])
        both = name[0] == "::" and socket.has_dualstack_ipv6()
        try:
            sockets.append(socket.create_server(place, family=family, backlog=BACKLOG, dualstack_ipv6=both))
        except OSError as error:
            if error.errno in _NOT_HERE and sockets:  # localhost is ::1 as well, also where there is no IPv6
                continue
            for one in sockets:
                one.close()
            raise OSError(error.errno, os.strerror(error.errno or 0)) from None
    return tuple(sockets)


class TcpMissionServer:
    """A mission server that listens. Made and used on one event loop; `observer` is told of every effect.

    `port` says where, once started. What a `journal` has is restored on start. A journal that cannot be written ends
    the server: `failed` then has the reason, nothing more is sent, and every connection is dropped.
    """

    def __init__(
        self,
        settings: Settings = Settings(),
        *,
        journal: Journal | None = None,
        observer: Callable[[Effect], None] = _nothing,
    ) -> None:
        self._settings = settings
        self.core = MissionServerCore(
            settings.profile,
            name_channel=settings.name_channel,
            line_limit=settings.line_limit,
            tokens=settings.tokens,
        )
        self.port = settings.port
        self._observer = observer
        self._alarm = Alarm(self._ring)
        self._servers: list[asyncio.Server] = []
        self.addresses: tuple[str, ...] = ()
        self._numbers: dict[LineConnection, int] = {}
        self._connections: dict[int, LineConnection] = {}
        self.failed: asyncio.Future[JournalError] = asyncio.get_running_loop().create_future()
        self._journal = journal
        self._books = None if journal is None else Bookkeeper(self.core, journal)
        self._peers: dict[int, str] = {}
        self._accepted = 0
        self._closing = False

    async def start(self) -> None:
        """Take up what the journal has, and listen. OSError where the address cannot be had; JournalError."""
        if self._journal is not None and self._books is not None:
            snapshots = self._journal.missions()
            self._books.restore(snapshots)
            self._perform(self.core.restore(snapshots, self._settings.resume, fresh_uuid, self._alarm.now()))
            if self.failed.done():
                raise self.failed.result()
        sockets = await listening(self._settings.host, self.port)
        loop = asyncio.get_running_loop()
        self._servers = [
            await loop.create_server(self._accept, sock=one, backlog=BACKLOG, ssl=self._settings.tls) for one in sockets
        ]
        self.addresses = tuple(address(one.getsockname()) for one in sockets)
        self.port = sockets[0].getsockname()[1]

    async def close(self) -> None:
        """Stop listening and drop everybody. Missions keep the status they have."""
        self._closing = True
        self._alarm.set(None)
        for server in self._servers:
            server.close()
        waiting = [connection.gone for connection in self._numbers]
        for connection in tuple(self._numbers):
            connection.close()
        if waiting:
            await asyncio.wait(waiting, timeout=_GRACE)
        for connection in tuple(self._numbers):
            connection.abort()
        for server in self._servers:
            await server.wait_closed()

    def peer(self, connection: int) -> str:
        """The other end of a connection as host:port, as long as somebody may speak of it."""
        return self._peers.get(connection, "somebody")

    def robots(self) -> list[tuple[str, str | None]]:
        """Every robot that is connected or has missions to do, and its other end if it is connected."""
        found = self.core.robots()
        return [(one.robot, None if one.connection is None else self.peer(one.connection)) for one in found]

    def create(self, request: MissionRequest, uuid: Uuid) -> Refused | None:
        """Make a mission known; see `MissionServerCore.create`."""
        refused = self.core.create(request, uuid)
        if refused is None and self._books is not None:
            self._books.create(uuid)
        return refused

    def submit(self, uuid: Uuid) -> Refused | None:
        """Run a created mission; see `MissionServerCore.submit`."""
        return self._taken(self.core.submit(uuid, self._alarm.now()), submitted=True)

    def submit_file(self, file: MissionFile, fresh: tuple[Uuid, ...]) -> Refused | None:
        """Create and submit all missions of a file."""
        result = submit_all(self.core, file, fresh, self._alarm.now())
        if self._books is not None:
            for index in topological_order([entry.upstream for entry in file.missions]):
                self._books.create(fresh[index])
        return self._taken(result, submitted=True)

    def cancel(self, uuid: Uuid) -> Refused | None:
        """Give a mission up; see `MissionServerCore.cancel`."""
        return self._taken(self.core.cancel(uuid, self._alarm.now()))

    def retry(self, uuid: Uuid) -> Refused | None:
        """Run a mission that failed once more; see `MissionServerCore.retry`."""
        return self._taken(self.core.retry(uuid, fresh_uuid(), self._alarm.now()))

    def forget(self, uuid: Uuid) -> Refused | None:
        """Remember nothing more of a mission that has ended; see `MissionServerCore.forget`."""
        refused = self.core.forget(uuid)
        if refused is None and self._books is not None:
            with self._fatal():
                self._books.forget([uuid])
        return refused

    def _taken(self, result: Refused | tuple[Effect, ...], *, submitted: bool = False) -> Refused | None:
        """Raises JournalError where it was taken and cannot be kept."""
        if isinstance(result, Refused):
            return result
        self._perform(result, submitted=submitted)
        if self.failed.done():
            raise self.failed.result()
        return None

    def _accept(self) -> LineConnection:
        return LineConnection(
            Decoder(limit=self._settings.line_limit, numbers=self._settings.profile.ai_25 == "a"),
            opened=self._opened,
            arrived=self._arrived,
            closed=self._closed,
            leaving=self._leaving,
            read_last_line=self._settings.profile.ai_26_last == "c",
            write_timeout=self._settings.write_timeout,
        )

    def _opened(self, connection: LineConnection) -> None:
        self._accepted += 1
        self._numbers[connection] = self._accepted
        self._connections[self._accepted] = connection
        self._peers[self._accepted] = connection.peer
        if self._closing:
            connection.abort()
            return
        self._perform(self.core.connected(self._accepted, self._alarm.now()))

    def _arrived(self, connection: LineConnection, item: Message | WireError) -> None:
        if not self._closing:
            self._perform(self.core.received(self._numbers[connection], item, self._alarm.now()))

    def _leaving(self, connection: LineConnection) -> None:
        self.core.leaving(self._numbers[connection])

    def _closed(self, connection: LineConnection) -> None:
        number = self._numbers.pop(connection)
        if not self._closing:
            self._perform(self.core.disconnected(number, self._alarm.now()))
        del self._connections[number], self._peers[number]

    def _ring(self) -> None:
        self._perform(self.core.advance(self._alarm.now()))

    def _perform(self, effects: Sequence[Effect], *, submitted: bool = False) -> None:
        with self._fatal():
            if self._books is not None:
                self._books.note(effects, submitted=submitted)
            for effect in effects:
                if isinstance(effect, Send):
                    self._send(effect)
                elif isinstance(effect, Close):
                    if (closed := self._connections.get(effect.connection)) is not None:
                        closed.close()
                elif isinstance(effect, Ignored):
                    LOG.debug("connection %d: %s", effect.connection, effect.reason)
                self._observer(effect)
            if not self._closing:
                self._alarm.set(self.core.next_deadline())

    @contextlib.contextmanager
    def _fatal(self) -> Iterator[None]:
        """A journal that cannot be written ends everything: what is not kept is neither sent nor told."""
        try:
            yield
        except JournalError as error:
            self._closing = True
            self._alarm.set(None)
            if not self.failed.done():
                self.failed.set_result(error)
            for connection in tuple(self._numbers):
                connection.abort()

    def _send(self, effect: Send) -> None:
        connection = self._connections.get(effect.connection)
        if connection is not None:
            uuid = effect.header or fresh_uuid()
            message = stamp(effect.payload, effect.channel, pubtime=time.time_ns(), uuid=uuid)
            connection.send(encode(message, header_uuid_as_numbers=self._settings.profile.header_uuid_as_numbers))


class TcpRobot:
    """A robot that connects, and connects again when the connection drops, for as long as `run` runs.

    `observer` is told of every effect, `notes` of what happens to the connection.
    """

    def __init__(
        self,
        core: RobotCore,
        dialling: Dialling = Dialling(),
        *,
        line_limit: int = MAX_LINE,
        observer: Callable[[RobotEffect], None] = _nothing,
        notes: Callable[[str], None] = _nothing,
    ) -> None:
        self.core = core
        self._dialling = dialling
        self._line_limit = line_limit
        self._observer = observer
        self._notes = notes
        self._alarm: Alarm | None = None
        self._connection: LineConnection | None = None

    async def run(self) -> None:
        """Be a robot until cancelled."""
        self._alarm = Alarm(self._ring)
        delay = self._dialling.first_delay
        try:
            while True:
                began = self._alarm.now()
                if await self._one_connection() and self._alarm.now() - began > delay:
                    delay = self._dialling.first_delay
                await asyncio.sleep(delay * random.uniform(0.5, 1.0))  # noqa: S311 - no secret
                delay = min(2 * delay, self._dialling.longest_delay)
        finally:
            self._alarm.set(None)
            if (connection := self._connection) is not None:
                connection.close()
                await asyncio.wait([connection.gone], timeout=_GRACE)
                connection.abort()

    async def _one_connection(self) -> bool:
        """Connect and stay until the connection drops; False if it could not be made."""
        loop, where = asyncio.get_running_loop(), self._dialling
        try:
            async with asyncio.timeout(where.connect_timeout):
                _, connection = await loop.create_connection(self._make, where.host, where.port, ssl=where.tls)
        except OSError as error:  # a TimeoutError is one too
            self._notes(f"cannot connect to {address((where.host, where.port))}: {error or type(error).__name__}")
            return False
        await connection.gone
        return True

    def _make(self) -> LineConnection:
        return LineConnection(
            Decoder(limit=self._line_limit),
            opened=self._opened,
            arrived=self._arrived,
            closed=self._closed,
        )

    def _opened(self, connection: LineConnection) -> None:
        if connection.is_itself:
            connection.abort()
            return
        self._connection = connection
        self._notes(f"connected to {connection.peer}")
        self._perform(self.core.connected(self._now()))

    def _arrived(self, connection: LineConnection, item: Message | WireError) -> None:
        if connection is self._connection:
            if isinstance(item, WireError):
                self._notes(f"from the server: {item}")
            self._perform(self.core.received(item, self._now()))

    def _closed(self, connection: LineConnection) -> None:
        if connection is self._connection:
            self._connection = None
            self._notes("disconnected")
            self._perform(self.core.disconnected(self._now()))

    def _now(self) -> float:
        assert self._alarm is not None  # noqa: S101 - set before there is a connection
        return self._alarm.now()

    def _ring(self) -> None:
        self._perform(self.core.advance(self._now()))

    def _perform(self, effects: Iterable[RobotEffect]) -> None:
        for effect in effects:
            if isinstance(effect, Transmit) and self._connection is not None:
                self._connection.send(_line(effect.payload, effect.channel))
            self._observer(effect)
        if self._alarm is not None:
            self._alarm.set(self.core.next_deadline())


def _line(payload: Payload, channel: str) -> bytes:
    return encode(stamp(payload, channel, pubtime=time.time_ns(), uuid=fresh_uuid()))
