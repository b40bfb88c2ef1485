"""Judge many recorded files: folders and patterns of them, on several cores, and one large file by its robots."""

from __future__ import annotations

import contextlib
import glob
import heapq
import multiprocessing
import os
import re
import signal
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from attrs import evolve, frozen

from missionfsm.adapters.addresses import Addresses
from missionfsm.adapters.historyfile import is_plain_file, lines, open_history
from missionfsm.app.cores import cores
from missionfsm.app.garbage import seldom
from missionfsm.app.recorded import check_file
from missionfsm.kernel.codec import UnreadableError
from missionfsm.oracle.transcript import head
from missionfsm.systems import system
from missionfsm.tools.check.verdict import Verdict

ENDINGS = (".jsonl", ".jsonl.gz", ".jsonl.zst")
"""How the names of those files in a folder end that are taken for histories."""
WORTH_A_PROCESS = 2_000_000
"""Bytes of logs that are worth the second that a process of their own takes to begin."""


@frozen
class Judged:
    """The result for one file.

    Attributes:
        path: the file.
        verdicts: a verdict for each robot that it speaks of.
        said: what was told on the way.
        trouble: why it could not be read; "" if it could.
        seconds: how long it took to judge, in all processes together.
    """

    path: str
    verdicts: tuple[tuple[str | None, Verdict], ...] = ()
    said: tuple[str, ...] = ()
    trouble: str = ""
    seconds: float = 0.0


@frozen
class Piece:
    """What is judged at a time: a file, or some of the robots of one.

    Attributes:
        robots: which of them, with their places in the order of their first lines; all if there are none.
    """

    path: str
    robots: tuple[tuple[int, str | None], ...] = ()


def histories(paths: Iterable[str]) -> list[str]:
    """The files among paths, those in the folders among them, and those that patterns fit, each once, by name.

    A path is a pattern (``logs/**/*.jsonl``) where nothing has that name.

    Raises:
        UnreadableError: there is none in a folder, or none fits a pattern.
    """
    found: dict[str, None] = {}
    for path in paths:
        if os.path.isdir(path):  # noqa: PTH112 - a path that no file can have is none either
            named = (one for one in Path(path).rglob("*") if one.name.endswith(ENDINGS))
            # A link that leads nowhere is a log that is missing: whoever judges it says so.
            inside = sorted(str(one) for one in named if one.is_file() or not one.exists())
            if not inside:
                message = f"{path}: there is no history in it; their names end with {', '.join(ENDINGS)}"
                raise UnreadableError(message)
            found |= dict.fromkeys(inside)
        elif {"*", "?"} & set(path) and not os.path.lexists(path):
            fits = sorted(glob.glob(path, recursive=True))  # noqa: PTH207 - `Path.glob` takes no absolute pattern
            if not fits:
                message = f"{path}: no file fits this pattern"
                raise UnreadableError(message)
            found |= dict.fromkeys(histories(fits))
        else:
            found[path] = None
    return list(found)


def robots(path: str) -> Mapping[str | None, int]:
    """The robots that a history speaks of, in the order of their first lines, and how many lines each has.

    None are told of bare messages, of several histories in one file, which are judged together, and of what cannot be
    read: whoever judges it says why.
    """
    found: Counter[str | None] = Counter()
    with contextlib.suppress(UnreadableError), open_history(path) as source:
        numbered = lines(source, path)
        by_params = system(head(next(numbered, (0, None))[1]).system).codec.robot_in_params
        addresses = Addresses(by_params=by_params)
        for _, line in numbered:
            robot, line_alone = addresses.whose(line)
            if "missionfsm" in line_alone:
                break
            found[robot] += 1
        else:
            return found
    return {}


def _names_robots(path: str) -> bool:
    """Whether any line of a history may name a robot, by its bytes: few do, and reading all lines takes a while."""
    with contextlib.suppress(UnreadableError), open_history(path) as source:
        return any(b'"robot' in line for line in source)
    return False


def pieces(paths: Sequence[str], workers: int) -> list[tuple[Piece, ...]]:
    """For each file the pieces in which so many workers judge it.

    A file that is more than a worker's share of all, and worth it, is judged by its robots: each piece has about as
    many lines as the others.
    """
    sizes = [Path(path).stat().st_size if is_plain_file(path) else 0 for path in paths]
    share = max(sum(sizes) / workers, WORTH_A_PROCESS)
    return [
        _by_robot(path, workers) if workers > 1 and size >= share else (Piece(path),)
        for path, size in zip(paths, sizes, strict=True)
    ]


