"""What goes wrong on a real network, made up: seeded, so that it goes wrong in the same way again."""

from __future__ import annotations

import random
from collections.abc import Iterable

from attrs import evolve, frozen


@frozen
class Faults:
    """How often what goes wrong; probabilities from 0 to 1.

    Attributes:
        deadline: a unary call that would have succeeded answers DEADLINE_EXCEEDED; every second time it took effect.
        unavailable: a call, or a subscription, answers UNAVAILABLE and has no effect.
        internal: the same with INTERNAL.
        lost: a message of a stream, but the first, is left out.
        late: seconds that every message of a stream, but the first, is on its way; 0 for none.
        doubled: a message of a stream is sent twice, with the same number and timestamp.
        ends: seconds after which every stream ends cleanly; None: never.
    """

    deadline: float = 0.0
    unavailable: float = 0.0
    internal: float = 0.0
    lost: float = 0.0
    late: float = 0.0
    doubled: float = 0.0
    ends: float | None = None

    @classmethod
    def parse(cls, texts: Iterable[str]) -> Faults:
        """Faults from texts such as ``deadline:0.05`` or ``ends:60``.

        Raises:
            ValueError: there is no such fault, or its number is out of range.
        """
        found = cls()
        for text in texts:
            name, _, number = text.partition(":")
            if name not in _NAMES:
                raise ValueError(f"{text!r}: there is no fault {name!r}; there are {', '.join(_NAMES)}")
            try:
                value = float(number)
            except ValueError:
                raise ValueError(f"{text!r}: {number!r} is no number") from None
            if not (0 < value < float("inf") if name in _SECONDS else 0 <= value <= 1):
                raise ValueError(f"{text!r}: {'seconds are more than 0' if name in _SECONDS else 'it is from 0 to 1'}")
            found = evolve(found, **{name: value})
        return found


_NAMES = ("deadline", "unavailable", "internal", "lost", "late", "doubled", "ends")
_SECONDS = ("late", "ends")


class Dice:
    """Faults as they come: each question is asked once and answered by chance, the same for the same seed."""

    def __init__(self, faults: Faults, seed: int) -> None:
        self.faults = faults
        self._random = random.Random(seed)  # noqa: S311 - no secret

    def unavailable(self) -> bool:
        """Whether this call, or this subscription, does not reach the robot."""
        return self._happens(self.faults.unavailable)

    def internal(self) -> bool:
        """Whether the robot breaks down over this call, or this subscription."""
        return self._happens(self.faults.internal)

    def deadline(self) -> str:
        """What becomes of a call that would succeed: "" for nothing, or ``applied`` or ``lost``."""
        if not self._happens(self.faults.deadline):
            return ""
        return "applied" if self._random.random() < 0.5 else "lost"

    def copies(self, *, first: bool) -> int:
        """How many times a message of a stream is sent."""
        if not first and self._happens(self.faults.lost):
            return 0
        return 2 if self._happens(self.faults.doubled) else 1

    def _happens(self, probability: float) -> bool:
        return probability > 0 and self._random.random() < probability
