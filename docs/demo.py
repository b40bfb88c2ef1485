"""Draws docs/demo.svg: a terminal in which the tutorial's fault is found. Run it as ``python docs/demo.py``."""

from __future__ import annotations

import io
import re
import subprocess
import sys
from pathlib import Path

from rich.console import Console
from rich.text import Text

COMMAND = 'missionfsm conform bear.mission -- sh -c "missionfsm adapter bear.mission | sed -u s/SUCCEEDED/CANCELED/"'
_UNWANTED = re.compile(r"@font-face \{.*?\}\s*|<!--.*?-->", re.DOTALL)
_COLOURS = {
    "violates": "bold red",
    r"^  \d+\. .*": "cyan",
    "allowed here:|against:|as --expect-violations takes it:": "bold",
    r"\[Mission ›.*\]": "dim",
}


def demo() -> str:
    """The SVG of the command and of the first part of what it says."""
    program = f"{sys.executable} -m missionfsm"
    asked = [*program.split(), "conform", "bear.mission", "--seed", "1", "--examples", "5", "--", "sh", "-c"]
    faulty = f"{program} adapter bear.mission | sed -u s/SUCCEEDED/CANCELED/"
    ran = subprocess.run([*asked, faulty], capture_output=True, text=True, check=False)
    console = Console(record=True, width=118, file=io.StringIO(), force_terminal=True)
    console.print(Text(f"$ {COMMAND}\n", style="bold green"))
    told = Text(re.split(r"\n(?:flagged|readings still open|rules exercised):", ran.stdout)[0])
    for pattern, style in _COLOURS.items():
        told.highlight_regex(re.compile(pattern, re.MULTILINE), style)  # type: ignore[arg-type]
    console.print(told)
    return _UNWANTED.sub("", console.export_svg(title="missionfsm", unique_id="demo"))


if __name__ == "__main__":
    (Path(__file__).parent / "demo.svg").write_text(demo())
