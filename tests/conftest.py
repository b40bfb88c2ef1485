"""What several tests need: the command line in this process, and that no slow machine fails a test."""

from __future__ import annotations

import io
import signal
import sys

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
