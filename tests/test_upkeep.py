"""The house is kept: no function grows beyond what one reads at once, and nothing lies about that nobody uses."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
import radon.complexity
import vulture

import missionfsm

ROOT = Path(missionfsm.__file__).parent

MOST = 15
"""Ways through a function, as radon counts them."""

CALLED_BY_OTHERS = {
    # a protocol of functions
    "__call__",
    # Python and its standard library
    "__dir__",
    "__getattr__",
    "connection_lost",
    "data_received",
    "do_GET",
    "eof_received",
    "handle_error",
    "log_message",
    "pause_writing",
    "readinto",
    "resume_writing",
    # pytest, Hypothesis, Typer, grpcio
    "Suite",
    "_describe",
    "format_epilog",
    "intercept_service",
    "pytest_addoption",
    "pytest_collect_file",
    "pytest_generate_tests",
    "reportinfo",
    "runtest",
    "teardown",
    "walk_what_was_walked_least",
    # the templates of pages
    "sentences",
    "slug",
    "worst",
    # a call of the Robot Status page, made by its name
    "navigation_status",
}
"""What nobody calls by its name in this project."""


def of(path: Path) -> str:
    """The module in a file, without the name of the whole."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def fields_left_out(path: Path) -> list[str]:
    """The fields of a module's classes that their list of attributes does not describe."""
    left = []
    for found in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        says = ast.get_docstring(found) or "" if isinstance(found, ast.ClassDef) else ""
        if isinstance(found, ast.ClassDef) and "Attributes:" in says:
            described = re.findall(r"^ {4}([a-z_, ]+):", says.partition("Attributes:")[2], re.MULTILINE)
            names = {name.strip() for line in described for name in line.split(",")}
            targets = (one.target for one in found.body if isinstance(one, ast.AnnAssign))
            fields = (one.id.removeprefix("_") for one in targets if isinstance(one, ast.Name))  # as they are given
            left += [f"{found.name}.{one}" for one in fields if one not in names]
    return left


def test_the_kernel_describes_every_field() -> None:
    """Where a class of the kernel lists its attributes, it lists all of them."""
    assert [left for path in sorted((ROOT / "kernel").glob("*.py")) for left in fields_left_out(path)] == []


@pytest.mark.long
def test_no_function_is_too_complex() -> None:
    """No function has more than 15 ways through it."""
    found = [
        f"{of(path)}.{block.fullname}"
        for path in sorted(ROOT.rglob("*.py"))
        for block in radon.complexity.cc_visit(path.read_text(encoding="utf-8"))
        if hasattr(block, "is_method") and block.complexity > MOST
    ]
    assert found == []


@pytest.mark.long
def test_everything_is_used() -> None:
    """Every function, method, property and class is used by the project, its tests and examples, or by a framework.

    Fields of values are left out: they are read by cattrs, attrs and templates.
    """
    looked = vulture.Vulture()
    looked.scavenge([str(ROOT), str(ROOT.parent / "tests"), str(ROOT.parent / "examples")], exclude=["*/strangers/*"])
    found = {
        f"{of(item.filename)}: {item.name}"
        for item in looked.get_unused_code(min_confidence=60)
        if item.typ not in ("attribute", "variable")
        and item.filename.is_relative_to(ROOT)
        and item.name not in CALLED_BY_OTHERS
    }
    assert sorted(found) == []


@pytest.mark.long
def test_every_test_states_its_claim() -> None:
    """Every test has a docstring: the claim that it makes."""
    found = [
        f"{path.name}: {node.name}"
        for path in sorted((ROOT.parent / "tests").rglob("*.py"))
        if "strangers" not in path.parts
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_") and ast.get_docstring(node) is None
    ]
    assert found == []


def _documented(node: ast.ClassDef) -> set[str]:
    """The fields that a class says something of: in its docstring, or in a text right behind the field."""
    said = set(re.findall(r"\w+", ast.get_docstring(node) or ""))
    pairs = zip(node.body, node.body[1:], strict=False)
    behind = {
        one.target.id
        for one, text in pairs
        if isinstance(one, ast.AnnAssign)
        and isinstance(one.target, ast.Name)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
    }
    return said | behind


def test_every_field_of_the_language_and_of_the_engine_is_documented() -> None:
    """A class of the kernel, the oracle or the verdicts that lists attributes leaves none of its fields out."""
    found = [
        f"{of(path)}.{node.name}.{one.target.id}"
        for folder in ("kernel", "oracle", "tools/check")
        for path in sorted((ROOT / folder).rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef) and "Attributes:\n" in (ast.get_docstring(node) or "")
        for one in node.body
        if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name) and not one.target.id.startswith("_")
        if one.target.id not in _documented(node)
    ]
    assert found == []
