"""Worlds, messages and conversations for the tests of bear.status."""

from __future__ import annotations

import functools
import random
from collections.abc import Iterable, Mapping
from typing import Any

from missionfsm.bear.status.system import SYSTEM
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.readings import constrain
from missionfsm.kernel.subject import Exchange, Notification, Subject
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.transcript import Head
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.verdict import Outcome
from missionfsm.tools.reference.subject import ReferenceSubject

ALPHABET = SYSTEM.alphabet({}, Bounds())
WORLDS = ALPHABET.worlds
DRIVES = tuple(SYSTEM.spec.drives)


def judge(
    lines: Iterable[Any],
    world: Any = None,
    drives: tuple[str, ...] = DRIVES,
    readings: Mapping[str, str] | None = None,
) -> Judge:
    """A judge that has read these lines."""
    found = Judge(SYSTEM, Head(SYSTEM.name, WORLDS[0] if world is None else world, drives), readings=readings)
    for line in lines:
        found.feed(line)
    return found


def lines_of(notifications: Iterable[Notification]) -> Iterable[Any]:
    """Notifications as lines of a history."""
    for one in notifications:
        if one.method == "message":
            yield {"stream": one.params["stream"], "message": one.params["message"]}
        else:
            yield {
                "stream": one.params["stream"],
                "closed": True,
                **({"error": one.params["error"]} if "error" in one.params else {}),
            }


class Walk:
    """A conversation with a subject that takes its turns from a seeded generator."""

    def __init__(self, subject: Subject, automaton: Automaton, world: Any, drives: tuple[str, ...], seed: int) -> None:
        self.subject = subject
        self.random = random.Random(seed)
        self.judge = Judge(SYSTEM, Head(SYSTEM.name, world, drives), automaton, keep=100_000)
        alphabet = SYSTEM.alphabet(world, Bounds())
        self.prompts = alphabet.inputs
        self.drives = [one for one in alphabet.drives if one["event"] in drives]
        self.serial = 0
        self.streams: list[int] = []
        subject.exchange("reset", {"world": world})

    def feed(self, *lines: Any) -> None:
        for line in lines:
            if self.judge.violation is None and not self.judge.exhausted:
                self.judge.feed(line)

    def call(self, method: str, params: Any) -> Exchange:
        self.serial += 1
        self.feed({"call": self.serial, "method": method, "params": params})
        exchange = self.subject.exchange(method, params)
        self.feed(*lines_of(exchange.before))
        answer = {"error": exchange.error} if exchange.error is not None else {"result": exchange.result}
        self.feed({"return": self.serial, **answer}, *lines_of(exchange.after))
        if exchange.error is None and isinstance(exchange.result, dict) and "stream" in exchange.result:
            self.streams.append(exchange.result["stream"])
        return exchange

    def drive(self, event: Any) -> None:
        exchange = self.subject.exchange("drive", event)
        if exchange.result["happened"]:
            self.feed({"drive": event})
        self.feed(*lines_of(exchange.before), *lines_of(exchange.after))

    def settle(self) -> None:
        exchange = self.subject.exchange("settle", {})
        self.feed(*lines_of(exchange.before), {"settled": True}, *lines_of(exchange.after))

    def cancel(self) -> None:
        stream = self.streams.pop(self.random.randrange(len(self.streams)))
        self.serial += 1
        self.feed({"call": self.serial, "method": "cancel", "params": {"stream": stream}})
        exchange = self.subject.exchange("cancel", {"stream": stream})
        # What other streams showed in the meantime counts.
        self.feed(*lines_of(exchange.before), {"return": self.serial, "result": {}}, *lines_of(exchange.after))

    def turn(self) -> None:
        dice = self.random.random()
        if dice < 0.35 and len(self.streams) < 4:
            prompt = self.random.choice(self.prompts)
            self.call(prompt.method, prompt.params)
        elif dice < 0.8 and self.drives:
            self.drive(self.random.choice(self.drives))
        elif dice < 0.85 and self.streams:
            self.cancel()
        elif dice < 0.93:
            self.call("GetRobotStatus", {"robotId": self.random.choice(("r1", "r2", "r3"))})
        else:
            self.settle()


@functools.lru_cache(maxsize=4)
def _automaton(drives: tuple[str, ...], readings: tuple[tuple[str, str], ...]) -> Automaton:
    """One automaton for all who may walk it: what one of them finds out, the others know."""
    return Automaton(SYSTEM.spec, drives, constrain(SYSTEM.spec.ambiguities, dict(readings)))


