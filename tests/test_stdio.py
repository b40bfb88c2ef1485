"""The adapter protocol over a child's stdin and stdout: whatever a child does wrong is the adapter's failure."""

from __future__ import annotations

import io
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import orjson
import pytest
from attrs import evolve
from commandline import CommandLine

from missionfsm.adapters import stderrlog, stdio
from missionfsm.adapters.stdio import Child, serve
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification, SubjectError
from missionfsm.systems import system
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.reference.subject import ReferenceSubject

# A child answers as the reference does, through `reference`, until it is asked for METHOD; then it does WRONG.
CHILD = """
import json, os, signal, sys, time
from missionfsm.systems import system
from missionfsm.adapters.stdio import _respond
from missionfsm.tools.reference.subject import ReferenceSubject

reference = ReferenceSubject(system("bear.mission"))

def send(value):
    sys.stdout.write(value if isinstance(value, str) else json.dumps(value))
    sys.stdout.write("\\n")
    sys.stdout.flush()

for line in sys.stdin.buffer:
    request = json.loads(line)
    id, method = request["id"], request["method"]
    if method == METHOD:
        WRONG
    for answer in _respond(reference, line):
        send(answer)
"""

Adapter = Callable[..., list[str]]


@pytest.fixture
def adapter(tmp_path: Path) -> Adapter:
    """The command of a child that answers as the reference does but does something else when asked for a method."""

    def write(wrong: str, method: str = "initialize") -> list[str]:
        path = tmp_path / "adapter.py"
        path.write_text(CHILD.replace("METHOD", repr(method)).replace("WRONG", wrong))
        return [sys.executable, "-u", str(path)]

    return write


# What a child does when it is asked for SkipGoal, and what is said about that; seconds that an answer may take.
FAILURES = {
    "exits": ("sys.exit(7)", "exited with status 7 before answering SkipGoal"),
    "exits well": ("sys.exit()", "exited with status 0 before answering SkipGoal"),
    "complains and exits": (
        "print('no robot\\n', file=sys.stderr); sys.exit(1)",
        "exited with status 1 before answering SkipGoal (stderr: no robot)",
    ),
    "raises": (
        "raise KeyError('robot')",
        "exited with status 1 before answering SkipGoal (stderr: KeyError: 'robot'; all of it is in ",
    ),
    "is killed": ("os.kill(os.getpid(), signal.SIGKILL)", "was ended by signal 9 before answering SkipGoal"),
    "closes its output": ("os.close(1); time.sleep(60)", "closed its output before answering SkipGoal"),
    "hangs": ("time.sleep(60)", "did not answer SkipGoal within 0.5 s"),
    "exits in the middle of a line": (
        "os.write(1, b'{\"id\"'); os._exit(0)",
        "exited with status 0 before answering SkipGoal, in the middle of the line '{\"id\"'",
    ),
    "hangs in the middle of a line": (
        "sys.stdout.write('{\"id\"'); sys.stdout.flush(); time.sleep(60)",
        "did not answer SkipGoal within 0.5 s",
    ),
    "chatters and never answers": (
        "while True: send({'method': 'message', 'params': {'stream': 1, 'message': {}}}); time.sleep(0.01)",
        "did not answer SkipGoal within 0.5 s",
    ),
    "writes rubbish": ("send('Listening on port 80')", "wrote a line that is not JSON: 'Listening on port 80'"),
    "writes bytes": (
        "os.write(1, bytes(range(128, 200)) + b'\\n')",
        "wrote a line that is not JSON: '" + 56 * "\ufffd" + "...",
    ),
    "writes an empty line": ("send('')", "wrote a line that is not JSON: ''"),
    "writes NaN": ('send(\'{"id": %d, "result": NaN}\' % id)', 'wrote a line that is not JSON: \'{"id": '),
    "nests too deep": (
        "send('{\"id\": %d, \"result\": %s}' % (id, 200 * '[' + 200 * ']'))",
        'wrote a line that is nested more than 200 deep: \'{"id": ',
    ),
    "writes a list": ("send([])", "wrote a line that is not a JSON object: []"),
    "answers another request": (
        "send({'id': id + 1, 'result': {}})",
        " instead of ",
    ),
    "answers an old request": ("send({'id': id - 1, 'result': {}})", "instead of"),
    "answers nothing": ("send({'id': id})", "answered SkipGoal without a result or an error: {'id': "),
    "answers with its own error": (
        "send({'id': id, 'error': {'code': -32601, 'message': 'no such method'}})",
        "answered SkipGoal with JSON-RPC error -32601: it does not have it",
    ),
    "answers with an unknown error": (
        "send({'id': id, 'error': {'code': 99, 'message': ''}})",
        "answered SkipGoal with error 99, status null: not a gRPC error",
    ),
    "answers with an error that is OK": (
        "send({'id': id, 'error': {'code': 0, 'message': ''}})",
        "answered SkipGoal with error 0, status 'OK': not a gRPC error",
    ),
    "answers with two errors": (
        "send({'id': id, 'error': {'code': 9, 'data': {'status': 'INTERNAL'}}})",
        "answered SkipGoal with error 9, status 'INTERNAL': not a gRPC error",
    ),
    "answers with an error that is a list": (
        "send({'id': id, 'error': {'code': 9, 'data': {'status': []}}})",
        "answered SkipGoal with error 9, status []: not a gRPC error",
    ),
    "answers with an error without a code": (
        "send({'id': id, 'error': {'message': 'no'}})",
        "answered SkipGoal with an error without a code: {'message': 'no'}",
    ),
    "answers with an error that is a text": (
        "send({'id': id, 'error': 'no'})",
        "answered SkipGoal with an error without a code: 'no'",
    ),
    "notifies of something else": (
        "send({'method': 'log', 'params': {}})",
        "sent something that is no notification of the protocol: {'method': 'log', 'params': {}}",
    ),
    "notifies without a stream": (
        "send({'method': 'message', 'params': {'message': {}}})",
        "sent something that is no notification of the protocol: ",
    ),
    "notifies on a stream that is a text": (
        "send({'method': 'message', 'params': {'stream': '1', 'message': {}}})",
        "sent a notification whose stream is '1'",
    ),
}


