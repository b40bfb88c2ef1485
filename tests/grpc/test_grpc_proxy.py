"""A proxy between clients and a robot: what passes, what is recorded, and what never holds traffic up."""

from __future__ import annotations

import concurrent.futures
import json
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import grpc
import pytest
from relay import METHODS, NAVIGATE, WAIT, Relay, as_they_are, eventually

from missionfsm.adapters.grpc.client import GrpcSubject
from missionfsm.adapters.grpc.descriptors import decode, path
from missionfsm.adapters.grpc.target import Target
from missionfsm.app.asked import judged_system
from missionfsm.app.recorded import check_file
from missionfsm.app.recorder import Recorder
from missionfsm.app.serve import Served, serve
from missionfsm.kernel.codec import JSON
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.conform.conform import conform

HEAD = {"missionfsm": 1, "system": "bear.mission", "world": {}}


def without_times(lines: list[JSON]) -> list[JSON]:
    return [{key: value for key, value in line.items() if key != "at"} for line in lines]


def test_an_answer_and_a_refusal_pass_as_they_are(relay: Relay, lines: list[JSON]) -> None:
    """Answers, codes, messages and trailing metadata are those of the robot, and both are recorded."""
    mission = relay.call("CreateMission", NAVIGATE)["missionId"]
    with pytest.raises(grpc.RpcError) as refused:
        relay.call("CreateMission", NAVIGATE)
    assert refused.value.code() is grpc.StatusCode.FAILED_PRECONDITION
    assert "missionfsm-rule" in dict(refused.value.trailing_metadata())
    assert without_times(lines) == [
        {"call": 1, "method": "CreateMission", "params": NAVIGATE},
        {"return": 1, "result": {"missionId": mission}},
        {"call": 2, "method": "CreateMission", "params": NAVIGATE},
        {"return": 2, "error": {"status": "FAILED_PRECONDITION", "message": refused.value.details()}},
    ]


def test_a_stream_passes_message_by_message(relay: Relay, robot: Served, lines: list[JSON]) -> None:
    """A subscriber behind the proxy sees what the robot sends when it sends it; giving up is recorded."""
    method = METHODS["SubscribeMissionStatus"]
    call = relay.channel.unary_stream(path(method))(b"")
    first = decode(method.response, next(call))
    mission = relay.call("CreateMission", NAVIGATE)["missionId"]
    second = decode(method.response, next(call))
    call.cancel()
    assert eventually(lambda: lines[-1].get("result") == {})
    assert [line for line in without_times(lines) if "message" in line] == [
        {"stream": 1, "message": first},
        {"stream": 1, "message": second},
    ]
    assert second["missionStates"]["missions"][0]["missionId"] == mission
    assert [line["method"] for line in lines if "method" in line] == [
        "SubscribeMissionStatus",
        "CreateMission",
        "cancel",
    ]
    assert eventually(lambda: any(line.get("method") == "cancel" for line in robot.history()))


def test_a_subscription_that_is_refused_never_begins(lines: list[JSON]) -> None:
    """Neither the client nor the record sees a stream where the robot refuses one."""
    with serve("bear.status") as robot:
        relay = Relay(robot.target, lines.append, system="bear.status")
        direct, proxied = (
            GrpcSubject("bear.status", Target(target)) for target in (robot.target, f"localhost:{relay.proxy.port}")
        )
        for subject in (direct, proxied) * 10:
            assert subject.exchange("SubscribeBatteryStatus", {}).error["status"] == "INVALID_ARGUMENT"
        direct.close()
        proxied.close()
        relay.close()
    assert [line["error"]["status"] for line in lines if "return" in line] == ["INVALID_ARGUMENT"] * 10


def test_calls_that_nobody_knows_pass_and_leave_no_line(relay: Relay, lines: list[JSON]) -> None:
    """What is not modelled is passed on as well; the robot says UNIMPLEMENTED, and nothing is recorded."""
    for _ in range(5):
        with pytest.raises(grpc.RpcError) as refused:
            relay.channel.unary_unary("/other.Service/Call")(b"\x00\x01", timeout=WAIT)
        assert refused.value.code() is grpc.StatusCode.UNIMPLEMENTED
    assert lines == []


def test_metadata_passes_but_is_not_recorded() -> None:
    """A token reaches the robot, and stands in no line of the history."""
    lines: list[JSON] = []
    with serve("bear.mission", token="sesame") as robot:  # noqa: S106 - it is nobody's
        relay = Relay(robot.target, lines.append)
        with pytest.raises(grpc.RpcError) as refused:
            relay.call("ChargeRobot")
        assert refused.value.code() is grpc.StatusCode.UNAUTHENTICATED
        assert relay.call("ChargeRobot", metadata=(("authorization", "Bearer sesame"),))["missionId"]
        relay.close()
    assert "sesame" not in json.dumps(lines)


