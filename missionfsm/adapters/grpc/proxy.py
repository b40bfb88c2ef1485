"""A proxy between clients and a robot: passes every byte on, and tells which came by.

A connection of a client is one of the proxy to the robot, and what comes in at one end goes out at the other. Metadata,
trailers, deadlines, cancellations, unknown calls and fields go through, as the proxy does not read them; nor do flow
control, pings or a robot that goes away need anything of it. What came by is handed to a recorder, which only puts it
into a queue: whatever becomes of it there, and however long it takes to read, traffic goes on.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import os
import socket
import ssl
import time
from collections.abc import Callable

from missionfsm.adapters.grpc.authority import Renamed
from missionfsm.adapters.grpc.overheard import Chunk, Connection, End
from missionfsm.adapters.grpc.server import Security
from missionfsm.adapters.grpc.target import Target

CONNECT_SECONDS = 20.0
"""How long the robot may take to take a connection; a client's own limit is the same."""
FLUSH_SECONDS = 10.0
"""How long one end may take to read what the other had sent before it went away."""
ALPN = ["h2"]
"""What is spoken under TLS."""

Record = Callable[[Chunk], None]


class Proxy:
    """A relay of connections.

    Args:
        upstream: the robot. If it has TLS, its name replaces the proxy's in the ``:authority`` of clients, by which a
            server with several names behind one address tells them apart.
        record: given the traffic before it is passed on; must not block.
        security: TLS at its own port; tokens are the robot's business.
        clock: seconds, for when it came by.
    """

    def __init__(
        self,
        upstream: Target,
        record: Record,
        *,
        security: Security = Security(),  # noqa: B008 - a frozen value
        clock: Callable[[], float] = time.time,
    ) -> None:
        self._host, _, port = upstream.address.rpartition(":")
        self._address = self._host.strip("[]"), int(port)
        self._upstream = upstream
        self._security = security
        self._record = record
        self._clock = clock
        self._numbers = itertools.count(1)
        self._pairs: set[_Pair] = set()
        self._server: asyncio.Server | None = None
        self._tls: ssl.SSLContext | None = None
        self.port = 0

    async def start(self, host: str, port: int) -> None:
        """Listen. Raises OSError where that is impossible, or a file of TLS cannot be read."""
        self._tls = _to_robot(self._upstream)
        own = _for_clients(self._security)
        loop = asyncio.get_running_loop()
        try:
            self._server = await loop.create_server(self._accept, host, port, ssl=own)
        except OSError as error:
            is_plain = error.errno is not None and not isinstance(error, socket.gaierror)
            said = os.strerror(error.errno or 0) if is_plain else error.strerror  # asyncio adds many words of its own
            raise OSError(f"{host}:{port}: {said}") from None
        self.port = self._server.sockets[0].getsockname()[1]

    async def stop(self, seconds: float = 1.0) -> None:
        """Let go of both sides.

        Args:
            seconds: how long what has come by may take to go out.
        """
        if self._server is not None:
            self._server.close()
        for pair in tuple(self._pairs):
            pair.close()
        if self._pairs:
            await asyncio.wait([pair.over for pair in self._pairs], timeout=seconds)
        for pair in tuple(self._pairs):
            pair.abort()
        await asyncio.sleep(0)  # connections that are lost say so in the next turn of the loop

    def _accept(self) -> _Side:
        """A client connects."""
        number = Connection(next(self._numbers))

        def seen(end: End, data: bytes) -> None:
            self._record(Chunk(self._clock(), number, end, data))

        pair = _Pair(self, seen)
        self._pairs.add(pair)
        return pair.client

    async def connect(self, pair: _Pair) -> None:
        """Connect a client to the robot; where that cannot be, the client is let go, as a robot that is away would."""
        host, port = self._address
        name = host if self._tls is not None else None
        loop = asyncio.get_running_loop()
        try:
            async with asyncio.timeout(CONNECT_SECONDS):
                await loop.create_connection(lambda: pair.robot, host, port, ssl=self._tls, server_hostname=name)
        except (OSError, TimeoutError):
            pair.lost(pair.robot)

    def renamed(self) -> Renamed | None:
        """What puts the robot's name into what a client asks; None where that is left alone."""
        return Renamed(self._upstream.address) if self._tls is not None else None

    def forget(self, pair: _Pair) -> None:
        """Both sides are gone."""
        self._pairs.discard(pair)
        if not pair.over.done():
            pair.over.set_result(None)


