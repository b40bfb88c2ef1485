"""The layers of the house: who may import what, and who may touch the world."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import missionfsm

ROOT = Path(missionfsm.__file__).parent
MODULES = {
    ".".join(path.relative_to(ROOT.parent).with_suffix("").parts): ast.parse(path.read_text())
    for path in sorted(ROOT.rglob("*.py"))
}

BEAR, ISAAC = {"kernel", "bear.wire"}, {"kernel", "isaac.wire", "isaac.shared"}
SYSTEMS = {"bear.mission", "bear.status", "isaac.server", "isaac.robot"}
JUDGING = {"kernel", "oracle", "systems", "tools.placeholders"}
TOOLS = {
    "tools.check": JUDGING | {"tools.reference"},
    "tools.reference": JUDGING,
    "tools.explore": JUDGING | {"tools.check", "tools.reference"},
    "tools.conform": JUDGING | {"tools.check", "tools.reference", "tools.explore"},
    "tools.mutate": JUDGING | {"tools.check", "tools.reference", "tools.explore", "tools.conform"},
    "tools.draw": JUDGING | {"tools.check", "tools.reference", "tools.explore"},
    "tools.specpages": JUDGING | {"tools.explore", "tools.conform", "tools.draw", "tools.mutate"},
}
EDGES = {"isaac.wire", "isaac.runtime", "bear.wire"}
HOUSE = {
    "kernel": set[str](),
    "oracle": {"kernel"},
    "bear.wire": {"kernel.codec", "kernel.rules", "kernel.text"},
    "bear.mission": BEAR,
    "bear.status": BEAR,
    "isaac.wire": {"kernel.codec", "kernel.rules", "kernel.text"},
    "isaac.shared": {"kernel", "isaac.wire"},
    "isaac.server": ISAAC,
    "isaac.robot": ISAAC,
    "isaac.runtime": {"isaac.wire"},
    "isaac.realtime": {"kernel", "isaac.wire", "isaac.runtime", "isaac.server"},
    "systems": {"kernel"},
    "tools.placeholders": {"kernel"},
    **TOOLS,
    "pages": {"kernel", "oracle", *TOOLS, "tools.placeholders"},
    "fakes": {"kernel", "tools.reference", "bear"},
    "adapters": {"kernel", *EDGES},
    "adapters.isaac": {"kernel", "adapters", *EDGES},
    "app": {"kernel", "oracle", "systems", "tools", "pages", "fakes", "adapters", "bear", "isaac"},
    "cli": {"missionfsm"},
    "testing": {"kernel", "oracle", "systems", "tools", "adapters", "app"},
    "pytest_plugin": {"kernel", "oracle", "systems", "tools", "adapters", "app"},
}
"""For each layer, which others it may import; a layer may import itself."""

EXCEPTIONS = {
    "isaac.server.plans": {"isaac.runtime.missionfile", "isaac.runtime.missions"},
}
"""What does not follow the layers yet. No line is added; `isaac.server.plans` is meant (a mission file is a plan)."""

GUESTS = {
    "kernel": {"attrs"},
    "oracle": {"attrs"},
    "bear": {"attr", "attrs", "cattrs"},
    "isaac": {"attr", "attrs", "cattrs"},
    "systems": {"attrs"},
    "tools": {"attrs", "graphviz", "transitions"},
    "pages": {"attrs", "jinja2", "markupsafe"},
    "fakes": {"attrs"},
    "adapters": {"attrs", "orjson", "zstandard"},
    "kernel.chart": {"transitions"},
    "tools.conform.conform": {"hypothesis"},
}
"""The libraries that a layer, or a single module, may import."""

ANYBODY = {"app", "cli", "testing", "pytest_plugin"}
LAZY = {"adapters": {"grpc"}}
WORLD = {"time", "random", "socket", "os", "subprocess", "asyncio", "threading"}
SEEDED = {"tools"}  # may hold a random.Random that somebody seeded, and nothing else of chance
PURE = {"kernel", "oracle", "bear", "isaac", "tools", "systems", "pages", "fakes"}


def within(name: str, places: set[str] | dict[str, set[str]]) -> str | None:
    """The longest of some places that a module is in."""
    parts = name.split(".")
    heads = (".".join(parts[:length]) for length in range(len(parts), 0, -1))
    return next((head for head in heads if head in places), None)


def imports(tree: ast.AST) -> Iterator[tuple[str, bool]]:
    """Every module that is imported, with whether that happens at the top."""
    top = set(ast.iter_child_nodes(tree))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node in top) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            dotted = (node.module or "") if not node.level else "missionfsm.?"
            inner = (f"{dotted}.{alias.name}" for alias in node.names)
            yield from ((name if name in MODULES or dotted == "missionfsm" else dotted, node in top) for name in inner)


def _is(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.Name) and node.id == name


def climbs(module: str, imported: str) -> bool:
    """Whether a module imports one that its layer may not; both without the name of the house."""
    layer = within(module, HOUSE)
    if layer is None or "missionfsm" in HOUSE[layer]:
        return layer is None
    return within(imported, HOUSE[layer] | {layer} | EXCEPTIONS.get(module, set())) is None


def wrong(dotted: str, tree: ast.Module) -> Iterator[str]:
    """What a file imports or calls although its layer may not."""
    module = dotted.removeprefix("missionfsm.").removesuffix(".__init__")
    layer = module.partition(".")[0]
    for name, at_top in imports(tree):
        head, _, rest = name.partition(".")
        if layer in PURE and head in WORLD and not (layer in SEEDED and name == "random"):
            yield f"{module} imports {name}"
        if head == "missionfsm":
            if climbs(module, rest):
                yield f"{module} imports {name}"
        elif head not in sys.stdlib_module_names and layer not in ANYBODY:
            lazy = set[str]() if at_top else LAZY.get(layer, set())
            if head not in GUESTS.get(layer, set()) | GUESTS.get(module, set()) | lazy:
                yield f"{module} imports {name}"
    if layer in PURE:
        calls = (node.func for node in ast.walk(tree) if isinstance(node, ast.Call))
        drawn = (node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute) and _is(node.value, "random"))
        yield from (f"{module} uses random.{name}" for name in drawn if name != "Random")
        yield from (f"{module} calls open()" for func in calls if isinstance(func, ast.Name) and func.id == "open")


def test_every_import_follows_the_layers() -> None:
    """No module imports what its layer may not, and the pure ones touch neither clock, chance nor the world."""
    house = {name: tree for name, tree in MODULES.items() if name not in {"missionfsm.__init__", "missionfsm.__main__"}}
    assert [line for name, tree in house.items() for line in wrong(name, tree)] == []


def test_no_modules_import_each_other_in_a_circle() -> None:
    """The modules stand in an order in which each imports earlier ones only, what is loaded late included."""
    house = {name.removesuffix(".__init__") for name in MODULES}
    graph = {
        name.removesuffix(".__init__"): {imported for imported, _ in imports(tree)} & house
        for name, tree in MODULES.items()
    }
    try:
        assert len(list(TopologicalSorter(graph).static_order())) == len(house)
    except CycleError as error:
        pytest.fail(f"these import each other: {error.args[1]}")


def test_no_exception_outlives_its_reason() -> None:
    """Every exception is an import that is really there; what is mended leaves the list."""
    there = {
        (module.removeprefix("missionfsm."), name.removeprefix("missionfsm."))
        for module, tree in MODULES.items()
        for name, _ in imports(tree)
    }
    listed = {(module, name) for module, names in EXCEPTIONS.items() for name in names}
    assert listed <= there


def test_every_package_says_what_lives_in_it() -> None:
    """A newcomer who opens a package reads what lives there, what it may import and where to begin."""
    texts = {name: ast.get_docstring(tree) or "" for name, tree in MODULES.items()}
    silent = [name for name, text in texts.items() if name.endswith("__init__") and len(text) < 100]
    assert silent == []
