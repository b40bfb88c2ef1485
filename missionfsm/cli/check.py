"""The command that judges recorded histories."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import define, field

from missionfsm.adapters.historyfile import STDIN
from missionfsm.cli.common import (
    DONE,
    FAILED,
    Troubles,
    choice,
    one_line_errors,
    readable,
    refuse_outputs,
    say_shown,
)
from missionfsm.cli.options import (
    Github,
    KnownFile,
    NoFlagged,
    ProfileName,
    Readings,
    Transport,
    Verbose,
    finite,
)
from missionfsm.cli.overgrpc import Beginning
from missionfsm.cli.printing import made, say_verdict
from missionfsm.cli.progress import Bar
from missionfsm.cli.reports import NO_REPORTS, Reports, annotate, known_violations, with_reports
from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.text import printable
from missionfsm.reports.report import Finding, Report

if TYPE_CHECKING:
    from missionfsm.app.many import Judged
    from missionfsm.cli.summary import Told
    from missionfsm.tools.check.baseline import Baseline

MANY = 20
"""Files, or robots of one, of which each verdict is told unless it is asked otherwise; more are summed up."""


@with_reports(several=True)
def check(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE…", help="Recorded histories, folders of them or patterns ('*.gz'); - is stdin."),
    ],
    reading: Readings = None,
    profile: ProfileName = None,
    no_flagged: NoFlagged = False,
    transport: Annotated[
        Transport, typer.Option(help="Whether messages may be lost, doubled or made up on the way.")
    ] = Transport.IMPERFECT,
    begins: Annotated[
        Beginning,
        typer.Option(help="Whether the logs begin with a robot that has done nothing, or while it is in use."),
    ] = Beginning.FRESH,
    others: Annotated[
        bool, typer.Option("--others", help="Others, whose calls are not in the logs, use the robots as well.")
    ] = False,
    settled_after: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", min=0, callback=finite, help="What is due so long (of `at`) is late."),
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option(min=1, max=1024, help="Processes that judge files, or robots of a large one; as many as pay off."),
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option(metavar="SCHEDULER", help="Judge on the workers of this scheduler of Dask; local starts some."),
    ] = None,
    summary: Annotated[
        bool | None,
        typer.Option("--summary/--no-summary", help="Only what all verdicts come to, as for folders; or every one."),
    ] = None,
    expect_violations: KnownFile = None,
    reports: Reports = NO_REPORTS,
    github: Github = None,
    verbose: Verbose = False,
) -> None:
    """Judge recorded histories, or bare messages of live subscriptions and bodies of webhooks.

    Exit status: 0 if all conform, flagged or not, 1 if one violates or is inconclusive, 2 for bad usage or a file that
    cannot be read (one line says where and why). 3, that the adapter failed, comes of conform alone.
    """
    from missionfsm.app.many import histories  # noqa: PLC0415 - commands load what they need
    from missionfsm.cli.summary import Told  # noqa: PLC0415
    from missionfsm.tools.check.baseline import Baseline  # noqa: PLC0415

    readings = choice(reading)
    how = {
        "no_flagged": no_flagged,
        "profile": profile,
        "strict": transport is Transport.STRICT,
        "anywhere": begins is Beginning.ANYWHERE,
        "others": others,
        "settled_after": settled_after,
    }
    known = Baseline(known_violations(expect_violations))
    with one_line_errors():
        found = histories(files)
        refuse_outputs(reports.outputs, (*found, expect_violations))
        reports.refuse_impossible()
    many = found != list(dict.fromkeys(files))
    sums_up = many or len(found) > MANY if summary is None else summary
    telling = _Telling(known, sums_up, summary is None, reports.taken, verbose)
    told = Told(reports.taken)
    with one_line_errors(), Bar("files", len(found)) as bar:
        live = None if telling.sums_up else telling.say
        for one in _judged(found, readings, jobs=jobs, dask=dask, progress=bar.more, tell=live, **how):
            telling.add(one)
    telling.end(told)
    reached, troubles = telling.reached, telling.troubles
    if reached:
        with troubles.kept():
            annotate(reached, github, reports.taken)
        reports.write(Report(tuple(reached), made(), telling.stale, several=many), troubles)
    conform = not telling.stale and all(one.verdict.conforms for one in reached)
    troubles.end(DONE if conform else FAILED)


@define(eq=False)
class _Telling:
    """Tells the verdicts as they come, or sums them up in the end.

    Attributes:
        known: the violations that are expected.
        sums_up: whether all verdicts are summed up.
        may_sum_up: whether they are also summed up from the first file on that has too many robots.
        json: ``-`` if a report goes to stdout, so that nothing else may.
    """

    known: Baseline
    sums_up: bool
    may_sum_up: bool
    json: str | None
    verbose: bool
    reached: list[Finding] = field(factory=list)
    troubles: Troubles = field(factory=Troubles)

    @property
    def stale(self) -> tuple[str, ...]:
        """Rules whose expected violation was not met; none if a file could not be read, which may have it."""
        return () if self.troubles else self.known.stale

    def say(self, line: str) -> None:
        """Tell a line; what goes wrong with that is kept."""
        with self.troubles.kept():
            say_shown(line, json=self.json)

    def add(self, one: Judged) -> None:
        """A file has been judged; one that cannot be read keeps none of the others from it."""
        from missionfsm.tools.check.baseline import with_known  # noqa: PLC0415 - commands load what they need

        with self.troubles.kept():
            for line in () if self.sums_up else one.said:
                say_shown(line, json=self.json)
            self.sums_up = self.sums_up or (self.may_sum_up and len(one.verdicts) > MANY)
            for robot, judged in one.verdicts:
                found = Finding(with_known(judged, self.known), readable(one.path), robot, one.seconds)
                self.reached.append(found)
                if not self.sums_up:
                    say_verdict(_headed(found, verbose=self.verbose), json=self.json)
            if one.trouble:
                raise UnreadableError(one.trouble)

    def end(self, told: Told) -> None:
        """Sum up, and tell what was expected and not met."""
        if self.sums_up:
            with self.troubles.kept():
                told.say((one.file, one.robot, one.verdict) for one in self.reached)
        for rule in self.stale:
            self.say(f"a violation of {rule} was expected and was not met: take it off the list")


def _judged(
    files: list[str],
    readings: dict[str, str],
    *,
    jobs: int | None,
    dask: str | None,
    tell: Callable[[str], None] | None,
    **how: Any,  # noqa: ANN401 - see `missionfsm.app.asked.Asked`
) -> Iterator[Judged]:
    """What there is to say of each file, judged where it is wanted; bad usage where it cannot be judged there."""
    if dask is None:
        from missionfsm.app.many import judge_files  # noqa: PLC0415 - commands load what they need

        return judge_files(files, readings, jobs=jobs, tell=tell, **how)
    from missionfsm import fleet  # noqa: PLC0415 - commands load what they need

    if STDIN in files:
        message = "--dask: stdin can be read in this process alone"
        raise UnreadableError(message)
    if jobs is not None and dask != fleet.LOCAL:
        message = f"--jobs: how many workers there are is up to the scheduler at {dask}"
        raise UnreadableError(message)
    return fleet.judge(files, readings, scheduler=dask, workers=jobs, **how)


def _headed(found: Finding, *, verbose: bool) -> str:
    """The verdict with what it is about."""
    robot = f" {printable(found.robot)}" if found.robot else ""
    return f"{printable(found.file)}{robot}: {found.verdict.text(verbose=verbose)}"
