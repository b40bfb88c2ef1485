"""What a server sends on its streams: messages come from any thread, and go out in the server's loop."""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import Mapping

from missionfsm.adapters.grpc import control
from missionfsm.kernel.codec import JSON


class Inbox:
    """Messages on their way into the loop of the server, from whichever thread; one wake-up for many."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self.loop = loop
        self._came: deque[tuple[Outgoing, JSON]] = deque()
        self._called = False

    def put(self, to: Outgoing, message: JSON) -> None:
        """Hand a message to its stream; the robot's lock keeps the messages of a stream in order."""
        try:
            here: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
        except RuntimeError:
            here = None
        self._came.append((to, message))
        if here is self.loop:
            self._deliver()
        elif not self._called:
            self._called = True
            with contextlib.suppress(RuntimeError):  # the server stops; nobody reads any more
                self.loop.call_soon_threadsafe(self._deliver)

    def _deliver(self) -> None:
        self._called = False  # before the queue is emptied, so that what comes meanwhile is not left in it
        while self._came:
            to, message = self._came.popleft()
            to.take(message)


class Outgoing:
    """The messages of one stream, from the robot to its subscriber.

    Args:
        inbox: how messages of other threads get into the server's loop.
        metadata: what the subscriber sent along; it may name a session, and the stream within it.
        late: how many seconds every message but the first is on its way.

    Attributes:
        session, stream: those names; "" for none.
        sent: how many messages went out.
        waiting: messages that did not, and marks that are to be set once all before them did.
    """

    def __init__(self, inbox: Inbox, metadata: Mapping[str, str], late: float = 0.0) -> None:
        self.session = metadata.get(control.SESSION_KEY, "")
        self.stream = metadata.get(control.STREAM_KEY, "")
        self.sent = 0
        self.waiting: asyncio.Queue[JSON | asyncio.Future[None]] = asyncio.Queue()
        self._inbox = inbox
        self._late = late
        self._begun = self._closed = False

    @property
    def unsent(self) -> int:
        """How many messages wait."""
        return self.waiting.qsize()

    def come(self, message: JSON) -> None:
        """Take a message, from whichever thread it comes."""
        self._inbox.put(self, message)

    def take(self, what: JSON | asyncio.Future[None]) -> None:
        """Let a message, or a mark, wait to go out, once it has been on its way."""
        if self._late and self._begun:
            self._inbox.loop.call_later(self._late, self._put, what)
        else:
            self._put(what)
        self._begun = True

    def _put(self, what: JSON | asyncio.Future[None]) -> None:
        if not self._closed:
            self.waiting.put_nowait(what)
        elif isinstance(what, asyncio.Future):
            what.set_result(None)

    async def next(self, seconds: float | None) -> JSON:
        """The next message, once all before it went out; None once so many seconds have passed."""
        with contextlib.suppress(TimeoutError):
            while True:
                if seconds is None or not self.waiting.empty():
                    found = await self.waiting.get()
                else:
                    found = await asyncio.wait_for(self.waiting.get(), seconds)
                if not isinstance(found, asyncio.Future):
                    return found
                found.set_result(None)
        return None

    def flushed(self) -> asyncio.Future[None]:
        """Done once all that waits now went out, or the stream ended."""
        found = self._inbox.loop.create_future()
        self.take(found)
        return found

    def close(self) -> None:
        """Nothing goes out any more."""
        self._closed = True
        while not self.waiting.empty():
            found = self.waiting.get_nowait()
            if isinstance(found, asyncio.Future):
                found.set_result(None)
