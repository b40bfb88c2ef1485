"""The command line: ``missionfsm conform``, ``check``, ``explore``, ``rules``, ``readings``, ``adapter`` and more.

It may import everything; nothing imports it. Begin with the file that is called like the command; `common` and
`printing` are what all of them share.

Exit status: 0 conforms (or done), 1 violates or inconclusive, 2 bad usage or bad input, 3 the adapter failed.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import Annotated, cast

import typer

from missionfsm.adapters.outputs import silence_stdout
from missionfsm.app.garbage import seldom
from missionfsm.cli import adapter, check, conform, diagram, dispatch, explore, listing, proxy, robot, serve, teeth
from missionfsm.cli.common import BAD_INPUT, DONE, complain, say
from missionfsm.cli.defaults import defaults
from missionfsm.cli.helping import Command, Program
from missionfsm.cli.signals import ended_like_ctrl_c
from missionfsm.kernel.codec import UnreadableError

HELP = """An executable model of robot-mission interfaces, and an oracle made from it.

`missionfsm COMMAND --help` says more of a command.

Exit status: 0 conforms (or done), 1 violates or inconclusive, 2 bad usage or bad input, 3 the adapter failed.
"""
app = typer.Typer(
    cls=Program,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
    help=HELP,
)
for _command in (
    conform.conform,
    check.check,
    adapter.smoke,
    explore.explore,
    teeth.teeth,
    listing.rules,
    listing.readings,
    listing.schema,
    listing.new,
    diagram.diagram,
    adapter.adapter,
    dispatch.dispatch,
    robot.robot,
    serve.serve,
    proxy.proxy,
):
    app.command(cls=Command)(_command)


def _version(*, wanted: bool) -> None:
    if wanted:
        from missionfsm import __version__  # noqa: PLC0415 - seldom asked for

        say(f"missionfsm {__version__}")
        raise typer.Exit(DONE)


@app.callback(help=HELP)
def options(
    version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=lambda wanted: _version(wanted=wanted), help="Show it.")
    ] = False,
) -> None:
    """Options of the program itself."""


def main() -> None:
    """Run the command line."""
    if isinstance(sys.stdout, io.TextIOWrapper):  # it may have no daggers, and no encoding has all names of files
        sys.stdout.reconfigure(errors="replace")
    seldom()
    try:
        with ended_like_ctrl_c():
            program = cast(Program, typer.main.get_command(app))  # as `app()` makes it anew: once is enough
            program(default_map=defaults(program, Path.cwd()))
    except KeyboardInterrupt:
        sys.exit(130)
    except UnreadableError as error:
        complain(str(error))
        sys.exit(BAD_INPUT)
    except OSError as error:  # what the commands do not expect, such as a help that finds no room
        silence_stdout()
        complain(error.strerror or str(error))
        sys.exit(BAD_INPUT)


if __name__ == "__main__":
    main()
