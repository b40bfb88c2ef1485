"""A subscription to a fake: what came and was not taken yet."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from typing import Generic, TypeVar

T = TypeVar("T")


class Updates(Generic[T]):
    """A subscription: a ``for`` loop over it takes the updates since the last loop.

    The first updates are the latest known states when the subscription was made; every change adds one. Updates are
    values.

    Args:
        callback: is given every update as it comes; then none is kept for a loop.
    """

    def __init__(self, callback: Callable[[T], object] | None = None) -> None:
        self._callback = callback
        self._unread: deque[T] = deque()
        self.latest: T | None = None
        """The update that came last, read or not."""
        self.open = True
        """Whether more may come."""
        self.listener: Callable[[], object] | None = None
        """Called without arguments when an update came to be taken, or none will come any more."""

    def __iter__(self) -> Iterator[T]:
        while self._unread:
            yield self._unread.popleft()

    def __len__(self) -> int:
        """How many have come that were not taken yet."""
        return len(self._unread)

    def __bool__(self) -> bool:
        """A subscription is there even while nothing has come."""
        return True

    def cancel(self) -> None:
        """Give it up: nothing comes any more; what has come stays to be taken."""
        self.open = False
        self._tell()

    def _come(self, update: T) -> None:
        if not self.open:
            return
        self.latest = update
        if self._callback is None:
            self._unread.append(update)
            self._tell()
        else:
            self._callback(update)

    def _tell(self) -> None:
        if self.listener is not None:
            self.listener()

    def _put_back(self, unread: Iterable[T]) -> None:
        self._unread = deque(unread)
