"""Fakes for several threads and for tasks, by name, in JSON, with a clock of one's own."""

from __future__ import annotations

import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from missionfsm import Fleet, Robot, Shared, State, from_json, missions, to_json
from missionfsm.bear.status.messages import BatteryState
from missionfsm.bear.wire.messages import Mission


def test_four_threads_get_ids_of_their_own() -> None:
    """Behind the lock no id is given twice and no mission is lost."""
    shared = Shared(Robot())
    with shared as robot:
        ids = [robot.create_mission(missions.navigate("table-1"))]

    def append(_: int) -> list[str]:
        found = []
        for _ in range(25):
            with shared as robot:
                found.append(robot.append_mission(missions.navigate("table-1")))
        return found

    with ThreadPoolExecutor(4) as pool:
        ids += [one for some in pool.map(append, range(4)) for one in some]
    with shared as robot:
        listed = [one.mission_id for one in robot.status.missions]
    assert sorted(ids) == sorted(listed)
    assert len(set(ids)) == 101


def test_a_task_follows_what_another_thread_does() -> None:
    """An iteration in a loop shows every update that another thread causes, and ends with the subscription."""
    shared = Shared(Robot())
    seen: list[Any] = []
    opened: list[Any] = []

    def work() -> None:
        with shared as robot:
            robot.create_mission(missions.navigate("table-1"))
        with shared as robot:
            robot.goal_reached()
            opened[0].cancel()

    async def follow() -> None:
        def subscribe(robot: Robot) -> Any:
            opened.append(robot.updates())
            return opened[0]

        async for update in shared.follow(subscribe):
            seen.append([one.state for one in update.mission_states.missions])
            if len(seen) == 1:
                threading.Thread(target=work).start()

    asyncio.run(asyncio.wait_for(follow(), 10))
    assert seen == [[], [State.STATE_RUNNING], [State.STATE_SUCCEEDED]]


def test_a_fleet_is_followed_alike() -> None:
    """Updates of a fleet come to a task as well; leaving the iteration gives the subscription up."""

    async def first() -> BatteryState:
        shared = Shared(Fleet(["r1"]))
        with shared as fleet:
            fleet.drive("report", robotId="r1", part="battery", value={"chargePercent": 7})
        updates = shared.follow(lambda fleet: fleet.battery_status(["r1"]))
        found = await anext(updates)
        await updates.aclose()
        return found.value

    assert asyncio.run(asyncio.wait_for(first(), 10)).charge_percent == 7


def test_drives_go_by_name() -> None:
    """What the adapter protocol drives a fake is driven by; a wrong name is refused in words."""
    robot = Robot()
    assert robot.drive("goalReached") is False
    assert robot.drive("world", destinations=["bar"]) is True
    assert robot.create_mission(missions.navigate("bar"))
    with pytest.raises(ValueError, match="noSuchDrive"):
        robot.drive("noSuchDrive")
    with pytest.raises(ValueError, match="drive"):
        Fleet(["r1"]).drive("goalReached")


def test_messages_become_json_and_come_back() -> None:
    """A message is the JSON that a client sends, in either direction."""
    mission = missions.delivery("table-1", "table-2")
    assert from_json(Mission, to_json(mission)) == mission
    robot = Robot("servi")
    robot.create_mission(to_json(mission))
    states = robot.status
    assert from_json(type(states), to_json(states)) == states
    with pytest.raises(ValueError, match=r"baseMission: 1 is not an object"):
        from_json(Mission, {"baseMission": 1})


def test_a_clock_gives_the_timestamps() -> None:
    """Updates are stamped by the clock that is given, alike on every stream; without one by the event's number."""
    now = [1_750_000_000.0]
    robot = Robot(clock=lambda: now[0])
    first, second = robot.updates(), robot.updates()
    now[0] += 1.5
    robot.create_mission(missions.navigate("table-1"))
    stamps = [[one.metadata.timestamp for one in updates if one.metadata] for updates in (first, second)]
    assert stamps[0][-1] == stamps[1][-1] == "2025-06-15T15:06:41.500000Z"
    fleet = Fleet(["r1"], clock=lambda: now[0])
    fleet.report("r1", "battery", {"chargePercent": 7})
    assert [one.metadata.timestamp for one in fleet.battery_status(["r1"])] == ["2025-06-15T15:06:41.500000Z"]
