"""What a run of `conform` says of itself: what ruled a reading out, which rules came up seldom, that it was stopped."""

from __future__ import annotations

import itertools
from typing import Any

import orjson
import pytest
from attrs import evolve
from broken import MISSION
from commandline import CommandLine

from missionfsm.kernel.subject import Exchange
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.transcript import Head, head
from missionfsm.systems import names, system
from missionfsm.tools.check.judge import Judge, check
from missionfsm.tools.check.verdict import PER, RATE, Outcome
from missionfsm.tools.conform.actions import SETTLE, Action
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.coverage import Census, rare
from missionfsm.tools.conform.finding import verdict_of
from missionfsm.tools.conform.narrowing import WIDE
from missionfsm.tools.conform.plan import DRAWN, STEPS, TOURS, Plan
from missionfsm.tools.conform.run import BOUNDS, FEW, ONE_IN, ONE_IN_UNDRIVEN, Run
from missionfsm.tools.conform.tour import play, some, written
from missionfsm.tools.reference.subject import ReferenceSubject

HEAD: Any = {"missionfsm": 1, "system": "bear.mission", "world": {}}


def call(number: int, method: str, params: Any, **came: Any) -> tuple[Any, Any]:
    return {"call": number, "method": method, "params": params}, {"return": number, **came}


# What ruled a reading out.


def test_the_event_that_ruled_a_reading_out_is_named() -> None:
    """Each reading by the event after which no explanation follows it any more."""
    lines = (
        *call(1, "ClearMissionStatus", {}, result={"missionIds": []}),
        *call(2, "SkipGoal", {}, error={"status": "FAILED_PRECONDITION", "message": ""}),
    )
    verdict = check(MISSION, head(HEAD), lines)
    told = "ClearMissionStatus() was answered OK in [no mission]"
    assert (verdict.readings["AM-33.fresh"], verdict.ruled_out["AM-33.fresh"]) == (("a",), {"b": told, "c": told})
    assert f"  AM-33.fresh = a (not b, c: {told})" in str(verdict).splitlines()
    assert verdict.to_json()["ruled_out"]["AM-33.fresh"] == {"b": told, "c": told}


def test_a_reading_that_was_asked_for_was_ruled_out_by_nothing() -> None:
    """Only events rule readings out; what a user decides beforehand is no event."""
    lines = call(1, "ClearMissionStatus", {}, result={"missionIds": []})
    verdict = check(MISSION, head(HEAD), lines, readings={"AM-33.fresh": "a"})
    assert "AM-33.fresh" not in verdict.ruled_out


@pytest.mark.parametrize("name", names())
def test_every_reading_that_is_gone_has_an_event(name: str) -> None:
    """Replayed line by line: a reading is noted with the first line after which it is not possible any more."""
    judged = system(name)
    seen: list[Judge] = []

    def keep(run: Run) -> None:
        if run.last is not None and run.last.judge not in seen:
            seen.append(run.last.judge)

    conform(judged, ReferenceSubject(judged, {}), drawn=1, tours=4, steps=15, seed=3, advice=False, progress=keep)
    for judge in seen:
        first, *lines = judge.history
        again = Judge(judged, head(first), judge.automaton)
        gone: dict[tuple[str, str], str] = {}
        for line in lines:
            again.feed(line)
            for one, letters in again.belief.readings.items():
                ambiguity = next(each for each in judged.spec.ambiguities if each.id == one)
                for letter in set(ambiguity.possible(judge.automaton.assumed)) - set(letters):
                    gone.setdefault((one, letter), str(again.eliminations.found[one, letter]))
        assert {one: str(elimination) for one, elimination in judge.eliminations.found.items()} == gone


def test_a_run_names_events_for_what_all_its_conversations_ruled_out() -> None:
    """What is not left of an ambiguity has an event, whichever conversation it was in."""
    verdict = conform(MISSION, ReferenceSubject(MISSION, {}), drawn=2, tours=6, steps=15, seed=1, advice=False)
    letters = {one.id: set(one.readings) for one in MISSION.spec.ambiguities}
    gone = {name: letters[name] - set(left) for name, left in verdict.readings.items() if letters[name] - set(left)}
    assert {name: set(events) for name, events in verdict.ruled_out.items()} == gone