def test_both_sides_may_have_tls(tls: tuple[str, str], lines: list[JSON]) -> None:
    """The robot is reached over TLS, and clients reach the proxy so; both are recorded as without."""
    certificate, key = tls
    with serve("bear.mission", certificate=certificate, key=key) as robot:
        relay = Relay(f"localhost:{robot.port}", lines.append, tls)
        mission = relay.call("CreateMission", NAVIGATE)["missionId"]
        bare = grpc.insecure_channel(f"localhost:{relay.proxy.port}")
        with pytest.raises(grpc.RpcError) as refused:
            bare.unary_unary(path(METHODS["ChargeRobot"]))(b"", timeout=WAIT)
        assert refused.value.code() is grpc.StatusCode.UNAVAILABLE
        bare.close()
        relay.close()
    assert without_times(lines)[-1] == {"return": 1, "result": {"missionId": mission}}


def test_a_token_that_expires_is_refused_by_the_robot(lines: list[JSON]) -> None:
    """Calls and subscriptions with a token that is good no more are UNAUTHENTICATED, and the record conforms."""
    with serve("bear.mission", token="new") as robot:  # noqa: S106 - it is nobody's
        relay = Relay(robot.target, lines.append)
        old, new = ((("authorization", f"Bearer {token}"),) for token in ("old", "new"))
        assert relay.call("CreateMission", NAVIGATE, metadata=new)["missionId"]
        for name in ("AppendMission", "SubscribeMissionStatus"):
            with pytest.raises(grpc.RpcError) as refused:
                next(relay.channel.unary_stream(path(METHODS[name]))(b"", timeout=WAIT, metadata=old))
            assert refused.value.code() is grpc.StatusCode.UNAUTHENTICATED
        relay.close()
    verdict = check(judged_system("bear.mission", strict=False), head(HEAD), without_times(lines))
    assert verdict.violation is None, str(verdict)


def test_a_token_that_expires_during_a_stream_ends_it_behind_the_proxy(lines: list[JSON]) -> None:
    """The subscriber hears UNAUTHENTICATED, comes back with a new token, and the record of all that conforms."""
    subscribe = path(METHODS["SubscribeMissionStatus"])
    with serve("bear.mission", token="old") as robot:  # noqa: S106 - it is nobody's
        relay = Relay(robot.target, lines.append)
        old, new = ((("authorization", f"Bearer {token}"),) for token in ("old", "new"))
        stream = relay.channel.unary_stream(subscribe)(b"", metadata=old, timeout=WAIT)
        next(stream)
        robot.renew("new")
        with pytest.raises(grpc.RpcError) as ended:
            next(stream)
        assert ended.value.code() is grpc.StatusCode.UNAUTHENTICATED
        again = relay.channel.unary_stream(subscribe)(b"", metadata=new, timeout=WAIT)
        next(again)
        assert relay.call("CreateMission", NAVIGATE, metadata=new)["missionId"]
        next(again)
        relay.close()
    closed = [line["error"]["status"] for line in lines if line.get("closed") and line["stream"] == 1]
    assert closed == ["UNAUTHENTICATED"]
    verdict = check(judged_system("bear.mission", strict=False), head(HEAD), without_times(lines))
    assert verdict.violation is None, str(verdict)


def test_a_call_that_is_cancelled_stays_without_an_answer(lines: list[JSON]) -> None:
    """A client that gives up its call cancels it at the robot; the history has the call and no answer."""
    slow = Slow()
    relay = Relay(f"127.0.0.1:{slow.port}", lines.append)
    call = relay.channel.unary_unary(path(METHODS["CreateMission"])).future(b"", timeout=WAIT)
    assert slow.asked.wait(WAIT)
    call.cancel()
    assert slow.cancelled.wait(WAIT)
    relay.close()
    slow.stop()
    assert [line.get("call") for line in lines] == [1]


class Slow:
    """A robot that answers CreateMission never."""

    def __init__(self) -> None:
        self.asked, self.cancelled = threading.Event(), threading.Event()
        self._server = grpc.server(concurrent.futures.ThreadPoolExecutor(2))
        service, name = path(METHODS["CreateMission"]).split("/")[1:]
        handlers = {name: grpc.unary_unary_rpc_method_handler(self._wait)}
        self._server.add_generic_rpc_handlers((grpc.method_handlers_generic_handler(service, handlers),))
        self.port = self._server.add_insecure_port("127.0.0.1:0")
        self._server.start()

    def _wait(self, _: bytes, context: Any) -> bytes:
        context.add_callback(self.cancelled.set)
        self.asked.set()
        self.cancelled.wait(WAIT)
        return b""

    def stop(self) -> None:
        self._server.stop(0).wait()


