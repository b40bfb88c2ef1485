"""What a proxy sees, written down and judged, while traffic goes on whatever becomes of that.

The proxy only puts lines into a queue. A thread hands them, many at a time, to a process of its own, where one thread
reads and writes them and another judges them: neither takes the proxy's interpreter from the traffic. A full disk ends
the file and a judge that lags behind is given up, and both are said; the traffic notices neither.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import queue
import threading
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO, TYPE_CHECKING

import orjson
from attrs import frozen

from missionfsm.kernel.codec import JSON

if TYPE_CHECKING:
    from missionfsm.tools.check.verdict import Verdict

MAX_WAITING_LINES = 1_000_000
"""Lines that may wait to be written or judged; what comes beyond them is counted and left out."""
BATCH_SECONDS = 0.02
"""How long lines are gathered before they are handed over, many at a time."""
MAX_BATCH_LINES = 10_000
MAX_WAITING_BATCHES = 100_000
"""Batches that may wait to be judged; then the judge gives up."""
LAG_SECONDS = 90.0
"""How long a judge that lags behind may take for what waits, once traffic is over."""
PAGE_SECONDS = 2
"""How often the page is written and refreshed."""
_END = None

Tell = Callable[[str], None]
Read = Callable[[dict[str, JSON]], dict[str, JSON]]


@frozen
class Judged:
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
        read: makes of a line as it is handed over one of the format.
        judge, readings, html: as for `Recorder`.
    """

    head: dict[str, JSON]
    file: str
    read: Read
    judge: bool
    readings: dict[str, str]
    html: str


class Recorder:
    """Takes the lines of a history; never blocks whoever brings them.

    Args:
        head: the first line of the history.
        file: where the lines are written; "" for nowhere.
        read: makes of a line as it is brought one of the format, in another process; a function of a module.
        judge: whether they are judged.
        readings: the readings to assume.
        html: a page that says how it stands, written anew every few seconds; "" for none. Needs `judge`.
        tell: takes a line for people, from another thread.

    Raises:
        OSError: the file cannot be written.
    """

    def __init__(  # noqa: PLR0913 - all but the first have a default
        self,
        head: dict[str, JSON],
        *,
        file: str = "",
        read: Read = dict,
        judge: bool = True,
        readings: dict[str, str] | None = None,
        html: str = "",
        tell: Tell,
    ) -> None:
        self._lines: queue.SimpleQueue[JSON] = queue.SimpleQueue()
        self._tell = tell
        self._left_out = 0
        self.judged: Judged | None = None
        if file:
            Path(file).open("wb").close()  # what cannot be written is said at once
        context = multiprocessing.get_context("spawn")
        receive, self._to_process = context.Pipe(duplex=False)
        self._from_process, send = context.Pipe(duplex=False)
        work = _Work(head, file, read, judge, readings or {}, html)
        self._process = context.Process(target=_work, args=(work, receive, send), daemon=True)
        self._process.start()
        receive.close()
        send.close()
        self._listener = threading.Thread(target=self._listen, name="missionfsm-judge", daemon=True)
        self._thread = threading.Thread(target=self._run, name="missionfsm-recorder", daemon=True)
        self._listener.start()
        self._thread.start()
        self.record(head)

    def record(self, line: JSON) -> None:
        """Take a line; returns at once."""
        if self._lines.qsize() > MAX_WAITING_LINES:
            self._left_out += 1
        else:
            self._lines.put(line)

    def _run(self) -> None:
        over = False
        while not over:
            lines = [self._lines.get()]
            if lines[-1] is not _END:
                time.sleep(BATCH_SECONDS)  # the traffic is not woken up for every line
            with contextlib.suppress(queue.Empty):
                while lines[-1] is not _END and len(lines) < MAX_BATCH_LINES:
                    lines.append(self._lines.get_nowait())
            over = lines[-1] is _END
            try:
                self._to_process.send(lines)
            except (OSError, ValueError):  # the process died
                self._tell("what records and judges has died; nothing more is recorded, traffic goes on")
                return
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

    def close(self, seconds: float = LAG_SECONDS) -> Judged | None:
        """Write and judge what has come, and end.

        Args:
            seconds: how long the judge may take for what waits; Ctrl-C gives it up before.

        Returns:
            What the judge said last; None without one, or where it did not get to an end.
        """
        self._lines.put(_END)
        self._thread.join(seconds)
        if self._left_out:
            self._tell(f"{self._left_out} lines came faster than they could be written, and are left out")
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
    with contextlib.suppress(EOFError):
        while True:
            batch = [orjson.dumps(work.read(line)) for line in lines.recv() if line is not _END]
            file.write(b"".join(line + b"\n" for line in batch))
            if work.judge:
                to_judge.put(batch)
    file.close()
    to_judge.put(None)
    if work.judge:
        judging.join()
    say.close()


class _Said:
    """What the process says to the proxy, from either of its threads."""

    def __init__(self, say: Connection) -> None:
        self._say = say
        self._lock = threading.Lock()

    def __call__(self, what: str | Judged) -> None:
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
    from missionfsm.app.asked import judged_system  # noqa: PLC0415 - only this process needs it
    from missionfsm.kernel.codec import UnreadableError  # noqa: PLC0415
    from missionfsm.oracle.transcript import head as read_head  # noqa: PLC0415
    from missionfsm.tools.check.judge import Judge  # noqa: PLC0415

    first = read_head(work.head)
    judge = Judge(
        judged_system(first.system, strict=first.strict, anywhere=first.anywhere, others=first.others),
        first,
        readings=work.readings,
    )
    page = _Page(work.html, say)
    wrong = False
    while (batch := batches.get()) is not None:
        for text in batch:
            line = orjson.loads(text)
            if wrong or "missionfsm" in line:
                continue
            try:
                wrong = not judge.feed(line)
            except UnreadableError as error:
                say(Judged(f"what was recorded cannot be judged any further: {error}", conforms=False))
                wrong = True
            if wrong and judge.violation is not None:
                verdict = judge.verdict()
                page.told(verdict, over=False)
                say(Judged(str(verdict), conforms=False))
        if not wrong:
            page.so_far(first.system, judge.read)
        if batches.qsize() > MAX_WAITING_BATCHES:
            say("the judge lags too far behind and gives up; what is recorded can be judged by `missionfsm check`")
            return
    verdict = judge.verdict()
    page.told(verdict, over=True)
    say(Judged(str(verdict), verdict.conforms, verdict.to_json()))


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

    def told(self, verdict: Verdict, *, over: bool) -> None:
        """There is a verdict; it is final once traffic is over."""
        if self._path:
            from missionfsm.pages.report import Judged as On  # noqa: PLC0415 - pages are for who wants them
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
