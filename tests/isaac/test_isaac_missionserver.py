"""The mission server as the page's sample uses it: from threads, blocking."""

import asyncio
import math
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from missionfsm.adapters.isaac.missionserver import AsyncMissionServer, Mission, MissionRefusedError, MissionServer
from missionfsm.adapters.isaac.settings import Dialling
from missionfsm.adapters.isaac.tcp import TcpRobot
from missionfsm.isaac.runtime.codelet import Codelet
from missionfsm.isaac.runtime.profile import AS_SHIPPED, DOCUMENTED
from missionfsm.isaac.runtime.robot import Behavior, RobotCore

INCOMPLETE = (Mission.Status.CREATED, Mission.Status.QUEUED, Mission.Status.STARTED, Mission.Status.RUNNING)


@pytest.fixture
def server() -> Iterator[MissionServer]:
    with MissionServer(port=0, name_channel="name", host="127.0.0.1") as made:
        yield made


@pytest.fixture
def fleet(server: MissionServer) -> Iterator[None]:
    """Two robots in a thread of their own."""
    loop = asyncio.new_event_loop()

    async def robots() -> None:
        cores = [
            RobotCore(name, script=(Behavior("succeed", 0.02),), codelet=Codelet(period=0.01))
            for name in ("carter-01", "carter-02")
        ]
        await asyncio.gather(*(TcpRobot(core, Dialling(port=server.port, first_delay=0.02)).run() for core in cores))

    task = loop.create_task(robots())
    thread = threading.Thread(target=lambda: loop.run_until_complete(asyncio.wait([task])))
    thread.start()
    yield
    loop.call_soon_threadsafe(task.cancel)
    thread.join()
    loop.close()


@pytest.mark.usefixtures("fleet")
def test_isaac_facade_the_sample_of_the_page(server: MissionServer) -> None:
    """Two missions, one upstream of the other, polled until the second is complete."""
    mission_1 = Mission(robot="carter-01", channel="mission", config={"a": {"b": {"c": 1}}})
    mission_2 = Mission(robot="carter-02", channel="mission", config={"a": {"b": {"c": 1}}}, upstream=[mission_1])
    assert (mission_1.status, mission_2.status) == (Mission.Status.CREATED, Mission.Status.CREATED)
    server.submit(mission_1)
    server.submit(mission_2)
    deadline = time.monotonic() + 10
    while mission_2.status in INCOMPLETE and time.monotonic() < deadline:
        time.sleep(0.005)
    assert (mission_1.status, mission_2.status) == (Mission.Status.SUCCESS, Mission.Status.SUCCESS)


@pytest.mark.usefixtures("fleet")
def test_isaac_facade_many_threads_may_submit_and_wait(server: MissionServer) -> None:
    """Eight threads with five missions each: all succeed, and every thread sees its own end."""
    results: list[bool] = []

    def work() -> None:
        mine = [Mission("carter-01" if number % 2 else "carter-02") for number in range(5)]
        for mission in mine:
            server.submit(mission)
        ended = server.wait(*mine, timeout=20)
        results.append(ended and all(mission.status is Mission.Status.SUCCESS for mission in mine))

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [True] * 8


def test_isaac_facade_waiting_ends_at_its_timeout_and_at_close(server: MissionServer) -> None:
    """A wait for what does not end is False after its timeout, and when the server is closed from another thread."""
    mission = Mission("nobody")
    server.submit(mission)
    assert server.wait(timeout=0.05) is False
    assert server.wait(mission, timeout=0.05) is False
    results: list[bool] = []
    waiting = threading.Thread(target=lambda: results.append(server.wait()))
    waiting.start()
    time.sleep(0.05)
    server.close()
    waiting.join(5)
    assert results == [False]
    assert mission.status is Mission.Status.QUEUED
    server.close()
    for call in (lambda: server.submit(Mission("r")), server.wait):
        with pytest.raises(RuntimeError, match="the server is closed"):
            call()


def test_isaac_facade_nothing_to_wait_for_is_no_wait(server: MissionServer) -> None:
    """Without missions there is nothing that has not ended."""
    assert server.wait() is True