@pytest.mark.parametrize("case", FAILURES)
def test_a_failing_adapter_is_told_in_a_line(adapter: Adapter, case: str) -> None:
    """An adapter that fails in the middle of a run raises `SubjectError`: what it did, in one line."""
    wrong, says = FAILURES[case]
    child = Child(adapter(wrong, "SkipGoal"), timeout=10)
    try:
        child.exchange("initialize", {"system": "bear.mission"})
        child.exchange("reset", {"world": {}})
        child.timeout = 0.5
        with pytest.raises(SubjectError) as raised:
            child.exchange("SkipGoal", {})
    finally:
        began = time.monotonic()
        child.close()
    assert str(raised.value).startswith("the adapter ")
    assert says in str(raised.value)
    assert "\n" not in str(raised.value)
    assert len(str(raised.value)) < 400
    assert time.monotonic() - began < 5


@pytest.mark.parametrize(
    ("member", "result", "status"),
    [
        ("'result': {'missionIds': []}, 'error': None", {"missionIds": []}, None),
        ("'result': None, 'error': {'code': 9, 'message': 'no'}", None, "FAILED_PRECONDITION"),
    ],
)
def test_a_member_that_is_null_beside_the_other_is_absent(
    adapter: Adapter, member: str, result: JSON, status: str | None
) -> None:
    """Libraries write both members of an answer; the one that is null is not there."""
    child = Child(adapter(f"send({{'id': id, {member}}}); continue", "ClearMissionStatus"), timeout=10)
    try:
        found = child.exchange("ClearMissionStatus", {})
    finally:
        child.close()
    assert (found.result, found.error and found.error["status"]) == (result, status)


