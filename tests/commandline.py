"""How a command of the command line ended."""

from __future__ import annotations

from collections.abc import Callable

from attrs import frozen


@frozen
class Ended:
    """Its exit status and what it wrote."""

    status: int
    out: str
    err: str


CommandLine = Callable[..., Ended]
