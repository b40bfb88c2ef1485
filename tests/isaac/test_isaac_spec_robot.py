"""The oracle for ``isaac.robot``: who passes, who is caught, and what a recorded history comes to."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

import pytest
from spec_helpers import breaks, explained, needs_node, node, run_of

from missionfsm.adapters.isaac.subjects import RobotSubject
from missionfsm.isaac.robot.readings import AMBIGUITIES
from missionfsm.isaac.wire.framing import encode
from missionfsm.isaac.wire.messages import (
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
)
from missionfsm.kernel.alphabet import Bounds
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.transcript import Head
from missionfsm.systems import system
from missionfsm.tools.check.judge import Judge, check
from missionfsm.tools.check.nearest import rules_about
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.mutate.teeth import teeth
from missionfsm.tools.placeholders import fill
from missionfsm.tools.reference.subject import ReferenceSubject

ROBOT = system("isaac.robot")
ONE, TWO, THREE = Uuid(1, 1 << 60 | 1), Uuid(2, 1 << 60 | 2), Uuid(3, 1 << 60 | 3)
SUCCEEDED, SETTLED = {"drive": {"event": "behaviorSucceeded"}}, {"settled": True}


def arrives(uuid: Uuid, config: str = "{}") -> Any:
    """A mission arrives."""
    line = encode(Message(Header("mission"), MissionProto(uuid, config))).decode().strip()
    return {"drive": {"event": "line", "line": line}}


def says(status: str, uuid: Uuid = ONE, channel: str = "mission_status") -> Any:
    """The robot reports."""
    message = Message(Header(channel, 1, 1, TWO), MissionStatusProto(uuid, WireStatus(status)))
    return {"connection": 1, "line": encode(message).decode().strip()}


def passes(seconds: float) -> Any:
    return {"drive": {"event": "advance", "seconds": seconds}}


def judged(*lines: Any, **readings: str) -> Verdict:
    """The verdict on a history of a robot whose drives are all commanded, under these readings."""
    drives = ("line", "behaviorSucceeded", "behaviorFailed", "advance", "disconnect", "connect")
    head = Head("isaac.robot", {}, drives)
    return check(ROBOT, head, lines, readings=readings)


def rules(verdict: Verdict) -> list[str]:
    assert verdict.violation is not None
    return [rule.id.removeprefix("isaac.robot/") for rule in verdict.violation.rules]


@pytest.mark.parametrize(
    "lines",
    [
        (arrives(ONE), says("running"), SUCCEEDED, says("success"), SETTLED),
        (arrives(ONE), SUCCEEDED, says("success"), SETTLED),
        (arrives(ONE), says("running"), says("running"), SUCCEEDED, says("running"), says("success"), SETTLED),
        (arrives(ONE), arrives(TWO), says("failure"), says("running", TWO), SETTLED),
        (arrives(ONE, "no json"), says("failure"), SETTLED, arrives(TWO), says("running", TWO), SETTLED),
        (arrives(ONE), passes(5), says("running"), SETTLED, says("running"), SETTLED),
        (arrives(ONE), passes(4.9), SETTLED),
    ],
    ids=["all", "short", "often", "preempted", "unusable", "settled", "within the bound"],
)
def test_what_a_codelet_may_say(lines: tuple[Any, ...]) -> None:
    """RUNNING as often as it likes while a tree runs, one final status, FAILURE for what is preempted."""
    assert judged(*lines).conforms


def test_a_robot_that_reports_each_second_has_few_explanations() -> None:
    """What came how often need not be told apart: twelve rounds have at most twice the explanations of six."""

    def widest(rounds: int) -> int:
        judge = Judge(ROBOT, Head("isaac.robot", {}, ("line", "behaviorSucceeded", "behaviorFailed", "advance")))
        most = 0
        for line in (arrives(ONE), says("running"), SETTLED, *[passes(1), says("running")] * rounds):
            assert judge.feed(line)
            most = max(most, len(judge.belief.node.explanations))
        return most

    assert widest(12) <= 2 * widest(6) + 10


def test_running_that_was_due_has_to_come() -> None:
    """However often it was due: where it was not shown at all since, that is noticed once everything has settled."""
    due = passes(40)
    assert rules(judged(arrives(ONE), says("running"), SETTLED, due, due, SETTLED))
    assert judged(arrives(ONE), says("running"), SETTLED, due, says("running"), due, says("running"), SETTLED).conforms
    assert rules(judged(arrives(ONE), says("running"), SETTLED, due, due, says("running"), SETTLED))


NODES = '{"goals":{"Selector":{"desired":"path"}}}'
FAILED = {"drive": {"event": "behaviorFailed"}}
RUNS = (arrives(ONE, NODES), says("running"), SETTLED)


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ((*RUNS, FAILED, says("success")), ["status/one-failure-at-the-end"]),
        ((*RUNS, FAILED, passes(1), SETTLED), ["status/one-failure-at-the-end"]),
        (
            (arrives(ONE, NODES), says("running", Uuid(1, 0))),
            ["status/a-status-is-about-its-mission", "codelet/a-mission-starts-the-behavior-tree"],
        ),
        (
            (*RUNS, arrives(TWO, NODES), passes(1), says("running"), SETTLED),
            [
                "status/running-while-the-tree-runs",
                "codelet/a-new-mission-preempts",
                "codelet/a-mission-starts-the-behavior-tree",
            ],
        ),
    ],
)
def test_no_configuration_is_accused_where_none_is_odd(lines: tuple[Any, ...], told: list[str]) -> None:
    """A mission that fails since its configuration cannot be used has no part in what goes wrong with others."""
    assert rules(judged(*lines)) == told


def test_a_mission_that_was_dropped_silently_accuses_what_preempted_it() -> None:
    """Also where the one after it may be none that can be used, so that only that is left to explain the lines."""
    preempted = (*RUNS, arrives(TWO, '{"x":1}'), says("running", TWO), passes(1), says("running", TWO), SETTLED)
    told = rules(judged(*preempted))
    assert "codelet/a-new-mission-preempts" in told
    assert "codelet/an-unusable-configuration-fails-the-mission" not in told


def test_of_which_mission_something_is_missing_is_said_by_its_uuid() -> None:
    """The line that is missing and the line that came last are each shown with the uuid of their mission."""
    verdict = judged(*RUNS, arrives(TWO, NODES), passes(1), says("running"), SETTLED)
    missing, last = (
        f"RUNNING of its mission on mission_status (uuid (lower {one}, upper {one | 1 << 60}))" for one in (2, 1)
    )
    assert f"connection 1 did not show {missing}; it showed {last} last" in str(verdict)
    silent = judged(*RUNS, passes(5), passes(5), passes(30), SETTLED)
    assert f"connection 1 did not show {last} again" in str(silent)


@pytest.mark.parametrize(
    ("lines", "rule"),
    [
        ((arrives(ONE), SUCCEEDED, says("failure")), "status/one-success-at-the-end"),
        ((arrives(ONE), SUCCEEDED, says("success", channel="mission")), "status/statuses-go-to-the-status-channel"),
        ((arrives(ONE), arrives(TWO), says("running", TWO)), "status/one-failure-at-the-end"),
        ((arrives(ONE), SUCCEEDED, {"connection": 1, "line": "{}"}), "line/a-line-is-one-message"),
    ],
)
def test_what_is_wrong_is_said_by_its_rule(lines: tuple[Any, ...], rule: str) -> None:
    """A violation names the rule that it is against."""
    verdict = judged(*lines)
    assert (verdict.conforms, rule in rules(verdict)) == (False, True)


@pytest.mark.parametrize(
    "lines",
    [
        (says("running"),),
        (arrives(ONE), SUCCEEDED, says("success"), says("success")),
        (arrives(ONE), SUCCEEDED, says("success"), says("running")),
        (arrives(ONE), says("success")),
        (arrives(ONE), says("running", TWO)),
        (arrives(ONE), arrives(TWO), says("failure"), says("running")),
        (arrives(ONE), SUCCEEDED, passes(1), SETTLED),
        (arrives(ONE), passes(40), SETTLED),
    ],
    ids=["no mission", "twice", "after the end", "too early", "another", "preempted", "never", "beyond the bound"],
)
def test_what_no_reading_allows(lines: tuple[Any, ...]) -> None:
    """Reports without a mission, after its end, before it, about another, or none at all."""
    assert not judged(*lines).conforms


UNREAD = (
    (arrives(TWO), SUCCEEDED, passes(1), says("success"), says("running", TWO)),
    (arrives(TWO), FAILED, passes(1), says("failure"), says("running", TWO)),
    (arrives(TWO, "no JSON"), SUCCEEDED, passes(1), says("success"), says("failure", TWO)),
    (arrives(TWO), arrives(THREE), SUCCEEDED, passes(1), says("success"), says("failure", TWO), says("running", THREE)),
)


@pytest.mark.parametrize("lines", UNREAD, ids=["succeeds", "fails", "unusable", "two unread"])
def test_a_line_may_be_read_on_the_tick(lines: tuple[Any, ...]) -> None:
    """AI-31.read b: a tree that stops before a line was read has ended the mission before it."""
    verdict = judged(*RUNS, *lines, SETTLED)
    assert verdict.conforms, verdict
    assert "b" in verdict.readings.get("AI-31.read", ("a", "b"))


def test_a_line_that_was_reported_on_has_been_read() -> None:
    """The mission that was preempted does not end again, and its end takes the place of the FAILURE alone."""
    assert not judged(*RUNS, arrives(TWO), says("failure"), SUCCEEDED, passes(1), says("success"), SETTLED).conforms
    late = (arrives(TWO), SUCCEEDED, passes(1), says("failure"), says("success"), SETTLED)
    assert not judged(*RUNS, *late).conforms


DROPPED, BACK = {"drive": {"event": "disconnect"}}, {"drive": {"event": "connect"}}


@pytest.mark.parametrize(
    ("lines", "readings"),
    [
        ((DROPPED, passes(1), BACK, passes(1), says("failure")), {"AI-15.mission": ("c",), "AI-15.status": ("a", "b")}),
        ((DROPPED, SUCCEEDED, BACK, passes(1), says("success")), {"AI-15.status": ("a", "b")}),
        ((DROPPED, SUCCEEDED, passes(1), BACK, passes(1), says("success")), {"AI-15.status": ("b",)}),
        ((SUCCEEDED, DROPPED, BACK, passes(1), says("success")), {"AI-31.end": ("b",)}),
    ],
    ids=["fails with it", "not due yet", "due and kept", "drops before it is due"],
)
def test_what_is_due_while_there_is_no_connection(lines: tuple[Any, ...], readings: dict[str, tuple[str, ...]]) -> None:
    """It is lost or kept once it is due; where no time has passed, nobody knows.

    A mission may fail with the connection: that is told once there is one again, and says nothing of other statuses.
    """
    verdict = judged(arrives(ONE), *lines, SETTLED)
    assert verdict.conforms, verdict
    followed = {name: verdict.readings.get(name, ("a", "b")) for name in readings}
    assert followed == readings


def test_every_question_has_a_rule_that_two_answers_to_it_break() -> None:
    """A codelet that answers a question now so and now otherwise is accused of that, not of whatever came."""
    spec = system("isaac.robot").spec
    assert [one.id for one in AMBIGUITIES if not rules_about(spec, one[one.default])] == []


def test_an_integer_that_is_a_number_is_told_by_its_place() -> None:
    """The header's uuid may be numbers, which departs from the text; the payload's may not."""
    line = json.loads(says("success")["line"])
    line["header"]["uuid"] = {"lower": 5, "upper": 6}
    verdict = judged(arrives(ONE), SUCCEEDED, {"connection": 1, "line": json.dumps(line)}, SETTLED)
    assert (verdict.conforms, verdict.readings["AI-25.header"], len(verdict.flagged)) == (True, ("n",), 1)
    line["payload"]["uuid"] = {"lower": ONE.lower, "upper": ONE.upper}
    wrong = judged(arrives(ONE), SUCCEEDED, {"connection": 1, "line": json.dumps(line)})
    assert rules(wrong) == ["line/64-bit-integers-are-strings"]


def test_nobody_has_to_drive_the_tree() -> None:
    """Where the tester cannot stop the behavior tree, it may stop at any time by itself."""
    head = Head("isaac.robot", {}, ("line", "advance"))
    assert check(ROBOT, head, (arrives(ONE), says("running"), says("failure"), SETTLED)).conforms


def test_the_robot_that_ships_conforms() -> None:
    """The codelet that runs under the sockets follows one set of readings, and every rule is exercised on it."""
    verdict = conform(ROBOT, RobotSubject(), drawn=10, steps=30, seed=1, tours=20)
    assert verdict.conforms
    assert verdict.uncovered == ()
    decided = {name: letters[0] for name, letters in verdict.readings.items() if len(letters) == 1}
    assert {name: letter for name, letter in decided.items() if name.startswith("AI-33")} == {
        "AI-33.blank": "b",
        "AI-33.node": "a",
        "AI-33.null": "b",
        "AI-33.preempts": "a",
        "AI-33.preempts-blank": "a",
        "AI-33.preempts-null": "a",
        "AI-33.preempts-value": "a",
        "AI-33.unknown": "a",
        "AI-33.unusable": "a",
        "AI-33.value": "a",
    }


UNASKED = ("AI-27.taken", "AI-28.taken", "AI-33.preempts-written")
"""Of lines that no tester sends: they are recorded (`test_isaac_odd_lines.py`)."""
NEEDS = {
    **{f"AI-33.preempts-{kind}": {f"AI-33.{kind}": "b"} for kind in ("null", "blank", "node", "unknown")},
    "AI-31.read": {"AI-31.preempted": "b", "AI-31.unusable": "b"},
}
"""What has to fail, or to wait, for it to matter what becomes of the mission that runs, or when a line is read."""
FOLLOWED = [one for one in AMBIGUITIES if one.id not in UNASKED]


@pytest.mark.long
@pytest.mark.parametrize(
    ("entry", "letter"), [(one.id, letter) for one in FOLLOWED for letter in one.readings if letter != one.default]
)
def test_the_reference_follows_every_reading(entry: str, letter: str) -> None:
    """The reference under a single other reading conforms, and is found to follow it."""
    run = run_of("isaac.robot", ReferenceSubject(ROBOT, {entry: letter, **NEEDS.get(entry, {})}))
    assert (explained(run, 12, 30), run.ledger.readings[entry]) == (True, (letter,))


@needs_node
def test_an_independent_robot_conforms() -> None:
    """The Node.js robot, written from the page alone, can be explained."""
    with node("isaac.robot") as subject:
        assert explained(run_of("isaac.robot", subject), 15, 30)


COMMON_BREAKS = (
    "running-missing",
    "running-after-final",
    "success-missing",
    "final-twice",
    "failure-as-success",
    "deaf-after-failure",
    "bad-config-succeeds",
    "preempted-silently",
    "preempted-too-late",
    "preemption-ignored",
    "status-on-mission-channel",
    "uuid-rounded",
)
"""One of each kind; the others are tried where there is time."""


def uncaught(names: Iterable[str]) -> list[str]:
    """Which breaks of the Node.js robot are not found."""
    automaton = Automaton(ROBOT.spec, tuple(ROBOT.spec.drives))
    survived = []
    for one in names:
        with node("isaac.robot", "--break", one) as subject:
            if explained(run_of("isaac.robot", subject, automaton), 8, 25):
                survived.append(one)
    return survived


@needs_node
def test_breaks_of_the_independent_robot_are_caught() -> None:
    """What the Node.js robot does wrong on purpose no reading explains."""
    assert set(COMMON_BREAKS) < set(breaks("isaac.robot"))
    assert uncaught(COMMON_BREAKS) == []


@needs_node
@pytest.mark.long
def test_every_other_break_of_the_independent_robot_is_caught() -> None:
    """So it is with all the others."""
    others = [one for one in breaks("isaac.robot") if one not in COMMON_BREAKS]
    assert len(others) > 15
    assert uncaught(others) == []


def test_what_cannot_be_used_may_be_passed_over() -> None:
    """AI-33.unusable c: such a message is no mission, with and without one that runs; that is accepted and flagged."""
    verdict = judged(arrives(ONE, "no json"), passes(1), arrives(ONE), says("running"), arrives(TWO, "no json"),
                     passes(1), says("running"), SUCCEEDED, says("success"), SETTLED)  # fmt: skip
    assert verdict.conforms, str(verdict)
    assert "AI-33.unusable=c" in [one.partition(" ")[0] for one in verdict.flagged]


def test_what_is_passed_over_may_end_what_runs() -> None:
    """AI-33.unusable c, AI-33.preempts a: the mission that runs is preempted, and nothing is said of the new one."""
    passed_over = {"AI-33.unusable": "c"}
    history = (arrives(ONE), says("running"), arrives(TWO, "no json"), says("failure"), passes(1))
    verdict = judged(*history, SETTLED, **passed_over)
    assert verdict.conforms, str(verdict)
    assert verdict.readings["AI-33.preempts"] == ("a",)
    assert not judged(*history, says("failure", TWO), SETTLED, **passed_over).conforms


def test_every_broken_rule_is_noticed() -> None:
    """Whichever rule the reference breaks, in whichever way, the oracle notices."""
    found = teeth(ROBOT)
    assert (found.killed, found.survived, found.allowed, found.untested) == (30, (), (), ())


def _taking_turns(times: int, last: Any) -> tuple[Any, ...]:
    """Two missions that preempt one another again and again, the same one twice at first; then something else."""
    lines: list[Any] = [arrives(ONE), says("running"), arrives(ONE)]
    for number in range(times):
        old, new = (ONE, TWO) if number % 2 == 0 else (TWO, ONE)
        lines += [arrives(new), says("failure", old), says("running", new), SETTLED]
    return (*lines, last, SETTLED)


@pytest.mark.parametrize("times", [2, 3, 4])
def test_missions_that_were_there_before_come_again(times: int) -> None:
    """Each comes back after it was preempted, and what is said is of the one that runs."""
    runs, other = (ONE, TWO) if times % 2 == 0 else (TWO, ONE)
    assert judged(*_taking_turns(times, says("running", runs))).conforms
    assert judged(*_taking_turns(times, says("running", runs)), **{"AI-32.same": "b"}).conforms
    assert not judged(*_taking_turns(times, says("running", other))).conforms


@pytest.mark.parametrize(
    ("silence", "right"), [((45, 30), True), ((60, 25), True), ((60, 40), False), ((3600,), False)]
)
def test_the_name_may_come_once_a_minute_but_has_to_come_again(silence: tuple[float, ...], *, right: bool) -> None:
    """How often it comes is not said: more than a minute may pass without; one that never comes again is noticed."""
    name = {"connection": 1, "line": encode(Message(Header("name", 1, 1), TextProto("robot"))).decode().strip()}
    waits = [one for seconds in silence for one in (passes(seconds), SETTLED)]
    assert judged(name, passes(60), name, SETTLED, *waits).conforms is right
    assert judged(name, passes(60), name, SETTLED, *waits[:-2], waits[-2], name, SETTLED).conforms


def test_every_mission_that_is_tried_comes_in_a_message_of_its_own() -> None:
    """A header has its message's uuid, another one each time: a robot may take equal ones for a repeat."""
    tried = [
        fill(drive, {}, ROBOT.naming, serial) for serial in (1, 2) for drive in ROBOT.alphabet({}, Bounds()).drives
    ]
    lines = [json.loads(drive["line"]) for drive in tried if drive.get("line", "").startswith('{"header":{"channel"')]
    missions = [line for line in lines if "config" in line["payload"]]
    messages = {str(line["header"]["uuid"]) for line in missions}
    assert messages.isdisjoint(str(line["payload"]["uuid"]) for line in missions)
    assert len(messages) == 2
