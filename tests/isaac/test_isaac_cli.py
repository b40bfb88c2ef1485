"""`dispatch` and `robot` as processes: the page's walk-through over three terminals, and what goes wrong."""

import fcntl
import json
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from missionfsm.isaac.runtime.log import Entry
from missionfsm.isaac.runtime.missionfile import MissionEntry, MissionFile
from missionfsm.isaac.runtime.missions import RobotOffline, RobotOnline, Status

APP = (
    "import typer; from missionfsm.cli.dispatch import dispatch; from missionfsm.cli.robot import robot; "
    "app = typer.Typer(); app.command()(dispatch); app.command()(robot); app()"
)

Start = Callable[..., "Process"]


class Process:
    """A child process whose output is read line by line, as it comes."""

    def __init__(self, *arguments: str) -> None:
        self.child = subprocess.Popen(
            [sys.executable, "-c", APP, *arguments],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, encoding="utf-8",
            env={**os.environ, "PYTHONUTF8": "1", "COLUMNS": "200"},
        )  # fmt: skip
        self.lines: list[str] = []
        self.errors: list[str] = []
        self._readers = [
            threading.Thread(target=self._read, args=(stream, lines), daemon=True)
            for stream, lines in ((self.child.stdout, self.lines), (self.child.stderr, self.errors))
        ]
        for reader in self._readers:
            reader.start()

    @staticmethod
    def _read(stream: Iterator[str], lines: list[str]) -> None:
        lines.extend(line.rstrip("\n") for line in stream)

    def until(self, pattern: str) -> re.Match[str]:
        """The first line that matches."""
        deadline = time.monotonic() + 20
        while time.monotonic() < deadline:
            for line in self.lines:
                if match := re.search(pattern, line):
                    return match
            time.sleep(0.01)
        pytest.fail(f"no line {pattern!r} in {self.lines} {self.errors}")

    def end(self) -> int:
        status = self.child.wait(20)
        for reader in self._readers:
            reader.join(5)
        return status

    def interrupt(self) -> int:
        self.child.send_signal(signal.SIGINT)
        return self.end()


@pytest.fixture
def start() -> Iterator[Start]:
    started: list[Process] = []

    def begin(*arguments: str) -> Process:
        started.append(Process(*arguments))
        return started[-1]

    yield begin
    for process in started:
        if process.child.poll() is None:
            process.child.kill()
        process.end()
        for stream in (process.child.stdout, process.child.stderr):
            assert stream is not None
            stream.close()


def write(folder: Path, *missions: object) -> str:
    path = folder / "missions.json"
    path.write_text(json.dumps({"missions": missions}))
    return str(path)


def test_isaac_cli_four_missions_on_two_robots_over_three_terminals(tmp_path: Path, start: Start) -> None:
    """The walk-through of the page: a dispatcher and two robots, each a process, and all missions succeed in order."""
    file = write(
        tmp_path,
        {"robot": "carter-01", "config": {"navigation": {"goal": {"x": 1}}}},
        {"robot": "carter-02", "upstream": [0]},
        {"robot": "carter-01", "upstream": [1]},
        {"robot": "carter-02", "upstream": [0, 2]},
    )
    server = start("dispatch", file, "--host", "127.0.0.1", "--port", "0")
    port = server.until(r"^listening on 127\.0\.0\.1:(\d+)$")[1]
    robots = [start("robot", "--name", f"carter-0{n}", "--port", port, "--duration", "0.05") for n in (1, 2)]
    assert server.end() == 0
    ends = [line for line in server.lines if line.endswith((": STARTED", ": SUCCESS", "did not"))]
    assert ends == [
        *(f"missions[{n}] carter-0{n % 2 + 1}: {status}" for n in range(4) for status in ("STARTED", "SUCCESS")),
        "4 succeeded, 0 did not",
    ]
    assert {"robot carter-01: connected", "robot carter-02: connected"} <= set(server.lines)
    assert server.errors == []
    for robot in robots:
        robot.until(r"^mission [0-9a-f-]{36}: success$")
        robot.until(r"^disconnected$")
        assert robot.interrupt() == 130
        assert robot.errors == ["missionfsm: interrupted"]


def test_isaac_cli_a_failure_is_exit_status_1(tmp_path: Path, start: Start) -> None:
    """A robot that fails every mission: one FAILED, one cancelled; by script the third succeeds."""
    file = write(tmp_path, {"robot": "r"}, {"robot": "r", "upstream": [0]}, {"robot": "r"})
    server = start("dispatch", file, "--host", "127.0.0.1", "--port", "0", "--profile", "as-shipped")
    port = server.until(r"^listening on .*:(\d+)$")[1]
    start("robot", "--name", "r", "--port", port, "--script", "fail:0,succeed:0.01")
    assert server.end() == 1
    assert server.lines[-1] == "1 succeeded, 2 did not"
    assert "missions[1] r: FAILED_UPSTREAM" in server.lines


