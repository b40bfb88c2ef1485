"""How fast one stream of a large fleet is judged, and that memory does not grow with its messages.

    pytest tests/bench/test_bench_status.py -s

Making the lines is not part of what is measured; reading them is.
"""

from __future__ import annotations

import random
import time
import tracemalloc
from collections.abc import Iterator
from typing import Any

import orjson
import pytest

from missionfsm.bear.status.monitor import StreamMonitor

ROBOTS = 1_000
MESSAGES = 1_000_000
CHUNK = 50_000


def lines(endpoint: str, messages: int) -> Iterator[list[bytes]]:
    """So many lines about a thousand robots, in any order, in chunks."""
    chance = random.Random(11)
    numbers = [0] * ROBOTS
    for start in range(0, messages, CHUNK):
        chunk = []
        for _ in range(min(CHUNK, messages - start)):
            robot = chance.randrange(ROBOTS)
            numbers[robot] += 1
            metadata = {"timestamp": "2025-04-01T16:45:00Z", "sequenceNumber": numbers[robot]}
            chunk.append(orjson.dumps(message(endpoint, f"pennybot-{robot:04}", metadata, chance)))
        yield chunk


def message(endpoint: str, robot: str, metadata: Any, chance: random.Random) -> Any:
    if endpoint == "SubscribeBatteryStatus":
        battery = {
            "chargePercent": chance.randrange(101),
            "state": "STATE_CHARGING",
            "chargeMethod": "CHARGE_METHOD_CONTACT",
        }
        return {"metadata": metadata, "robotId": robot, "batteryState": battery}
    if endpoint == "SubscribeNavigationStatus":
        stuck = chance.choice((("STATE_STUCK", "REASON_PATH_BLOCKED"), ("STATE_NOT_STUCK", "REASON_UNKNOWN")))
        state = {"stuckState": dict(zip(("state", "reason"), stuck, strict=True))}
        return {"metadata": metadata, "robotId": robot, "navigationState": state}
    wifi = {"ssid": "office", "signalLevelDbm": -chance.randrange(30, 90), "linkQuality": chance.randrange(71)}
    return {"networkStates": {robot: {"metadata": metadata, "connectedWifi": {**wifi, "security": 2}}}}


def judged(endpoint: str, messages: int) -> tuple[float, int]:
    """Seconds that judging took, and how many problems there were."""
    monitor, spent, problems = StreamMonitor(endpoint), 0.0, 0
    feed, loads = monitor.feed, orjson.loads
    for chunk in lines(endpoint, messages):
        start = time.perf_counter()
        for line in chunk:
            problems += len(feed(loads(line)))
        spent += time.perf_counter() - start
    assert (monitor.messages, monitor.robots) == (messages, ROBOTS)
    return spent, problems


@pytest.mark.slow
def test_a_million_messages_are_judged_fast() -> None:
    """One stream, a thousand robots, a million messages from JSON lines."""
    seconds, problems = judged("SubscribeBatteryStatus", MESSAGES)
    print(f"\nSubscribeBatteryStatus: {MESSAGES / seconds:,.0f} messages a second")
    assert problems == 0


@pytest.mark.slow
@pytest.mark.parametrize("endpoint", ["SubscribeNavigationStatus", "SubscribeNetworkStatus"])
def test_other_streams_are_judged_fast(endpoint: str) -> None:
    """Nested messages and maps as well."""
    seconds, problems = judged(endpoint, MESSAGES // 4)
    print(f"\n{endpoint}: {MESSAGES // 4 / seconds:,.0f} messages a second")
    assert problems == 0


@pytest.mark.slow
def test_memory_does_not_grow_with_the_messages() -> None:
    """After the first tenth the monitor keeps no more than before: what it knows is bounded by robots and payloads."""
    monitor = StreamMonitor("SubscribeBatteryStatus")
    sizes = []
    tracemalloc.start()
    for chunk in lines("SubscribeBatteryStatus", 8 * CHUNK):
        for line in chunk:
            monitor.feed(orjson.loads(line))
        del chunk, line
        sizes.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    print(f"\nmemory after each {CHUNK:,} messages: {', '.join(f'{size / 1e6:.1f} MB' for size in sizes)}")
    assert max(sizes[1:]) < sizes[1] * 1.1 + 100_000
