"""How much of a system says nothing about it: ``python docs/glue.py`` counts the lines of `isaac.robot`.

``python docs/glue.py PATH…`` counts other files, ``--at COMMIT`` those of a commit, and ``--before`` the robot before
its rooms, with what was common to both of Isaac's systems. Lines are those of ``wc -l``: blank lines, docstrings and
comments among them. Glue are

- imports;
- what is put together: of a statement that makes one of the values in `ASSEMBLED`, the lines that only hand on what has
  a name already, with those of its brackets;
- listings: statements of a module that give a name to nothing but other names;
- forwarding: functions and methods that return or raise what another function makes of their own parameters.
"""

from __future__ import annotations

import argparse
import ast
import subprocess
from pathlib import Path

ROOT = Path(__file__).parent.parent
ROOMS = ("missionfsm/isaac/robot",)
BEFORE = "57a042b"
OLD_ROOMS = tuple(
    f"missionfsm/isaac/robot_{one}.py" for one in ("breaks", "json", "readings", "rules", "sketches", "spec", "system")
)
ASSEMBLED = {"Spec", "Codec", "System", "Alphabet", "Shapes", "Abstraction", "Naming", "Matrix", "Sketch", "declared"}


def lines_of(node: ast.AST) -> set[int]:
    """The numbers of the lines on which something stands."""
    return set(range(node.lineno, node.end_lineno + 1))  # type: ignore[attr-defined]


def called(node: ast.AST | None) -> str:
    """The name of what a call calls; empty for what is no such call."""
    return node.func.id if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else ""


def hands_on(node: ast.AST) -> bool:
    """Whether an expression holds nothing but names, and what only puts them into another form."""
    if isinstance(node, ast.Name | ast.Attribute):
        return True
    if isinstance(node, ast.Constant):
        return node.value in ((), "", None, 0)
    if isinstance(node, ast.Starred):
        return hands_on(node.value)
    if isinstance(node, ast.Tuple | ast.List | ast.Set):
        return all(map(hands_on, node.elts))
    if isinstance(node, ast.Dict):
        return all(hands_on(one) for one in (*node.keys, *node.values) if one is not None)
    if isinstance(node, ast.Call):
        return called(node) in ("", "tuple", "frozenset", "map") and all(map(hands_on, arguments(node)))
    return isinstance(node, ast.Lambda) and (hands_on(node.body) or passes_on(node.body, node.args))


def arguments(call: ast.Call) -> tuple[ast.expr, ...]:
    """What a call is given."""
    return (*call.args, *(one.value for one in call.keywords))


def assembly(call: ast.Call) -> set[int]:
    """The lines of a value that is put together, but for those of arguments that say something."""
    says: set[int] = set()
    for one in arguments(call):
        if not hands_on(one) and called(one) not in ASSEMBLED:
            says |= lines_of(one)
    return lines_of(call) - says


def passes_on(node: ast.AST | None, parameters: ast.arguments) -> bool:
    """Whether a call is given parameters only."""
    own = {one.arg for one in (*parameters.posonlyargs, *parameters.args, *parameters.kwonlyargs)}
    own |= {one.arg for one in (parameters.vararg, parameters.kwarg) if one is not None}
    given = arguments(node) if isinstance(node, ast.Call) else ()
    plain = [one.value if isinstance(one, ast.Starred) else one for one in given]
    return bool(plain) and all(isinstance(one, ast.Name) and one.id in own for one in plain)


def forwards(function: ast.FunctionDef) -> bool:
    """Whether a function does no more than to hand its parameters on."""
    body = function.body[1:] if ast.get_docstring(function) is not None else function.body
    last = body[-1] if len(body) == 1 else None
    value = last.value if isinstance(last, ast.Return) else last.exc if isinstance(last, ast.Raise) else None
    return passes_on(value, function.args)


def glue(text: str) -> set[int]:
    """The numbers of the lines of a file that say nothing about its system."""
    tree = ast.parse(text)
    found: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom) or (isinstance(node, ast.FunctionDef) and forwards(node)):
            found |= lines_of(node)
        elif isinstance(node, ast.Assign | ast.AnnAssign | ast.Return) and isinstance(node.value, ast.Call):
            found |= assembly(node.value) if called(node.value) in ASSEMBLED else set()
    for node in tree.body:
        listed = isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(
            node.value, ast.Tuple | ast.List | ast.Dict
        )
        if listed and hands_on(node.value):
            found |= lines_of(node)
    return found


def texts(paths: list[str], commit: str | None) -> dict[str, str]:
    """The Python files there by name, as they are or as they were."""
    if commit is None:
        files = [one for path in paths for one in (sorted((ROOT / path).rglob("*.py")) or [ROOT / path])]
        return {str(one): one.read_text() for one in files}

    def git(*command: str) -> str:
        return subprocess.run(["git", *command], cwd=ROOT, capture_output=True, text=True, check=True).stdout

    names = git("ls-tree", "-r", "--name-only", commit, *paths).split()
    return {name: git("show", f"{commit}:{name}") for name in names if name.endswith(".py")}


def rows(files: dict[str, str]) -> list[str]:
    """The table of some files, the sums last."""
    found = ["| file | lines | of these glue |", "| --- | --- | --- |"]
    lines, idle = 0, 0
    for name, text in files.items():
        own = len(text.splitlines()), len(glue(text))
        lines, idle = lines + own[0], idle + own[1]
        found.append(f"| {Path(name).name} | {own[0]} | {own[1]} |")
    return [*found, f"| all | {lines} | {idle} ({idle / lines:.1%}) |"]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("paths", nargs="*", default=[*ROOMS], metavar="PATH")
    parser.add_argument("--at", metavar="COMMIT", help="as they were")
    parser.add_argument("--before", action="store_true", help="the robot before its rooms")
    given = parser.parse_args()
    paths = [*OLD_ROOMS, "missionfsm/isaac/line_breaks.py"] if given.before else given.paths
    print("\n".join(rows(texts(paths, BEFORE if given.before else given.at))))


if __name__ == "__main__":
    main()
