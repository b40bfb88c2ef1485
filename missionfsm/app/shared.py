"""A fake robot or fleet for several threads, and for tasks of asyncio.

shared = Shared(Robot())
with shared as robot:
    mission = robot.create_mission(missions.navigate("table-1"))
async for update in shared.follow(lambda robot: robot.updates()):
    ...
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import AsyncIterator, Callable
from typing import Generic, TypeVar

from missionfsm.fakes.fleet import Fleet
from missionfsm.fakes.robot import Robot
from missionfsm.fakes.updates import Updates

Fake = TypeVar("Fake", bound=Robot | Fleet)
T = TypeVar("T")


class Shared(Generic[Fake]):
    """A fake, which is for one thread at a time, with a lock around it: a ``with`` block has it for itself.

    Args:
        fake: the robot or the fleet; nobody may use it but through this.
    """

    def __init__(self, fake: Fake) -> None:
        self._fake = fake
        self._lock = threading.RLock()

    def __enter__(self) -> Fake:
        self._lock.acquire()
        return self._fake

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    async def follow(self, subscribe: Callable[[Fake], Updates[T]]) -> AsyncIterator[T]:
        """The updates of a subscription, as they come from whichever thread, until it is cancelled.

        Args:
            subscribe: opens it, such as ``lambda robot: robot.updates()``; it is given up with the iteration.
        """
        loop = asyncio.get_running_loop()
        more = asyncio.Event()

        def tell() -> None:
            with contextlib.suppress(RuntimeError):  # the loop is closed: nobody follows any more
                loop.call_soon_threadsafe(more.set)

        with self as fake:
            updates = subscribe(fake)
            updates.listener = tell
        try:
            while True:
                more.clear()
                with self:
                    taken, more_may_come = list(updates), updates.open
                for one in taken:
                    yield one
                if not more_may_come:
                    return
                await more.wait()
        finally:
            with self:
                updates.cancel()
