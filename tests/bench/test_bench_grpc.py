"""How fast robots are served, and what the proxy adds, beside a bare echo server of grpcio in the same run.

    pytest -o addopts= tests/bench/test_bench_grpc.py -s

But for the proxy, clients and servers share one process, and so its one interpreter at a time: only ratios say
something.
"""

from __future__ import annotations

import asyncio
import contextlib
import re
import signal
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from pathlib import Path
from typing import Any

import grpc
import pytest
from grpc import aio

from missionfsm.adapters.grpc.descriptors import encode, methods, path
from missionfsm.app.serve import serve

CALLS = 2_000
EVENTS = 100
METHODS = methods("bear.mission")
SUBSCRIBE = METHODS["SubscribeMissionStatus"]
GOAL = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}


class Loop:
    """An event loop in a thread of its own."""

    def __init__(self) -> None:
        self.loop = asyncio.new_event_loop()
        self.thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self.thread.start()

    def run(self, work: Any) -> Any:
        return asyncio.run_coroutine_threadsafe(work, self.loop).result(30)

    def close(self) -> None:
        self.loop.call_soon_threadsafe(self.loop.stop)
        self.thread.join()
        self.loop.close()


class Echo(grpc.GenericRpcHandler):
    """Answers every unary call with its request, and sends what it is told to on every stream."""

    def __init__(self) -> None:
        self.queues: list[asyncio.Queue[bytes]] = []

    def service(self, details: grpc.HandlerCallDetails) -> grpc.RpcMethodHandler:
        async def echo(request: bytes, _: Any) -> bytes:
            return request

        async def stream(request: bytes, _: Any) -> AsyncIterator[bytes]:
            mine: asyncio.Queue[bytes] = asyncio.Queue()
            self.queues.append(mine)
            yield request
            while True:
                yield await mine.get()

        if details.method.endswith("Subscribe"):
            return grpc.unary_stream_rpc_method_handler(stream)
        return grpc.unary_unary_rpc_method_handler(echo)

    async def tell(self, message: bytes) -> None:
        for one in self.queues:
            one.put_nowait(message)


@contextlib.contextmanager
def echoing() -> Iterator[tuple[str, Callable[[bytes], Awaitable[None]], Loop]]:
    """The bare server: where it is, how to make it send, and its loop."""
    loop, handler = Loop(), Echo()

    async def start() -> tuple[aio.Server, int]:
        server = aio.server()
        server.add_generic_rpc_handlers((handler,))
        port = server.add_insecure_port("127.0.0.1:0")
        await server.start()
        return server, port

    server, port = loop.run(start())
    yield f"127.0.0.1:{port}", handler.tell, loop
    loop.run(server.stop(0))
    loop.close()


@contextlib.contextmanager
def process(*arguments: str) -> Iterator[int]:
    """A Python process that prints its port, after a colon or alone, in its first line; interrupted at the end."""
    with subprocess.Popen([sys.executable, *arguments], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        yield int(re.findall(r"\d+", child.stdout.readline().split(",")[0])[-1])
        child.send_signal(signal.SIGINT)


def calls_a_second(target: str, name: str, request: bytes) -> tuple[float, float]:
    """Unary calls, one after the other: how many a second, and the median in milliseconds."""
    with grpc.insecure_channel(target) as channel:
        ask = channel.unary_unary(name)
        times = []
        for _ in range(CALLS):
            begun = time.perf_counter()
            with contextlib.suppress(grpc.RpcError):
                ask(request, timeout=10)
            times.append(time.perf_counter() - begun)
    return CALLS / sum(times), 1000 * statistics.median(times)


def messages_a_second(target: str, name: str, subscribers: int, cause: Callable[[], object]) -> float:
    """Messages to so many subscribers, from the first event to the last message."""
    with grpc.insecure_channel(target) as channel:
        streams = [channel.unary_stream(name)(b"") for _ in range(subscribers)]
        for one in streams:
            next(one)
        begun = time.perf_counter()
        for _ in range(EVENTS):
            cause()
        for one in streams:
            for _ in range(EVENTS):
                next(one)
        taken = time.perf_counter() - begun
        for one in streams:
            one.cancel()
    return subscribers * EVENTS / taken


def test_unary_calls_beside_an_echo() -> None:
    """Calls a second to the robot against those to the echo server."""
    request = encode(METHODS["CreateMission"].request, GOAL)
    with echoing() as (echo, _, _):
        bare, _ = calls_a_second(echo, "/bench.Echo/Call", request)
    with serve("bear.mission") as robot:
        robot_calls, _ = calls_a_second(robot.target, path(METHODS["CreateMission"]), request)
    print(f"\nunary: echo {bare:,.0f}/s, robot {robot_calls:,.0f}/s: {robot_calls / bare:.2f} of it")


def test_what_a_proxy_adds(tmp_path: Path) -> None:
    """Milliseconds that the proxy adds while it records and judges, beside those of a bare relay of grpcio.

    Server, proxy, relay and client have a process each. The relay only passes bytes on: it is the least that anything
    in between costs in Python.
    """
    name, request = path(METHODS["CreateMission"]), encode(METHODS["CreateMission"].request, GOAL)
    bare = str(Path(__file__).with_name("echo.py"))
    with process(bare) as echo:
        options = ("--grpc", f"127.0.0.1:{echo}", "--listen", "0", "--record", str(tmp_path / "day.jsonl"))
        judging = ("-m", "missionfsm", "proxy", "bear.mission", *options)
        with process(*judging) as proxy, process(bare, str(echo)) as relay:
            for _ in range(3):
                took = [calls_a_second(f"127.0.0.1:{port}", name, request)[1] for port in (echo, relay, proxy)]
                proxied, relayed = took[2] - took[0], took[1] - took[0]
                print(f"\nproxy: {proxied:.2f} ms added to {took[0]:.2f} ms (medians); ", end="")
                print(f"a bare relay adds {relayed:.2f} ms: {proxied / relayed:.2f} of it", end="")


@pytest.mark.parametrize("subscribers", [1, 8, 200])
def test_messages_beside_an_echo(subscribers: int) -> None:
    """Messages a second to subscribers of the robot against those of the echo server."""
    with echoing() as (echo, tell, loop):
        payload = b"x" * 400
        bare = messages_a_second(echo, "/bench.Echo/Subscribe", subscribers, lambda: loop.run(tell(payload)))
    with serve("bear.mission", world={"family": "servi"}) as robot:
        with grpc.insecure_channel(robot.target) as channel:
            create = METHODS["CreateMission"]
            goals = [{"destinationId": "table-1"}, {"destinationId": "table-2"}]
            patrol = {"mission": {"serviMission": {"deliveryPatrolMission": {"goals": goals}}}}
            channel.unary_unary(path(create))(encode(create.request, patrol), timeout=10)
        robot_rate = messages_a_second(robot.target, path(SUBSCRIBE), subscribers, lambda: robot.drive("goalReached"))
    print(f"\n{subscribers} subscribers: echo {bare:,.0f}/s, robot {robot_rate:,.0f}/s: {robot_rate / bare:.2f} of it")
