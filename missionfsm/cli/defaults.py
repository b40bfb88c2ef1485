"""Defaults of options from the table ``[tool.missionfsm]`` of the pyproject.toml of the folder, or of one above it.

An option in the table itself is a default of every command that has it; an option in ``[tool.missionfsm.conform]`` is a
default of that command alone. Options on the command line take precedence.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from typer.core import TyperGroup

from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.text import brief


def defaults(commands: TyperGroup, folder: Path) -> dict[str, dict[str, Any]]:
    """Command to its defaults, by the names of their parameters.

    Raises:
        UnreadableError: the file cannot be read, or has a key that is no command and no option.
    """
    path = next(
        (one / "pyproject.toml" for one in (folder, *folder.parents) if (one / "pyproject.toml").is_file()), None
    )
    if path is None:
        return {}
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8")).get("tool", {}).get("missionfsm", {})
    except (OSError, ValueError) as error:
        raise UnreadableError(f"{path}: {error}") from None
    options = {name: _options(command) for name, command in commands.commands.items()}
    found = _of_all(table, options, path)
    for name, known in options.items():
        for key, value in table.get(name, {}).items():
            if key not in known:
                raise UnreadableError(f"{path}: [tool.missionfsm.{name}] has {brief(key)}, which is no option of it")
            found[name][known[key]] = value
    return found


def _of_all(table: dict[str, Any], options: Mapping[str, Mapping[str, str]], path: Path) -> dict[str, dict[str, Any]]:
    """What is said for every command that has such an option; the tables of single commands are left out."""
    found: dict[str, dict[str, Any]] = {name: {} for name in options}
    for key, value in table.items():
        having = [name for name, known in options.items() if key in known]
        if key in options and isinstance(value, dict):
            continue
        if not having:
            raise UnreadableError(f"{path}: [tool.missionfsm] has {brief(key)}, which is no command and no option")
        for name in having:
            found[name][options[name][key]] = value
    return found


def _options(command: Any) -> dict[str, str]:  # noqa: ANN401 - a command of click, which typer hides
    """The long options of a command, without their dashes, to the parameters that they set."""
    return {
        option.removeprefix("--"): parameter.name or ""
        for parameter in command.params
        if parameter.param_type_name == "option"
        for option in parameter.opts
        if option.startswith("--")
    }
