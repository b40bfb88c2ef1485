"""What is worth trying on a robot: lines that arrive, a behavior tree that stops, a connection that drops, time."""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.isaac.robot.codec import CODEC
from missionfsm.isaac.robot.inputs import USABLE, Arrives
from missionfsm.isaac.robot.scripts import EVENTS, SCRIPTS, mission
from missionfsm.isaac.shared.line import new_uuid
from missionfsm.isaac.wire.messages import TYPE_IDS, MissionStatusProto, TextProto, signed
from missionfsm.kernel.language import JSON, Alphabet, Bounds, as_text, new, pick

_CONFIGS = ('{"goals.path":{"FollowPath":{"tolerance":0.25}}}', "{}", '{"a":{"b":{"c":[1,2.5,null,"é"]}}}')
_UNUSABLE = ("no json", "[1,2]", "{", "17", '{"a":1}', "")
_WORLDS: tuple[JSON, ...] = (
    {"name": "carter-01"},
    {"name": "Fork 2", "channel": "lift", "statusChannel": "lift-status", "nameChannel": "names"},
)


def _drives(channel: str, status_channel: str) -> Iterator[JSON]:
    for config in _CONFIGS:
        yield from (mission(config, new("uuid"), channel) for _ in range(3))
    yield mission("{}", pick("uuid"), channel)
    yield from (mission(config, new("uuid"), channel) for config in _UNUSABLE)
    yield mission("null", new("uuid"), channel)
    for other in dict.fromkeys((status_channel, "elsewhere", "mission", channel.upper())):
        if other != channel:
            yield mission("{}", new("uuid"), other)
    yield mission("{}", {"lower": 77, "upper": 99}, channel)
    yield from ({"event": "line", "line": line} for line in ("", "no json", "{}", "[]", '{"header":{}}'))
    for kind, payload in ((TextProto, {"text": "robot"}), (MissionStatusProto, {"missionStatus": "success"})):
        header = {"channel": channel, "proto": str(signed(TYPE_IDS[kind]))}
        yield {"event": "line", "line": as_text({"header": header, "payload": payload})}
    yield from EVENTS.values()


def alphabet(world: JSON, _: Bounds) -> Alphabet:
    """What is worth trying on a robot in a world."""
    here = CODEC.read_world(world)
    plain = CODEC.write_drive(Arrives(USABLE, named=True, channel=here.channel), (new_uuid(1),))
    return Alphabet(
        drives=tuple(_drives(here.channel, here.status_channel)),
        core_drives=(plain, *(EVENTS[word] for word in ("succeeds", "fails", "90s", "drops", "connects"))),
        worlds=_WORLDS,
        scripts=SCRIPTS,
    )
