"""What a verdict says first: what it rests on, what departs from the text, and what it leaves to be asked for."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
from pathlib import Path

import orjson
import pytest
from attrs import evolve
from broken import BUSY, MISSION
from commandline import CommandLine

import missionfsm
from missionfsm.app.recorded import check_file
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Settled
from missionfsm.kernel.subject import Exchange
from missionfsm.systems import system
from missionfsm.tools.check.basis import Flagged, Untested, readings_line
from missionfsm.tools.check.eliminations import Elimination, by_ambiguity
from missionfsm.tools.check.github import workflow_commands
from missionfsm.tools.check.narrate import story
from missionfsm.tools.check.scope import untested
from missionfsm.tools.check.verdict import Outcome, Verdict, Violation
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.explore.undriven import Missed, missed_without
from missionfsm.tools.reference.subject import ReferenceSubject

FIRST = '{"missionfsm": 1, "system": "bear.mission"}'
CREATE: JSON = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
DRIVES = ("goalReached", "missionSucceeded", "missionFailed", "world", "fault")
OTHERS = tuple(one for one in MISSION.codec.methods if one != "CreateMission")
MISSED = "so that 13 rules could not be tested"
ESCAPES = re.compile(r"\x1b\[[\d;?]*[A-Za-z]")


def two_creates(path: Path) -> Path:
    """Two missions are created one after the other, though the page refuses the second; nothing says what happened."""
    lines = [FIRST]
    for call in (1, 2):
        lines += [orjson.dumps({"call": call, "method": "CreateMission", "params": CREATE}).decode()]
        lines += [orjson.dumps({"return": call, "result": {"missionId": f"m{call}"}}).decode()]
    path.write_text("\n".join(lines) + "\n")
    return path


def skipped(path: Path) -> Path:
    """A goal is skipped though there is no mission."""
    path.write_text(f'{FIRST}\n{{"call": 1, "method": "SkipGoal", "params": {{}}}}\n{{"return": 1, "result": {{}}}}\n')
    return path


def test_a_log_without_drives_conforms_in_part(tmp_path: Path) -> None:
    """Where two creates succeed in a row the robot may have failed unseen in between, and the verdict says so."""
    ((_, verdict),) = check_file(str(two_creates(tmp_path / "log")))
    first, *basis = verdict.text().splitlines()[:4]
    assert first == "conforms in part: bear.mission, 4 events"
    assert basis == [
        f"  calls: 1 of 10 succeeded; not tried: {', '.join(OTHERS[:4])} and 5 more",
        "  readings: none departs from the text; 1 mattered, 1 of them still open",
        f"  drives: 5 of 5 missing ({', '.join(DRIVES)}); what they do may have happened unseen, {MISSED}",
    ]
    assert verdict.to_json()["headline"] == "conforms in part"
    missed = missed_without(MISSION, frozenset(DRIVES))
    assert (verdict.untested.refusals, verdict.untested.promises) == (missed.refusals, missed.promises)


def test_what_is_missed_without_drives_is_what_the_robot_may_have_left() -> None:
    """Refusals that rest on a mission under way need the drives that end it, and no others."""
    missed = missed_without(MISSION, frozenset(DRIVES))
    assert BUSY in missed.refusals
    assert {rule.split("/")[2] for rule in missed.refusals} == {"FAILED_PRECONDITION"}
    assert missed_without(MISSION, frozenset()) == missed_without(MISSION, frozenset({"world", "fault"})) == Missed()
    assert set(missed_without(MISSION, frozenset({"goalReached"})).refusals) < set(missed.refusals)


@pytest.mark.parametrize(
    ("name", "drive", "promises"),
    [
        ("bear.mission", "missionFailed", ["lifecycle/fail"]),
        ("bear.status", "report", ["messages/updates-follow-the-state"]),
        ("isaac.server", "advance", ["timeout/start-timeout-aborts", "timeout/silence-is-no-loss"]),
        ("isaac.robot", "behaviorFailed", ["status/one-failure-at-the-end"]),
    ],
)
def test_what_only_a_drive_leads_to_is_missed_without_it(name: str, drive: str, promises: list[str]) -> None:
    """Of every system the rules are counted that no step rests on but for a drive that is missing."""
    missed = missed_without(system(name), frozenset({drive}))
    assert list(missed.promises) == [f"{name}/{one}" for one in promises]


def test_what_never_happens_by_itself_has_not_happened_unseen() -> None:
    """Where a robot has no drive for a connection that drops, nothing is said of what may have come between."""
    gaps = untested(system("isaac.robot").spec, {}, ("line", "behaviorSucceeded", "behaviorFailed", "advance"), ())
    assert gaps.drives_line() == "drives: 2 of 6 missing (disconnect, connect)"


class Without:
    """A reference that has not all calls."""

    def __init__(self, *absent: str) -> None:
        self._reference = ReferenceSubject(MISSION)
        self._absent = absent

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Ask it."""
        if method in self._absent:
            return Exchange((), error={"status": "UNIMPLEMENTED", "message": ""})
        return self._reference.exchange(method, params)

    def close(self) -> None:
        """Nothing is held."""