def test_isaac_cli_nothing_to_do_is_done(tmp_path: Path, start: Start) -> None:
    """A file without missions ends at once, well."""
    server = start("dispatch", write(tmp_path), "--host", "127.0.0.1", "--port", "0")
    assert server.end() == 0
    assert server.lines[-1] == "0 succeeded, 0 did not"


def test_isaac_cli_every_problem_of_a_file_is_one_line(tmp_path: Path, start: Start) -> None:
    """Exit status 2, nothing on stdout, no traceback, each problem with its place."""
    file = write(tmp_path, {"robot": "r", "upstream": [1]}, {"robot": "r", "upstream": [0], "timeout": -1}, {})
    server = start("dispatch", file)
    assert server.end() == 2
    assert server.lines == []
    assert server.errors == [
        f"missionfsm: {file}: missions[1].timeout: wanted 0 seconds or more, found -1",
        f"missionfsm: {file}: missions[2].robot: is missing: no robot to submit the mission to",
        f"missionfsm: {file}: missions[0].upstream: each waits for the next, in a cycle: "
        "missions[0] -> missions[1] -> missions[0]",
    ]


def test_isaac_cli_bad_files_and_addresses_are_one_line(tmp_path: Path, start: Start) -> None:
    """A missing file, a folder, text that is no JSON, a port in use, a bad script: status 2 and one line each."""
    good = write(tmp_path, {"robot": "r"})
    bad = tmp_path / "bad.json"
    bad.write_text('{"missions": [\n{]}')
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        found = {
            what: start(*arguments)
            for what, arguments in {
                "missing": ("dispatch", str(tmp_path / "missing")),
                "folder": ("dispatch", str(tmp_path)),
                "no JSON": ("dispatch", str(bad)),
                "port": ("dispatch", good, "--host", "127.0.0.1", "--port", port),
                "script": ("robot", "--name", "r", "--script", "fly"),
                "name": ("robot", "--name", ""),
            }.items()
        }
        assert {what: process.end() for what, process in found.items()} == dict.fromkeys(found, 2)
    expected = {
        "missing": f"{tmp_path / 'missing'}: No such file or directory",
        "folder": f"{tmp_path}: Is a directory",
        "no JSON": f"{bad}: line 2, column 2: not JSON: expecting property name enclosed in double quotes",
        "port": f"cannot listen on 127.0.0.1:{port}: Address already in use",
        "script": "--script: step 1, 'fly': wanted succeed|fail|hang, or with seconds as in fail:0.5",
        "name": "--name: an empty name is no name",
    }
    assert {what: process.errors for what, process in found.items()} == {
        what: [f"missionfsm: {text}"] for what, text in expected.items()
    }


def test_isaac_cli_ctrl_c_is_clean(tmp_path: Path, start: Start) -> None:
    """Status 130, one line that says what had not ended, and robots are disconnected."""
    file = write(tmp_path, {"robot": "r"}, {"robot": "r"})
    server = start("dispatch", file, "--host", "127.0.0.1", "--port", "0")
    port = server.until(r"^listening on .*:(\d+)$")[1]
    robot = start("robot", "--name", "r", "--port", port, "--behavior", "hang")
    server.until(r"RUNNING")
    assert server.interrupt() == 130
    assert server.errors == ["missionfsm: interrupted: 2 of 2 missions had not ended"]
    robot.until(r"^disconnected$")


def test_isaac_cli_a_signal_ends_it_and_is_said(tmp_path: Path, start: Start) -> None:
    """SIGTERM is status 143 and one line for the dispatcher and the robot; what had not ended is counted."""
    file = write(tmp_path, {"robot": "r"}, {"robot": "r", "start_timout": 3})
    server = start("dispatch", file, "--port", "0")
    port = server.until(r"^listening on 127\.0\.0\.1:(\d+)$")[1]
    server.until(r"^only programs on this machine can connect; --host :: lets robots in from elsewhere$")
    robot = start("robot", "--name", "r", "--port", port, "--behavior", "hang")
    server.until(r"RUNNING")
    for process in (server, robot):
        process.child.send_signal(signal.SIGTERM)
        assert process.end() == 143
    assert server.errors == [
        f"missionfsm: {file}: missions[1].start_timout: is unknown and ignored; did you mean start_timeout?",
        "missionfsm: ended by SIGTERM: 2 of 2 missions had not ended",
    ]
    assert robot.errors == ["missionfsm: ended by SIGTERM"]


