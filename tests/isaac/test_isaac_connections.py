"""Who listens where, who takes over whose name, who leaves while reporting; and lines that nobody reads."""

import asyncio
import os
import socket
import threading
import time

import pytest
from isaac_helpers import RUNNING, SUCCESS, Driver, says_name, uuid

from missionfsm.adapters.background import BackgroundLines
from missionfsm.adapters.isaac.lines import address
from missionfsm.adapters.isaac.settings import Settings
from missionfsm.adapters.isaac.tcp import TcpMissionServer, fresh_uuid
from missionfsm.isaac.runtime.log import Level, Narrator
from missionfsm.isaac.runtime.missions import MissionRequest, RobotTakenOver, Status, StatusChanged
from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto


def test_isaac_server_a_name_that_is_taken_over_is_one_effect() -> None:
    """Another connection says a robot's name: one effect says so, its mission fails, the next goes to the new one."""
    server = Driver()
    server.add("r")
    server.add("r")
    server.connect(1, "r")
    server.effects.clear()
    server.connect(2)
    assert server.hear(2, says_name("r")) == [1]
    taken, failed, *_ = server.effects
    assert taken == RobotTakenOver("r", 1, 2)
    assert failed == StatusChanged(uuid(0), Status.STARTED, Status.FAILED_DISCONNECTED)
    server.effects.clear()
    server.drop(1)
    assert server.effects == []
    told = Narrator(["r", "r"], {1: "10.0.0.1:5", 2: "[fe80::2]:6"}.__getitem__).tell(taken)
    assert (told.level, told.text) == (
        Level.WARNING,
        "robot r: taken over by [fe80::2]:6, which says the same name as 10.0.0.1:5",
    )


def test_isaac_server_nothing_is_sent_to_a_robot_that_leaves() -> None:
    """What it reported at the end counts; the next mission waits for it to come back."""
    server = Driver()
    server.add("r")
    server.add("r")
    server.connect(1, "r")
    server.report(1, 0, RUNNING)
    server.core.leaving(1)
    assert server.report(1, 0, SUCCESS) == []
    assert server.drop(1) == []
    assert server.statuses() == ["SUCCESS", "QUEUED"]
    assert server.connect(2, "r") == [1]


def test_isaac_tcp_a_robot_that_reports_and_hangs_up_gets_no_mission_into_the_dying_socket() -> None:
    """Its last words and the end of the connection come together: the mission succeeds, the next one is kept."""

    async def scenario() -> None:
        async with asyncio.timeout(20):
            server = TcpMissionServer(Settings(port=0))
            await server.start()
            missions = [fresh_uuid() for _ in range(2)]
            for mission in missions:
                assert server.create(MissionRequest("r"), mission) is None
                assert server.submit(mission) is None
            reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
            writer.write(encode(says_name("r")))
            await reader.readline()
            status = Message(Header("mission_status"), MissionStatusProto(missions[0], SUCCESS))
            writer.write(encode(status))
            writer.close()
            status_of = server.core.status
            while status_of(missions[0]) is not Status.SUCCESS or server.core.robots()[0].connection:  # noqa: ASYNC110
                await asyncio.sleep(0.005)
            assert server.core.status(missions[1]) is Status.QUEUED
            await server.close()

    asyncio.run(scenario())


@pytest.mark.skipif(not socket.has_dualstack_ipv6(), reason="there is no IPv6 here")
def test_isaac_tcp_a_server_on_any_address_takes_both_families() -> None:
    """`::` is IPv4 as well, on one port; addresses are written as people write them."""

    async def scenario() -> None:
        server = TcpMissionServer(Settings(host="::", port=0))
        await server.start()
        assert server.addresses == (f"[::]:{server.port}",)
        for host in ("127.0.0.1", "::1"):
            _, writer = await asyncio.open_connection(host, server.port)
            writer.write(encode(says_name(host)))
            while len(server.core.robots()) != 1:  # noqa: ASYNC110 - what is waited for tells nobody
                await asyncio.sleep(0.005)
            (robot,) = server.core.robots()
            assert robot.connection is not None
            own = address(writer.get_extra_info("sockname"))
            assert (
                server.peer(robot.connection) == own == f"{'[::1]' if host == '::1' else host}:{own.rpartition(':')[2]}"
            )
            writer.close()
            while server.core.robots():  # noqa: ASYNC110 - as above
                await asyncio.sleep(0.005)
        await server.close()

    asyncio.run(scenario())


def test_isaac_tcp_addresses_print_right() -> None:
    """IPv6 in brackets, IPv4 that came over IPv6 as IPv4."""
    assert [address(name) for name in (("10.0.0.1", 5), ("::ffff:10.0.0.1", 5, 0, 0), ("fe80::1%eth0", 5, 0, 2))] == [
        "10.0.0.1:5",
        "10.0.0.1:5",
        "[fe80::1%eth0]:5",
    ]


def test_lines_are_written_in_order_and_saying_one_never_waits() -> None:
    """Nobody reads a full pipe: saying goes on, what finds no room is counted in its place, and the end is told."""
    reading, writing = os.pipe()
    begun = threading.Event()

    def write(data: bytes) -> None:
        begun.set()
        os.write(writing, data)

    lines = BackgroundLines(write, kept=3)
    lines.say("x" * 100_000)  # more than a pipe holds
    assert begun.wait(10)
    for number in range(5):
        lines.say(str(number))
    assert os.read(reading, 1)
    assert lines.close(patience=0.05) == 1 + 3 + 2
    left = bytearray()
    while not left.endswith(b"\n"):
        left += os.read(reading, 1 << 16)
    os.close(writing)
    os.close(reading)


def test_lines_that_were_lost_leave_a_line_in_their_place() -> None:
    """A reader that was away for a while sees how many lines are missing, and what follows."""
    out: list[bytes] = []
    gate = threading.Semaphore(0)

    def write(data: bytes) -> None:
        gate.acquire()
        out.append(data)

    lines = BackgroundLines(write, kept=2)
    lines.say("first")
    deadline = time.monotonic() + 10
    while lines._waiting and time.monotonic() < deadline:
        time.sleep(0.001)
    for word in ("second", "third", "lost", "lost too"):
        lines.say(word)
    gate.release(100)
    while lines._waiting and time.monotonic() < deadline:
        time.sleep(0.001)
    lines.say("last")
    assert lines.close() == 0
    assert b"".join(out).decode().splitlines() == [
        "first", "second", "third", "2 lines are missing here: nobody read them in time", "last",
    ]  # fmt: skip
