"""A diagram in Mermaid, which code hosts draw by themselves.

A state diagram, but where colours tell two readings apart or where nothing is a state: only flowcharts have those.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator

from missionfsm.tools.draw.diagram import Diagram, Side
from missionfsm.tools.draw.dot import COLOURS, FADED


def write(diagram: Diagram) -> str:
    """The diagram as Mermaid."""
    body = _states(diagram) if diagram.machine and not diagram.versus else _flowchart(diagram)
    title = json.dumps(diagram.title, ensure_ascii=False)  # a quoted text of YAML is one of JSON
    remarks = (f"%% {remark}" for remark in diagram.remarks)
    return "\n".join(("---", f"title: {title}", "---", *body, *remarks, ""))


_ENTITIES = {
    ord(one): f"#{name};"
    for one, name in (("#", "35"), ('"', "quot"), ("<", "lt"), (">", "gt"), ("`", "96"), ("&", "amp"))
}


def _lines(lines: Iterable[str]) -> str:
    return "<br/>".join(line.translate(_ENTITIES) for line in lines)


def _states(diagram: Diagram) -> Iterator[str]:
    yield "stateDiagram-v2"
    yield f"    direction {diagram.directed}"
    for node in diagram.nodes:
        yield f'    state "{_lines(node.lines)}" as {node.id}'
    for node in diagram.nodes:
        if node.start:
            yield f"    [*] --> {node.id}"
    for arrow in diagram.arrows:
        yield f"    {arrow.source} --> {arrow.target} : {_lines(arrow.lines)}"
    for node in diagram.nodes:
        if node.end:
            yield f"    {node.id} --> [*]"
    if diagram.sure:  # else it is too much for notes, and stands in the table
        for stay in diagram.stays:
            yield from (f"    note right of {node} : stays there<br/>{_lines(stay.lines)}" for node in stay.nodes)


def _flowchart(diagram: Diagram) -> Iterator[str]:
    yield f"flowchart {diagram.directed}"
    for node in diagram.nodes:
        left, right = ("([", "])") if node.end and diagram.machine else ("(", ")")
        yield f'    {node.id}{left}"{_lines(node.lines)}"{right}'
    links = 0
    coloured: dict[str, list[int]] = {}
    for node in diagram.nodes:
        if node.start and diagram.machine:
            yield f"    start_{node.id}(( )) --> {node.id}"
            links += 1
    for arrow in diagram.arrows:
        only = diagram.only(arrow.side)
        lines = (f"{only}:", *arrow.lines) if only else arrow.lines
        label = f'|"{_lines(lines)}"|' if lines else ""
        yield f"    {arrow.source} -->{label} {arrow.target}"
        if diagram.versus:
            coloured.setdefault(COLOURS.get(arrow.side, FADED), []).append(links)
        links += 1
    for colour, those in coloured.items():
        yield f"    linkStyle {','.join(map(str, those))} stroke:{colour},color:{colour}"
    for node in diagram.nodes:
        if node.side is not Side.BOTH:
            yield f"    style {node.id} stroke:{COLOURS[node.side]},color:{COLOURS[node.side]}"
