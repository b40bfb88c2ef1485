"""Lines between a mission server and a robot, as text. MissionSubmission › JsonTcpClient Codelet.

One JSON object a line, with "header" and "payload"; all 64-bit integers are strings. Field names and type ids are those
of the published message schemas.
"""

from __future__ import annotations

import json
from typing import Any, NamedTuple

from missionfsm.isaac.wire.framing import WireError, decode_line, encode
from missionfsm.isaac.wire.messages import Message, Payload, Uuid, stamp

PROTOS = {
    "mission": "-9035847460398774087",
    "status": "-8059665372481944188",
    "text": "-7485136457943612313",
}
"""The signed type ids of MissionProto, MissionStatusProto and TextProto."""

NO_MESSAGES = (
    "",
    "rubbish",
    "[]",
    '{"header": {}}',
    '{"header": {"channel": "mission"}, "payload": 7}',
    '{"payload": {"text": "carter"}}',
)
"""Lines that are no message."""


class Sent(NamedTuple):
    """A message that was sent, as its receiver reads it: its channel, its kind, the mission it names, what it says."""

    channel: str
    kind: str
    mission: int | None
    says: str


class Post:
    """Stamps messages, and reads them as their receiver would."""

    def __init__(self) -> None:
        self._made = 0

    def read(self, channel: str, payload: Payload) -> Sent:
        """What goes out: one line, each message under a UUID of its own."""
        self._made += 1
        line = encode(stamp(payload, channel, pubtime=self._made, uuid=Uuid(self._made, 1 << 63)))
        assert line.endswith(b"\n")
        assert line.count(b"\n") == 1
        message = json.loads(line)
        assert message.keys() == {"header", "payload"}
        header, body = message["header"], message["payload"]
        assert header["channel"] == channel
        assert header["uuid"] == {"lower": str(self._made), "upper": str(1 << 63)}
        assert (header["pubtime"], header["acqtime"]) == (str(self._made),) * 2
        kind = next(name for name, proto in PROTOS.items() if proto == header["proto"])
        if kind == "text":
            return Sent(channel, kind, None, body["text"])
        says = body["config"]["serialized"] if kind == "mission" else body["missionStatus"]
        halves = body["uuid"]
        assert all(isinstance(half, str) for half in halves.values())
        return Sent(channel, kind, int(halves["upper"]) * (1 << 64) + int(halves["lower"]), says)


def text(line: str) -> list[Message | WireError]:
    """What comes in: any line."""
    return decode_line(line.encode())


def line(channel: str, kind: str, mission: int | None, says: str) -> str:
    """A line as a peer writes it."""
    body: dict[str, Any] = {}
    if mission is not None:
        upper, lower = divmod(mission, 1 << 64)
        body["uuid"] = {"lower": str(lower), "upper": str(upper)}
    match kind:
        case "text":
            body = {"text": says}
        case "mission":
            body["config"] = {"serialized": says}
        case _:
            body["missionStatus"] = says
    header = {
        "channel": channel,
        "proto": PROTOS[kind],
        "pubtime": "1",
        "acqtime": "1",
        "uuid": {"lower": "7", "upper": "7"},
    }
    return json.dumps({"header": header, "payload": body})
