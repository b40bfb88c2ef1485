"""The mission files and the script in examples/isaac do what their page says."""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from missionfsm.isaac.runtime.missionfile import MissionFile, parse
from missionfsm.isaac.runtime.profile import AS_SHIPPED, DOCUMENTED, Profile

FOLDER = Path(__file__).parents[2] / "examples" / "isaac"
FILES = sorted(FOLDER.glob("*.json"))


@pytest.mark.parametrize("profile", [DOCUMENTED, AS_SHIPPED], ids=["documented", "as-shipped"])
def test_isaac_examples_are_mission_files(profile: Profile) -> None:
    """Each is taken without a warning, as documented and as shipped."""
    read = {path.stem: parse(path.read_bytes(), profile) for path in FILES}
    assert {
        name: (len(file.missions), file.warnings) for name, file in read.items() if isinstance(file, MissionFile)
    } == {
        "carter": (3, ()),
        "forklifts": (5, ()),
        "walkthrough": (4, ()),
    }


def test_isaac_examples_run_all_at_once() -> None:
    """The script starts the server and a robot for every name, and ends with all missions done."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"]))
    ran = subprocess.run(
        [str(FOLDER / "run.sh"), str(FOLDER / "forklifts.json")],
        env={**os.environ, "PATH": path, "PORT": port, "DURATION": "0.01"},
        stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert (ran.returncode, ran.stdout.splitlines()[-1]) == (0, "5 succeeded, 0 did not")
