"""``missionfsm diagram``: what goes to stdout, what into files, and how bad usage ends."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from commandline import CommandLine

from missionfsm.isaac.server.plans import FORKLIFTS
from missionfsm.tools.draw.gallery import FORMATS, SVG, Picture


@pytest.fixture
def without_dot(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No program can be found."""
    monkeypatch.setenv("PATH", str(tmp_path / "nothing"))


def files(folder: Path) -> list[str]:
    return sorted(one.relative_to(folder).as_posix() for one in folder.rglob("*") if one.is_file())


@pytest.mark.parametrize("form", sorted(set(FORMATS) - {SVG}))
def test_one_picture_goes_to_stdout(form: str, command_line: CommandLine, gallery: dict[str, Picture]) -> None:
    """One picture in one format is written to stdout, and nothing else is."""
    ended = command_line("diagram", "bear.mission/mission", "--format", form)
    assert (ended.status, ended.out, ended.err) == (0, FORMATS[form].write(gallery["bear.mission/mission"]), "")


def test_dot_is_what_is_written_where_no_format_is_said(command_line: CommandLine) -> None:
    """A picture without a format is DOT."""
    ended = command_line("diagram", "isaac.robot/codelet")
    assert ended == command_line("diagram", "isaac.robot/codelet", "--format", "dot")
    assert ended.out.startswith('digraph "isaac.robot: codelet" {')


def test_a_system_goes_into_files(command_line: CommandLine, tmp_path: Path) -> None:
    """All pictures of a system in one format; the page of all pictures is left alone."""
    ended = command_line("diagram", "isaac.robot", "--format", "mermaid", "-o", tmp_path)
    stems = ("codelet", "reports-AI-33.unusable-a-b", "reports")
    assert (ended.status, files(tmp_path)) == (0, [f"isaac.robot/{stem}.mmd" for stem in stems])
    assert ended.out == f"3 files in {tmp_path}: .mmd\n"


def test_readings_are_named_in_titles_and_files(command_line: CommandLine, tmp_path: Path) -> None:
    """A picture under another reading is another file, and says so."""
    ended = command_line("diagram", "bear.mission/queue", "--reading", "AM-09=c", "--format", "dot")
    assert "bear.mission: a robot&#39;s missions, AM-09=c" in ended.out.replace("&#x27;", "&#39;")
    assert "halted" not in ended.out
    halted = command_line("diagram", "bear.mission/queue", "--reading", "AM-09=b")
    assert "halted" in halted.out
    versus = ("--reading", "AM-11=b", "--versus", "AM-09=c")
    command_line("diagram", "bear.mission", *versus, "--format", "table", "-o", tmp_path)
    assert files(tmp_path) == ["bear.mission/queue-AM-11-b-AM-09-AM-09.skip-aa-cc.md"]


def test_an_entry_speaks_for_all_of_its_parts(command_line: CommandLine) -> None:
    """``AM-17`` stands for all of ``AM-17.last`` and ``AM-17.patrol``, as it does elsewhere."""
    ended = command_line("diagram", "bear.mission", "--versus", "AM-17=d", "--format", "mermaid")
    assert (ended.status, ended.err) == (0, "")
    assert "AM-17.last.base-navigate=a, AM-17.last.base-navigate-auto=a, " in ended.out
    assert "AM-17.patrol.carti-traverse-patrol=d" in ended.out


def test_refusals_are_told_if_asked_for(command_line: CommandLine) -> None:
    """The picture tells of refusals only with ``--refusals``."""
    plain = command_line("diagram", "bear.mission/queue", "--format", "plantuml")
    told = command_line("diagram", "bear.mission/queue", "--format", "plantuml", "--refusals")
    refused = (
        "RUNNING, others wait; PAUSED, others wait: may be refused (NOT_FOUND): UpdateMission of a waiting mission\n"
    )
    assert (refused in plain.out, refused in told.out) == (False, True)


