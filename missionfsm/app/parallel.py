"""Teeth on several cores: every process judges its part of the mutants, and tells how far it is."""

from __future__ import annotations

import contextlib
import functools
import multiprocessing
import signal
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnContext

from missionfsm.systems import system
from missionfsm.tools.mutate.teeth import MutationReport, merged_reports, teeth

_MORE = "one more"
"""The message of a process for each mutant that it has judged, before its report."""


def teeth_on(
    jobs: int, name: str, *, seed: int, only: str, every: int = 1, progress: Callable[[], None]
) -> MutationReport:
    """Judge every mutant of a system in several processes. The result depends on how many they are.

    Args:
        jobs: how many processes.
        name: the name of the system.
        seed, only, every: see `teeth`.
        progress: called for every mutant that has been judged.
    """
    judge = functools.partial(teeth, seed=seed, only=only, every=every)
    if jobs == 1:
        return judge(system(name), progress=lambda _: progress())
    context = multiprocessing.get_context("spawn")
    with contextlib.ExitStack() as started:
        parts = [started.enter_context(_begun(context, name, judge, (which, jobs))) for which in range(jobs)]
        found: dict[Connection, MutationReport] = {}
        while len(found) < jobs:
            for part in wait([part for part in parts if part not in found]):
                assert isinstance(part, Connection)  # noqa: S101 - nothing else is waited for
                said = part.recv()
                if said == _MORE:
                    progress()
                else:
                    found[part] = said
    return merged_reports(system(name), (found[part] for part in parts))


@contextlib.contextmanager
def _begun(
    context: SpawnContext, name: str, judge: Callable[..., MutationReport], part: tuple[int, int]
) -> Iterator[Connection]:
    """A process that judges a part: the connection on which it reports. It ends when this process ends."""
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_judge, args=(name, judge, part, theirs), daemon=True)
    process.start()
    theirs.close()
    try:
        yield ours
    finally:
        process.terminate()
        process.join()
        ours.close()


def _judge(name: str, judge: Callable[..., MutationReport], part: tuple[int, int], results: Connection) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever started it ends it
    results.send(judge(system(name), part=part, progress=lambda _: results.send(_MORE)))
