"""Server and robot on loopback sockets, and what faults do to them. Durations are real and short."""

import asyncio
import contextlib
import socket
import struct
import time
from collections.abc import AsyncIterator, Callable, Coroutine
from typing import Any

import attrs
import pytest
from isaac_helpers import RUNNING, SUCCESS, says_name

from missionfsm.adapters.isaac.lines import LineConnection
from missionfsm.adapters.isaac.missionserver import AsyncMissionServer, Mission
from missionfsm.adapters.isaac.settings import Dialling, Settings
from missionfsm.adapters.isaac.tcp import TcpMissionServer, TcpRobot, fresh_uuid
from missionfsm.isaac.runtime.codelet import Codelet
from missionfsm.isaac.runtime.missions import MissionRequest
from missionfsm.isaac.runtime.profile import DOCUMENTED
from missionfsm.isaac.runtime.robot import Behavior, RobotCore
from missionfsm.isaac.wire.framing import Decoder, encode
from missionfsm.isaac.wire.messages import Header, Message, MissionProto, MissionStatusProto, Uuid, WireStatus

LIMIT = 20.0


def run(work: Coroutine[Any, Any, None]) -> None:
    """Run a scenario; a hang is a failure."""

    async def limited() -> None:
        async with asyncio.timeout(LIMIT):
            await work

    asyncio.run(limited())


@contextlib.asynccontextmanager
async def robots(port: int, *names: str, duration: float = 0.02, outcome: str = "succeed") -> AsyncIterator[None]:
    """Simulated robots that come back quickly."""
    tasks = [
        asyncio.create_task(
            TcpRobot(
                RobotCore(name, script=(Behavior(outcome, duration),), codelet=Codelet(period=0.02)),
                Dialling(port=port, first_delay=0.02, longest_delay=0.1),
            ).run()
        )
        for name in names
    ]
    try:
        yield
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


