"""The system ``isaac.server``: its specification, its JSON, and what is worth trying on it."""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.isaac.server.codec import CODEC
from missionfsm.isaac.server.matrix import MATRIX
from missionfsm.isaac.server.mutations import MESSAGE_MUTATIONS, STEP_MUTATIONS
from missionfsm.isaac.server.pictures import SKETCHES
from missionfsm.isaac.server.plans import PLANS
from missionfsm.isaac.server.scripts import SCRIPTS
from missionfsm.isaac.server.shapes import shapes
from missionfsm.isaac.server.spec import SPEC
from missionfsm.isaac.shared.naming import NAMING
from missionfsm.isaac.shared.profiles import AS_SHIPPED, DOCUMENTED, SHIPPED_SERVER
from missionfsm.isaac.wire.messages import TYPE_IDS, MissionProto, MissionStatusProto, TextProto, signed
from missionfsm.kernel.alphabet import Alphabet, Bounds, Input, as_text, new, pick, upcoming
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import to_the_letter
from missionfsm.kernel.system import System

ROBOTS = ("carter-01", "carter-02")
_MISSION = pick("mission", 0)
_OTHER = pick("mission", 1)
_STATUSES = ("running", "success", "failure")


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


def _line(
    kind: type[TextProto | MissionStatusProto | MissionProto], channel: str, payload: JSON, **header: JSON
) -> JSON:
    head = {
        "channel": channel,
        "pubtime": "1700000000000000000",
        "acqtime": "1700000000000000000",
        "proto": str(signed(TYPE_IDS[kind])),
        **header,
    }
    return {"event": "line", "connection": pick("connection", 0), "line": as_text({"header": head, "payload": payload})}


def _says(name: str, channel: str = "name") -> JSON:
    return _line(TextProto, channel, {"text": name})


def _reports(status: str, channel: str = "mission_status", **header: JSON) -> JSON:
    return _line(MissionStatusProto, channel, {"uuid": pick("uuid", 1), "missionStatus": status}, **header)


def _lines(name_channel: str) -> Iterator[JSON]:
    for _ in range(3):
        yield from (_says(robot, name_channel) for robot in ROBOTS)
        yield from (_reports(status, uuid=pick("uuid", 1)) for status in _STATUSES)
    yield _reports("success", uuid=pick("uuid", 1))
    yield from (_reports(status) for status in _STATUSES)
    yield from (_reports(status, "arm_news", uuid=pick("uuid", 1)) for status in _STATUSES)
    yield _reports("running", "arm_status", uuid=pick("uuid", 1))
    yield _reports("success", "elsewhere", uuid=pick("uuid", 1))
    yield from (
        _line(MissionStatusProto, "mission_status", {"missionStatus": status}) for status in ("running", "success")
    )
    yield _reports("success", uuid={"lower": "3", "upper": "4"})
    yield _says(ROBOTS[0].capitalize(), name_channel)
    yield _says(f" {ROBOTS[1]} ", name_channel)
    yield _says("", name_channel)
    yield _says(ROBOTS[0], "elsewhere")
    yield _line(MissionProto, "mission", {"uuid": new("uuid"), "config": {"serialized": "{}"}})
    bare = {"uuid": {"lower": 5, "upper": 6}, "missionStatus": "success"}
    yield _line(MissionStatusProto, "mission_status", bare)
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
            _says(ROBOTS[0], channel),
            *(_reports(status, uuid=pick("uuid", 1)) for status in _STATUSES),
            _EVERY_CLOCK,
        ),
        worlds=({}, {"nameChannel": "who"}),
        look=Input("statuses", {}),
        scripts=SCRIPTS,
    )


PROFILES = {DOCUMENTED: to_the_letter(SPEC.ambiguities), AS_SHIPPED: SHIPPED_SERVER}

SYSTEM = System(
    SPEC.system,
    SPEC,
    CODEC,
    alphabet,
    NAMING,
    message_mutations=MESSAGE_MUTATIONS,
    step_mutations=STEP_MUTATIONS,
    sketches=SKETCHES,
    plans=PLANS,
    shapes=shapes,
    profiles=PROFILES,
    matrix=MATRIX,
    minutes_at=2,
)
