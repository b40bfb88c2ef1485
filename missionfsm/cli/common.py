"""What the commands share: how bad input ends, how readings are given, where JSON goes."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from typing import NoReturn

import orjson
import typer

from missionfsm.adapters.historyfile import write_whole
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.subject import SubjectError
from missionfsm.kernel.system import System
from missionfsm.systems import system

DONE, FAILED, BAD_INPUT, ADAPTER_FAILED = 0, 1, 2, 3


def stop(says: str, status: int) -> NoReturn:
    """End with one line on stderr."""
    print(f"missionfsm: {says}", file=sys.stderr)  # noqa: T201 - the command line speaks
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


def write_json(path: str | None, value: JSON) -> None:
    """Write a value as JSON to a file or to stdout, if it is wanted."""
    if path:
        with one_line_errors():
            write_whole(path, orjson.dumps(value, option=orjson.OPT_INDENT_2) + b"\n")


def say(text: str, *, json: str | None) -> None:
    """Print for people, unless stdout is taken by JSON."""
    if json != "-":
        print(text)  # noqa: T201 - the command line speaks


def say_now(text: str, *, json: str | None) -> None:
    """Print for people who wait for it."""
    say(text, json=json)
    sys.stdout.flush()
