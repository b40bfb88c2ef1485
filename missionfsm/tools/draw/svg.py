"""What Graphviz draws, made fit to be looked at in light and in dark."""

from __future__ import annotations

import re
from collections.abc import Mapping

from missionfsm.tools.draw.diagram import Side
from missionfsm.tools.draw.dot import COLOURS, FADED, INK, SHADE

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


def light_and_dark(svg: str) -> str:
    """A picture as Graphviz draws it, that turns dark with the page on which it stands."""
    return _OPENING.sub(lambda opening: f"{opening[0]}\n{_STYLE}", svg, count=1)
