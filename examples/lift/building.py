"""A lift in memory behind the adapter protocol, right or with a bug.

missionfsm conform lift -- python3 examples/lift/building.py [--bug NAME]
"""

import argparse
import json
import sys
from itertools import count
from types import SimpleNamespace

CODES = {"INVALID_ARGUMENT": 3, "NOT_FOUND": 5, "RESOURCE_EXHAUSTED": 8, "FAILED_PRECONDITION": 9}
BUGS = {
    "fifth-floor": "a floor that the building does not have is called",
    "one-more": "four rides may wait",
    "stays": "the lift departs only when something else happens",
    "name-again": "the name of a ride that has ended is given again",
    "newest-first": "the ride that was called last is carried out first",
    "cancels-the-first": "Cancel takes off the ride that waits longest, whatever it is asked for",
    "quiet": "that a ride was cancelled is not shown",
    "now-so-now-so": "a second call to a floor makes a ride, or answers with the one that waits, by turns",
    "forgets": "a ride that is cancelled under way is gone, and the lift stays where it is",
}
parser = argparse.ArgumentParser()
parser.add_argument("--bug", choices=BUGS, help="; ".join(f"{name}: {says}" for name, says in BUGS.items()))
bug = parser.parse_args().bug
rides, streams = [], {}  # the rides in the order of their calls; what each stream was shown last
lift = SimpleNamespace(moving=None, stuck=False)  # the ride that is under way
names, numbers, turns = count(1), count(1), count(0)


class RefusedError(Exception):
    """A call is refused with a status."""


def call(floor):
    if type(floor) is not int or floor not in range(5 if bug == "fifth-floor" else 4):
        raise RefusedError("INVALID_ARGUMENT")
    waiting = [ride for ride in rides if ride is not lift.moving]
    if len(waiting) >= (4 if bug == "one-more" else 3):
        raise RefusedError("RESOURCE_EXHAUSTED")
    there = next((ride for ride in waiting if ride["floor"] == floor), None)
    if bug == "now-so-now-so" and there and next(turns) % 2:
        return {"ride": there["ride"]}
    name = len(rides) + 1 if bug == "name-again" else next(names)
    rides.append({"ride": f"ride-{name}", "floor": floor})
    return {"ride": rides[-1]["ride"]}


def cancel(name):
    ride = next((ride for ride in rides if ride["ride"] == name), None)
    if ride is None:
        raise RefusedError("NOT_FOUND")
    if ride is lift.moving:
        if bug != "forgets":
            raise RefusedError("FAILED_PRECONDITION")
        lift.moving, lift.stuck = None, True
    elif bug == "cancels-the-first":
        ride = next(one for one in rides if one is not lift.moving)
    rides.remove(ride)
    if bug == "quiet":
        for stream in streams:
            streams[stream] = state()
    return {}


def arrive():
    happened = lift.moving is not None
    if happened:
        rides.remove(lift.moving)
        lift.moving = None
    return {"happened": happened}


def reset():
    lift.moving, lift.stuck = None, False
    rides.clear()
    streams.clear()
    return {}


def answer(method, params):
    match method:
        case "initialize":
            return {"implementation": {"name": "building", "version": "1"}, "drives": ["arrive"]}
        case "reset":
            return reset()
        case "Call":
            lift.stuck = False
            return call(params.get("floor"))
        case "Cancel":
            return cancel(params.get("ride"))
        case "Watch":
            streams[number := next(numbers)] = None
            return {"stream": number}
        case "drive":
            return arrive()
        case "cancel":
            streams.pop(params["stream"], None)
            return {}
        case _:  # settle: what was caused has happened
            return {}


def state():
    return json.dumps({"rides": rides, "moving": lift.moving is not None})


def show():
    """What changed is shown to all who watch."""
    for stream in [number for number, last in streams.items() if last != state()]:
        streams[stream] = state()
        write({"method": "message", "params": {"stream": stream, "message": json.loads(state())}})


def write(line):
    print(json.dumps({"jsonrpc": "2.0", **line}), flush=True)


for line in sys.stdin:
    asked = json.loads(line)
    try:
        write({"id": asked["id"], "result": answer(asked["method"], asked["params"])})
    except RefusedError as refused:
        status = str(refused)
        error = {"code": CODES[status], "message": status, "data": {"status": status}}
        write({"id": asked["id"], "error": error})
    show()
    if (
        rides
        and lift.moving is None
        and not lift.stuck
        and (bug != "stays" or asked["method"] not in ("Call", "settle"))
    ):
        lift.moving = rides[-1 if bug == "newest-first" else 0]
        if bug == "newest-first":
            rides.remove(lift.moving)
            rides.insert(0, lift.moving)
        show()
