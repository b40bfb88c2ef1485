"""The formats of reports, by the names of their options: where a new one is entered.

``--NAME FILE`` of `check` and `conform` writes what the module of a format makes of a `Report`: its function
``written`` takes one and returns the bytes of the file. A module is loaded when its format is asked for.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping

from attrs import frozen

from missionfsm.kernel.codec import UnreadableError
from missionfsm.reports.report import Report


@frozen
class Format:
    """A format of reports.

    Attributes:
        module: where its ``written`` is.
        says: what ``--help`` says of its option.
        stdout: whether ``-`` is stdout.
        advises: whether it has the experiments that would decide between readings, which take long to find.
        several: whether it is for several verdicts, so that only `check` has it.
        library: the library that it needs, which comes with the extra that is called like the format.
    """

    module: str
    says: str
    stdout: bool = True
    advises: bool = False
    several: bool = False
    library: str | None = None

    @property
    def written(self) -> Callable[[Report], bytes]:
        """What makes the bytes of its files."""
        found: Callable[[Report], bytes] = importlib.import_module(self.module).written
        return found


FORMATS: dict[str, Format] = {
    "json": Format("missionfsm.reports.json", "Write the verdict as JSON; - is stdout.", advises=True),
    "parquet": Format(
        "missionfsm.reports.parquet",
        "Write a row for each file and robot as Parquet; - is stdout.",
        several=True,
        library="pyarrow",
    ),
    "html": Format("missionfsm.reports.html", "Write a page for a browser, one file.", stdout=False, advises=True),
    "junit": Format("missionfsm.reports.junit", "Write the verdict as JUnit XML; - is stdout."),
}
"""The name of a format, which is that of its option, to what there is to know of it before it is loaded."""


def refuse_without_library(name: str) -> None:
    """Raises UnreadableError where what a format needs is not installed."""
    library = FORMATS[name].library
    if library is None:
        return
    try:
        importlib.import_module(library)
    except ImportError:
        message = f"{library} is not installed: install missionfsm[{name}] to write {name.capitalize()}"
        raise UnreadableError(message) from None


def formats(*, several: bool) -> Mapping[str, Format]:
    """Those of a command that judges several things, or one."""
    return {name: one for name, one in FORMATS.items() if several or not one.several}
