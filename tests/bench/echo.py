"""A bare echo server of grpcio in a process of its own; with a port as its argument, a bare relay to the server there.

The first line that it prints is its port. What a robot does for its subscribers it does as barely as grpcio lets it: a
call whose name ends in ``Tell`` is answered with nothing, and everybody who called ``Subscribe`` is sent its request.
"""

from __future__ import annotations

import asyncio
import contextlib
import sys
from collections.abc import AsyncIterator
from typing import Any

import grpc
from grpc import aio


class Echo(grpc.GenericRpcHandler):
    """Answers every unary call with its request, or sends that to all who subscribed."""

    def __init__(self) -> None:
        self._subscribers: list[asyncio.Queue[bytes]] = []

    def service(self, details: grpc.HandlerCallDetails) -> grpc.RpcMethodHandler:
        if details.method.endswith("Subscribe"):
            return grpc.unary_stream_rpc_method_handler(self._subscribe)
        return grpc.unary_unary_rpc_method_handler(self._tell if details.method.endswith("Tell") else self._echo)

    @staticmethod
    async def _echo(request: bytes, _: Any) -> bytes:
        return request

    async def _tell(self, request: bytes, _: Any) -> bytes:
        for one in self._subscribers:
            one.put_nowait(request)
        return b""

    async def _subscribe(self, request: bytes, _: Any) -> AsyncIterator[bytes]:
        mine: asyncio.Queue[bytes] = asyncio.Queue()
        self._subscribers.append(mine)
        try:
            yield request
            while True:
                yield await mine.get()
        finally:
            self._subscribers.remove(mine)


class Relay(grpc.GenericRpcHandler):
    """Passes the bytes of every unary call on, and nothing else."""

    def __init__(self, channel: aio.Channel) -> None:
        self._channel = channel

    def service(self, details: grpc.HandlerCallDetails) -> grpc.RpcMethodHandler:
        ask = self._channel.unary_unary(details.method)

        async def answer(request: bytes, _: Any) -> Any:
            return await ask(request)

        return grpc.unary_unary_rpc_method_handler(answer)


async def main(upstream: str) -> None:
    server = aio.server()
    handler = Relay(aio.insecure_channel(f"127.0.0.1:{upstream}")) if upstream else Echo()
    server.add_generic_rpc_handlers((handler,))
    port = server.add_insecure_port("127.0.0.1:0")
    await server.start()
    print(port, flush=True)
    try:
        await server.wait_for_termination()
    finally:
        await server.stop(0)


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(main("".join(sys.argv[1:])))
