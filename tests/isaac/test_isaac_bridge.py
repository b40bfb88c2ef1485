"""The oracle over real sockets: servers and robots that ship, with and without something wrong, and what is refused."""

from __future__ import annotations

import json
import socket
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from commandline import CommandLine

from missionfsm.adapters.isaac.bridge import RobotBridge, address
from missionfsm.adapters.isaac.programs import Program
from missionfsm.isaac.realtime import in_real_time, submissions
from missionfsm.isaac.runtime.missionfile import MissionFile, parse
from missionfsm.isaac.wire.framing import Decoder, encode
from missionfsm.isaac.wire.messages import Header, Message, MissionProto, MissionStatusProto, Uuid, WireStatus
from missionfsm.kernel.subject import SubjectError
from missionfsm.oracle.transcript import Head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.conform.live import live

SERVER = Path(__file__).parent.parent / "subjects" / "isaac_tcp_server.py"
MISSIONFSM = (sys.executable, "-m", "missionfsm")
TOLERANCE = 0.3
"""Seconds; also the machine that runs the tests may be slow."""

DIAMOND = {
    "missions": [
        {"robot": "r1", "start_timeout": 2},
        {"robot": "r2", "upstream": [0], "config": {"a": {"b": 1}}},
        {"robot": "r1", "upstream": [0, 1]},
    ]
}


@pytest.fixture
def port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as sock:
        sock.bind(("127.0.0.1", 0))
        return int(sock.getsockname()[1])


@pytest.fixture
def diamond(tmp_path: Path) -> Path:
    path = tmp_path / "missions.json"
    path.write_text(json.dumps(DIAMOND))
    return path


# Robots.


class OddRobot(threading.Thread):
    """A robot in this process that answers every mission with what it is told to say."""

    def __init__(self, port: int, status: WireStatus, channel: str = "mission_status") -> None:
        super().__init__(daemon=True)
        self.sock = socket.create_connection(("127.0.0.1", port))
        self.status = status
        self.channel = channel
        self.start()

    def run(self) -> None:
        decoder = Decoder()
        while data := self.sock.recv(4096):
            for one in decoder.feed(data):
                if isinstance(one, Message) and isinstance(one.payload, MissionProto):
                    header = Header(self.channel, 1, 1, Uuid(5, 6))
                    self.sock.sendall(encode(Message(header, MissionStatusProto(one.payload.uuid, self.status))))


def judged(bridge: RobotBridge, steps: int = 4) -> Any:
    try:
        return live(in_real_time(system("isaac.robot")), bridge, 1, steps, seed=3)
    finally:
        bridge.close()


def test_a_robot_that_says_nothing_wrong() -> None:
    """A robot whose missions all succeed at once conforms, though nobody can stop its behavior tree."""
    bridge = RobotBridge(0, TOLERANCE, host="127.0.0.1")
    robot = OddRobot(bridge.port, WireStatus.SUCCESS)
    verdict = judged(bridge)
    robot.join(5)
    robot.sock.close()
    assert verdict.conforms, verdict


def test_a_robot_on_the_wrong_channel() -> None:
    """A robot that reports on another channel is found out, and what was found is not asked for again."""
    bridge = RobotBridge(0, TOLERANCE, host="127.0.0.1")
    robot = OddRobot(bridge.port, WireStatus.SUCCESS, "elsewhere")
    verdict = judged(bridge)
    robot.join(5)
    robot.sock.close()
    assert verdict.violation is not None
    assert "isaac.robot/status/statuses-go-to-the-status-channel" in [one.id for one in verdict.violation.rules]


@pytest.mark.long
def test_the_robot_that_ships(command_line: CommandLine, port: int) -> None:
    """`missionfsm robot` conforms; the verdict says the tolerance."""
    robot = (*MISSIONFSM, "robot", "--name", "r1", "--port", port, "--duration", "0.5")
    options = ("--tcp-listen", port, "--tolerance", TOLERANCE, "--examples", 2, "--steps", 6, "--seed", 3)
    ended = command_line("conform", "isaac.robot", *options, "--", *robot)
    assert (ended.status, ended.err) == (0, "")
    assert "in 2 examples" in ended.out
    assert f"a tolerance of {TOLERANCE} s" in ended.out


def test_a_run_that_is_nearly_over_waits_no_longer() -> None:
    """Where less time is left than is to pass, that much passes, and is told."""
    bridge = RobotBridge(0, TOLERANCE, host="127.0.0.1")
    bridge.left = lambda: 0.05
    result = bridge.exchange("drive", {"event": "advance", "seconds": 600}).result
    bridge.close()
    assert 0 <= result["seconds"] < 600