@pytest.mark.long
def test_a_robot_without_four_of_ten_calls_conforms_in_part() -> None:
    """The calls that it answers UNIMPLEMENTED are named."""
    absent = ("AppendMissionBatch", "ChargeRobot", "SkipGoal", "UpdateMission")
    verdict = conform(MISSION, Without(*absent), drawn=5, tours=40, steps=20, seed=1, advice=False)
    assert verdict.headline == "conforms in part, flagged"
    assert verdict.rests_on()[0] == f"calls: 6 of 10 succeeded; not there: {', '.join(absent)}"
    assert verdict.rests_on()[2] == "drives: all 5 commanded"


def test_a_drive_that_is_left_out_was_not_commanded() -> None:
    """The headline counts what this run left out as missing; the robot does none of it by itself."""
    robot = system("isaac.robot")
    subject = ReferenceSubject(robot)
    verdict = conform(robot, subject, drawn=2, tours=3, steps=10, seed=1, advice=False, without=["connect"])
    assert verdict.rests_on()[-1] == "drives: 1 of 6 missing (connect)"


def test_what_has_no_gap_conforms() -> None:
    """A robot whose every drive was commanded, and which departs from nothing, simply conforms."""
    robot = system("isaac.robot")
    verdict = conform(robot, ReferenceSubject(robot), drawn=3, tours=5, steps=20, seed=1, advice=False)
    assert verdict.headline == "conforms"
    assert verdict.rests_on()[-1] == "drives: all 6 commanded"


def test_what_departs_from_the_text_stands_in_the_headline() -> None:
    """Readings that depart are named and come before open ones; what is decided is told only where it is wanted."""
    verdict = Verdict(
        Outcome.CONFORMS,
        "s",
        readings={"Q-1": ("b",), "Q-2": ("a", "b"), "Q-3": ("a",)},
        flagged=(
            Flagged("Q-1=b departs from the text: why", "Q-1=b"),
            Flagged("incoherent, calls that look alike are read differently: …"),
        ),
        untested=Untested(operations=2, all_drives=1),
    )
    folded = [
        "conforms, flagged: s, 0 events",
        "  calls: all 2 succeeded",
        "  readings: 1 departs from the text (Q-1=b); 1 besides that is flagged; 3 mattered, 1 of them still open",
        "  drives: all 1 commanded",
        "",
        "flagged:",
        *(f"  {one}" for one in verdict.flagged),
        "",
        "readings still open:",
        "  Q-2 = a or b",
    ]
    assert verdict.text().splitlines() == [*folded, "-v shows what decided 2 readings"]
    assert verdict.text(verbose=True).splitlines() == [*folded, "", "readings followed:", "  Q-1 = b", "  Q-3 = a"]
    assert readings_line({}, ()) == "readings: none departs from the text; none mattered"


def test_calls_that_never_succeeded_say_how_they_were_answered() -> None:
    """Of what was tried in vain the codes stand there; what a stream showed is taken into account."""
    gaps = Untested(
        {"A": "never succeeded: NOT_FOUND 2 times"},
        drives=("d",),
        refusals=("s/A/NOT_FOUND/r",),
        unseen=True,
        operations=2,
        all_drives=2,
        shown=True,
    )
    assert (gaps.calls_line(), gaps.drives_line()) == (
        "calls: 1 of 2 succeeded; never succeeded: A (NOT_FOUND 2 times)",
        "drives: 1 of 2 missing (d); what they do may have happened unseen, so that 1 rule could be tested only"
        " where a stream showed whether it had",
    )


def test_a_story_tells_an_unusual_world() -> None:
    """The members of a world that are not as usual stand before the story; the usual world is not told."""
    head: JSON = {"missionfsm": 1, "system": "bear.mission", "world": {"family": "base", "contactDock": True}}
    call: JSON = {"call": 1, "method": "SkipGoal", "params": {}}
    assert story(MISSION, (head, call)).splitlines() == ['  0. in the world {"family": "base"}', "  1. SkipGoal()"]
    assert story(MISSION, ({**head, "world": {}}, call)) == "  1. SkipGoal()"


def test_the_rule_ids_that_are_told_can_be_expected(command_line: CommandLine, tmp_path: Path) -> None:
    """What a violation names as --expect-violations takes it makes up such a file."""
    log = skipped(tmp_path / "log")
    told = command_line("check", log).out
    ids = re.search(r"as --expect-violations takes it:\n((?: {4}\S+\n)+)", told)
    assert ids is not None
    (tmp_path / "known").write_text(ids[1])
    assert command_line("check", log, "--expect-violations", tmp_path / "known").status == 0


def test_rules_of_what_was_met_before_it_was_made_short_are_told_as_such(tmp_path: Path) -> None:
    """Where the short story breaks other rules than the one that was met, what is expected is told apart from it."""
    ((_, verdict),) = check_file(str(skipped(tmp_path / "log")))
    assert verdict.violation is not None
    other = evolve(verdict, violation=evolve(verdict.violation, listed=("bear.mission/other/rule",)))
    lines = other.text().splitlines()
    at = lines.index("  as --expect-violations takes it (by the rules that it broke before it was made short):")
    assert lines[at + 1] == "    bear.mission/other/rule"
    assert "  as --expect-violations takes it:" in verdict.text().splitlines()


