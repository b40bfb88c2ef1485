"""The system ``isaac.robot``: its specification, its JSON, and what is worth trying on it."""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.isaac.robot.codec import CODEC
from missionfsm.isaac.robot.mutations import BENDS, TWISTS
from missionfsm.isaac.robot.pictures import SKETCHES
from missionfsm.isaac.robot.spec import SPEC
from missionfsm.isaac.shared.line import new_uuid
from missionfsm.isaac.shared.naming import NAMING
from missionfsm.isaac.wire.messages import TYPE_IDS, MissionProto, MissionStatusProto, TextProto, signed
from missionfsm.kernel.alphabet import Alphabet, Bounds, as_text, new, pick
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System

_CONFIGS = ('{"goals.path":{"FollowPath":{"tolerance":0.25}}}', "{}", '{"a":{"b":{"c":[1,2.5,null,"é"]}}}')
_UNUSABLE = ("no json", "[1,2]", "{", "17")
_HEADER_UUID = {"lower": "12297829382473034411", "upper": "6148914691236517206"}


def _mission(config: JSON, uuid: JSON, channel: str = "mission", **header: JSON) -> JSON:
    return {
        "event": "line",
        "line": as_text(
            {
                "header": {
                    "channel": channel,
                    "pubtime": "1700000000000000000",
                    "acqtime": "1700000000000000000",
                    "proto": str(signed(TYPE_IDS[MissionProto])),
                    "uuid": _HEADER_UUID,
                    **header,
                },
                "payload": {"uuid": uuid, "config": config},
            }
        ),
    }


def _drives() -> Iterator[JSON]:
    for config in _CONFIGS:
        yield from (_mission({"serialized": config}, new("uuid")) for _ in range(3))
    yield _mission({"serialized": "{}"}, pick("uuid"))
    yield from (_mission({"serialized": config}, new("uuid")) for config in _UNUSABLE)
    yield _mission({"serialized": "null"}, new("uuid"))
    yield _mission({"serialized": "{}"}, new("uuid"), channel="mission_status")
    yield _mission({"serialized": "{}"}, new("uuid"), channel="elsewhere")
    yield _mission({"serialized": "{}"}, {"lower": 77, "upper": 99})
    yield from ({"event": "line", "line": line} for line in ("", "no json", "{}", "[]", '{"header":{}}'))
    for kind, payload in ((TextProto, {"text": "robot"}), (MissionStatusProto, {"missionStatus": "success"})):
        header = {"channel": "mission", "proto": str(signed(TYPE_IDS[kind]))}
        yield {"event": "line", "line": as_text({"header": header, "payload": payload})}
    yield from _EVENTS


_EVENTS: tuple[JSON, ...] = (
    {"event": "behaviorSucceeded"},
    {"event": "behaviorFailed"},
    {"event": "advance", "seconds": 0.05},
    {"event": "advance", "seconds": 1},
    {"event": "advance", "seconds": 5},
    {"event": "advance", "seconds": 10},
)


def alphabet(_: JSON, __: Bounds) -> Alphabet:
    """What is worth trying on a robot."""
    return Alphabet(
        prompts=(),
        plain=(),
        drives=tuple(_drives()),
        plain_drives=(
            {"event": "line", "line": CODEC.write_drive(CODEC.drive(_PLAIN)[0], (new_uuid(1),))["line"]},
            *_EVENTS[:2],
            _EVENTS[4],
        ),
        worlds=({},),
    )


_PLAIN: JSON = {
    "event": "line",
    "line": (
        '{"header":{"channel":"mission"},"payload":{"uuid":{"lower":"1","upper":"1"},"config":{"serialized":"{}"}}}'
    ),
}
SYSTEM = System(SPEC.system, SPEC, CODEC, alphabet, NAMING, bends=BENDS, twists=TWISTS, sketches=SKETCHES)
