"""A proxy in this process, between a robot that is served here and a client that tests use."""

from __future__ import annotations

import asyncio
import threading
import time
from typing import Any

from missionfsm.adapters.grpc.descriptors import decode, encode, methods, path
from missionfsm.adapters.grpc.overheard import Chunk, Overheard
from missionfsm.adapters.grpc.proxy import Proxy
from missionfsm.adapters.grpc.server import Security
from missionfsm.adapters.grpc.target import Target
from missionfsm.kernel.codec import JSON

WAIT = 10.0
"""Seconds after which an answer that does not come fails a test."""
METHODS = methods("bear.mission")
NAVIGATE = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}


def eventually(holds: Any) -> bool:
    """Whether something comes to hold within the time."""
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        if holds():
            return True
        time.sleep(0.01)
    return False


def as_they_are() -> Any:
    """For `Recorder`: what comes by are lines."""
    return lambda line: (line,)


class Relay:
    """A proxy that runs in a loop of its own."""

    def __init__(
        self, target: str, record: Any, tls: tuple[str, str] | None = None, system: str = "bear.mission"
    ) -> None:
        self.loop = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self.thread.start()
        certificate, key = tls or ("", "")
        overheard = Overheard(system)
        self.chunks: list[Chunk] = []

        def seen(chunk: Chunk) -> None:
            self.chunks.append(chunk)
            for line in overheard(chunk):
                record(line)

        self.proxy = Proxy(Target(target, certificate=certificate), seen, security=Security(certificate, key))
        asyncio.run_coroutine_threadsafe(self.proxy.start("127.0.0.1", 0), self.loop).result(WAIT)
        self.channel = Target(f"localhost:{self.proxy.port}", certificate=certificate).channel()

    def call(self, name: str, request: JSON = None, **options: Any) -> JSON:
        method = METHODS[name]
        ask = self.channel.unary_unary(path(method))
        return decode(method.response, ask(encode(method.request, request or {}), **{"timeout": WAIT, **options}))

    def close(self) -> None:
        self.channel.close()
        asyncio.run_coroutine_threadsafe(self.proxy.stop(), self.loop).result(WAIT)
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join()
        self.loop.close()