class _Pair:
    """A connection of a client and the one to the robot that it became."""

    def __init__(self, proxy: Proxy, seen: Callable[[End, bytes], None]) -> None:
        self._proxy = proxy
        self._seen = seen
        self._there = set(End)
        self.over: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._renamed = proxy.renamed()
        self._connecting: asyncio.Task[None] | None = None
        self.client = _Side(self, End.CLIENT)
        self.robot = _Side(self, End.ROBOT)

    def made(self, side: _Side) -> None:
        """One side is there: a client waits until the robot is."""
        if side is self.client:
            side.transport.pause_reading()
            self._connecting = asyncio.get_running_loop().create_task(self._proxy.connect(self))
        elif self.client.transport.is_closing():
            side.transport.abort()
        else:
            self.client.transport.resume_reading()

    def came(self, side: _Side, data: bytes) -> None:
        """Bytes came in on one side."""
        self._seen(side.end, data)
        if side is self.client and self._renamed is not None:
            try:
                data = self._renamed(data)
            except ValueError:  # it is no HTTP/2, and no robot would take it
                self.abort()
                return
        if not self.other(side).transport.is_closing():
            self.other(side).transport.write(data)

    def other(self, side: _Side) -> _Side:
        """The side across."""
        return self.robot if side is self.client else self.client

    def finished(self, side: _Side) -> None:
        """One side sends no more: nor does the other get any more."""
        self._say_gone(side)
        transport = self.other(side).transport
        if not self._there:
            self.close()
        elif transport.can_write_eof():
            with contextlib.suppress(OSError):
                transport.write_eof()
        else:
            self._close(self.other(side))

    def lost(self, side: _Side) -> None:
        """End the other side as well, once it has been sent everything: this one is gone for good."""
        self._say_gone(side)
        side.gone = True
        if side is self.client and not self.robot.connected and self._connecting is not None:
            self._connecting.cancel()
            self._say_gone(self.robot)
            self.robot.gone = True
        other = self.other(side)
        if not other.gone:
            self._close(other)
        elif side.gone:
            self._proxy.forget(self)

    def _say_gone(self, side: _Side) -> None:
        if side.end in self._there:
            self._there.discard(side.end)
            self._seen(side.end, b"")

    @staticmethod
    def _close(side: _Side) -> None:
        if side.connected and not side.transport.is_closing():
            side.transport.close()
            asyncio.get_running_loop().call_later(FLUSH_SECONDS, side.transport.abort)

    def close(self) -> None:
        """Let go of both sides."""
        for side in (self.client, self.robot):
            self._close(side)

    def abort(self) -> None:
        """Let go of both sides at once."""
        for side in (self.client, self.robot):
            if side.connected:
                side.transport.abort()


class _Side(asyncio.Protocol):
    """One side of a pair."""

    transport: asyncio.Transport

    def __init__(self, pair: _Pair, end: End) -> None:
        self._pair = pair
        self.end = end
        self.connected = False
        self.gone = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """It is there."""
        assert isinstance(transport, asyncio.Transport)  # noqa: S101 - so is every one of TCP
        transport.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        self.transport = transport
        self.connected = True
        self._pair.made(self)

    def data_received(self, data: bytes) -> None:
        """Bytes came in."""
        self._pair.came(self, data)

    def eof_received(self) -> bool:
        """No more will come; True for what can still be sent the other way, which TLS has not."""
        self._pair.finished(self)
        return self.transport.can_write_eof()

    def connection_lost(self, _: Exception | None) -> None:
        """It is gone."""
        self._pair.lost(self)

    def pause_writing(self) -> None:
        """It does not read as fast as the other one sends."""
        with contextlib.suppress(RuntimeError):  # that one is about to go
            self._pair.other(self).transport.pause_reading()

    def resume_writing(self) -> None:
        """It reads again."""
        with contextlib.suppress(RuntimeError):  # as above
            self._pair.other(self).transport.resume_reading()


def _to_robot(target: Target) -> ssl.SSLContext | None:
    """What the robot's certificate is checked with; None without TLS. Raises OSError for a file that cannot be read."""
    if not target.certificate:
        return None
    context = ssl.create_default_context(cafile=None if target.certificate == "system" else target.certificate)
    context.set_alpn_protocols(ALPN)
    return context


def _for_clients(security: Security) -> ssl.SSLContext | None:
    """TLS of the proxy's own port; None without. Raises OSError for files that cannot be read."""
    if not security.certificate:
        return None
    context = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
    context.load_cert_chain(security.certificate, security.key)
    context.set_alpn_protocols(ALPN)
    return context