# Which rules came up seldom.


@pytest.mark.long
def test_a_run_says_which_rules_came_up_seldom_and_why() -> None:
    """Those and no others; each with a reason that the model gives."""
    runs: list[Run] = []
    verdict = conform(MISSION, ReferenceSubject(MISSION, {}), drawn=2, tours=10, steps=20, seed=1, progress=runs.append)
    steps = runs[-1].ledger.steps
    seldom = {rule.id for rule in MISSION.spec.all_rules if verdict.exercised.get(rule.id, 0) * PER < RATE * steps}
    assert set(verdict.rare) == seldom
    assert all(verdict.rare.values())
    assert verdict.to_json()["coverage"]["rare"] == verdict.rare


@pytest.mark.long
@pytest.mark.parametrize(
    ("rule", "readings", "why"),
    [
        (
            "ClearMissionStatus/FAILED_PRECONDITION/nothing-is-listed",
            {"AM-33.cleared": ("a",)},
            "only under AM-33.cleared=b, which is not followed",
        ),
        ("ChargeRobot/NOT_FOUND/the-robot-has-no-contact-dock", {}, "and that in 1 of 8 worlds"),
        ("UpdateMission/NOT_FOUND/the-mission-has-ended-and-another-is-active", {}, "no step in "),
    ],
)
def test_the_reason_is_the_models(rule: str, readings: dict[str, tuple[str, ...]], why: str) -> None:
    """A reading that is not followed, a world that is seldom met, something that is far from the start."""
    assert why in Census(MISSION, readings).why(MISSION.spec.rule(f"bear.mission/{rule}"))


@pytest.mark.slow
@pytest.mark.parametrize("name", [pytest.param("bear.mission", marks=pytest.mark.long), *names()[1:]])
def test_what_is_exercised_enough_is_not_rare(name: str) -> None:
    """A rule that is exercised at the rate is not on the list; with none exercised all are."""
    rules = [rule.id for rule in system(name).spec.all_rules]
    assert rare(system(name), dict.fromkeys(rules, RATE), PER, {}) == {}
    assert list(rare(system(name), {}, PER, {})) == rules


# That it was stopped.


def test_a_run_ends_once_it_is_enough() -> None:
    """No step is begun after that, whichever part of the search it is in, and the verdict says that it was stopped."""
    for limit in (1, 20, 100):
        asked = itertools.count()
        verdict = conform(
            MISSION,
            ReferenceSubject(MISSION, {}),
            drawn=20,
            tours=3,
            steps=10,
            seed=1,
            advice=False,
            enough=lambda asked=asked, limit=limit: next(asked) >= limit,
        )
        assert verdict.examples < 2 * (20 + 3)
        assert verdict.notes == (f"it was stopped after {verdict.examples} of 46 conversations",)


def test_time_bounds_a_run(command_line: CommandLine) -> None:
    """``--time`` stops a run that would take far longer; what it came to is told."""
    ended = command_line("conform", "isaac.robot", "--examples", "100000", "--time", "1", "--seed", "1", "--json", "-")
    told = orjson.loads(ended.out)
    assert (ended.status, told["verdict"], len(told["notes"])) == (0, "conforms", 1)


def test_a_head_is_read() -> None:
    """The first line of a history that a judge shows is one that makes the same judge."""
    judge = Judge(MISSION, Head("bear.mission", {}, ("goalReached",)))
    assert head(judge.history[0]) == judge.head


# Implementations that also move by themselves.


class Undriven(ReferenceSubject):
    """The reference, which declares no drives: whatever they do may happen at any time."""

    def exchange(self, method: str, params: Any) -> Any:
        came = super().exchange(method, params)
        return evolve(came, result={**came.result, "drives": []}) if method == "initialize" else came


