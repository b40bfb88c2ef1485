"""What a proxy sees, written down and judged, while traffic goes on whatever becomes of that.

The proxy only puts what came by into a queue. A thread hands it, much at a time, to a process of its own, where one
thread reads it and writes it as lines and another judges them: neither takes the proxy's interpreter from the traffic.
A full disk ends the file and a judge that lags behind is given up, and both are said; the traffic notices neither.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import queue
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Generic, TypeVar

import orjson
from attrs import frozen

from missionfsm.kernel.codec import JSON, UnreadableError

if TYPE_CHECKING:
    from missionfsm.tools.check.verdict import Verdict

MAX_WAITING_BYTES = 256 * 1024 * 1024
"""What may wait to be read; then recording ends, since a history with a hole in it would be judged wrong."""
ITEM_BYTES = 500
"""What anything that waits takes beside its bytes."""
BATCH_SECONDS = 0.02
"""How long it is gathered before it is handed over, much at a time."""
MAX_BATCH_ITEMS = 10_000
MAX_WAITING_BATCHES = 100_000
"""Batches that may wait to be judged; then the judge gives up."""
LAG_SECONDS = 90.0
"""How long a judge that lags behind may take for what waits, once traffic is over."""
PAGE_SECONDS = 2
"""How often the page is written and refreshed."""

Item = TypeVar("Item")
Tell = Callable[[str], None]
Read = Callable[[Item], Iterable[dict[str, JSON]]]
"""The lines of a history that what came by makes. Raises UnreadableError where what follows would have a hole."""


@frozen
class Statement:
    """What a judge says: a text for people as soon as something breaks, and the verdict at the end, as JSON."""

    text: str
    conforms: bool
    verdict: JSON = None


@frozen
class _Work:
    """What the process is to do.

    Attributes:
        head: the first line of the history.
        file: where the lines are written; "" for nowhere.
        reader, judge, readings, html: as for `Recorder`.
    """

    head: dict[str, JSON]
    file: str
    reader: Callable[[], Read[Any]]
    judge: bool
    readings: dict[str, str]
    html: str


class Recorder(Generic[Item]):
    """Makes a history of observed traffic, and never blocks whoever observes it.

    Args:
        head: the first line of the history.
        reader: makes the reader of the traffic in another process, and so has to be picklable.
        file: where the lines are written; "" for nowhere.
        judge: whether they are judged.
        readings: the readings to assume.
        html: a page that says how it stands, written anew every few seconds; "" for none. Needs `judge`.
        tell: takes a line for people, from another thread.

    Raises:
        OSError: the file cannot be written.
    """

    def __init__(
        self,
        head: dict[str, JSON],
        reader: Callable[[], Read[Item]],
        *,
        file: str = "",
        judge: bool = True,
        readings: dict[str, str] | None = None,
        html: str = "",
        tell: Tell,
    ) -> None:
        self._waiting: queue.SimpleQueue[tuple[Item, int] | None] = queue.SimpleQueue()
        self._bytes_come = 0
        self._bytes_gone = 0
        self._tell = tell
        self._over = False
        self.judged: Statement | None = None
        if file:
            Path(file).open("wb").close()  # what cannot be written is said at once
        context = multiprocessing.get_context("spawn")
        receive, self._to_process = context.Pipe(duplex=False)
        self._from_process, send = context.Pipe(duplex=False)
        work = _Work(head, file, reader, judge, readings or {}, html)
        self._process = context.Process(target=_work, args=(work, receive, send), daemon=True)
        self._process.start()
        receive.close()
        send.close()
        self._listener = threading.Thread(target=self._listen, name="missionfsm-judge", daemon=True)
        self._thread = threading.Thread(target=self._run, name="missionfsm-recorder", daemon=True)
        self._listener.start()
        self._thread.start()

    def record(self, item: Item, size: int = 0) -> None:
        """Take what came by; returns at once.

        Args:
            size: of its data, in bytes.
        """
        if self._over:
            return
        size += ITEM_BYTES
        if self._bytes_come - self._bytes_gone + size > MAX_WAITING_BYTES:
            self._end()
            self._tell("traffic comes faster than it can be read; nothing more is recorded, traffic goes on")
            return
        self._bytes_come += size
        self._waiting.put((item, size))

    def _end(self) -> None:
        self._over = True
        self._waiting.put(None)

    def _run(self) -> None:
        over = False
        while not over:
            batch = [self._waiting.get()]
            if batch[-1] is not None:
                time.sleep(BATCH_SECONDS)  # the traffic is not woken up for everything
            with contextlib.suppress(queue.Empty):
                while batch[-1] is not None and len(batch) < MAX_BATCH_ITEMS:
                    batch.append(self._waiting.get_nowait())
            over = batch[-1] is None
            there = [one for one in batch if one is not None]
            try:
                self._to_process.send([item for item, _ in there])
            except (OSError, ValueError):  # the process died
                self._over = True
                self._tell("what records and judges has died; nothing more is recorded, traffic goes on")
                return
            self._bytes_gone += sum(size for _, size in there)
        self._to_process.close()

    def _listen(self) -> None:
        with contextlib.suppress(EOFError, OSError):
            while True:
                said = self._from_process.recv()
                if isinstance(said, str):
                    self._tell(said)
                    continue
                self.judged = said
                if said.verdict is None:
                    self._tell(said.text)

    def close(self, seconds: float = LAG_SECONDS) -> Statement | None:
        """Write and judge what has come, and end.

        Args:
            seconds: how long the judge may take for what waits; Ctrl-C gives it up before.

        Returns:
            What the judge said last; None without one, or where it did not get to an end.
        """
        self._end()
        self._thread.join(seconds)
        with contextlib.suppress(KeyboardInterrupt):
            self._listener.join(seconds)
        if self._listener.is_alive():  # it ends when the process has said all that it has to say
            self._process.kill()
            self._tell("the judge did not get to the end of what was recorded")
        return self.judged


def _work(work: _Work, lines: Connection, say: Connection) -> None:
    """The process: reads and writes lines until their end, and hands them to the judge beside it."""
    import os  # noqa: PLC0415 - only this process needs it
    import signal  # noqa: PLC0415 - as above

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the terminal's Ctrl-C is for the proxy, which ends this by its pipe
    if hasattr(os, "nice"):
        os.nice(10)  # traffic comes first
    to_judge: queue.SimpleQueue[list[bytes] | None] = queue.SimpleQueue()
    said = _Said(say)
    judging = threading.Thread(target=_judge, args=(work, to_judge, said), name="missionfsm-judge")
    if work.judge:
        judging.start()
    file = _File(work.file, said)
    for batch in _batches(work, lines, said):
        file.write(b"".join(line + b"\n" for line in batch))
        if work.judge:
            to_judge.put(batch)
    file.close()
    to_judge.put(None)
    if work.judge:
        judging.join()
    say.close()


def _batches(work: _Work, items: Connection, say: _Said) -> Iterator[list[bytes]]:
    """The lines of the history as they come, many at a time: to the end, or to where there would be a hole."""
    read = work.reader()
    yield [orjson.dumps(work.head)]
    with contextlib.suppress(EOFError):
        while True:
            batch: list[bytes] = []
            try:
                for item in items.recv():
                    batch += [orjson.dumps(line) for line in read(item)]
            except UnreadableError as error:
                yield batch
                say(f"{error}; nothing more is recorded, traffic goes on")
                break
            yield batch
        while True:  # what comes is taken, so that nobody waits for it to be
            items.recv()


class _Said:
    """What the process says to the proxy, from either of its threads."""

    def __init__(self, say: Connection) -> None:
        self._say = say
        self._lock = threading.Lock()

    def __call__(self, what: str | Statement) -> None:
        with self._lock, contextlib.suppress(OSError):  # the proxy is gone; the file is written to its end
            self._say.send(what)


class _File:
    """The recorded file, until it cannot be written any more."""

    def __init__(self, path: str, said: _Said) -> None:
        self._path = path
        self._said = said
        self._file: IO[bytes] | None = None
        if path:
            try:
                self._file = Path(path).open("wb")  # noqa: SIM115 - closed at the end
            except OSError as error:
                self._failed(error)

    def write(self, data: bytes) -> None:
        """Write lines, so that whoever reads the file sees them."""
        if self._file is not None:
            try:
                self._file.write(data)
                self._file.flush()
            except OSError as error:
                with contextlib.suppress(OSError):
                    self._file.close()
                self._file = None
                self._failed(error)

    def _failed(self, error: OSError) -> None:
        self._said(f"{self._path}: {error.strerror or error}; nothing more is recorded, traffic goes on")

    def close(self) -> None:
        """Let go of the file."""
        if self._file is not None:
            self._file.close()


def _judge(work: _Work, batches: queue.SimpleQueue[list[bytes] | None], say: _Said) -> None:
    """Judges lines until their end; says what breaks at once, and the verdict at the end."""
    from missionfsm.app.conversations import Conversations  # noqa: PLC0415 - only this process needs it

    judge = Conversations(work.readings)
    page = _Page(work.html, say)
    wrong = False
    while (batch := batches.get()) is not None:
        for text in batch:
            if wrong:
                continue
            line = orjson.loads(text)
            try:
                wrong = not judge.feed(line)
            except UnreadableError as error:
                say(Statement(f"what was recorded cannot be judged any further: {error}", conforms=False))
                wrong = True
            if wrong and judge.violation is not None:
                verdict = judge.verdict()
                page.show_verdict(verdict, over=False)
                said = [line.strip() for line in str(verdict).splitlines() if line.strip()]
                say(Statement("; ".join(said[:2]), conforms=False))  # a line; all of it comes at the end
        if not wrong:
            page.so_far(work.head["system"], judge.read)
        if batches.qsize() > MAX_WAITING_BATCHES:
            say("the judge lags too far behind and gives up; what is recorded can be judged by `missionfsm check`")
            return
    verdict = judge.verdict()
    page.show_verdict(verdict, over=True)
    say(Statement(str(verdict), verdict.conforms, verdict.to_json()))


class _Page:
    """The page of a judge that goes on: it refreshes itself until traffic ends.

    Args:
        path: where it is; "" for nowhere.
        tell: takes a line for people: the page cannot be written, and is not any more.
    """

    def __init__(self, path: str, tell: Tell) -> None:
        self._path = path
        self._tell = tell
        self._written = 0.0

    def so_far(self, name: str, lines: int) -> None:
        """Nothing is wrong yet."""
        now = time.monotonic()
        if self._path and now - self._written >= PAGE_SECONDS:
            self._written = now
            from missionfsm.pages.standing import standing_page  # noqa: PLC0415 - pages are for who wants them

            page = standing_page(name, lines, PAGE_SECONDS)
            self._write(page, over=False)

    def show_verdict(self, verdict: Verdict, *, over: bool) -> None:
        """There is a verdict; it is final once traffic is over."""
        if self._path:
            from missionfsm.pages.report import LabelledVerdict as On  # noqa: PLC0415 - pages are for who wants them
            from missionfsm.pages.report import report  # noqa: PLC0415
            from missionfsm.systems import system  # noqa: PLC0415

            self._write(report([On(verdict, "", "")], system), over=over)

    def _write(self, page: str, *, over: bool) -> None:
        if not over:
            page = page.replace("<head>", f'<head><meta http-equiv="refresh" content="{PAGE_SECONDS}">', 1)
        beside = Path(f"{self._path}.new")
        try:  # a reader sees the old page or the new one, never half of it
            beside.write_text(page, encoding="utf-8")
            beside.replace(self._path)
        except OSError as error:
            self._tell(f"{self._path}: {error.strerror or error}; the page is not written any more")
            self._path = ""