def test_a_robot_that_does_not_come(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where no robot connects, or one program cannot be started, that is no violation."""
    monkeypatch.setattr("missionfsm.adapters.isaac.bridge.PATIENCE", 0.1)
    bridge = RobotBridge(0, TOLERANCE, host="127.0.0.1")
    with pytest.raises(SubjectError, match=r"no robot has connected to port \d+ within 0.1 s"):
        judged(bridge)
    program = Program(["/no/such/program"])
    bridge = RobotBridge(0, TOLERANCE, host="127.0.0.1", program=program)
    with pytest.raises(SubjectError, match="cannot start /no/such/program"):
        judged(bridge)


RECONNECTS = """
import os, signal, socket, sys, time
signal.signal(signal.SIGTERM, signal.SIG_IGN)
while True:
    try:
        with socket.create_connection(("127.0.0.1", int(sys.argv[1]))) as sock:
            sock.sendall(b"%d\\n" % os.getpid())
            while sock.recv(4096):
                pass
    except OSError:
        time.sleep(0.005)
"""


@pytest.mark.long
def test_a_robot_that_comes_back_while_it_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is not taken for the one that is started next."""
    bridge = RobotBridge(0, TOLERANCE, host="127.0.0.1")
    program = Program([sys.executable, "-c", RECONNECTS, str(bridge.port)])
    monkeypatch.setattr(bridge, "_program", program)
    try:
        heard = [[one.params["line"] for one in bridge.exchange("reset", {}).after if one.method == "line"][:1]]
        heard += [[one.params["line"] for one in bridge.exchange("reset", {}).after if one.method == "line"][:1]]
        assert program._process is not None
        assert heard[1] == [str(program._process.pid)] != heard[0]
    finally:
        bridge.close()


# Servers.


@pytest.mark.long
def test_the_server_that_ships_with_its_file(command_line: CommandLine, diamond: Path, port: int) -> None:
    """`missionfsm dispatch` conforms, started anew with its file for every conversation."""
    server = (*MISSIONFSM, "dispatch", diamond, "--host", "127.0.0.1", "--port", port)
    options = ("--tcp", f"127.0.0.1:{port}", "--missions", diamond, "--tolerance", TOLERANCE)
    ended = command_line("conform", "isaac.server", *options, "--examples", 2, "--steps", 5, "--seed", 1, "--", *server)
    assert (ended.status, ended.err) == (0, "")
    assert "in 2 examples" in ended.out
    assert f"a tolerance of {TOLERANCE} s" in ended.out


@pytest.mark.long
def test_a_server_with_another_file(command_line: CommandLine, diamond: Path, tmp_path: Path, port: int) -> None:
    """A server that was given other missions than the oracle is found out by what it sends."""
    other = tmp_path / "other.json"
    other.write_text(json.dumps({"missions": [{"robot": "r1", "config": {"x": {"y": 2}}}]}))
    server = (*MISSIONFSM, "dispatch", other, "--host", "127.0.0.1", "--port", port)
    record = tmp_path / "found.jsonl"
    options = ("--tcp", f"127.0.0.1:{port}", "--missions", diamond, "--tolerance", TOLERANCE, "--record", record)
    ended = command_line("conform", "isaac.server", *options, "--steps", 12, "--seed", 1, "--", *server)
    assert (ended.status, ended.err) == (1, "")
    assert "the configuration is" in ended.out
    again = command_line("check", record)
    assert (again.status, again.err) == (1, "")
    assert "the configuration is" in again.out


@pytest.mark.long
@pytest.mark.parametrize(("broken", "status"), [((), 0), (("--eager",), 1)], ids=["right", "eager"])
def test_a_server_with_an_adapter(
    command_line: CommandLine, port: int, broken: tuple[str, ...], *, status: int
) -> None:
    """Missions are submitted through an adapter, and robots talk over TCP; one that does not wait is found out."""
    server = (sys.executable, SERVER, port, *broken)
    options = ("--tcp", f"127.0.0.1:{port}", "--tolerance", TOLERANCE, "--examples", 1, "--steps", 16, "--seed", 1)
    ended = command_line("conform", "isaac.server", *options, "--", *server)
    assert (ended.status, ended.err) == (status, "")


def test_a_server_that_is_not_there(command_line: CommandLine, diamond: Path, port: int) -> None:
    """A server that exits at once is an adapter that failed, and its last words are passed on."""
    server = (sys.executable, "-c", "raise SystemExit('no floor')")
    options = ("--tcp", f"127.0.0.1:{port}", "--missions", diamond)
    ended = command_line("conform", "isaac.server", *options, "--", *server)
    assert (ended.status, ended.out) == (3, "")
    assert ended.err == "missionfsm: the server exited before it listened (stderr: no floor)\n"


# What cannot be done.


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("isaac.robot", "--tcp", "127.0.0.1:1"), "--tcp: it is isaac.server that is judged so, not isaac.robot"),
        (("isaac.server", "--tcp-listen", "9"), "--tcp-listen: it is isaac.robot that is judged so, not isaac.server"),
        (("isaac.server", "--tcp", "9998"), "'9998': expected an address such as 127.0.0.1:9998"),
        (
            ("isaac.server", "--tcp", "127.0.0.1:1"),
            "--tcp: say how missions are submitted, by --missions FILE or by an adapter after --",
        ),
        (
            ("isaac.server", "--missions", "m.json"),
            "--missions: it belongs to --tcp, which says where the mission server listens",
        ),
        (
            ("bear.mission", "--missions", "m.json"),
            "--missions: it belongs to --tcp, which says where the mission server listens",
        ),
        (
            ("isaac.robot", "--tcp-listen", "1024", "--missions", "m.json"),
            "--missions: it belongs to --tcp, which says where the mission server listens",
        ),
        (
            ("isaac.server", "--tcp", "127.0.0.1:1", "--missions", "/no/such/file"),
            "/no/such/file: No such file or directory",
        ),
        (
            ("isaac.server", "--tcp", "127.0.0.1:1", "--tolerance", "0"),
            "--tolerance 0: times are never exact over TCP",
        ),
    ],
)
def test_options_that_do_not_go_together(command_line: CommandLine, options: tuple[str, ...], says: str) -> None:
    """Bad usage is told in one line."""
    ended = command_line("conform", *options)
    assert (ended.status, ended.out, ended.err) == (2, "", f"missionfsm: {says}\n")