@pytest.mark.parametrize(
    ("wrong", "method", "says"),
    [
        ("sys.exit(7)", "initialize", "exited with status 7 before answering initialize"),
        ("sys.exit(7)", "UpdateMission", "exited with status 7 before answering UpdateMission"),
        ("send('hello')", "reset", "wrote a line that is not JSON: 'hello'"),
        (
            "send({'id': id, 'result': {}}); continue",
            "initialize",
            "answered initialize without an implementation name",
        ),
        (
            "send({'id': id, 'result': {'implementation': {'name': 'x'}, 'drives': 'all'}}); continue",
            "initialize",
            "answered initialize with drives 'all'",
        ),
        (
            "send({'id': id, 'error': {'code': 13, 'message': ''}}); continue",
            "reset",
            "answered reset with INTERNAL",
        ),
        (
            "send({'id': id, 'result': {}}); continue",
            "drive",
            "answered drive with {}, not with happened true or false",
        ),
        (
            "send({'id': id, 'result': {'happened': True, 'event': 'missionFailed'}}); continue",
            "drive",
            "which is another drive",
        ),
        (
            "send({'id': id, 'result': {}}); continue",
            "SubscribeMissionStatus",
            "cannot be read: SubscribeMissionStatus answered {}, which carries no stream number",
        ),
        (
            "send({'method': 'closed', 'params': {'stream': 1, 'error': {'status': 'BANANA'}}})",
            "settle",
            "cannot be read: error.status: 'BANANA' is not the name of a gRPC error",
        ),
        (
            "send({'method': 'closed', 'params': {'stream': 1, 'error': []}})",
            "settle",
            "cannot be read: error.status: null is not the name of a gRPC error",
        ),
        (
            "send({'method': 'closed', 'params': {'stream': 1, 'message': {}}})",
            "settle",
            "cannot be read: stream 1: expected a message or closed (with an error or without), not both",
        ),
        ("time.sleep(60)", "settle", "did not answer settle within 1 s"),
    ],
)
def test_conform_ends_with_3_where_the_adapter_fails(
    command_line: CommandLine, adapter: Adapter, wrong: str, method: str, says: str
) -> None:
    """``conform`` ends with status 3, one line on stderr and no verdict, whenever the adapter fails."""
    command = adapter(wrong, method)
    ended = command_line("conform", "bear.mission", "--seed", 1, "--examples", 20, "--timeout", 1, "--", *command)
    assert (ended.status, ended.out, ended.err.count("\n")) == (3, "", 1)
    assert ended.err.startswith("missionfsm: the adapter ")
    assert says in ended.err


def test_a_robot_that_connects_has_a_connection() -> None:
    """An adapter that says that a robot has connected but not which connection that is has failed."""

    class Forgetful(ReferenceSubject):
        def exchange(self, method: str, params: JSON) -> Exchange:
            done = super().exchange(method, params)
            return evolve(done, result={"happened": True}) if method == "drive" else done

    with pytest.raises(SubjectError, match=r"^the adapter .*connection: null is not the number of a connection$"):
        conform(system("isaac.server"), Forgetful(system("isaac.server")), drawn=1, tours=1, seed=1)


def test_a_program_that_cannot_be_started_ends_with_3(command_line: CommandLine, tmp_path: Path) -> None:
    """A command that does not exist, and one that is no program, are the adapter's failure."""
    path = tmp_path / "no-program"
    missing = command_line("conform", "bear.mission", "--", path)
    path.write_text("")
    forbidden = command_line("conform", "bear.mission", "--", path)
    assert missing.err == f"missionfsm: cannot start {path}: No such file or directory\n"
    assert forbidden.err == f"missionfsm: cannot start {path}: Permission denied\n"
    assert (missing.status, forbidden.status) == (3, 3)


def test_a_child_that_never_reads_is_given_up(adapter: Adapter) -> None:
    """A request that does not fit into the pipe of a child that does not read is given up in time."""
    child = Child(adapter("time.sleep(60)", "reset"), timeout=10)
    try:
        child.exchange("initialize", {"system": "bear.mission"})
        child.timeout = 0.5
        with pytest.raises(SubjectError, match=r"^the adapter did not answer reset within 0.5 s; it was sent"):
            child.exchange("reset", {"world": {}})
        with pytest.raises(SubjectError, match=r"^the adapter did not read SkipGoal within 0.5 s; it was sent"):
            child.exchange("SkipGoal", {"x": 10_000_000 * "x"})
    finally:
        child.close()