def test_isaac_facade_what_is_refused_is_said(server: MissionServer) -> None:
    """A second submission, a mission of another server, a mission without a robot: refused with the reason."""
    mission = Mission("r")
    server.submit(mission)
    with pytest.raises(MissionRefusedError, match="was submitted before"):
        server.submit(mission)
    with pytest.raises(MissionRefusedError, match="the mission has no robot"):
        server.submit(Mission())
    with MissionServer(0, host="127.0.0.1") as other:
        with pytest.raises(MissionRefusedError, match="belongs to another server"):
            other.submit(mission)
        with pytest.raises(MissionRefusedError, match="there is no mission"):
            other.submit(Mission("r", upstream=[mission]))


def test_isaac_facade_unsubmitted_upstreams_by_reading() -> None:
    """As documented the mission waits; as shipped it is refused; by the third reading its upstreams are submitted."""
    for profile, upstream_status in ((DOCUMENTED, "CREATED"), (DOCUMENTED.choosing("AI-22", "c"), "QUEUED")):
        with MissionServer(0, host="127.0.0.1", profile=profile) as server:
            first = Mission("r")
            middle = Mission("r", upstream=[first])
            last = Mission("r", upstream=[middle, first])
            server.submit(last)
            assert [first.status.name, middle.status.name] == [upstream_status] * 2
            assert last.status.name == "QUEUED"
    with MissionServer(0, host="127.0.0.1", profile=AS_SHIPPED) as server:
        first = Mission("r")
        second = Mission("r", upstream=[first])
        with pytest.raises(MissionRefusedError, match="was not submitted"):
            server.submit(second)
        server.submit(first)
        server.submit(second)


@pytest.mark.parametrize("config", [{"a": math.nan}, {"a": {1, 2}}, {"a": "\ud800"}, {"a": 1e400}])
def test_isaac_facade_a_config_that_is_no_json_is_refused_at_once(config: dict[str, object]) -> None:
    """What could not be sent cannot be made."""
    with pytest.raises(ValueError, match="config"):
        Mission("r", config=config)


