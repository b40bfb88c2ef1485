"""How tests run the command line as a process of its own, and what they know of a page in a browser."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from typing import Any

from attrs import field, frozen


@frozen
class Run:
    """How a command ended."""

    status: int
    out: str
    err: str


def missionfsm(*arguments: object) -> Run:
    """Run the command line as a process of its own."""
    command = [sys.executable, "-m", "missionfsm", *map(str, arguments)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    return Run(ended.returncode, ended.stdout, ended.stderr)


@frozen
class Seen:
    """A page in the browser, and what it asked for and complained of."""

    page: Any
    requests: list[str] = field(factory=list)
    complaints: list[str] = field(factory=list)

    def overflows(self) -> bool:
        """Whether the page is wider than the window."""
        wide: bool = self.page.evaluate("document.documentElement.scrollWidth > window.innerWidth")
        return wide


def expect(locator: Any) -> Any:
    """What has to hold of a part of a page within five seconds: a page draws itself anew some time after a press."""
    from playwright.sync_api import expect as waiting  # noqa: PLC0415 - only who has a browser has it

    return waiting(locator)


Opener = Callable[..., Seen]