def test_a_child_that_floods_is_given_up(adapter: Adapter, monkeypatch: pytest.MonkeyPatch) -> None:
    """Notifications without end, and a line without end, are a failure long before the memory is full."""
    flood = 'sys.stdout.write(\'{"method":"message","params":{"stream":1,"message":{}}}\\n\' * 1000)'
    endless = "sys.stdout.write('x' * 100000)"
    monkeypatch.setattr(stdio, "MAX_NOTIFICATIONS", 20_000)
    monkeypatch.setattr(stdio, "LONGEST_LINE", 2_000_000)
    for wrong, says in ((flood, "flooded: more than 20000 "), (endless, "flooded: a line of more than 2000000 bytes")):
        child = Child(adapter(f"while True: {wrong}"), timeout=20)
        try:
            with pytest.raises(SubjectError) as raised:
                child.exchange("initialize", {"system": "bear.mission"})
        finally:
            child.close()
        assert says in str(raised.value)


def test_long_lines_go_both_ways(adapter: Adapter) -> None:
    """A request and an answer of 10 MB are nothing special."""
    text = 10_000_000 * "x"
    child = Child(adapter("send({'id': id, 'result': request['params']}); continue", "SkipGoal"), timeout=30)
    try:
        child.exchange("initialize", {"system": "bear.mission"})
        assert child.exchange("SkipGoal", {"x": text}).result == {"x": text}
    finally:
        child.close()


def test_a_child_that_outlives_its_input_is_ended(adapter: Adapter) -> None:
    """A child that does not exit at the end of its input is ended by `close`."""
    child = Child(adapter("signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(60)"), timeout=0.5)
    with pytest.raises(SubjectError, match="did not answer initialize"):
        child.exchange("initialize", {"system": "bear.mission"})
    began = time.monotonic()
    child.close()
    assert child._process.poll() == -9
    assert time.monotonic() - began < 5


