"""Without the extra ``grpc``, which the extra ``test`` brings along, there is nothing here to test."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from relay import Relay

    from missionfsm.app.serve import Served

collect_ignore_glob = [] if find_spec("grpc_reflection") else ["test_*.py"]


@pytest.fixture(scope="session")
def tls(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    """A certificate of localhost and its key, as files."""
    if shutil.which("openssl") is None:
        pytest.skip("a certificate is made with openssl")
    folder: Path = tmp_path_factory.mktemp("tls")
    key, certificate = folder / "key.pem", folder / "certificate.pem"
    made = "req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=localhost -addext subjectAltName=DNS:localhost"
    command = ["openssl", *made.split(), "-keyout", str(key), "-out", str(certificate)]
    subprocess.run(command, check=True, capture_output=True, timeout=60)
    return str(certificate), str(key)


@pytest.fixture
def robot() -> Iterator[Served]:
    """The reference as a robot."""
    from missionfsm.app.serve import serve  # noqa: PLC0415 - without the extra nobody asks for it

    with serve("bear.mission") as served:
        yield served


@pytest.fixture
def lines() -> list[Any]:
    """What a proxy before the robot records."""
    return []


@pytest.fixture
def relay(robot: Served, lines: list[Any]) -> Iterator[Relay]:
    """A proxy before the robot."""
    from relay import Relay  # noqa: PLC0415 - as above

    found = Relay(robot.target, lines.append)
    yield found
    found.close()
