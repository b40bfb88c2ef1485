"""Missions that have ended are put away while nobody watches, and nothing is judged otherwise for that."""

from __future__ import annotations

import copy
import sys
from pathlib import Path
from random import Random
from typing import Any

import pytest
from attrs import evolve

sys.path.insert(0, str(Path(__file__).parents[1]))
from traffic import COMMANDS, DRIVES, SUBSCRIBE, Recorder, delivery, navigate

from missionfsm.app.asked import judged_system
from missionfsm.kernel.system import System
from missionfsm.oracle import belief, shelf
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.verdict import Outcome


def test_a_list_that_is_never_cleared_stays_small() -> None:
    """However many missions have ended, what is known of them is as much as of one, while nobody watches."""
    system = judged_system("bear.mission", strict=False)
    log = Recorder()
    judge = Judge(system, head(log.head))
    widths = []
    for _ in range(2 * belief.LEAST):
        log.call("CreateMission", navigate("table-1"))
        log.drive(event="goalReached")
        assert all(map(judge.feed, log.lines))
        log.lines.clear()
        widths.append(judge.belief.node.width)
    assert max(widths) <= belief.LEAST + 2
    assert widths[-1] <= 2
    log.call(SUBSCRIBE)
    assert all(map(judge.feed, log.lines))
    assert judge.belief.node.width > 2 * belief.LEAST


def _unwatched(seed: int, steps: int, *, drives: bool) -> Recorder:
    """A client that seldom watches, and hardly ever clears the list."""
    random = Random(seed)
    log = Recorder(drives=drives)
    for _ in range(steps):
        what = random.randrange(16)
        if what < 5:
            log.call(random.choice(("CreateMission", "CreateMission", "AppendMission")), navigate("table-1"))
        elif what == 5:
            log.call("AppendMission", delivery("table-1", "table-2"))
        elif what < 8 and log.missions:
            one = random.choice((log.missions[-1], random.choice(log.missions)))
            log.call("UpdateMission", {"missionCommand": {"missionId": one, "command": random.choice(COMMANDS)}})
        elif what == 8 and random.random() < 0.3:
            log.call(SUBSCRIBE)
            log.call("cancel", {"stream": log.streams[-1]})
        elif what == 9 and random.random() < 0.2:
            log.call("ClearMissionStatus")
        elif what == 10 and drives:
            log.settle()
        else:
            log.drive(event=random.choice(DRIVES))
    log.call(SUBSCRIBE)
    log.settle()
    return log


def _spoiled(lines: list[Any], random: Random) -> list[Any]:
    """The lines with something else in one of them."""
    lines = copy.deepcopy(lines)
    streams = {one["call"] for one in lines if one.get("method") in (SUBSCRIBE, "cancel")}
    answers = [one for one in lines if "return" in one and one["return"] not in streams]
    messages = [one["message"]["missionStates"]["missions"] for one in lines if "message" in one]
    what = random.randrange(5)
    if what == 0:
        one, other = random.sample(answers, 2)
        number = one["return"]
        one.clear()
        one |= copy.deepcopy(other) | {"return": number}
    elif what == 1:
        one = random.choice([one for one in answers if one.get("result", {}).get("missionId")])
        one["result"] = copy.deepcopy(random.choice([one for one in answers if one.get("result")])["result"])
    elif what == 2 and messages[-1]:
        random.choice(messages[-1])["state"] = random.choice(("STATE_FAILED", "STATE_CANCELED", "STATE_SUCCEEDED"))
    elif what == 3 and messages[-1]:
        messages[-1].pop(random.randrange(len(messages[-1])))
    else:
        lines.remove(random.choice([one for one in lines if "call" not in one]))
    return lines


def _judged(system: System, first: Any, lines: list[Any]) -> Judge:
    judge = Judge(system, head(first))
    for line in lines:
        if not judge.feed(line):
            break
    judge.verdict()
    return judge


@pytest.mark.parametrize("strict", [True, False], ids=["strict", "over a transport"])
@pytest.mark.parametrize(("drives", "seeds"), [(True, range(8)), (False, range(4, 6))], ids=["driven", "not driven"])
def test_verdicts_are_the_same_where_missions_are_put_away(
    monkeypatch: pytest.MonkeyPatch, seeds: range, *, drives: bool, strict: bool
) -> None:
    """A verdict, with all that it says, is that of a judge that puts nothing away; also where something is wrong."""
    system = judged_system("bear.mission", strict=strict)
    whole = evolve(system, spec=evolve(system.spec, shelving=None, decided=None))
    put_away = evolve(system, spec=evolve(system.spec, decided=None))
    outcomes, searched = set(), False
    for seed in seeds:
        random = Random(seed)
        log = _unwatched(seed, 25 if drives else 40, drives=drives)
        for lines in (log.lines, *(_spoiled(log.lines, random) for _ in range(3 if drives else 1))):
            for module, name in ((belief, "LEAST"), (shelf, "LEAST"), (shelf, "MORE")):
                monkeypatch.setattr(module, name, 2 + seed % 3)
            found, expected = _judged(put_away, log.head, lines), _judged(whole, log.head, lines)
            assert found.verdict().to_json() == expected.verdict().to_json(), seed
            outcomes.add(found.verdict().outcome)
            searched = searched or found.held_back
    assert Outcome.CONFORMS in outcomes
    assert searched or drives


def test_missions_that_nobody_sees_end_are_put_away_in_a_search() -> None:
    """Each mission has succeeded or failed before the next one is created, nobody saw how, and then somebody looks."""
    log = Recorder(drives=False)
    for number in range(3 * belief.LEAST):
        log.call("CreateMission", navigate("table-1"))
        log.drive(event="goalReached" if number % 3 else "missionFailed")
        if number == 2 * belief.LEAST:
            log.call(SUBSCRIBE)
            log.call("cancel", {"stream": log.streams[-1]})
    named = log.missions[3]
    log.call("UpdateMission", {"missionCommand": {"missionId": named, "command": "COMMAND_CANCEL"}})
    log.call(SUBSCRIBE)
    system = judged_system("bear.mission", strict=False)
    right = _judged(system, log.head, log.lines)
    assert right.held_back
    assert right.verdict().outcome is Outcome.CONFORMS
    missions = log.lines[-1]["message"]["missionStates"]["missions"]
    missions[3]["goals"] = [{"destinationId": "table-2"}]
    assert _judged(system, log.head, log.lines).verdict().outcome is Outcome.VIOLATES
