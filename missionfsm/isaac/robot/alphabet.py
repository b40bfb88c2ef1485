"""What is worth trying on a robot: lines that arrive, a behavior tree that stops, a connection that drops, time."""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.isaac.robot.codec import CODEC
from missionfsm.isaac.robot.inputs import USABLE, Arrives
from missionfsm.isaac.shared.line import new_uuid
from missionfsm.isaac.wire.messages import TYPE_IDS, MissionProto, MissionStatusProto, TextProto, signed
from missionfsm.kernel.alphabet import Alphabet, Bounds, ScriptStep, as_text, new, pick
from missionfsm.kernel.codec import JSON

_CONFIGS = ('{"goals.path":{"FollowPath":{"tolerance":0.25}}}', "{}", '{"a":{"b":{"c":[1,2.5,null,"é"]}}}')
_UNUSABLE = ("no json", "[1,2]", "{", "17", '{"a":1}')
_HEADER_UUID = {"lower": "12297829382473034411", "upper": "6148914691236517206"}
_WORLDS: tuple[JSON, ...] = (
    {"name": "carter-01"},
    {"name": "fork 2", "channel": "lift", "statusChannel": "lift-status", "nameChannel": "names"},
)


def _mission(config: JSON, uuid: JSON, channel: str, **payload: JSON) -> JSON:
    header = {
        "channel": channel,
        "pubtime": "1700000000000000000",
        "acqtime": "1700000000000000000",
        "proto": str(signed(TYPE_IDS[MissionProto])),
        "uuid": _HEADER_UUID,
    }
    line = {"header": header, "payload": {"uuid": uuid, "config": config, **payload}}
    return {"event": "line", "line": as_text(line)}


def _drives(channel: str, status_channel: str) -> Iterator[JSON]:
    for config in _CONFIGS:
        yield from (_mission({"serialized": config}, new("uuid"), channel) for _ in range(3))
    yield _mission({"serialized": "{}"}, pick("uuid"), channel)
    yield from (_mission({"serialized": config}, new("uuid"), channel) for config in _UNUSABLE)
    yield _mission({"serialized": "null"}, new("uuid"), channel)
    for other in dict.fromkeys((status_channel, "elsewhere", "mission")):
        if other != channel:
            yield _mission({"serialized": "{}"}, new("uuid"), other)
    yield _mission({"serialized": "{}"}, {"lower": 77, "upper": 99}, channel)
    yield from ({"event": "line", "line": line} for line in ("", "no json", "{}", "[]", '{"header":{}}'))
    for kind, payload in ((TextProto, {"text": "robot"}), (MissionStatusProto, {"missionStatus": "success"})):
        header = {"channel": channel, "proto": str(signed(TYPE_IDS[kind]))}
        yield {"event": "line", "line": as_text({"header": header, "payload": payload})}
    yield from _EVENTS


_EVENTS: tuple[JSON, ...] = (
    {"event": "behaviorSucceeded"},
    {"event": "behaviorFailed"},
    {"event": "advance", "seconds": 0.05},
    {"event": "advance", "seconds": 1},
    {"event": "advance", "seconds": 5},
    {"event": "advance", "seconds": 20},
    {"event": "disconnect"},
    {"event": "connect"},
)


def alphabet(world: JSON, _: Bounds) -> Alphabet:
    """What is worth trying on a robot in a world."""
    here = CODEC.world(world)
    plain = {
        "event": "line",
        "line": CODEC.write_drive(Arrives(USABLE, named=True, channel=here.channel), (new_uuid(1),))["line"],
    }
    return Alphabet(
        inputs=(),
        core_inputs=(),
        drives=tuple(_drives(here.channel, here.status_channel)),
        core_drives=(plain, *_EVENTS[:2], _EVENTS[5], *_EVENTS[6:]),
        worlds=_WORLDS,
        scripts=_scripts(),
    )


_SCRIPTS = (
    # The mission that runs arrives again; it ends, and arrives once more.
    "mission 1s settle again settle 1s settle succeeds 1s settle again 1s settle fails 1s settle",
    # Missions that cannot be used, with and without one that runs, and what runs then ends.
    "unusable settle 1s settle mission 1s settle unusable settle 1s settle succeeds settle 1s settle",
    # Missions preempt one another faster than a tick.
    "mission tick mission mission settle 1s settle fails mission settle 1s settle",
    # A connection drops while nothing runs, while a mission runs, and while it ends.
    "20s settle drops settle connects settle 20s settle mission 1s settle drops settle 1s settle connects settle 20s "
    "settle drops succeeds settle connects settle 20s settle mission settle 20s settle fails settle 20s settle",
)


def _scripts() -> tuple[tuple[ScriptStep, ...], ...]:
    """Conversations that go where chance seldom does, in the usual world."""
    words = ("succeeds", "fails", "tick", "1s", "5s", "20s", "drops", "connects")
    known = {word: ScriptStep("drive", event) for word, event in zip(words, _EVENTS, strict=True)}
    known["settle"] = ScriptStep("settle")
    known["mission"] = ScriptStep("drive", _mission({"serialized": "{}"}, new("uuid"), "mission"))
    known["again"] = ScriptStep("drive", _mission({"serialized": "{}"}, pick("uuid"), "mission"), ((0, 0),))
    known["unusable"] = ScriptStep("drive", _mission({"serialized": "no json"}, new("uuid"), "mission"))
    return tuple(tuple(known[word] for word in script.split()) for script in _SCRIPTS)
