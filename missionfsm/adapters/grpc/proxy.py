"""A proxy between a client and a robot: passes on everything as it is, and tells what it saw.

Bytes, metadata, trailers, deadlines and cancellations go through unchanged, unknown calls and fields as well. What is
seen is handed to a recorder as bytes, which only puts it into a queue: whatever becomes of it there, and however long
it takes to read it, traffic goes on.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import time
from collections.abc import AsyncIterator, Callable
from typing import Any

import grpc
from attrs import frozen
from grpc import aio

from missionfsm.adapters.grpc.descriptors import NotOnTheWireError, decode, methods, path
from missionfsm.adapters.grpc.server import Security
from missionfsm.adapters.grpc.target import Target
from missionfsm.bear.wire.fields import Method
from missionfsm.kernel.codec import JSON

Record = Callable[[JSON], None]
"""Takes a line of a history, with what was said in it as `LineContent`."""
HOP_BY_HOP = frozenset(("user-agent", "te", "content-type", "grpc-timeout", "grpc-accept-encoding", "grpc-encoding"))
"""Metadata that the proxy's own connection has."""
UNLIMITED = (("grpc.max_receive_message_length", -1), ("grpc.max_send_message_length", -1))
PATIENCE_SECONDS = 0.02
"""How long the end of the requests of an unknown call is awaited, before it is taken for a stream of requests."""
REFUSAL_SECONDS = 0.1
"""How long the refusal of a stream is awaited once it seems to begin: grpc gives a refusal, which has no initial
metadata, empty ones. A stream with a first message, or with initial metadata, is not held up by it."""
Context = Any
"""grpc.aio.ServicerContext, which has no type parameters that fit."""


def _passed(metadata: Any) -> tuple[tuple[str, str | bytes], ...]:  # noqa: ANN401 - grpc's metadata
    return tuple((key, value) for key, value in metadata or () if key not in HOP_BY_HOP)


@frozen
class LineContent:
    """A message as it was on the wire.

    Attributes:
        message: its name in the table of the wire.
    """

    message: str
    data: bytes

    def read(self) -> JSON:
        """Its protobuf JSON; of bytes that are no message a text that says so."""
        try:
            return decode(self.message, self.data)
        except NotOnTheWireError as error:
            return f"(malformed: {error})"


def read_line(line: dict[str, JSON]) -> dict[str, JSON]:
    """A line of a history as the format has it: what was said in it is read."""
    return {key: value.read() if isinstance(value, LineContent) else value for key, value in line.items()}


