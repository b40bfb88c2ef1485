"""Diagrams as values, whatever format they are written in: nodes, arrows, and what is done without leaving a node."""

from __future__ import annotations

import enum
import re
from collections.abc import Collection, Iterable, Mapping

from attrs import evolve, frozen

from missionfsm.kernel.chart import Chart
from missionfsm.kernel.picture import Plan
from missionfsm.tools.draw.quotient import Move, Quotient


class Side(enum.Enum):
    """Where two readings are drawn in one picture: what is so under both, under the first alone, the second alone."""

    BOTH = enum.auto()
    FIRST = enum.auto()
    SECOND = enum.auto()


@frozen
class Node:
    """A node: its identifier, what stands in it, whether it is a start, and whether nothing leaves it."""

    id: str
    lines: tuple[str, ...]
    start: bool = False
    end: bool = False
    side: Side = Side.BOTH


@frozen
class Arrow:
    """An arrow between two nodes; every line of its label is a way from one to the other."""

    source: str
    target: str
    lines: tuple[str, ...]
    side: Side = Side.BOTH


@frozen
class Stay:
    """What can be done in some nodes without leaving them.

    `nodes` are identifiers; without any it can be done in every node that has an arrow to another. Nodes without such
    an arrow are not mentioned, since everything stays there; refusals are. `code` is the code of a refusal.
    """

    nodes: tuple[str, ...]
    lines: tuple[str, ...]
    code: str = ""
    side: Side = Side.BOTH


ENDS = "in a node with a double border", "everything stays there"


@frozen
class Diagram:
    """What is drawn.

    Attributes:
        directed: the way in which it is best read: down (``TB``) or to the right (``LR``).
        stays: what is told beside it.
        remarks: what is said below it.
        versus: the two readings that are told apart, if it shows two.
        machine: whether the nodes are states; if not, they are things that wait for one another.
        sure: whether a node shows everything that can happen there; a node that stands for many states may do more.
    """

    title: str
    nodes: tuple[Node, ...]
    arrows: tuple[Arrow, ...]
    directed: str = "TB"
    stays: tuple[Stay, ...] = ()
    remarks: tuple[str, ...] = ()
    versus: tuple[str, str] | None = None
    machine: bool = True
    sure: bool = True

    def node(self, identifier: str) -> Node:
        """The node with an identifier."""
        return next(node for node in self.nodes if node.id == identifier)

    def in_words(self, stay: Stay) -> tuple[str, str]:
        """Where something stays, and how."""
        where = "; ".join(", ".join(self.node(node).lines) for node in stay.nodes)
        only = self.only(stay.side)
        stays = "stays there" if self.sure else "may stay there"
        does = f"may be refused ({stay.code})" if stay.code else stays
        everywhere = "in every other node" if self.ends else "in every node"
        return where or everywhere, f"{only}: {does}" if only else does

    @property
    def ends(self) -> bool:
        """Whether there are nodes of which has to be said that everything stays there."""
        return bool(self.stays) and any(node.end for node in self.nodes)

    def only(self, side: Side) -> str:
        """Under which reading alone something is so; empty where it always is."""
        if self.versus is None or side is Side.BOTH:
            return ""
        return self.versus[0] if side is Side.FIRST else self.versus[1]


def identifier(words: str) -> str:
    """Words as a name that every format takes."""
    return re.sub(r"\W+", "_", words).strip("_")


def state_name(state: object) -> str:
    """What a chart's state is called: the name of an enum member, or the text itself."""
    return str(getattr(state, "name", state))


MARKS = "¹²³⁴⁵⁶⁷⁸⁹"
"""What stands at an arrow and at the remark that is about it."""


def of_chart(system: str, chart: Chart[object]) -> Diagram:
    """A lifecycle. What is noted of a trigger is marked on its arrows and said below."""
    names = tuple(identifier(state_name(state)) for state in chart.states)
    marks = dict(zip((note for note in chart.notes if note in chart.triggers), MARKS, strict=False))
    moves: dict[tuple[str, str], list[str]] = {}
    for trigger, source, target in chart.table:
        label = f"{trigger} {marks[trigger]}" if trigger in marks else trigger
        moves.setdefault((identifier(state_name(source)), identifier(state_name(target))), []).append(label)
    return Diagram(
        f"{system}: {chart.name}",
        tuple(
            Node(name, (state_name(state),), start=state == chart.initial, end=state in chart.final)
            for name, state in zip(names, chart.states, strict=True)
        ),
        tuple(Arrow(source, target, tuple(lines)) for (source, target), lines in moves.items() if source != target),
        stays=tuple(Stay((node,), tuple(moves[node, node])) for node in names if (node, node) in moves),
        remarks=tuple(f"{marks.get(about, '')} {about}: {note}".strip() for about, note in chart.notes.items()),
    )


def of_quotient(title: str, shown: Quotient, *, refusals: bool = False) -> Diagram:
    """A quotient under one choice of readings."""
    return _drawn(title, {Side.BOTH: shown}, refusals=refusals)


