"""The reference as a gRPC server: what a client sees, and what a test can do with it."""

from __future__ import annotations

import concurrent.futures
import queue
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import grpc
import pytest
from commandline import CommandLine
from google.protobuf import descriptor_pool, json_format, message_factory
from grpc_reflection.v1alpha.proto_reflection_descriptor_database import ProtoReflectionDescriptorDatabase

import missionfsm
from missionfsm.adapters.grpc.client import GrpcSubject
from missionfsm.adapters.grpc.control import Control
from missionfsm.adapters.grpc.descriptors import SERVICES, decode, encode, methods, path
from missionfsm.adapters.grpc.faults import Dice, Faults
from missionfsm.adapters.grpc.server import Server
from missionfsm.adapters.grpc.target import Target
from missionfsm.app.live import Live
from missionfsm.app.serve import Cue, Served, read_script, serve
from missionfsm.bear.wire.fields import PACKAGE
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check

NAVIGATE = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
WAIT = 10.0
"""Seconds after which a message that does not come fails a test."""


class Client:
    """A client as generated code would be one: paths, bytes, and nothing of the server's."""

    def __init__(self, target: str, name: str = "bear.mission", metadata: tuple[tuple[str, str], ...] = ()) -> None:
        self.channel = grpc.insecure_channel(target)
        self.methods = methods(name)
        self.metadata = metadata

    def call(self, name: str, request: JSON = None, timeout: float = WAIT) -> JSON:
        """A unary call."""
        method = self.methods[name]
        ask = self.channel.unary_unary(path(method))
        data = ask(encode(method.request, request or {}), metadata=self.metadata, timeout=timeout)
        return decode(method.response, data)

    def subscribe(self, name: str = "SubscribeMissionStatus", request: JSON = None) -> tuple[Any, queue.Queue[JSON]]:
        """A stream: the call, and its messages as they come; None at its end."""
        method = self.methods[name]
        call = self.channel.unary_stream(path(method))(encode(method.request, request or {}), metadata=self.metadata)
        found: queue.Queue[JSON] = queue.Queue()

        def listen() -> None:
            try:
                for data in call:
                    found.put(decode(method.response, data))
            except grpc.RpcError:
                pass
            found.put(None)

        threading.Thread(target=listen, daemon=True).start()
        return call, found


@pytest.fixture
def client(robot: Served) -> Iterator[Client]:
    found = Client(robot.target)
    yield found
    found.channel.close()


def refusal(client: Client, name: str, request: JSON = None) -> Any:
    with pytest.raises(grpc.RpcError) as raised:
        client.call(name, request)
    return raised.value


def test_a_mission_runs_from_its_creation_to_its_end(robot: Served, client: Client) -> None:
    """A client creates a mission, the test says that its goal is reached, and the subscriber sees it succeed."""
    _, messages = client.subscribe()
    assert messages.get(timeout=WAIT)["missionStates"] == {"currentMissionIndex": -1}
    mission = client.call("CreateMission", NAVIGATE)["missionId"]
    running = messages.get(timeout=WAIT)["missionStates"]["missions"][0]
    assert (running["missionId"], running["state"]) == (mission, "STATE_RUNNING")
    assert robot.drive("goalReached")
    assert messages.get(timeout=WAIT)["missionStates"]["missions"][0]["state"] == "STATE_SUCCEEDED"


def test_two_subscribers_see_one_event_under_one_number(robot: Served, client: Client) -> None:
    """Numbers and timestamps are those of events: every stream shows the same event alike."""
    _, first = client.subscribe()
    first.get(timeout=WAIT)
    client.call("CreateMission", NAVIGATE)
    latest = first.get(timeout=WAIT)
    _, second = client.subscribe()
    assert second.get(timeout=WAIT) == latest
    robot.drive("goalReached")
    assert second.get(timeout=WAIT) == first.get(timeout=WAIT)


def test_a_refusal_names_its_rule_and_place(client: Client) -> None:
    """A refused call has the documented code, and its rule and citation in the trailing metadata."""
    client.call("CreateMission", NAVIGATE)
    error = refusal(client, "CreateMission", NAVIGATE)
    assert error.code() is grpc.StatusCode.FAILED_PRECONDITION
    assert dict(error.trailing_metadata()) == {
        "missionfsm-rule": "bear.mission/CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued",
        "missionfsm-cite": "Mission > CreateMission > Errors",
    }


