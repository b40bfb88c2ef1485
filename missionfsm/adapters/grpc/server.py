"""The reference of a Bear system as a gRPC server.

One event loop in one thread of its own serves all callers; the reference is asked under a lock and answers in
microseconds. A stream costs a task and a queue, no thread.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import contextlib
import functools
import socket
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine
from pathlib import Path
from typing import Any, Self, TypeVar

import grpc
from attrs import frozen
from grpc import aio
from grpc_reflection.v1alpha import reflection

from missionfsm.adapters.grpc import control
from missionfsm.adapters.grpc.answers import Answered, Robots, Spoilt
from missionfsm.adapters.grpc.descriptors import (
    SERVICES,
    NotOnTheWireError,
    decode,
    encode,
    methods,
    path,
    pool,
)
from missionfsm.adapters.grpc.faults import Dice, Faults
from missionfsm.adapters.grpc.outgoing import Inbox, Outgoing
from missionfsm.bear.wire.fields import PACKAGE
from missionfsm.bear.wire.methods import Method
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.subject import SubjectError

MAX_UNSENT_MESSAGES = 10_000
"""Messages that wait for a subscriber who does not read; then its stream ends with RESOURCE_EXHAUSTED."""
REMEMBERED_MESSAGES = 100
"""Messages whose bytes are remembered, since other streams show the same one."""
MAX_MESSAGE_BYTES = 4 * 1024 * 1024
"""What gRPC takes of one message unless told otherwise."""
STOP_SECONDS = 0.1
"""How long calls that are under way may take when the server stops."""

SETTLE_SECONDS = 5.0
"""How long ``Settle`` waits for messages on their way to a subscriber who does not read."""

RULE_KEY, CITE_KEY = "missionfsm-rule", "missionfsm-cite"
"""Trailing metadata of a refusal: the ids of the rules, and their places on the page."""

EXPIRED = object()
"""Stands among the messages of a stream where the token of its subscriber is good no more."""

Context = Any
"""grpc.aio.ServicerContext, which has no type parameters that fit."""

_Result = TypeVar("_Result")


@frozen
class Security:
    """Who may call, and how it is hidden from others.

    Attributes:
        certificate, key: files in PEM; both or neither.
        token: what a caller has to send as ``authorization: Bearer TOKEN``; "" for nothing.
    """

    certificate: str = ""
    key: str = ""
    token: str = ""

    def credentials(self) -> grpc.ServerCredentials | None:
        """The credentials of TLS; None without. Raises OSError for files that cannot be read."""
        if not self.certificate:
            return None
        pair = (Path(self.key).read_bytes(), Path(self.certificate).read_bytes())
        return grpc.ssl_server_credentials([pair])


class _Tokens(aio.ServerInterceptor):
    """Refuses whoever does not send the token.

    Attributes:
        token: the one that is good now.
    """

    def __init__(self, token: str) -> None:
        self.token = token
        self._refusal = grpc.unary_unary_rpc_method_handler(self._refuse)

    @staticmethod
    async def _refuse(_: bytes, context: Context) -> None:
        await context.abort(grpc.StatusCode.UNAUTHENTICATED, "the token is missing or wrong")

    async def intercept_service(
        self,
        continuation: Callable[[grpc.HandlerCallDetails], Awaitable[grpc.RpcMethodHandler]],
        handler_call_details: grpc.HandlerCallDetails,
    ) -> grpc.RpcMethodHandler:
        """Let through what has the token."""
        sent = dict(handler_call_details.invocation_metadata or ())
        good = sent.get("authorization") == f"Bearer {self.token}"
        return await continuation(handler_call_details) if good else self._refusal


class _Handlers(grpc.GenericRpcHandler):
    """The calls of a system, and the control service."""

    def __init__(self, live: Robots, dice: Dice, loop: asyncio.AbstractEventLoop, *, with_control: bool) -> None:
        self._live = live
        self._inbox = Inbox(loop)
        self._dice = dice
        self._by_path = {path(one): self._handler(one) for one in methods(live.system.name).values()}
        self._open: set[Outgoing] = set()
        self._bytes: dict[int, tuple[JSON, bytes]] = {}
        if with_control:
            for name in control.UNARY:
                self._by_path[f"/{control.SERVICE}/{name}"] = grpc.unary_unary_rpc_method_handler(
                    getattr(self, f"_{name.lower()}")
                )
            self._by_path[f"/{control.SERVICE}/History"] = grpc.unary_stream_rpc_method_handler(self._history)

    def service(self, handler_call_details: grpc.HandlerCallDetails) -> grpc.RpcMethodHandler | None:
        """The handler of a call; None, which means UNIMPLEMENTED, if the call is not modelled."""
        return self._by_path.get(handler_call_details.method)

    def _handler(self, method: Method) -> grpc.RpcMethodHandler:
        if method.streams:
            return grpc.unary_stream_rpc_method_handler(functools.partial(self._stream, method))

        return grpc.unary_unary_rpc_method_handler(functools.partial(self._unary, method))

    @staticmethod
    async def _read(method: Method, request: bytes, context: Context) -> JSON:
        try:
            return decode(method.request, request)
        except NotOnTheWireError as error:
            await context.abort(grpc.StatusCode.INVALID_ARGUMENT, f"{method.name}: {error}")

    async def _unary(self, method: Method, request: bytes, context: Context) -> bytes:
        params = await self._read(method, request, context)
        spoilt = self._kept_from() or self._late()
        answered = self._live.call(method.name, params, spoilt)
        if answered.error is not None:
            await _refuse(context, answered)
        return await _said(context, method, lambda: encode(method.response, answered.result))

    def _kept_from(self) -> Spoilt | None:
        """What keeps a call, or a subscription, from having any effect."""
        if self._dice.unavailable():
            return Spoilt({"status": "UNAVAILABLE", "message": "made up: the robot is not reached"}, applied=False)
        if self._dice.internal():
            return Spoilt({"status": "INTERNAL", "message": "made up: the robot breaks down"}, applied=False)
        return None

    def _late(self) -> Spoilt | None:
        """What keeps a caller from hearing in time what became of a call."""
        deadline = self._dice.deadline()
        if deadline:
            error = {"status": "DEADLINE_EXCEEDED", "message": "made up: no confirmation in time"}
            return Spoilt(error, applied=deadline == "applied")
        return None

    def _encoded(self, method: Method, message: JSON) -> bytes:
        """The bytes of a message; streams that show the same event share the message, and so its bytes."""
        known = self._bytes.get(id(message))
        if known is None or known[0] is not message:
            if len(self._bytes) >= REMEMBERED_MESSAGES:
                self._bytes.clear()
            known = self._bytes[id(message)] = (message, encode(method.response, message))
        return known[1]

    async def _stream(self, method: Method, request: bytes, context: Context) -> AsyncIterator[bytes]:
        params = await self._read(method, request, context)
        loop = asyncio.get_running_loop()
        outgoing = Outgoing(self._inbox, dict(context.invocation_metadata() or ()), self._dice.faults.late)
        answered = self._live.subscribe(method.name, params, outgoing.come, self._kept_from())
        if answered.error is not None:
            await _refuse(context, answered)
        self._open.add(outgoing)
        # A subscriber is not kept waiting for a first change.
        await context.send_initial_metadata(((control.BEGUN_KEY, "true"),))
        ends = None if self._dice.faults.ends is None else loop.time() + self._dice.faults.ends
        first = True
        try:
            while True:
                message = await outgoing.next(None if ends is None else ends - loop.time())
                if message is None:
                    return
                if message is EXPIRED:
                    await context.abort(grpc.StatusCode.UNAUTHENTICATED, "the token has expired")
                if outgoing.unsent > MAX_UNSENT_MESSAGES:
                    await context.abort(grpc.StatusCode.RESOURCE_EXHAUSTED, "the subscriber does not read")
                data = await _said(context, method, functools.partial(self._encoded, method, message))
                copies = self._dice.copies(first=first)
                for _ in range(copies):
                    yield data
                outgoing.sent += copies
                first = False
        finally:
            self._open.discard(outgoing)
            outgoing.close()
            self._live.cancel(answered.result)

    async def expire(self) -> None:
        """End every stream, whose token is good no more."""
        for one in self._open:
            one.take(EXPIRED)

    # The control service.

    async def _describe(self, _: bytes, __: Context) -> bytes:
        system = self._live.system
        return control.pack({"system": system.name, "drives": list(system.spec.drives)})

    async def _reset(self, request: bytes, context: Context) -> bytes:
        try:
            self._live.reset(control.unpack(request).get("world", {}))
        except (UnreadableError, SubjectError) as error:
            await context.abort(grpc.StatusCode.INVALID_ARGUMENT, str(error))
        return control.pack({})

    async def _drive(self, request: bytes, context: Context) -> bytes:
        try:
            return control.pack(self._live.drive(control.unpack(request)))
        except (UnreadableError, SubjectError) as error:
            await context.abort(grpc.StatusCode.INVALID_ARGUMENT, str(error))
            raise

    async def _settle(self, request: bytes, _: Context) -> bytes:
        session = str(control.unpack(request).get("session", ""))
        mine = [one for one in self._open if one.session == session]
        if mine:
            await asyncio.wait([one.flushed() for one in mine], timeout=SETTLE_SECONDS)
        return control.pack({"streams": {one.stream: one.sent for one in mine if one in self._open}})

    async def _history(self, _: bytes, __: Context) -> AsyncIterator[bytes]:
        for line in self._live.history():
            yield control.pack(line)


async def _said(context: Context, method: Method, encoded: Callable[[], bytes]) -> bytes:
    """The bytes of an answer or a message. INTERNAL if binary protobuf cannot say it, as under a JSON-only reading."""
    try:
        return encoded()
    except NotOnTheWireError as error:
        await context.abort(grpc.StatusCode.INTERNAL, f"{method.name}: binary protobuf cannot say this: {error}")
        raise


async def _refuse(context: Context, answered: Answered) -> None:
    """End a call with a documented error. The trailing metadata has the rules that demand it, and their places."""
    assert answered.error is not None  # noqa: S101 - the caller has looked
    context.set_trailing_metadata(
        (
            *((RULE_KEY, rule) for rule in answered.rules),
            *((CITE_KEY, _ascii(cite)) for cite in answered.cites),
        )
    )
    await context.abort(grpc.StatusCode[answered.error["status"]], answered.error.get("message", ""))


def _ascii(text: str) -> str:
    """Metadata is ASCII; the arrows of a citation are not."""
    return text.replace("›", ">").encode("ascii", "replace").decode()


class Server:
    """A reference that is served.

    Args:
        live: the reference.
        host, port: where it listens; port 0 takes a free one.
        faults, seed: what goes wrong on the network, made up.
        security: TLS and a token.
        with_control: whether the control service is there.

    Attributes:
        port: where it really listens.

    Raises:
        OSError: it cannot listen there, or a file of `security` cannot be read.
    """

    def __init__(
        self,
        live: Robots,
        *,
        host: str = "127.0.0.1",
        port: int = 0,
        faults: Faults = Faults(),  # noqa: B008 - a frozen value
        seed: int = 0,
        security: Security = Security(),
        with_control: bool = True,
    ) -> None:
        self.live = live
        self._host = f"[{host}]" if ":" in host else host
        self._security = security
        self._loop = asyncio.new_event_loop()
        self._handlers = _Handlers(live, Dice(faults, seed), self._loop, with_control=with_control)
        self._with_control = with_control
        self._tokens = _Tokens(security.token)
        self._thread = threading.Thread(target=self._loop.run_forever, name="missionfsm-grpc", daemon=True)
        self._thread.start()
        self._server: aio.Server | None = None
        try:
            self.port: int = self._run(self._start(port))
        except BaseException:
            self.stop()
            raise

    @property
    def target(self) -> str:
        """What a client connects to."""
        return f"{self._host}:{self.port}"

    def _run(self, work: Coroutine[object, object, _Result]) -> _Result:
        return asyncio.run_coroutine_threadsafe(work, self._loop).result()

    async def _start(self, port: int) -> int:
        # SO_REUSEPORT would let two servers share a port, and calls would go to either.
        options = (("grpc.so_reuseport", 0), ("grpc.max_receive_message_length", MAX_MESSAGE_BYTES))
        interceptors = (self._tokens,) if self._security.token else ()
        server = self._server = aio.server(options=options, interceptors=interceptors)
        server.add_generic_rpc_handlers((self._handlers,))
        descriptors = pool()
        names = [f"{PACKAGE}.{SERVICES[self.live.system.name]}", reflection.SERVICE_NAME]
        if self._with_control:
            control.add_to(descriptors)
            names.append(control.SERVICE)
        reflection.enable_server_reflection(names, server, pool=descriptors)
        credentials = self._security.credentials()
        where = f"{self._host}:{port}"
        if port:
            self._must_be_free(port)
        try:
            bound = (
                server.add_insecure_port(where) if credentials is None else server.add_secure_port(where, credentials)
            )
        except RuntimeError as error:
            raise OSError(f"{where}: {str(error).splitlines()[0]}") from None
        if bound == 0:
            raise OSError(f"{where}: the port cannot be had")
        await server.start()
        return bound

    def _must_be_free(self, port: int) -> None:
        """Raise OSError, which says why, for a port that cannot be had: gRPC writes to the terminal and says less."""
        try:
            family, kind, protocol, _, where = socket.getaddrinfo(
                self._host.strip("[]"), port, type=socket.SOCK_STREAM
            )[0]
            with socket.socket(family, kind, protocol) as probe:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                probe.bind(where)
        except OSError as error:
            raise OSError(f"{self._host}:{port}: {error.strerror}") from None

    def renew(self, token: str) -> None:
        """From now on another token is good, and streams that were opened with the one before end UNAUTHENTICATED.

        Raises:
            ValueError: there is none to renew.
        """
        if not self._security.token:
            raise ValueError("nobody has to send a token here, so that none expires")
        self._tokens.token = token
        self._run(self._handlers.expire())

    def stop(self) -> None:
        """End what is under way and let go of the port; a second time does nothing."""
        if self._loop.is_closed():
            return
        if self._server is not None:
            with contextlib.suppress(concurrent.futures.CancelledError):
                self._run(self._server.stop(STOP_SECONDS))
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
