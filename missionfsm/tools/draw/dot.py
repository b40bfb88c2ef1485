"""A diagram in DOT, the language of Graphviz: the picture, and below it what does not leave its node."""

from __future__ import annotations

import html
import textwrap

import graphviz

from missionfsm.tools.draw.diagram import ENDS, Arrow, Diagram, Node, Side

INK, FADED, SHADE = "#1b2733", "#76838f", "#e7edf3"
COLOURS = {Side.FIRST: "#b3261e", Side.SECOND: "#1257a8"}
"""Two readings in one picture: what is so under one of them alone."""

_FONT = "Helvetica,Arial,sans-serif"
_WIDTH = 100
"""Characters of a line below the picture."""


def write(diagram: Diagram) -> str:
    """The diagram as DOT."""
    graph = graphviz.Digraph(
        diagram.title,
        graph_attr={
            "label": f"<{_below(diagram)}>",
            "labelloc": "b",
            "rankdir": diagram.directed,
            "nodesep": "0.45",
            "ranksep": "0.55",
            "fontname": _FONT,
            "fontsize": "11",
            "fontcolor": INK,
        },
        node_attr={
            "shape": "box",
            "style": "rounded,filled",
            "fillcolor": "white",
            "color": INK,
            "fontcolor": INK,
            "fontname": _FONT,
            "fontsize": "12",
            "margin": "0.18,0.1",
        },
        edge_attr={"color": INK, "fontcolor": INK, "fontname": _FONT, "fontsize": "10", "arrowsize": "0.8"},
    )
    for node in diagram.nodes:
        graph.node(node.id, graphviz.nohtml(r"\n".join(map(_plain, node.lines))), **_node(diagram, node))
        if node.start and diagram.machine:
            start = f"start_{node.id}"
            graph.node(start, "", shape="circle", style="filled", fillcolor=INK, width="0.14", margin="0")
            graph.edge(start, node.id)
    for arrow in diagram.arrows:
        graph.edge(arrow.source, arrow.target, _label(diagram, arrow), **_arrow(diagram, arrow))
    return str(graph.source)


def _plain(text: str) -> str:
    """Text of a label that means nothing: Graphviz takes backslashes and entities for more."""
    return str(graphviz.escape(text.replace("&", "&amp;")))


def _node(diagram: Diagram, node: Node) -> dict[str, str]:
    found = {"peripheries": "2", "fillcolor": SHADE} if node.end and diagram.machine else {}
    colour = COLOURS.get(node.side)
    return {**found, "color": colour, "fontcolor": colour} if colour else found


def _label(diagram: Diagram, arrow: Arrow) -> str | None:
    """A line for every way, a little off the arrow."""
    only = diagram.only(arrow.side)
    lines = (*((f"{only}:",) if only else ()), *arrow.lines)
    return "".join(rf"  {_plain(line)}\l" for line in lines) or None


def _arrow(diagram: Diagram, arrow: Arrow) -> dict[str, str]:
    colour = COLOURS.get(arrow.side)
    if colour:
        return {"color": colour, "fontcolor": colour, "penwidth": "1.6"}
    return {"color": FADED, "fontcolor": FADED} if diagram.versus else {}


def _below(diagram: Diagram) -> str:
    """The title, the remarks, and a table of what stays where it is."""
    rows = ['<TR><TD COLSPAN="2"></TD></TR>']
    rows.append(f'<TR><TD COLSPAN="2"><FONT POINT-SIZE="14"><B>{html.escape(diagram.title)}</B></FONT></TD></TR>')
    rows += (
        f'<TR><TD COLSPAN="2"><FONT COLOR="{_remark_colour(diagram, remark)}">{_wrapped(remark)}</FONT></TD></TR>'
        for remark in diagram.remarks
    )
    if diagram.stays:
        rows.append('<TR><TD COLSPAN="2"></TD></TR>')
        if diagram.ends:
            rows.append(_row(ENDS[0], f"<I>{ENDS[1]}</I>", INK))
        for stay in diagram.stays:
            where, does = diagram.in_words(stay)
            what = f"<I>{html.escape(does)}</I>: {_wrapped(', '.join(stay.lines), _WIDTH // 2)}"
            rows.append(_row(where, what, COLOURS.get(stay.side, INK)))
    return f'<TABLE BORDER="0" CELLBORDER="0" CELLSPACING="0" CELLPADDING="3">{"".join(rows)}</TABLE>'


def _remark_colour(diagram: Diagram, remark: str) -> str:
    sides = (Side.FIRST, Side.SECOND)
    return next((COLOURS[side] for side in sides if diagram.versus and remark.startswith(diagram.only(side))), INK)


def _row(where: str, what: str, ink: str) -> str:
    cell = f'ALIGN="LEFT" VALIGN="TOP" BORDER="1" SIDES="T" COLOR="{FADED}"'
    return f'<TR><TD {cell}>{_wrapped(where, _WIDTH // 2)}</TD><TD {cell}><FONT COLOR="{ink}">{what}</FONT></TD></TR>'


def _wrapped(text: str, width: int = _WIDTH) -> str:
    return "".join(f'{html.escape(line)}<BR ALIGN="LEFT"/>' for line in textwrap.wrap(text, width))
