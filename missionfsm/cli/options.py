"""Options that several commands take, and what they may be."""

from __future__ import annotations

import enum
import math
from typing import Annotated

import typer

Readings = Annotated[
    list[str] | None, typer.Option("--reading", metavar="AM-09=a", help="A reading that has to be followed; repeat it.")
]
ProfileName = Annotated[
    str | None,
    typer.Option(
        "--profile",
        metavar="NAME",
        help="Readings of Isaac's systems together: documented (nothing departs from the text) or as-shipped.",
    ),
]
NoFlagged = Annotated[
    bool, typer.Option("--no-flagged", help="What is explained, and yet departs from the text, is a violation.")
]
Verbose = Annotated[
    bool, typer.Option("--verbose", "-v", help="Tell all readings, what would decide those that are open, rare rules.")
]
Github = Annotated[
    bool | None,
    typer.Option(
        "--github/--no-github", help="Annotations for GitHub Actions; by default where GITHUB_ACTIONS is true."
    ),
]
KnownFile = Annotated[
    str | None,
    typer.Option(
        "--expect-violations",
        metavar="FILE",
        help="Ids of rules that are known to be broken, one a line, # for comments; one that is not met fails.",
    ),
]

DAY = 24 * 60 * 60.0
"""Seconds that anything may be waited for."""


def finite(seconds: float | None) -> float | None:
    """The seconds that an option gives; bad usage where they are no number."""
    if seconds is not None and not math.isfinite(seconds):
        message = f"{seconds:g} is no number of seconds"
        raise typer.BadParameter(message)
    return seconds


class Transport(enum.Enum):
    """What lies between an implementation and its log."""

    IMPERFECT = "imperfect"
    STRICT = "strict"
