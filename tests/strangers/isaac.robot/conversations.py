"""The conversations of the smoke driver: a world and what happens in it, one after the other."""

from __future__ import annotations

import json
from typing import Any

Json = dict[str, Any]
Step = tuple[str, Json]

MISSION_PROTO = "-9035847460398774087"
BIG = 2**64 - 59
SETTLE: Step = ("settle", {})
NOTHING: Any = object()


def drive(event: str, **fields: Any) -> Step:
    """Something that happens."""
    return "drive", {"event": event, **fields}


def line(text: str) -> Step:
    """A line from the server."""
    return drive("line", line=text)


def mission(
    number: int,
    *,
    channel: str = "mission",
    config: Any = NOTHING,
    serialized: Any = '{"node": {"component": {"speed": 1}}}',
    proto: Any = MISSION_PROTO,
    uuid: Any = NOTHING,
) -> Step:
    """A MissionProto; a field that is None is left out."""
    header = {"channel": channel, "pubtime": "5", "acqtime": "5", "uuid": {"lower": "1", "upper": "2"}}
    if proto is not None:
        header["proto"] = proto
    payload: Json = {}
    own: Any = {"lower": str(BIG - number), "upper": str(2**60 + number)} if uuid is NOTHING else uuid
    if own is not None:
        payload["uuid"] = own
    whole: Any = {"serialized": serialized} if config is NOTHING else config
    if whole is not None:
        payload["config"] = whole
    return line(json.dumps({"header": header, "payload": payload}))


def after(seconds: float) -> Step:
    """That much time passes."""
    return drive("advance", seconds=seconds)


DONE = drive("behaviorSucceeded")
BROKEN = drive("behaviorFailed")

PLAIN: Json = {"name": "carter-01", "channel": "mission", "statusChannel": "mission_status", "nameChannel": "name"}
OTHER: Json = {"name": "Käfer", "channel": "orders", "statusChannel": "answers", "nameChannel": "who"}


def _configurations() -> list[Step]:
    texts = ["{", "", "null", "[1]", '"x"', "3", "{}", '{"node": 3}', '{"node": {}}']
    steps: list[Step] = []
    for number, text in enumerate(texts):
        steps += [mission(number, serialized=text), after(0.5), DONE, SETTLE]
    wholes: list[Any] = [None, {}, 7, {"serialized": 7}, {"serialized": None}]
    for number, whole in enumerate(wholes):
        steps += [mission(20 + number, config=whole), after(0.5), DONE, SETTLE]
    steps += [mission(30), after(1), mission(31, serialized="{"), after(2), mission(32), DONE, after(1)]
    return [*steps, SETTLE]


def _malformed() -> list[Step]:
    steps = [line(text) for text in ("", " ", "[]", "{}", '{"header": 3}', '{"header": {"channel": "mission"}}')]
    steps += [mission(1, proto=proto) for proto in (None, "5", "9410896613310777529", -9035847460398774087)]
    steps += [after(1), DONE]
    uuids: list[Any] = [None, 3, {}, {"lower": 5, "upper": 6}, {"lower": "x"}, {"lower": "-1"}, {"lower": str(2**64)}]
    for number, uuid in enumerate(uuids):
        steps += [mission(10 + number, uuid=uuid), after(1), DONE]
    steps += [line("rubbish"), mission(2), after(1), DONE, line("rubbish"), after(1)]
    return [*steps, SETTLE]


CONVERSATIONS: dict[str, tuple[Json, list[Step]]] = {
    "idle": (PLAIN, [after(0.3), after(0.9), after(3), DONE, BROKEN, after(25), SETTLE]),
    "defaults": ({}, [mission(1), after(2), DONE, after(2), SETTLE]),
    "success": (PLAIN, [after(0.4), mission(1), after(0.05), after(5.5), DONE, DONE, after(3), SETTLE]),
    "failure": (
        PLAIN,
        [mission(1), after(1.5), BROKEN, BROKEN, after(3), mission(2), after(2), DONE, after(2), SETTLE],
    ),
    "long": (PLAIN, [mission(1), after(40), DONE, after(2), SETTLE]),
    "in turn": (PLAIN, [mission(1), after(1), DONE, mission(2), after(1), BROKEN, mission(3), after(1), DONE, SETTLE]),
    "preemption": (PLAIN, [mission(1), after(1.5), mission(2), SETTLE, after(2.5), DONE, after(2), DONE, SETTLE]),
    "three at once": (PLAIN, [mission(1), mission(2), mission(3), after(2), BROKEN, after(2), DONE, SETTLE]),
    "the same twice": (PLAIN, [mission(1), after(1), mission(1), after(2), DONE, after(2), SETTLE]),
    "other names": (
        OTHER,
        [mission(1), after(1), mission(2, channel="orders"), after(2), DONE, after(1), SETTLE],
    ),
    "other channels": (
        PLAIN,
        [mission(1, channel="answers"), mission(2, channel="mission_status"), after(2), DONE, after(1), SETTLE],
    ),
    "drop in a mission": (
        PLAIN,
        [
            *[mission(1), after(1.5), drive("disconnect"), drive("disconnect"), mission(2), after(2.5)],
            *[drive("connect"), drive("connect"), after(2.5), DONE, after(1), mission(3), after(2), DONE, SETTLE],
        ],
    ),
    "end while away": (
        PLAIN,
        [mission(1), drive("disconnect"), after(2), DONE, after(2), drive("connect"), after(3), mission(2), SETTLE],
    ),
    "configurations": (PLAIN, _configurations()),
    "malformed": (PLAIN, _malformed()),
}
