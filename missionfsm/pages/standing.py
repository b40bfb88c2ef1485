"""The page on traffic that goes on, as long as nothing is wrong."""

from __future__ import annotations

from missionfsm.pages.render import rendered


def standing_page(name: str, lines: int, seconds: float) -> str:
    """How it stands so far.

    Args:
        name: of the system that is judged.
        lines: of the history, so far.
        seconds: after which the page is written anew.
    """
    return rendered("standing.html", name=name, lines=f"{lines:,}", seconds=f"{seconds:g}", made="")
