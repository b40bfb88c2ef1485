"""Recordings in which calls are lost, time out or overlap, as people have them: good ones, bad ones, and cut off."""

from __future__ import annotations

from typing import Any

Line = dict[str, Any]
HEAD: Line = {
    "missionfsm": 1,
    "system": "bear.mission",
    "world": {"family": "servi"},
    "drives": ["goalReached", "missionSucceeded", "missionFailed"],
}
TABLES = ("table-1", "table-2", "table-3")


def navigate(table: str) -> Line:
    """A mission to one table."""
    return {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": table}}}}}


def listed(mission_id: str, table: str, state: str = "STATE_DEFAULT") -> Line:
    """Such a mission as a status message lists it."""
    return {
        "missionId": mission_id,
        "state": state,
        "missionType": {"baseType": "BASE_TYPE_NAVIGATE"},
        "goals": [{"destinationId": table}],
        "currentGoalIndex": 0,
        "owner": "api",
    }


class Recording:
    """The lines of a recording, as they come."""

    def __init__(self) -> None:
        self.lines: list[Line] = [HEAD]
        self._calls = 0
        self._shown = 0

    def call(self, method: str, params: Line | None = None) -> int:
        """A call is sent."""
        self._calls += 1
        self.lines.append({"call": self._calls, "method": method, "params": params or {}})
        return self._calls

    def ok(self, call: int, **result: object) -> None:
        """It succeeds."""
        self.lines.append({"return": call, "result": result})

    def fails(self, call: int, status: str) -> None:
        """It fails."""
        self.lines.append({"return": call, "error": {"status": status, "message": ""}})

    def shows(self, *missions: Line, active: int = 0) -> None:
        """The stream shows missions."""
        self._shown += 1
        metadata = {"timestamp": f"2025-04-01T17:05:00.{self._shown:03}Z", "sequenceNumber": self._shown}
        states = {"missions": list(missions), "currentMissionIndex": active}
        self.lines.append({"stream": 1, "message": {"metadata": metadata, "missionStates": states}})

    def settled(self) -> list[Line]:
        """Everything has settled: the whole recording."""
        self.lines.append({"settled": True})
        return self.lines


def _running() -> Recording:
    """A subscriber is there, and mission A runs."""
    made = Recording()
    made.ok(made.call("SubscribeMissionStatus"), stream=1)
    made.shows(active=-1)
    made.ok(made.call("CreateMission", navigate("table-1")), missionId="A")
    made.shows(listed("A", "table-1", "STATE_RUNNING"))
    return made


def lost_appends(count: int, taken: int, *, bad: bool = False) -> list[Line]:
    """So many appends are never answered; so many of them took effect before another one, which is answered.

    Args:
        bad: the snapshot shows a mission that nobody asked for.
    """
    made = _running()
    for _ in range(count):
        made.call("AppendMission", navigate("table-2"))
    made.ok(made.call("AppendMission", navigate("table-3")), missionId="Z")
    others = [listed(f"L{number}", "table-2") for number in range(taken)]
    if bad:
        others[taken // 2] = listed("X", "table-1")
    made.shows(listed("A", "table-1", "STATE_RUNNING"), *others, listed("Z", "table-3"))
    return made.settled()


def late_appends(count: int, taken: int, *, bad: bool = False) -> list[Line]:
    """So many appends with different goals time out, and every so-manieth took effect; see `lost_appends`."""
    made = _running()
    tables = [TABLES[number % 3] for number in range(count)]
    for table in tables:
        made.fails(made.call("AppendMission", navigate(table)), "DEADLINE_EXCEEDED")
    made.ok(made.call("AppendMission", navigate("table-3")), missionId="Z")
    kept = tables[:: count // taken][:taken] if taken else []
    others = [listed(f"L{number}", table) for number, table in enumerate(kept)]
    if bad:
        others.append({**listed("X", "table-3"), "goals": [{"destinationId": "table-3"}] * 2})
    made.shows(listed("A", "table-1", "STATE_RUNNING"), *others, listed("Z", "table-3"))
    return made.settled()


def overlapping_appends(count: int, *, bad: bool = False) -> list[Line]:
    """So many appends are in flight at once, are answered in one order and took effect in another.

    Args:
        bad: the snapshot lists the goals of two of them the wrong way round.
    """
    made = _running()
    tables = [TABLES[number % 3] for number in range(count)]
    calls = [made.call("AppendMission", navigate(table)) for table in tables]
    for number in (number * 3 % count for number in range(count)):
        made.ok(calls[number], missionId=f"M{number}")
    order = [number * 7 % count for number in range(count)]
    shown = [listed(f"M{number}", tables[number]) for number in order]
    if bad:
        shown[1], shown[2] = ({**shown[1], "missionId": f"M{order[2]}"}, {**shown[2], "missionId": f"M{order[1]}"})
    made.shows(listed("A", "table-1", "STATE_RUNNING"), *shown)
    return made.settled()


def lost_mixture(rounds: int) -> list[Line]:
    """So many rounds of five calls of different kinds are never answered; nothing tells which took effect."""
    made = _running()
    commands = ("PAUSE", "RESUME", "CANCEL", "FINISH")
    for number in range(rounds):
        command = f"COMMAND_{commands[number % 4]}"
        made.call("UpdateMission", {"missionCommand": {"missionId": "A", "command": command}})
        made.call("SkipGoal")
        made.call("CreateMission", navigate("table-2"))
        made.call("AppendMission", navigate("table-3"))
        made.call("ClearMissionStatus")
    made.ok(made.call("AppendMission", navigate("table-3")), missionId="Z")
    made.shows(listed("A", "table-1", "STATE_RUNNING"), listed("Z", "table-3"))
    return made.settled()
