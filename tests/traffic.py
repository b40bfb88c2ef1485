"""Conforming histories of the reference, as long and as varied as a test wants them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from random import Random
from typing import Any

from missionfsm.kernel.alphabet import Input
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification
from missionfsm.kernel.system import System
from missionfsm.systems import system
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")
WORLD = {"family": "servi"}
COMMANDS = ("COMMAND_CANCEL", "COMMAND_PAUSE", "COMMAND_RESUME", "COMMAND_FINISH")
DRIVES = ("goalReached", "missionSucceeded", "missionFailed")
SUBSCRIBE = "SubscribeMissionStatus"


def navigate(table: str) -> Any:
    return {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": table}}}}}


def delivery(*tables: str) -> Any:
    goals = [{"destinationId": table} for table in tables]
    return {"mission": {"serviMission": {"deliveryMission": {"goals": goals}}}}


class Recorder:
    """Talks to the reference of `bear.mission` and keeps the lines of the history, the first one included.

    Args:
        choice: the readings that the reference follows.
        drives: whether the environment is known to be driven.
    """

    def __init__(self, choice: Mapping[str, str] | None = None, *, drives: bool = True, of: System = MISSION) -> None:
        self.reference = ReferenceSubject(of, choice)
        self.reference.exchange("reset", {"world": WORLD})
        self.head: Any = {"missionfsm": 1, "system": of.name, "world": WORLD}
        if drives:
            self.head["drives"] = list(DRIVES)
        self.driven = drives
        self.calls = 0
        self.lines: list[Any] = []
        self.missions: list[str] = []
        self.streams: list[int] = []

    def call(self, method: str, params: Any = None) -> Exchange:
        """A call with its answer, and what comes with it."""
        self.calls += 1
        exchange = self.reference.exchange(method, params or {})
        self.lines.append({"call": self.calls, "method": method, "params": params or {}})
        answer = {"error": exchange.error} if exchange.error else {"result": exchange.result}
        self.lines.append({"return": self.calls, **answer})
        result = exchange.result or {}
        self.missions += [name for name in (result.get("missionId"), *result.get("missionIds", ())) if name]
        if "stream" in result:
            self.streams.append(result["stream"])
        self._shown(exchange.after)
        return exchange

    def drive(self, **event: Any) -> None:
        """What the environment does; a line of its own where it is known to be driven."""
        exchange = self.reference.exchange("drive", event)
        if self.driven and exchange.result["happened"]:
            self.lines.append({"drive": event})
        self._shown(exchange.after)

    def settle(self) -> None:
        self.lines.append({"settled": True})

    def _shown(self, after: tuple[Notification, ...]) -> None:
        self.lines += [{"stream": one.params["stream"], "message": one.params["message"]} for one in after]

    @property
    def history(self) -> list[Any]:
        return [self.head, *self.lines]


def walk(seed: int, steps: int, choice: Mapping[str, str] | None = None, *, drives: bool = True) -> Recorder:
    """A client, and now and then another subscriber, of a robot that runs missions."""
    random = Random(seed)
    log = Recorder(choice, drives=drives)
    log.call(SUBSCRIBE)
    tables = ("table-1", "table-2", "table-3")
    for _ in range(steps):
        what = random.randrange(12)
        if what < 2:
            log.call("CreateMission", navigate(random.choice(tables)))
        elif what < 4:
            log.call("AppendMission", delivery(*random.sample(tables, 2)))
        elif what < 6 and log.missions:
            mission = random.choice(log.missions[-3:])
            command = {"missionId": mission, "command": random.choice(COMMANDS)}
            log.call("UpdateMission", {"missionCommand": command})
        elif what == 6:
            log.call(random.choice(("SkipGoal", "ClearMissionStatus", "ChargeRobot")))
        elif what == 7 and len(log.streams) < 3:
            log.call(SUBSCRIBE)
        elif what == 8:
            log.settle()
        else:
            log.drive(event=random.choice(DRIVES))
    log.settle()
    return log


def hourly(seed: int) -> Recorder:
    """A client whose stream ends again and again, and is opened anew."""
    random = Random(seed)
    log = Recorder(readings_at_random(seed) if seed % 2 else None, drives=random.random() < 0.5)
    for _ in range(5):
        log.call(SUBSCRIBE)
        for _ in range(random.randrange(1, 4)):
            what = random.randrange(5)
            if what < 2:
                log.call(("CreateMission", "AppendMission")[what], navigate("table-1"))
            elif what == 2:
                log.call(random.choice(("SkipGoal", "ClearMissionStatus", "ChargeRobot")))
            else:
                log.drive(event=random.choice(DRIVES))
        log.lines.append({"stream": log.streams[-1], "closed": True})
        log.reference.exchange("cancel", {"stream": log.streams[-1]})
    return log


def readings_at_random(seed: int, of: System = MISSION) -> dict[str, str]:
    """A letter of some ambiguities, the others as by default."""
    random = Random(seed)
    some = random.sample(of.spec.ambiguities, len(of.spec.ambiguities) // 4)
    return {one.id: random.choice(tuple(one.readings)) for one in some}


def one_more(
    reference: ReferenceSubject, random: Random, number: int, prompts: Sequence[Input], drives: Sequence[JSON]
) -> list[Any]:
    """The lines of a call with that number, or of a drive that happened, and of what came with it."""
    if prompts and random.random() < 0.5:
        prompt = random.choice(prompts)
        exchange = reference.exchange(prompt.method, prompt.params)
        answer = {"error": exchange.error} if exchange.error else {"result": exchange.result}
        lines: list[Any] = [{"call": number, "method": prompt.method, "params": prompt.params}]
        lines.append({"return": number, **answer})
    else:
        drive = random.choice(drives)
        exchange = reference.exchange("drive", drive)
        lines = [{"drive": drive}] * exchange.result["happened"]
    return [*lines, *(one.params for one in exchange.after)]
