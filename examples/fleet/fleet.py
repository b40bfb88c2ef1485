"""A fleet's logs with three faults in them: written by the reference, judged on one core, on two, on a cluster.

python examples/fleet/fleet.py --robots 1000 --lines 10000
"""

from __future__ import annotations

import argparse
import gzip
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from pyarrow import parquet

from missionfsm.systems import system
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")
WORLD = {"family": "servi"}
FIRST = {"missionfsm": 1, "system": "bear.mission", "world": WORLD, "drives": list(MISSION.spec.drives)}
TABLES = ("table-1", "table-2", "table-3")
WAYS = {
    "one core": ("--jobs", "1"),
    "two cores (--jobs 2)": ("--jobs", "2"),
    "two workers (--dask local)": ("--dask", "local", "--jobs", "2"),
}


def delivery(*tables):
    goals = [{"destinationId": table} for table in tables]
    return {"mission": {"serviMission": {"deliveryMission": {"goals": goals}}}}


class Robot:
    """A robot that is used all day, and the log of one client that watches it."""

    def __init__(self, seed):
        self.reference = ReferenceSubject(MISSION)
        self.reference.exchange("reset", {"world": WORLD})
        self.chance = random.Random(seed)  # noqa: S311 - the same log for the same seed
        self.log = [FIRST]
        self.calls = 0
        self.call("SubscribeMissionStatus", {})

    def shown(self, exchange):
        self.log += [{"stream": one.params["stream"], "message": one.params["message"]} for one in exchange.after]

    def call(self, method, params):
        self.calls += 1
        exchange = self.reference.exchange(method, params)
        answer = {"error": exchange.error} if exchange.error else {"result": exchange.result}
        self.log += [{"call": self.calls, "method": method, "params": params}, {"return": self.calls, **answer}]
        self.shown(exchange)
        return (exchange.result or {}).get("missionId")

    def drive(self, event):
        exchange = self.reference.exchange("drive", {"event": event})
        if exchange.result["happened"]:
            self.log.append({"drive": {"event": event}})
            self.shown(exchange)

    def command(self, mission, command):
        self.call("UpdateMission", {"missionCommand": {"missionId": mission, "command": command}})

    def round(self):
        """A table is served, and whatever else happens that day."""
        chance = self.chance
        mission = self.call("CreateMission", delivery(*chance.sample(TABLES, 2)))
        if chance.random() < 0.5:
            self.call("AppendMission", delivery(chance.choice(TABLES)))
        self.call("CreateMission", delivery("table-1"))  # refused: one is under way
        self.drive("goalReached")
        if chance.random() < 0.3:
            self.command(mission, "COMMAND_PAUSE")
            self.command(mission, "COMMAND_RESUME")
        if chance.random() < 0.3:
            self.command(mission, "COMMAND_CANCEL")
        for _ in range(4):
            self.drive("goalReached")
        self.log.append({"settled": True})
        self.call("ClearMissionStatus", {})


# The faults: a line of the log becomes what no robot may say.


def refused_and_done(line):
    """A mission is created although another one is under way."""
    if line.get("error", {}).get("status") == "FAILED_PRECONDITION":
        return {"return": line["return"], "result": {"missionId": "one-too-many"}}
    return None


def cancelled_and_succeeded(line):
    """A mission that was cancelled is shown as one that has succeeded."""
    text = json.dumps(line)
    return json.loads(text.replace("STATE_CANCELED", "STATE_SUCCEEDED")) if "STATE_CANCELED" in text else None


def numbered_again(line):
    """A message has a number that is smaller than those before it."""
    if line.get("message", {}).get("missionStates", {}).get("missions"):
        metadata = {**line["message"]["metadata"], "sequenceNumber": 3}
        return {**line, "message": {**line["message"], "metadata": metadata}}
    return None


SOON = 5
"""Within so many lines a fault is found: a robot that says of a call that it was done may have restarted just then."""
FAULTS = (refused_and_done, cancelled_and_succeeded, numbered_again)


def write(path, seed, lines, fault):
    """Write the log of one robot; returns how many lines it has and in which the fault is."""
    robot = Robot(seed)
    count = planted = 0
    with gzip.open(path, "wt", compresslevel=1) as file:
        while count < lines:
            robot.round()
            for line in robot.log:
                broken = fault(line) if fault and not planted and count >= lines // 2 else None
                count += 1
                planted = count if broken else planted
                file.write(json.dumps(broken or line, separators=(",", ":")) + "\n")
            robot.log.clear()
    return count, planted


def write_all(folder, robots, lines):
    """Write the logs of all robots; returns how many lines there are, and where the faults are."""
    chosen = {(2 * number + 1) * robots // 6: fault for number, fault in enumerate(FAULTS)}
    paths = [folder / f"robot-{number:04}.jsonl.gz" for number in range(robots)]
    with ProcessPoolExecutor() as pool:
        done = list(pool.map(write, paths, range(robots), [lines] * robots, map(chosen.get, range(robots))))
    planted = {str(path): line for path, (_, line) in zip(paths, done, strict=True) if line}
    return sum(count for count, _ in done), planted


def processor_seconds():
    """Of all processes that this one has started and that have ended, and of those that they have."""
    times = os.times()
    return times.children_user + times.children_system


def judged(folder, way, table):
    """The seconds that it takes to judge all, those of cores, and file and line of each violation that is found."""
    command = [sys.executable, "-m", "missionfsm", "check", str(folder), *way, "--parquet", str(table)]
    begun, used = time.perf_counter(), processor_seconds()
    ended = subprocess.run(command, check=False, capture_output=True, text=True)  # noqa: S603 - this package's command
    seconds, used = time.perf_counter() - begun, processor_seconds() - used
    if ended.returncode not in (0, 1):
        sys.exit(ended.stderr)
    found = parquet.read_table(table).to_pylist()
    return seconds, used, {one["file"]: one["line"] for one in found if one["verdict"] == "violates"}, ended.stdout


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=12, help="at least 3")
    parser.add_argument("--lines", type=int, default=200, help="of each robot, or a few more")
    parser.add_argument("--ways", type=int, default=len(WAYS), help="how many ways to judge, in this order")
    asked = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place, "logs")
        folder.mkdir()
        begun = time.perf_counter()
        count, planted = write_all(folder, asked.robots, asked.lines)
        print(f"{count:,} lines of {asked.robots:,} robots written in {time.perf_counter() - begun:.0f} s")
        print(f"\n{'':28}{'seconds':>10}{'of cores':>10}{'lines/s':>12}{'ratio':>8}   faults found")
        first = said = None
        for name, way in list(WAYS.items())[: asked.ways]:
            seconds, used, found, said = judged(folder, way, Path(place, "table.parquet"))
            first = first or seconds
            right = sum(0 <= line - planted.get(file, line + 1) <= SOON for file, line in found.items())
            wrong = f", and {len(found) - right} that are none" if len(found) > right else ""
            rate, ratio = count / seconds, first / seconds
            print(f"{name:28}{seconds:10.1f}{used:10.1f}{rate:12,.0f}{ratio:8.2f}   {right} of {len(FAULTS)}{wrong}")
        print(f"\n{said}", end="")


if __name__ == "__main__":
    main()
