"""A diagram in PlantUML; what does not leave its node stands in the legend."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from missionfsm.tools.draw.diagram import ENDS, Diagram, Side
from missionfsm.tools.draw.dot import COLOURS, FADED


def write(diagram: Diagram) -> str:
    """The diagram as PlantUML."""
    return "\n".join(("@startuml", *_body(diagram), "@enduml", ""))


_CODES = {ord(one): f"<U+{ord(one):04X}>" for one in '"\\<>~&'}


def _lines(lines: Iterable[str]) -> str:
    return r"\n".join(line.translate(_CODES) for line in lines)


def _body(diagram: Diagram) -> Iterator[str]:
    yield f"title {diagram.title}"
    yield "hide empty description" if diagram.machine else "skinparam shadowing false"
    if diagram.directed == "LR":
        yield "left to right direction"
    for node in diagram.nodes:
        colour = f" #line:{COLOURS[node.side].removeprefix('#')}" if node.side is not Side.BOTH else ""
        yield f'{"state" if diagram.machine else "rectangle"} "{_lines(node.lines)}" as {node.id}{colour}'
    if diagram.machine:
        yield from (f"[*] --> {node.id}" for node in diagram.nodes if node.start)
    yield from _arrows(diagram)
    if diagram.machine:
        yield from (f"{node.id} --> [*]" for node in diagram.nodes if node.end)
    yield from _legend(diagram)


def _arrows(diagram: Diagram) -> Iterator[str]:
    for arrow in diagram.arrows:
        only = diagram.only(arrow.side)
        lines = (f"{only}:", *arrow.lines) if only else arrow.lines
        shaft = f"-[{COLOURS.get(arrow.side, FADED)}]->" if diagram.versus else "-->"
        label = f" : {_lines(lines)}" if lines else ""
        yield f"{arrow.source} {shaft} {arrow.target}{label}"


def _legend(diagram: Diagram) -> Iterator[str]:
    legend = [*diagram.remarks]
    legend += [": ".join(ENDS)] if diagram.ends else []
    legend += (": ".join((*diagram.in_words(stay), ", ".join(stay.lines))) for stay in diagram.stays)
    if legend:
        yield from ("legend bottom", *legend, "endlegend")
