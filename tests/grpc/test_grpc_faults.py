"""Clients and networks that fail: the server and the proxy outlive them, and forget what is gone."""

from __future__ import annotations

import asyncio
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import pytest
from grpc import aio

from missionfsm.adapters.grpc.descriptors import decode, methods, path
from missionfsm.app.serve import Served, serve

SUBSCRIBE = methods("bear.mission")["SubscribeMissionStatus"]
WAIT = 20.0
"""Seconds after which what does not come fails a test."""
GONE = """
import sys, grpc
stream = grpc.insecure_channel(sys.argv[1]).unary_stream(sys.argv[2])(b"")
next(stream)
print("subscribed", flush=True)
next(stream)
"""


def eventually(holds: Callable[[], Any]) -> bool:
    end = time.monotonic() + WAIT
    while time.monotonic() < end:
        if holds():
            return True
        time.sleep(0.02)
    return False


def cancelled(robot: Served) -> int:
    """How many streams the robot has given up."""
    return sum(line.get("method") == "cancel" for line in robot.history())


def test_a_client_that_is_killed_is_forgotten() -> None:
    """A subscriber whose process dies is given up, and the robot goes on."""
    with serve("bear.mission") as robot:
        command = [sys.executable, "-c", GONE, robot.target, path(SUBSCRIBE)]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as client:
            assert client.stdout is not None
            assert client.stdout.readline() == b"subscribed\n"
            client.kill()
        assert eventually(lambda: cancelled(robot) == 1)
        assert robot.drive("world", blocked=True)


def test_connections_that_say_nothing_hold_nobody_up() -> None:
    """Half-open connections, and such as send rubbish, are no matter to those who speak gRPC."""
    with serve("bear.mission") as robot:
        silent = [socket.create_connection(("127.0.0.1", robot.port)) for _ in range(20)]
        silent[0].sendall(b"GET / HTTP/1.1\r\n\r\n")
        assert asyncio.run(subscribe_all(robot, 3)) == 1
        for one in silent:
            one.close()


async def subscribe_all(robot: Served, streams: int) -> int:
    """How many different numbers so many subscribers see of one event."""
    async with aio.insecure_channel(robot.target) as channel:
        calls = [channel.unary_stream(path(SUBSCRIBE))(b"") for _ in range(streams)]
        await asyncio.gather(*(one.read() for one in calls))
        loop = asyncio.get_running_loop()
        assert await loop.run_in_executor(None, lambda: robot.drive("world", destinations=["table-1"]))
        request = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
        assert await loop.run_in_executor(None, lambda: robot.call("CreateMission", request))
        messages = await asyncio.wait_for(asyncio.gather(*(one.read() for one in calls)), WAIT)
        for one in calls:
            one.cancel()
        return len({decode(SUBSCRIBE.response, one)["metadata"]["sequenceNumber"] for one in messages})


@pytest.mark.long
def test_a_thousand_subscribers_see_one_event_and_are_forgotten() -> None:
    """A thousand streams at once are served, see the event under one number, and are given up when they go."""
    with serve("bear.mission") as robot:
        assert asyncio.run(subscribe_all(robot, 1000)) == 1
        assert eventually(lambda: cancelled(robot) == 1000)
