"""Teeth on several cores: every process judges its part of the mutants, and tells how far it is."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import Any

from missionfsm.systems import system
from missionfsm.tools.teeth import Teeth, joined, teeth

_MORE, _ENDED = "one more", "that was all"
"""What a process tells the one that shows the progress."""


def cores() -> int:
    """How many processes can run at once."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def teeth_on(jobs: int, name: str, *, seed: int, only: str, progress: Callable[[], None]) -> Teeth:
    """Judge every mutant of a system in so many processes; the same number of them finds the same.

    Args:
        progress: called for every mutant that has been judged.
    """
    if jobs == 1:
        return teeth(system(name), seed=seed, only=only, progress=lambda _: progress())
    context = multiprocessing.get_context("spawn")
    with context.Manager() as manager, ProcessPoolExecutor(jobs, context) as processes:
        judged = manager.Queue()
        parts = [processes.submit(_part, name, seed, only, (which, jobs), judged) for which in range(jobs)]
        ended = 0
        while ended < jobs:
            if judged.get() == _ENDED:
                ended += 1
            else:
                progress()
        return joined(system(name), (part.result() for part in parts))


def _part(name: str, seed: int, only: str, part: tuple[int, int], judged: Any) -> Teeth:  # noqa: ANN401 - a queue
    try:
        return teeth(system(name), seed=seed, only=only, part=part, progress=lambda _: judged.put(_MORE))
    finally:
        judged.put(_ENDED)
