"""What Graphviz draws, made fit to be looked at in light and in dark."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from missionfsm.tools.draw.diagram import Side
from missionfsm.tools.draw.dot import COLOURS, FADED, INK, SHADE
from missionfsm.tools.draw.legible import faults

DARK: Mapping[str, str] = {
    "white": "#1c2024",
    INK: "#e6e8ea",
    FADED: "#a0a8b1",
    SHADE: "#32383f",
    COLOURS[Side.FIRST]: "#ff9a91",
    COLOURS[Side.SECOND]: "#8ab4f8",
}
"""Every colour of a picture to what it is where people look at dark pages."""
_OPENING = re.compile(r"<svg\b[^>]*>")
_STYLE = "\n".join(
    (
        "<style>",
        # A label that a line touches stays readable.
        ".edge text { paint-order: stroke; stroke: white; stroke-width: 4px; stroke-linejoin: round }",
        "@media (prefers-color-scheme: dark) {",
        *(f'[{kind}="{light}"] {{ {kind}: {dark} }}' for light, dark in DARK.items() for kind in ("fill", "stroke")),
        f".edge text {{ stroke: {DARK['white']} }}",
        "}</style>",
    )
)


_LAYOUTS = (
    "",
    "nodesep=0.8 ranksep=0.8",
    "nodesep=1.2 ranksep=0.8",
    "rankdir=BT",
    "rankdir=LR nodesep=0.5 ranksep=0.8",
    "rankdir=LR nodesep=0.8 ranksep=1.2",
    "nodesep=1.6 ranksep=1.2",
)
"""Attributes of Graphviz, from the closest layout to the loosest."""


def drawn(dot: str, draw: Callable[[str], str]) -> str:
    """A picture in the first layout in which nothing is in the way of anything; else in the one with the least faults.

    Args:
        dot: the picture in DOT.
        draw: DOT to the SVG that Graphviz makes of it.
    """
    best, fewest = "", None
    for layout in _LAYOUTS:
        svg = draw(_laid_out(dot, layout))
        wrong = len(faults(svg))
        if fewest is None or wrong < fewest:
            best, fewest = svg, wrong
        if not wrong:
            break
    return light_and_dark(best)


def _laid_out(dot: str, layout: str) -> str:
    """What is said last of a graph is what holds."""
    body, end, rest = dot.rpartition("}")
    return f"{body}graph [{layout}]\n{end}{rest}" if layout else dot


def light_and_dark(svg: str) -> str:
    """A picture of Graphviz with a style that turns dark with the page that shows it."""
    return _OPENING.sub(lambda opening: f"{opening[0]}\n{_STYLE}", svg, count=1)
