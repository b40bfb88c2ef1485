"""What bounds a run bounds all of it; an implementation that is not the same twice upsets nothing, and is told so."""

from __future__ import annotations

import itertools
import random

import pytest
from attrs import evolve
from broken import BUSY, MISSION, answering

from missionfsm.app.lamp import SYSTEM as LAMP
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification, Subject
from missionfsm.systems import names, system
from missionfsm.tools.check.verdict import Outcome, Verdict
from missionfsm.tools.conform.conform import ADVICE, EXPERIMENTS, MISSED, conform
from missionfsm.tools.conform.drawn import draw
from missionfsm.tools.conform.plan import Plan
from missionfsm.tools.conform.run import Run
from missionfsm.tools.mutate.mutants import mutants
from missionfsm.tools.reference.subject import ReferenceSubject

TIME, CALL = 10.0, 0.2
"""Seconds that a run may take, and that an answer takes."""


class Slow:
    """An implementation that takes its time, on a clock of its own."""

    def __init__(self, subject: Subject) -> None:
        self.subject = subject
        self.clock = 0.0
        self.begun: float | None = None
        self.resets = 0

    def exchange(self, method: str, params: JSON) -> Exchange:
        self.clock += CALL
        self.resets += method == "reset"
        return self.subject.exchange(method, params)

    def enough(self) -> bool:
        """Whether the time is up, which begins when this is first asked."""
        if self.begun is None:
            self.begun = self.clock
        return self.clock > self.begun + TIME


def judged(name: str, subject: Subject) -> tuple[Slow, Verdict]:
    slow = Slow(subject)
    verdict = conform(system(name), slow, seed=1, distinguish=True, enough=slow.enough)
    assert slow.begun is not None
    assert slow.clock - slow.begun <= TIME + 5 * CALL
    return slow, verdict


@pytest.mark.parametrize("name", names())
def test_time_bounds_all_of_a_run(name: str) -> None:
    """With 0.2 s for each answer, a run of 10 s ends within a second of them, and says what it did not come to.

    What it came to is enough to say that the implementation conforms.
    """
    _, verdict = judged(name, ReferenceSubject(system(name), {}))
    assert verdict.outcome is Outcome.CONFORMS
    (note,) = verdict.notes
    assert note.startswith(f"it was stopped after {verdict.examples} of ")
    assert note.endswith(f" conversations; it did not come to {EXPERIMENTS}, nor to {ADVICE}")


@pytest.mark.parametrize(
    ("name", "which"),
    [
        *((name, which) for name in names() for which in (1, 5)),
        *(pytest.param(name, which, marks=pytest.mark.long) for name in names() for which in range(0, 160, 7)),
    ],
)
def test_time_bounds_what_is_broken(name: str, which: int) -> None:
    """To find what is wrong, to make it short and to try it again takes no longer either."""
    broken = next(itertools.islice(mutants(system(name)), which, None), None)
    if broken is None:
        return
    slow, verdict = judged(name, broken.subject(system(name)))
    if verdict.outcome is Outcome.VIOLATES and slow.enough():
        assert "the violation was not made as short as can be: the time was up" in verdict.notes


def test_time_bounds_what_is_told_of_drives() -> None:
    """Which rules only drives would have tested takes thought, of which a run that is stopped says that it had none."""
    slow = Slow(ReferenceSubject(system("bear.status"), {}))
    left_out = ("move",)
    verdict = conform(system("bear.status"), slow, seed=1, without=left_out, advice=False, enough=slow.enough)
    assert (verdict.untested.drives, verdict.untested.refusals, verdict.untested.promises) == (left_out, (), ())
    assert verdict.notes[-1].endswith(f" conversations; it did not come to {MISSED}")


def test_time_bounds_advice() -> None:
    """What is thought about at the end ends with the time as well, and is then said not to have been come to."""
    robot, plan = system("isaac.robot"), Plan(drawn=1, tours=2, scripts=1, steps=5, fills=0)
    asked = itertools.count()

    def run(limit: int) -> Verdict:
        return conform(robot, ReferenceSubject(robot, {}), plan=plan, seed=2, enough=lambda: next(asked) >= limit)

    assert run(10**9).rare
    whole = next(asked) - 1
    asked = itertools.count()
    verdict = run(whole - 100)
    assert (verdict.rare, verdict.notes[-1:]) == (
        {},
        (f"it was stopped after 3 of 3 conversations; it did not come to {ADVICE}",),
    )


def test_advice_that_was_given_is_not_missing() -> None:
    """Where the time was up only after what is thought about at the end, a run does not say that it missed that."""
    robot, plan = system("isaac.robot"), Plan(drawn=1, tours=2, scripts=1, steps=5, fills=0)
    asked = itertools.count()

    def run(limit: int) -> Verdict:
        return conform(robot, ReferenceSubject(robot, {}), plan=plan, seed=2, enough=lambda: next(asked) >= limit)

    assert run(10**9).rare
    whole = next(asked)
    asked = itertools.count()
    verdict = run(whole - 1)
    assert verdict.rare
    assert verdict.notes[-1:] == ("it was stopped after 3 of 3 conversations",)


