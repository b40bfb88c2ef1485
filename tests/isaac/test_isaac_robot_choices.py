"""The robot that somebody else made (tests/strangers), with two or three choices at a time, on random lives.

Each choice by itself is judged by ``missionfsm teeth``; what is accepted alone has to be accepted together, whatever is
sent to the robot: missions that are written otherwise or lack something, too.
"""

from __future__ import annotations

import json
import random
import re
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from missionfsm.adapters.stdio import Child
from missionfsm.isaac.wire.messages import TYPE_IDS, MissionProto, TextProto, signed, unsigned
from missionfsm.kernel.subject import Exchange
from missionfsm.oracle.transcript import Head
from missionfsm.systems import system
from missionfsm.tools.check.judge import check

ROBOT = system("isaac.robot")
FOLDER = Path(__file__).parent.parent / "strangers" / "isaac.robot"
DRIVES = tuple(ROBOT.spec.drives)
CHOICES = tuple(re.findall(r'"choice-([a-z-]+)"|"--choice", "([a-z-]+)"', (FOLDER / "subjects.toml").read_text()))
NAMES = tuple(sorted({name for found in CHOICES for name in found if name}))
MISSION = signed(TYPE_IDS[MissionProto])
CONFIGS = ("{}", '{"a":{"b":{"c":1}}}', "no json", "null", "[1]", "17", '{"a":1}', "", '{"a":{"b":1}}')
RUBBISH = ("", "no json", "{}", "[]", '{"header":{}}', '{"header":{"channel":"mission"},"payload":{}}')
SECONDS = (0.05, 0.1, 0.3, 1, 1, 2, 5, 20)


class Life:
    """Leads their robot and writes down what it does."""

    def __init__(self, subject: Child, draw: random.Random) -> None:
        self._subject = subject
        self._draw = draw
        self._missions = 0
        self.lines: list[Any] = []
        subject.exchange("initialize", {"protocolVersion": 1, "system": "isaac.robot"})
        self._seen(subject.exchange("reset", {"world": {}}))

    def lead(self) -> list[Any]:
        """What it does in a life of some steps."""
        for _ in range(self._draw.randrange(8, 26)):
            self._step(self._event())
            if self._draw.random() < 0.6:
                self._seen(self._subject.exchange("settle", {}))
                self.lines.append({"settled": True})
        return self.lines

    def _step(self, event: Any) -> None:
        exchange = self._subject.exchange("drive", event)
        if exchange.result["happened"]:
            self.lines.append({"drive": event})
        self._seen(exchange)

    def _seen(self, exchange: Exchange) -> None:
        for told in (*exchange.earlier, *exchange.before, *exchange.after):
            self.lines.append({"connection": 1, **told.params})

    def _event(self) -> Any:
        what = self._draw.choice("mmmmaaaaaaaasfsfdcoo")
        if what == "m":
            return {"event": "line", "line": json.dumps(self._mission())}
        if what == "o":
            return {"event": "line", "line": self._draw.choice((*RUBBISH, self._text()))}
        if what == "a":
            return {"event": "advance", "seconds": self._draw.choice(SECONDS)}
        return {"event": {"s": "behaviorSucceeded", "f": "behaviorFailed", "d": "disconnect", "c": "connect"}[what]}

    def _text(self) -> str:
        header = {"channel": "mission", "proto": str(signed(TYPE_IDS[TextProto]))}
        return json.dumps({"header": header, "payload": {"text": "hello"}})

    def _mission(self) -> Any:
        """A mission, which may be one that came before, or lack something, or have something too much."""
        self._missions += 1
        number = self._missions if self._draw.random() < 0.8 else self._draw.randrange(1, self._missions + 1)
        header: dict[str, Any] = {"channel": "mission", "pubtime": "1", "acqtime": "1", "proto": str(MISSION)}
        header["uuid"] = {"lower": str(self._missions), "upper": "77"}
        text = self._draw.choice((*CONFIGS, *["{}"] * 8))
        payload: dict[str, Any] = {"uuid": {"lower": str(number), "upper": "7"}, "config": {"serialized": text}}
        odd = self._draw.random()
        changes: tuple[tuple[float, Any, Any], ...] = (
            (0.04, payload, {"uuid": None}),
            (0.08, payload, {"uuid": {"lower": number, "upper": 7}}),
            (0.11, payload, {"config": None}),
            (0.14, payload, {"config": {"serialized": None}}),
            (0.17, payload, {"config": {"serialized": {"a": {"b": {"c": 1}}}}}),
            (0.21, header, {"proto": None}),
            (0.24, header, {"proto": str(unsigned(MISSION))}),
            (0.27, header, {"seq": 5}),
        )
        part, change = next(((part, change) for below, part, change in changes if odd < below), (header, {}))
        part |= change
        return {
            "header": {key: value for key, value in header.items() if value is not None},
            "payload": {key: value for key, value in payload.items() if value is not None},
        }


def _lived(seed: int) -> tuple[tuple[str, ...], list[Any]]:
    draw = random.Random(seed)
    chosen = tuple(draw.sample(NAMES, draw.choice((2, 2, 3))))
    options = (option for name in chosen for option in ("--choice", name))
    with closing(Child((sys.executable, "robot.py", *options), folder=str(FOLDER))) as subject:
        return chosen, Life(subject, draw).lead()


@pytest.mark.parametrize("seed", range(24))
def test_choices_of_a_robot_are_accepted_together(seed: int) -> None:
    """A robot may make several choices at once."""
    chosen, lines = _lived(seed)
    assert check(ROBOT, Head("isaac.robot", {}, DRIVES), lines).conforms, chosen


@pytest.mark.long
@pytest.mark.parametrize("seed", range(24, 324))
def test_choices_of_a_robot_are_accepted_together_whatever_they_are(seed: int) -> None:
    """A robot may make any of its choices at once."""
    chosen, lines = _lived(seed)
    assert check(ROBOT, Head("isaac.robot", {}, DRIVES), lines).conforms, chosen


def test_a_fault_of_a_robot_is_noticed_on_such_lives() -> None:
    """Lives like these are not accepted whatever the robot does."""
    noticed = 0
    for seed in range(8):
        draw = random.Random(seed)
        with closing(Child((sys.executable, "robot.py", "--bug", "final-missing"), folder=str(FOLDER))) as subject:
            lines = Life(subject, draw).lead()
        noticed += not check(ROBOT, Head("isaac.robot", {}, DRIVES), lines).conforms
    assert noticed
