"""``missionfsm new``: a package with a system that works at once."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from commandline import CommandLine

from missionfsm.kernel.codec import Codec, Malformed, UnreadableError

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
    assert (ran.returncode, "3 passed" in ran.stdout) == (0, True), ran.stdout
    [(name, place)] = tomllib.loads((root / "pyproject.toml").read_text())["project"]["entry-points"][
        "missionfsm.systems"
    ].items()
    about = root / "desk_lamp-0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: desk-lamp\nVersion: 0\n")
    (about / "entry_points.txt").write_text(f"[missionfsm.systems]\n{name} = {place}\n")
    monkeypatch.syspath_prepend(str(root))
    assert command_line("explore", "desk_lamp").status == 0
    assert "The lamp is burnt out." in command_line("rules", "desk_lamp").out
    assert "desk_lamp" in command_line("readings", "desk_lamp", "--json").out
    history = root / "one.jsonl"
    history.write_text(
        '{"missionfsm": 1, "system": "desk_lamp", "drives": ["burnOut"]}\n'
        '{"call": 1, "method": "Switch", "params": {}}\n{"return": 1, "result": {"light": "off"}}\n'
    )
    assert command_line("check", history).status == 1


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
    assert len(pieces) == 4
    assert [piece for piece in pieces if piece not in source] == []
