"""The robots that inputs, scripts and pictures are about, and lines as such robots send them."""

from __future__ import annotations

from missionfsm.isaac.shared.naming import MESSAGE
from missionfsm.isaac.wire.messages import TYPE_IDS, MissionProto, MissionStatusProto, TextProto, signed
from missionfsm.kernel.alphabet import as_text, new, pick
from missionfsm.kernel.codec import JSON

ROBOTS = ("carter-01", "carter-02")
STATUSES = ("running", "success", "failure")


def header(kind: type[TextProto | MissionStatusProto | MissionProto], channel: str, **more: JSON) -> JSON:
    """A header as robots send it, with more members, or with other values of these."""
    times = {"pubtime": "1700000000000000000", "acqtime": "1700000000000000000"}
    return {"channel": channel, **times, "proto": str(signed(TYPE_IDS[kind])), **more}


def robot_line(head: JSON, payload: JSON, link: int = 0) -> JSON:
    """The drive that a robot sends a line on the connection in a slot of the params."""
    text = as_text({"header": head, "payload": payload})
    return {"event": "line", "connection": pick("connection", link), "line": text}


def introduction(robot: str, channel: str, link: int = 0, **more: JSON) -> JSON:
    """The drive that a robot says its name on the connection in a slot of the params, with a whole header."""
    return robot_line(header(TextProto, channel, **{"uuid": new(MESSAGE), **more}), {"text": robot}, link)
