"""The files in ``diagrams/`` are what the model draws now."""

from __future__ import annotations

import collections
import itertools
import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from missionfsm.tools.draw.diagram import Diagram
from missionfsm.tools.draw.gallery import FORMATS, SVG, Picture
from missionfsm.tools.draw.index import index, path
from missionfsm.tools.draw.legible import faults
from missionfsm.tools.draw.svg import DARK, light_and_dark

FOLDER = Path(__file__).parents[2] / "diagrams"
REDRAW = "run: missionfsm diagram -o diagrams"
NAMESPACE = {"svg": "http://www.w3.org/2000/svg"}


def nodes_and_edges(diagram: Diagram) -> tuple[set[str], collections.Counter[tuple[str, str]]]:
    """What DOT has to show: nodes and arrows, and of machines the starts."""
    starts = [node.id for node in diagram.nodes if node.start and diagram.machine]
    edges = collections.Counter((arrow.source, arrow.target) for arrow in diagram.arrows)
    edges.update((f"start_{one}", one) for one in starts)
    return {node.id for node in diagram.nodes} | {f"start_{one}" for one in starts}, edges


def test_files_are_those_of_the_pictures(gallery: dict[str, Picture]) -> None:
    """The folder has every picture in every format that it can be had in, the index, and nothing else."""
    expected = {path(one, form) for one in gallery.values() for form, made in FORMATS.items() if made.write(one)}
    found = {one.relative_to(FOLDER).as_posix() for one in FOLDER.rglob("*") if one.is_file()}
    assert found == expected | {"README.md"}, REDRAW


@pytest.mark.parametrize("form", sorted(set(FORMATS) - {SVG}))
def test_files_are_drawn_anew(form: str, gallery: dict[str, Picture]) -> None:
    """Every file says what the model says now."""
    texts = {path(one, form): text for one in gallery.values() if (text := FORMATS[form].write(one)) is not None}
    assert {name: (FOLDER / name).read_text(encoding="utf-8") for name in texts} == texts, REDRAW


def test_index_is_drawn_anew(gallery: dict[str, Picture]) -> None:
    """So does the page that shows them all."""
    assert (FOLDER / "README.md").read_text(encoding="utf-8") == index(gallery.values()), REDRAW


def test_svgs_have_the_nodes_and_arrows_of_the_pictures(gallery: dict[str, Picture]) -> None:
    """Every SVG has exactly the nodes and the arrows of its picture; where they stand is up to Graphviz."""
    for one in gallery.values():
        if one.divided:
            continue
        root = ET.parse(FOLDER / path(one, SVG))  # noqa: S314 - it is our own
        groups = root.iterfind(".//svg:g", NAMESPACE)
        titles: dict[str | None, list[str]] = {"node": [], "edge": []}
        for group in groups:
            titles.setdefault(group.get("class"), []).append(group.findtext("svg:title", "", NAMESPACE))
        edges = collections.Counter(tuple(title.split("->")) for title in titles["edge"])
        assert (set(titles["node"]), edges) == nodes_and_edges(one.diagram), one.id


def test_dot_loads_in_graphviz(gallery: dict[str, Picture]) -> None:
    """Graphviz lays every picture out, with its nodes and its arrows, and has nothing to complain about."""
    if not shutil.which("dot"):
        pytest.skip("Graphviz is not installed, which reads DOT")
    files = [str(FOLDER / path(one, "dot")) for one in gallery.values()]
    canonical = subprocess.run(["dot", "-Tcanon", *files], capture_output=True, text=True, check=False)
    assert (canonical.returncode, canonical.stderr) == (0, "")
    plain = subprocess.run(["dot", "-Tplain", *files], capture_output=True, text=True, check=True).stdout
    lines = (line.split(" ") for line in plain.splitlines())
    for one in gallery.values():
        drawn = list(itertools.takewhile(lambda line: line != ["stop"], lines))
        edges = collections.Counter((line[1], line[2]) for line in drawn if line[0] == "edge")
        assert ({line[1] for line in drawn if line[0] == "node"}, edges) == nodes_and_edges(one.diagram), one.id


def test_every_svg_turns_dark() -> None:
    """Every colour of every picture has one for dark pages, and the pictures say so themselves."""
    for drawn in sorted(FOLDER.glob("*/*.svg")):
        text = drawn.read_text()
        head, _, body = text.partition("</style>\n")
        used = set(re.findall(r'(?:fill|stroke)="([^"]+)"', body)) - {"none", "transparent"}
        assert used <= set(DARK), drawn
        assert light_and_dark(f"{head.partition('<style>')[0].rstrip()}\n{body}") == text, drawn


def test_every_svg_is_easy_to_read() -> None:
    """A picture has at most ten edges; no line crosses a node or touches a label, and no label is on anything."""
    drawn = sorted(FOLDER.glob("*/*.svg"))
    assert {one.stem: faults(one.read_text()) for one in drawn} == {one.stem: () for one in drawn}