class Peer:
    """A hand-made client."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer
        self._decoder = Decoder()

    @classmethod
    async def to(cls, port: int) -> "Peer":
        return cls(*await asyncio.open_connection("127.0.0.1", port))

    def write(self, data: bytes | Message) -> None:
        self.writer.write(encode(data) if isinstance(data, Message) else data)

    async def mission(self) -> Uuid:
        """The next mission that arrives."""
        while True:
            for item in self._decoder.feed(await self.reader.readline()):
                assert isinstance(item, Message)
                assert isinstance(item.payload, MissionProto)
                assert item.payload.uuid is not None
                return item.payload.uuid

    def report(self, mission: Uuid, status: WireStatus) -> None:
        self.write(Message(Header("mission_status"), MissionStatusProto(mission, status)))

    async def dropped(self) -> bool:
        """Whether the server has closed the connection."""
        with contextlib.suppress(ConnectionError):
            return await self.reader.read(1) == b""
        return True

    async def close(self, *, reset: bool = False) -> None:
        if reset:
            sock: socket.socket = self.writer.get_extra_info("socket")
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.writer.close()
        with contextlib.suppress(ConnectionError):
            await self.writer.wait_closed()


@contextlib.asynccontextmanager
async def serving(**settings: Any) -> AsyncIterator[TcpMissionServer]:
    server = TcpMissionServer(Settings(host="127.0.0.1", port=0, **settings))
    await server.start()
    try:
        yield server
    finally:
        await server.close()


def add(server: TcpMissionServer, robot: str, **settings: Any) -> Uuid:
    made = fresh_uuid()
    assert server.create(MissionRequest(robot, **settings), made) is None
    assert server.submit(made) is None
    return made


async def until(condition: Callable[[], object]) -> None:
    while not condition():  # noqa: ASYNC110 - what is waited for tells nobody
        await asyncio.sleep(0.005)


def test_isaac_tcp_missions_run_on_real_robots() -> None:
    """Twenty missions in a chain across two robots succeed, one after the other."""

    async def scenario() -> None:
        async with AsyncMissionServer(0, host="127.0.0.1") as server, robots(server.port, "a", "b"):
            chain: list[Mission] = []
            for number in range(20):
                chain.append(Mission("ab"[number % 2], config={"n": {"c": {"p": number}}}, upstream=chain[-1:]))
                server.submit(chain[-1])
            assert await server.wait(timeout=LIMIT)
            assert [mission.status for mission in chain] == [Mission.Status.SUCCESS] * 20

    run(scenario())


def test_isaac_tcp_a_failing_robot_fails_its_mission_and_cancels_downstream() -> None:
    """FAILURE over the socket is FAILED in the server; downstream is never sent."""

    async def scenario() -> None:
        async with AsyncMissionServer(0, host="127.0.0.1") as server, robots(server.port, "a", outcome="fail"):
            first = Mission("a")
            second = Mission("a", upstream=[first])
            server.submit(first)
            server.submit(second)
            assert await server.wait(second, timeout=LIMIT)
            assert (first.status, second.status) == (Mission.Status.FAILED, Mission.Status.FAILED_UPSTREAM)

    run(scenario())


@pytest.mark.parametrize("reset", [False, True])
@pytest.mark.parametrize("point", ["connected", "half name", "named", "mission", "half status", "running", "done"])
def test_isaac_tcp_a_robot_that_dies_at_any_point_hurts_nobody_else(point: str, reset: bool) -> None:  # noqa: FBT001
    """What it was sent fails with it, what it was not goes to its successor, and the other robot never notices."""

    async def scenario() -> None:
        async with serving() as server, robots(server.port, "other"):
            others = [add(server, "other") for _ in range(5)]
            first, second = add(server, "dying"), add(server, "dying")
            peer = await Peer.to(server.port)
            name = encode(says_name("dying"))
            status = encode(Message(Header("mission_status"), MissionStatusProto(first, RUNNING)))
            steps: dict[str, bytes] = {
                "connected": b"",
                "half name": name[:30],
                "named": name[30:],
                "mission": b"",
                "half status": status[:70],
                "running": status[70:],
                "done": status.replace(b"running", b"success"),
            }
            for step, data in steps.items():
                peer.write(data)
                await peer.writer.drain()
                if step == "mission":
                    assert await peer.mission() == first
                if step == point:
                    break
            expected = {"running": "RUNNING", "done": "SUCCESS"}.get(point, "STARTED")
            if point in {"connected", "half name"}:
                expected = "QUEUED"
            await until(lambda: server.core.status(first).name == expected)  # type: ignore[union-attr]
            await peer.close(reset=reset)
            ended = {"QUEUED": "QUEUED", "SUCCESS": "SUCCESS"}.get(expected, "FAILED_DISCONNECTED")
            await until(lambda: server.core.status(first).name == ended)  # type: ignore[union-attr]
            async with robots(server.port, "dying"):
                await until(lambda: server.core.unfinished == 0)
            results = [server.core.status(one).name for one in (first, second, *others)]  # type: ignore[union-attr]
            following = "FAILED_DISCONNECTED" if point == "done" else "SUCCESS"  # it had been sent by then
            assert results == [ended.replace("QUEUED", "SUCCESS"), following, *["SUCCESS"] * 5]

    run(scenario())


def test_isaac_tcp_silent_connections_cost_nothing() -> None:
    """Two hundred peers that never say their name do not keep a robot from its missions."""

    async def scenario() -> None:
        async with serving() as server:
            peers = await asyncio.gather(*(Peer.to(server.port) for _ in range(200)))
            for peer in peers[::2]:
                peer.write(b'{"header": {"chan')
            async with robots(server.port, "r"):
                missions = [add(server, "r") for _ in range(10)]
                await until(lambda: server.core.unfinished == 0)
            assert [server.core.status(one).name for one in missions] == ["SUCCESS"] * 10  # type: ignore[union-attr]
            await asyncio.gather(*(peer.close() for peer in peers))

    run(scenario())


def test_isaac_tcp_a_line_of_ten_megabytes_is_skipped() -> None:
    """The peer may go on after it and is served; others are served meanwhile."""

    async def scenario() -> None:
        async with serving() as server, robots(server.port, "other"):
            peer = await Peer.to(server.port)
            peer.write(b'{"header": "' + b"x" * 10_000_000 + b'"}\n')
            others = [add(server, "other") for _ in range(5)]
            mine = add(server, "r")
            peer.write(says_name("r"))
            await peer.writer.drain()
            assert await peer.mission() == mine
            peer.report(mine, SUCCESS)
            await until(lambda: server.core.unfinished == 0)
            assert {server.core.status(one).name for one in (mine, *others)} == {"SUCCESS"}  # type: ignore[union-attr]
            await peer.close()

    run(scenario())


def test_isaac_tcp_rubbish_ends_its_own_connection_only() -> None:
    """Megabytes of rubbish lines drop the peer that sends them; a robot beside it works on."""

    async def scenario() -> None:
        async with serving() as server, robots(server.port, "r"):
            peer = await Peer.to(server.port)
            rubbish = bytes(range(256)) * 16384
            with contextlib.suppress(ConnectionError):
                peer.write(rubbish)
                await peer.writer.drain()
            missions = [add(server, "r") for _ in range(5)]
            assert await peer.dropped()
            await until(lambda: server.core.unfinished == 0)
            assert {server.core.status(one).name for one in missions} == {"SUCCESS"}  # type: ignore[union-attr]
            await peer.close()

    run(scenario())


def test_isaac_tcp_a_few_bad_lines_are_forgiven() -> None:
    """A robot whose lines are partly bad is still a robot."""

    async def scenario() -> None:
        async with serving() as server:
            peer = await Peer.to(server.port)
            mission = add(server, "r")
            for _ in range(300):
                peer.write(b"rubbish\r\n\r\n\xff\xfe\n")
                peer.write(says_name("r"))
            assert await peer.mission() == mission
            await peer.close()

    run(scenario())


def test_isaac_tcp_a_peer_that_does_not_read_is_dropped_and_holds_up_nobody() -> None:
    """A mission larger than every buffer waits for a peer that never reads, until the write timeout."""

    async def scenario() -> None:
        async with serving(write_timeout=0.3, line_limit=1 << 24) as server, robots(server.port, "other", duration=0.0):
            peer = await Peer.to(server.port)
            peer.writer.transport.pause_reading()  # type: ignore[attr-defined]
            stuck = add(server, "stuck", config='{"x":"' + "y" * 12_000_000 + '"}', start_timeout=60.0)
            peer.write(says_name("stuck"))
            others = [add(server, "other") for _ in range(5)]
            before = time.monotonic()
            await until(lambda: all(server.core.status(one).terminal for one in others))  # type: ignore[union-attr]
            assert time.monotonic() - before < 2.0
            await until(lambda: server.core.status(stuck).terminal)  # type: ignore[union-attr]
            assert server.core.status(stuck).name == "FAILED_DISCONNECTED"  # type: ignore[union-attr]
            await peer.close(reset=True)

    run(scenario())


def test_isaac_tcp_a_slow_reader_is_not_dropped() -> None:
    """A peer that keeps reading, however slowly, keeps its connection beyond the write timeout."""

    async def scenario() -> None:
        async with serving(write_timeout=0.2, line_limit=1 << 24) as server:
            peer = await Peer.to(server.port)
            mission = add(server, "slow", config='{"x":"' + "y" * 8_000_000 + '"}', start_timeout=60.0)
            peer.write(says_name("slow"))
            got = 0
            began = time.monotonic()
            while got < 8_000_000:
                got += len(await peer.reader.read(400_000))
                await asyncio.sleep(0.02)
            assert time.monotonic() - began > 0.3
            peer.report(mission, SUCCESS)
            await until(lambda: server.core.unfinished == 0)
            await peer.close()

    run(scenario())


def test_isaac_tcp_a_closed_connection_is_closed_for_the_peer_too() -> None:
    """Where a reading closes a connection, the peer sees the end of it."""

    async def scenario() -> None:
        profile = attrs.evolve(DOCUMENTED.choosing("AI-18", "d"), name_timeout=0.05)
        async with serving(profile=profile) as server:
            silent, named = await Peer.to(server.port), await Peer.to(server.port)
            named.write(says_name("r"))
            assert await silent.dropped()
            mission = add(server, "r")
            assert await named.mission() == mission
            await silent.close()
            await named.close()

    run(scenario())


def test_isaac_tcp_timeouts_come_by_themselves() -> None:
    """A robot that says nothing loses its mission after the start timeout, with no other event to help."""

    async def scenario() -> None:
        async with serving() as server:
            peer = await Peer.to(server.port)
            peer.write(says_name("r"))
            first, second = add(server, "r", start_timeout=0.1), add(server, "r", timeout=0.1)
            assert await peer.mission() == first
            assert await peer.mission() == second
            peer.report(second, RUNNING)
            await until(lambda: server.core.unfinished == 0)
            assert [status.name for _, status in server.core.statuses()] == ["FAILED_TIMEDOUT"] * 2
            await peer.close()

    run(scenario())


def test_isaac_tcp_robots_find_a_server_that_was_restarted() -> None:
    """A new server on the old port gets the same robots, though they were in the middle of missions."""

    async def scenario() -> None:
        async with AsyncMissionServer(0, host="127.0.0.1") as server:
            port = server.port
            async with contextlib.AsyncExitStack() as stack:
                await stack.enter_async_context(robots(port, "a", "b", duration=0.05))
                old = [Mission(robot) for robot in "ab"]
                for mission in old:
                    server.submit(mission)
                await until(lambda: all(mission.status is Mission.Status.RUNNING for mission in old))
                await server.close()
                assert [mission.status for mission in old] == [Mission.Status.RUNNING] * 2
                async with AsyncMissionServer(port, host="127.0.0.1") as again:
                    new = [Mission(robot) for robot in "abab"]
                    for mission in new:
                        again.submit(mission)
                    assert await again.wait(timeout=LIMIT)
                    assert [mission.status for mission in new] == [Mission.Status.SUCCESS] * 4

    run(scenario())


def test_isaac_tcp_a_robot_backs_off_within_bounds() -> None:
    """Attempts against a closed port grow apart, but never further than the bound."""

    async def scenario() -> None:
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            notes: list[float] = []
            robot = TcpRobot(
                RobotCore("r"),
                Dialling(port=taken.getsockname()[1], first_delay=0.01, longest_delay=0.04),
                notes=lambda _: notes.append(time.monotonic()),
            )
            task = asyncio.create_task(robot.run())
            await asyncio.sleep(0.4)
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            assert 8 <= len(notes) <= 30

    run(scenario())


def test_isaac_tcp_an_address_in_use_is_an_oserror() -> None:
    """A second server on the same port cannot start, and leaves the first alone."""

    async def scenario() -> None:
        async with serving() as server:
            second = TcpMissionServer(Settings(host="127.0.0.1", port=server.port))
            with pytest.raises(OSError, match="Address already in use"):
                await second.start()
            await second.close()
            await (await Peer.to(server.port)).close()

    run(scenario())


def test_isaac_tcp_a_backlog_for_a_peer_that_does_not_read_is_bounded() -> None:
    """Where more waits for a peer than may, it is dropped without waiting for the timeout."""

    class Transport(asyncio.Transport):
        def __init__(self) -> None:
            super().__init__()
            self.size, self.aborted = 0, False

        def write(self, data: bytes | bytearray | memoryview) -> None:
            self.size += len(data)

        def get_write_buffer_size(self) -> int:
            return self.size

        def is_closing(self) -> bool:
            return self.aborted

        def abort(self) -> None:
            self.aborted = True

    async def scenario() -> None:
        transport = Transport()
        nothing: Any = lambda *_: None  # noqa: E731
        connection = LineConnection(Decoder(), opened=nothing, arrived=nothing, closed=nothing)
        connection.connection_made(transport)
        for _ in range(20):
            connection.send(b"x" * (1 << 20))
        assert (transport.aborted, transport.size) == (True, 17 << 20)

    run(scenario())