def test_a_deadline_of_the_client_reaches_the_robot(relay: Relay, lines: list[JSON]) -> None:
    """A call whose time is up ends for the client; in the history it has no answer or that of the deadline."""
    method = METHODS["SubscribeMissionStatus"]
    call = relay.channel.unary_stream(path(method))(b"", timeout=0.3)
    with pytest.raises(grpc.RpcError) as ended:
        for _ in call:
            pass
    assert ended.value.code() is grpc.StatusCode.DEADLINE_EXCEEDED
    assert eventually(lambda: lines[-1].get("closed") or lines[-1].get("result") == {})


def test_bytes_that_are_no_message_pass_and_are_recorded_as_such(relay: Relay, lines: list[JSON]) -> None:
    """The proxy judges nothing: rubbish reaches the robot, whose refusal comes back."""
    ask = relay.channel.unary_unary(path(METHODS["CreateMission"]))
    with pytest.raises(grpc.RpcError) as refused:
        ask(b"\xff\xff", timeout=WAIT)
    assert refused.value.code() is grpc.StatusCode.INVALID_ARGUMENT
    assert lines[0]["params"].startswith("(malformed: ")
    verdict = check(system("bear.mission"), head(HEAD), without_times(lines))
    assert verdict.violation is None


def test_a_robot_that_is_away_is_unavailable(lines: list[JSON]) -> None:
    """Where the robot cannot be reached the client is told so, and the proxy lives on."""
    with serve("bear.mission") as robot:
        relay = Relay(robot.target, lines.append)
        relay.call("ChargeRobot")
    with pytest.raises(grpc.RpcError) as refused:
        relay.call("ChargeRobot")
    assert refused.value.code() is grpc.StatusCode.UNAVAILABLE
    relay.close()


def test_busy_clients_lose_nothing(relay: Relay, robot: Served, lines: list[JSON], tmp_path: Path) -> None:
    """Four clients at once: every call is recorded once with its answer, and the record conforms."""

    def busy(_: int) -> int:
        done = 0
        for name in ("CreateMission", "AppendMission", "SkipGoal"):
            try:
                relay.call(name, NAVIGATE if name.endswith("Mission") else None)
            except grpc.RpcError:
                robot.drive("goalReached")
            done += 1
        return done

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        total = sum(pool.map(busy, range(4)))
    assert eventually(lambda: sum("return" in line for line in lines) == total)
    called, returned = ([line[key] for line in lines if key in line] for key in ("call", "return"))
    assert sorted(called) == sorted(returned) == list(range(1, total + 1))
    file = tmp_path / "busy.jsonl"
    file.write_text("".join(f"{json.dumps(line)}\n" for line in (HEAD, *without_times(lines))))
    ((_, verdict),) = check_file(str(file), {}, lambda _: None)
    assert verdict.violation is None, str(verdict)


# The recorder.


def record(lines: list[JSON], file: Path | None = None, **options: Any) -> tuple[Recorder[JSON], list[str]]:
    told: list[str] = []
    recorder: Recorder[JSON] = Recorder(HEAD, as_they_are, file=str(file or ""), tell=told.append, **options)
    for line in lines:
        recorder.record(line)
    return recorder, told


GOOD: list[JSON] = [
    {"call": 1, "method": "CreateMission", "params": NAVIGATE},
    {"return": 1, "result": {"missionId": "m"}},
]
BAD: list[JSON] = [
    {"call": 2, "method": "CreateMission", "params": NAVIGATE},
    {"return": 2, "result": {"missionId": "n"}},
    {"settled": True},
    {"call": 3, "method": "CreateMission", "params": NAVIGATE},
    {"return": 3, "error": {"status": "NOT_FOUND", "message": ""}},
]


def test_what_was_recorded_is_judged_while_it_comes(tmp_path: Path) -> None:
    """The file has every line after the first one, and the judge's verdict is that of ``check``."""
    file = tmp_path / "day.jsonl"
    recorder, told = record(GOOD, file)
    judged = recorder.close()
    assert [json.loads(line) for line in file.read_text().splitlines()] == [HEAD, *GOOD]
    assert judged is not None
    assert judged.conforms
    assert judged.verdict["verdict"] == "conforms"
    assert told == []


