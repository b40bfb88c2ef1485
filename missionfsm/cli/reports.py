"""What the commands that judge write beside their verdicts, and the list of what is known to be broken."""

from __future__ import annotations

import re
from pathlib import Path

from attrs import frozen

from missionfsm.cli.common import BAD_INPUT, Troubles, one_line_errors, stop, the_system
from missionfsm.cli.pages import write_report
from missionfsm.cli.printing import in_github, say_annotations
from missionfsm.kernel.system import System
from missionfsm.systems import names
from missionfsm.tools.check.verdict import Verdict

Finding = tuple[str, str | None, Verdict]
"""A file, empty where there is none; a robot, if the file names one; and the verdict."""


@frozen
class Reports:
    """What a command that judges writes beside its verdicts: files that options name, and annotations for GitHub."""

    json: str | None
    html: str | None
    junit: str | None
    github: bool | None

    @property
    def outputs(self) -> dict[str, str | None]:
        """The options to the files that they name."""
        return {"--json": self.json, "--html": self.html, "--junit": self.junit}

    def write(self, reached: list[Finding], troubles: Troubles) -> None:
        """Write all that are wanted but for the JSON; what goes wrong with one is kept, and the others are written."""
        with troubles.kept():
            self._annotate(reached)
        with troubles.kept():
            write_report(self.html, *reached)
        with troubles.kept():
            self._write_junit(reached)

    def _annotate(self, reached: list[Finding]) -> None:
        if not in_github(self.github):
            return
        from missionfsm.tools.check.github import workflow_commands  # noqa: PLC0415 - commands load what they need

        named = ((path or None, robot or _subject(verdict), verdict) for path, robot, verdict in reached)
        say_annotations(list(workflow_commands(named)), json=self.json)

    def _write_junit(self, reached: list[Finding]) -> None:
        if self.junit is None:
            return
        from missionfsm.adapters.outputs import write_whole  # noqa: PLC0415 - commands load what they need
        from missionfsm.tools.check.junit import junit  # noqa: PLC0415

        named = [
            (f"{path} {robot}" if robot else path or _subject(verdict), verdict) for path, robot, verdict in reached
        ]
        write_whole(self.junit, junit(named))


def _subject(verdict: Verdict) -> str:
    """What was judged, where no file says so."""
    return verdict.implementation or verdict.system


def write_record(path: str | None, system: System, verdict: Verdict) -> None:
    """Write the history of a violation in the form that the name of the file asks for, if there is one."""
    if path is None or verdict.violation is None:
        return
    from missionfsm.adapters.outputs import write_history, write_whole  # noqa: PLC0415
    from missionfsm.tools.check.narrate import as_mermaid, as_pytest  # noqa: PLC0415
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
