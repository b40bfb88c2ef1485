"""What a sentence of the Mission page speaks against is accepted and pointed out, and a violation to the letter."""

from __future__ import annotations

import pytest
from attrs import evolve

from missionfsm.bear.mission.readings.scope import part_of
from missionfsm.bear.mission.readings.skipping import LOOPS
from missionfsm.bear.mission.samples import CANCEL, FINISH, PAUSE, RESUME, TABLES, of_family
from missionfsm.bear.mission.scripts import APPENDED, CREATED, call, commanded, drive
from missionfsm.bear.mission.state import Kind
from missionfsm.kernel.alphabet import Alphabet, Bounds, ScriptStep
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.system import System
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Outcome, Verdict
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.plan import Plan
from missionfsm.tools.conform.run import Run
from missionfsm.tools.conform.tour import play
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")
WATCHED = call("SubscribeMissionStatus")
SERVI: JSON = {"family": "servi"}
QUEUE = (*WATCHED, *CREATED, *APPENDED)
HALTED = {"AM-09": "b"}
UNDOCKED = (*call("ChargeRobot"), *commanded(0, CANCEL), *drive("world", contactDock=False), *call("ChargeRobot"))
PATROLS = {
    Kind.SERVI_DELIVERY_PATROL: ("servi", "deliveryPatrolMission"),
    Kind.SERVI_BUSSING_PATROL: ("servi", "bussingPatrolMission"),
    Kind.CARTI_TRAVERSE_PATROL: ("carti", "traversePatrolMission"),
    Kind.SERVI_HOSTING_PATROL: ("servi", "hostingPatrol"),
}


def patrolled(kind: Kind) -> tuple[ScriptStep, ...]:
    """A patrol of one goal whose goal is skipped."""
    family, which = PATROLS[kind]
    if kind is Kind.SERVI_HOSTING_PATROL:
        goals = {"goals": [{"destinationId": TABLES[0]}]}
        begun = call("CreateMissionWorkflow", {"missionWorkflow": {"serviWorkflow": {which: goals}}})
    else:
        begun = call("CreateMission", {"mission": of_family(family, which, TABLES[0])})
    return (*WATCHED, *begun, *call("SkipGoal"))


AUTO_TAKEN = {
    "baseMission": {"navigateAutoMission": {"goals": [{"destinationId": TABLES[0]}, {"destinationId": TABLES[1]}]}}
}
TAKEN = {"family": "servi", "occupied": [*TABLES]}
AUTO_FIRST, AUTO_LATER = (
    call("CreateMissionBatch", {"missions": [{"mission": one} for one in missions]})
    for missions in (
        (AUTO_TAKEN, of_family("servi", "deliveryMission", TABLES[0])),
        (of_family("servi", "deliveryMission", TABLES[0]), AUTO_TAKEN),
    )
)
WORKFLOW = call(
    "CreateMissionWorkflow",
    {"missionWorkflow": {"serviWorkflow": {"delivery": {"goals": [{"destinationId": TABLES[0]}]}}}},
)
OTHER_CASE = (
    *WATCHED,
    *call("CreateMission", {"mission": of_family("servi", "deliveryMission", TABLES[0], TABLES[1].upper())}),
    *drive("goalReached"),
)
"""A mission of which the second destination is on the map but for its case."""
DEPARTURES: tuple[tuple[str, str, dict[str, str], JSON, tuple[ScriptStep, ...]], ...] = (
    ("AM-07.halted", "v", HALTED, SERVI, (*QUEUE, *commanded(0, CANCEL), *WORKFLOW)),
    ("AM-08", "b", {}, SERVI, QUEUE),
    ("AM-09", "d", {}, SERVI, (*QUEUE, *commanded(0, CANCEL))),
    ("AM-09.skip", "d", {"AM-17": "d"}, SERVI, (*QUEUE, *call("SkipGoal"))),
    ("AM-10", "d", {}, SERVI, (*QUEUE, *drive("missionFailed"))),
    ("AM-12.paused.AppendMission", "b", {}, SERVI, (*CREATED, *commanded(0, PAUSE), *APPENDED)),
    ("AM-12.halted.AppendMission", "b", HALTED, SERVI, (*QUEUE, *commanded(0, CANCEL), *APPENDED)),
    ("AM-14.halted", "e", HALTED, SERVI, (*QUEUE, *commanded(0, CANCEL))),
    *(
        (f"AM-17.patrol.{part_of(kind)}", letter, {}, {"family": PATROLS[kind][0]}, patrolled(kind))
        for kind in Kind
        if kind in LOOPS
        for letter in "abcd"
    ),
    ("AM-29.pause", "b", {}, SERVI, (*CREATED, *commanded(0, PAUSE), *commanded(0, PAUSE))),
    ("AM-29.resume", "b", {}, SERVI, (*CREATED, *commanded(0, RESUME))),
    ("AM-30", "b", {}, SERVI, (*WATCHED, *CREATED, *commanded(0, FINISH))),
    *(("AM-38.dock", letter, {}, SERVI, UNDOCKED) for letter in "cg"),
    *(("AM-43.case.CreateMission", letter, {}, SERVI, OTHER_CASE) for letter in "bdfm"),
    ("AM-53.CreateMissionWorkflow", "v", {}, {"family": "servi", "blocked": True}, WORKFLOW),
    ("AM-51.base-navigate", "b", {}, SERVI, (*WATCHED, *CREATED)),
)
ACCEPTED: tuple[tuple[str, str, dict[str, str], JSON, tuple[ScriptStep, ...]], ...] = (
    ("AM-02.cleared.idle", "e", {"AM-03": "b"}, SERVI, (*CREATED, *commanded(0, CANCEL), *call("ClearMissionStatus"))),
    ("AM-09", "b", {}, SERVI, (*QUEUE, *commanded(0, CANCEL))),
    ("AM-10", "b", {}, SERVI, (*QUEUE, *drive("missionFailed"))),
    ("AM-17.patrol.servi-hosting-patrol", "c", {}, SERVI, patrolled(Kind.SERVI_HOSTING_PATROL)),
    ("AM-17.last.base-navigate", "c", {}, SERVI, (*CREATED, *call("SkipGoal"))),
    ("AM-33.fresh", "b", {}, SERVI, call("ClearMissionStatus")),
    ("AM-36", "b", {}, SERVI, WATCHED),
    ("AM-40", "c", {}, SERVI, (*call("ChargeRobot"), *commanded(0, PAUSE))),
    ("AM-45.none.refused.CreateMissionBatch", "c", {}, TAKEN, AUTO_LATER),
    ("AM-45.none.refused.CreateMissionBatch", "s", {}, TAKEN, AUTO_FIRST),
    ("AM-45.none.refused.CreateMissionBatch", "s", {}, TAKEN, AUTO_LATER),
)