class Proxy:
    """A gRPC server that passes every call on.

    Args:
        system: which calls are recorded: those of ``bear.mission`` or ``bear.status``.
        upstream: the robot.
        record: takes the lines of the history as they are seen, see `read_line`; must not block.
        security: TLS at its own port; tokens are the robot's business.
        clock: seconds, for the lines' ``at``.
    """

    def __init__(
        self,
        system: str,
        upstream: Target,
        record: Record,
        *,
        security: Security = Security(),  # noqa: B008 - a frozen value
        clock: Callable[[], float] = time.time,
    ) -> None:
        self._security = security
        self._methods = {path(one): one for one in methods(system).values()}
        self._upstream = upstream
        self._record = record
        self._clock = clock
        self._calls = itertools.count(1)
        self._streams = itertools.count(1)
        self._channel: aio.Channel | None = None
        self._server: aio.Server | None = None
        self.port = 0

    async def start(self, host: str, port: int) -> None:
        """Listen. Raises OSError where that is impossible, or a file of TLS cannot be read."""
        target = self._upstream
        upstream, own = target.credentials(), self._security.credentials()
        if upstream is None:
            self._channel = aio.insecure_channel(target.address, UNLIMITED)
        else:
            self._channel = aio.secure_channel(target.address, upstream, UNLIMITED)
        self._server = aio.server(options=(*UNLIMITED, ("grpc.so_reuseport", 0)))
        self._server.add_generic_rpc_handlers((_Handlers(self),))
        where = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
        try:
            add = self._server.add_insecure_port
            self.port = add(where) if own is None else self._server.add_secure_port(where, own)
        except RuntimeError as error:
            raise OSError(f"{where}: {str(error).splitlines()[0]}") from None
        await self._server.start()

    async def stop(self, seconds: float = 1.0) -> None:
        """End what is under way and let go of both sides."""
        if self._server is not None:
            await self._server.stop(seconds)
        if self._channel is not None:
            await self._channel.close()

    def _note(self, line: dict[str, JSON]) -> None:
        self._record({**line, "at": round(self._clock(), 6)})

    # Passing on.

    def handler(self, name: str) -> grpc.RpcMethodHandler:
        """How a call is passed on.

        A call that nobody knows is a stream of requests and one of responses, as any call is on the wire. One that is
        known is passed on as what it is, which takes a fraction of the time.
        """
        method = self._methods.get(name)
        if method is not None and not method.streams:
            assert self._channel is not None  # noqa: S101 - it is asked only once it listens
            return grpc.unary_unary_rpc_method_handler(_Unary(self, method, self._channel.unary_unary(name)).answer)

        async def pass_one(request: bytes, context: Context) -> AsyncIterator[bytes]:
            async for one in self._passed_on(name, _only(request), context):
                yield one

        async def pass_all(requests: AsyncIterator[bytes], context: Context) -> AsyncIterator[bytes]:
            async for one in self._passed_on(name, requests, context):
                yield one

        if method is not None:
            return grpc.unary_stream_rpc_method_handler(pass_one)
        return grpc.stream_stream_rpc_method_handler(pass_all)

    async def _passed_on(self, name: str, requests: AsyncIterator[bytes], context: Context) -> AsyncIterator[bytes]:
        seen = _Seen(self, self._methods.get(name))
        call = await self._called(name, requests, context, seen)
        try:
            initial = _passed(await call.initial_metadata())
            first = asyncio.ensure_future(call.read())
            if initial or not await _fails(first):
                await context.send_initial_metadata(initial)
                seen.begun()
            response = await first
            while response is not aio.EOF:
                seen.response(response)
                yield response
                response = await call.read()
        except asyncio.CancelledError:
            # The client went away, or its deadline passed, or the robot was: which, its own code says.
            call.cancel()
            seen.gone()
            raise
        except aio.AioRpcError as error:
            await _ended(call, seen, context, error)
            return
        await _ended(call, seen, context, None)

    async def _called(self, name: str, requests: AsyncIterator[bytes], context: Context, seen: _Seen) -> Any:  # noqa: ANN401
        """The call to the robot.

        A single request goes out in one piece with its end: grpc makes INTERNAL of a refusal that comes while a
        request of a stream is still being sent. Only of calls that nobody knows it is not known whether more will come.
        """
        assert self._channel is not None  # noqa: S101 - it is asked only once it listens
        options = {
            "timeout": context.time_remaining(),
            "metadata": aio.Metadata(*_passed(context.invocation_metadata())),
        }
        first = await anext(requests, None)
        if first is not None:
            seen.request(first)
        following = asyncio.ensure_future(anext(requests, None))
        if first is not None and name not in self._methods:
            await asyncio.wait([following], timeout=PATIENCE_SECONDS)
        if first is not None and (name in self._methods or (following.done() and following.result() is None)):
            return self._channel.unary_stream(name)(first, **options)

        async def all_requests() -> AsyncIterator[bytes]:
            if first is not None:
                yield first
            request = await following
            while request is not None:
                yield request
                request = await anext(requests, None)

        return self._channel.stream_stream(name)(all_requests(), **options)


async def _fails(first: asyncio.Future[Any]) -> bool:
    """Whether a stream is refused instead of having a first message."""
    await asyncio.wait([first], timeout=REFUSAL_SECONDS)
    return first.done() and not first.cancelled() and first.exception() is not None


async def _only(request: bytes) -> AsyncIterator[bytes]:
    yield request