def _by_robot(path: str, workers: int) -> tuple[Piece, ...]:
    """A file in at most so many pieces, which have the robots with the most lines apart."""
    named = robots(path) if _names_robots(path) else {}
    found = [(many, place, robot) for place, (robot, many) in enumerate(named.items())]
    shares: list[tuple[int, int, list[tuple[int, str | None]]]] = [(0, number, []) for number in range(workers)]
    for many, place, robot in sorted(found, key=lambda one: -one[0]):
        least, number, whose = heapq.heappop(shares)
        heapq.heappush(shares, (least + many, number, [*whose, (place, robot)]))
    cut = tuple(Piece(path, tuple(whose)) for _, _, whose in shares if whose)
    return cut if len(cut) > 1 else (Piece(path),)


_PLACE = re.compile(r":(\d+): ")


def merged_results(cut: Sequence[Piece], parts: Sequence[Judged]) -> Judged:
    """The result for a file whose pieces were judged. Of several troubles it is the first one, as in one piece."""
    if len(parts) == 1:
        return parts[0]
    path = cut[0].path
    said = tuple(line for part in parts for line in part.said)
    seconds = sum(part.seconds for part in parts)
    troubles = [part.trouble for part in parts if part.trouble]
    if troubles:
        return Judged(path, (), said, min(troubles, key=_line_of), seconds)
    places = {robot: place for piece in cut for place, robot in piece.robots}
    found = sorted((verdict for part in parts for verdict in part.verdicts), key=lambda one: places[one[0]])
    return Judged(path, tuple(found), said, "", seconds)


def _line_of(trouble: str) -> int:
    """The number of the line that a trouble is about; 0 if it is about none."""
    place = _PLACE.search(trouble)
    return int(place[1]) if place else 0


def workers_for(paths: Iterable[str]) -> int:
    """How many processes judge some files: as many as there are cores, if each has enough to do."""
    size = sum(Path(path).stat().st_size for path in paths if is_plain_file(path))
    return max(1, min(cores(), size // WORTH_A_PROCESS))


def judge_files(
    paths: Iterable[str],
    readings: Mapping[str, str],
    *,
    jobs: int | None = None,
    progress: Callable[[float], None] = lambda _: None,
    tell: Callable[[str], None] | None = None,
    **how: Any,  # noqa: ANN401 - see `missionfsm.app.asked.Asked`
) -> Iterator[Judged]:
    """Judge files, several at a time. The results come in the order of the files, and do not depend on `jobs`.

    Args:
        paths: the files.
        readings: the readings to assume.
        jobs: how many processes judge; None: as many as there are cores, if the files are worth it.
        progress: given 1 for every file that has been judged, or a part of that for a piece of a file.
        tell: given what is told on the way, as soon as it is there; None keeps it for `Judged.said`. With several
            processes it is kept.
        how: how else the files are to be judged; see `missionfsm.app.asked.Asked`.
    """
    waiting = list(paths)
    jobs = workers_for(waiting) if jobs is None else jobs
    cut = pieces(waiting, jobs)
    many = sum(map(len, cut))
    if jobs == 1 or many == 1:
        for path in waiting:
            yield judge_piece(Piece(path), readings, how, tell)
            progress(1)
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(jobs, many), context, initializer=_undisturbed) as pool:
        begun: list[list[Future[Judged]]] = []
        try:
            for parts in cut:
                begun.append([pool.submit(judge_piece, piece, readings, how) for piece in parts])
                share = 1 / len(parts)
                for future in begun[-1]:
                    future.add_done_callback(lambda _, share=share: progress(share))  # type: ignore[misc]
            for parts, futures in zip(cut, begun, strict=True):
                yield merged_results(
                    parts, [_result(piece.path, future) for piece, future in zip(parts, futures, strict=True)]
                )
        finally:
            for future in (one for futures in begun for one in futures):
                future.cancel()


def _undisturbed() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever started it ends it
    seldom()


def _result(path: str, future: Future[Judged]) -> Judged:
    with contextlib.suppress(BrokenProcessPool):
        return future.result()
    return Judged(path, trouble=f"{path}: a process that judged ended before it was done; try --jobs 1")


def judge_piece(
    piece: Piece, readings: Mapping[str, str], how: dict[str, Any], tell: Callable[[str], None] | None = None
) -> Judged:
    """Judge a file, or some of the robots of one, in this process; the arguments are those of `judge_files`."""
    said: list[str] = []
    begun = time.perf_counter()
    only = {"only": frozenset(robot for _, robot in piece.robots)} if piece.robots else {}
    try:
        verdicts = check_file(piece.path, readings, tell or said.append, **how, **only)
        found = Judged(piece.path, tuple(verdicts), tuple(said))
    except ValueError as error:  # UnreadableError is one, and so is that of a reading that does not exist
        found = Judged(piece.path, (), tuple(said), str(error))
    return evolve(found, seconds=time.perf_counter() - begun)


__all__ = [
    "Judged",
    "Piece",
    "histories",
    "judge_files",
    "judge_piece",
    "merged_results",
    "pieces",
    "robots",
    "workers_for",
]
