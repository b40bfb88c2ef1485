"""The mission server that somebody else made (tests/strangers), with two or three choices about limits at a time.

Each choice by itself is judged by ``missionfsm teeth``; what is accepted alone has to be accepted together.
"""

from __future__ import annotations

import itertools
import json
import random
import re
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from server_history import SETTLED, History

from missionfsm.adapters.stdio import Child
from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import Header, Message, MissionStatusProto, TextProto, Uuid, WireStatus
from missionfsm.kernel.subject import Exchange
from missionfsm.tools.check.verdict import Verdict

FOLDER = Path(__file__).parent.parent / "strangers" / "isaac.server"

PROGRAM = """
import sys
sys.path.insert(0, ".")
import dispatch
import limits
from adapter import Adapter
from mission import Status
from variants import Variant

WAITING = (Status.QUEUED, Status.STARTED)

class Several(Variant):
    def __call__(self, name):
        super().__call__(name)
        return name in sys.argv[1:]

class Dispatch(dispatch.Dispatch):
    def limits(self):
        for mission in self._missions.values():
            if not hasattr(mission, "there_at"):
                there = self._connections.serving(mission.robot) is not None
                mission.there_at = mission.submitted_at if there else None
        return super().limits()

    def end(self, mission, status, now):
        sent, held = mission.active, self._held.get(mission.robot)
        super().end(mission, status, now)
        if not sent and held is not mission:
            self.release(mission)
            if held is not None:
                self._held[mission.robot] = held

    def left(self, robot):
        super().left(robot)
        self._there(robot, None)

    def arrived(self, connection, others, now):
        super().arrived(connection, others, now)
        self._there(connection.name, now)

    def _there(self, robot, since):
        for mission in self._missions.values():
            if mission.robot == robot and mission.status is Status.QUEUED:
                mission.there_at = since

def begins(mission):
    if "start-limit-from-submitting" in sys.argv:
        return mission.submitted_at
    if "start-limit-from-connection" in sys.argv:
        return mission.there_at
    if any(one.status is not Status.SUCCESS for one in mission.upstream):
        return None
    return max([mission.submitted_at] + [one.ended_at for one in mission.upstream])

def start_limit_at(mission, variant):
    if not any(one.startswith("start-limit-from") for one in sys.argv):
        return limits.start_limit_at(mission, variant)
    since = begins(mission) if mission.status in WAITING else None
    if since is None or mission.start_limit is None:
        return None
    return limits._strikes(since, mission.start_limit, variant)

def run_limit_at(mission, limit, variant):
    if "run-limit-from-submitting" not in sys.argv or limit is None or mission.ended:
        return limits.run_limit_at(mission, limit, variant)
    return limits._strikes(mission.submitted_at, limit, variant)

import mission_server
dispatch.start_limit_at, dispatch.run_limit_at = start_limit_at, run_limit_at
mission_server.Dispatch = Dispatch
Adapter("several", sys.stdout, Several()).run(sys.stdin)
"""
"""Their server with as many variants as the command names, and with limits that count from elsewhere."""

LIMITS = (
    "limits-every-second",
    "pass-every-second",
    "sends-every-second",
    "limit-strictly-after",
    "limit-whole-seconds-exceeded",
    "limit-rounded-up",
    "limit-zero-waits",
    "run-limit-from-sending",
    "held-after-abort",
    "abort-closes",
    "run-limit-from-submitting",
    "start-limit-from-submitting",
    "start-limit-from-readiness",
    "start-limit-from-connection",
)
"""The choices about when a limit is over and what that does."""


COUNTS_EARLIER = re.compile(".*-limit-from-(?!sending)").match
ROUNDED, LOOKED_AT = "limit-rounded-up", {"limits-every-second", "pass-every-second"}


def combined(size: int) -> Iterator[tuple[str, ...]]:
    """So many choices at a time, of those that a server can make together and be no more than a second late."""
    for several in itertools.combinations(LIMITS, size):
        questions = [one.partition("-from-")[0] for one in several if "-from-" in one]
        # A limit that counts from an odd moment, is rounded up and then looked at in whole seconds: up to two seconds.
        too_late = questions and ROUNDED in several and not LOOKED_AT.isdisjoint(several)
        if len(questions) == len(set(questions)) and not too_late:
            yield several


PAIRS = tuple(combined(2))
TRIPLES = tuple(random.Random(13).sample(list(combined(3)), 60))


