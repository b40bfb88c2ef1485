"""Busy clients behind a proxy: what they asked and saw, what the proxy recorded, and how it was judged."""

from __future__ import annotations

import contextlib
import json
import random
import re
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

import grpc
from attrs import define, field, frozen

from missionfsm.adapters.grpc.descriptors import decode, encode, methods, path
from missionfsm.app.serve import serve
from missionfsm.kernel.codec import JSON

METHODS = methods("bear.mission")
SUBSCRIBE = METHODS["SubscribeMissionStatus"]
NAVIGATE: JSON = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
COMMANDS = ("COMMAND_PAUSE", "COMMAND_RESUME", "COMMAND_CANCEL", "COMMAND_FINISH")


@define
class Client:
    """A client that calls and watches as fast as it can.

    Attributes:
        answers: the codes of its calls, and how often each came.
        numbers: the numbers of the events that its stream showed.
    """

    target: str
    draw: random.Random
    pause: float
    answers: Counter[tuple[str, str]] = field(factory=Counter)
    numbers: list[int] = field(factory=list)
    missions: list[str] = field(factory=list)
    stream: Any = None

    def watch(self, channel: grpc.Channel, began: threading.Event) -> None:
        """Read a subscription until it is cancelled."""
        self.stream = channel.unary_stream(path(SUBSCRIBE))(b"")
        with contextlib.suppress(grpc.RpcError):
            for data in self.stream:
                message = decode(SUBSCRIBE.response, data)
                self.numbers.append(int(message["metadata"]["sequenceNumber"]))
                self.missions = [one["missionId"] for one in message["missionStates"].get("missions", ())]
                began.set()

    def work(self, channel: grpc.Channel, over: threading.Event) -> None:
        """Call one thing after the other until told to stop."""
        while not over.wait(self.pause):
            name, params = self._next()
            ask = channel.unary_unary(path(METHODS[name]))
            code = "OK"
            try:
                ask(encode(METHODS[name].request, params), timeout=30)
            except grpc.RpcError as error:
                code = error.code().name
            self.answers[name, code] += 1

    def _next(self) -> tuple[str, JSON]:
        name = self.draw.choice(
            ("CreateMission", "AppendMission", "SkipGoal", "UpdateMission", "ClearMissionStatus", "UpdateMission")
        )
        if name == "UpdateMission":
            mission = self.draw.choice(self.missions[-3:] or ["nobody"])
            return name, {"missionCommand": {"missionId": mission, "command": self.draw.choice(COMMANDS)}}
        return name, NAVIGATE if name.endswith("eMission") or name == "AppendMission" else {}


@frozen
class Ran:
    """What became of a busy run.

    Attributes:
        clients: what each asked and saw.
        lines: what the proxy recorded.
        status: the proxy's exit status.
        verdict: the proxy's, as JSON.
        told: what the proxy printed.
    """

    clients: tuple[Client, ...]
    lines: tuple[JSON, ...]
    status: int
    verdict: JSON
    told: str

    @property
    def recorded(self) -> Counter[tuple[str, str]]:
        """The codes of the recorded calls with one answer, and how often each came."""
        asked = {line["call"]: line["method"] for line in self.lines if "call" in line}
        found: Counter[tuple[str, str]] = Counter()
        for line in self.lines:
            if "return" in line and not METHODS.get(asked[line["return"]], SUBSCRIBE).streams:
                found[asked[line["return"]], line["error"]["status"] if "error" in line else "OK"] += 1
        return found

    @property
    def streams(self) -> list[list[int]]:
        """The numbers of the events that each recorded stream showed, in the order of the streams."""
        found: dict[int, list[int]] = {}
        for line in self.lines:
            if "message" in line:
                found.setdefault(line["stream"], []).append(int(line["message"]["metadata"]["sequenceNumber"]))
        return list(found.values())


def run(
    folder: Path,
    seconds: float,
    *,
    clients: int = 10,
    pause: float = 0.02,
    broken: str = "",
    seed: int = 1,
    patience: float = 120,
) -> Ran:
    """Clients that are busy for some time, through a proxy in a process of its own, with a robot in this one.

    Args:
        clients: how many; each has a stream and a connection of its own.
        pause: seconds between a client's calls.
        patience: seconds that the proxy may take to judge what waits.
        broken: what the robot breaks, as `missionfsm.serve` takes it.
    """
    record, verdict = folder / "busy.jsonl", folder / "busy.json"
    with serve("bear.mission", auto=0.1, broken=broken) as robot:
        command = [sys.executable, "-m", "missionfsm", "proxy", "bear.mission", "--grpc", robot.target, "--listen", "0"]
        command += ["--record", str(record), "--json", str(verdict)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as proxy:
            assert proxy.stdout is not None
            ports = re.findall(r":(\d+)", proxy.stdout.readline())
            busy = tuple(Client(f"127.0.0.1:{ports[0]}", random.Random(seed + at), pause) for at in range(clients))
            over = threading.Event()
            channels = [grpc.insecure_channel(one.target, (("grpc.use_local_subchannel_pool", 1),)) for one in busy]
            began = [threading.Event() for _ in busy]
            watching = [
                threading.Thread(target=one.watch, args=(channel, start), daemon=True)
                for one, channel, start in zip(busy, channels, began, strict=True)
            ]
            working = [
                threading.Thread(target=one.work, args=(channel, over), daemon=True)
                for one, channel in zip(busy, channels, strict=True)
            ]
            for thread in watching:
                thread.start()
            for start in began:
                assert start.wait(30)
            for thread in working:
                thread.start()
            time.sleep(seconds)
            over.set()
            for thread in working:
                thread.join(60)
            time.sleep(0.5)  # what is on its way to the streams comes
            for one, thread in zip(busy, watching, strict=True):
                one.stream.cancel()
                thread.join(10)
            proxy.send_signal(signal.SIGINT)
            told = proxy.stdout.read()
            proxy.wait(patience)
            for channel in channels:
                channel.close()
    lines = tuple(json.loads(line) for line in record.read_text().splitlines())
    return Ran(busy, lines, proxy.returncode, json.loads(verdict.read_text()) if verdict.exists() else None, told)
