"""A package with a small system of its own, to start from: what ``missionfsm new`` writes."""

from __future__ import annotations

import inspect
import keyword
import re
from pathlib import Path

from missionfsm.app import lamp
from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.text import brief
from missionfsm.tools.specpages import regenerate

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
_SPECIFICATION = """\
# `NAME`: a lamp with a timer

What the manual says, clause by clause, in our own words, and what the program makes of it: what stands between two
comments is computed, and `python tests/test_NAME.py` writes it anew.

## What can be asked

<!-- generated: operations -->
<!-- end -->

## Switch

**L-1** (`Lamp › Switch`) Switch turns the light on, or off if there is light. No rule: it is what the call does.

## Dim

**L-2** (`Lamp › Dim`) Dim changes full light to dim. *Open*: LA-01.

**L-3** (`Lamp › Dim › Errors`) Only light can be dimmed. *Checked by* `Dim/FAILED_PRECONDITION/there-is-no-light`.

<!-- generated: rules Dim -->
<!-- end -->

## Watch

**L-4** (`Lamp › Watch`) The stream shows the light at once, then every change. *Checked by*
`Watch/the-light-is-shown`.

<!-- generated: rules Watch -->
<!-- end -->

## What is open

<!-- generated: readings -->
<!-- end -->

### LA-01

<!-- generated: entry LA-01 -->
<!-- end -->
"""
_TESTS = '''\
"""The system NAME: it holds together, and the oracle that is made from it tells right from wrong."""

import itertools
from pathlib import Path

from missionfsm import conform, explore
from missionfsm.kernel.subject import Exchange
from missionfsm.tools.specpages import regenerate

from NAME.system import SYSTEM

PAGE = Path(__file__).parent.parent / "specification.md"


def test_the_specification_says_what_the_program_does():
    """The computed parts of the page are as the program has them."""
    text = PAGE.read_text(encoding="utf-8")
    assert text == regenerate(text, SYSTEM), "run python tests/test_NAME.py"


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


if __name__ == "__main__":
    PAGE.write_text(regenerate(PAGE.read_text(encoding="utf-8"), SYSTEM), encoding="utf-8")
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
        root / "specification.md": regenerate(_SPECIFICATION, lamp.SYSTEM),
        root / "tests" / f"test_{name}.py": _TESTS,
    }
    try:
        root.mkdir()
        for path, text in files.items():
            path.parent.mkdir(exist_ok=True)
            own = text if path.name == "system.py" else re.sub(r"(?<![A-Z])NAME\b", name, text)
            path.write_text(own, encoding="utf-8")
    except OSError as error:
        raise UnreadableError(f"{error.filename}: {error.strerror}") from None
    return tuple(files)
