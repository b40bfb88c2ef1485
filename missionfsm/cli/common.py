"""What the commands share: how bad input ends, how readings are given, what people are told and where JSON goes."""

from __future__ import annotations

import contextlib
import itertools
import sys
from collections.abc import Iterable, Iterator, Mapping
from typing import NoReturn

import orjson
import typer

from missionfsm.adapters.outputs import STDOUT, refuse_unwritable, same_file, to_stdout, write_whole
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.subject import SubjectError
from missionfsm.kernel.system import System
from missionfsm.kernel.text import clipped
from missionfsm.systems import system

DONE, FAILED, BAD_INPUT, ADAPTER_FAILED = 0, 1, 2, 3
INTERRUPTED = 130
"""As a shell says it of what ended by Ctrl-C."""


def complain(says: str) -> None:
    """Say what is wrong, in one line on stderr."""
    if sys.stderr is not None:  # print would take stdout instead
        with contextlib.suppress(OSError):
            print(f"missionfsm: {clipped(says)}", file=sys.stderr, flush=True)  # noqa: T201 - the command line speaks


def stop(says: str, status: int) -> NoReturn:
    """End with one line on stderr."""
    complain(says)
    raise typer.Exit(status)


@contextlib.contextmanager
def one_line_errors() -> Iterator[None]:
    """Whatever a user or an adapter did wrong ends in one line and the right status, never in a traceback."""
    try:
        yield
    except UnreadableError as error:
        stop(str(error), BAD_INPUT)
    except SubjectError as error:
        stop(str(error), ADAPTER_FAILED)


def the_system(name: str) -> System:
    """The system with a name; bad input if there is none."""
    with one_line_errors():
        return system(name)


def choice(readings: list[str] | None) -> dict[str, str]:
    """``AM-09=a`` and the like as a mapping."""
    found: dict[str, str] = {}
    for one in readings or []:
        name, sign, letter = one.partition("=")
        if not sign or not name or not letter:
            stop(f"--reading {one}: expected an ambiguity and a letter, such as AM-09=a", BAD_INPUT)
        if found.get(name, letter) != letter:
            stop(f"--reading {one}: {name} was given the reading {found[name]} before", BAD_INPUT)
        found[name] = letter
    return found


def profiled(profile: str | None, readings: Mapping[str, str], chosen: System) -> Mapping[str, str]:
    """The readings of a profile of a system, but for those that are given; bad input where it has no such profile."""
    try:
        return chosen.chosen(profile, readings)
    except ValueError as error:
        stop(f"--profile: {error}", BAD_INPUT)


def refuse_outputs(outputs: Mapping[str, str | None], inputs: Iterable[str | None] = ()) -> None:
    """Bad input, before any work is done, where something cannot be written or would destroy something else.

    Args:
        outputs: options to the files that they name, if they are given.
        inputs: files that are read.
    """
    wanted = {option: path for option, path in outputs.items() if path is not None}
    for option, path in wanted.items():
        try:
            refuse_unwritable(path)
        except UnreadableError as error:
            stop(f"{option}: {error}", BAD_INPUT)
    for one, other in itertools.combinations(wanted, 2):
        if wanted[one] == wanted[other] == STDOUT or same_file(wanted[one], wanted[other]):
            stop(f"{one} and {other}: both go to {wanted[one]}", BAD_INPUT)
    for (option, path), source in itertools.product(wanted.items(), inputs):
        if source and same_file(path, source):
            stop(f"{option}: {path} is read, and would be overwritten", BAD_INPUT)


def refuse_options(options: Mapping[str, object], where: str) -> None:
    """Bad input where an option is given that has no effect there."""
    for option, value in options.items():
        if value:
            stop(f"{option}: it has no effect {where}", BAD_INPUT)


def refuse_given(context: typer.Context, parameters: Mapping[str, str], where: str) -> None:
    """Bad input where an option was given on the command line that has no effect there.

    Args:
        parameters: names of the command's parameters to the options that they are.
    """
    for name, option in parameters.items():
        source = context.get_parameter_source(name)
        if source is not None and source.name == "COMMANDLINE":
            stop(f"{option}: it has no effect {where}", BAD_INPUT)


class Troubles:
    """What went wrong while the rest was told and written all the same; it is said at the end, a line each."""

    def __init__(self) -> None:
        self._said: list[str] = []

    def __bool__(self) -> bool:
        return bool(self._said)

    @contextlib.contextmanager
    def kept(self) -> Iterator[None]:
        """What cannot be read or written here does not end the command."""
        try:
            yield
        except UnreadableError as error:
            self._said.append(str(error))

    def end(self, status: int) -> NoReturn:
        """End with that status, or as bad input if anything went wrong."""
        for one in dict.fromkeys(self._said):
            complain(one)
        raise typer.Exit(BAD_INPUT if self else status)


def readable(path: str) -> str:
    """The name of a file as text that can be printed: bytes that are not UTF-8 are replaced."""
    return path.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def write_json(path: str | None, value: JSON) -> None:
    """Write a value as JSON to a file or to stdout, if it is wanted. Raises UnreadableError if that is impossible."""
    if path is not None:
        write_whole(path, orjson.dumps(value, option=orjson.OPT_INDENT_2) + b"\n")


def say(text: str, *, json: str | None = None) -> None:
    """Print for people, unless stdout is taken by JSON. Raises UnreadableError if stdout cannot be written to."""
    if json != STDOUT and sys.stdout is not None:
        with to_stdout():
            print(text)  # noqa: T201 - the command line speaks


def say_shown(text: str, *, json: str | None) -> None:
    """Print what may hold texts from elsewhere: no terminal obeys them, and no line is longer than people read."""
    say("\n".join(map(clipped, text.split("\n"))), json=json)
