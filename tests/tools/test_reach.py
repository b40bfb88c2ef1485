"""A run asks everything that matters in every situation, and says where it did not."""

from __future__ import annotations

import itertools
import random

import pytest
from attrs import evolve

from missionfsm.bear.mission.matrix import MATRIX
from missionfsm.bear.status.matrix import OFFLINE, ONE, PLACE, SOME
from missionfsm.bear.status.state import STATE_PARTS, TOPICAL, Endpoint
from missionfsm.isaac.robot.scripts import script
from missionfsm.isaac.server.script import A, B, Script
from missionfsm.systems import names, system
from missionfsm.tools.check.basis import OFTEN, MatrixCoverage
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.plan import FILLS, SCRIPTS, Plan
from missionfsm.tools.conform.reach import Choice
from missionfsm.tools.conform.run import BOUNDS, Run
from missionfsm.tools.conform.tour import fill_gaps, follow, play, written
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION, STATUS = system("bear.mission"), system("bear.status")
SERVER, CODELET = system("isaac.server"), system("isaac.robot")
ONLY_SO = {("carti state", "changes")}
"""What a robot that carries trays does not do: there is one conveyor state to report."""
KINDS = {
    "base": ("base navigate", "base navigate-auto"),
    "servi": (
        *("base navigate", "base navigate-auto", "servi delivery", "servi delivery patrol", "servi bussing"),
        *("servi bussing patrol", "servi navigate", "servi navigate-auto"),
    ),
    "carti": (
        *("base navigate", "base navigate-auto", "carti traverse", "carti traverse patrol", "carti navigate"),
        "carti navigate-auto",
    ),
}
WORKFLOWS = {
    "servi": ("delivery", "delivery patrol", "bussing", "bussing patrol", "birthday", "hosting", "hosting patrol"),
    "carti": ("traverse", "traverse patrol"),
}


def columns() -> set[str]:
    """What the page lets one ask of a robot in any situation, written out."""
    some = {
        *("SubscribeMissionStatus", "ChargeRobot", "ClearMissionStatus", "SkipGoal", "cancel"),
        *(f"{call} changes" for call in ("blocked", "occupied", "charging location", "contact dock", "destinations")),
        *(
            f"{status} {when} its effect"
            for status in ("INTERNAL", "DEADLINE_EXCEEDED")
            for when in ("after", "instead of")
        ),
        *(
            f"CreateMissionWorkflow of {family} {kind} to a {family} robot"
            for family in WORKFLOWS
            for kind in WORKFLOWS[family]
        ),
        *(f"CreateMissionWorkflow with 4 goals to a {family} robot" for family in WORKFLOWS),
        *("CreateMissionWorkflow whose last goal is wrong", "CreateMissionWorkflow with two members in one wrapper"),
    }
    for call in ("CreateMission", "AppendMission"):
        some |= {f"{call} of {kind} to a {family} robot" for family, kinds in KINDS.items() for kind in kinds}
        some |= {f"{call} with 4 goals to a {family} robot" for family in KINDS}
        some |= {f"{call} whose last goal is wrong", f"{call} with two members in one wrapper"}
        some |= {f"{call}Batch of {size}" for size in (1, 2, 3, 4)}
        some |= {f"{call}Batch whose last mission is wrong", f"{call}Batch with two members in one wrapper"}
    return some


@pytest.mark.long
def test_a_run_asks_everything_in_every_situation() -> None:
    """Before anything is toured or drawn every cell is met three times: all that the page lets one ask, everywhere."""
    run = Run.against(MISSION, ReferenceSubject(MISSION))
    assert run.reach is not None
    assert fill_gaps(run, random.Random(1), FILLS, 40)
    assert {cell for cell, times in run.reach.times.items() if times < OFTEN} == set()
    assert set(itertools.product(MATRIX.ways, columns())) - set(run.reach.times) == set()
    assert run.reach.reached() == MatrixCoverage(len(run.reach.times))


def test_what_was_met_too_seldom_is_told() -> None:
    """The rarest come first, the whole list where it is wanted, and situations that never came about."""
    holes = {f"paused × {name}": times for name, times in (("a", 2), ("b", 0), ("c", 1), ("d", 1), ("e", 1), ("f", 1))}
    reached = MatrixCoverage(40, holes, ("cleared",))
    assert reached.lines() == [
        f"situations × actions: 34 of 40 met {OFTEN} times or more",
        "  never came about: cleared",
        "  too seldom: paused × b (0), paused × c (1), paused × d (1), paused × e (1) and 2 more",
    ]
    assert reached.lines(all_names=True)[-1].count("paused") == len(holes)
    assert reached.to_json() == {"cells": 40, "holes": holes, "never": ["cleared"]}


