"""A gRPC server judged with no adapter: that the verdict is right, and the same again."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import grpc
import pytest
from attrs import evolve
from commandline import CommandLine

from missionfsm.adapters.grpc import control
from missionfsm.adapters.grpc.client import GrpcSubject, Use
from missionfsm.adapters.grpc.descriptors import encode, methods, path
from missionfsm.adapters.grpc.target import Target
from missionfsm.app.serve import serve
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import SubjectError
from missionfsm.kernel.transport import over_transport
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.conform import conform

NAVIGATE = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}


@contextmanager
def subject(name: str, address: str, **options: Any) -> Iterator[GrpcSubject]:
    """A server as a subject."""
    silence = {"settle": options.pop("settle", 0.02), "settle_most": options.pop("settle_most", 5.0)}
    found = GrpcSubject(name, Target(address, timeout=5.0, begin=0.2, **silence), **options)
    try:
        yield found
    finally:
        found.close()


def judged(name: str, address: str, seed: int, **options: Any) -> Verdict:
    """The verdict of a short run."""
    with subject(name, address, **options) as server:
        return conform(system(name), server, drawn=2, tours=1, steps=15, seed=seed, advice=False)


@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_the_reference_over_grpc_conforms_and_does_so_again(name: str) -> None:
    """Two runs with one seed see the same, event by event, although messages and answers race on the network."""
    found = []
    for _ in range(2):
        with serve(name) as robot:
            verdict = judged(name, robot.target, 7)
        assert verdict.conforms, str(verdict)
        found.append({**verdict.to_json(), "implementation": ""})
    assert found[0] == found[1]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(2, 8))])
def test_the_reference_over_grpc_conforms_for_any_seed(seed: int) -> None:
    """Whatever is drawn, the reference is judged right."""
    for name in ("bear.mission", "bear.status"):
        with serve(name) as robot:
            verdict = judged(name, robot.target, seed)
        assert verdict.conforms, str(verdict)


def test_a_server_without_the_control_service_is_reset_softly() -> None:
    """Without the control service what the tester began is ended and cleared between conversations."""
    with serve("bear.mission", control=False) as robot:
        with subject("bear.mission", robot.target, world={}, settle=0.2) as server:
            verdict = conform(system("bear.mission"), server, drawn=1, tours=1, steps=8, seed=1, advice=False)
        assert verdict.violation is None, str(verdict)
        called = [line.get("method") for line in robot.history()]
    assert called.count("ClearMissionStatus") >= 2


def test_missions_of_others_are_not_touched() -> None:
    """A robot that has missions already is refused; with ``force`` they are ended and cleared."""
    with serve("bear.mission", control=False) as robot:
        with subject("bear.mission", robot.target) as other:
            other.exchange("CreateMission", NAVIGATE)
        with subject("bear.mission", robot.target) as careful, pytest.raises(SubjectError, match="--force"):
            careful.exchange("reset", {})
        with subject("bear.mission", robot.target, use=Use(force=True)) as bold:
            bold.exchange("reset", {})
            opened = bold.exchange("SubscribeMissionStatus", {})
            assert [one.params["message"]["missionStates"] for one in opened.after] == [{"currentMissionIndex": -1}]


class Lazy:
    """A server whose streams say that they have begun with their first message only, as many libraries do it.

    Args:
        first: after how many seconds a message comes by itself; None for never.
    """

    def __init__(self, *, first: float | None) -> None:
        self._first = first
        self._server = grpc.server(ThreadPoolExecutor(4))
        self._server.add_generic_rpc_handlers((self._handlers(),))
        self.port = self._server.add_insecure_port("127.0.0.1:0")
        self._server.start()

    def _handlers(self) -> Any:
        found = methods("bear.mission")
        subscribe: Callable[[bytes, Any], Iterator[bytes]] = self._subscribe
        return grpc.method_handlers_generic_handler(
            path(found["SubscribeMissionStatus"]).split("/")[1],
            {"SubscribeMissionStatus": grpc.unary_stream_rpc_method_handler(subscribe)},
        )

    def _subscribe(self, _: bytes, context: Any) -> Iterator[bytes]:
        ended = threading.Event()
        context.add_callback(ended.set)
        if self._first is not None:
            ended.wait(self._first)
            response = methods("bear.mission")["SubscribeMissionStatus"].response
            yield encode(response, {"missionStates": {"currentMissionIndex": -1}})
        ended.wait(10)

    def stop(self) -> None:
        self._server.stop(0).wait()


@pytest.mark.parametrize("first", [0.0, 1.0, None])
def test_a_stream_that_says_late_that_it_has_begun_has_begun(first: float | None) -> None:
    """A subscription is answered OK once nothing refused it for a while, with its first message, however late it is.

    Where there is none the next one is not waited for as long.
    """
    lazy = Lazy(first=first)
    try:
        with subject("bear.mission", f"127.0.0.1:{lazy.port}", settle_most=5.0 if first else 0.5) as server:
            for _ in range(2):
                opened = server.exchange("SubscribeMissionStatus", {})
                assert opened.error is None
                assert len(opened.after) == (first is not None)
    finally:
        lazy.stop()


class Hesitant:
    """A server that counts what it sends, and takes long to refuse a subscription."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._server = grpc.server(ThreadPoolExecutor(2))
        subscribe = path(methods("bear.mission")["SubscribeMissionStatus"])
        answers = {"Describe": {"system": "bear.mission", "drives": []}, "Settle": {"streams": {}}}
        for service, handlers in (
            (control.SERVICE, {name: self._always(answer) for name, answer in answers.items()}),
            (subscribe.split("/")[1], {subscribe.split("/")[2]: grpc.unary_stream_rpc_method_handler(self._refuse)}),
        ):
            self._server.add_generic_rpc_handlers((grpc.method_handlers_generic_handler(service, handlers),))
        self.port = self._server.add_insecure_port("127.0.0.1:0")
        self._server.start()

    @staticmethod
    def _always(answer: JSON) -> Any:
        return grpc.unary_unary_rpc_method_handler(lambda _request, _context: control.pack(answer))

    def _refuse(self, _: bytes, context: Any) -> Iterator[bytes]:
        time.sleep(self._seconds)
        context.abort(grpc.StatusCode.INVALID_ARGUMENT, "no")
        yield b""

    def stop(self) -> None:
        self._server.stop(0).wait()


