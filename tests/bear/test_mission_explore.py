"""The graph of the mission API: how many states it has, what can be forgotten of them, which rules fire."""

from __future__ import annotations

import pytest
from attrs import evolve

from missionfsm.bear.mission.compiled import forget_ended
from missionfsm.bear.mission.readings.scope import FIELDLESS
from missionfsm.bear.mission.state import Robot
from missionfsm.kernel.alphabet import Bounds, Input
from missionfsm.kernel.readings import UNCONSTRAINED, choose
from missionfsm.kernel.spec import Invariant
from missionfsm.systems import system
from missionfsm.tools.explore.explore import Actions, Reached, explore, firings, reachable, steps

MISSION = system("bear.mission")
SPEC = MISSION.spec
DEFAULT = choose(SPEC.ambiguities)
WORLDS = MISSION.alphabet({}, Bounds()).worlds
READINGS = pytest.mark.parametrize("assumed", [DEFAULT, UNCONSTRAINED], ids=["default readings", "all readings"])


def actions(bounds: Bounds, world: object = None) -> Actions:
    alphabet = MISSION.alphabet(world or {}, bounds)
    return Actions.from_alphabet(MISSION, alphabet.core_inputs, alphabet.core_drives)


def graph(bounds: Bounds, assumed: int, *, forgetting: bool = False) -> Reached:
    start = SPEC.initial(MISSION.codec.read_world({}))
    return reachable(SPEC, start, actions(bounds), bounds.size, assumed, forget_ended=forgetting)


@pytest.mark.parametrize(
    ("assumed", "missions", "states", "situations", "depth"),
    [
        pytest.param(DEFAULT, 3, 12_720, 83, 12, id="default readings"),
        pytest.param(UNCONSTRAINED, 2, 16_384, 378, 13, id="all readings", marks=pytest.mark.long),
    ],
)
def test_some_missions_and_two_goals(assumed: int, missions: int, states: int, situations: int, depth: int) -> None:
    """Some missions of two goals make so many states; every invariant holds and every possibility is met."""
    found = explore(MISSION, Bounds(missions, goals=2, batch=2), assumed=assumed)
    assert (found.states, found.situations, found.depth) == (states, situations, depth)
    assert (found.counterexample, found.unmet) == (None, ())


def test_the_steps_of_two_missions_are_counted() -> None:
    """Under the default readings two missions of one goal make so many states, and so many answers of each kind."""
    found = explore(MISSION, Bounds(2, goals=1, batch=2), assumed=DEFAULT)
    assert (found.states, found.transitions) == (350, 10_342)
    assert found.by_operation == {
        "AppendMission": {"FAILED_PRECONDITION": 6, "OK": 1044},
        "AppendMissionBatch": {"FAILED_PRECONDITION": 2, "OK": 348},
        "ChargeRobot": {"FAILED_PRECONDITION": 192, "OK": 158},
        "ClearMissionStatus": {"FAILED_PRECONDITION": 192, "OK": 158},
        "CreateMission": {"FAILED_PRECONDITION": 576, "OK": 474},
        "CreateMissionBatch": {"FAILED_PRECONDITION": 192, "OK": 158},
        "CreateMissionWorkflow": {"FAILED_PRECONDITION": 192, "OK": 158},
        "SkipGoal": {"FAILED_PRECONDITION": 302, "OK": 48},
        "SubscribeMissionStatus": {"OK": 350},
        "UpdateMission": {"FAILED_PRECONDITION": 1920, "INVALID_ARGUMENT": 2784, "NOT_FOUND": 400, "OK": 384},
    }