def test_isaac_cli_killed_robots_do_not_hang_the_dispatcher(tmp_path: Path, start: Start) -> None:
    """A robot killed in the middle fails its mission; its successor does the rest; the dispatcher ends."""
    file = write(tmp_path, {"robot": "r"}, {"robot": "r"})
    server = start("dispatch", file, "--host", "127.0.0.1", "--port", "0")
    port = server.until(r"^listening on .*:(\d+)$")[1]
    first = start("robot", "--name", "r", "--port", port, "--behavior", "hang")
    server.until(r"missions\[0\] r: RUNNING")
    first.child.kill()
    server.until(r"missions\[0\] r: FAILED_DISCONNECTED")
    start("robot", "--name", "r", "--port", port, "--duration", "0.05")
    assert server.end() == 1
    assert server.lines[-1] == "1 succeeded, 1 did not"


def test_isaac_cli_a_reader_that_goes_away_does_not_stop_the_missions(tmp_path: Path, start: Start) -> None:
    """With stdout closed the missions are done all the same, and the exit status says so."""
    file = write(tmp_path, *({"robot": "r"} for _ in range(5)))
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    reading, writing = os.pipe()
    os.close(reading)
    arguments = ["dispatch", file, "--host", "127.0.0.1", "--port", port]
    server = subprocess.Popen([sys.executable, "-c", APP, *arguments], stdout=writing, stderr=subprocess.PIPE)
    os.close(writing)
    start("robot", "--name", "r", "--port", port, "--duration", "0")
    _, errors = server.communicate(timeout=20)
    assert (server.returncode, errors) == (0, b"")


def test_isaac_cli_a_reader_that_does_not_read_holds_up_nothing(tmp_path: Path, start: Start) -> None:
    """Behind a full pipe that nobody reads all missions are done; what was not written is said."""
    file = write(tmp_path, *({"robot": "r"} for _ in range(100)))
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    reading, writing = os.pipe()
    fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 16384)
    arguments = ["dispatch", file, "--port", port, "--log", "json"]
    server = subprocess.Popen([sys.executable, "-c", APP, *arguments], stdout=writing, stderr=subprocess.PIPE)
    os.close(writing)
    try:
        start("robot", "--name", "r", "--port", port, "--duration", "0")
        _, errors = server.communicate(timeout=20)
        assert server.returncode == 0
        assert re.fullmatch(rb"missionfsm: \d+ lines were not written: nobody reads stdout\n", errors)
    finally:
        with os.fdopen(reading, "rb") as left:
            first = [json.loads(line) for line in left.read().splitlines()[:3]]
    assert [(line["event"], line["level"]) for line in first] == [
        ("listening", "info"), ("loopback", "info"), ("status", "info"),
    ]  # fmt: skip
    assert first[2].keys() == {"time", "level", "event", "mission", "uuid", "robot", "before", "status", "text"}
    assert (first[2]["mission"], first[2]["robot"], first[2]["status"]) == (0, "r", "QUEUED")


def test_isaac_cli_the_table_shows_what_matters() -> None:
    """On a terminal: robots, missions, statuses and counts, as many rows as fit; names cannot control the terminal."""
    from rich.console import Console  # noqa: PLC0415

    from missionfsm.adapters.isaac.settings import Settings  # noqa: PLC0415
    from missionfsm.app.dispatch import Dispatch  # noqa: PLC0415
    from missionfsm.cli.isaac_view import TableView  # noqa: PLC0415

    file = MissionFile(
        tuple(MissionEntry("[red]r\x1b[2J", upstream=(number - 1,) if number else ()) for number in range(50))
    )
    console = Console(force_terminal=True, width=100, height=24, no_color=True, record=True)
    work = Dispatch(file, Settings())
    view = TableView(work, console)
    view.tell(Entry("listening", "listening on here:1"))
    view.tell(work.narrator.tell(RobotOnline("[red]r\x1b[2J", 1)))
    view.tell(work.narrator.tell(RobotOffline("[red]r\x1b[2J", 1)))
    work.statuses[:] = [Status.QUEUED] * 50
    work.statuses[40], work.statuses[1] = Status.RUNNING, Status.SUCCESS
    with console.capture() as capture:
        console.print(view.render())
    text = re.sub(r"\x1b\[[0-9;]*m", "", capture.get())
    assert len(text.splitlines()) <= 24
    for part in (
        "listening on here:1",
        "disconnected",
        "RUNNING",
        "1 RUNNING, 1 SUCCESS",
        "not shown",
        r"[red]r\x1b[2J",
    ):
        assert part in text
    assert "\x1b" not in text
    assert work.succeeded == 1