class Life(History):
    """Leads their server and writes down what it does; with a `step`, at least each so many seconds."""

    step = 0.0

    def __init__(self, subject: Child) -> None:
        super().__init__()
        self._subject = subject
        self.handles: list[int] = []
        self.open: list[int] = []
        self.sent: list[tuple[int, Uuid]] = []
        subject.exchange("initialize", {"protocolVersion": 1, "system": "isaac.server"})

    def mission(self, **mission: Any) -> Life:
        """A mission is submitted."""
        self.handles.append(self._asks("submit", {"mission": {"robot": "r", **mission}})["mission"])
        return self

    def robots(self, name: str = "r") -> Life:
        """A robot connects."""
        self.open.append(self._drives(event="connect")["connection"])
        return self._says(self.open[-1], "name", TextProto(name))

    def tells(self, sent: int, status: str) -> Life:
        """A status of a mission on the connection that it was sent on, if it was sent and that is there."""
        if sent >= len(self.sent) or self.sent[sent][0] not in self.open:
            return self
        connection, mission = self.sent[sent]
        return self._says(connection, "mission_status", MissionStatusProto(mission, WireStatus(status)))

    def goes_on(self, seconds: float) -> Life:
        """Time passes, and the statuses are looked at."""
        while self.step and seconds > self.step:
            self._drives(event="advance", seconds=self.step)
            seconds = round(seconds - self.step, 6)
        self._drives(event="advance", seconds=seconds)
        self._asks("statuses", {})
        return self

    def _says(self, connection: int, channel: str, payload: TextProto | MissionStatusProto) -> Life:
        line = encode(Message(Header(channel), payload)).decode().strip()
        self._drives(event="line", connection=connection, line=line)
        return self

    def _drives(self, **drive: Any) -> Any:
        exchange = self._subject.exchange("drive", drive)
        self.drive(**drive, **{name: one for name, one in exchange.result.items() if name != "happened"})
        self._settled(exchange)
        return exchange.result

    def _asks(self, method: str, params: Any) -> Any:
        exchange = self._subject.exchange(method, params)
        self.calls += 1
        self.lines.append({"call": self.calls, "method": method, "params": params})
        self.lines.append({"return": self.calls, "result": exchange.result})
        self._settled(exchange)
        return exchange.result

    def _settled(self, last: Exchange) -> None:
        settled = self._subject.exchange("settle", {})
        for one in (*last.after, *settled.earlier, *settled.before, *settled.after):
            if one.method == "closed":
                self.lines.append({"connection": one.params["connection"], "closed": True})
                self.open.remove(one.params["connection"])
            else:
                self.lines.append(one.params)
                halves = json.loads(one.params["line"])["payload"]["uuid"]
                self.sent.append((one.params["connection"], Uuid(int(halves["lower"]), int(halves["upper"]))))
        self.lines.append(SETTLED)


def lives(*choices: str) -> Iterator[Life]:
    """Their server with some choices, as one that lives."""
    command = (sys.executable, "-c", PROGRAM, *choices)
    with closing(Child(command, folder=str(FOLDER))) as subject:
        yield Life(subject)


def watched(life: Life) -> Life:
    """Missions that are acknowledged, or not, at odd moments, and looked at often around each of their limits."""
    life.goes_on(0.6).mission().robots().mission(start_timeout=2.5, timeout=3).goes_on(0.9)
    life.tells(0, "success").goes_on(1.2).tells(1, "running").mission(start_timeout=1.9, timeout=1.5)
    for step in (1.1, 0.2, 0.2, 0.2, 0.1, 0.2, 0.2, 0.3, 0.3, 0.4, 0.3, 0.5, 0.8, 0.8, 0.8):
        life.goes_on(step)
    return life


def waited(life: Life) -> Life:
    """Missions that wait: for their robot, for the one before, for an upstream; and looked at around their limits."""
    life.goes_on(0.3).mission(start_timeout=1.4).mission(start_timeout=2.5, timeout=4)
    for step in (1.3, 0.2, 0.3, 0.3, 0.4):
        life.goes_on(step)
    life.mission(robot="s", timeout=1.7).robots().goes_on(0.9).mission(start_timeout=0.8)
    for step in (0.2, 0.5, 0.2, 0.2, 0.4, 0.5):
        life.goes_on(step)
    life.tells(0, "running").mission(upstream=[1], start_timeout=1.2, timeout=3.1).goes_on(1.1)
    life.tells(0, "success")
    for step in (0.2, 0.7, 0.4, 0.2, 0.3, 0.4, 0.6, 1):
        life.goes_on(step)
    return life


