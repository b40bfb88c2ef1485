"""The layers of the house, as `docs/architecture.md` has them: who may import what, who may touch the world."""

from __future__ import annotations

import ast
import itertools
import re
import sys
import tomllib
from collections.abc import Collection, Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import missionfsm
from missionfsm.systems import names

ROOT = Path(missionfsm.__file__).parent
MODULES = {
    ".".join(path.relative_to(ROOT.parent).with_suffix("").parts): ast.parse(path.read_text())
    for path in sorted(ROOT.rglob("*.py"))
}

PAGE = ROOT.parent / "docs" / "architecture.md"


def rows(heading: str) -> list[list[str]]:
    """The cells of the table under a heading of the page, row by row, without its head."""
    _, _, section = PAGE.read_text(encoding="utf-8").partition(f"\n## {heading}\n")
    lines = [line for line in section.partition("\n## ")[0].splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def ticked(cell: str) -> set[str]:
    """What stands between backticks."""
    return set(re.findall(r"`([^`]+)`", cell))


LAYERS = {ticked(row[0]).pop(): row for row in rows("The layers")}
HOUSE = {name: {"missionfsm"} if row[2] == "everything" else ticked(row[2]) for name, row in LAYERS.items()}
"""For each layer, which others it may import; a layer may import itself."""

GUESTS = {name: ticked(row[3]) for name, row in LAYERS.items()}
"""The libraries that a layer may import."""

PURE = {name for name, row in LAYERS.items() if row[4] != "no"}
SEEDED = {name for name, row in LAYERS.items() if row[4] == "seeded"}
PARTICULAR = {"transitions": {"kernel.chart", "tools.draw.machines"}, "hypothesis": {"tools.conform.drawn"}}
"""Libraries that one module of a layer has to itself."""

SAME = {"attr": "attrs", "grpc": "grpcio", "grpc_reflection": "grpcio-reflection", "google": "protobuf"}
"""Libraries that are imported under another name than they are installed by."""

WORLD = {"time", "random", "socket", "os", "subprocess", "asyncio", "threading"}


def within(name: str, places: Collection[str]) -> str | None:
    """The longest of some places that a module is in."""
    parts = name.split(".")
    heads = (".".join(parts[:length]) for length in range(len(parts), 0, -1))
    return next((head for head in heads if head in places), None)


def imports(tree: ast.AST) -> Iterator[str]:
    """Every module that is imported, at the top or late."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            dotted = (node.module or "") if not node.level else "missionfsm.?"
            inner = (f"{dotted}.{alias.name}" for alias in node.names)
            yield from (name if name in MODULES or dotted == "missionfsm" else dotted for name in inner)


def _is(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name


def wrong(module: str, tree: ast.Module) -> Iterator[str]:
    """What a module imports or calls although its layer may not; its name is without that of the house."""
    layer = within(module, HOUSE)
    if layer is None:
        yield f"{module} is in no layer of {PAGE.name}"
        return
    for name in imports(tree):
        head, _, rest = name.partition(".")
        if layer in PURE and head in WORLD and not (layer in SEEDED and name == "random"):
            yield f"{module} imports {name}"
        if head == "missionfsm":
            if "missionfsm" not in HOUSE[layer] and within(rest, HOUSE[layer] | {layer}) is None:
                yield f"{module} imports {name}"
        elif head not in sys.stdlib_module_names:
            library = SAME.get(head, head)
            if library not in GUESTS[layer] or module not in PARTICULAR.get(library, {module}):
                yield f"{module} imports {name}"
    if layer in PURE:
        calls = (node.func for node in ast.walk(tree) if isinstance(node, ast.Call))
        drawn = (node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute) and _is(node.value, "random"))
        yield from (f"{module} uses random.{name}" for name in drawn if name != "Random")
        yield from (f"{module} calls open()" for func in calls if isinstance(func, ast.Name) and func.id == "open")


def test_every_import_follows_the_layers() -> None:
    """No module imports what its layer may not, and the pure ones touch neither clock, chance nor the world."""
    found = [
        line
        for name, tree in MODULES.items()
        if name not in {"missionfsm.__init__", "missionfsm.__main__"} and tree.body[1:]  # not a package's text alone
        for line in wrong(name.removeprefix("missionfsm.").removesuffix(".__init__"), tree)
    ]
    assert found == []


def test_the_page_speaks_of_what_is_there() -> None:
    """Every layer of the page is there, and every room and file that the page names."""
    names = {name.removeprefix("missionfsm.").removesuffix(".__init__") for name in MODULES}
    assert LAYERS.keys() <= names
    assert set().union(*HOUSE.values()) - {"missionfsm"} <= names
    named = {
        text for text in ticked(PAGE.read_text(encoding="utf-8")) if re.fullmatch(r"[a-z_]+/[a-z_/]*(\.py)?", text)
    }
    assert {text for text in named if not ((ROOT / text).exists() or (ROOT.parent / text).exists())} == set()


def test_every_room_is_on_the_page() -> None:
    """The tables of rooms name every file of the four systems, and no room that none of them has."""
    section = PAGE.read_text(encoding="utf-8").partition("## The same rooms")[2].partition("Files of more than")[0]
    systems = tuple(f"missionfsm.{one}." for one in names())
    there = {name.removeprefix(one).partition(".")[0] for name in MODULES for one in systems if name.startswith(one)}
    named = {text for text in ticked(section) if re.fullmatch("[a-z_]+", text)}
    assert (there - named - {"__init__"}, named - there - {"conform"}) == (set(), set())


def test_every_dependency_has_its_reason() -> None:
    """The page gives a reason for each library that the package or an extra of it depends on, and for no other."""
    project = tomllib.loads((ROOT.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [more for name, more in project["optional-dependencies"].items() if name != "test"]
    needed = {re.split(r"[^\w-]", one)[0] for one in itertools.chain(project["dependencies"], *extras)}
    assert {ticked(row[0]).pop() for row in rows("Dependencies")} == needed - {"missionfsm"}


def test_no_modules_import_each_other_in_a_circle() -> None:
    """The modules stand in an order in which each imports earlier ones only, what is loaded late included."""
    house = {name.removesuffix(".__init__") for name in MODULES}
    graph = {name.removesuffix(".__init__"): set(imports(tree)) & house for name, tree in MODULES.items()}
    try:
        assert len(list(TopologicalSorter(graph).static_order())) == len(house)
    except CycleError as error:
        pytest.fail(f"these import each other: {error.args[1]}")


def test_every_package_says_what_lives_in_it() -> None:
    """A newcomer who opens a package reads what lives there, what it may import and where to begin."""
    texts = {name: ast.get_docstring(tree) or "" for name, tree in MODULES.items()}
    silent = [name for name, text in texts.items() if name.endswith("__init__") and len(text) < 100]
    assert silent == []