@pytest.mark.parametrize(("subject", "waited"), [(Undriven, True), (ReferenceSubject, False)])
def test_what_may_have_moved_too_far_is_let_settle(subject: type[ReferenceSubject], *, waited: bool) -> None:
    """Before the next call, where what nobody saw has many explanations; what is driven moves no further."""
    goals = [{"destinationId": name} for name in ("table-1", "table-2", "table-3")]
    patrol = {"mission": {"serviMission": {"deliveryPatrolMission": {"goals": goals}}}}
    run = Run.against(MISSION, subject(MISSION))
    run.start({})
    run.do("SubscribeMissionStatus", {})
    run.do("CreateMissionBatch", {"missions": [patrol, patrol]})
    run.do("UpdateMission", {"missionCommand": {"missionId": "no-such-mission"}})
    wide = len(run.conversation.judge.belief.node.explanations)
    assert run.do("CreateMission", patrol)
    assert (wide > WIDE, {"settled": True} in run.conversation.heard) == (waited, waited)
    assert len(run.conversation.judge.belief.node.explanations) <= max(2, wide // 2)


@pytest.mark.parametrize("drives", [(), tuple(MISSION.spec.drives)], ids=["by itself", "driven"])
def test_a_conversation_that_cannot_be_decided_is_given_up(drives: tuple[str, ...]) -> None:
    """A few are, and the verdict says how many; after those the run is inconclusive."""
    automaton = Automaton(MISSION.spec, drives, budget=1)
    run = Run.against(MISSION, ReferenceSubject(MISSION, {}), automaton=automaton)
    created = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
    asked = Action(1, "SubscribeMissionStatus", {}), Action(2, "CreateMission", created), Action(3, "SkipGoal", {})
    outcomes = [run.converse({}, (*asked, Action(4, SETTLE))) for _ in range(FEW + 1)]
    assert outcomes == [True] * FEW + [False]
    assert run.ledger.undecided == FEW
    verdict = verdict_of(run, 0, advice=False)
    assert verdict.outcome is Outcome.INCONCLUSIVE
    assert any("were given up" in one for one in verdict.notes)


@pytest.mark.parametrize(("drives", "one_in"), [((), ONE_IN_UNDRIVEN), (tuple(MISSION.spec.drives), ONE_IN)])
def test_how_many_conversations_may_be_given_up(drives: tuple[str, ...], one_in: int) -> None:
    """Of what moves by itself more may be: what it did until then was judged."""
    automaton = Automaton(MISSION.spec, drives, budget=1)
    run = Run.against(MISSION, ReferenceSubject(MISSION, {}), automaton=automaton)
    run.ledger.examples, run.ledger.undecided = one_in * (FEW + 2), FEW + 1
    created = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
    asked = Action(1, "SubscribeMissionStatus", {}), Action(2, "CreateMission", created), Action(3, "SkipGoal", {})
    assert [run.converse({}, (*asked, Action(4, SETTLE))) for _ in range(2)] == [True, False]
    assert run.ledger.undecided == FEW + 2


class Falsy(ReferenceSubject):
    """Takes a goal whose numbers are all zero for one that was not given."""

    def exchange(self, method: str, params: Any) -> Any:
        if method == "CreateMission" and "'xMeters': 0.0" in str(params):
            return Exchange(error={"status": "INVALID_ARGUMENT", "message": "no goal"})
        return super().exchange(method, params)


def test_the_origin_of_the_map_is_a_goal_that_is_asked_for() -> None:
    """A robot for which zero is nothing is found out."""
    verdict = conform(MISSION, Falsy(MISSION), drawn=1, steps=5, seed=1, advice=False)
    assert verdict.outcome is Outcome.VIOLATES
    assert "pose (0, 0, 0)" in str(verdict)


@pytest.mark.parametrize(("subject", "left"), [(Undriven, 1), (ReferenceSubject, 0)])
def test_a_conversation_in_which_too_much_may_have_happened_ends_early(
    subject: type[ReferenceSubject], left: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was seen until then is judged and entered, and the verdict says how many there were."""
    monkeypatch.setattr("missionfsm.tools.conform.narrowing.WIDE", 0)
    run = Run.against(MISSION, subject(MISSION))
    assert run.converse({}, (Action(1, "SubscribeMissionStatus", {}), Action(2, "ClearMissionStatus", {})))
    assert (run.ledger.left, run.ledger.examples) == (left, 1)
    assert len(run.conversation.actions) == (1 if left else 2)
    said = "1 of 1 conversations ended early: too much may have happened by itself to follow what comes next"
    assert verdict_of(run, 0, advice=False).notes == (said,) * left


class Failing(Undriven):
    """One that answers all creations with an error that nothing documents."""

    def exchange(self, method: str, params: Any) -> Any:
        came = super().exchange(method, params)
        return evolve(came, result=None, error={"status": "DATA_LOSS"}) if method.startswith("Create") else came


@pytest.mark.parametrize("broken", [False, True])
def test_what_moves_by_itself_is_not_followed_for_ever(monkeypatch: pytest.MonkeyPatch, *, broken: bool) -> None:
    """A run ends when many conversations ended early; a violation that it has found is made short all the same."""
    monkeypatch.setattr("missionfsm.tools.conform.narrowing.WIDE", 2)
    for name, value in (("LEFT", 2), ("STRAIN", 10), ("EARLY", 5)):
        monkeypatch.setattr(f"missionfsm.tools.conform.run.{name}", value)
    verdict = conform(MISSION, (Failing if broken else Undriven)(MISSION), seed=1)
    stopped = any("it was stopped after" in one for one in verdict.notes)
    assert (verdict.outcome, stopped) == (Outcome.VIOLATES if broken else Outcome.CONFORMS, not broken)
    assert (verdict.examples < 100, any("time was up" in one for one in verdict.notes)) == (True, False)


def turned(message: Any) -> Any:
    """A message that shows a pose with the axes of the map swapped, unless it is the first goal of its mission."""
    for mission in message["missionStates"]["missions"]:
        for goal in mission["goals"][1:]:
            pose = goal.get("pose")
            if pose:
                pose["xMeters"], pose["yMeters"] = pose["yMeters"], pose["xMeters"]
    return message


def test_poses_behind_other_goals_are_asked_for() -> None:
    """A robot that mistakes a pose only where it is not the first goal is found out."""
    run = Run.against(MISSION, ReferenceSubject(MISSION, mutate_message=turned))
    assert not play(run)
    assert "pose (1.25, 2.5, 0.5)" in str(run.conversation.judge.verdict())


class Dated(ReferenceSubject):
    """Knows no destination that was not on its map from the start."""

    def exchange(self, method: str, params: Any) -> Any:
        if method == "CreateMission" and "table-4" in str(params):
            return Exchange(error={"status": "INVALID_ARGUMENT", "message": "no such destination"})
        return super().exchange(method, params)


class Forgetful(ReferenceSubject):
    """Tells nobody but the first who subscribed of a mission that is resumed."""

    def exchange(self, method: str, params: Any) -> Any:
        found = super().exchange(method, params)
        resumes = "COMMAND_RESUME" in str(params)
        return evolve(found, after=found.after[:1]) if resumes else found


@pytest.mark.parametrize(
    ("subject", "says"), [(Dated, "'table-4'"), (Forgetful, "did not show [RUNNING at goal 0, WAITING]")]
)
def test_a_map_that_changes_and_a_second_subscriber_are_asked_for(subject: type[ReferenceSubject], says: str) -> None:
    """A robot that goes by the map that it had, or tells one subscriber less than another, is found out."""
    run = Run.against(MISSION, subject(MISSION))
    assert not play(run)
    assert says in str(run.conversation.judge.verdict())


class Lenient(ReferenceSubject):
    """Takes any number for a command, and does nothing at one that stands for none."""

    def exchange(self, method: str, params: Any) -> Any:
        if method == "UpdateMission" and params.get("missionCommand", {}).get("command") == 9:
            return Exchange({})
        return super().exchange(method, params)


def test_a_number_that_is_no_command_is_asked_for() -> None:
    """A robot that answers OK to it is found out."""
    run = Run.against(MISSION, Lenient(MISSION))
    assert not play(run)
    assert "the-command-is-not-set" in str(run.conversation.judge.verdict())


@pytest.mark.parametrize("name", names())
@pytest.mark.parametrize("plan", [Plan(), Plan.beside(DRAWN, TOURS, STEPS)], ids=["command line", "Python"])
def test_a_default_run_plays_every_script(name: str, plan: Plan) -> None:
    """Those of other families stand last; a bound that cuts them off is noticed."""
    of = system(name)
    scripts = written([of.alphabet(world, BOUNDS) for world in of.alphabet({}, BOUNDS).worlds])
    assert some(scripts, plan.scripts) == scripts