@pytest.mark.long
def test_every_subscription_is_watched_while_everything_changes() -> None:
    """Each subscription to one robot, to several and to a location sees each part that it shows change in every way."""
    run = Run.against(STATUS, ReferenceSubject(STATUS))
    assert run.reach is not None
    assert fill_gaps(run, random.Random(0), FILLS, 40)
    assert {cell for cell, times in run.reach.times.items() if times < OFTEN} == set()
    wholes = {f"{Endpoint.ROBOT.value} to {whom}" for whom in (ONE, SOME, PLACE)}
    parts = {part.replace("_", " ") for part in STATE_PARTS}
    expected = {
        (situation, f"{part} {change}, of a watched robot")
        for situation in wholes
        for part in parts
        for change in ("changes", "is unset")
        if (part, change) not in ONLY_SO
    }
    assert expected - set(run.reach.times) == set()
    expected = {
        (f"{endpoint.value} to {whom}", f"{part.replace('_', ' ')} {change}, of a watched robot{offline}")
        for endpoint, part in TOPICAL.items()
        for whom in (ONE, SOME, PLACE)
        for change in ("changes", "is unset", "comes up", "comes again")
        for offline in ("", OFFLINE)
        if endpoint is not Endpoint.ONLINE
    }
    assert expected - set(run.reach.times) == set()


ANYWHERE = {
    *("statuses", "connect", "a second passes", "submit to no robot in particular", "submit to a robot that is away"),
    *(f"submit with {what}" for what in ("a start_timeout", "a start_timeout of 0", "a timeout", "a timeout of 0")),
    *("submit with channels of its own", "submit after a mission that does not exist"),
    *("disconnect of a connection without a name", "a line that is no message", "a message of another type"),
    *("a message to nobody", "a name", "a name that is empty", "a name on another channel"),
    *("a name with space around it", "a status of a mission that does not exist", "a status of no mission"),
}
"""What one may ask of a mission server in any situation, some robot or other being connected, written out."""
CONFIGURATIONS = ("usable", "null", "blank", "shallow", "odd", "unusable")
WHERE_LINES_COME = {
    *(f"a mission whose configuration is {kind} arrives" for kind in CONFIGURATIONS),
    "a mission whose configuration is usable arrives in numbers",
    "a mission whose configuration is usable arrives on another channel",
    *("a line that is no message", "a message of another type", "disconnect"),
}
"""What may come to a robot that is connected."""
TIMES = {"less than a tick passes", "a tick passes", "RUNNING is due", "a name is due"}
ENDS = {"behaviorSucceeded", "behaviorFailed"}


@pytest.mark.long
def test_a_mission_server_is_asked_everything_in_every_situation() -> None:
    """Missions of every kind, upstreams that stand in every way, statuses and names of all, wherever they can come."""
    run = Run.against(SERVER, ReferenceSubject(SERVER))
    assert run.reach is not None
    assert play(run)
    assert fill_gaps(run, random.Random(1), FILLS, 40)
    assert {cell for cell, times in run.reach.times.items() if times < OFTEN} == set()
    assert SERVER.matrix is not None
    nameless = {"a name that two connections said"}  # three connections there are, and those have names
    lacking = set(itertools.product(set(SERVER.matrix.ways) - nameless, ANYWHERE)) - set(run.reach.times)
    assert lacking == set()
    upstreams = {"QUEUED", "STARTED", "RUNNING", "SUCCESS", "FAILED", "FAILED_TIMEDOUT", "FAILED_UPSTREAM"}
    asked = {
        (f"running{queue}", f"submit after a mission that is {one}")
        for one in upstreams
        for queue in ("", " with a queue")
    }
    assert asked - set(run.reach.times) == {("running", "submit after a mission that is QUEUED")}
    assert run.reach.reached() == MatrixCoverage(len(run.reach.times))


def test_a_robot_is_told_everything_in_every_situation() -> None:
    """Lines of every kind, ends of the tree, times and drops come to a robot that is idle, running and away."""
    run = Run.against(CODELET, ReferenceSubject(CODELET))
    assert run.reach is not None
    assert play(run)  # whether a mission outlives its connection has shown then
    assert fill_gaps(run, random.Random(1), FILLS, 40)
    again = "the mission that runs arrives again"
    assert set(run.reach.times) == {
        *itertools.product(("idle", "idle again", "running"), {*WHERE_LINES_COME, *TIMES, *ENDS}),
        ("running", again),
        *itertools.product(("away", "away on a mission"), {*TIMES, "connect"}),
        *itertools.product(("away on a mission",), ENDS),
    }
    assert run.reach.reached() == MatrixCoverage(len(run.reach.times))


