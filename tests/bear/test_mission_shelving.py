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
from missionfsm.oracle import belief
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.check.verdict import Outcome, Verdict


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


def _judged(system: System, first: Any, lines: list[Any]) -> Verdict:
    judge = Judge(system, head(first))
    for line in lines:
        if not judge.feed(line):
            break
    return judge.verdict()


@pytest.mark.parametrize("strict", [True, False], ids=["strict", "over a transport"])
@pytest.mark.parametrize(("drives", "seeds"), [(True, 8), (False, 2)], ids=["driven", "not driven"])
def test_verdicts_are_the_same_where_missions_are_put_away(
    monkeypatch: pytest.MonkeyPatch, seeds: int, *, drives: bool, strict: bool
) -> None:
    """A verdict, with all that it says, is that of a judge that puts nothing away; also where something is wrong."""
    system = judged_system("bear.mission", strict=strict)
    whole = evolve(system, spec=evolve(system.spec, shelving=None, decided=None))
    put_away = evolve(system, spec=evolve(system.spec, decided=None))
    outcomes = set()
    for seed in range(seeds):
        random = Random(seed)
        log = _unwatched(seed, 25, drives=drives)
        for lines in (log.lines, *(_spoiled(log.lines, random) for _ in range(3))):
            monkeypatch.setattr(belief, "LEAST", 1 + seed % 3)
            found, expected = _judged(put_away, log.head, lines), _judged(whole, log.head, lines)
            assert found.to_json() == expected.to_json(), seed
            outcomes.add(found.outcome)
    assert Outcome.CONFORMS in outcomes
    assert Outcome.VIOLATES in outcomes
