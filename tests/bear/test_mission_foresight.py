"""What later messages tell of a robot: never that it cannot be what it was."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

import orjson
import pytest
from attrs import evolve
from busy import Habits, busy
from traffic import readings_at_random

from missionfsm.app import perrobot
from missionfsm.app.recorded import check_file
from missionfsm.bear.mission.foresight import foresees, succeeds
from missionfsm.bear.mission.state import Robot
from missionfsm.bear.mission.views import Listing, listing
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.readings import choose
from missionfsm.kernel.rules import OK
from missionfsm.kernel.step import Emission, Step
from missionfsm.oracle import window
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.explore.explore import Actions, bindings, steps

MISSION = system("bear.mission")
SPEC = MISSION.spec
ALPHABET = MISSION.alphabet({}, Bounds(3, goals=2, batch=2))
LABELS = Actions.from_alphabet(MISSION, ALPHABET.core_inputs, ALPHABET.core_drives)
Named = tuple[Any, tuple[int, ...]]
"""A robot, or what is seen of it, with the names of its missions; no two missions ever have the same."""


def lives(random: Random, length: int) -> Iterator[tuple[Named, list[Named], frozenset[str]]]:
    """Robots after one another, by whatever steps under whatever readings, what each makes seen, and by which call."""
    robot: Robot = SPEC.initial(MISSION.codec.read_world(random.choice(ALPHABET.worlds)))
    names: tuple[int, ...] = ()
    minted = 0
    for _ in range(length):
        found = [one for one in steps(SPEC, robot, LABELS) if one.step.after is not robot]
        # What clears the list comes up less often, so that lists grow.
        growing = [one for one in found if SPEC.names(one.step.after) >= len(names)]
        taken = random.choice(growing if growing and random.random() < 0.8 else found)
        step: Step = taken.step
        called = frozenset([SPEC.request_operation(taken.what)] if step.answer is not None else [])
        highest = max((*(step.names or ()), len(names) - 1))
        pool = [*names, *range(minted, minted + highest + 1 - len(names))]
        minted += highest + 1 - len(names)
        names = names if step.names is None else tuple(pool[ref] for ref in step.names)
        robot = step.after
        seen = [(one.view, names if one.refs is None else tuple(pool[ref] for ref in one.refs)) for one in step.emits]
        yield (robot, names), [*seen, (listing(robot), robot.listed(names))], called


def successes(robot: Robot, names: tuple[int, ...]) -> Iterator[tuple[Any, tuple[int, ...], tuple[int, ...]]]:
    """The requests that are answered OK in a state, each with its names and those of the answer."""
    for request, free in LABELS.requests:
        for refs in bindings(SPEC, robot, free):
            known = tuple(names[ref] for ref in refs if ref is not None and ref >= 0)
            for step in SPEC.outcomes(robot, request, refs) if len(known) == len(refs) else ():
                if step.answer is not None and step.answer.code == OK and not step.opens:
                    pool = [*names, *range(10_000, 10_100)]
                    yield request, known, tuple(pool[ref] for ref in step.refs)


def content(view: Listing, choice: int) -> Any:
    """The content of the message that shows a view under some readings."""
    missions = [f"m{number}" for number in range(len(view.missions))]
    message = MISSION.codec.write_message(view, tuple(missions), choice, 1, 0.0)
    return MISSION.codec.read_content(next(iter(MISSION.codec.split_message(message)))[2])


@pytest.mark.parametrize("seed", range(8))
def test_what_comes_to_be_shown_is_foreseen(seed: int) -> None:
    """A robot foresees every message of its future by the calls in between, whichever names were not seen yet."""
    random = Random(seed)
    choice = choose(SPEC.ambiguities, readings_at_random(seed))
    past: list[tuple[Robot, tuple[int, ...], frozenset[str]]] = []
    for here, seen, called in lives(random, 40):
        past = [(robot, names, calls | called) for robot, names, calls in past]
        for view, shown in seen:
            message = content(view, choice)
            for robot, names, calls in past:
                known = tuple(-2 - at if random.random() < 0.2 else name for at, name in enumerate(names))
                assert foresees(robot, known, message, shown, calls), (robot, known, view, shown, calls)
        past.append((*here, frozenset()))


CALLS = frozenset({"AppendMission", "SkipGoal", "ClearMissionStatus"})


@pytest.mark.parametrize("seed", range(4))
def test_what_comes_to_succeed_is_foreseen(seed: int) -> None:
    """A robot foresees every call that succeeds in its future, with the names of its answer."""
    random = Random(seed)
    past: list[Named] = []
    for (robot, names), *_ in lives(random, 25):
        past.append((robot, names))
        for request, args, answered in successes(robot, names):
            for before, known in past:
                assert succeeds(before, known, request, args, answered), (before, known, request, args, answered)


def test_what_cannot_succeed_any_more_is_not_foreseen() -> None:
    """No call makes a mission that is listed already, or skips or moves one that has ended."""
    _, robot = _queue()
    made, skipped, cleared = (
        MISSION.codec.read_request(method, {}) for method in ("AppendMission", "SkipGoal", "ClearMissionStatus")
    )
    assert [succeeds(robot, (0, 1, 2), made, (), (name,)) for name in (1, 3)] == [False, True]
    assert [succeeds(robot, (0, 1, 2), skipped, (), (name,)) for name in (0, 1, 3)] == [False, True, True]
    possible = [succeeds(robot, (0, 1, 2), cleared, (), names) for names in ((0,), (0, 1), (0, 3), (3,), (0, 2))]
    assert possible == [True, True, True, True, False]


def test_whoever_clears_missions_clears_all_that_have_ended() -> None:
    """Where one mission that has ended is cleared all others that have are, those too whose names nobody has seen."""
    kind, robot = _queue()
    (ended,) = robot.done
    both = evolve(robot, done=(ended, ended), pending=(kind,))
    cleared = MISSION.codec.read_request("ClearMissionStatus", {})
    cases = {((0, 1, 2), (0,)): False, ((0, 1, 2), (1, 0)): True, ((0, -2, 2), (0,)): False, ((0, -2, 2), (0, 5)): True}
    assert {case: succeeds(both, case[0], cleared, (), case[1]) for case in cases} == cases


def goes_on(robot: Robot) -> list[Any]:
    """What can be done in a state, step by step: what it is, what is answered, and what the state after it counts."""
    forgets = SPEC.abstraction.forget_ended
    assert forgets is not None
    return [
        (one.what, one.step.answer, one.step.refs, one.step.names, one.step.assumes, forgets(one.step.after))
        for one in steps(SPEC, robot, LABELS)
    ]


@pytest.mark.parametrize("seed", range(4))
def test_what_has_ended_only_counts(seed: int) -> None:
    """Whatever the missions were that have ended, all calls and events go on in the same ways."""
    random = Random(seed)
    forgets = SPEC.abstraction.forget_ended
    assert forgets is not None
    for (robot, _), *_ in lives(random, 25):
        assert goes_on(robot) == goes_on(forgets(robot))


@pytest.mark.parametrize("seed", range(4))
def test_where_a_mission_has_ended_nobody_can_tell(seed: int) -> None:
    """Without the goal at which a mission has ended, all goes on in the same ways, and the same messages show it."""
    random = Random(seed)
    choice = choose(SPEC.ambiguities, readings_at_random(seed))
    indistinct = SPEC.abstraction.indistinct
    assert indistinct is not None
    for (robot, _), *_ in lives(random, 25):
        done = tuple(evolve(one, goal=random.randrange(-1, len(one.goals) + 1)) for one in robot.done)
        ended = evolve(robot, done=done)
        alike = indistinct(Step(ended, emits=(Emission("status", listing(ended)),)))
        shown = content(listing(ended), choice)
        assert (alike.after, goes_on(alike.after)) == (indistinct(Step(robot)).after, goes_on(ended))
        assert indistinct(alike) is alike
        assert SPEC.matches(alike.emits[0].view, shown) == SPEC.matches(listing(ended), shown)


ORDERS = {
    "another comes before one that has started": (("B", "A"), False),
    "one that waits has vanished though nothing failed": (("A", "C"), False),
    "those that wait have changed places": (("A", "C", "B"), False),
    "what has ended is forgotten": (("B", "C", "D"), True),
    "everything is forgotten": ((), True),
    "what is new comes last": (("A", "B", "C", "D"), True),
}


@pytest.mark.parametrize("case", ORDERS)
def test_missions_keep_their_order(case: str) -> None:
    """Of a robot with one mission that has ended and two that wait, no message is foreseen that changes their order."""
    shown, possible = ORDERS[case]
    numbers = {"A": 0, "B": 1, "C": 2, "D": 3}
    kind, running = _queue()
    missions = tuple(kind for _ in shown)
    message = content(Listing(missions, None, running.world.family), choose(SPEC.ambiguities))
    ended = evolve(kind, state=running.done[0].state)
    first = content(
        Listing((ended, *missions[1:]) if shown[:1] == ("A",) else missions, None, running.world.family),
        choose(SPEC.ambiguities),
    )
    message = first if shown[:1] == ("A",) else message
    assert foresees(running, (0, 1, 2), message, tuple(numbers[name] for name in shown), CALLS) == possible


@pytest.mark.parametrize(
    ("shown", "possible"),
    [((0, 1, 2), True), ((0, 2, 1), False), ((0, 1), False), ((1, 2), False), ((0, 2), True), ((5, 1, 2), False)],
)
def test_missions_out_of_their_turns_keep_their_places(shown: tuple[int, ...], *, possible: bool) -> None:
    """Where a mission has overtaken one that waits, all that have started stay listed, in the order of their coming.

    The second of three missions waits, and may vanish; the third has run before it and has ended as well.
    """
    kind, robot = _queue()
    (ended,) = robot.done
    overtaken = evolve(robot, done=(ended, ended), pending=(kind,), assigned=(0, 2, 1))
    states = {0: ended, 1: kind, 2: ended, 5: ended}
    view = Listing(tuple(states[name] for name in shown), None, robot.world.family)
    message = content(view, choose(SPEC.ambiguities))
    assert foresees(overtaken, (0, 2, 1), message, shown, CALLS - {"ClearMissionStatus"}) == possible


def _queue() -> tuple[Any, Robot]:
    """A mission that waits, and a robot with one that has succeeded before two of them."""
    robot: Robot = SPEC.initial(MISSION.codec.read_world({}))
    params = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
    _, rest = MISSION.codec.split_request("CreateMission", params)
    request = MISSION.codec.read_request("CreateMission", rest)
    created = next(step.after for step in SPEC.outcomes(robot, request, ()) if step.after.pending)
    (mission,) = created.pending
    ended = mission.moved("start").moved("succeed")
    return mission, evolve(created, done=(ended,), pending=(mission, mission))


def judged(path: Path, lines: list[Any]) -> Verdict:
    path.write_bytes(b"".join(orjson.dumps(line) + b"\n" for line in lines))
    ((_, verdict),) = check_file(str(path))
    return verdict


def disordered(lines: list[Any]) -> list[Any]:
    """The log with the last list of several missions turned round."""
    wrong = copy.deepcopy(lines)
    lists = [line["message"]["missionStates"]["missions"] for line in wrong if "message" in line]
    next((one for one in reversed(lists) if len(one) > 1), []).reverse()
    return wrong


@pytest.mark.parametrize("seed", [pytest.param(0, marks=pytest.mark.long), *range(1, 5)])
def test_foresight_changes_no_verdict(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """Small logs, right ones and such with a list that is turned round, are judged alike where nothing is foreseen."""
    right = busy(seed, 26, Habits(clients=2), readings_at_random(seed) if seed % 2 else None)
    wrong = disordered(right)
    monkeypatch.setattr(window, "WINDOW_BUDGET", 1_500)
    led = [judged(tmp_path / "log", lines) for lines in (right, wrong)]
    as_it_is = perrobot.judged_system

    def blind(*name: Any, **how: Any) -> Any:
        found = as_it_is(*name, **how)
        remembering = evolve(found.spec.abstraction, forget_ended=None)
        blinded = evolve(found.spec, foresees=None, succeeds=None, decided=None, abstraction=remembering)
        return evolve(found, spec=blinded)

    monkeypatch.setattr(perrobot, "judged_system", blind)
    for lines, verdict in zip((right, wrong), led, strict=True):
        other = judged(tmp_path / "log", lines)
        if other.outcome.value != "inconclusive":
            assert (verdict.outcome, verdict.events) == (other.outcome, other.events)
