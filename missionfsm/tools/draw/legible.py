"""What makes a drawn picture hard to read: a line through a label or through a node, a label on another.

Graphviz keeps labels off the lines of its own choice of layout, but not always off others. So an SVG is looked at once
it is drawn, and drawn in another layout where something is in the way.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator
from xml.etree import ElementTree as ET

from attrs import field, frozen

from missionfsm.tools.draw.parts import MAX_EDGES

_SVG = "{http://www.w3.org/2000/svg}"
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_SAMPLES = 24
"""Points of one curve: a step is shorter than a letter is wide."""
_ROOM = 1.0
"""How near a line may come to a label, in points."""

# Widths in Helvetica, in thousandths of the size, of what is not 556.
_WIDTHS = {
    **dict.fromkeys("ijl", 222),
    **dict.fromkeys(" .,:;/\\!It|\u00a0[]f", 278),
    **dict.fromkeys("r()-`\u00b9\u00b2\u00b3", 333),
    **dict.fromkeys("cksvxyz", 500),
    **dict.fromkeys("FTZ", 611),
    **dict.fromkeys("ABEKPSVXY&", 667),
    **dict.fromkeys("CDHNRUw", 722),
    **dict.fromkeys("GOQ", 778),
    **dict.fromkeys("mM", 833),
    "W": 944,
    "→": 1000,
}

Point = tuple[float, float]


@frozen
class _Box:
    """A rectangle, by its edges."""

    left: float
    top: float
    right: float
    bottom: float

    @classmethod
    def around(cls, points: Iterable[Point]) -> _Box:
        xs, ys = zip(*points, strict=True)
        return cls(min(xs), min(ys), max(xs), max(ys))

    def wider(self, by: float) -> _Box:
        return _Box(self.left - by, self.top - by, self.right + by, self.bottom + by)

    def holds(self, point: Point) -> bool:
        return self.left < point[0] < self.right and self.top < point[1] < self.bottom

    def meets(self, other: _Box) -> bool:
        across = self.left < other.right and other.left < self.right
        return across and self.top < other.bottom and other.top < self.bottom


@frozen
class _Edge:
    """An edge: the ends, the points of its line, and a box for each line of its label."""

    ends: tuple[str, ...]
    line: tuple[Point, ...] = field(repr=False)
    label: tuple[_Box, ...] = field(repr=False)

    def __str__(self) -> str:
        return " -> ".join(self.ends)


def faults(svg: str) -> tuple[str, ...]:
    """What is wrong with a picture as Graphviz drew it, each in a line; nothing if it is easy to read."""
    root = ET.fromstring(svg)  # noqa: S314 - it is our own
    groups = [(group.get("class"), group) for group in root.iter(f"{_SVG}g")]
    nodes = {_title(group): _outline(group) for kind, group in groups if kind == "node"}
    edges = [_edge(group) for kind, group in groups if kind == "edge"]
    found = [] if len(edges) <= MAX_EDGES else [f"{len(edges)} edges are more than {MAX_EDGES}"]
    return (*found, *_lines(edges, nodes), *_labels(edges, nodes))


def _lines(edges: list[_Edge], nodes: dict[str, _Box]) -> Iterator[str]:
    for edge in edges:
        for other in edges:
            if any(box.wider(_ROOM).holds(point) for box in other.label for point in edge.line):
                yield f"the line of {edge} touches the label of {other}"
        for name, box in nodes.items():
            if name not in edge.ends and any(map(box.holds, edge.line)):
                yield f"the line of {edge} crosses {name}"


def _labels(edges: list[_Edge], nodes: dict[str, _Box]) -> Iterator[str]:
    for edge in edges:
        yield from (
            f"the label of {edge} is on {name}"
            for name, box in nodes.items()
            if any(part.meets(box) for part in edge.label)
        )
    for one, other in itertools.combinations(edges, 2):
        if any(part.meets(that) for part in one.label for that in other.label):
            yield f"the labels of {one} and {other} are on each other"


def _title(group: ET.Element) -> str:
    return group.findtext(f"{_SVG}title", "")


def _outline(group: ET.Element) -> _Box:
    """All that is drawn of a node but for its text."""
    return _Box.around(point for part in group for point in _points(part))


def _points(part: ET.Element) -> Iterator[Point]:
    if part.tag == f"{_SVG}ellipse":
        x, y, wide, high = (float(part.get(name, "0")) for name in ("cx", "cy", "rx", "ry"))
        yield from ((x - wide, y - high), (x + wide, y + high))
    else:
        yield from _pairs(part.get("d") or part.get("points") or "")


def _pairs(text: str) -> list[Point]:
    numbers = [float(one) for one in _NUMBER.findall(text)]
    return list(zip(numbers[::2], numbers[1::2], strict=True))


def _edge(group: ET.Element) -> _Edge:
    curves = [point for path in group.findall(f"{_SVG}path") for point in _pairs(path.get("d", ""))]
    texts = (_text(one) for one in group.findall(f"{_SVG}text"))
    return _Edge(tuple(_title(group).split("->")), tuple(_along(curves)), tuple(texts))


def _along(curves: list[Point]) -> Iterator[Point]:
    """Points of a line of cubic Bezier curves, each of which begins where the one before ends."""
    for start in range(0, len(curves) - 3, 3):
        for step in range(_SAMPLES):
            there = step / _SAMPLES
            here = 1 - there
            shares = here**3, 3 * here**2 * there, 3 * here * there**2, there**3
            parts = tuple(zip(shares, curves[start : start + 4], strict=True))
            yield sum(share * x for share, (x, _) in parts), sum(share * y for share, (_, y) in parts)


def _text(text: ET.Element) -> _Box:
    """Where the letters of a text are, which is set from its start."""
    said = text.text or ""
    size, left, base = float(text.get("font-size", "0")), float(text.get("x", "0")), float(text.get("y", "0"))
    shown = said.strip(" \u00a0")
    # Spaces of a text are one where it begins with several, but for those that do not break.
    indent = said.partition(shown)[0] if shown else ""
    left += size * _width("\u00a0" * indent.count("\u00a0"))
    return _Box(left, base - 0.72 * size, left + size * _width(shown), base + 0.21 * size)


def _width(text: str) -> float:
    return sum(_WIDTHS.get(one, 556) for one in text) / 1000
