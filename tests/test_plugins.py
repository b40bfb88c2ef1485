"""Systems of other packages: found by their entry points."""

from __future__ import annotations

from pathlib import Path

import pytest
from commandline import CommandLine

from missionfsm.systems import names, system, title


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package with a system that is one of ours by another name, one that fails to load, and one that is none."""
    (tmp_path / "far_away.py").write_text(
        "from attrs import evolve\nfrom missionfsm.isaac.robot.system import SYSTEM as OURS\n"
        "SYSTEM = evolve(OURS, name='far.away')\n"
    )
    about = tmp_path / "far_away-1.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: far-away\nVersion: 1\n")
    (about / "entry_points.txt").write_text(
        "[missionfsm.systems]\nfar.away = far_away:SYSTEM\nbear.mission = far_away:SYSTEM\n"
        "far.broken = far_away:NOTHING\nfar.wrong = far_away:evolve\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))


@pytest.mark.usefixtures("installed")
def test_a_system_of_another_package_is_one_like_ours(command_line: CommandLine) -> None:
    """It is listed, found by its name and judged; a name of ours stays ours."""
    assert names()[4:] == ("far.away", "far.broken", "far.wrong")
    assert (system("far.away").name, system("bear.mission").name) == ("far.away", "bear.mission")
    assert command_line("explore", "far.away").status == 0


@pytest.mark.usefixtures("installed")
@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("far.broken", "the system far.broken cannot be loaded from far_away:NOTHING: AttributeError: "),
        ("far.wrong", "the system far.wrong cannot be loaded from far_away:evolve: that is a function, no System"),
        ("far", "there is no system 'far'; there are bear.mission, bear.status, isaac.server, isaac.robot, far.away"),
    ],
)
def test_one_that_cannot_be_loaded_is_bad_input(command_line: CommandLine, name: str, says: str) -> None:
    """What is wrong with a package of somebody else is one line and exit status 2."""
    ended = command_line("rules", name)
    assert (ended.status, ended.err.startswith(f"missionfsm: {says}"), ended.err.count("\n")) == (2, True, 1)


@pytest.mark.parametrize("name", names())
def test_the_registry_calls_a_system_what_it_calls_itself(name: str) -> None:
    """Titles stand in the registry too, so that the help loads no system."""
    assert title(name) == system(name).spec.title