def test_bytes_that_are_no_message_are_an_invalid_argument(client: Client) -> None:
    """What cannot be decoded is INVALID_ARGUMENT."""
    ask = client.channel.unary_unary(path(client.methods["CreateMission"]))
    with pytest.raises(grpc.RpcError) as raised:
        ask(b"\xff\xff\xff", timeout=WAIT)
    assert raised.value.code() is grpc.StatusCode.INVALID_ARGUMENT


def test_calls_that_are_not_modelled_are_unimplemented(client: Client) -> None:
    """Another call of the service, and another service, answer UNIMPLEMENTED."""
    for name in ("/bearrobotics.api.v1.services.robot.APIService/GetMap", "/other.Service/Call"):
        with pytest.raises(grpc.RpcError) as raised:
            client.channel.unary_unary(name)(b"", timeout=WAIT)
        assert raised.value.code() is grpc.StatusCode.UNIMPLEMENTED


@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_reflection_is_enough_to_call_every_method(name: str) -> None:
    """A client that knows no definitions lists services and calls by reflection, calls each, and reads the answers."""
    goal = {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}
    ids = {"selector": {"robotIds": {"ids": ["r1"]}}}
    said = {"CreateMission": {"mission": goal}, "AppendMission": {"mission": goal}, "GetRobotStatus": {"robotId": "r1"}}
    world = system(name).alphabet({}, Bounds(1)).worlds[0] if name == "bear.status" else {}
    with serve(name, world=world) as robot, grpc.insecure_channel(robot.target) as channel:
        database = ProtoReflectionDescriptorDatabase(channel)
        services = set(database.get_services())
        full_name = f"{PACKAGE}.{SERVICES[name]}"
        assert {full_name, "missionfsm.control.v1.Control"} <= services
        service = descriptor_pool.DescriptorPool(database).FindServiceByName(full_name)
        assert {one.name for one in service.methods} == set(methods(name))
        answered = {}
        for method in sorted(service.methods, key=lambda one: one.name != "CreateMission"):
            request = said.get(method.name, ids if name == "bear.status" else {})
            request = json_format.ParseDict(request, message_factory.GetMessageClass(method.input_type)())
            how = channel.unary_stream if method.server_streaming else channel.unary_unary
            call = how(f"/{full_name}/{method.name}")
            try:
                asked = call(request.SerializeToString(), timeout=WAIT)
                answer = next(asked) if method.server_streaming else asked
                message_factory.GetMessageClass(method.output_type).FromString(answer)
                answered[method.name] = "OK"
            except grpc.RpcError as error:
                answered[method.name] = error.code().name
    refused = {one: code for one, code in answered.items() if code != "OK"}
    if name == "bear.status":
        assert refused == {}
    else:
        assert set(answered) - set(refused) >= {"CreateMission", "AppendMission", "SubscribeMissionStatus"}
        assert set(refused.values()) <= {"INVALID_ARGUMENT", "FAILED_PRECONDITION", "NOT_FOUND"}


def test_the_control_service_sets_the_scene(robot: Served, client: Client) -> None:
    """By the control service a test in any language resets, drives and reads the history."""
    control = Control(robot.target)
    assert control.describe() == {"system": "bear.mission", "drives": list(system("bear.mission").spec.drives)}
    control.reset({"family": "carti", "destinations": ["dock-7"]})
    assert refusal(client, "CreateMission", NAVIGATE).code() is grpc.StatusCode.INVALID_ARGUMENT
    assert control.drive("goalReached") is False
    with pytest.raises(grpc.RpcError, match="INVALID_ARGUMENT"):
        control.drive("noSuchDrive")
    assert [line.get("method", line.get("system")) for line in control.history()][:2] == [
        "bear.mission",
        "CreateMission",
    ]
    control.close()


def test_what_clients_did_is_a_history_that_conforms(robot: Served, client: Client) -> None:
    """The history of several clients at once is judged as conforming."""
    _, messages = client.subscribe()

    def busy(number: int) -> None:
        other = Client(robot.target)
        for _ in range(5):
            try:
                other.call("AppendMission" if number % 2 else "CreateMission", NAVIGATE)
            except grpc.RpcError:
                robot.drive("goalReached")
        other.channel.close()

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        list(pool.map(busy, range(4)))
    first, *lines = robot.history()
    verdict = check(system("bear.mission"), head(first), lines)
    assert verdict.conforms, str(verdict)
    assert len(lines) > 40
    assert messages.get(timeout=WAIT) is not None


def test_a_subscriber_that_goes_away_is_forgotten(robot: Served, client: Client) -> None:
    """A cancelled stream is given up by the robot as well."""
    call, messages = client.subscribe()
    messages.get(timeout=WAIT)
    call.cancel()
    assert messages.get(timeout=WAIT) is None
    for _ in range(200):
        if any(line.get("method") == "cancel" for line in robot.history()):
            return
        threading.Event().wait(0.02)
    pytest.fail("the robot still sends to a subscriber who has gone")


