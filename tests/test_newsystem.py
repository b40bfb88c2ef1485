"""``missionfsm new``: a package with a system that works at once."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Literal

import pytest
from attrs import evolve, frozen
from commandline import CommandLine

from missionfsm.app.lamp import SYSTEM
from missionfsm.kernel.codec import NAMED, Codec, Malformed, UnreadableError
from missionfsm.kernel.history import Answer
from missionfsm.kernel.typed import reads

PAGE = Path(__file__).parent.parent / "docs" / "your-own-system.md"


def test_what_is_written_works_at_once(
    command_line: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its own tests are green, and installed it is a system like ours."""
    monkeypatch.chdir(tmp_path)
    assert command_line("new", "desk_lamp").status == 0
    root = tmp_path / "desk_lamp"
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"],
        cwd=root,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert (ran.returncode, "4 passed" in ran.stdout) == (0, True), ran.stdout
    page = (root / "specification.md").read_text()
    assert "| FAILED_PRECONDITION | `there-is-no-light` | The light is off, and only light can be dimmed. |" in page
    assert (
        "| (promise) | `the-light-is-shown` | A stream shows the light at once, then every change. |  | L-4 |" in page
    )
    assert "**LA-01** What does Dim do to a light that is dim?" in page
    [(name, place)] = tomllib.loads((root / "pyproject.toml").read_text())["project"]["entry-points"][
        "missionfsm.systems"
    ].items()
    about = root / "desk_lamp-0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: desk-lamp\nVersion: 0\n")
    (about / "entry_points.txt").write_text(f"[missionfsm.systems]\n{name} = {place}\n")
    monkeypatch.syspath_prepend(str(root))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join((str(root), os.environ.get("PYTHONPATH", ""))))
    assert command_line("explore", "desk_lamp").status == 0
    assert "The light is off, and only light can be dimmed." in command_line("rules", "desk_lamp").out
    assert "desk_lamp" in command_line("readings", "desk_lamp", "--json").out
    assert command_line("conform", "desk_lamp", "--examples", "10").status == 0
    assert "5 of 5 mutants killed" in command_line("teeth", "desk_lamp").out
    assert command_line("diagram", "desk_lamp", "-o", "pictures").status == 0
    assert "timeIsUp" in (tmp_path / "pictures" / "desk_lamp" / "states.mmd").read_text()
    history = root / "one.jsonl"
    history.write_text(
        '{"missionfsm": 1, "system": "desk_lamp", "drives": ["timeIsUp"]}\n'
        '{"call": 1, "method": "Dim", "params": {}}\n{"return": 1, "result": {}}\n'
    )
    assert command_line("check", history).status == 1


def test_a_small_system_stays_small() -> None:
    """A lamp with a timer, a call, a refusal, an ambiguity, a stream and a drive takes about eighty lines."""
    source = (Path(__file__).parent.parent / "missionfsm" / "app" / "lamp.py").read_text()
    assert len(source.splitlines()) <= 90


def test_what_the_language_fills_in_refuses_what_there_is_not() -> None:
    """A codec that leaves everything out reads its own methods and drives, and says of others what there are."""
    codec = Codec(methods=("Switch",), events=("burnOut",))
    event, names = codec.read_drive({"event": "burnOut"})
    assert (codec.read_request("Switch", {}), names, codec.write_drive(event, names)) == (
        "Switch",
        (),
        {"event": "burnOut"},
    )
    with pytest.raises(UnreadableError, match="'Blink' is not a method; those are Switch"):
        codec.read_request("Blink", {})
    with pytest.raises(UnreadableError, match="'blink' is not a drive; those are burnOut"):
        codec.read_drive({"event": "blink"})
    answer, _ = codec.read_answer("Switch", {"light": "on"})
    assert isinstance(answer.shape, Malformed)