def test_what_is_possible_is_not_told_as_ruled_out() -> None:
    """A short story may leave open what another conversation has ruled out: it is told as open."""
    asked = MISSION.spec.ambiguities[0]
    gone = Elimination(MISSION.spec, Settled(), None)
    found = {(asked.id, letter): gone for letter in asked.readings}
    left, *others = asked.readings
    assert by_ambiguity((asked,), found, {asked.id: (left,)}) == {asked.id: dict.fromkeys(others, "everything settled")}


def test_what_is_written_says_how_it_was_made(command_line: CommandLine, tmp_path: Path) -> None:
    """JSON and pages carry version, date and command."""
    log, json, html = two_creates(tmp_path / "log"), tmp_path / "out.json", tmp_path / "out.html"
    command_line("check", log, "--json", json, "--html", html)
    made = orjson.loads(json.read_bytes())["made"]
    assert (made["version"], made["command"]) == (
        missionfsm.__version__,
        f"missionfsm check {log} --json {json} --html {html}",
    )
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", made["date"])
    page = html.read_text()
    assert f"missionfsm {made['version']}, {made['date'][:10]}" in page
    assert "<strong>conforms in part</strong>" in page


def test_a_terminal_sees_colour_and_no_line_that_is_wider(tmp_path: Path) -> None:
    """On a terminal lines are folded at its width, with their words whole, and the outcome has a colour."""
    log = two_creates(tmp_path / "log")
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [sys.executable, "-m", "missionfsm", "check", str(log)],
        stdout=theirs,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "COLUMNS": "60", "TERM": "xterm-256color", "GITHUB_ACTIONS": ""},
    ) as child:
        os.close(theirs)
        said = b""
        while chunk := _read(ours):
            said += chunk
        assert child.wait() == 0
    lines = said.decode().replace("\r\n", "\n").splitlines()
    plain = [ESCAPES.sub("", line) for line in lines]
    assert max(map(len, plain)) <= 60
    assert any("\x1b[1;33mconforms in part" in line for line in lines)
    assert any(line.startswith("      ") for line in plain)


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 65536)
    except OSError:  # the child has closed it
        return b""


@pytest.mark.parametrize("asked", ["--github", "GITHUB_ACTIONS"])
def test_github_shows_what_is_wrong_where_it_is(
    asked: str, command_line: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a workflow, or where it is asked for, a violation is an error at its line of the file."""
    log = skipped(tmp_path / "log")
    monkeypatch.setenv("GITHUB_ACTIONS", "true" if asked == "GITHUB_ACTIONS" else "")
    options = [asked] if asked == "--github" else []
    last = command_line("check", log, *options).out.splitlines()[-1]
    assert last.startswith(
        f"::error file={log},line=3,title=violates%3A bear.mission::line 3: SkipGoal() was answered OK"
    )
    assert "%0A" in last
    assert "::error" not in command_line("check", log, "--no-github").out


def test_annotations_are_of_one_line_each() -> None:
    """What departs from the text is a warning, a live robot has no file, and no text can end a command early."""
    flagged = Verdict(Outcome.CONFORMS, "s", flagged=("Q-1=b departs: 100%\nof it",))
    wrong = Verdict(Outcome.VIOLATES, "s", violation=Violation((), "a\x1b[31m", (), at=4))
    assert list(workflow_commands([("f,1", "r", flagged), (None, "robot 1", wrong)])) == [
        "::warning file=f%2C1,line=1,title=conforms, flagged%3A r::Q-1=b departs: 100%25%0Aof it".replace(
            "conforms, flagged", "conforms%2C flagged"
        ),
        "::error title=violates%3A robot 1::a\\x1b[31m%0A  nothing was allowed here",
    ]


def test_a_request_that_may_be_malformed_is_told_as_it_was_sent(tmp_path: Path) -> None:
    """Where the verdict says that something is wrong with a request, the request stands there, as JSON."""
    params = {"mission": {"baseMission": {"navigateMission": {"goal": {"pose": {"xMeters": "NaN"}}}}}}
    log = tmp_path / "log"
    log.write_bytes(
        b"\n".join(
            [
                b'{"missionfsm": 1, "system": "bear.mission", "world": {"family": "base"}}',
                orjson.dumps({"call": 1, "method": "CreateMission", "params": params}),
                b'{"return": 1, "result": {"missionId": "m"}}\n',
            ]
        )
    )
    ((_, verdict),) = check_file(str(log))
    assert verdict.violation is not None
    assert [line for line in str(verdict).splitlines() if "xMeters" in line] == [
        '  sent: {"mission": {"baseMission": {"navigateMission": {"goal": {"pose": {"xMeters": "NaN"}}}}}}'
    ]
    ((_, other),) = check_file(str(skipped(tmp_path / "skipped")))
    assert other.violation is not None
    assert other.violation.sent == ""