def test_many_streams_need_no_thread_each(robot: Served, client: Client) -> None:
    """A hundred subscribers all see the next event, and no thread was started for them by the server."""
    method = client.methods["SubscribeMissionStatus"]
    calls = [client.channel.unary_stream(path(method))(b"") for _ in range(100)]
    for call in calls:
        next(call)
    before = threading.active_count()
    client.call("CreateMission", NAVIGATE)
    numbers = {decode(method.response, next(call))["metadata"]["sequenceNumber"] for call in calls}
    assert len(numbers) == 1
    assert threading.active_count() <= before + 1
    for call in calls:
        call.cancel()
    assert robot.history()


def test_a_token_that_expires_ends_streams_and_a_client_comes_back_with_a_new_one() -> None:
    """A stream ends UNAUTHENTICATED when its token expires, calls with it are refused, and a new one opens all."""
    old, new = ((("authorization", f"Bearer {token}"),) for token in ("old", "new"))
    subscribe, charge = (path(methods("bear.mission")[name]) for name in ("SubscribeMissionStatus", "ChargeRobot"))
    with serve("bear.mission", token="old") as robot, grpc.insecure_channel(robot.target) as channel:  # noqa: S106
        stream = channel.unary_stream(subscribe)(b"", metadata=old, timeout=WAIT)
        next(stream)
        robot.renew("new")
        for ask in (lambda: next(stream), lambda: channel.unary_unary(charge)(b"", metadata=old, timeout=WAIT)):
            with pytest.raises(grpc.RpcError) as refused:
                ask()
            assert refused.value.code() is grpc.StatusCode.UNAUTHENTICATED
        again = channel.unary_stream(subscribe)(b"", metadata=new, timeout=WAIT)
        next(again)
        channel.unary_unary(charge)(b"", metadata=new, timeout=WAIT)
        next(again)
        again.cancel()
        assert missionfsm.check(robot.history()).conforms


@pytest.mark.parametrize("command", [("serve", "--grpc"), ("proxy", "--grpc", "localhost:1", "--listen")])
def test_a_port_that_is_taken_is_told_in_one_line(
    command: tuple[str, ...], robot: Served, command_line: CommandLine
) -> None:
    """Nobody listens where somebody else does; the line says where, and why."""
    verb, *options = command
    ended = command_line(verb, "bear.mission", *options, str(robot.port))
    assert (ended.status, ended.out) == (2, "")
    assert ended.err == f"missionfsm: 127.0.0.1:{robot.port}: Address already in use\n"


def test_a_token_that_nobody_has_to_send_cannot_expire(robot: Served) -> None:
    """A robot without a token has none to renew."""
    with pytest.raises(ValueError, match="none expires"):
        robot.renew("new")


def test_a_token_is_asked_for() -> None:
    """Without the token every call is UNAUTHENTICATED; with it calls are served."""
    with serve("bear.mission", token="secret") as robot:  # noqa: S106 - it is nobody's
        stranger, friend = Client(robot.target), Client(robot.target, metadata=(("authorization", "Bearer secret"),))
        assert refusal(stranger, "ChargeRobot").code() is grpc.StatusCode.UNAUTHENTICATED
        assert friend.call("ChargeRobot")["missionId"]


def test_faults_are_the_same_for_the_same_seed() -> None:
    """Faults are drawn from the seed alone; a deadline may have been too late or too early."""
    faults = Faults.parse(["deadline:0.5", "lost:0.5", "doubled:0.25"])
    drawn = [
        [(dice.deadline(), dice.copies(first=False)) for _ in range(50)] for dice in (Dice(faults, 3), Dice(faults, 3))
    ]
    assert drawn[0] == drawn[1]
    assert {one for one, _ in drawn[0]} == {"", "applied", "lost"}
    assert {copies for _, copies in drawn[0]} == {0, 1, 2}
    assert Dice(faults, 3).copies(first=True) >= 1


@pytest.mark.parametrize(
    "text", ["deadline", "deadline:2", "deadline:x", "ends:0", "ends:inf", "nothing:1", "lost:nan"]
)
def test_a_wrong_fault_is_refused_in_words(text: str) -> None:
    """A fault that does not exist, or out of range, is named in the error."""
    with pytest.raises(ValueError, match=r"^'"):
        Faults.parse([text])