@pytest.mark.parametrize("name", names())
def test_one_example_is_one_conversation(name: str) -> None:
    """``--examples 1`` asks for one reset and no more."""
    slow = Slow(ReferenceSubject(system(name), {}))
    verdict = conform(system(name), slow, plan=Plan.sharing(1), seed=1, advice=False)
    assert (verdict.examples, slow.resets) == (1, 1)


class Unsteady:
    """A robot that now and then fails a call by itself, as is allowed, and is never the same twice."""

    def __init__(self, seed: int) -> None:
        self._robot = ReferenceSubject(MISSION, {})
        self._chance = random.Random(seed)

    def exchange(self, method: str, params: JSON) -> Exchange:
        if method in MISSION.codec.methods and method not in MISSION.codec.streams and self._chance.random() < 0.3:
            self._robot.exchange("drive", {"event": "fault", "status": "INTERNAL"})
        answer = self._robot.exchange(method, params)
        if method == "initialize":
            drives = [one for one in answer.result["drives"] if one != "fault"]
            return Exchange({**answer.result, "drives": drives})
        return answer


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.long)])
def test_what_is_drawn_does_not_depend_on_answers(seed: int) -> None:
    """Hypothesis draws again what it drew before; an implementation that then answers otherwise does not upset it."""
    run = Run.against(MISSION, Unsteady(seed))
    draw(run, 120, 20, seed=1)
    assert (run.found, run.ledger.examples >= 120) == (None, True)


class Moody:
    """An implementation that is broken in some of its conversations."""

    def __init__(self, broken: Subject, sound: Subject, seed: int) -> None:
        self._both = (broken, sound)
        self._chance = random.Random(seed)
        self._now = broken

    def exchange(self, method: str, params: JSON) -> Exchange:
        if method == "reset":
            self._now = self._chance.choice(self._both)
        return self._now.exchange(method, params)


@pytest.mark.long
def test_a_violation_that_comes_and_goes_is_told_how_often_it_is_seen() -> None:
    """It is tried again: how often it was seen, of how many times, is said with it."""
    broken = answering("NOT_FOUND", BUSY)
    verdict = conform(MISSION, Moody(broken, ReferenceSubject(MISSION, {}), 2), seed=1)
    (note,) = verdict.notes
    assert note in {f"the violation comes and goes: it was seen {times} of 5 times" for times in (1, 2, 3, 4)}


class Late:
    """An implementation of which what an answer causes is sometimes seen only with the next one."""

    def __init__(self, subject: Subject, seed: int) -> None:
        self._subject = subject
        self._chance = random.Random(seed)
        self._held: tuple[Notification, ...] = ()

    def exchange(self, method: str, params: JSON) -> Exchange:
        answer = self._subject.exchange(method, params)
        held, self._held = self._held, ()
        if method != "settle" and self._chance.random() < 0.5:
            self._held = answer.after
            answer = evolve(answer, after=())
        return evolve(answer, before=(*held, *answer.before))


@pytest.mark.parametrize("seed", range(5))
def test_what_only_comes_later_does_not_come_and_go(seed: int) -> None:
    """A violation that is seen once one waits for it is seen: when it arrives is nothing that the subject did."""
    robot = system("isaac.robot")
    bare = next(one for one in mutants(robot) if one.kind == "sends half a line")
    verdict = conform(robot, Late(bare.subject(robot), seed), plan=Plan(1, 1, 1), seed=1)
    assert (verdict.outcome, verdict.notes) == (Outcome.VIOLATES, ())


@pytest.mark.parametrize(
    ("rule", "kind"),
    [
        ("status/running-acknowledges", "is not heard"),
        ("status/a-final-status-ends-the-mission", "counts failure as success"),
    ],
)
@pytest.mark.parametrize("seed", range(3))
def test_what_is_meant_may_come_late(seed: int, rule: str, kind: str) -> None:
    """What is said of a mission that is on its way is said once it is there: the violation does not come and go."""
    server = system("isaac.server")
    (mutant,) = (one for one in mutants(server) if (one.rule, one.kind) == (f"isaac.server/{rule}", kind))
    verdict = conform(server, Late(mutant.subject(server), seed), plan=Plan(3, 3, 30), seed=1)
    assert (verdict.outcome, verdict.notes) == (Outcome.VIOLATES, ())
    assert verdict.violation is not None
    assert len(verdict.violation.history) < 14


@pytest.mark.slow
def test_a_run_may_be_stopped_at_any_time() -> None:
    """Wherever a run is broken off, also where a conversation drawn alike went on, it ends in a verdict."""
    for steps in range(290, 600, 30):
        asked = itertools.count()
        verdict = conform(
            LAMP,
            ReferenceSubject(LAMP),
            seed=1,
            drawn=200,
            tours=0,
            enough=lambda: next(asked) > steps,  # noqa: B023
        )
        assert verdict.outcome is not Outcome.VIOLATES
        assert "it was stopped after" in verdict.notes[-1]
