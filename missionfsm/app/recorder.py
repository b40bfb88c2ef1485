"""What a proxy sees, written down and judged, while traffic goes on whatever becomes of that.

The proxy only puts lines into a queue. A thread takes them out, writes the file and hands them to a judge in a process
of its own. A full disk ends the file and a judge that lags behind is given up, and both are said; the traffic notices
neither.
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
from typing import IO, TYPE_CHECKING, Any

import orjson
from attrs import frozen

from missionfsm.kernel.codec import JSON

if TYPE_CHECKING:
    from missionfsm.tools.check.verdict import Verdict

MAX_WAITING_LINES = 1_000_000
"""Lines that may wait to be written or judged; what comes beyond them is counted and left out."""
PAGE_SECONDS = 2
"""How often the page is written and refreshed."""
_END = None

Tell = Callable[[str], None]


@frozen
class Judged:
    """What a judge says: a text for people as soon as something breaks, and the verdict at the end, as JSON."""

    text: str
    conforms: bool
    verdict: JSON = None


class Recorder:
    """Takes the lines of a history; never blocks whoever brings them.

    Args:
        head: the first line of the history.
        file: where the lines are written; "" for nowhere.
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
        judge: bool = True,
        readings: dict[str, str] | None = None,
        html: str = "",
        tell: Tell,
    ) -> None:
        self._lines: queue.SimpleQueue[JSON] = queue.SimpleQueue()
        self._tell = tell
        self._left_out = 0
        self._file: IO[bytes] | None = Path(file).open("wb") if file else None  # noqa: SIM115 - closed at the end
        self._path = file
        self._to_judge: Connection | None = None
        self._process: Any = None
        self.judged: Judged | None = None
        if judge:
            self._begin_judging(head, readings or {}, html)
        self._thread = threading.Thread(target=self._run, name="missionfsm-recorder", daemon=True)
        self._thread.start()
        self.record(head)

    def _begin_judging(self, head: dict[str, JSON], readings: dict[str, str], html: str) -> None:
        context = multiprocessing.get_context("spawn")
        receive, self._to_judge = context.Pipe(duplex=False)
        self._from_judge, send = context.Pipe(duplex=False)
        self._process = context.Process(target=_judge, args=(head, readings, html, receive, send), daemon=True)
        self._process.start()
        receive.close()
        send.close()
        self._listener = threading.Thread(target=self._listen, name="missionfsm-judge", daemon=True)
        self._listener.start()

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
            with contextlib.suppress(queue.Empty):
                while len(lines) < 1000:
                    lines.append(self._lines.get_nowait())
            over = lines[-1] is _END
            data = b"".join(orjson.dumps(line) + b"\n" for line in lines if line is not _END)
            self._write(data)
            self._hand_over(data)
        if self._to_judge is not None:
            self._to_judge.close()

    def _write(self, data: bytes) -> None:
        if self._file is not None:
            try:
                self._file.write(data)
                self._file.flush()
            except OSError as error:
                with contextlib.suppress(OSError):
                    self._file.close()
                self._file = None
                self._tell(f"{self._path}: {error.strerror or error}; nothing more is recorded, traffic goes on")

    def _hand_over(self, data: bytes) -> None:
        if self._to_judge is not None:
            try:
                self._to_judge.send_bytes(data)
            except (OSError, ValueError):  # the judge has ended: it has said why, or its process died
                self._to_judge.close()
                self._to_judge = None

    def _listen(self) -> None:
        with contextlib.suppress(EOFError, OSError):
            while True:
                said: Judged = self._from_judge.recv()
                self.judged = said
                if said.verdict is None:
                    self._tell(said.text)

    def close(self, seconds: float = 30.0) -> Judged | None:
        """Write and judge what has come, and end.

        Args:
            seconds: how long the judge may take for what waits.

        Returns:
            What the judge said last; None without one, or where it did not get to an end.
        """
        self._lines.put(_END)
        self._thread.join(seconds)
        if self._file is not None:
            self._file.close()
        if self._left_out:
            self._tell(f"{self._left_out} lines came faster than they could be written, and are left out")
        if self._process is not None:
            self._listener.join(seconds)
            self._process.join(1.0)
            if self._process.is_alive():
                self._process.kill()
                self._tell("the judge did not get to the end of what was recorded")
        return self.judged


def _judge(head: dict[str, JSON], readings: dict[str, str], html: str, lines: Connection, say: Connection) -> None:
    """The judge's process: reads lines until their end; says what breaks at once, and the verdict at the end."""
    import os  # noqa: PLC0415 - only this process needs it
    import signal  # noqa: PLC0415 - as above

    from missionfsm.app.asked import judged_system  # noqa: PLC0415
    from missionfsm.kernel.codec import UnreadableError  # noqa: PLC0415
    from missionfsm.oracle.transcript import head as read_head  # noqa: PLC0415
    from missionfsm.tools.check.judge import Judge  # noqa: PLC0415

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the terminal's Ctrl-C is for the proxy, which ends this by its pipe
    if hasattr(os, "nice"):
        os.nice(10)  # traffic comes first
    first = read_head(head)
    judge = Judge(
        judged_system(first.system, strict=first.strict, anywhere=first.anywhere, others=first.others),
        first,
        readings=readings,
    )
    page = _Page(html, lambda text: say.send(Judged(text, conforms=True)))
    wrong = False
    with contextlib.suppress(EOFError):
        while True:
            for text in lines.recv_bytes().splitlines():
                line = orjson.loads(text)
                if wrong or "missionfsm" in line:
                    continue
                try:
                    wrong = not judge.feed(line)
                except UnreadableError as error:
                    say.send(Judged(f"what was recorded cannot be judged any further: {error}", conforms=False))
                    wrong = True
                if wrong and judge.violation is not None:
                    verdict = judge.verdict()
                    page.told(verdict, over=False)
                    say.send(Judged(str(verdict), conforms=False))
            if not wrong:
                page.so_far(head["system"], judge.read)
    verdict = judge.verdict()
    page.told(verdict, over=True)
    say.send(Judged(str(verdict), verdict.conforms, verdict.to_json()))
    say.close()


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
            says = f"{name}: nothing is wrong so far, {lines:,} lines"
            page = f"<!doctype html><html><head><title>{says}</title></head><body><p>{says}</p></body></html>"
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
