"""The command that shows whether the oracle has teeth: on broken references, and on implementations of others."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionfsm.cli.common import BAD_INPUT, DONE, FAILED, refuse_outputs, stop, the_system
from missionfsm.cli.helping import SystemName
from missionfsm.cli.pages import HtmlFile, write_teeth
from missionfsm.cli.printing import JsonFile, print_result
from missionfsm.cli.progress import Bar
from missionfsm.kernel.codec import UnreadableError

SECONDS = 120.0
"""How long a foreign subject is judged at most, where nobody says."""


def teeth(
    system: SystemName,
    subjects: Annotated[
        str | None,
        typer.Option(metavar="FOLDER", help="Judge instead what others made, as its subjects.toml names it."),
    ] = None,
    only: Annotated[str, typer.Option(help="Judge only implementations with this in their name.")] = "",
    every: Annotated[int, typer.Option(min=1, help="Of those only every so many-th, from the first on.")] = 1,
    seed: Annotated[int, typer.Option(help="The same seed asks the same, in as many processes.")] = 0,
    time: Annotated[float, typer.Option(min=0.1, help="Seconds for each of --subjects, at most.")] = SECONDS,
    jobs: Annotated[int, typer.Option(min=0, help="Processes; 0 is one for each core.")] = 0,
    json: JsonFile = None,
    html: HtmlFile = None,
) -> None:
    """Break every rule, one at a time, and see whether the oracle notices."""
    from missionfsm.app.cores import cores  # noqa: PLC0415 - commands load what they need
    from missionfsm.app.parallel import teeth_on  # noqa: PLC0415
    from missionfsm.tools.mutate.teeth import sampled  # noqa: PLC0415

    judged = the_system(system)
    refuse_outputs({"--json": json, "--html": html})
    if subjects is not None:
        if html is not None:
            stop("--html has no effect with --subjects", BAD_INPUT)
        _foreign(system, Path(subjects), only, every, seed, time, jobs or cores(), json)
        return
    if time != SECONDS:
        stop("--time has no effect without --subjects", BAD_INPUT)
    total = len(sampled(judged, only, every))
    if not total:
        stop(f"--only {only}: no implementation has {only!r} in its name", BAD_INPUT)
    with Bar("implementations", total) as bar:
        found = teeth_on(min(jobs or cores(), total), system, seed=seed, only=only, every=every, progress=bar.one_more)
    troubles = print_result(found, json)
    with troubles.kept():
        write_teeth(html, judged, found)
    troubles.end(FAILED if found.survived or found.untested else DONE)


def _foreign(
    system: str, folder: Path, only: str, every: int, seed: int, seconds: float, jobs: int, json: str | None
) -> None:
    """Judge the implementations of others in a folder, and end the command."""
    from missionfsm.app.foreign import judge_all, subjects  # noqa: PLC0415 - commands load what they need

    try:
        given = [one for one in subjects(folder) if only in one.name][::every]
    except UnreadableError as error:
        stop(str(error), BAD_INPUT)
    if not given:
        stop(f"--only {only}: no implementation has {only!r} in its name", BAD_INPUT)
    with Bar("implementations", len(given)) as bar:
        found = judge_all(system, given, seed=seed, seconds=seconds, jobs=min(jobs, len(given)), progress=bar.one_more)
    print_result(found, json).end(FAILED if found.wrong else DONE)
