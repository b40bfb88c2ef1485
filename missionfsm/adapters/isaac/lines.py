"""One TCP connection that carries lines both ways, and an alarm clock: what server and robot share."""

import asyncio
import logging
import socket
from collections.abc import Callable
from typing import Any, Final

from missionfsm.isaac.wire.framing import Decoder, WireError
from missionfsm.isaac.wire.messages import Message

LOG: Final = logging.getLogger("missionfsm.tcp")

WRITE_TIMEOUT: Final = 10.0
"""Seconds a peer may take without reading anything before its connection is dropped."""

_SLICE: Final = 1 << 14  # bytes read between two looks at whether the connection still stands
_BACKLOG: Final = 1 << 24  # bytes that may wait for a peer that does not read
_BAD_LINES: Final = 100  # in a row, before a peer is taken for something that speaks another protocol


def address(name: tuple[Any, ...]) -> str:
    """The address of a socket as people write it: host:port, with brackets where the host has colons itself."""
    host = str(name[0]).removeprefix("::ffff:") if "." in str(name[0]) else str(name[0])
    return f"[{host}]:{name[1]}" if ":" in host else f"{host}:{name[1]}"


class LineConnection(asyncio.Protocol):
    """Feeds what arrives to a decoder, and gives up on a peer that does not read, or sends nothing but rubbish.

    `opened`, `arrived` and `closed` are called in that order; `closed` exactly once if `opened` was. Where `leaving` is
    given, it is called before what came together with the end of the connection: bytes are held back until the event
    loop has looked once more whether the connection still stands.
    """

    def __init__(
        self,
        decoder: Decoder,
        *,
        opened: Callable[["LineConnection"], None],
        arrived: Callable[["LineConnection", Message | WireError], None],
        closed: Callable[["LineConnection"], None],
        leaving: Callable[["LineConnection"], None] | None = None,
        read_last_line: bool = True,
        write_timeout: float = WRITE_TIMEOUT,
    ) -> None:
        self._decoder = decoder
        self._opened = opened
        self._arrived = arrived
        self._closed = closed
        self._leaving = leaving
        self._held: list[bytes] = []
        self._dropped = False  # by us: what arrives is of no interest any more
        self._read_last_line = read_last_line
        self._write_timeout = write_timeout
        self._transport: asyncio.Transport | None = None
        self._watch: asyncio.TimerHandle | None = None
        self._bad_lines = 0
        self.gone: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Called by asyncio."""
        assert isinstance(transport, asyncio.Transport)  # noqa: S101 - a stream has no other kind
        self._transport = transport
        sock: socket.socket | None = transport.get_extra_info("socket")
        if sock is not None:  # a peer that is unplugged is noticed some day, though it never says so
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
        self._opened(self)

    def data_received(self, data: bytes) -> None:
        """Called by asyncio."""
        if self._leaving is None:
            self._read(data)
            return
        self._held.append(data)
        if len(self._held) == 1:  # the second pass from now is the first one after the loop has looked again
            loop = asyncio.get_running_loop()
            loop.call_soon(loop.call_soon, self._release)

    def eof_received(self) -> None:
        """Called by asyncio."""
        self._leave()

    def connection_lost(self, exc: Exception | None) -> None:
        """Called by asyncio."""
        if exc is not None:
            LOG.debug("connection lost: %s", exc)
        if self._watch is not None:
            self._watch.cancel()
            self._watch = None
        self._leave()
        for item in self._decoder.close() if self._read_last_line else ():
            self._arrived(self, item)
        self._transport = None
        self._closed(self)
        if not self.gone.done():
            self.gone.set_result(None)

    def pause_writing(self) -> None:
        """Called by asyncio where the peer reads more slowly than we write."""
        self._watch_writing()

    def resume_writing(self) -> None:
        """Called by asyncio when the peer has caught up."""
        if self._watch is not None:
            self._watch.cancel()
            self._watch = None

    def send(self, line: bytes) -> None:
        """Write a line, now or as soon as the peer reads; never blocks."""
        transport = self._transport
        if transport is None or transport.is_closing():
            return
        transport.write(line)
        if transport.get_write_buffer_size() > _BACKLOG:
            LOG.warning("connection to %s dropped: %d bytes wait for a peer that does not read", self.peer, _BACKLOG)
            self.abort()

    def close(self) -> None:
        """Close after what is written has gone, or after the write timeout."""
        self._dropped = True
        if self._transport is not None and not self._transport.is_closing():
            self._transport.close()
            if self._transport.get_write_buffer_size() and self._watch is None:
                self._watch_writing()

    def abort(self) -> None:
        """Close now."""
        self._dropped = True
        if self._transport is not None:
            self._transport.abort()

    @property
    def peer(self) -> str:
        """The other end as host:port, for people."""
        name = None if self._transport is None else self._transport.get_extra_info("peername")
        return address(name) if isinstance(name, tuple) else "somebody"

    @property
    def is_itself(self) -> bool:
        """True where the kernel has connected a port to itself, which loopback without a listener allows."""
        transport = self._transport
        return transport is not None and transport.get_extra_info("peername") == transport.get_extra_info("sockname")

    def _leave(self) -> None:
        if self._leaving is not None:
            self._leaving(self)
            self._release()

    def _release(self) -> None:
        held, self._held = self._held, []
        for data in held:
            self._read(data)

    def _read(self, data: bytes) -> None:
        for start in range(0, len(data), _SLICE):
            for item in self._decoder.feed(data[start : start + _SLICE]):
                if self._dropped:
                    return
                self._take(item)

    def _take(self, item: Message | WireError) -> None:
        self._bad_lines = self._bad_lines + 1 if isinstance(item, WireError) else 0
        self._arrived(self, item)
        if self._bad_lines >= _BAD_LINES:
            LOG.warning("connection to %s dropped: %d lines in a row were no messages", self.peer, _BAD_LINES)
            self.abort()

    def _watch_writing(self) -> None:
        transport = self._transport
        if transport is not None:
            left = transport.get_write_buffer_size()
            self._watch = asyncio.get_running_loop().call_later(self._write_timeout, self._check_writing, left)

    def _check_writing(self, before: int) -> None:
        transport = self._transport
        if transport is None:
            return
        if transport.get_write_buffer_size() >= before:
            LOG.warning("connection to %s dropped: the peer has read nothing for %g s", self.peer, self._write_timeout)
            self.abort()
        else:
            self._watch_writing()


class Alarm:
    """Calls `ring` at the time that was set last, on the running loop's clock."""

    def __init__(self, ring: Callable[[], None]) -> None:
        self._ring = ring
        self._loop = asyncio.get_running_loop()
        self._handle: asyncio.TimerHandle | None = None

    def now(self) -> float:
        """Seconds on the clock that `set` goes by."""
        return self._loop.time()

    def set(self, when: float | None) -> None:
        """Ring at `when`, or not at all."""
        handle = self._handle
        if handle is not None and when is not None and handle.when() <= when:
            return  # it rings early, finds nothing due and is set again: cheaper than a new one for every event
        if handle is not None:
            handle.cancel()
        self._handle = None if when is None else self._loop.call_at(when, self._rings)

    def _rings(self) -> None:
        self._handle = None
        self._ring()