def lives(process: int) -> bool:
    """Whether a process is still there, other than as a zombie that nobody has asked for yet."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="it is asked of /proc what lives")
def test_what_a_child_has_started_ends_with_it(adapter: Adapter, tmp_path: Path) -> None:
    """A child that is a shell, which ends at once where it is told to: what it has started ends too."""
    path = tmp_path / "number"
    wrong = f"open({str(path)!r}, 'w').write(str(os.getpid())); time.sleep(60)"
    child = Child(["sh", "-c", f"{shlex.join(adapter(wrong, 'reset'))}; true"], timeout=10)
    child.exchange("initialize", {"system": "bear.mission"})
    child.timeout = 0.5
    with pytest.raises(SubjectError, match="did not answer reset"):
        child.exchange("reset", {})
    assert lives(int(path.read_text()))
    child.close()
    ended = time.monotonic() + 5
    while lives(int(path.read_text())) and time.monotonic() < ended:
        time.sleep(0.01)
    assert not lives(int(path.read_text()))


def test_a_child_that_leaves_somebody_behind_has_exited() -> None:
    """What it has started holds its output open; that it has exited is said at once all the same."""
    child = Child(["sh", "-c", "sleep 43 & exit 7"], timeout=30)
    began = time.monotonic()
    try:
        with pytest.raises(SubjectError, match="exited with status 7 before answering initialize"):
            child.exchange("initialize", {})
    finally:
        child.close()
    assert time.monotonic() - began < 10


@pytest.mark.parametrize("signal_number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_ends_the_adapter_too(adapter: Adapter, tmp_path: Path, signal_number: int) -> None:
    """``conform`` that is told to end ends its adapter first, though that ignores the end of its input."""
    path = tmp_path / "number"
    wrong = f"open({str(path)!r}, 'w').write(str(os.getpid())); time.sleep(60)"
    command = [sys.executable, "-m", "missionfsm", "conform", "bear.mission", "--timeout", "50", "--"]
    conforming = subprocess.Popen([*command, *adapter(wrong, "reset")], stderr=subprocess.DEVNULL)
    ended = time.monotonic() + 20
    while not (path.exists() and path.read_text()) and time.monotonic() < ended:
        time.sleep(0.05)
    conforming.send_signal(signal_number)
    assert conforming.wait(10) == 130
    assert not lives(int(path.read_text()))


def test_a_child_that_logs_without_end_fills_nothing(adapter: Adapter) -> None:
    """A flood on stderr is read and thrown away but for its end, which is told with what is wrong."""
    wrong = "os.write(2, b'x' * 50_000_000 + b'\\nthe end\\n'); sys.exit(1)"
    child = Child(adapter(wrong), timeout=30)
    try:
        with pytest.raises(SubjectError, match=r"exited with status 1 before answering initialize .stderr: the end; "):
            child.exchange("initialize", {})
        assert len(child._log.text) <= 2 * stderrlog.KEPT + 100
    finally:
        child.close()


def test_what_a_child_logs_is_no_answer(adapter: Adapter) -> None:
    """Stderr is free: a child that logs a megabyte is judged like a silent one."""
    child = Child(adapter("print('x' * 1000000, file=sys.stderr)"), timeout=20)
    try:
        assert child.exchange("initialize", {"system": "bear.mission"}).error is None
    finally:
        child.close()


# What is exchanged.


@pytest.fixture
def child() -> Iterator[Child]:
    started = Child([sys.executable, "-m", "missionfsm", "adapter", "bear.mission"])
    yield started
    started.close()


CONVERSATION: tuple[tuple[str, JSON], ...] = (
    ("initialize", {"protocolVersion": 1, "system": "bear.mission"}),
    ("reset", {"world": {"family": "base"}}),
    ("SubscribeMissionStatus", {}),
    ("CreateMission", {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}),
    ("CreateMission", {}),
    ("SkipGoal", {"unknown": 1}),
    ("drive", {"event": "missionFailed"}),
    ("drive", {"event": "missionFailed"}),
    ("settle", {}),
    ("cancel", {"stream": 2}),
    ("ClearMissionStatus", {}),
    ("reset", {}),
    ("UpdateMission", {"missionCommand": {"missionId": "mission-1", "command": "COMMAND_PAUSE"}}),
)


def told(exchange: Exchange) -> tuple[JSON, JSON, list[Notification]]:
    return exchange.result, exchange.error, [*exchange.before, *exchange.after]


def test_a_child_answers_as_its_object_does(child: Child) -> None:
    """The reference as a child process says, word for word, what the reference in this process says."""
    here = ReferenceSubject(system("bear.mission"))
    for method, params in CONVERSATION:
        near = here.exchange(method, params)
        far = child.exchange(method, params)
        # A child's notification may arrive with the next answer; those here come at once.
        late = child.exchange("settle", {})
        assert told(far)[:2] == told(near)[:2]
        assert told(far)[2] + told(late)[2] == told(near)[2]


def test_a_server_answers_whatever_it_is_sent() -> None:
    """The server answers a malformed line, an unknown method and wrong parameters with JSON-RPC's own errors."""
    lines = [
        b"{",
        b"[]",
        b"{}",
        b'{"id": 1, "method": "fly", "params": {}}',
        b'{"id": 2, "method": "SkipGoal", "params": {}}',
        b'{"id": 3, "method": "reset", "params": {"world": {"colour": "red"}}}',
        b'{"id": 4, "method": "initialize", "params": {"system": "isaac.robot"}}',
        b"",
        b'{"id": "five", "method": "reset"}',
        b'{"id": 6, "method": "SkipGoal", "params": {}}',
        b'{"id": 7, "method": "SkipGoal", "params": %b}' % (200 * b"[" + 200 * b"]"),
    ]
    out = io.BytesIO()
    serve(ReferenceSubject(system("bear.mission")), io.BytesIO(b"\n".join(lines)), out)
    answers = [orjson.loads(line) for line in out.getvalue().splitlines()]
    assert [(one["id"], one.get("error", {}).get("code"), one.get("result")) for one in answers] == [
        (None, -32700, None),
        (None, -32600, None),
        (None, -32600, None),
        (1, -32602, None),
        (2, -32602, None),
        (3, -32602, None),
        (4, -32602, None),
        ("five", None, {}),
        (6, 9, None),
        (None, -32700, None),
    ]
    assert answers[-2]["error"]["data"] == {"status": "FAILED_PRECONDITION"}
