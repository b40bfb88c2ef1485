"""Logs of several clients at once of a robot that moves by itself: calls overlap, are lost or time out, streams end."""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Mapping
from random import Random
from typing import Any

from attrs import define, field, frozen
from traffic import COMMANDS, DRIVES, MISSION, SUBSCRIBE, WORLD, delivery, navigate

from missionfsm.tools.reference.subject import ReferenceSubject


@frozen
class Habits:
    """How often things go as nobody likes them to, from 0 to 1, and how many clients there are.

    Attributes:
        lost: calls that are never answered.
        late: calls that are answered DEADLINE_EXCEEDED by the client; they take effect or not, now or later.
        ends: streams that end cleanly, each time one could show a message.
        moves: steps in which the robot does something by itself.
        slow: how long messages and answers stay on their way; 0: they come at once.
        behind: how many messages of an open stream may be on their way at once.
    """

    clients: int = 3
    lost: float = 0.05
    late: float = 0.05
    ends: float = 0.02
    moves: float = 0.15
    slow: float = 0.5
    behind: int = sys.maxsize


@define
class _Call:
    """A call on its way: `answer` once it has taken effect, `waits` while its client does."""

    number: int
    method: str
    params: Any
    client: int
    answer: Any = None
    waits: bool = True


@define
class Traffic:
    """Clients and a robot; `lines` are what is recorded after the first line."""

    random: Random
    habits: Habits
    reference: ReferenceSubject
    lines: list[Any] = field(factory=list)
    _calls: list[_Call] = field(factory=list)
    _sent: int = 0
    _busy: set[int] = field(factory=set)
    _missions: list[str] = field(factory=list)
    _waiting: dict[int, deque[Any]] = field(factory=dict)
    _open: set[int] = field(factory=set)

    def send(self, client: int, method: str, params: Any) -> _Call:
        """A client sends a call."""
        self._sent += 1
        call = _Call(self._sent, method, params, client)
        self.lines.append({"call": call.number, "method": method, "params": params})
        self._calls.append(call)
        self._busy.add(client)
        return call

    def take_effect(self, call: _Call) -> None:
        """The robot gets a call and does what it says."""
        exchange = self.reference.exchange(call.method, call.params)
        call.answer = {"error": exchange.error} if exchange.error else {"result": exchange.result}
        result = exchange.result or {}
        self._missions += [name for name in (result.get("missionId"), *result.get("missionIds", ())) if name]
        if "stream" in result:
            self._waiting[result["stream"]] = deque()
        self._show(exchange.after)
        if not call.waits:
            self._calls.remove(call)

    def come_back(self, call: _Call) -> None:
        """A client gets its answer."""
        self.lines.append({"return": call.number, **call.answer})
        self._done(call)
        self._calls.remove(call)
        self._open |= {call.answer["result"]["stream"]} if "stream" in call.answer.get("result", {}) else set()

    def give_up(self, call: _Call, *, told: bool) -> None:
        """A client waits no longer: its deadline has passed, or nobody ever hears of the call again."""
        if told:
            passed = {"status": "DEADLINE_EXCEEDED", "message": "context deadline exceeded"}
            self.lines.append({"return": call.number, "error": passed})
        self._done(call)
        call.waits = False
        if call.answer is not None:
            self._calls.remove(call)

    def _done(self, call: _Call) -> None:
        self._busy.discard(call.client)

    def move(self) -> None:
        """The robot does something that nobody has asked for."""
        self._show(self.reference.exchange("drive", {"event": self.random.choice(DRIVES)}).after)

    def _show(self, after: Any) -> None:
        for one in after:
            self._waiting[one.params["stream"]].append(one.params["message"])
        for stream in sorted(self._open):
            while stream in self._open and len(self._waiting[stream]) > self.habits.behind:
                self.deliver(stream)

    def deliver(self, stream: int) -> None:
        """A stream shows its next message, or ends."""
        if self.random.random() < self.habits.ends:
            self.lines.append({"stream": stream, "closed": True})
            self._open.remove(stream)
            self.reference.exchange("cancel", {"stream": stream})
        else:
            self.lines.append({"stream": stream, "message": self._waiting[stream].popleft()})

    def request(self) -> tuple[str, Any]:
        """What a client may want."""
        random = self.random
        table, other = random.sample(("table-1", "table-2", "table-3"), 2)
        mission = random.choice((navigate(table), delivery(table, other)))
        what = random.randrange(12)
        if what < 3:
            return "CreateMission", mission
        if what < 6:
            return "AppendMission", mission
        if what < 9 and self._missions:
            command = {"missionId": random.choice(self._missions[-4:]), "command": random.choice(COMMANDS)}
            return "UpdateMission", {"missionCommand": command}
        if what == 9 and len(self._open) < self.habits.clients:
            return SUBSCRIBE, {}
        return random.choice(("SkipGoal", "ClearMissionStatus", "ChargeRobot", "SkipGoal")), {}

    def step(self) -> None:
        """Something happens."""
        random, habits = self.random, self.habits
        idle = [one for one in range(habits.clients) if one not in self._busy]
        ready = [stream for stream in sorted(self._open) if self._waiting[stream]]
        if random.random() < habits.moves:
            self.move()
        elif idle and random.random() < 1 / 3:
            call = self.send(random.choice(idle), *self.request())
            if random.random() < habits.lost + habits.late:
                self.give_up(call, told=random.random() * (habits.lost + habits.late) > habits.lost)
            elif random.random() >= habits.slow:
                self.take_effect(call)
                self.come_back(call)
        elif self._calls and random.random() < 1 / 2:
            call = random.choice(self._calls)
            if call.answer is None:
                self.take_effect(call)
            elif call.waits:
                self.come_back(call)
        elif ready:
            self.deliver(random.choice(ready))


def busy(seed: int, lines: int, habits: Habits, choice: Mapping[str, str] | None = None) -> list[Any]:
    """A log of about so many lines, the first one included; the robot follows a choice of readings."""
    reference = ReferenceSubject(MISSION, choice)
    reference.exchange("reset", {"world": WORLD})
    traffic = Traffic(Random(seed), habits, reference)
    first = traffic.send(0, SUBSCRIBE, {})
    traffic.take_effect(first)
    traffic.come_back(first)
    while len(traffic.lines) < lines:
        traffic.step()
    return [{"missionfsm": 1, "system": MISSION.name, "world": WORLD}, *traffic.lines]
