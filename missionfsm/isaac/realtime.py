"""What is worth trying where time is real: the alphabets of both systems without their long waits.

Times are never known exactly then. The server's world says by how much they may be off (`tolerance`); the robot is owed
nothing that a little less time would not have brought.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable

from attrs import evolve

from missionfsm.isaac.runtime.missionfile import MissionEntry, MissionFile
from missionfsm.isaac.server.samples import header, introduction, robot_line
from missionfsm.isaac.wire.messages import MissionStatusProto
from missionfsm.kernel.alphabet import Alphabet, Bounds, pick
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System

MAX_WAIT_SECONDS = 6.0
"""Seconds that are waited at most at a time: a little more than start_timeout. Silences add up."""

_STATUSES = ("running", "success", "failure")


def in_real_time(system: System, tolerance: float = 0.0, scripts: int = 0, world: JSON = None) -> System:
    """A system to be tried in real time.

    Args:
        tolerance: seconds by which times may be off, where the system's world says so.
        scripts: how many of the written conversations to have.
        world: what else the world says.
    """
    here = {**(world or {}), **({"tolerance": tolerance} if tolerance else {})}

    def alphabet(given: JSON, bounds: Bounds) -> Alphabet:
        whole = system.alphabet(given, bounds)
        return evolve(
            whole,
            drives=tuple(one for one in whole.drives if one.get("seconds", 0) <= MAX_WAIT_SECONDS),
            worlds=(here,),
            scripts=whole.scripts[:scripts],
        )

    return evolve(system, alphabet=alphabet, matrix=None)  # in which situation it is, is not sure for long


def with_file(system: System, file: MissionFile, name_channel: str, tolerance: float) -> System:
    """The mission server where all that is submitted is a mission file: what its robots can do."""

    def alphabet(_: JSON, __: Bounds) -> Alphabet:
        drives: list[JSON] = [{"event": "connect"}, {"event": "disconnect", "connection": pick("connection", 0)}]
        drives += _waits(file)
        for _ in range(3):
            drives += _lines(file, name_channel)
        return Alphabet(
            inputs=(),
            core_inputs=(),
            drives=tuple(drives),
            core_drives=(),
            worlds=({"nameChannel": name_channel, "tolerance": tolerance},),
        )

    return evolve(system, alphabet=alphabet, matrix=None)  # in which situation it is, is not sure for long


def _waits(file: MissionFile) -> list[JSON]:
    """Some short times, and for every timeout that is not too long a little more than that."""
    timeouts = {time + 0.5 for one in file.missions for time in (one.start_timeout, one.timeout)}
    times = sorted({0.5, 1.5, *(time for time in timeouts if time <= MAX_WAIT_SECONDS)})
    return [{"event": "advance", "seconds": time} for time in times]


def _lines(file: MissionFile, name_channel: str) -> Iterable[JSON]:
    robots = dict.fromkeys(one.robot for one in file.missions if one.robot is not None)
    for robot in robots:
        yield introduction(robot, name_channel)
    channels = dict.fromkeys(
        name
        for one in file.missions
        for name in ((one.status_channel,) if one.status_channel else ("mission_status", f"{one.channel}_status"))
    )
    for channel in channels:
        for status in _STATUSES:
            uuid = pick("uuid", 1)
            head = header(MissionStatusProto, channel, uuid=uuid)
            yield robot_line(head, {"uuid": uuid, "missionStatus": status})


def submissions(file: MissionFile) -> tuple[JSON, ...]:
    """The lines of a history that submit the missions of a file; the handle of each is its place there, from 1.

    Raises:
        ValueError: a mission names a later one as upstream, so that nobody knows in which order they are submitted.
    """
    lines: list[JSON] = []
    for index, mission in enumerate(file.missions):
        later = next((one for one in mission.upstream if one >= index), None)
        if later is not None:
            raise ValueError(
                f"missions[{index}].upstream: mission {later} is not before it, so that the order of submission, which "
                "decides what is sent first, is the server's affair; put upstreams first"
            )
        number = -1 - index
        lines.append({"call": number, "method": "submit", "params": {"mission": _submitted(mission)}})
        lines.append({"return": number, "result": {"mission": index + 1}})
    return tuple(lines)


def _submitted(mission: MissionEntry) -> JSON:
    params: dict[str, JSON] = {
        "robot": mission.robot,
        "channel": mission.channel,
        "config": json.loads(mission.config),
        "start_timeout": mission.start_timeout,
        "upstream": [one + 1 for one in mission.upstream],
    }
    if mission.status_channel is not None:
        params["status_channel"] = mission.status_channel
    if mission.timeout < math.inf:
        params["timeout"] = mission.timeout
    return params