async def _ended(call: Any, seen: _Seen, context: Context, error: aio.AioRpcError | None) -> None:  # noqa: ANN401
    code = await call.code() if error is None else error.code()
    details = (await call.details() if error is None else error.details()) or ""
    trailing = await call.trailing_metadata() if error is None else error.trailing_metadata()
    context.set_trailing_metadata(_passed(trailing))
    seen.ended(code, details)
    if code is not grpc.StatusCode.OK:
        with contextlib.suppress(aio.AbortError):
            await context.abort(code, details)


@frozen
class _Unary:
    """Passes on the calls of a method that has one answer."""

    proxy: Proxy
    method: Method
    ask: Any

    async def answer(self, request: bytes, context: Context) -> bytes:
        """The robot's answer, or its refusal."""
        seen = _Seen(self.proxy, self.method)
        metadata = _passed(context.invocation_metadata())
        seen.request(request)
        call = self.ask(request, timeout=context.time_remaining(), metadata=aio.Metadata(*metadata))
        try:
            response: bytes = await call
        except aio.AioRpcError as error:
            initial = _passed(error.initial_metadata())
            if initial:
                await context.send_initial_metadata(initial)
            await _ended(call, seen, context, error)
            return b""  # which is not sent: the call has ended
        seen.response(response)
        initial = _passed(await call.initial_metadata())
        if initial:
            await context.send_initial_metadata(initial)
        trailing = _passed(await call.trailing_metadata())
        if trailing:
            context.set_trailing_metadata(trailing)
        return response


class _Handlers(grpc.GenericRpcHandler):
    def __init__(self, proxy: Proxy) -> None:
        self._proxy = proxy

    def service(self, handler_call_details: grpc.HandlerCallDetails) -> grpc.RpcMethodHandler:
        """Whatever is called is passed on."""
        return self._proxy.handler(handler_call_details.method)


class _Seen:
    """What is seen of one call, as lines of a history. A call that is not modelled leaves none."""

    def __init__(self, proxy: Proxy, method: Method | None) -> None:
        self._proxy = proxy
        self._method = method
        self._call = 0
        self._stream = 0
        self._over = False

    def request(self, data: bytes) -> None:
        """The request is on its way."""
        if self._method is not None and not self._call:
            self._call = next(self._proxy._calls)  # noqa: SLF001 - a part of the proxy
            self._note({"call": self._call, "method": self._method.name, "params": self._read(data, request=True)})

    def begun(self) -> None:
        """A stream has begun."""
        if self._method is not None and self._method.streams and self._call and not self._stream:
            self._stream = next(self._proxy._streams)  # noqa: SLF001 - as above
            self._note({"return": self._call, "result": {"stream": self._stream}})

    def response(self, data: bytes) -> None:
        """An answer or a message came by."""
        if self._method is None or not self._call:
            return
        if self._method.streams:
            self.begun()
            self._note({"stream": self._stream, "message": self._read(data, request=False)})
        else:
            self._over = True
            self._note({"return": self._call, "result": self._read(data, request=False)})

    def ended(self, code: grpc.StatusCode, details: str) -> None:
        """The robot ended it."""
        if self._method is None or not self._call or self._over:
            return
        self._over = True
        error = {} if code is grpc.StatusCode.OK else {"error": {"status": code.name, "message": details}}
        if self._stream:
            self._note({"stream": self._stream, "closed": True, **error})
        elif error:
            self._note({"return": self._call, **error})

    def gone(self) -> None:
        """The client went away: a stream is given up, a call stays without an answer."""
        if self._stream and not self._over:
            self._over = True
            call = next(self._proxy._calls)  # noqa: SLF001 - as above
            self._note({"call": call, "method": "cancel", "params": {"stream": self._stream}})
            self._note({"return": call, "result": {}})

    def _read(self, data: bytes, *, request: bool) -> LineContent:
        assert self._method is not None  # noqa: S101 - the callers have looked
        return LineContent(self._method.request if request else self._method.response, data)

    def _note(self, line: dict[str, JSON]) -> None:
        self._proxy._note(line)  # noqa: SLF001 - as above
