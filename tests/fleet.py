"""A fleet of robots on loopback, and the mission server that ships as a process of its own, which may be killed.

Robots are as good or as bad as a `Temper` says. What they were sent, and what the server told, is kept to be looked at.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import random
import signal
import socket
import subprocess
import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import attrs

from missionfsm.adapters.isaac.journal import Journal
from missionfsm.isaac.runtime.missions import Snapshot
from missionfsm.isaac.wire.framing import Decoder, encode
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
)

GOOD: Mapping[str, float] = {"success": 1}
BAD: Mapping[str, float] = {"success": 70, "failure": 8, "drop": 8, "hang": 7, "stall": 7}
"""What a robot does with a mission, with weights: ``hang`` says nothing, ``stall`` nothing after RUNNING."""

AT_ONCE = 200
"""How many robots connect at the same time."""


@attrs.frozen
class Size:
    """How many robots and missions; ``200x5000`` as text."""

    robots: int
    missions: int

    @classmethod
    def read(cls, text: str) -> Size:
        """The size that a text says."""
        return cls(*map(int, text.split("x")))


def mission_file(size: Size, seed: int, **fields: float) -> dict[str, list[dict[str, Any]]]:
    """Missions of random robots, a third of which have one or two upstreams."""
    numbers = random.Random(seed)
    missions: list[dict[str, Any]] = []
    for number in range(size.missions):
        mission: dict[str, Any] = {"robot": f"robot-{numbers.randrange(size.robots)}", **fields}
        if number and numbers.random() < 1 / 3:
            mission["upstream"] = sorted({numbers.randrange(number) for _ in range(numbers.randrange(1, 3))})
        missions.append(mission)
    return {"missions": missions}


@attrs.define
class Fleet:
    """Robots that connect to a port again and again, and do what they are sent.

    Attributes:
        sent: what came, in order: the identifier, and what the robot made of it.
    """

    port: int
    robots: int
    temper: Mapping[str, float] = GOOD
    seed: int = 1
    sent: list[tuple[Uuid, str]] = attrs.Factory(list)
    _door: asyncio.Semaphore = attrs.Factory(lambda: asyncio.Semaphore(AT_ONCE))

    async def robot(self, number: int) -> None:
        """One robot, for ever."""
        numbers = random.Random(f"{self.seed} {number}")
        while True:
            with contextlib.suppress(OSError):
                async with self._door:
                    reader, writer = await asyncio.open_connection("127.0.0.1", self.port)
                try:
                    await self._serve(f"robot-{number}", numbers, reader, writer)
                finally:
                    writer.close()
            await asyncio.sleep(0.05)

    async def _serve(
        self, name: str, numbers: random.Random, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        decoder = Decoder()
        await self._say(numbers, writer, Message(Header("name"), TextProto(name)))
        while data := await reader.read(1 << 16):
            for message in decoder.feed(data):
                assert isinstance(message, Message)
                assert isinstance(message.payload, MissionProto)
                uuid = message.payload.uuid
                assert uuid is not None
                (mood,) = numbers.choices(tuple(self.temper), tuple(self.temper.values()))
                self.sent.append((uuid, mood))
                if mood == "drop":
                    return
                says = {"hang": (), "stall": ("running",)}.get(mood, ("running", mood))
                for word in says:
                    status = MissionStatusProto(uuid, WireStatus(word))
                    await self._say(numbers, writer, Message(Header("mission_status", 1, 1, uuid), status))

    async def _say(self, numbers: random.Random, writer: asyncio.StreamWriter, message: Message) -> None:
        """Send a line; a robot that is not good may send it in two pieces."""
        line = encode(message)
        if self.temper is not GOOD and numbers.random() < 1 / 3:
            cut = numbers.randrange(1, len(line))
            writer.write(line[:cut])
            await writer.drain()
            await asyncio.sleep(0.002)
            line = line[cut:]
        writer.write(line)
        await writer.drain()


@attrs.frozen
class Outcome:
    """What came of a run.

    Attributes:
        status: the exit status of the server that came to its end.
        kills: how many were killed before.
        sent: see `Fleet`.
        ends: for each index of a mission the statuses in which a server said that it ended.
        journal: what the journal has at the end.
        seconds: from the first server's start to the last one's end.
    """

    status: int
    kills: int
    sent: tuple[tuple[Uuid, str], ...]
    ends: Mapping[int, tuple[str, ...]]
    journal: tuple[Snapshot, ...]
    seconds: float


def free_port() -> int:
    """A port of loopback that nobody listens on."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        return int(taken.getsockname()[1])


def run(
    folder: Path,
    missions: Mapping[str, Any],
    robots: int,
    *options: str,
    temper: Mapping[str, float] = GOOD,
    kills: int = 0,
    seed: int = 1,
) -> Outcome:
    """Run the server until all missions have ended; it is killed at so many moments and started again.

    Args:
        folder: where the file of missions, the journal (if it is killed) and the log are written.
        options: of ``dispatch``, besides.
    """
    file, log = folder / "missions.json", folder / "log.jsonl"
    file.write_text(json.dumps(missions), encoding="utf-8")
    journal = folder / "journal.db"
    port = free_port()
    keeps = ("--journal", str(journal)) if kills else ()
    program = (sys.executable, "-m", "missionfsm", "dispatch", str(file), "--port", str(port), "--log", "json")
    fleet = Fleet(port, robots, temper, seed)

    async def serve() -> tuple[int, int, float]:
        loop = asyncio.get_running_loop()
        began = loop.time()
        at = [len(missions["missions"]) * (one + 1) // (kills + 2) for one in range(kills)]
        crew = [asyncio.create_task(fleet.robot(number)) for number in range(robots)]
        killed = 0
        try:
            while True:
                command = [*program, *keeps, *options]
                with log.open("ab") as sink, subprocess.Popen(command, stdout=sink) as server:  # noqa: ASYNC220 - in no time
                    while server.poll() is None:
                        await asyncio.sleep(0.01)
                        if at and len(fleet.sent) >= at[0]:
                            at.pop(0)
                            killed += 1
                            server.kill()
                            server.wait()
                if server.returncode != -signal.SIGKILL:
                    return server.returncode, killed, loop.time() - began
        finally:
            for one in crew:
                one.cancel()
            await asyncio.gather(*crew, return_exceptions=True)

    status, killed, seconds = asyncio.run(serve())
    kept: tuple[Snapshot, ...] = ()
    if kills:
        books = Journal(journal)
        kept = books.missions()
        books.close()
    return Outcome(status, killed, tuple(fleet.sent), _ends(log), kept, seconds)


def _ends(log: Path) -> dict[int, tuple[str, ...]]:
    """Of each mission the ends that were told; the last line of a server that was killed may be cut."""
    ends: dict[int, tuple[str, ...]] = {}
    for line in log.read_bytes().splitlines():
        with contextlib.suppress(ValueError):
            said = json.loads(line)
            if said.get("event") == "status" and said["status"] not in ("CREATED", "QUEUED", "STARTED", "RUNNING"):
                ends[said["mission"]] = (*ends.get(said["mission"], ()), said["status"])
    return ends


def doubled(outcome: Outcome) -> list[Uuid]:
    """What was sent more than once."""
    return [uuid for uuid, times in Counter(uuid for uuid, _ in outcome.sent).items() if times > 1]
