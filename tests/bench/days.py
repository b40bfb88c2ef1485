"""Histories to measure with: the log of a robot that runs missions all day, and of one client that watches it."""

from __future__ import annotations

from collections.abc import Iterator

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Notification
from missionfsm.systems import system
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")
WORLD = {"family": "servi"}
HEAD = {"missionfsm": 1, "system": "bear.mission", "world": WORLD, "drives": list(MISSION.spec.drives)}


def _delivery(*tables: str) -> JSON:
    goals = [{"destinationId": table} for table in tables]
    return {"mission": {"serviMission": {"deliveryMission": {"goals": goals}}}}


def _command(mission: str, command: str) -> JSON:
    return {"missionCommand": {"missionId": mission, "command": command}}


class Log:
    """Talks to the reference and keeps the lines of the history."""

    def __init__(self) -> None:
        self.reference = ReferenceSubject(MISSION)
        self.reference.exchange("reset", {"world": WORLD})
        self.calls = 0
        self.lines: list[JSON] = []

    def call(self, method: str, params: JSON) -> JSON:
        self.calls += 1
        exchange = self.reference.exchange(method, params)
        self.lines.append({"call": self.calls, "method": method, "params": params})
        answer = {"error": exchange.error} if exchange.error else {"result": exchange.result}
        self.lines.append({"return": self.calls, **answer})
        self.lines += map(_shown, exchange.after)
        return exchange.result

    def drive(self, **event: JSON) -> None:
        exchange = self.reference.exchange("drive", event)
        self.lines.append({"drive": event})
        self.lines += map(_shown, exchange.after)

    def settle(self) -> None:
        self.lines.append({"settled": True})

    def flush(self) -> list[JSON]:
        lines, self.lines = self.lines, []
        return lines


def _shown(one: Notification) -> JSON:
    return {"stream": one.params["stream"], "message": one.params["message"]}


def day(lines: int) -> Iterator[JSON]:
    """So many lines after the first: missions are created, appended, paused, skipped, refused, ended and cleared."""
    log = Log()
    log.call("SubscribeMissionStatus", {})
    sent = 0
    while sent < lines:
        first = log.call("CreateMission", _delivery("table-1", "table-2"))["missionId"]
        second = log.call("AppendMission", _delivery("table-3"))["missionId"]
        log.call("ChargeRobot", {})
        log.settle()
        log.drive(event="goalReached")
        log.call("UpdateMission", _command(first, "COMMAND_PAUSE"))
        log.call("UpdateMission", _command(second, "COMMAND_CANCEL"))
        log.call("UpdateMission", _command(first, "COMMAND_RESUME"))
        log.call("SkipGoal", {})
        log.settle()
        log.call("ClearMissionStatus", {})
        log.drive(event="missionFailed")
        log.settle()
        log.call("ClearMissionStatus", {})
        for line in log.flush():
            if sent < lines:
                yield line
                sent += 1
