"""Recordings of many clients at once, each of which watches the robot: their calls overlap, and all see every event."""

from __future__ import annotations

import random

import pytest

from missionfsm.app.asked import judged_system
from missionfsm.kernel.codec import JSON
from missionfsm.oracle.successors import Successors
from missionfsm.oracle.transcript import Head
from missionfsm.systems import system
from missionfsm.tools.check.judge import Judge, check
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.reference.subject import ReferenceSubject

CLIENTS, ROUNDS = 8, 5
NAVIGATE: JSON = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
CALLS: tuple[tuple[str, JSON], ...] = (
    ("CreateMission", NAVIGATE),
    ("AppendMission", NAVIGATE),
    ("SkipGoal", {}),
    ("ClearMissionStatus", {}),
)


class Recording:
    """What a proxy between the clients and the reference records, the robot's surroundings aside."""

    def __init__(self, seed: int) -> None:
        self.lines: list[JSON] = []
        self._draw = random.Random(seed)
        self._robot = ReferenceSubject(system("bear.mission"))
        self._robot.exchange("reset", {"world": {}})
        self._calls = 0
        self._sent: list[JSON] = []

    def round(self, asked: list[tuple[str, JSON]], *, drives: int = 0) -> None:
        """Calls that are under way at once; what streams show of them comes in the order of the robot's events."""
        numbered = list(enumerate(asked, self._calls + 1))
        self._calls += len(asked)
        self.lines += ({"call": number, "method": name, "params": params} for number, (name, params) in numbered)
        answers = []
        for number, (name, params) in self._draw.sample(numbered, len(numbered)):
            exchange = self._robot.exchange(name, params)
            answered = {"result": exchange.result} if exchange.error is None else {"error": exchange.error}
            if name.startswith("Subscribe"):  # a stream shows nothing before it was answered
                self.lines.append({"return": number, **answered})
            else:
                answers.append({"return": number, **answered})
            self.lines += (one.params for one in exchange.after)
        for _ in range(drives):
            self.lines += (one.params for one in self._robot.exchange("drive", {"event": "goalReached"}).after)
        self.lines += self._draw.sample(answers, len(answers))

    def calls(self) -> list[tuple[str, JSON]]:
        """What the clients ask next, each one thing."""
        return [self._draw.choice(CALLS) for _ in range(CLIENTS)]

    def over(self, clients: int) -> None:
        """Every client leaves."""
        self.round([("cancel", {"stream": stream}) for stream in range(1, clients + 1)])


def recorded(seed: int, clients: int = CLIENTS) -> list[JSON]:
    """A busy recording from its beginning to its end; so many clients watch."""
    found = Recording(seed)
    found.round([("SubscribeMissionStatus", {})] * clients)
    for _ in range(ROUNDS):
        found.round(found.calls(), drives=1)
    found.over(clients)
    return found.lines


def verdict(lines: list[JSON]) -> Verdict:
    """The verdict of ``missionfsm check``."""
    return check(judged_system("bear.mission", strict=False), Head("bear.mission", {}), lines)


def test_many_who_watch_everything_are_decided() -> None:
    """Eight clients whose calls overlap and whose streams all show every event are judged to the end, and right."""
    found = verdict(recorded(1))
    assert found.conforms, str(found)


def test_a_break_among_many_who_watch_is_found() -> None:
    """Where one stream of eight shows two events in the wrong order, that is the line that is wrong."""
    lines = recorded(1)
    mine = [at for at, line in enumerate(lines) if line.get("stream") == 3 and "message" in line]
    first, second = mine[len(mine) // 2 : len(mine) // 2 + 2]
    lines[first], lines[second] = lines[second], lines[first]
    found = verdict(lines)
    assert found.violation is not None
    assert (found.violation.at, [rule.id for rule in found.violation.rules]) == (
        second + 2,
        ["bear.mission/SubscribeMissionStatus/sequence-numbers-grow"],
    )


def test_an_answer_that_cannot_be_read_is_found_among_many() -> None:
    """An answer without its mission id is wrong whatever was before it, however much that leaves open."""
    lines = recorded(2)
    at, line = next((at, line) for at, line in enumerate(lines) if "missionId" in line.get("result", {}))
    lines[at] = {**line, "result": {}}
    found = verdict(lines)
    assert found.violation is not None
    assert found.violation.at == at + 2


def test_the_first_message_may_be_wrong_while_all_subscribe() -> None:
    """Where all subscribe at once and the first message shows what never was, that is decided: no order explains it."""
    lines = recorded(3, 5)
    at, line = next((at, line) for at, line in enumerate(lines) if "message" in line)
    states = {**line["message"]["missionStates"], "currentMissionIndex": 0}
    lines[at] = {**line, "message": {**line["message"], "missionStates": states}}
    found = verdict(lines)
    assert found.violation is not None
    assert found.violation.at == at + 2


def test_subscriptions_in_flight_do_not_multiply(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of twelve that are under way at once the answers and the first messages are looked at one after the other."""
    spent = {}
    spend, looked_at = Successors.spend, [0]

    def counted(successors: Successors, cost: int = 1) -> None:
        looked_at[0] += cost
        spend(successors, cost)

    monkeypatch.setattr(Successors, "spend", counted)
    for clients in (6, 12):
        log = Recording(1)
        log.round([("SubscribeMissionStatus", {})] * clients)
        judge = Judge(judged_system("bear.mission", strict=False), Head("bear.mission", {}, frozenset()), waits=False)
        costs = []
        for line in log.lines:
            looked_at[0] = 0
            judge.feed(line)
            costs.append(looked_at[0])
        assert judge.right
        spent[clients] = max(costs)
    assert 0 < spent[12] < 3 * spent[6]
