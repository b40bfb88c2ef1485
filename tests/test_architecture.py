"""The layers of the house (see the table in the design): who may import what, and who may touch the world."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

import missionfsm

ROOT = Path(missionfsm.__file__).parent
KERNEL, VENDORS = {"missionfsm.kernel"}, {"missionfsm.bear", "missionfsm.isaac"}
HOUSE = {
    "kernel": KERNEL,
    "bear": KERNEL | {"missionfsm.bear"},
    "isaac": KERNEL | {"missionfsm.isaac"},
    "tools": KERNEL | {"missionfsm.tools", "missionfsm.systems"},
    "systems": KERNEL | VENDORS,
    "pages": KERNEL | {"missionfsm.tools", "missionfsm.pages"},
    "embedding": KERNEL | VENDORS | {"missionfsm.tools", "missionfsm.embedding"},
    "adapters": KERNEL | VENDORS | {"missionfsm.adapters", "missionfsm.systems"},
}
GUESTS = {
    "kernel": {"attrs"},
    "bear": {"attr", "attrs", "cattrs"},
    "isaac": {"attr", "attrs", "cattrs"},
    "tools": {"attrs", "graphviz", "transitions"},
    "systems": {"attrs"},
    "pages": {"attrs", "jinja2", "markupsafe"},
    "embedding": {"attrs"},
    "adapters": {"attrs", "orjson"},
}
PARTICULAR = {"kernel/chart.py": {"transitions"}, "tools/conform.py": {"hypothesis"}}
LAZY = {"adapters": {"grpc"}}
WORLD = {"time", "random", "socket", "os", "subprocess", "asyncio", "threading"}
SEEDED = {"tools"}  # may hold a random.Random that somebody seeded, and nothing else of chance
PURE = {"kernel", "bear", "isaac", "tools", "systems", "pages", "embedding"}


def imports(tree: ast.AST) -> Iterator[tuple[str, bool]]:
    """Every module that is imported, with whether that happens at the top."""
    top = set(ast.iter_child_nodes(tree))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node in top) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            dotted = (node.module or "") if not node.level else "missionfsm.?"
            inner = [f"{dotted}.{alias.name}" for alias in node.names] if dotted == "missionfsm" else [dotted]
            yield from ((name, node in top) for name in inner)


def _is(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name


def wrong(path: Path) -> Iterator[str]:
    """What a file imports or calls although its layer may not."""
    place = path.relative_to(ROOT)
    layer = place.parts[0].removesuffix(".py")
    tree = ast.parse(path.read_text())
    for name, at_top in imports(tree):
        package, head = ".".join(name.split(".")[:2]), name.partition(".")[0]
        if layer in PURE and head in WORLD and not (layer in SEEDED and name == "random"):
            yield f"{place} imports {name}"
        if layer not in HOUSE or head in sys.stdlib_module_names:
            continue
        guests = GUESTS[layer] | PARTICULAR.get(place.as_posix(), set()) | (set() if at_top else LAZY.get(layer, set()))
        if package not in HOUSE[layer] if head == "missionfsm" else head not in guests:
            yield f"{place} imports {name}"
    if layer in PURE:
        calls = (node.func for node in ast.walk(tree) if isinstance(node, ast.Call))
        drawn = (node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute) and _is(node.value, "random"))
        yield from (f"{place} uses random.{name}" for name in drawn if name != "Random")
        yield from (f"{place} calls open()" for func in calls if isinstance(func, ast.Name) and func.id == "open")


def test_every_import_follows_the_layers() -> None:
    """No module imports what its layer may not, and the pure ones touch neither clock, chance nor the world."""
    assert [line for path in sorted(ROOT.rglob("*.py")) for line in wrong(path)] == []
