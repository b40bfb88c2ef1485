"""The commands that list: rules, readings, the schemas of the two formats; and a system to start from."""

from __future__ import annotations

import enum
from pathlib import Path
from typing import Annotated

import typer

from missionfsm.cli.common import one_line_errors, say, the_system, write_json
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.middle import MIDDLE
from missionfsm.kernel.system import System
from missionfsm.kernel.transport import TRANSPORT

Which = Annotated[str | None, typer.Argument(help="Which system; all if left out.")]
AsJson = Annotated[bool, typer.Option("--json", help="Write JSON.")]


def _systems(name: str | None) -> list[System]:
    from missionfsm.systems import names  # noqa: PLC0415 - commands load what they need

    return [the_system(one) for one in ([name] if name else names())]


def rules(system: Which = None, json: AsJson = False) -> None:
    """List every rule: its id, what it says, and its place in the document."""
    found: list[JSON] = []
    for spec in (one.spec for one in _systems(system)):
        for rule in spec.all_rules:
            under = str(rule.assumes) if rule.assumes else None
            found.append({"id": rule.id, "says": rule.says, "cite": str(rule.cite), "code": rule.code, "under": under})
            if not json:
                say(f"{rule.id}\n    {rule.says} [{rule.cite}]" + (f" under {under}" if under else ""))
    if json:
        write_json("-", found)


def readings(system: Which = None, json: AsJson = False) -> None:
    """List every ambiguity with its readings; a star marks the reference's, a dagger a departure from the text."""
    found: list[JSON] = []
    for one in _systems(system):
        for ambiguity in (
            *one.spec.ambiguities,
            *(TRANSPORT if one.codec.streams else ()),
            *(MIDDLE if one.spec.middle and one.spec.middle.glimpses else ()),
        ):
            found.append(
                {
                    "system": one.name,
                    "id": ambiguity.id,
                    "question": ambiguity.question,
                    "readings": dict(ambiguity.readings),
                    "default": ambiguity.default,
                    "flagged": sorted(ambiguity.flagged),
                }
            )
            if not json:
                lines = [f"{ambiguity.id}  {ambiguity.question}"]
                for letter, answer in ambiguity.readings.items():
                    mark = "*" if letter == ambiguity.default else "†" if letter in ambiguity.flagged else " "
                    lines.append(f"  {mark} {letter}  {answer}")
                say("\n".join(lines))
    if json:
        write_json("-", found)


class Format(enum.Enum):
    """What there are schemas of."""

    ADAPTER = "adapter"
    HISTORY = "history"


def schema(
    which: Annotated[Format, typer.Argument(metavar="adapter|history", help="The protocol or the format.")],
    system: Annotated[str | None, typer.Option(metavar="SYSTEM", help="Whose lines; any system's if left out.")] = None,
) -> None:
    """Write the JSON Schema of a line of the adapter protocol or of the history format."""
    from missionfsm.tools.schema import schema as made  # noqa: PLC0415 - commands load what they need

    write_json("-", made(which.value, the_system(system) if system is not None else None))


def new(name: Annotated[str, typer.Argument(help="The name of the package, and of its system.")]) -> None:
    """Write a package with a small system of its own, to start from."""
    from missionfsm.app.newsystem import new_system  # noqa: PLC0415 - commands load what they need

    with one_line_errors():
        written = new_system(name, Path())
    say("\n".join(map(str, written)))
    say(f"try it: pip install -e ./{name} && missionfsm explore {name} && missionfsm conform {name}")
