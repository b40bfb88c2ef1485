"""What a client that retries as the page advises does to a robot whose confirmations come too late.

A dozen missions are appended, one after the other; three calls in ten are answered DEADLINE_EXCEEDED, of which half
took effect. One client calls again, as the page says. The other looks first: it subscribes, and calls again only if the
list has not grown. The robot is right in both cases, as ``missionfsm.check`` says of its history.

    python examples/retry/retry.py
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import grpc

import missionfsm
from missionfsm.adapters.grpc.descriptors import decode, encode, methods, path
from missionfsm.app.serve import Served

MISSIONS = 12
GOAL = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}


class Client:
    """A client of the mission API: generated code would do as well."""

    def __init__(self, target: str) -> None:
        self._channel = grpc.insecure_channel(target)
        self._methods = methods("bear.mission")

    def call(self, name: str) -> None:
        """A call about one mission."""
        method = self._methods[name]
        self._channel.unary_unary(path(method))(encode(method.request, GOAL), timeout=10)

    def listed(self) -> int:
        """How many missions the robot has."""
        method = self._methods["SubscribeMissionStatus"]
        stream = self._channel.unary_stream(path(method))(b"", timeout=10)
        message = decode(method.response, next(stream))
        stream.cancel()
        return len(message["missionStates"].get("missions", []))


def as_advised(client: Client, name: str) -> None:
    """Call until it is confirmed: what the page says of DEADLINE_EXCEEDED."""
    while True:
        try:
            client.call(name)
        except grpc.RpcError as error:
            if error.code() is grpc.StatusCode.DEADLINE_EXCEEDED:
                continue
        return  # it is confirmed, or a create is refused because its mission is there already


def after_a_look(client: Client, name: str) -> None:
    """Call again only if what was asked for is not there."""
    before = client.listed()
    while client.listed() == before:
        with contextlib.suppress(grpc.RpcError):
            client.call(name)


def study(way: Callable[[Client, str], None], seed: int) -> tuple[int, str]:
    """How many missions the robot has at the end, and what the oracle says of it."""
    robot: Served
    with missionfsm.serve("bear.mission", faults=["deadline:0.3"], seed=seed) as robot:
        client = Client(robot.target)
        way(client, "CreateMission")
        for _ in range(MISSIONS - 1):
            way(client, "AppendMission")
        return client.listed(), missionfsm.check(robot.history()).outcome.value


if __name__ == "__main__":
    for way in (as_advised, after_a_look):
        missions, verdict = study(way, seed=1)
        print(f"{way.__name__}: {MISSIONS} missions wanted, {missions} listed; the robot {verdict}")