def test_what_breaks_is_told_before_the_end() -> None:
    """A violation is told as soon as its line is there; lines that follow are recorded all the same."""
    recorder, told = record([*GOOD, *BAD])
    assert eventually(lambda: told)
    assert told[0].startswith("violates: bear.mission, ")
    assert told[0].endswith("; CreateMission(base navigate to 'table-1') was answered NOT_FOUND")
    recorder.record({"settled": True})
    judged = recorder.close()
    assert judged is not None
    assert not judged.conforms
    assert len(told) == 1


def test_a_full_disk_ends_the_file_and_nothing_else() -> None:
    """Where the file cannot be written any more that is said once, and judging goes on."""
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("this system has no /dev/full")
    recorder, told = record(GOOD, full)
    judged = recorder.close()
    assert told == ["/dev/full: No space left on device; nothing more is recorded, traffic goes on"]
    assert judged is not None
    assert judged.conforms


@pytest.mark.parametrize("name", ["bear.mission", pytest.param("bear.status", marks=pytest.mark.long)])
def test_a_conformance_run_through_the_proxy_is_judged_alike(name: str, tmp_path: Path) -> None:
    """A tester who resets and drives the robot through the proxy, ``conform --grpc``, leaves a record of many
    conversations, one for each reset and world; the proxy's verdict is that of ``check``, and both conform.
    """
    file, told = tmp_path / "day.jsonl", list[str]()
    recorder: Recorder[JSON] = Recorder({**HEAD, "system": name}, as_they_are, file=str(file), tell=told.append)
    with serve(name) as robot:
        relay = Relay(robot.target, recorder.record, system=name)
        tester = GrpcSubject(name, Target(f"localhost:{relay.proxy.port}", timeout=WAIT, settle=0.02, begin=0.2))
        seen = judged_system(name, strict=False)
        verdict = conform(seen, tester, drawn=1, tours=1, steps=10, seed=3, advice=False)
        tester.close()
        relay.close()
    judged = recorder.close()
    assert verdict.conforms, str(verdict)
    assert judged is not None
    ((_, again),) = check_file(str(file))
    assert (told, judged.verdict["verdict"], again.to_json()["verdict"]) == ([], "conforms", "conforms")
    heads = [line for line in map(json.loads, file.read_text().splitlines()) if "missionfsm" in line]
    assert len(heads) == 1 + verdict.examples
    assert heads[1]["drives"] == list(system(name).spec.drives)


@pytest.mark.long
def test_a_page_says_how_it_stands(tmp_path: Path) -> None:
    """While traffic goes on the page refreshes itself, at once with what broke; at the end it is the report."""
    page = tmp_path / "day.html"
    recorder, _ = record(GOOD, html=str(page))
    assert eventually(page.exists)
    assert 'http-equiv="refresh"' in page.read_text()
    assert "nothing is wrong so far" in page.read_text()
    for line in BAD:
        recorder.record(line)
    assert eventually(lambda: "another-mission-is-active-or-queued" in page.read_text())
    assert 'http-equiv="refresh"' in page.read_text()
    recorder.close()
    assert 'http-equiv="refresh"' not in page.read_text()


def test_a_page_that_cannot_be_written_is_told_once(tmp_path: Path) -> None:
    """A page in no folder is said in one line, and judging goes on."""
    recorder, told = record(GOOD, html=str(tmp_path / "none" / "day.html"))
    judged = recorder.close()
    assert told == [f"{tmp_path}/none/day.html: No such file or directory; the page is not written any more"]
    assert judged is not None
    assert judged.conforms


def test_a_robot_that_is_killed_and_comes_back_is_served_again(lines: list[JSON]) -> None:
    """Streams end with UNAVAILABLE, and so do calls in between; the proxy lives on and finds the new robot."""
    command = [sys.executable, "-m", "missionfsm", "serve", "bear.mission", "--grpc", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as robot:
        assert robot.stdout is not None
        port = int(robot.stdout.readline().split(";")[0].rpartition(":")[2])
        relay = Relay(f"127.0.0.1:{port}", lines.append)
        method = METHODS["SubscribeMissionStatus"]
        stream = relay.channel.unary_stream(path(method))(b"")
        next(stream)
        robot.kill()
    for ask in (lambda: next(stream), lambda: relay.call("ChargeRobot")):
        with pytest.raises(grpc.RpcError) as ended:
            ask()
        assert ended.value.code() is grpc.StatusCode.UNAVAILABLE
    with serve("bear.mission", port=port):
        assert eventually(lambda: _answers(relay))
    assert [line for line in lines if line.get("closed")] != []
    relay.close()


def _answers(relay: Relay) -> bool:
    try:
        return bool(relay.call("ChargeRobot")["missionId"])
    except grpc.RpcError as error:
        return error.code() is grpc.StatusCode.FAILED_PRECONDITION