@pytest.mark.parametrize("code", [grpc.StatusCode.INTERNAL, grpc.StatusCode.UNAVAILABLE])
def test_calls_and_subscriptions_fail_without_effect(code: grpc.StatusCode) -> None:
    """With the fault now a call fails and now a subscription, in which nothing happens; the history conforms."""
    with serve("bear.mission", faults=[f"{code.name.lower()}:0.5"], seed=2) as robot:
        client = Client(robot.target)
        listed, codes = 0, set()
        for _ in range(10):
            call, messages = client.subscribe()
            first = messages.get(timeout=WAIT)
            if first is None:
                codes.add(("SubscribeMissionStatus", call.code()))
            else:
                assert len(first["missionStates"].get("missions", ())) == listed
            try:
                client.call("ChargeRobot" if not listed else "AppendMission", {} if not listed else NAVIGATE)
                listed += 1
            except grpc.RpcError as error:
                codes.add(("call", error.code()))
        assert codes == {("SubscribeMissionStatus", code), ("call", code)}
        assert listed
        verdict = missionfsm.check(robot.history())
    assert verdict.conforms, str(verdict)


def test_a_deadline_may_have_taken_effect() -> None:
    """With the fault, some calls answer DEADLINE_EXCEEDED; of those some have created a mission."""
    with serve("bear.mission", faults=["deadline:1"], seed=1) as robot:
        client = Client(robot.target)
        applied = set()
        for _ in range(8):
            robot.reset()
            assert refusal(client, "CreateMission", NAVIGATE).code() is grpc.StatusCode.DEADLINE_EXCEEDED
            _, messages = client.subscribe()
            applied.add(bool(messages.get(timeout=WAIT)["missionStates"].get("missions")))
        assert applied == {True, False}


def test_a_stream_ends_when_it_is_told_to() -> None:
    """``ends`` closes every stream cleanly after so many seconds."""
    with serve("bear.mission", faults=["ends:0.05"]) as robot:
        call, messages = Client(robot.target).subscribe()
        assert messages.get(timeout=WAIT) is not None
        assert messages.get(timeout=WAIT) is None
        assert call.code() is grpc.StatusCode.OK


def test_a_robot_that_drives_itself_reaches_its_goals() -> None:
    """With ``auto`` a mission ends although nobody drives; a script comes first."""
    cues = (Cue(0.0, {"event": "world", "destinations": ["table-1", "bar"]}),)
    with serve("bear.mission", auto=0.01, script=cues) as robot:
        client = Client(robot.target)
        _, messages = client.subscribe()
        client.call("CreateMission", NAVIGATE)
        for _ in range(20):
            missions = messages.get(timeout=WAIT)["missionStates"].get("missions", [{}])
            if missions[0].get("state") == "STATE_SUCCEEDED":
                return
        pytest.fail("the mission did not end")


@pytest.mark.parametrize(
    "line", ["[]", "{}", '{"drive": {"event": "none"}}', '{"after": -1, "drive": {}}', "{", '{"x": 1}']
)
def test_a_wrong_script_is_refused_with_its_line(line: str) -> None:
    """What is no cue is named with its line."""
    with pytest.raises(UnreadableError, match=r"^line 2: "):
        read_script(f'{{"drive": {{"event": "goalReached"}}}}\n{line}', system("bear.mission"))


def test_a_fleet_is_served_behind_one_port() -> None:
    """Of ``bear.status`` several robots are served, told apart by the selectors of the calls."""
    world = {
        "robots": [
            {"robotId": name, "locationId": "L1", "owned": True, "state": {"battery": {"chargePercent": percent}}}
            for name, percent in (("r1", 10), ("r2", 90))
        ],
        "locations": [{"locationId": "L1", "owned": True}],
    }
    with serve("bear.status", world=world) as fleet:
        client = Client(fleet.target, "bear.status")
        assert client.call("GetRobotStatus", {"robotId": "r2"})["robotState"]["battery"]["chargePercent"] == 90
        _, messages = client.subscribe("SubscribeBatteryStatus", {"selector": {"locationId": "L1"}})
        assert {messages.get(timeout=WAIT)["robotId"] for _ in range(2)} == {"r1", "r2"}


def test_a_port_that_is_taken_is_an_error_with_its_name(robot: Served) -> None:
    """A second server on the same port is refused, not mixed up with the first."""
    with pytest.raises(OSError, match=str(robot.port)), serve("bear.mission", port=robot.port):
        pytest.fail("two servers on one port")


