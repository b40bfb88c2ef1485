"""The logs of a fleet on more than one machine: what `check FOLDER` does, spread over the workers of Dask.

    from missionfsm import fleet

    for judged in fleet.judge(["/logs/2026"], scheduler="tcp://scheduler:8786"):
        for robot, verdict in judged.verdicts:
            print(judged.path, robot, verdict.headline)

The files are a bag, large ones in a partition for some of their robots each, and every partition is judged by the very
same judge as in one process: what is found does not depend on how many workers there are, nor on whether some of them
end before they are done. Every worker has to find the files under the same names, as on a shared file system.

It needs the extra ``fleet``.
"""

from __future__ import annotations

import contextlib
import logging
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from missionfsm.app.cores import cores
from missionfsm.app.many import Judged, Piece, histories, judge_piece, merged_results, pieces
from missionfsm.kernel.codec import UnreadableError

LOCAL = "local"
"""In the place of a scheduler's address: workers on this machine, for this run alone."""
PATIENCE = "10s"
"""How long a scheduler may take to answer."""
PER_WORKER = 4
"""Into how many pieces for each worker large files are cut, so that those who are quick get more of them."""


def judge(
    paths: Iterable[str],
    readings: Mapping[str, str] | None = None,
    *,
    scheduler: str = LOCAL,
    workers: int | None = None,
    progress: Callable[[float], None] = lambda _: None,
    **how: Any,  # noqa: ANN401 - see `missionfsm.app.asked.Asked`
) -> Iterator[Judged]:
    """Judge files, folders of them and patterns, on the workers of a cluster; what is found comes in their order.

    A worker that ends while it judges loses nothing: others judge what it had. Whatever is judged again for that is
    told once.

    Args:
        scheduler: the address of a scheduler, such as ``tcp://host:8786``; "local" starts workers on this machine.
        workers: how many of them; as many as there are cores by default.
        progress: called for every file that has been judged, or for a part of one with how much of the file it is.
        how: what else is said of the logs; see `missionfsm.app.asked.Asked`.

    Raises:
        UnreadableError: Dask is not installed, no scheduler answers, or there is no such file.
    """
    files = histories(paths)
    with _client(scheduler, workers) as client:
        from dask import bag  # noqa: PLC0415 - it is there, or there is no client

        many = len(client.scheduler_info(n_workers=-1)["workers"]) or 1
        cut = [tuple(map(_absolute, parts)) for parts in pieces(files, many * PER_WORKER)]
        flat = [piece for parts in cut for piece in parts]
        shares = [1 / len(parts) for parts in cut for _ in parts]
        judged = bag.from_sequence(flat, npartitions=len(flat)).map(judge_piece, dict(readings or {}), how)
        found = _as_they_come(client, judged.to_delayed(), shares, progress)
        done: dict[int, Judged] = {}
        first = 0
        for path, parts in zip(files, cut, strict=True):
            wanted = range(first, first := first + len(parts))
            while not all(one in done for one in wanted):
                number, result = next(found)
                done[number] = result or Judged(path, trouble=f"{path}: every worker that judged it ended meanwhile")
            yield _named(merged_results(parts, [done.pop(one) for one in wanted]), path)


def _absolute(piece: Piece) -> Piece:
    """The same for a worker that runs in another folder."""
    return Piece(os.path.abspath(piece.path), piece.robots)  # noqa: PTH100 - a path that no file can have stays as it is


def _named(judged: Judged, path: str) -> Judged:
    """What was found, with the file called as it was here."""
    trouble = judged.trouble.replace(os.path.abspath(path), path, 1)  # noqa: PTH100 - as above
    return Judged(path, judged.verdicts, judged.said, trouble, judged.seconds)


def _as_they_come(
    client: Any,  # noqa: ANN401 - Dask has no types
    partitions: Iterable[Any],
    shares: list[float],
    progress: Callable[[float], None],
) -> Iterator[tuple[int, Judged | None]]:
    """The number of each partition and what was found in it, once each; None where it ended all who judged it."""
    from distributed import KilledWorker, as_completed  # noqa: PLC0415 - as above

    numbers = {future: number for number, future in enumerate(client.compute(list(partitions)))}
    for future in as_completed(list(numbers), loop=client.loop):
        number = numbers.pop(future)
        result: Judged | None = None
        with contextlib.suppress(KilledWorker):
            (result,) = future.result()
        progress(shares[number])
        yield number, result


@contextlib.contextmanager
def _client(scheduler: str, workers: int | None) -> Iterator[Any]:
    """Somebody who gives workers what they are to do."""
    try:
        import dask.bag  # noqa: F401, PLC0415 - an extra
        from distributed import Client, LocalCluster  # noqa: PLC0415 - an extra
    except ImportError:
        message = "Dask is not installed: install missionfsm[fleet] to judge on its workers"
        raise UnreadableError(message) from None
    with contextlib.ExitStack() as open_until_done:
        if scheduler == LOCAL:
            cluster = LocalCluster(
                n_workers=workers or cores(),
                threads_per_worker=1,
                processes=True,
                dashboard_address=None,
                silence_logs=logging.CRITICAL,
            )
            scheduler = open_until_done.enter_context(cluster).scheduler_address
        try:
            client = Client(scheduler, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            message = f"{scheduler}: no scheduler of Dask answers there ({error or type(error).__name__})"
            raise UnreadableError(message) from None
        yield open_until_done.enter_context(client)


__all__ = ["LOCAL", "Judged", "judge"]