def of_contrast(
    title: str,
    first: Quotient,
    second: Quotient,
    versus: tuple[str, str],
    *,
    refusals: bool = False,
    remarks: tuple[str, ...] = (),
) -> Diagram:
    """A quotient under two choices of readings at once."""
    common = frozenset(first.moves) & frozenset(second.moves)
    nodes = frozenset(first.nodes) & frozenset(second.nodes)
    sides = {
        Side.BOTH: Quotient(
            tuple(one for one in first.nodes if one in nodes),
            first.starts,
            tuple(one for one in first.moves if one in common),
            first.labels,
        ),
        Side.FIRST: _without(first, nodes, common),
        Side.SECOND: _without(second, nodes, common),
    }
    return evolve(_drawn(title, sides, refusals=refusals), versus=versus, remarks=remarks)


def _without(shown: Quotient, nodes: frozenset[str], moves: frozenset[Move]) -> Quotient:
    return Quotient(
        tuple(one for one in shown.nodes if one not in nodes),
        shown.starts,
        tuple(one for one in shown.moves if one not in moves),
        shown.labels,
    )


def _drawn(title: str, sides: Mapping[Side, Quotient], *, refusals: bool) -> Diagram:
    moves = [(side, move) for side, shown in sides.items() for move in shown.moves]
    left = {move.source for _, move in moves if move.source != move.target}
    nodes = tuple(
        Node(identifier(name), tuple(name.split(", ")), start=name in shown.starts, end=name not in left, side=side)
        for side, shown in sides.items()
        for name in shown.nodes
    )
    labels = tuple(dict.fromkeys(label for shown in sides.values() for label in shown.labels))
    rank = {str(move): (labels.index(move.label), str(move)) for _, move in moves}
    arrows: dict[tuple[Side, str, str], set[str]] = {}
    for side, move in moves:
        source, target = identifier(move.source), identifier(move.target)
        if source != target:
            arrows.setdefault((side, source, target), set()).add(str(move))
    stays = _staying(sides, left, refusals=refusals)
    return Diagram(
        title,
        nodes,
        tuple(
            Arrow(source, target, tuple(sorted(lines, key=rank.__getitem__)), side)
            for (side, source, target), lines in arrows.items()
        ),
        stays=tuple(_stays(stays, nodes)),
        sure=False,
    )


def _staying(
    sides: Mapping[Side, Quotient], left: Collection[str], *, refusals: bool
) -> Mapping[tuple[Side, str, str], set[str]]:
    """What leaves the robot where it is and is worth telling: by side, code and label, the nodes in which it does."""
    # Where two readings differ in what is refused, that is what there is to tell.
    common = sides[Side.BOTH].nodes
    apart = {(side, node) for side in sides if side is not Side.BOTH for node in common}
    stays: dict[tuple[Side, str, str], set[str]] = {}
    for side, move in ((side, move) for side, shown in sides.items() for move in shown.moves):
        worth_saying = (refusals or (side, move.source) in apart) if move.refused else move.source in left
        if worth_saying and identifier(move.source) == identifier(move.target):
            code = move.code if move.refused else ""
            stays.setdefault((side, code, move.label if code else str(move)), set()).add(identifier(move.source))
    return stays


def _stays(stays: Mapping[tuple[Side, str, str], set[str]], nodes: tuple[Node, ...]) -> Iterable[Stay]:
    """What stays where it is, with the nodes in which the same does together."""
    order = [node.id for node in nodes]
    left = {node.id for node in nodes if not node.end}
    grouped: dict[tuple[Side, str, tuple[str, ...]], list[str]] = {}
    for (side, code, label), where in stays.items():
        nodes_of_some = () if where == left else tuple(sorted(where, key=order.index))
        grouped.setdefault((side, code, nodes_of_some), []).append(label)
    found = [Stay(nodes_of_some, tuple(lines), code, side) for (side, code, nodes_of_some), lines in grouped.items()]
    return sorted(found, key=lambda one: (one.side.value, one.code, len(order) - (len(one.nodes) or len(order))))


def _printable(text: str) -> str:
    """A name on one line, without control characters."""
    return "".join(one if one.isprintable() else " " for one in text)


def of_plan(system: str, plan: Plan) -> Diagram:
    """Missions that wait for one another: an arrow goes from each to those that wait for it."""
    waited = {one for those in plan.upstream for one in those}
    return Diagram(
        f"{system}: {_printable(plan.title)}",
        tuple(
            Node(f"mission_{index}", tuple(map(_printable, lines)), not plan.upstream[index], index not in waited)
            for index, lines in enumerate(plan.missions)
        ),
        tuple(
            Arrow(f"mission_{other}", f"mission_{index}", ("succeeds",))
            for index, those in enumerate(plan.upstream)
            for other in those
        ),
        directed="LR",
        machine=False,
    )
