"""State against event as a Markdown table: everything that can be done, refusals included."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping

from missionfsm.kernel.chart import Chart
from missionfsm.kernel.picture import Plan
from missionfsm.kernel.rules import OK
from missionfsm.tools.draw.diagram import state_name
from missionfsm.tools.draw.quotient import Move, Quotient

NOTHING = "·"
"""In a cell: that cannot happen there."""

Cells = Mapping[tuple[str, str], list[str]]


def of_chart(chart: Chart[object]) -> str:
    """Where every trigger leads from every state."""
    cells = {(state_name(source), trigger): [state_name(target)] for trigger, source, target in chart.table}
    return _table(tuple(map(state_name, chart.states)), chart.triggers, cells)


def of_quotient(shown: Quotient) -> str:
    """Where everything may lead from every node, and what it may be refused with there."""
    return _table(shown.nodes, shown.labels, _cells(shown))


def of_contrast(first: Quotient, second: Quotient, versus: tuple[str, str]) -> str:
    """The same under two choices of readings; a cell says both where they differ."""
    one, other = _cells(first), _cells(second)
    cells: dict[tuple[str, str], list[str]] = {}
    for key in {**one, **other}:
        if one.get(key) == other.get(key) or not (key[0] in first.nodes and key[0] in second.nodes):
            cells[key] = one.get(key) or other[key]
        else:
            both = ((versus[0], one.get(key)), (versus[1], other.get(key)))
            cells[key] = [f"**{name}**: {'; '.join(found)}" for name, found in both if found]
    only = {node: versus[0] for node in first.nodes if node not in second.nodes}
    only |= {node: versus[1] for node in second.nodes if node not in first.nodes}
    nodes = tuple(dict.fromkeys((*first.nodes, *second.nodes)))
    heads = {node: f"{node} (**{only[node]}**)" for node in only}
    return _table(nodes, tuple(dict.fromkeys((*first.labels, *second.labels))), cells, heads)


def of_plan(plan: Plan) -> str:
    """Every mission with those that it waits for."""
    rows = (
        (str(index), html.escape(", ".join(lines[1:])), ", ".join(map(str, plan.upstream[index])) or NOTHING)
        for index, lines in enumerate(plan.missions)
    )
    return markdown(("mission", "what", "waits for"), rows)


def _cells(shown: Quotient) -> Cells:
    cells: dict[tuple[str, str], dict[str, None]] = {}
    for move in shown.moves:
        cells.setdefault((move.source, move.label), {}).setdefault(_said(move))
    return {key: sorted(found, key=lambda said: (said.startswith("_"), said)) for key, found in cells.items()}


def _said(move: Move) -> str:
    if move.refused:
        return f"_{move.code}_"
    target = "stays" if move.source == move.target else move.target
    details = [move.code] if move.code not in ("", OK) else []
    return f"{target} ({', '.join((*details, *move.shows))})" if details or move.shows else target


def _table(
    states: tuple[str, ...], events: tuple[str, ...], cells: Cells, heads: Mapping[str, str] | None = None
) -> str:
    """The longer of the two goes down."""
    titles = tuple((heads or {}).get(state, state) for state in states)
    filled = [["<br>".join(cells.get((state, event), [NOTHING])) for event in events] for state in states]
    if len(states) >= len(events):
        return markdown(("state", *events), ((title, *row) for title, row in zip(titles, filled, strict=True)))
    columns = zip(*filled, strict=True)
    return markdown(("event", *titles), ((event, *row) for event, row in zip(events, columns, strict=True)))


def markdown(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table in Markdown."""
    head = tuple(head)
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    lines += ("| " + " | ".join(" ".join(cell.replace("|", "\\|").split()) for cell in row) + " |" for row in rows)
    return "\n".join(lines) + "\n"