def test_what_is_asked_about_a_name_counts_for_what_bears_it() -> None:
    """What is submitted, said and dropped counts as what it is about: the upstream, the mission, the connection."""
    run = Run.against(SERVER, ReferenceSubject(SERVER))
    assert run.reach is not None
    run.start({})
    assert all(follow(run, step) for step in Script().submit(A).robot(0, A).report(0, 0, "running").lines)
    assert all(follow(run, step) for step in Script().submit(B, 0).drop(0).lines)
    assert run.reach.times == {
        ("nothing submitted", "submit to a robot that is away"): 1,
        ("waiting for the robot", "connect"): 1,
        ("waiting for the robot", "a name"): 1,
        ("sent", "statuses"): 2,
        ("sent", "a second passes"): 1,
        ("sent", "RUNNING of a mission that is STARTED"): 1,
        ("running", "a second passes"): 1,
        ("running", "statuses"): 1,
        ("running", "submit after a mission that is RUNNING"): 1,
        ("running with a queue", "disconnect of a robot that is busy"): 1,
        ("all has ended, no robot", "a second passes"): 1,
        ("all has ended, no robot", "statuses"): 1,
    }


def test_a_mission_that_arrives_again_counts_as_such() -> None:
    """A line with the identifier of the mission that runs is another kind of line than one with a new identifier."""
    run = Run.against(CODELET, ReferenceSubject(CODELET))
    assert run.reach is not None
    run.start({})
    assert all(follow(run, step) for step in script("mission 1s again mission"))
    assert run.reach.times == {
        ("idle", "a mission whose configuration is usable arrives"): 1,
        ("running", "a tick passes"): 1,
        ("running", "the mission that runs arrives again"): 1,
        ("running", "a mission whose configuration is usable arrives"): 1,
    }


def test_a_conversation_is_had_in_the_world_that_it_needs() -> None:
    """A Carti is led round its patrols: what only robots like it run is asked of it, once, and accepted."""
    begun: list[str] = []

    def watch(run: Run) -> None:
        conversation = run.conversation
        if any("traversePatrolMission" in str(action.params) for action in conversation.actions):
            begun.append(conversation.world["family"])
            assert "INVALID_ARGUMENT" not in str(conversation.heard)

    assert play(Run.against(MISSION, ReferenceSubject(MISSION), progress=watch))
    assert begun == ["carti"] * 9


def test_where_a_situation_is_not_sure_time_passes_once() -> None:
    """Of a robot that dropped during a mission nobody knows at first whether it goes on: a run waits, once."""
    run = Run.against(CODELET, ReferenceSubject(CODELET))
    assert run.reach is not None
    run.start({})
    assert all(follow(run, step) for step in script("mission 1s drops"))
    (pause,) = script("1s")
    chosen = run.reach.choose(run.conversation, 0, random.Random(1))
    assert chosen == Choice(pause.method, pause.params, None, (), ())
    assert follow(run, pause)
    assert run.reach.choose(run.conversation, 0, random.Random(1)) is None


def test_a_system_that_names_no_situation_has_no_matrix() -> None:
    """Nothing is told of situations that nobody names."""
    nameless = evolve(STATUS, matrix=None)
    verdict = conform(nameless, ReferenceSubject(nameless), plan=Plan(1, 1, 1, 5), seed=1, advice=False)
    assert (verdict.reach, verdict.to_json()["reach"]) == (None, None)
    assert "situations" not in str(verdict)


def test_a_run_led_nowhere_says_so() -> None:
    """Of a robot whose list cannot be cleared the run says that no situation after a clear came about."""
    without = conform(
        MISSION,
        ReferenceSubject(MISSION),
        plan=Plan(0, 1, 0, 5, fills=30),
        without=["ClearMissionStatus"],
        seed=1,
        advice=False,
    )
    assert without.reach is not None
    assert "cleared" in without.reach.never


@pytest.mark.parametrize("name", names())
def test_a_default_run_plays_every_script(name: str) -> None:
    """The bound on scripts cuts off none of any system, in whatever world they are played."""
    found = system(name)
    worlds = found.alphabet({}, BOUNDS).worlds
    assert 0 < len(written([found.alphabet(world, BOUNDS) for world in worlds])) <= SCRIPTS
    assert Plan.beside(100, 60, 40) == Plan()
