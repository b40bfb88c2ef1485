"""The commands about adapters: the reference behind one, and a first look at one of your own."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from missionfsm.cli.common import ADAPTER_FAILED, BAD_INPUT, DONE, choice, profiled, refuse_outputs, stop, the_system
from missionfsm.cli.helping import SystemName
from missionfsm.cli.options import DAY, ProfileName, Readings, finite
from missionfsm.cli.printing import JsonFile, print_result


def smoke(
    system: SystemName,
    command: Annotated[list[str], typer.Argument(help="The adapter to look at, after --.")],
    timeout: Annotated[
        float, typer.Option(min=0.01, max=DAY, callback=finite, help="Seconds that an answer may take.")
    ] = 3.0,
    json: JsonFile = None,
) -> None:
    """Ask an adapter for each method once, and say what is not of the protocol and how to mend it.

    Exit status: 0 for an adapter, 3 for something that is none yet.
    """
    from missionfsm.adapters.stdio import Child  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.conform.smoke import smoke as looked_at  # noqa: PLC0415

    refuse_outputs({"--json": json})
    found = looked_at(the_system(system), lambda: Child(command, timeout))
    troubles = print_result(found, json)
    troubles.end(DONE if found.is_adapter else ADAPTER_FAILED)


def adapter(
    system: SystemName,
    reading: Readings = None,
    profile: ProfileName = None,
) -> None:
    """Put the reference model behind the adapter protocol, on stdin and stdout."""
    from missionfsm.adapters.historyfile import stdin  # noqa: PLC0415 - commands load what they need
    from missionfsm.adapters.outputs import to_stdout  # noqa: PLC0415
    from missionfsm.adapters.stdio import serve  # noqa: PLC0415
    from missionfsm.tools.reference.subject import ReferenceSubject  # noqa: PLC0415

    try:
        reference = ReferenceSubject(the_system(system), profiled(profile, choice(reading), the_system(system)))
    except ValueError as error:
        stop(str(error), BAD_INPUT)
    requests = stdin()
    with to_stdout():
        serve(reference, requests, sys.stdout.buffer)
