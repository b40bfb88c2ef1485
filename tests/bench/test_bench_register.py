"""How fast histories of the register of the kernel's tests are decided, beside Porcupine: calls that overlap.

    MISSIONFSM_PORCUPINE=PROGRAM pytest -o addopts= tests/bench/test_bench_register.py -s

`PROGRAM` is built apart from Porcupine, with a model of that register that begins at 0. It reads a history from stdin,
JSON Lines in the order of events: ``{"call": 7, "request": ["write", 1]}`` (or ``["read"]``, ``["swap", old, new]``)
and ``{"return": 7, "answer": …}`` (None, the value read, or whether it was swapped); a call without a return was lost.
It prints, five times, its verdict (``Ok``, ``Illegal`` or ``Unknown``) and the seconds that it took; reading the
history is not counted on either side. Without the variable only our own seconds are printed.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from pathlib import Path
from random import Random
from typing import Any

import orjson
import pytest
from attrs import define, frozen

sys.path.insert(0, str(Path(__file__).parents[1] / "kernel"))
from toys import REGISTER

from missionfsm.kernel.history import Answer, Called, Event, Returned
from missionfsm.kernel.rules import OK
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.successors import ExhaustedError
from missionfsm.tools.check.held import Held, HeldEvent
from missionfsm.tools.check.judge import PATIENCE

PROGRAM = os.environ.get("MISSIONFSM_PORCUPINE")
VALUES = 5


@frozen
class Load:
    """What a history is made of: clients, calls, how many are in flight, how many are lost, whether a read is wrong."""

    clients: int
    calls: int
    in_flight: float
    lost: int = 0
    wrong: bool = False


@define
class _Call:
    """A call on its way, and its answer once it has taken effect."""

    number: int
    request: tuple[Any, ...]
    done: bool = False
    answer: Any = None


def _request(random: Random) -> tuple[Any, ...]:
    kind = random.random()
    if kind < 0.3:
        return ("write", random.randrange(VALUES))
    if kind < 0.6:
        return ("swap", random.randrange(VALUES), random.randrange(VALUES))
    return ("read",)


def _took_effect(value: int, call: _Call) -> int:
    """The register after a call."""
    call.done = True
    match call.request:
        case ("write", new):
            return int(new)
        case ("swap", old, new):
            call.answer = value == old
            return int(new) if value == old else value
        case _:
            call.answer = value
            return value


def history(load: Load, seed: int = 1) -> list[Event]:
    """Calls that take effect at some moment between when they are sent and answered."""
    random = Random(seed)
    lost = set(random.sample(range(load.calls), load.lost))
    events: list[Event] = []
    waiting: list[_Call] = []
    value = sent = 0
    while sent < load.calls or waiting:
        if len(waiting) < min(load.clients, load.in_flight + random.random() - 0.5) and sent < load.calls:
            call = _Call(sent, _request(random))
            events.append(Called(("call", sent), call.request, lost=sent in lost))
            waiting.append(call)
            sent += 1
            continue
        call = random.choice(waiting)
        if call.done:
            waiting.remove(call)
            if call.number not in lost:
                events.append(Returned(("call", call.number), Answer(OK, call.answer)))
        else:
            value = _took_effect(value, call)
    if load.wrong:
        reads = [at for at, one in enumerate(events) if type(one) is Returned and type(one.answer.shape) is int]
        events[reads[-1]] = Returned(events[reads[-1]].call, Answer(OK, VALUES))  # type: ignore[union-attr]
    return events


def verdict(events: list[Event]) -> str:
    """What comes of a history, judged as ``check`` judges one: what is too dear waits for what follows."""
    automaton = Automaton(REGISTER, budget=PATIENCE)
    automaton.successors.live = False
    belief = Belief(automaton, 0)
    held: Held | None = None
    try:
        for at, event in enumerate(events):
            if held is None:
                try:
                    if not belief.observe(event):
                        return "Illegal"
                    continue
                except ExhaustedError:
                    held = Held(belief)
            held.add(HeldEvent(event, None, at, at, open_calls=False))
            if held.due:
                explained = held.explain(whole=False)
                if not explained.whole:
                    return "Illegal"
                if explained.exact:
                    held = None
                else:
                    held.wait()
        return "Ok" if held is None or held.explain(whole=True).whole else "Illegal"
    except ExhaustedError:
        return "Unknown"


def ours(events: list[Event]) -> tuple[str, float]:
    """Our verdict, and the median of five times that it takes, in seconds."""
    took = []
    for _ in range(5):
        began = time.process_time()
        found = verdict(events)
        took.append(time.process_time() - began)
    return found, statistics.median(took)


def line(event: Any) -> Any:
    """An event as the program reads it."""
    _, number = event.call
    if type(event) is Called:
        return {"call": number, "request": event.request}
    return {"return": number, "answer": event.answer.shape}


def theirs(program: str, events: list[Event]) -> tuple[str, float]:
    """The program's verdict, and the median of what it took, in seconds."""
    text = b"".join(orjson.dumps(line(event)) + b"\n" for event in events)
    out = subprocess.run([program], input=text, capture_output=True, check=True).stdout.decode()
    rounds = [said.split() for said in out.splitlines()]
    return rounds[0][0], statistics.median(float(seconds) for _, seconds in rounds)


LOADS = {
    "6 clients x 200 calls, 4.7 in flight": Load(6, 1_200, 4.7),
    "the same, the last read impossible": Load(6, 1_200, 4.7, wrong=True),
    "6 clients x 200 calls, 2.8 in flight": Load(6, 1_200, 2.8),
    "12 of 200 calls lost, 4.4 in flight": Load(6, 200, 4.4, lost=12),
    "the same, the last read impossible, 12 lost": Load(6, 200, 4.4, lost=12, wrong=True),
    "one client, 20 of 200 lost, the last read impossible": Load(1, 200, 1, lost=20, wrong=True),
}


@pytest.mark.parametrize("name", LOADS)
def test_bench_register(name: str) -> None:
    """A history of a register: our verdict and seconds, and those of the program."""
    events = history(LOADS[name])
    found, seconds = ours(events)
    said = f"\n{name}: {found} in {seconds * 1e3:.1f} ms"
    if PROGRAM:
        other, took = theirs(PROGRAM, events)
        said += f"; Porcupine {other} in {took * 1e3:.1f} ms, {seconds / took:.1f} times that here"
        assert "Unknown" in (found, other) or found == other
    print(said)
