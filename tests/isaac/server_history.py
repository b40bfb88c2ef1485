"""Histories of a mission server, written down step by step."""

from __future__ import annotations

from typing import Any

from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
)
from missionfsm.oracle.transcript import Head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.verdict import Verdict

SERVER = system("isaac.server")
SETTLED = {"settled": True}


class History:
    """Writes a history down: what is done, and what the server is seen to do."""

    def __init__(self, *drives: str) -> None:
        self.drives = drives or ("connect", "line", "disconnect", "advance")
        self.lines: list[Any] = []
        self.calls = 0

    def submit(self, handle: int, *, refused: bool = False, **mission: Any) -> History:
        self.calls += 1
        self.lines.append({"call": self.calls, "method": "submit", "params": {"mission": {"robot": "r", **mission}}})
        answer = {"error": {"status": "INVALID_ARGUMENT"}} if refused else {"result": {"mission": handle}}
        self.lines.append({"return": self.calls, **answer})
        return self

    def shows(self, *statuses: str) -> History:
        self.calls += 1
        missions = {str(handle): status for handle, status in enumerate(statuses, 1)}
        self.lines.append({"call": self.calls, "method": "statuses", "params": {}})
        self.lines.append({"return": self.calls, "result": {"missions": missions}})
        return self

    def drive(self, event: str, **fields: Any) -> History:
        self.lines.append({"drive": {"event": event, **fields}})
        return self

    def robot(self, connection: int, name: str = "r") -> History:
        return self.drive("connect", connection=connection).says(connection, name)

    def says(self, connection: int, name: str = "r") -> History:
        line = encode(Message(Header("name"), TextProto(name))).decode().strip()
        return self.drive("line", connection=connection, line=line)

    def sends(self, connection: int, mission: int, config: str = "{}", channel: str = "mission") -> History:
        message = Message(Header(channel, 1, 1, Uuid(9, 9 + len(self.lines))), MissionProto(_uuid(mission), config))
        self.lines.append({"connection": connection, "line": encode(message).decode().strip()})
        return self

    def reports(self, connection: int, mission: int, status: str) -> History:
        payload = MissionStatusProto(_uuid(mission), WireStatus(status))
        line = encode(Message(Header("mission_status"), payload)).decode().strip()
        return self.drive("line", connection=connection, line=line)

    def closes(self, connection: int) -> History:
        self.lines.append({"connection": connection, "closed": True})
        return self

    def waits(self, seconds: float) -> History:
        return self.drive("advance", seconds=seconds)

    def at(self, seconds: float) -> History:
        """What was written down last was seen then, with all that has no time before it."""
        for line in self.lines:
            line.setdefault("at", seconds)
        return self

    @property
    def settles(self) -> History:
        self.lines.append(dict(SETTLED))
        return self

    def judged(self, **options: Any) -> Verdict:
        return check(SERVER, Head("isaac.server", {}, self.drives), self.lines, **options)


def _uuid(mission: int) -> Uuid:
    return Uuid(mission, 1 << 61 | mission)
