"""The command that judges recorded histories."""

from __future__ import annotations

from typing import Annotated

import typer

from missionfsm.cli.common import (
    DONE,
    FAILED,
    Troubles,
    choice,
    one_line_errors,
    readable,
    refuse_outputs,
    say_shown,
    write_json,
)
from missionfsm.cli.options import (
    Github,
    JunitFile,
    KnownFile,
    NoFlagged,
    ProfileName,
    Readings,
    Transport,
    Verbose,
    finite,
)
from missionfsm.cli.overgrpc import Beginning
from missionfsm.cli.pages import HtmlFile, write_report
from missionfsm.cli.printing import JsonFile, say_verdict, stamped
from missionfsm.cli.progress import Bar
from missionfsm.cli.reports import annotate, known_violations, write_junit
from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.text import printable
from missionfsm.tools.check.verdict import Verdict


def check(  # noqa: PLR0913 - options of the command
    files: Annotated[
        list[str], typer.Argument(metavar="FILE…", help="Recorded histories, or folders of them; - is stdin.")
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
        int | None, typer.Option(min=1, max=1024, help="Files judged at a time; by default as many as are worth it.")
    ] = None,
    summary: Annotated[
        bool | None,
        typer.Option("--summary/--no-summary", help="Only what all verdicts come to, as for folders; or every one."),
    ] = None,
    expect_violations: KnownFile = None,
    json: JsonFile = None,
    html: HtmlFile = None,
    junit: JunitFile = None,
    github: Github = None,
    verbose: Verbose = False,
) -> None:
    """Judge recorded histories, or bare messages of live subscriptions and bodies of webhooks."""
    from missionfsm.app.many import histories, judge_files  # noqa: PLC0415 - commands load what they need
    from missionfsm.cli.summary import Told  # noqa: PLC0415
    from missionfsm.tools.check.baseline import Baseline, excused  # noqa: PLC0415

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
    refuse_outputs({"--json": json, "--html": html, "--junit": junit}, (*found, expect_violations))
    many = found != files
    told = Told(json) if (many if summary is None else summary) else None
    reached: list[tuple[str, str | None, Verdict]] = []
    troubles = Troubles()

    def tell(line: str) -> None:
        with troubles.kept():
            say_shown(line, json=json)

    with Bar("files", len(found)) as bar:
        live = tell if told is None else None
        for one in judge_files(found, readings, jobs=jobs, progress=bar.one_more, tell=live, **how):
            with troubles.kept():
                for line in () if told else one.said:
                    say_shown(line, json=json)
                for robot, judged in one.verdicts:
                    reached.append((readable(one.path), robot, excused(judged, known)))
                    if told is None:
                        say_verdict(_headed(*reached[-1], verbose=verbose), json=json)
                if one.trouble:  # one that cannot be read keeps none of the others from being judged
                    raise UnreadableError(one.trouble)
    if told is not None:
        with troubles.kept():
            told.say(reached)
    stale = () if troubles else known.stale  # they may be met in what cannot be read
    with troubles.kept():
        for rule in stale:
            say_shown(f"a violation of {rule} was expected and was not met: take it off the list", json=json)
    if reached:
        more = {"stale": list(stale)} if stale else {}
        verdicts = [{"file": path, "robot": robot, **one.to_json(), **more} for path, robot, one in reached]
        with troubles.kept():
            write_json(json, stamped(verdicts[0] if len(verdicts) == 1 and not many else verdicts))
        with troubles.kept():
            annotate(github, [(path, robot or "", verdict) for path, robot, verdict in reached], json)
        with troubles.kept():
            write_report(html, *reached)
        with troubles.kept():
            write_junit(junit, [(f"{path} {robot}" if robot else path, verdict) for path, robot, verdict in reached])
    troubles.end(DONE if not stale and all(verdict.conforms for _, _, verdict in reached) else FAILED)


def _headed(path: str, robot: str | None, verdict: Verdict, *, verbose: bool) -> str:
    """The verdict with what it is about."""
    return f"{printable(path)}{f' {printable(robot)}' if robot else ''}: {verdict.told(verbose=verbose)}"
