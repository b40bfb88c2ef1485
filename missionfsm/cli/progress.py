"""How far long work has come: a bar on a terminal, nothing on a pipe."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from missionfsm.tools.conform.run import Run

EVERY = 1.0
"""Seconds between two looks at what takes a while to count."""


class Bar:
    """A progress bar, used as a context manager.

    Args:
        what: what is counted.
        total: how many there are.
    """

    def __init__(self, what: str, total: int) -> None:
        self.what = what
        self.total = total
        self._bar: Any = None
        self._task: Any = None
        self._looked = 0.0

    def __enter__(self) -> Self:
        if sys.stderr is not None and sys.stderr.isatty():
            from rich.console import Console  # noqa: PLC0415 - only a terminal needs it
            from rich.progress import Progress  # noqa: PLC0415

            self._bar = Progress(console=Console(stderr=True), transient=True)
            self._bar.start()
            self._task = self._bar.add_task(self.what, total=self.total)
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def one_more(self, _: object = None) -> None:
        """One more is done."""
        self.more(1)

    def more(self, share: float) -> None:
        """One more is done, or so much of one."""
        if self._bar is not None:
            self._bar.advance(self._task, share)

    def conversation(self, run: Run) -> None:
        """A run has had one more conversation; now and then its coverage is told with it."""
        self.one_more()
        if self._bar is not None and time.monotonic() - self._looked > EVERY:
            rules = f"{len(run.narrowing.exercised())} of {len(run.system.spec.all_rules)} rules"
            self._bar.update(self._task, description=f"{self.what}, {rules}")
            self._looked = time.monotonic()
