"""The command that visits every state of the model."""

from __future__ import annotations

from typing import Annotated

import typer

from missionfsm.cli.common import BAD_INPUT, DONE, FAILED, choice, complain, profiled, refuse_outputs, stop, the_system
from missionfsm.cli.helping import SystemName
from missionfsm.cli.options import ProfileName, Readings
from missionfsm.cli.pages import HtmlFile, write_explorer
from missionfsm.cli.printing import JsonFile, print_result


def explore(
    system: SystemName,
    missions: Annotated[int, typer.Option(min=0, max=8, help="Listed missions, at most.")] = 2,
    goals: Annotated[int, typer.Option(min=1, max=8, help="Goals of a mission, at most.")] = 2,
    batch: Annotated[int, typer.Option(min=1, max=8, help="Missions of a batch, at most.")] = 2,
    reading: Readings = None,
    profile: ProfileName = None,
    forget_ended: Annotated[
        bool, typer.Option("--forget-ended", help="Only count what has ended: far fewer states, the same steps.")
    ] = False,
    hazards: Annotated[
        bool, typer.Option("--hazards", help="What a retry can lead to, for every call and failure; nothing else.")
    ] = False,
    json: JsonFile = None,
    html: HtmlFile = None,
) -> None:
    """Visit every state within bounds: invariants, possibilities, which rules fire."""
    from missionfsm.kernel.alphabet import Bounds  # noqa: PLC0415 - commands load what they need
    from missionfsm.kernel.readings import constrain  # noqa: PLC0415
    from missionfsm.tools.explore.explore import explore as visit  # noqa: PLC0415

    explored = the_system(system)
    readings = profiled(profile, choice(reading), explored)
    try:
        assumed = constrain(explored.spec.ambiguities, readings)
    except ValueError as error:
        stop(str(error), BAD_INPUT)
    refuse_outputs({"--json": json, "--html": html})
    bounds = Bounds(missions, goals=goals, batch=batch)
    if hazards:
        from missionfsm.tools.explore.hazards import hazards as retries  # noqa: PLC0415

        if html is not None or forget_ended:
            stop("--hazards: it goes with no --html and no --forget-ended", BAD_INPUT)
        print_result(retries(explored, bounds, readings), json).end(DONE)
    if forget_ended and html is not None:
        stop("--forget-ended: it has no effect on the page of --html, which shows every state", BAD_INPUT)
    if explored.minutes_at is not None and missions >= explored.minutes_at:
        complain(f"explore {system}: this takes minutes; --missions {explored.minutes_at - 1} takes seconds")
    found = visit(explored, bounds, assumed=assumed, forget_ended=forget_ended)
    troubles = print_result(found, json)
    with troubles.kept():
        write_explorer(html, explored, found, assumed)
    troubles.end(DONE if found.holds else FAILED)