def walk(
    subject: Subject,
    walks: int = 25,
    steps: int = 40,
    *,
    drives: tuple[str, ...] = DRIVES,
    readings: Mapping[str, str] | None = None,
    seed: int = 0,
) -> Judge:
    """The judge of the first of so many random conversations that goes wrong, or of the last."""
    automaton = _automaton(drives, tuple((readings or {}).items()))
    for number in range(walks):
        one = Walk(subject, automaton, WORLDS[number % len(WORLDS)], drives, seed * 1000 + number)
        for _ in range(steps):
            one.turn()
            if one.judge.violation or one.judge.exhausted:
                return one.judge
        one.settle()
        if one.judge.violation or one.judge.exhausted:
            return one.judge
    return one.judge


def reference(choice: Mapping[str, str] | None = None) -> ReferenceSubject:
    """The reference model under a choice of readings."""
    return ReferenceSubject(SYSTEM, choice)


# Lines of histories, written by hand.


def by_ids(*robots: str) -> Any:
    return {"selector": {"robotIds": {"ids": list(robots)}}}


def at(location: str) -> Any:
    return {"selector": {"locationId": location}}


def opened(stream: int, method: str, params: Any) -> list[Any]:
    """The lines of a subscription that succeeds; the call has the number of the stream."""
    return [{"call": stream, "method": method, "params": params}, {"return": stream, "result": {"stream": stream}}]


def refused(method: str, params: Any, status: str, call: int = 90) -> list[Any]:
    return [{"call": call, "method": method, "params": params}, {"return": call, "error": {"status": status}}]


def metadata(number: int) -> Any:
    return {"timestamp": "2025-04-01T16:45:00Z", "sequenceNumber": number}


def battery(percent: int = 78, state: str = "STATE_CHARGING", method: str = "CHARGE_METHOD_CONTACT") -> Any:
    return {"chargePercent": percent, "state": state, "chargeMethod": method}


def battery_message(stream: int, robot: str, number: int, value: Any) -> Any:
    return {"stream": stream, "message": {"metadata": metadata(number), "robotId": robot, "batteryState": value}}


def robot_message(stream: int, robot: str, number: int, state: Any) -> Any:
    return {"stream": stream, "message": {"metadata": metadata(number), "robotId": robot, "robotState": state}}


def online_message(stream: int, **robots: tuple[int, str]) -> Any:
    states = {
        robot: {"metadata": metadata(number), "connection": {"state": state}}
        for robot, (number, state) in robots.items()
    }
    return {"stream": stream, "message": {"onlineStates": states}}


def report(robot: str, part: str, value: Any) -> Any:
    return {"drive": {"event": "report", "robotId": robot, "part": part, "value": value}}


SETTLED = {"settled": True}


# Histories written by hand.

BATTERY, ONLINE, ROBOT = "SubscribeBatteryStatus", "SubscribeOnlineStatus", "SubscribeRobotStatus"
ERRORS = "SubscribeErrorCodes"
R1 = WORLDS[0]["robots"][0]
FIRST = R1["state"]["battery"]
SECOND = WORLDS[0]["robots"][1]["state"]["battery"]
UNPLUGGED = battery(77, "STATE_DISCHARGING", "CHARGE_METHOD_NONE")
SUBSCRIBED = [*opened(1, BATTERY, by_ids("r1")), battery_message(1, "r1", 5, FIRST)]
BOTH = [
    *opened(1, BATTERY, by_ids("r1", "r2")),
    battery_message(1, "r2", 7, SECOND),
    battery_message(1, "r1", 5, FIRST),
]


def conforms(*lines: Any, **options: Any) -> bool:
    return judge(lines, **options).verdict().outcome is Outcome.CONFORMS


def broken(*lines: Any, **options: Any) -> list[str]:
    """The names of the rules that a history breaks; at least it must break some."""
    found = judge(lines, **options)
    assert found.violation is not None
    return [one.id.rpartition("/")[2] for one in found.violation.rules]


def readings_of(found: Judge, entry: str) -> tuple[str, ...]:
    """What is left of the one part of an entry that mattered."""
    assert found.violation is None
    [letters] = [left for one, left in found.verdict().readings.items() if f"{one}.".startswith(f"{entry}.")]
    return letters


def errors_message(stream: int, robot: str, number: int, codes: Any) -> Any:
    return {"stream": stream, "message": {"errorCodes": {robot: {"metadata": metadata(number), "codes": codes}}}}
