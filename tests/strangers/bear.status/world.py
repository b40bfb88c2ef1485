"""The fleet: robots, locations, and what the robots have reported, each event with its number and time."""

from __future__ import annotations

import copy
import time
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from typing import Any

from schema import PARTS, Json, canonical
from variants import Options

WIFI = "wifi"
STATE = "state"
TOPICS: tuple[str, ...] = ("battery", "errorCodes", "navigationState", WIFI, "connection", STATE)

_START = datetime(2025, 4, 1, 16, 0, 0, tzinfo=UTC)


@dataclass(frozen=True)
class Metadata:
    """When an event was recorded, and the number that the robot gave it."""

    number: int
    timestamp: str

    def as_json(self) -> Json:
        """The EventMetadata message."""
        return {"timestamp": self.timestamp, "sequenceNumber": str(self.number)}


@dataclass
class Robot:
    """One robot of the world with its latest reports."""

    robot_id: str
    location_id: str
    owned: bool
    index: int
    state: Json
    wifi: Json | None
    first_state: Json
    previous_wifi: Json | None = None
    counters: dict[str, int] = field(default_factory=dict)
    events: dict[str, Metadata] = field(default_factory=dict)
    restarted: bool = False
    was_offline: bool = False

    def part(self, name: str) -> Any:
        """The latest value of a part, None where it is not set."""
        return self.wifi if name == WIFI else self.state.get(name)

    def online(self) -> bool:
        """Whether the robot's latest connection state is not the disconnected one."""
        connection = self.state.get("connection") or {}
        return bool(connection.get("state") != "STATE_DISCONNECTED")


class Clock:
    """The robots' clocks: one tick of a second for every reading, or the time of day."""

    def __init__(self, options: Options) -> None:
        self._options = options
        self._ticks = 0

    def read(self, robot_index: int) -> str:
        """The time by the clock of the robot with that index, as RFC 3339 text."""
        self._ticks += 1
        moment = _START + timedelta(seconds=self._ticks)
        if self._options.on("wall-clock"):
            moment = datetime.fromtimestamp(time.time(), UTC)
            return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")
        if self._options.on("coarse-clock"):
            moment = moment.replace(second=0)
        if self._options.on("clocks-differ"):
            moment -= timedelta(days=365 * robot_index)
        return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


class World:
    """All robots and locations, and the events that change them."""

    def __init__(self, options: Options, description: Json) -> None:
        self._options = options
        self.clock = Clock(options)
        self.locations: dict[str, bool] = {
            entry["locationId"]: bool(entry.get("owned", False)) for entry in description.get("locations") or []
        }
        self.robots: dict[str, Robot] = {}
        for index, entry in enumerate(description.get("robots") or []):
            self._add(index, entry)
        self.first_locations = {robot.robot_id: robot.location_id for robot in self.robots.values()}

    def _add(self, index: int, entry: Json) -> None:
        state = {name: value for name, value in (entry.get("state") or {}).items() if value is not None}
        robot = Robot(
            robot_id=entry["robotId"],
            location_id=entry.get("locationId") or "",
            owned=bool(entry.get("owned", False)),
            index=index,
            state=copy.deepcopy(state),
            wifi=copy.deepcopy(entry.get("wifi")),
            first_state=copy.deepcopy(state),
        )
        robot.previous_wifi = robot.wifi
        first = 1
        if self._options.on("counter-from-zero"):
            first = 0
        elif self._options.on("counter-high"):
            first = 2**53 + 11
        started = Metadata(first, self.clock.read(index))
        for topic in TOPICS:
            robot.counters[topic] = first
            robot.events[topic] = started
        self.robots[robot.robot_id] = robot

    def at(self, location_id: str) -> list[Robot]:
        """The robots that are at a location, in the order of the world."""
        if self._options.on("location-index-stale"):
            return [robot for robot in self.robots.values() if self.first_locations[robot.robot_id] == location_id]
        return [robot for robot in self.robots.values() if robot.location_id == location_id]

    def record(self, robot: Robot, topics: tuple[str, ...]) -> None:
        """Number an event of the robot that concerns these topics, and note its time."""
        timestamp = self.clock.read(robot.index)
        if self._options.on("counter-per-topic"):
            for topic in topics:
                robot.counters[topic] += 1
                robot.events[topic] = Metadata(robot.counters[topic], timestamp)
            return
        number = self._next_number(robot)
        for topic in topics:
            robot.events[topic] = Metadata(number, timestamp)

    def _next_number(self, robot: Robot) -> int:
        step = 10 if self._options.on("counter-gaps") else 1
        if self._options.on("second-robot-numbers-fall") and robot.index == 1:
            step = -1 if robot.counters[STATE] > 0 else 9
        if self._options.on("number-repeats") and robot.counters[STATE] % 3 == 2:
            robot.counters[STATE] += step
            return robot.counters[STATE] - step
        if self._options.on("restart-counter-stuck") and robot.restarted:
            step = 0 if robot.counters[STATE] > 0 else 1
        robot.counters[STATE] += step
        return robot.counters[STATE]

    def report(self, robot: Robot, part: str, value: Any) -> bool:
        """Put a new value of a part in the place of the old one; tells whether that changed anything."""
        old = robot.part(part)
        new = copy.deepcopy(value)
        changed = bool(canonical(old) != canonical(new))
        if part == WIFI:
            robot.previous_wifi = robot.wifi
            robot.wifi = new
        elif new is None:
            robot.state.pop(part, None)
        else:
            for other in ("serviState", "cartiState"):
                if part in ("serviState", "cartiState") and other != part:
                    robot.state.pop(other, None)
            if part == "errorCodes" and self._options.on("codes-accumulate"):
                new = _joined(old, new)
            robot.state[part] = new
        topics = topics_of(part)
        if changed or self._options.on("equal-report-renews"):
            self.record(robot, topics)
        if part == "connection" and not robot.online():
            robot.was_offline = True
        return changed

    def restart(self, robot: Robot) -> None:
        """The robot starts anew: its numbers begin again at 0, its reports stay what they were."""
        robot.restarted = True
        timestamp = self.clock.read(robot.index)
        first = -3 if self._options.on("number-negative-after-restart") else 0
        for topic in TOPICS:
            robot.counters[topic] = first
            robot.events[topic] = Metadata(first, timestamp)
        if self._options.on("restart-forgets-state"):
            robot.state = {name: robot.state[name] for name in ("connection",) if name in robot.state}


def topics_of(part: str) -> tuple[str, ...]:
    """The topics that show a part."""
    if part == WIFI:
        return (WIFI,)
    return (part, STATE) if part in TOPICS else (STATE,)


def known_part(part: Any) -> bool:
    """Whether a robot has a part of that name."""
    return part == WIFI or part in PARTS


def _joined(old: Any, new: Any) -> Any:
    codes = list((old or {}).get("codes") or [])
    codes += [code for code in new.get("codes") or [] if code not in codes]
    return {"codes": codes}
