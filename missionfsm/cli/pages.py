"""``--html FILE``: what a command found, as one page. Pages are imported only when needed: that takes long."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

import typer

from missionfsm.adapters.outputs import STDOUT, write_whole
from missionfsm.cli.printing import made

if TYPE_CHECKING:
    from missionfsm.kernel.system import System
    from missionfsm.tools.explore.explore import Exploration
    from missionfsm.tools.mutate.teeth import MutationReport


def _a_file(path: str | None) -> str | None:
    if path == STDOUT:
        message = "a page goes to a file"
        raise typer.BadParameter(message)
    return path


HtmlFile = Annotated[
    str | None, typer.Option("--html", metavar="FILE", callback=_a_file, help="Write a page for a browser, one file.")
]


def _write(path: str, page: Callable[[], str]) -> None:
    # What an implementation sent may hold halves of surrogate pairs, which no encoding has.
    write_whole(path, page().encode("utf-8", "xmlcharrefreplace"))


def write_teeth(path: str | None, judged: System, found: MutationReport) -> None:
    """Write the page on all mutants of a system, if it is wanted."""
    if path is not None:
        from missionfsm.pages.teeth import teeth_page  # noqa: PLC0415 - pages load what they need

        _write(path, lambda: teeth_page(judged, found, str(made())))


def write_explorer(path: str | None, visited: System, explored: Exploration, assumed: int) -> None:
    """Write the page to click through a system with, if it is wanted."""
    if path is not None:
        from missionfsm.pages.explorer import explorer_page  # noqa: PLC0415 - pages load what they need

        _write(path, lambda: explorer_page(visited, explored, assumed, str(made())))
