"""Every format is read by the program that it is meant for, which sees the arrows of the picture."""

from __future__ import annotations

import shutil
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from missionfsm.tools.draw.diagram import Arrow, Diagram
from missionfsm.tools.draw.gallery import FORMATS, Picture

SVG = "{http://www.w3.org/2000/svg}"
Readers = dict[str, dict[str, Any]]


def lines(diagram: Diagram, arrow: Arrow) -> list[str]:
    """What stands on an arrow, with the reading that it belongs to."""
    only = diagram.only(arrow.side)
    return [*([f"{only}:"] if only else []), *arrow.lines]


def arrows(diagram: Diagram) -> Counter[tuple[str, str, tuple[str, ...]]]:
    return Counter((arrow.source, arrow.target, tuple(lines(diagram, arrow))) for arrow in diagram.arrows)


def test_mermaid_reads_every_picture(readers: Readers, gallery: dict[str, Picture]) -> None:
    """Mermaid finds the nodes of every picture and its arrows with their labels; besides them starts and ends."""
    marks = ("root_start", "root_end")
    for name, one in gallery.items():
        found = readers["mermaid"][name]
        assert "error" not in found, (name, found)
        nodes = {node for node in found["nodes"] if node not in marks and not node.startswith("start_")}
        assert nodes == {node.id for node in one.diagram.nodes}, name
        between = (edge for edge in found["edges"] if edge[0] in nodes and edge[1] in nodes)
        texts = Counter(
            (source, target, tuple(label.replace("<br/>", "<br>").split("<br>"))) for source, target, label in between
        )
        assert texts == arrows(one.diagram), name
        expected = "stateDiagram" if one.diagram.machine and not one.diagram.versus else "flowchart-v2"
        assert found["type"] == expected, name


def test_a_parser_of_plantuml_reads_every_picture(readers: Readers, gallery: dict[str, Picture]) -> None:
    """It finds the arrows of every picture with their labels; besides them starts and ends."""
    for name, one in gallery.items():
        found = readers["plantuml"][name]
        assert "error" not in found, (name, found)
        nodes = {node.id for node in one.diagram.nodes}
        # It takes the hyphens of a legend for arrows, too.
        between = (edge for edge in found["edges"] if edge[0] in nodes and edge[1] in nodes)
        texts = Counter((source, target, tuple(label.split(r"\n"))) for source, target, label in between)
        assert texts == arrows(one.diagram), name


@pytest.mark.parametrize("form", ["mermaid", "plantuml"])
def test_names_mean_nothing(form: str, readers: Readers, odd: Picture) -> None:
    """Whatever robots are called, every mission is a node, and every arrow is where it should be."""
    found = readers[form][odd.id]
    assert "error" not in found, found
    assert Counter((edge[0], edge[1]) for edge in found["edges"]) == Counter(
        (arrow.source, arrow.target) for arrow in odd.diagram.arrows
    )


def test_graphviz_shows_names_as_they_are(odd: Picture) -> None:
    """Graphviz writes every name out as it is, but for line breaks."""
    if not shutil.which("dot"):
        pytest.skip("Graphviz is not installed, which reads DOT")
    dot = str(FORMATS["dot"].write(odd))
    drawn = subprocess.run(["dot", "-Tsvg"], input=dot, capture_output=True, text=True, check=True)
    assert drawn.stderr == ""
    root = ET.fromstring(drawn.stdout)  # noqa: S314 - it is our own
    groups = [one for one in root.iter(f"{SVG}g") if one.get("class") == "node"]
    shown = [tuple(text.text for text in one.iter(f"{SVG}text")) for one in groups]
    assert shown == [node.lines for node in odd.diagram.nodes]


@pytest.mark.slow
def test_plantuml_draws_every_picture(gallery: dict[str, Picture], odd: Picture, tmp_path: Path) -> None:
    """PlantUML itself has nothing to complain about."""
    if not shutil.which("plantuml"):
        pytest.skip("PlantUML is not installed")
    for number, one in enumerate((*gallery.values(), odd)):
        (tmp_path / f"{number}.puml").write_text(str(FORMATS["plantuml"].write(one)), encoding="utf-8")
    done = subprocess.run(
        ["plantuml", "-charset", "UTF-8", "-checkonly", *sorted(map(str, tmp_path.iterdir()))],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
