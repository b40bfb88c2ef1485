"""Where programs cannot be started in sessions of their own: what works there, and what says that it does not."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from commandline import CommandLine

from missionfsm.adapters import processes

GOOD = Path(__file__).parent / "bear" / "edges" / "conform" / "AM-53-failed-without-having-run.jsonl"
ELSEWHERE = """
import os, signal, sys
for module in ("fcntl", "pty", "termios", "tty", "resource", "grp", "pwd"):
    sys.modules[module] = None
for owner, names in (
    (os, ("fork", "killpg", "setsid", "getuid", "geteuid", "getpgid", "mkfifo", "uname", "setpgid")),
    (signal, ("SIGHUP", "SIGKILL", "SIGUSR1", "SIGUSR2", "SIGALRM", "SIGCHLD")),
):
    for name in names:
        delattr(owner, name)
import missionfsm
from missionfsm.cli import main
sys.argv[1:] = sys.argv[1:] or ["--help"]
main()
"""


@pytest.mark.parametrize("arguments", [("check", str(GOOD)), ("rules", "isaac.robot"), ("explore", "isaac.robot")])
def test_what_reads_needs_nothing_that_only_posix_has(arguments: tuple[str, ...]) -> None:
    """Without the modules, functions and signals that Windows lacks, what starts no program works as ever."""
    ran = subprocess.run(
        [sys.executable, "-c", ELSEWHERE, *arguments], capture_output=True, text=True, check=False, timeout=120
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout


@pytest.mark.parametrize("command", ["conform", "smoke"])
def test_on_windows_a_program_is_not_judged(
    command: str, command_line: CommandLine, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What has to start a program says in one line that it cannot, and what works instead."""
    monkeypatch.setattr(processes, "PLATFORM", "win32")
    ended = command_line(command, "bear.mission", "--", "my-adapter.exe")
    assert (ended.status, "Traceback" in ended.err) == (3, False)
    assert "on Windows in WSL; `check` and `--grpc` work without it" in ended.out + ended.err
