"""What the commands that judge write beside their verdicts, and the list of what is known to be broken."""

from __future__ import annotations

import functools
import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer
from attrs import field, frozen

from missionfsm.adapters.outputs import STDOUT, write_history, write_whole
from missionfsm.cli.common import BAD_INPUT, Troubles, one_line_errors, stop, the_system
from missionfsm.cli.printing import in_github, say_annotations
from missionfsm.kernel.system import System
from missionfsm.reports.formats import FORMATS, Format, formats, refuse_without_library
from missionfsm.reports.report import Finding, Report
from missionfsm.systems import names
from missionfsm.tools.check.verdict import Verdict


@frozen
class Reports:
    """The reports that a command writes besides what it prints.

    Attributes:
        files: the formats that are wanted, each with the file that it goes to, in the order of `FORMATS`.
    """

    files: Mapping[str, str] = field(factory=dict)

    @property
    def outputs(self) -> dict[str, str]:
        """The options to the files that they name."""
        return {f"--{name}": path for name, path in self.files.items()}

    @property
    def taken(self) -> str | None:
        """``-`` where a report goes to stdout: people are told nothing there."""
        return STDOUT if STDOUT in self.files.values() else None

    @property
    def advises(self) -> bool:
        """Whether one of them tells what would decide between readings."""
        return any(FORMATS[name].advises for name in self.files)

    def refuse_impossible(self) -> None:
        """Raises UnreadableError, before anything is judged, where one of them cannot be written at all."""
        for name in self.files:
            refuse_without_library(name)

    def write(self, report: Report, troubles: Troubles) -> None:
        """Write all that are wanted; what goes wrong with one is kept, and the others are written."""
        for name, path in self.files.items():
            with troubles.kept():
                write_whole(path, FORMATS[name].written(report))


NO_REPORTS = Reports()


def with_reports(*, several: bool) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """A command that takes `reports` becomes one with an option for each format in that place.

    Args:
        several: whether it judges several things, for which there are more formats.
    """

    def decorated(command: Callable[..., None]) -> Callable[..., None]:
        signature, hints = inspect.signature(command), get_type_hints(command, include_extras=True)
        options = {name: _option(name, one) for name, one in formats(several=several).items()}
        parameters: list[inspect.Parameter] = []
        for one in signature.parameters.values():
            if one.name == "reports":
                kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
                parameters += (inspect.Parameter(n, kind, default=None, annotation=a) for n, a in options.items())
            else:
                parameters.append(one.replace(annotation=hints[one.name]))

        @functools.wraps(command)
        def wrapper(**given: object) -> None:
            files = {name: path for name in options if isinstance(path := given.pop(name), str)}
            command(**given, reports=Reports(files))

        wrapper.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        wrapper.__annotations__ = {one.name: one.annotation for one in parameters}
        return wrapper

    return decorated


def _option(name: str, written: Format) -> Any:  # noqa: ANN401 - an annotation
    def to_a_file(path: str | None) -> str | None:
        if path == STDOUT:
            message = "a page goes to a file"
            raise typer.BadParameter(message)
        return path

    callback = None if written.stdout else to_a_file
    return Annotated[str | None, typer.Option(f"--{name}", metavar="FILE", callback=callback, help=written.says)]


def annotate(findings: Iterable[Finding], wanted: bool | None, taken: str | None) -> None:
    """Print annotations for GitHub, where it is said or else in a workflow; to stderr where a report takes stdout.

    Raises UnreadableError if stdout cannot be written to.
    """
    if not in_github(wanted):
        return
    from missionfsm.tools.check.github import workflow_commands  # noqa: PLC0415 - commands load what they need

    named = ((one.file or None, one.robot or one.subject, one.verdict) for one in findings)
    say_annotations(list(workflow_commands(named)), json=taken)


def write_record(path: str | None, system: System, verdict: Verdict) -> None:
    """Write the history of a violation in the form that the name of the file asks for, if there is one."""
    if path is None or verdict.violation is None:
        return
    from missionfsm.tools.check.narrate import as_mermaid, as_pytest  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.conform.contradiction import recorded  # noqa: PLC0415 - as above

    history = recorded(verdict.violation)
    form = Path(path).suffix
    if form == ".py":
        name = re.sub(r"\W+", "_", Path(path).stem.removeprefix("test_")).strip("_") or system.name.replace(".", "_")
        write_whole(path, as_pytest(history, name).encode())
    elif form == ".mmd":
        write_whole(path, as_mermaid(system, history).encode())
    else:
        write_history(path, history)


def known_violations(path: str | None, *, judged: System | None = None) -> tuple[str, ...]:
    """The rules of a system, or of all, that a file lists as known to be broken; bad input if one of them is none."""
    if path is None:
        return ()
    from missionfsm.adapters.historyfile import read_whole  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.check.baseline import read_expected  # noqa: PLC0415

    with one_line_errors():
        data = read_whole(path)
    try:
        return read_expected(data.decode(), [one.spec for one in ([judged] if judged else map(the_system, names()))])
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        stop(f"{path}:{line}: byte 0x{data[error.start]:02x} is not UTF-8", BAD_INPUT)
    except ValueError as error:
        stop(f"{path}:{error}", BAD_INPUT)
