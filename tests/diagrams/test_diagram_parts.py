"""What is too much for one picture is drawn in parts, and no picture is hard to read."""

from __future__ import annotations

import itertools

import pytest

from missionfsm.tools.draw.diagram import Arrow, Diagram, Node, Side
from missionfsm.tools.draw.gallery import Picture
from missionfsm.tools.draw.legible import faults
from missionfsm.tools.draw.parts import MAX_EDGES, apart, edges
from missionfsm.tools.draw.svg import drawn

Line = tuple[str, str, str, Side]


def lines(diagram: Diagram) -> list[Line]:
    """Every line of every arrow; an arrow from a node that stands for several is one from each of them."""
    return [
        (source, arrow.target, line, arrow.side)
        for arrow in diagram.arrows
        for source in arrow.source.split("_or_")
        for line in arrow.lines
    ]


def test_parts_are_the_whole(gallery: dict[str, Picture]) -> None:
    """Every line of a divided picture is in exactly one of its parts, and so is whatever is told below it."""
    divided = [one for one in gallery.values() if one.divided]
    assert [one.name for one in divided] == ["mission", "queue", "mission-at-the-server", "dispatch", "dependency"]
    for whole in divided:
        parts = [one.diagram for one in gallery.values() if (one.system, one.whole) == (whole.system, whole.name)]
        assert sorted(map(str, lines(whole.diagram))) == sorted(str(line) for one in parts for line in lines(one))
        told = [(stay.nodes, line) for one in parts for stay in one.stays for line in stay.lines]
        assert sorted(told) == sorted((stay.nodes, line) for stay in whole.diagram.stays for line in stay.lines)
        assert {one for part in parts for one in part.remarks} == set(whole.diagram.remarks)
        assert [any(node.start for node in part.nodes) for part in parts] == [True] + [False] * (len(parts) - 1)


def test_no_picture_has_too_many_arrows(gallery: dict[str, Picture]) -> None:
    """What is drawn has at most ten arrows, or is divided."""
    assert {one.id for one in gallery.values() if edges(one.diagram) > MAX_EDGES} == {
        one.id for one in gallery.values() if one.divided
    }


def test_two_readings_with_much_in_common_show_what_differs() -> None:
    """Where two readings share too much for one picture, that is not drawn, and the picture says so."""
    nodes = tuple(Node(f"n{number}", (f"n{number}",), start=number == 0) for number in range(MAX_EDGES + 1))
    shared = tuple(Arrow(one.id, other.id, ("on",)) for one, other in itertools.pairwise(nodes))
    only = Arrow("n3", "n0", ("back",), Side.FIRST)
    both = Diagram("two", nodes, (*shared, only), versus=("A=a", "A=b"))
    assert apart(both) == Diagram(
        "two", (nodes[0], nodes[3]), (only,), remarks=("What both share is not drawn.",), versus=("A=a", "A=b")
    )
    small = Diagram("two", nodes[:4], (*shared[:3], only), versus=("A=a", "A=b"))
    assert apart(small) == small


# A picture as Graphviz writes it: two nodes, an arrow from one to the other, and what else is said.

_NODE = '<g class="node"><title>{0}</title><polygon points="{1},0 {2},0 {2},20 {1},20"/></g>'
_EDGE = '<g class="edge"><title>{0}</title><path d="M{1}"/>{2}</g>'
_TEXT = '<text text-anchor="start" x="{0}" y="{1}" font-size="10.00"> \u00a0to</text>'


def svg(*parts: str) -> str:
    """An SVG of these parts."""
    nodes = _NODE.format("a", 0, 40), _NODE.format("b", 200, 240)
    return f'<svg xmlns="http://www.w3.org/2000/svg">{"".join((*nodes, *parts))}</svg>'


STRAIGHT = "40,10C90,10 150,10 200,10"


@pytest.mark.parametrize(
    ("parts", "found"),
    [
        ((_EDGE.format("a-&gt;b", STRAIGHT, _TEXT.format(100, 30)),), ()),
        (
            (_EDGE.format("a-&gt;b", STRAIGHT, _TEXT.format(100, 14)),),
            ("the line of a -> b touches the label of a -> b",),
        ),
        (
            (_EDGE.format("a-&gt;c", "40,10C150,10 250,10 300,10", ""), _NODE.format("c", 300, 340)),
            ("the line of a -> c crosses b",),
        ),
        ((_EDGE.format("a-&gt;b", STRAIGHT, _TEXT.format(205, 15)),), ("the label of a -> b is on b",)),
        (
            (
                _EDGE.format("a-&gt;b", STRAIGHT, _TEXT.format(100, 40)),
                _EDGE.format("b-&gt;a", STRAIGHT, _TEXT.format(103, 42)),
            ),
            ("the labels of a -> b and b -> a are on each other",),
        ),
        ((_EDGE.format("a-&gt;b", STRAIGHT, ""),) * 11, ("11 edges are more than 10",)),
    ],
    ids=["nothing", "own line", "a node between", "label on a node", "two labels", "too many"],
)
def test_what_is_in_the_way_is_found(parts: tuple[str, ...], found: tuple[str, ...]) -> None:
    """Each kind of fault is told of a picture that has it, and none of one that has none."""
    assert faults(svg(*parts)) == found


def test_the_first_layout_without_fault_is_taken() -> None:
    """A picture is drawn in other layouts until nothing is in the way; without such a one the best is taken."""
    bad, good = (svg(_EDGE.format("a-&gt;b", STRAIGHT, _TEXT.format(100, base))) for base in (14, 30))
    asked: list[str] = []

    def draw(dot: str) -> str:
        asked.append(dot)
        return good if "nodesep=1.2" in dot else bad

    shown = drawn("digraph { a -> b }", draw)
    assert shown.endswith(good.partition(">")[2])
    assert asked == [
        "digraph { a -> b }",
        "digraph { a -> b graph [nodesep=0.8 ranksep=0.8]\n}",
        "digraph { a -> b graph [nodesep=1.2 ranksep=0.8]\n}",
    ]
    assert drawn("digraph { a -> b }", lambda _: bad).endswith(bad.partition(">")[2])


def test_a_part_of_a_lifecycle_keeps_its_ends(gallery: dict[str, Picture]) -> None:
    """Where everything stays is told of the whole: a node that another part leaves has no double border in this one."""
    come = gallery["bear.mission/queue-come"].diagram
    assert [node.id for node in come.nodes if node.end] == []
    ends = gallery["bear.mission/mission-ends"].diagram
    assert [node.id for node in ends.nodes if node.end] == ["STATE_CANCELED", "STATE_SUCCEEDED", "STATE_FAILED"]