def random_life(life: Life, draw: random.Random) -> Life:
    """A few missions and a robot; time passes mostly to moments when a limit could be over, or a little later."""
    now = draw.choice([0.1, 0.3, 0.6, 0.8])
    life.goes_on(now)
    limits: list[float] = []
    moments: list[float] = []
    for _ in range(16):
        what = draw.choice("mcrrrwwwwpppp") if life.handles else "m"
        if what == "m" and len(life.handles) < 4:
            start, run = draw.choice([0, 0.5, 1.9, 2, 5]), draw.choice([0, 1, 2.5, 3, 7])
            limits += [start, run]
            life.mission(start_timeout=start, timeout=run)
        elif what == "c" and not life.open:
            life.robots()
        elif what == "r" and life.sent:
            life.tells(draw.randrange(len(life.sent)), draw.choice(["running", "running", "success", "failure"]))
        ahead = [one for one in moments if one > now - 1]
        if what in "wp":
            to = draw.choice(ahead) if ahead and what == "w" else now
            step = round(to - now + draw.choice([-0.1, 0, 0.1, 0.2, 0.4, 0.6, 0.9, 1.2]), 6)
            if step > 0:
                life.goes_on(step)
                now += step
        else:
            moments += [now + limit for limit in limits]
    return life.goes_on(0.1)


@pytest.mark.parametrize("pair", PAIRS, ids="+".join)
def test_two_choices_about_limits_are_accepted_together(pair: tuple[str, ...]) -> None:
    """Whoever may look at limits now and then, or count otherwise, may do both."""
    for life in lives(*pair):
        assert watched(life).judged().conforms


@pytest.mark.parametrize("pair", [one for one in PAIRS if any(map(COUNTS_EARLIER, one))], ids="+".join)
def test_limits_of_missions_that_wait_are_accepted_too(pair: tuple[str, ...]) -> None:
    """A limit may be noticed up to a second late, whatever it counts from, also of a mission that was never sent."""
    for life in lives(*pair):
        assert waited(life).judged().conforms


@pytest.mark.long
@pytest.mark.parametrize("triple", TRIPLES, ids="+".join)
def test_three_choices_about_limits_are_accepted_together(triple: tuple[str, ...]) -> None:
    """So may whoever makes a third choice as well."""
    for lead in (watched, waited):
        for life in lives(*triple):
            assert lead(life).judged().conforms


@pytest.mark.long
@pytest.mark.parametrize("pair", PAIRS, ids="+".join)
def test_two_choices_about_limits_are_accepted_together_on_random_lives(pair: tuple[str, ...]) -> None:
    """So they are whatever happens to the missions."""
    for seed in range(3):
        for life in lives(*pair):
            assert random_life(life, random.Random(f"{pair} {seed}")).judged().conforms


def timed_lives(*choices: str) -> Iterator[Life]:
    """Their server with some choices, looked at often enough for a log to say when its lines were."""
    for life in lives(*choices):
        life.step = 0.5
        yield life


def by_the_clock(life: Life, late: float) -> Verdict:
    """The verdict on a life as a log that only tells when its lines were, and after how long something is late."""
    log, now = History("connect", "line", "disconnect"), 0.0
    for line in life.goes_on(20).lines:
        drive = line.get("drive", {})
        now += drive.get("seconds", 0)
        if drive.get("event") != "advance" and line != SETTLED:
            log.lines.append({**line, "at": now})
    return log.judged(settled_after=late)


@pytest.mark.parametrize("choice", LIMITS)
def test_nothing_that_is_right_is_late_by_the_times_of_the_lines(choice: str) -> None:
    """Whoever looks at limits now and then is no later than that, and what was due is known to have happened."""
    for lead in (watched, waited):
        for life in timed_lives(choice):
            assert by_the_clock(lead(life), 2.5).conforms


def test_a_limit_that_is_ignored_is_late_by_the_times_of_the_lines() -> None:
    """What has to be aborted by then is not under way."""
    for life in timed_lives("run-limit-ignored"):
        assert not by_the_clock(watched(life), 2.5).conforms


def test_a_fault_about_limits_is_not_accepted() -> None:
    """What is led so is looked at closely enough."""
    for fault in ("run-limit-doubled", "run-limit-ignored", "acknowledged-still-aborted"):
        for life in lives(fault):
            assert not watched(life).judged().conforms, fault
