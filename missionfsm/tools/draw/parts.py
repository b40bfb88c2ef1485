"""What is too much for one picture: a diagram in parts, two readings with nothing but what tells them apart."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from attrs import evolve

from missionfsm.kernel.picture import Part
from missionfsm.tools.draw.diagram import MARKS, Arrow, Diagram, Node, Side, Stay

MAX_EDGES = 10
"""The most arrows of one picture, including those that point to a start: more are hard to follow."""

_WAY, _ENDS = Part("way", "on the way", ()), Part("ends", "how it ends", ())
_SHARED = "What both share is not drawn."


def edges(diagram: Diagram) -> int:
    """How many arrows are drawn."""
    return len(diagram.arrows) + (sum(node.start for node in diagram.nodes) if diagram.machine else 0)


def apart(diagram: Diagram) -> Diagram:
    """Two readings in one picture, without what they share if that is too much to be drawn."""
    if edges(diagram) <= MAX_EDGES:
        return diagram
    different = evolve(diagram, remarks=(*diagram.remarks, _SHARED))
    return _only(
        different,
        (arrow for arrow in diagram.arrows if arrow.side is not Side.BOTH),
        (stay for stay in diagram.stays if stay.side is not Side.BOTH),
    )


def parts(diagram: Diagram, wanted: tuple[Part, ...] = ()) -> Iterator[tuple[Part, Diagram]]:
    """A diagram in parts, each small enough for a picture; nothing where the whole is small enough.

    Where no parts are wanted in particular, what ends everything is drawn apart from what comes before it. What
    belongs to none of them is in the first one, and so are the starts.
    """
    if edges(diagram) <= MAX_EDGES or not diagram.machine:
        return
    ends = {node.id for node in diagram.nodes if node.end}
    if not wanted and not ends:
        return
    for number, part in enumerate(wanted or (_WAY, _ENDS)):
        if wanted:
            others = {label for one in wanted if one is not part for label in one.labels}
            drawn = _of_labels(diagram, part, others, first=number == 0)
        else:
            drawn = _of_ends(diagram, ends, first=number == 0)
        yield part, evolve(drawn, title=f"{diagram.title}, {part.title}")


def _of_labels(diagram: Diagram, part: Part, others: Iterable[str], *, first: bool) -> Diagram:
    """What is labelled as a part says; in the first one also what no part says anything of."""

    def belongs(line: str) -> bool:
        return line in part.labels or (first and line not in others)

    return _part(diagram, lambda arrow: tuple(filter(belongs, arrow.lines)), belongs, first=first)


def _of_ends(diagram: Diagram, ends: set[str], *, first: bool) -> Diagram:
    """The way, with what stays where it is; or what leads to an end."""
    drawn = _part(
        diagram, lambda arrow: arrow.lines if (arrow.target in ends) != first else (), lambda _: first, first=first
    )
    return drawn if first else _together(drawn)


def _together(diagram: Diagram) -> Diagram:
    """What leads to one node from several is one arrow, from a node that stands for them all."""
    sources: dict[tuple[str, str, Side], list[str]] = {}
    for arrow in diagram.arrows:
        for line in arrow.lines:
            sources.setdefault((line, arrow.target, arrow.side), []).append(arrow.source)
    lines: dict[tuple[tuple[str, ...], str, Side], list[str]] = {}
    for (line, target, side), those in sources.items():
        lines.setdefault((tuple(those), target, side), []).append(line)
    groups = {those: _either([diagram.node(one) for one in those]) for those, _, _ in lines}
    return evolve(
        diagram,
        nodes=(*groups.values(), *(node for node in diagram.nodes if node.end)),
        arrows=tuple(
            Arrow(groups[those].id, target, tuple(some), side) for (those, target, side), some in lines.items()
        ),
    )


def _either(nodes: list[Node]) -> Node:
    """One node for several."""
    first, *others = (", ".join(node.lines) for node in nodes)
    lines = nodes[0].lines if not others else (first, *(f"or {one}" for one in others))
    return evolve(nodes[0], id="_or_".join(node.id for node in nodes), lines=lines)


def _part(
    diagram: Diagram, lines: Callable[[Arrow], tuple[str, ...]], stays: Callable[[str], bool], *, first: bool
) -> Diagram:
    """The lines of each arrow that are drawn, and what of the rest is told; the starts are in the first part alone."""
    drawn = _only(
        diagram,
        (evolve(arrow, lines=some) for arrow in diagram.arrows if (some := lines(arrow))),
        (evolve(stay, lines=some) for stay in diagram.stays if (some := tuple(filter(stays, stay.lines)))),
    )
    return drawn if first else evolve(drawn, nodes=tuple(evolve(node, start=False) for node in drawn.nodes))


def _only(diagram: Diagram, arrows: Iterable[Arrow], stays: Iterable[Stay]) -> Diagram:
    """Some of a diagram, with the nodes that it needs and the remarks that speak of it."""
    arrows, stays = tuple(arrows), tuple(stays)
    needed = {end for arrow in arrows for end in (arrow.source, arrow.target)}
    needed |= {node for stay in stays for node in stay.nodes}
    shown = "".join(line for arrow in arrows for line in arrow.lines)
    return evolve(
        diagram,
        nodes=tuple(node for node in diagram.nodes if node.id in needed),
        arrows=arrows,
        stays=stays,
        # A remark that begins with a mark is about the arrows that have it.
        remarks=tuple(one for one in diagram.remarks if one[0] not in MARKS or one[0] in shown),
    )