def test_a_refusal_that_comes_late_is_waited_for_where_beginnings_are_told() -> None:
    """A server that counts its messages says when a stream has begun, so that silence alone does not mean that."""
    hesitant = Hesitant(0.5)
    try:
        with subject("bear.mission", f"127.0.0.1:{hesitant.port}") as server:
            assert server.exchange("SubscribeMissionStatus", {}).error["status"] == "INVALID_ARGUMENT"
    finally:
        hesitant.stop()


@pytest.mark.long
def test_what_is_lost_on_the_way_is_flagged_or_with_a_strict_transport_wrong() -> None:
    """Messages that a server's network loses are explained and flagged, unless the transport is said to be strict."""
    found = {}
    strict = system("bear.mission")
    for name, of in (("strict", strict), ("imperfect", evolve(strict, spec=over_transport(strict.spec)))):
        with serve("bear.mission", faults=["lost:0.4"], seed=1) as robot, subject(of.name, robot.target) as server:
            verdict = conform(of, server, drawn=2, tours=1, steps=15, seed=3, advice=False)
        found[name] = (verdict.conforms, any(one.startswith("TR-03=b") for one in verdict.flagged))
    assert found == {"imperfect": (True, True), "strict": (False, False)}


@pytest.mark.long
@pytest.mark.parametrize("late", [0.3, 0.9])
def test_a_network_that_is_slower_than_the_silence_is_no_violation(late: float) -> None:
    """Updates that take many times as long as a silence are waited for, and silences become as long as they take."""
    slow = serve("bear.mission", control=False, faults=[f"late:{late}"])
    with slow as robot, subject("bear.mission", robot.target, settle=0.1) as server:
        verdict = conform(system("bear.mission"), server, drawn=1, tours=1, steps=4, seed=1, advice=False)
        assert verdict.violation is None, str(verdict)
        assert late < server.target.settle <= 5


def test_the_transport_belongs_to_a_server(command_line: CommandLine) -> None:
    """Between the tester and its child process nothing is lost, so that nobody may say so."""
    ended = command_line("conform", "bear.mission", "--transport", "imperfect")
    assert (ended.status, "--transport" in ended.err) == (2, True)
