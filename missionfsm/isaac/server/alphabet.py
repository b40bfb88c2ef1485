"""What is worth trying on a mission server: submissions, lines of robots, time that passes."""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.isaac.server.samples import ROBOTS, STATUSES, header, introduction, robot_line
from missionfsm.isaac.server.scripts import SCRIPTS
from missionfsm.isaac.wire.messages import MissionProto, MissionStatusProto
from missionfsm.kernel.alphabet import Alphabet, Bounds, Input, as_text, new, pick, upcoming
from missionfsm.kernel.codec import JSON

_MISSION = pick("mission", 0)
_OTHER = pick("mission", 1)


def _submit(**mission: JSON) -> Input:
    return Input("submit", {"mission": mission})


def _good() -> Iterator[Input]:
    first, second = ROBOTS
    for robot in ROBOTS:
        yield _submit(robot=robot)
        yield _submit(robot=robot, upstream=[_MISSION])
        yield _submit(robot=robot, upstream=[_MISSION, _OTHER])
        yield _submit(robot=robot, config={"goals.path": {"FollowPath": {"tolerance": 0.25, "laps": 2}}}, timeout=4)
    yield _submit(robot=first, start_timeout=2)
    yield _submit(robot=first, start_timeout=2, timeout=3, upstream=[_MISSION])
    yield _submit(robot=first, timeout=8)
    yield _submit(robot=second, start_timeout=8)
    yield _submit(robot=first, channel="arm", status_channel="arm_news", config={"arm": {"Grip": {"force": 17}}})
    yield _submit(robot=second, channel="arm", config={"arm": {"Grip": {"on": True, "note": "ü"}}})
    yield _submit(robot=first, channel="mission", status_channel="mission_status", start_timeout=5.0)


def _odd() -> Iterator[Input]:
    robot = ROBOTS[0]
    yield _submit()
    yield _submit(robot=None)
    yield _submit(robot="")
    yield _submit(robot=7)
    yield _submit(robot=robot, upstream=[-1])
    yield _submit(robot=robot, upstream=[999])
    # Handles usually count on, so this is the mission's own.
    yield _submit(robot=robot, upstream=[upcoming("mission")])
    yield _submit(robot=robot, upstream=[_MISSION, upcoming("mission")])
    yield _submit(robot=robot, upstream=[0.5])
    yield _submit(robot=robot, upstream=[True])
    yield _submit(robot=robot, upstream="1")
    yield _submit(robot=robot, upstream=[_MISSION, -1])
    yield _submit(robot=robot, start_timeout=-1)
    yield _submit(robot=robot, timeout=-0.5)
    yield _submit(robot=robot, start_timeout="5")
    yield _submit(robot=robot, start_timeout=0)
    yield _submit(robot=robot, timeout=0)
    yield _submit(robot=robot, start_timeout=0.5)
    yield _submit(robot=robot, config=[1])
    yield _submit(robot=robot, config="text")
    yield _submit(robot=robot, config=None)
    yield _submit(robot=robot, channel=None)
    yield _submit(robot=robot, channel=3)
    yield _submit(robot=robot, channel="")
    yield _submit(robot=robot, priority=3)
    yield Input("submit", {"mission": "carter"})
    yield Input("submit", {})


def _reports(status: str, channel: str = "mission_status", **more: JSON) -> JSON:
    payload = {"uuid": pick("uuid", 1), "missionStatus": status}
    return robot_line(header(MissionStatusProto, channel, **more), payload)


def _lines(name_channel: str) -> Iterator[JSON]:
    for _ in range(3):
        yield from (introduction(robot, name_channel) for robot in ROBOTS)
        yield from (_reports(status, uuid=pick("uuid", 1)) for status in STATUSES)
    yield _reports("success", uuid=pick("uuid", 1))
    yield from (_reports(status) for status in STATUSES)
    yield from (_reports(status, "arm_news", uuid=pick("uuid", 1)) for status in STATUSES)
    yield _reports("running", "arm_status", uuid=pick("uuid", 1))
    yield _reports("success", "elsewhere", uuid=pick("uuid", 1))
    status_header = header(MissionStatusProto, "mission_status")
    yield from (robot_line(status_header, {"missionStatus": status}) for status in ("running", "success"))
    yield _reports("success", uuid={"lower": "3", "upper": "4"})
    yield introduction(ROBOTS[0].capitalize(), name_channel)
    yield introduction(f" {ROBOTS[1]} ", name_channel)
    yield introduction("", name_channel)
    yield introduction(ROBOTS[0], "elsewhere")
    yield robot_line(header(MissionProto, "mission"), {"uuid": new("uuid"), "config": {"serialized": "{}"}})
    bare = {"uuid": {"lower": 5, "upper": 6}, "missionStatus": "success"}
    yield robot_line(status_header, bare)
    for line in ("", "no json", '{"header":', "[]"):
        yield {"event": "line", "connection": pick("connection", 0), "line": line}
    tensor = as_text({"header": {"channel": "camera", "proto": "TensorProto"}, "payload": {}})
    yield {"event": "line", "connection": pick("connection", 0), "line": tensor}


_TIMES: tuple[JSON, ...] = tuple(
    {"event": "advance", "seconds": seconds} for seconds in (0.5, 1, 1.5, 2, 2.5, 3, 4, 6, 60)
)


_EVERY_CLOCK: JSON = {"event": "advance", "seconds": 11}
"""More time than any clock of a plain mission takes."""


def _drives(name_channel: str) -> Iterator[JSON]:
    yield {"event": "connect"}
    yield {"event": "disconnect", "connection": pick("connection", 0)}
    yield from _TIMES
    yield from _lines(name_channel)


def alphabet(world: JSON, _: Bounds) -> Alphabet:
    """What is worth trying on a server in a world."""
    channel = (world or {}).get("nameChannel", "name")
    good = tuple(_good())
    return Alphabet(
        inputs=(*good, *good, *good, *_odd(), Input("statuses", {})),
        core_inputs=(
            _submit(robot=ROBOTS[0]),
            _submit(robot=ROBOTS[0], upstream=[_MISSION]),
            Input("statuses", {}),
        ),
        drives=tuple(_drives(channel)),
        core_drives=(
            {"event": "connect"},
            {"event": "disconnect", "connection": pick("connection", 0)},
            introduction(ROBOTS[0], channel),
            *(_reports(status, uuid=pick("uuid", 1)) for status in STATUSES),
            _EVERY_CLOCK,
        ),
        worlds=({}, {"nameChannel": "who"}),
        look=Input("statuses", {}),
        scripts=SCRIPTS,
    )
