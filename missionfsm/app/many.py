"""Judge many recorded files: folders of them, on several cores."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from attrs import frozen

from missionfsm.app.parallel import cores
from missionfsm.app.recorded import check_file
from missionfsm.kernel.codec import UnreadableError
from missionfsm.tools.check.verdict import Verdict

ENDINGS = (".jsonl", ".jsonl.gz", ".jsonl.zst")
"""How the names of those files in a folder end that are taken for histories."""


@frozen
class Judged:
    """What there is to say of one file.

    Attributes:
        path: the file.
        verdicts: a verdict for each robot that it speaks of.
        said: what was told on the way.
        trouble: why it could not be read; "" if it could.
    """

    path: str
    verdicts: tuple[tuple[str | None, Verdict], ...] = ()
    said: tuple[str, ...] = ()
    trouble: str = ""


def histories(paths: Iterable[str]) -> list[str]:
    """The files among paths, and those in the folders among them, by name.

    Raises:
        UnreadableError: there is none in a folder.
    """
    found: list[str] = []
    for path in paths:
        if not os.path.isdir(path):  # noqa: PTH112 - a path that no file can have is none either
            found.append(path)
            continue
        inside = sorted(str(one) for one in Path(path).rglob("*") if one.name.endswith(ENDINGS) and one.is_file())
        if not inside:
            message = f"{path}: there is no history in it; their names end with {', '.join(ENDINGS)}"
            raise UnreadableError(message)
        found += inside
    return found


WORTH_A_PROCESS = 2_000_000
"""Bytes of logs that are worth the second that a process of their own takes to begin."""


def _processes(paths: Iterable[str]) -> int:
    """As many processes as there are cores, as far as each has enough to do."""
    plain = (path for path in paths if os.path.isfile(path))  # noqa: PTH113 - as below
    size = sum(Path(path).stat().st_size for path in plain)
    return max(1, min(cores(), size // WORTH_A_PROCESS))


def judge_files(
    paths: Iterable[str],
    readings: Mapping[str, str],
    *,
    jobs: int | None = None,
    progress: Callable[[], None] = lambda: None,
    tell: Callable[[str], None] | None = None,
    **how: Any,  # noqa: ANN401 - see `missionfsm.app.asked.Asked`
) -> Iterator[Judged]:
    """Judge files, several at a time; what is found comes in their order and does not depend on `jobs`.

    Args:
        jobs: in how many processes; None: as many as there are cores, as far as the files are worth it.
        progress: called for every file that has been judged.
        tell: called with what is told on the way, as soon as it is there; None keeps it for `Judged.said`. What several
            processes are told is kept.
    """
    waiting = list(paths)
    jobs = _processes(waiting) if jobs is None else jobs
    if jobs == 1 or len(waiting) == 1:
        for path in waiting:
            yield _judged(path, readings, how, tell)
            progress()
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(jobs, len(waiting)), context, initializer=_undisturbed) as pool:
        begun: list[tuple[str, Future[Judged]]] = []
        try:
            for path in waiting:
                begun.append((path, pool.submit(_judged, path, readings, how)))
                begun[-1][1].add_done_callback(lambda _: progress())
            for path, future in begun:
                yield _result(path, future)
        finally:
            for _, future in begun:
                future.cancel()


def _undisturbed() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever started it ends it


def _result(path: str, future: Future[Judged]) -> Judged:
    with contextlib.suppress(BrokenProcessPool):
        return future.result()
    return Judged(path, trouble=f"{path}: a process that judged ended before it was done; try --jobs 1")


def _judged(
    path: str, readings: Mapping[str, str], how: dict[str, Any], tell: Callable[[str], None] | None = None
) -> Judged:
    said: list[str] = []
    try:
        return Judged(path, tuple(check_file(path, readings, tell or said.append, **how)), tuple(said))
    except ValueError as error:  # UnreadableError is one, and so is that of a reading that does not exist
        return Judged(path, (), tuple(said), str(error))


__all__ = ["Judged", "histories", "judge_files"]