@READINGS
def test_what_has_ended_need_only_be_counted(assumed: int) -> None:
    """The graph in which ended missions are only counted is the full one with each robot in its counted place.

    Its states are the counted full ones; and a full robot goes where its counted one goes, and nowhere else.
    """
    bounds = Bounds(2, goals=2, batch=2)
    full, counted = graph(bounds, assumed), graph(bounds, assumed, forgetting=True)
    assert {forget_ended(here) for here in full} == set(counted)
    short = SPEC.abstraction.compiled
    assert short is not None
    tried = actions(bounds)
    events = [event for event, _ in tried.events]
    plain = short(tried.requests, events, assumed, bounds.size)
    forgetting = short(tried.requests, events, assumed, bounds.size, forget_ended=True)

    def after(shortcut: object, here: Robot) -> set[Robot]:
        return {forget_ended(shortcut.decode(one)) for one in shortcut.successors(shortcut.encode(here))}  # type: ignore[attr-defined]

    assert [here for here in full if after(plain, here) != after(forgetting, forget_ended(here))] == []


@READINGS
def test_counting_gives_the_same_graph_step_by_step(assumed: int) -> None:
    """Without the shortcut, counting what has ended reaches the same states."""
    bounds = Bounds(2, goals=1, batch=2)
    slow = evolve(SPEC, abstraction=evolve(SPEC.abstraction, compiled=None))
    start = SPEC.initial(MISSION.codec.read_world({}))
    found = reachable(slow, start, actions(bounds), bounds.size, assumed, forget_ended=True)
    assert set(found) == set(graph(bounds, assumed, forgetting=True))


@pytest.mark.long
def test_six_missions_and_two_goals() -> None:
    """Under the default readings six missions of two goals, the ended ones counted, make 8,696 states."""
    found = explore(MISSION, Bounds(6, goals=2, batch=2), assumed=DEFAULT, forget_ended=True)
    assert (found.states, found.counterexample) == (8_696, None)


def test_a_robot_is_nearest_to_the_first_state_through_its_parent() -> None:
    """What is reached knows a state before it from which a step leads there."""
    bounds = Bounds(2, goals=1, batch=1)
    tried = actions(bounds)
    found = graph(bounds, DEFAULT)
    for here in found:
        if (before := found.before(here)) is not None:
            assert here in {one.step.after for one in steps(SPEC, before, tried)}


@pytest.mark.parametrize("forgetting", [False, True], ids=["in full", "counted"])
def test_a_broken_invariant_has_a_shortest_counterexample(*, forgetting: bool) -> None:
    """An invariant that does not hold is shown with a shortest way to a state in which it does not."""
    never = Invariant("never-two", "Two missions have ended.", lambda robot: len(robot.done) < 2)
    found = explore(MISSION, Bounds(2, goals=1, batch=2), assumed=DEFAULT, invariants=(never,), forget_ended=forgetting)
    assert found.counterexample is not None
    assert not found.holds
    # A batch of two, a start, an end, a start, an end.
    assert len(found.counterexample.path) == 5
    assert "does not hold in [" in str(found.counterexample)


@pytest.mark.long
def test_every_rule_fires_and_rests() -> None:
    """Every refusal is met by some call in some state of some world, and not met by another."""
    bounds = Bounds(2, goals=1, batch=1)
    fires: set[str] = set()
    rests: set[str] = set()
    for world in WORLDS:
        alphabet = MISSION.alphabet(world, bounds)
        start = SPEC.initial(MISSION.codec.read_world(world))
        found = reachable(SPEC, start, actions(bounds, world), bounds.size)
        situations = {SPEC.abstraction.enabled_key(here): here for here in found}
        scripted = [Input(one.method, one.params) for script in alphabet.scripts for one in script if not one.picks]
        asked = {str(one): one for one in scripted if one.method in SPEC.operations}
        everything = Actions.from_alphabet(MISSION, (*alphabet.inputs, *asked.values()), alphabet.drives)
        for rule, (fired, rested) in firings(SPEC, situations.values(), everything, settled=fires & rests).items():
            fires |= {rule} if fired else set()
            rests |= {rule} if rested else set()
    refusals = {rule.id for operation in SPEC.operations.values() for rule in operation.refusals}
    # An object without documented fields cannot be malformed, and a tester sends objects alone.
    never = {
        f"{SPEC.system}/{call}/INVALID_ARGUMENT/the-request-is-malformed"
        for call in (*FIELDLESS, "SubscribeMissionStatus")
    }
    assert refusals - fires == never
    assert refusals - rests == set()
