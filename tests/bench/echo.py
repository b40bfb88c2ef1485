"""A bare echo server of grpcio in a process of its own; the first line that it prints is its port."""

from __future__ import annotations

import asyncio
from typing import Any

import grpc
from grpc import aio


class Echo(grpc.GenericRpcHandler):
    """Answers every unary call with its request."""

    def service(self, _: grpc.HandlerCallDetails) -> grpc.RpcMethodHandler:
        async def echo(request: bytes, _: Any) -> bytes:
            return request

        return grpc.unary_unary_rpc_method_handler(echo)


async def main() -> None:
    server = aio.server()
    server.add_generic_rpc_handlers((Echo(),))
    port = server.add_insecure_port("127.0.0.1:0")
    await server.start()
    print(port, flush=True)
    await server.wait_for_termination()


if __name__ == "__main__":
    asyncio.run(main())
