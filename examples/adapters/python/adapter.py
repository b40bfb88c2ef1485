"""A robot in memory behind missionfsm's adapter protocol: put your own in its place.

missionfsm conform bear.mission -- python3 examples/adapters/python/adapter.py
"""

import json
import math
import sys
from datetime import UTC, datetime
from itertools import count

DESTINATIONS = ["kitchen", "table-1", "table-2"]
DECLARED = {
    "implementation": {"name": "starter in Python", "version": "1"},
    "drives": ["goalReached", "missionFailed"],
    "methods": ["CreateMission", "AppendMission", "SubscribeMissionStatus"],
    "worlds": "fixed",
    "world": {"family": "base", "destinations": DESTINATIONS},
    "requests": "binary",  # nothing of a wrong type is sent: your gRPC library would not let it in either
}
CODES = {"INVALID_ARGUMENT": 3, "FAILED_PRECONDITION": 9, "METHOD_NOT_FOUND": -32601}
TYPES = {"navigateMission": "BASE_TYPE_NAVIGATE", "navigateAutoMission": "BASE_TYPE_NAVIGATE_AUTO"}
ENDS = {"goalReached": "STATE_SUCCEEDED", "missionFailed": "STATE_FAILED"}
missions, streams = [], {}  # the missions in their order; each stream, with what it was shown last
stream_numbers, sequence_numbers = count(1), count(1)  # none comes twice, not even after a reset


def current():
    """The mission that runs: the first that has not ended."""
    return next((one for one in missions if one["state"] not in ENDS.values()), None)


def is_goal(goal):
    if "pose" in goal:
        return all(math.isfinite(float(number)) for number in goal["pose"].values())
    return goal.get("destinationId") in DESTINATIONS


def assign(request, *, first):
    kind, wanted = next(iter(request.get("mission", {}).get("baseMission", {}).items()), ("", {}))
    goals = wanted.get("goals") or [wanted.get("goal", {})]
    if not all(map(is_goal, goals)):
        return refusal("INVALID_ARGUMENT", "what is needed is a base mission, with goals that are on the map")
    if first and current():
        return refusal("FAILED_PRECONDITION", "a mission is running or waiting")
    if not first and not missions:
        return refusal("FAILED_PRECONDITION", "there is no mission to append to")
    name = f"mission-{len(missions) + 1}"
    kept = {"missionId": name, "state": "STATE_DEFAULT", "goals": goals, "missionType": {"baseType": TYPES[kind]}}
    missions.append(kept)
    return {"result": {"missionId": name}}


def refusal(status, message):
    return {"error": {"code": CODES[status], "message": message, "data": {"status": status}}}


def answer(method, params):
    match method:
        case "initialize":
            return {"result": DECLARED}
        case "CreateMission" | "AppendMission":
            return assign(params, first=method == "CreateMission")
        case "SubscribeMissionStatus":
            streams[number := next(stream_numbers)] = None
            return {"result": {"stream": number}}
        case "drive":
            if (mission := current()) is not None:
                mission["state"] = ENDS[params["event"]]
            return {"result": {"happened": mission is not None}}
        case "reset":
            missions.clear()
            streams.clear()
        case "cancel":
            streams.pop(params["stream"], None)
        case "settle":
            pass  # nothing is under way: what was caused has been written
        case _:
            return refusal("METHOD_NOT_FOUND", f"there is no {method}")
    return {"result": {}}


def write(line):
    print(json.dumps({"jsonrpc": "2.0", **line}), flush=True)


for line in sys.stdin:
    asked = json.loads(line)
    write({"id": asked["id"], **answer(asked["method"], asked["params"])})
    if current():
        current()["state"] = "STATE_RUNNING"
    states = {"missions": missions, "currentMissionIndex": missions.index(current()) if current() else -1}
    for stream in [number for number, shown in streams.items() if shown != str(states)]:
        streams[stream] = str(states)
        metadata = {"timestamp": datetime.now(UTC).isoformat(), "sequenceNumber": next(sequence_numbers)}
        message = {"metadata": metadata, "missionStates": states}
        write({"method": "message", "params": {"stream": stream, "message": message}})
