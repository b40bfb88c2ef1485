"""A package with a small system of its own, to start from: what ``missionfsm new`` writes."""

from __future__ import annotations

import inspect
import keyword
import re
from pathlib import Path

from missionfsm.app import lamp
from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.text import brief

_PYPROJECT = """\
[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"

[project]
name = "NAME"
version = "0.1.0"
dependencies = ["missionfsm"]

[project.optional-dependencies]
test = ["pytest"]

[project.entry-points."missionfsm.systems"]
NAME = "NAME.system:SYSTEM"

[tool.setuptools.packages.find]
include = ["NAME*"]
"""
_INIT = '"""The system NAME."""\n'
_TESTS = '''\
"""The system NAME: it holds together, and the oracle that is made from it tells right from wrong."""

import itertools

from missionfsm import conform, explore
from missionfsm.kernel.subject import Exchange

from NAME.system import SYSTEM


def test_every_state_is_as_it_should_be():
    """Every state that can be reached has an answer to every call, and keeps every invariant."""
    assert explore(SYSTEM).holds


def test_the_reference_conforms():
    """What is computed from the specification is what the specification allows."""
    assert conform(SYSTEM, examples=15).conforms


def test_a_lamp_that_shows_nothing_is_found():
    """Whoever opens a stream is shown the light."""
    assert conform(SYSTEM, Dark(), examples=15).violation is not None


class Dark:
    """An implementation that refuses nothing and shows nothing."""

    def __init__(self):
        self.streams = itertools.count(1)

    def exchange(self, method, params):
        if method == "initialize":
            return Exchange(result={"implementation": {"name": "dark"}, "drives": []})
        return Exchange(result={"stream": next(self.streams)} if method == "Watch" else {})

    def close(self):
        pass
'''


def new_system(name: str, folder: Path) -> tuple[Path, ...]:
    """Write a package with that name into the folder; the files that were written.

    Raises:
        UnreadableError: the name is none of a package, or there is something of that name already.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name) or keyword.iskeyword(name):
        raise UnreadableError(f"{brief(name)} is no name of a package: small letters, digits and _, a letter first")
    root = folder / name
    files = {
        root / "pyproject.toml": _PYPROJECT,
        root / name / "__init__.py": _INIT,
        root / name / "system.py": inspect.getsource(lamp).replace('NAME = "lamp"', f'NAME = "{name}"'),
        root / "tests" / f"test_{name}.py": _TESTS,
    }
    try:
        root.mkdir()
        for path, text in files.items():
            path.parent.mkdir(exist_ok=True)
            path.write_text(re.sub(r"\bNAME\b", name, text) if path.name != "system.py" else text, encoding="utf-8")
    except OSError as error:
        raise UnreadableError(f"{error.filename}: {error.strerror}") from None
    return tuple(files)