def test_mission_files_are_drawn(command_line: CommandLine, tmp_path: Path) -> None:
    """The missions of a file with those that they wait for; a file with a problem ends with 2 and the place."""
    good, bad = tmp_path / "box.json", tmp_path / "bad.json"
    good.write_text(FORKLIFTS)
    bad.write_text(FORKLIFTS.replace("[0, 1]", "[0, 4]"))
    ended = command_line("diagram", "--missions", good, "--format", "table")
    assert (ended.status, ended.out.splitlines()[4]) == (0, "| 2 | arm01, move-the-box | 0, 1 |")
    wrong = command_line("diagram", "--missions", bad)
    place = f"missionfsm: {bad}: missions[2].upstream: each waits for the next, in a cycle: "
    assert (wrong.status, wrong.out, wrong.err) == (2, "", f"{place}missions[2] -> missions[4] -> missions[2]\n")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--format", "png"), "--format png: there are dot, svg, mermaid, plantuml, scxml, xstate, table"),
        (
            ("isaac.robot", "--missions", "box.json"),
            "--missions draws a mission file, which needs no SYSTEM and has no readings and no refusals",
        ),
        (("--missions", "no.json"), "no.json: No such file or directory"),
        (("nowhere",), "there is no system 'nowhere'; there are bear.mission, bear.status, isaac.server, isaac.robot"),
        (
            ("isaac.robot/queue",),
            "there is no picture isaac.robot/queue; there are isaac.robot/codelet, isaac.robot/reports, "
            "isaac.robot/reports-AI-33.unusable-a-b",
        ),
        (
            ("isaac.robot",),
            "only one picture in one format goes to stdout; name a folder with -o, or one of isaac.robot/codelet, "
            "isaac.robot/reports, isaac.robot/reports-AI-33.unusable-a-b",
        ),
        (
            ("bear.mission/mission", "--format", "svg"),
            "as svg, bear.mission/mission is 2 pictures: name one of bear.mission/mission-way, "
            "bear.mission/mission-ends, or a folder with -o",
        ),
        (
            ("isaac.robot/reports", "--format", "xstate"),
            "isaac.robot/reports cannot be had as xstate: only a lifecycle is a machine, in which every event leads to "
            "one state",
        ),
        (("isaac.robot", "--reading", "AM-09=b"), "isaac.robot: there is no ambiguity AM-09"),
        (
            ("bear.mission", "--reading", "AM-09"),
            "--reading AM-09: expected an ambiguity and a letter, such as AM-09=a",
        ),
        (
            ("bear.mission", "--versus", "AM-09=z"),
            "AM-09 has no reading z: AM-09 has a, b, c, d; AM-09.skip has a, b, c, d",
        ),
        (
            ("bear.mission", "--versus", "AM-09=a"),
            "--versus AM-09=a: that is how it is read anyway, so there is nothing to tell apart",
        ),
    ],
)
def test_bad_usage_ends_in_one_line(arguments: tuple[str, ...], says: str, command_line: CommandLine) -> None:
    """Whatever is asked for that there is not: status 2, and one line that says what there is."""
    ended = command_line("diagram", *arguments)
    assert (ended.status, ended.out, ended.err) == (2, "", f"missionfsm: {says}\n")


def test_a_folder_that_cannot_be_written(command_line: CommandLine, tmp_path: Path) -> None:
    """A folder that is a file ends with 2."""
    taken = tmp_path / "taken"
    taken.write_text("")
    ended = command_line("diagram", "isaac.robot", "--format", "dot", "-o", taken)
    assert (ended.status, ended.err) == (2, f"missionfsm: {taken / 'isaac.robot'}: Not a directory\n")


NO_DOT = "missionfsm: SVG is drawn by Graphviz, whose program dot was not found: install the package graphviz\n"


@pytest.mark.usefixtures("without_dot")
def test_svg_without_graphviz_says_what_to_install(command_line: CommandLine) -> None:
    """SVG without Graphviz ends with 2 and one line."""
    ended = command_line("diagram", "isaac.robot/codelet", "--format", "svg")
    assert (ended.status, ended.out, ended.err) == (2, "", NO_DOT)


@pytest.mark.usefixtures("without_dot")
def test_everything_else_works_without_graphviz(
    command_line: CommandLine, gallery: dict[str, Picture], tmp_path: Path
) -> None:
    """Where all formats are asked for all but SVG are written before that is said."""
    ended = command_line("diagram", "-o", tmp_path)
    assert (ended.status, ended.out, ended.err) == (2, "", NO_DOT)
    other = {form: made for form, made in FORMATS.items() if form != SVG}
    expected = [f"{one.id}{made.suffix}" for one in gallery.values() for made in other.values() if made.write(one)]
    assert files(tmp_path) == sorted([*expected, "README.md"])


def test_svg_is_drawn_by_graphviz(command_line: CommandLine) -> None:
    """An SVG has the title of its picture."""
    if not shutil.which("dot"):
        pytest.skip("Graphviz is not installed, which draws SVG")
    ended = command_line("diagram", "isaac.server/forklifts", "--format", "svg")
    assert (ended.status, "two forklifts and an arm move a box" in ended.out, ended.out.count("<svg")) == (0, True, 1)
