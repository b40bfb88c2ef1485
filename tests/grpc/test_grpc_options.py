"""What ``conform --grpc`` is told about a server: who else uses it, with what it begins, what is sent along."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from commandline import CommandLine

from missionfsm.adapters.grpc.client import GrpcSubject, Use
from missionfsm.adapters.grpc.target import Target
from missionfsm.app.asked import judged_system
from missionfsm.app.serve import Served, serve
from missionfsm.cli.overgrpc import read_metadata, read_token
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Subject, SubjectError
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.run import Run

NAVIGATE = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
SHORT: dict[str, Any] = {"drawn": 1, "tours": 1, "steps": 10, "seed": 1, "advice": False}


@contextmanager
def subject(robot: Served, **options: Any) -> Iterator[GrpcSubject]:
    found = GrpcSubject("bear.mission", Target(robot.target, settle=0.02, timeout=5.0, begin=0.2), **options)
    try:
        yield found
    finally:
        found.close()


def judged(robot: Served, *, others: bool) -> Verdict:
    """The verdict on a robot that somebody else uses, which is said or not."""
    judged_as = judged_system("bear.mission", strict=True, others=others)
    with subject(robot, use=Use(shared=others, force=True)) as server:
        return conform(judged_as, _Appending(server, robot), **SHORT)


class _Appending:
    """A subject; after every mission that is created somebody else appends one."""

    def __init__(self, subject: Subject, robot: Served) -> None:
        self._subject, self._robot = subject, robot

    def exchange(self, method: str, params: JSON) -> Exchange:
        answer = self._subject.exchange(method, params)
        if method == "CreateMission" and answer.error is None:
            self._robot.call("AppendMission", NAVIGATE)
        return answer

    def close(self) -> None:
        """The subject is closed by whoever has made it."""


@pytest.mark.long
def test_others_may_use_the_robot_where_that_is_said() -> None:
    """A mission that somebody else appended breaks a rule, unless others use the robot; then it is flagged."""
    found = {}
    for others in (False, True):
        with serve("bear.mission", control=False) as robot:
            verdict = judged(robot, others=others)
        found[others] = (verdict.violation is None, any(one.startswith("LOG-02=b") for one in verdict.flagged))
    assert found == {False: (False, False), True: (True, True)}


def test_a_robot_in_use_is_judged_as_it_is() -> None:
    """With ``begins anywhere`` a mission that was there before is explained, and a reset leaves it alone."""
    with serve("bear.mission", control=False) as robot:
        there = robot.call("CreateMission", NAVIGATE)["missionId"]
        with subject(robot, use=Use(anywhere=True)) as server:
            server.exchange("reset", {})
            (shown,) = server.exchange("SubscribeMissionStatus", {}).after
            assert [one["missionId"] for one in shown.params["message"]["missionStates"]["missions"]] == [there]
            system = judged_system("bear.mission", strict=True, anywhere=True)
            verdict = conform(system, server, only=("SubscribeMissionStatus", "CreateMission"), **SHORT)
        assert verdict.violation is None, str(verdict)
        called = [line.get("method") for line in robot.history()]
    assert "CreateMission" in called
    assert not {"ClearMissionStatus", "UpdateMission"} & set(called)


def test_own_missions_are_ended_where_others_remain() -> None:
    """A reset of a robot in use cancels what this tester began and runs, and stops at what others began."""
    with serve("bear.mission", control=False) as robot, subject(robot, use=Use(anywhere=True)) as server:
        own = server.exchange("CreateMission", NAVIGATE).result["missionId"]
        theirs = robot.call("AppendMission", NAVIGATE)["missionId"]
        server.exchange("reset", {})
        opened = server.exchange("SubscribeMissionStatus", {})
        missions = opened.after[0].params["message"]["missionStates"]["missions"]
        assert [(one["missionId"], one["state"]) for one in missions] == [
            (own, "STATE_CANCELED"),
            (theirs, "STATE_RUNNING"),
        ]


def test_a_server_that_comes_back_is_judged_on() -> None:
    """A server that is away between two conversations is waited for, and what it was before counts for nothing."""
    with serve("bear.mission", control=False) as robot, subject(robot) as server:
        port = robot.port
        server.exchange("CreateMission", NAVIGATE)
        robot._server.stop()
        back = threading.Timer(0.5, lambda: again.append(stack.__enter__()))
        again: list[Served] = []
        stack = serve("bear.mission", control=False, port=port)
        back.start()
        server.exchange("reset", {})
        back.join()
        assert server.exchange("CreateMission", NAVIGATE).error is None
        stack.__exit__(None, None, None)


def test_metadata_and_token_are_sent_with_every_call(tmp_path: Path) -> None:
    """A server that wants a token gets it, from a file or as metadata, and with calls of every kind."""
    token = tmp_path / "token"
    token.write_text("sesame\n")
    for sent in ({"token": read_token(str(token))}, {"metadata": read_metadata(["Authorization: Bearer sesame"])}):
        with serve("bear.mission", token="sesame") as robot:  # noqa: S106 - it is nobody's
            server = GrpcSubject("bear.mission", Target(robot.target, keepalive=5, **sent))
            assert server.counts
            for method, params in (("reset", {}), ("SubscribeMissionStatus", {}), ("CreateMission", NAVIGATE)):
                assert server.exchange(method, params).error is None
            server.close()


def test_a_token_that_expires_is_read_again_before_the_next_conversation() -> None:
    """What is under way when a token expires is UNAUTHENTICATED, and explained; the next conversation has a new one."""
    tokens = ["old", "old"]
    of = judged_system("bear.mission", strict=False)
    with serve("bear.mission", token="old") as robot:  # noqa: S106 - it is nobody's
        server = GrpcSubject("bear.mission", Target(robot.target, token=tokens[-1]), renewed=lambda: tokens[-1])
        run = Run.against(of, server)
        run.start({})
        assert run.do("SubscribeMissionStatus", {})
        robot.renew("new")
        assert all((run.settle(), run.do("CreateMission", NAVIGATE), run.settle()))
        heard = [line["error"]["status"] for line in run.conversation.heard if line.get("error")]
        assert heard == ["UNAUTHENTICATED", "UNAUTHENTICATED"]
        with pytest.raises(SubjectError, match="UNAUTHENTICATED"):
            run.start({})
        tokens.append("new")
        run.start({})
        assert all((run.do("CreateMission", NAVIGATE), run.settle()))
        assert [line["result"].keys() for line in run.conversation.heard if "return" in line] == [{"missionId"}]
        server.close()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--metadata", "nothing"), "--metadata nothing: expected KEY:VALUE"),
        (("--metadata", "grpc-timeout:1"), "--metadata grpc-timeout:1: expected KEY:VALUE"),
        (("--grpc", "nowhere"), "--grpc nowhere: expected HOST:PORT"),
    ],
)
def test_options_that_cannot_be_are_bad_input(options: tuple[str, ...], says: str, command_line: CommandLine) -> None:
    """What no server can be told ends in one line."""
    ended = command_line("conform", "bear.mission", "--grpc", "localhost:1", *options)
    assert (ended.status, ended.out) == (2, "")
    assert says in ended.err


def test_what_belongs_to_a_server_is_refused_without_one(command_line: CommandLine) -> None:
    """Others, metadata and the like say nothing about a child process."""
    for option in (("--others",), ("--begins", "anywhere"), ("--metadata", "a:b"), ("--keepalive", "5")):
        ended = command_line("conform", "bear.mission", *option)
        assert (ended.status, option[0] in ended.err) == (2, True)
