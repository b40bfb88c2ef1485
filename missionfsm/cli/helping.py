"""What ``--help`` shows besides the options: the systems there are, and examples of each command; names to complete."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from missionfsm.kernel.codec import UnreadableError
from missionfsm.systems import names, title

EXAMPLES: dict[str, tuple[str, ...]] = {
    "missionfsm": (
        "missionfsm conform bear.mission",
        "missionfsm conform bear.mission -- python3 my_adapter.py",
        "missionfsm check monday.jsonl",
    ),
    "conform": (
        "missionfsm conform bear.mission --seed 1 --time 60 -- python3 my_adapter.py",
        "missionfsm conform bear.mission --record fault.jsonl --html fault.html -- ./my-adapter",
        "missionfsm conform bear.status --grpc localhost:50051",
        "missionfsm conform isaac.server --tcp localhost:9999 --missions missions.json",
    ),
    "check": (
        "missionfsm check monday.jsonl.gz",
        "missionfsm check logs --json verdicts.json",
        "missionfsm check monday.jsonl --begins anywhere --others",
        "missionfsm check monday.jsonl --reading AM-09=a --html monday.html",
    ),
    "smoke": ("missionfsm smoke bear.mission -- python3 my_adapter.py",),
    "explore": ("missionfsm explore bear.mission --html explorer.html", "missionfsm explore bear.mission --hazards"),
    "teeth": ("missionfsm teeth isaac.robot --only a-new-mission-preempts",),
    "rules": ("missionfsm rules bear.mission",),
    "readings": ("missionfsm readings bear.mission",),
    "schema": ("missionfsm schema adapter --system bear.mission > adapter.schema.json",),
    "new": ("missionfsm new lamp",),
    "diagram": ("missionfsm diagram bear.mission/mission --format svg -o pictures",),
    "adapter": ("missionfsm adapter bear.mission",),
    "serve": (
        "missionfsm serve bear.mission --grpc 50051 --auto 2",
        "missionfsm serve bear.mission --grpc 50051 --fault deadline:0.05 --fault lost:0.01 --seed 7",
    ),
    "proxy": ("missionfsm proxy bear.mission --grpc robot:50051 --listen 50052 --record today.jsonl",),
    "dispatch": ("missionfsm dispatch missions.json --journal missions.db",),
    "robot": ("missionfsm robot --name carter01",),
}
"""Command to commands worth copying; the program's own under its name."""


class Command(TyperCommand):
    """A command whose help ends with examples."""

    def format_epilog(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401, ARG002 - click's, which typer hides
        """Write the examples."""
        _write_examples(formatter, EXAMPLES.get(self.name or "", ()))


class Program(TyperGroup):
    """The program, whose help lists the systems as well."""

    def format_epilog(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401, ARG002 - click's, which typer hides
        """Write the systems, what each is in a few words, and examples."""
        with formatter.section("Systems"):
            formatter.write_dl([(name, _title(name)) for name in names()])
        _write_examples(formatter, EXAMPLES["missionfsm"])


def _write_examples(formatter: Any, examples: tuple[str, ...]) -> None:  # noqa: ANN401 - click's, which typer hides
    if examples:
        with formatter.section("Examples"):
            for one in examples:
                formatter.write(f"{' ' * formatter.current_indent}{one}\n")


def _title(name: str) -> str:
    """What a system is; one of another package may be broken, and help is needed all the same."""
    try:
        return title(name)
    except UnreadableError as error:
        return str(error)


def completed(incomplete: str) -> list[str]:
    """The systems whose names begin so, for the completion of a shell."""
    return [name for name in names() if name.startswith(incomplete)]


SystemName = Annotated[
    str,
    typer.Argument(
        metavar="SYSTEM",
        help="Which system; `missionfsm --help` lists them.",
        autocompletion=completed,
        show_default=False,
    ),
]

__all__ = ["EXAMPLES", "Command", "Program", "SystemName"]