def test_only_bear_systems_are_served() -> None:
    """Isaac's systems do not speak gRPC."""
    with pytest.raises(ValueError, match=r"^'isaac.server' is not served over gRPC; bear.mission and bear.status are$"):
        serve("isaac.server").__enter__()


def test_the_fixture_of_the_plugin_serves_until_the_test_ends(missionfsm_serve: Callable[..., Served]) -> None:
    """Several robots at once, each in its own world, for a test that asks for the fixture."""
    one, other = missionfsm_serve(), missionfsm_serve("bear.mission", world={"destinations": ["bar"]})
    assert Client(one.target).call("CreateMission", NAVIGATE)["missionId"]
    assert refusal(Client(other.target), "CreateMission", NAVIGATE).code() is grpc.StatusCode.INVALID_ARGUMENT
    assert missionfsm.serve is serve


def test_tls_is_spoken_with_a_certificate(tls: tuple[str, str]) -> None:
    """With a certificate a client that trusts it is served, the subject of conform as well; one without TLS is not."""
    certificate, key = tls
    with serve("bear.mission", certificate=certificate, key=key, token="sesame") as robot:  # noqa: S106 - nobody's
        target = Target(f"localhost:{robot.port}", "sesame", certificate=certificate, timeout=WAIT)
        subject = GrpcSubject("bear.mission", target)
        assert subject.exchange("CreateMission", NAVIGATE).error is None
        subject.close()
        assert refusal(Client(robot.target), "ChargeRobot").code() is grpc.StatusCode.UNAVAILABLE


def test_no_message_is_left_behind_where_threads_drive(robot: Served, client: Client) -> None:
    """Whatever threads cause, every subscriber sees every event, in order, up to the last."""
    client.call("CreateMission", NAVIGATE)
    streams = [client.subscribe()[1] for _ in range(3)]

    def work(_: int) -> None:
        other = Client(robot.target)
        for _ in range(20):
            other.call("AppendMission", NAVIGATE)
            robot.drive("goalReached")
        other.channel.close()

    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        list(pool.map(work, range(3)))
    last = number_of(client.subscribe()[1].get(timeout=WAIT))
    seen = [[number_of(message) for message in until(last, one)] for one in streams]
    assert seen[0] == seen[1] == seen[2] == sorted(set(seen[0]))


def number_of(message: JSON) -> int:
    return int(message["metadata"]["sequenceNumber"])


def until(last: int, messages: queue.Queue[JSON]) -> Iterator[JSON]:
    """The messages of a stream up to the one with a number."""
    while True:
        message = messages.get(timeout=WAIT)
        yield message
        if number_of(message) == last:
            return


JSON_ONLY = tuple(
    (name, f"{one.id}={letter}")
    for name in ("bear.mission", "bear.status")
    for one in system(name).spec.ambiguities
    for letter in sorted(one.json_only)
)


def test_which_readings_only_json_says() -> None:
    """Three of all are about JSON; tests/bench/test_bench_breaks.py looks for more among what the others say."""
    assert [reading for _, reading in JSON_ONLY] == [
        "AM-50.shape=b",
        "AS-22.GetRobotStatus=b",
        "AS-22.SubscribeRobotStatus=b",
    ]


@pytest.mark.parametrize(("name", "reading"), JSON_ONLY)
def test_a_reading_that_only_json_says_is_refused_over_grpc(name: str, reading: str, command_line: CommandLine) -> None:
    """No robot is served, judged or watched by it: one line says why."""
    nobody = "localhost:1"
    for command in (("serve", "0"), ("conform", nobody), ("proxy", nobody, "--listen", "0")):
        ended = command_line(command[0], name, "--grpc", *command[1:], "--reading", reading)
        says = f"missionfsm: {reading}: only JSON can say it; over gRPC there is one form, and nothing follows it\n"
        assert (ended.status, ended.out, ended.err) == (2, "", says)


def test_what_binary_has_no_form_for_ends_a_stream_in_words() -> None:
    """An implementation that says it all the same ends the stream with INTERNAL, and the details say why."""
    live = Live(system("bear.mission"), {"family": "servi"}, {"AM-50.shape": "b"}, clock=time.time)
    with Server(live) as robot:
        client = Client(robot.target)
        call, messages = client.subscribe()
        assert messages.get(timeout=WAIT) is not None
        delivery = {"mission": {"serviMission": {"deliveryMission": {"goals": [{"destinationId": "table-1"}]}}}}
        client.call("CreateMission", delivery)
        assert messages.get(timeout=WAIT) is None
        assert call.code() is grpc.StatusCode.INTERNAL
        assert call.details().startswith("SubscribeMissionStatus: binary protobuf cannot say this: ")