def test_addresses() -> None:
    """An address is a host and a port, the host in brackets where it has colons."""
    assert address("127.0.0.1:9998") == ("127.0.0.1", 9998)
    assert address("[::1]:1") == ("::1", 1)


def test_a_file_whose_order_is_unknown() -> None:
    """A mission that names a later one leaves the order of submission open, so nothing can be judged by it."""
    file = parse(json.dumps({"missions": [{"robot": "r", "upstream": [1]}, {"robot": "r"}]}))
    assert isinstance(file, MissionFile)
    with pytest.raises(ValueError, match=r"missions\[0\].upstream: mission 1 is not before it"):
        submissions(file)


# Times that may be off.


def history(seconds: float, status: str) -> Iterator[Any]:
    """A mission is sent, and so much later it has this status."""
    yield {"call": 1, "method": "submit", "params": {"mission": {"robot": "r", "start_timeout": 2}}}
    yield {"return": 1, "result": {"mission": 1}}
    yield {"drive": {"event": "connect", "connection": 1}}
    name = '{"header":{"channel":"name"},"payload":{"text":"r"}}'
    yield {"drive": {"event": "line", "connection": 1, "line": name}}
    line = encode(Message(Header("mission", 1, 1, Uuid(9, 9)), MissionProto(Uuid(1, 2), "{}"))).decode().strip()
    yield {"connection": 1, "line": line}
    yield {"drive": {"event": "advance", "seconds": seconds}}
    yield {"settled": True}
    yield {"call": 2, "method": "statuses", "params": {}}
    yield {"return": 2, "result": {"missions": {"1": status}}}


@pytest.mark.parametrize(
    ("seconds", "statuses"),
    [(1.6, "STARTED"), (1.9, "STARTED FAILED_TIMEDOUT"), (2.1, "STARTED FAILED_TIMEDOUT"), (2.4, "FAILED_TIMEDOUT")],
)
def test_a_tolerance_goes_both_ways(seconds: float, statuses: str) -> None:
    """A timeout may strike as much earlier or later as the world says, and no more."""
    found = [
        status
        for status in ("STARTED", "FAILED_TIMEDOUT")
        if check(
            system("isaac.server"),
            Head("isaac.server", {"tolerance": 0.3}, ("connect", "line", "disconnect", "advance")),
            list(history(seconds, status)),
            readings={"AI-39": "a", "AI-07": "a", "AI-05": "a", "AI-24.whole": "x"},
        ).conforms
    ]
    assert found == statuses.split()
