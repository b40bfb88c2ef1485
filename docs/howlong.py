"""How long the README's commands take on this machine: ``python docs/howlong.py`` prints a table.

Seconds of processor time, all child processes included, which a busy machine hardly changes; and those that passed.
"""

from __future__ import annotations

import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM = (sys.executable, "-m", "missionfsm")
HISTORY = (
    Path(__file__).parent.parent / "tests" / "bear" / "edges" / "conform" / "AM-53-failed-without-having-run.jsonl"
)
COMMANDS = {
    "conform bear.mission": ("conform", "bear.mission", "--seed", "1"),
    "conform isaac.server": ("conform", "isaac.server", "--seed", "1"),
    "smoke bear.mission": ("smoke", "bear.mission", "--", *PROGRAM, "adapter", "bear.mission"),
    "check, a short log": ("check", str(HISTORY)),
    "explore bear.mission": ("explore", "bear.mission"),
    "explore isaac.server --missions 1": ("explore", "isaac.server", "--missions", "1"),
    "teeth isaac.robot": ("teeth", "isaac.robot"),
}


def machine() -> str:
    """This machine in a few words."""
    about = Path("/proc/cpuinfo")
    lines = about.read_text().splitlines() if about.exists() else []
    model = next((line.partition(": ")[2] for line in lines if line.startswith("model name")), platform.processor())
    return f"{os.cpu_count()} cores of {model or platform.machine()}, Python {platform.python_version()}"


def spent() -> float:
    """Seconds of processor time of all child processes so far."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Print the table."""
    print(f"{machine()}\n\n| command | processor s | s |\n| --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for name, command in COMMANDS.items():
            before, began = spent(), time.monotonic()
            subprocess.run([*PROGRAM, *command], cwd=folder, stdout=subprocess.DEVNULL, check=False)
            print(f"| `{name}` | {spent() - before:.1f} | {time.monotonic() - began:.1f} |", flush=True)


if __name__ == "__main__":
    main()