def saying(script: tuple[ScriptStep, ...], world: JSON) -> System:
    """The system of which a tester has this one conversation."""

    def alphabet(_: JSON, bounds: Bounds) -> Alphabet:
        return evolve(MISSION.alphabet(world, bounds), scripts=(script,), worlds=(world,))

    return evolve(MISSION, alphabet=alphabet, matrix=None)


def judged(
    followed: dict[str, str], world: JSON, script: tuple[ScriptStep, ...], *, no_flagged: bool = False
) -> Verdict:
    """What is said of a reference that follows these readings, after one conversation."""
    subject = ReferenceSubject(MISSION, followed)
    return conform(saying(script, world), subject, plan=Plan(0, 0, 1), no_flagged=no_flagged, advice=False)


@pytest.mark.parametrize(
    ("question", "letter", "with_", "world", "script"), DEPARTURES, ids=[f"{one[0]}={one[1]}" for one in DEPARTURES]
)
def test_what_departs_from_the_text_is_flagged(
    question: str, letter: str, with_: dict[str, str], world: JSON, script: tuple[ScriptStep, ...]
) -> None:
    """It is explained, the verdict names the reading, and under the letter of the text it violates."""
    followed = {**with_, question: letter}
    verdict = judged(followed, world, script)
    assert (verdict.outcome, [line.partition("=")[0] for line in verdict.flagged]) == (Outcome.CONFORMS, [question])
    to_the_letter = Run.against(saying(script, world), ReferenceSubject(MISSION, followed), no_flagged=True)
    assert not play(to_the_letter)


@pytest.mark.parametrize(
    ("question", "letter", "with_", "world", "script"), ACCEPTED, ids=[f"{one[0]}={one[1]}" for one in ACCEPTED]
)
def test_what_no_sentence_speaks_against_is_not_flagged(
    question: str, letter: str, with_: dict[str, str], world: JSON, script: tuple[ScriptStep, ...]
) -> None:
    """It is explained to the letter of the text, and nothing is pointed out."""
    verdict = judged({**with_, question: letter}, world, script, no_flagged=True)
    assert (verdict.outcome, verdict.flagged) == (Outcome.CONFORMS, ())


def test_what_departs_in_one_of_two_ways_is_flagged_once() -> None:
    """UNIMPLEMENTED without a dock may be meant for that robot or for the whole call; the verdict names one of both."""
    (line,) = judged({"AM-38.dock": "d"}, SERVI, UNDOCKED).flagged
    assert line.startswith(("AM-38.dock=d departs from the text", "AM-61=b departs from the text"))
