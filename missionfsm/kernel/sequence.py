"""How numbers that are counted up compare with those before them."""

from __future__ import annotations

RELATIONS = ("first", "larger", "zero", "equal", "smaller", "negative", "renumbered", "stale")
"""How a number compares with its predecessor on its track; 0 is "zero" and less is "negative", whatever came before.

One that is not larger is "renumbered" where the numbers of its track are known to have started over since, and so is an
equal one where what it numbers may have been shown again. Where every number of a message is equal, it is "stale" too.
"""


STALE = RELATIONS[-1]


def relation(before: int | None, number: int) -> str:
    """How a number compares with its predecessor on a track: one of `RELATIONS`."""
    if number < 0:
        return "negative"
    if number == 0:
        return "zero"
    if before is None:
        return "first"
    if number == before:
        return "equal"
    return "larger" if number > before else "smaller"
