"""What several tests need: the command line in this process, and that no slow machine fails a test."""

from __future__ import annotations

import io
import os
import signal
import sys
import zlib
from pathlib import Path

import pytest
from commandline import CommandLine, Ended
from hypothesis import HealthCheck, settings

from missionfsm.cli import main

settings.register_profile("untimed", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("long", settings.get_profile("untimed"), max_examples=2_000)  # --hypothesis-profile long
settings.load_profile("untimed")

# A shell that runs a script in the background has SIGINT ignored, and `nohup` SIGHUP; so would be what a test starts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)

WEB = Path(__file__).parent / "web"


def pytest_addoption(parser: pytest.Parser) -> None:
    """``--part 1/5``: of the long tests only every fifth one, in turn."""
    parser.addoption("--part", default="0/1", metavar="K/N", help="every N-th of the long tests, the K-th turn")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """``-n auto``: one more than there are processors, as tests wait for the programs that they start."""
    return 1 + (os.cpu_count() or 1)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is not of the part that is asked for.

    N parts one after the other are everything. Each test begins at a place of its own, so that a part has a little of
    all that go through systems, readings or breaks.
    """
    turn, _, every = config.getoption("--part").partition("/")
    numbers: dict[str, int] = {}
    left_out = set()
    for item in items:
        if item.get_closest_marker("long"):
            name = item.nodeid.partition("[")[0]
            numbers[name] = number = numbers.get(name, zlib.crc32(name.encode())) + 1
            if (number - int(turn)) % int(every):
                left_out.add(item)
    # What takes longest is begun first, so that nobody waits for it at the end.
    items.sort(key=lambda item: not Path(item.path).is_relative_to(WEB))
    if left_out:
        config.hook.pytest_deselected(items=list(left_out))
        items[:] = [item for item in items if item not in left_out]


@pytest.fixture
def command_line(monkeypatch: pytest.MonkeyPatch, capfdbinary: pytest.CaptureFixture[bytes]) -> CommandLine:
    """Run ``missionfsm`` with arguments, and with a text on its stdin."""

    def run(*arguments: object, stdin: bytes = b"") -> Ended:
        monkeypatch.setattr(sys, "argv", ["missionfsm", *map(str, arguments)])
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(stdin)))
        try:
            main()
            status = 0
        except SystemExit as ended:
            status = int(ended.code or 0)
        sys.stdout.flush()
        out, err = capfdbinary.readouterr()
        return Ended(status, out.decode(), err.decode())

    return run