def test_what_the_language_fills_in_goes_by_what_a_changed_codec_has() -> None:
    """Whoever makes a codec of another one has its readers look at the new methods, streams, drives and names."""
    codec = evolve(Codec(methods=("Switch",)), methods=("Call", "Watch"), streams=("Watch",), answers={"Call": "ride"})
    assert codec.read_request("Call", {}) == "Call"
    assert codec.read_answer("Call", {"ride": "r1"}) == (Answer("OK"), (("ride", "r1"),))
    assert codec.read_answer("Watch", {"stream": 3}) == (Answer("OK"), (("stream", 3),))
    assert isinstance(codec.read_answer("Watch", {"stream": True})[0].shape, Malformed)
    happened = evolve(evolve(codec, events=("burnOut",)), read_drive=lambda _: ("all", ()))
    assert happened.read_drive_result({}) == ("all", ())


def test_a_system_fills_in_the_calls_and_drives_of_its_codec() -> None:
    """What the specification has need not be said again; a partner that has fewer keeps fewer."""
    methods = ("Switch", "Dim", "Watch")
    assert (SYSTEM.codec.methods, SYSTEM.codec.streams, SYSTEM.codec.events) == (methods, ("Watch",), ("timeIsUp",))
    assert evolve(SYSTEM, codec=evolve(SYSTEM.codec, methods=())).codec.methods == ()
    spec = SYSTEM.spec
    fewer = evolve(SYSTEM, spec=evolve(spec, operations=[spec.operations["Switch"]], drives=()))
    assert (fewer.codec.methods, fewer.codec.streams, fewer.codec.events) == (("Switch",), (), ())


def test_names_stand_beside_what_is_left_of_a_message() -> None:
    """The texts under the keys of names are taken out of JSON, wherever they stand, and put back."""
    message = {"rides": [{"ride": "r1", "floor": 2}, {"ride": "r2", "floor": 0}], "ride": 7}
    codec = Codec(names=("ride",))
    ((names, marks, rest),) = codec.split_message(message)
    assert (names, marks) == ((("ride", "r1"), ("ride", "r2")), ())
    assert rest == {"rides": [{"ride": NAMED, "floor": 2}, {"ride": NAMED, "floor": 0}], "ride": 7}
    assert codec.write_message(rest, names, 0, 1, 0.0) == message


@frozen
class _Goal:
    name: str
    at: int
    note: str | None = None


@frozen
class _Tour:
    goals: tuple[_Goal, ...]
    state: Literal["idle", "busy"]
    speed: float = 1.0


@pytest.mark.parametrize(
    ("message", "content"),
    [
        ({"goals": [{"name": "a", "at": 1}], "state": "idle"}, _Tour((_Goal("a", 1),), "idle")),
        ({"goals": [], "state": "busy", "speed": 2, "more": []}, _Tour((), "busy", 2)),
        (
            {"goals": [{"name": "a", "at": True}], "state": "on"},
            Malformed("true is no int @ $.goals.at; 'on' is none of idle, busy @ $.state"),
        ),
        ({"goals": "ab"}, Malformed("'ab' is no list @ $.goals; state is missing @ $.state")),
        ({"goals": [7], "state": []}, Malformed("7 is no object @ $.goals; [] is none of idle, busy @ $.state")),
        (None, Malformed("null is no object @ $")),
    ],
)
def test_a_class_says_what_is_right(message: object, content: object) -> None:
    """JSON is read as the annotations say, strictly; whatever else it is, is told in one line."""
    assert reads(_Tour)(message) == content


@pytest.mark.parametrize("name", ["Lamp", "my-lamp", "../lamp", "class", "taken"])
def test_a_name_that_will_not_do_is_bad_input(
    command_line: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    """What is no name of a package, and what is there already, is one line and exit status 2; nothing is written."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").mkdir()
    ended = command_line("new", name)
    assert (ended.status, ended.err.count("\n"), [one.name for one in tmp_path.iterdir()]) == (2, 1, ["taken"])


def test_the_page_shows_what_is_written() -> None:
    """Every piece of code on the page about it is in the file."""
    source = (Path(__file__).parent.parent / "missionfsm" / "app" / "lamp.py").read_text()
    pieces = re.findall(r"<!-- run: lamp -->\n```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    assert len(pieces) == 6
    assert [piece for piece in pieces if piece not in source] == []
