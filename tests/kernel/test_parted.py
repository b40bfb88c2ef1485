"""A belief for each part of a system, against one belief for all of it."""

from __future__ import annotations

import itertools
from typing import Any

import pytest
from attrs import evolve
from toys import QUESTIONS, Refs, Request, spec

from missionfsm.kernel.history import Answer, Called, Event, Returned
from missionfsm.kernel.readings import UNCONSTRAINED
from missionfsm.kernel.rules import OK
from missionfsm.kernel.spec import Parting
from missionfsm.kernel.step import Step
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.parted import Parted
from missionfsm.oracle.transcript import Transcript
from missionfsm.systems import system

FIRST, SECOND = QUESTIONS[:2]
PAIRS = {"equal": ("aa", "bb"), "crossed": ("ab", "ba"), "a": ("aa", "ab"), "b": ("ba", "bb")}


def _answers(state: int, request: Request, _: Refs) -> tuple[Step, ...]:
    return tuple(
        Step(state, answer=Answer(OK), assumes=(FIRST[first], SECOND[second])) for first, second in PAIRS[request[1]]
    )


TOY = evolve(
    spec("pairs", int, _answers, ambiguities=(FIRST, SECOND)),
    parting=Parting(
        lambda _, __: ("left", "right"),
        lambda whole, _: whole,
        lambda event: event.request[0] if isinstance(event, Called) else None,  # type: ignore[index]  # a toy's request
    ),
)
"""``(part, which)``: the answer assumes one of some pairs of readings."""


def asked(*requests: tuple[str, str]) -> list[Event]:
    """Requests that are all answered."""
    events: list[Event] = []
    for number, request in enumerate(requests):
        events += [Called(number, request), Returned(number, Answer(OK))]
    return events


@pytest.mark.parametrize(
    ("requests", "parted", "whole"),
    [
        ([("left", "a"), ("right", "a")], True, True),
        ([("left", "a"), ("right", "b")], False, False),
        ([("left", "equal"), ("left", "crossed")], False, False),
        ([("left", "equal"), ("right", "crossed")], True, False),
    ],
    ids=["agreeing", "contradicting", "contradicting in one part", "contradicting in no single question"],
)
def test_parts_follow_the_same_readings(requests: list[tuple[str, str]], *, parted: bool, whole: bool) -> None:
    """A reading that one part rules out is ruled out for all; only ties between two questions are lost."""
    beliefs = (Parted(TOY, 0, (), UNCONSTRAINED, 1000), Belief(Automaton(TOY), 0))
    found = tuple(all(belief.observe(event) for event in asked(*requests)) for belief in beliefs)
    assert found == (parted, whole)


def _battery(robot: str, percent: int, number: int) -> dict[str, Any]:
    battery = {"chargePercent": percent, "state": "STATE_DISCHARGING", "chargeMethod": "CHARGE_METHOD_NONE"}
    metadata = {"timestamp": "2025-04-01T17:05:00Z", "sequenceNumber": number}
    return {"stream": 1, "message": {"metadata": metadata, "robotId": robot, "batteryState": battery}}


def _report(robot: str, percent: int) -> dict[str, Any]:
    value = {"chargePercent": percent, "state": "STATE_DISCHARGING", "chargeMethod": "CHARGE_METHOD_NONE"}
    return {"drive": {"event": "report", "robotId": robot, "part": "battery", "value": value}}


LINES = [
    _battery("r1", 75, 1),
    _battery("r2", 75, 1),
    _battery("r2", 74, 2),
    _battery("nobody", 75, 1),
    _report("r1", 74),
    _report("r2", 74),
    {"settled": True},
    {"stream": 1, "closed": True, "error": {"status": "INTERNAL"}},
]


@pytest.mark.parametrize("driven", [(), ("report",)], ids=["undriven", "driven"])
def test_a_fleet_is_judged_robot_by_robot(driven: tuple[str, ...]) -> None:
    """Whatever comes after a subscription, the beliefs of the robots explain it exactly where one belief does."""
    found = system("bear.status")
    robots = [{"robotId": name, "locationId": "L1", "state": _report(name, 75)["drive"]} for name in ("r1", "r2")]
    for robot in robots:
        robot["state"] = {"battery": robot["state"]["value"]}
    world = found.codec.read_world({"robots": robots, "locations": [{"locationId": "L1"}]})
    start = [
        {
            "call": 1,
            "method": "SubscribeBatteryStatus",
            "params": {"selector": {"robotIds": {"ids": ["r1", "r2"]}}},
        },
        {"return": 1, "result": {"stream": 1}},
    ]
    for lines in itertools.product(LINES, repeat=3):
        transcript = Transcript(found.codec)
        events = [event for line in (*start, *lines) for event in transcript.read(line)]
        parted = Parted(found.spec, world, driven, UNCONSTRAINED, 20_000)
        whole = Belief(_automaton(driven), world)
        explained = [(parted.observe(event), whole.observe(event)) for event in events]
        assert [one for one, _ in explained] == [other for _, other in explained], lines


_MADE: dict[tuple[str, ...], Automaton] = {}


def _automaton(driven: tuple[str, ...]) -> Automaton:
    return _MADE.setdefault(driven, Automaton(system("bear.status").spec, driven))