def test_isaac_facade_a_port_in_use_is_an_oserror_and_leaves_nothing_behind() -> None:
    """The constructor says so, and its thread is gone."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        before = threading.active_count()
        with pytest.raises(OSError, match="Address already in use"):
            MissionServer(taken.getsockname()[1], host="127.0.0.1")
        assert threading.active_count() == before


def test_isaac_facade_an_async_server_has_to_be_started() -> None:
    """Before, submitting is an error that says what to do."""

    async def scenario() -> None:
        server = AsyncMissionServer(0)
        with pytest.raises(RuntimeError, match=r"await start\(\) first"):
            server.submit(Mission("r"))
        await server.close()

    asyncio.run(scenario())


def test_isaac_facade_a_mission_shows_itself() -> None:
    """Its repr names it, its robot and its status."""
    mission = Mission("r")
    assert repr(mission) == f"<Mission {mission.uuid} for 'r': CREATED>"
    assert mission.robot == "r"


@pytest.mark.usefixtures("fleet")
def test_isaac_facade_what_happens_is_told_and_can_be_undone(server: MissionServer) -> None:
    """Callbacks hear every status in order; a cancelled mission can be retried; what has ended is forgotten."""
    heard: list[tuple[Mission, Mission.Status]] = []
    told = threading.Event()

    def hear(mission: Mission, status: Mission.Status) -> None:
        heard.append((mission, status))
        if status is Mission.Status.SUCCESS:
            told.set()
        raise RuntimeError

    ends = server.on_status(hear)
    nobody = Mission("nobody")
    server.submit(nobody)
    server.cancel(nobody)
    assert nobody.status is Mission.Status.FAILED_CANCELLED
    with pytest.raises(MissionRefusedError, match="has ended: FAILED_CANCELLED"):
        server.cancel(nobody)
    server.retry(nobody)
    assert nobody.status is Mission.Status.QUEUED
    mission = Mission("carter-01", config={"a": {"b": {"c": 1}}})
    server.submit(mission)
    assert server.wait(mission, timeout=10)
    assert told.wait(10)
    names = [status.name for one, status in heard if one is mission]
    assert names == ["QUEUED", "STARTED", "RUNNING", "SUCCESS"]
    assert [status.name for one, status in heard if one is nobody] == ["QUEUED", "FAILED_CANCELLED", "QUEUED"]
    assert "carter-01" in server.get_robots()
    assert (mission.channel, mission.config) == ("mission", {"a": {"b": {"c": 1}}})
    ends()
    with pytest.raises(MissionRefusedError, match="has not ended: QUEUED"):
        server.forget(nobody)
    assert server.forget() == 1
    after = Mission("carter-01", upstream=[mission])
    assert after.outstanding_upstream == ()
    server.submit(after)
    assert server.wait(after, timeout=10)
    server.cancel(nobody)
    assert server.forget() == 2
    with pytest.raises(MissionRefusedError, match="is forgotten, and had not succeeded"):
        server.submit(Mission("r", upstream=[nobody]))


def test_isaac_facade_memory_is_bounded_by_what_is_unfinished() -> None:
    """Three hundred missions that end and are forgotten leave nothing behind, but for the one that waits."""

    async def scenario() -> None:
        async with AsyncMissionServer(0) as server:
            waiting = Mission("nobody")
            server.submit(waiting)
            for _ in range(300):
                mission = Mission("r")
                server.submit(mission)
                server.cancel(mission)
                server.forget(mission)
            assert server._tcp is not None
            scheduler = server._tcp.core._scheduler
            assert list(scheduler.missions) == [waiting.uuid]
            assert (len(scheduler.robots), len(server._missions), len(scheduler.deadlines)) == (1, 1, 0)

    asyncio.run(scenario())


def test_isaac_facade_statuses_can_be_iterated() -> None:
    """`async for` gives where a mission stands and all that follows, to any number of readers, until its end."""

    async def scenario() -> None:
        async with AsyncMissionServer(0) as server, asyncio.timeout(20):
            core = RobotCore("r", script=(Behavior("succeed", 0.01),), codelet=Codelet(period=0.01))
            mission, never = Mission("r"), Mission("nobody")
            server.submit(mission)
            server.submit(never)

            async def follow(one: Mission) -> list[str]:
                return [status.name async for status in server.statuses(one)]

            readers = [asyncio.create_task(follow(one)) for one in (mission, mission, never)]
            robot = asyncio.create_task(TcpRobot(core, Dialling(port=server.port)).run())
            expected = ["QUEUED", "STARTED", "RUNNING", "SUCCESS"]
            assert await asyncio.gather(*readers[:2]) == [expected, expected]
            robot.cancel()
            await asyncio.wait([robot])
            await server.close()
            assert await readers[2] == ["QUEUED"]

    asyncio.run(scenario())


def test_isaac_facade_a_journal_is_taken_up(tmp_path: Path) -> None:
    """A server on the journal of another has its missions, as objects, with their upstreams."""
    with MissionServer(0, journal=tmp_path / "journal") as first:
        one = Mission("r", config={"n": {"c": {"p": 1}}})
        two = Mission("s", upstream=[one], timeout=7)
        first.submit(two)
        first.submit(one)
        first.cancel(one)
        assert first.missions == ()
    with MissionServer(0, journal=tmp_path / "journal", resume="rerun") as second:
        assert [(mission.uuid, mission.status.name) for mission in second.missions] == [
            (one.uuid, "FAILED_CANCELLED"),
            (two.uuid, "FAILED_UPSTREAM"),
        ]
        again = second.missions[1]
        assert (again.request, again.upstream) == (two.request, second.missions[:1])
        second.retry(second.missions[0])
        assert [mission.status.name for mission in second.missions] == ["QUEUED", "QUEUED"]


@pytest.mark.parametrize(
    "wrong",
    [
        {"robot": 1},
        {"channel": 5},
        {"status_channel": b"x"},
        {"timeout": "7"},
        {"start_timeout": True},
        {"upstream": [1]},
    ],
    ids=lambda wrong: next(iter(wrong)),
)
def test_isaac_facade_what_is_of_another_kind_is_refused(wrong: dict[str, Any]) -> None:
    """A channel that is a number and the like say at once what is wrong."""
    with pytest.raises(TypeError, match=f"{next(iter(wrong))}: wanted .*, found "):
        Mission(**{"robot": "r", **wrong})
