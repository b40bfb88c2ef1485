"""The belief automaton: nodes are sets of explanations, edges are events; it is built lazily, as it is walked."""

from __future__ import annotations

import functools
from collections import defaultdict
from collections.abc import Iterable, Mapping

from attrs import define, evolve, field

from missionfsm.kernel.readings import UNCONSTRAINED, meet
from missionfsm.kernel.shelving import Shelving
from missionfsm.kernel.spec import Spec
from missionfsm.oracle.calls import FEW, is_of_calls_alone
from missionfsm.oracle.explanation import GONE, Explanation, rename
from missionfsm.oracle.memory import ENTRY, MEMORY, NODES, explanation_bytes
from missionfsm.oracle.shelf import Plan, plan
from missionfsm.oracle.subsumption import surviving_names
from missionfsm.oracle.successors import EVENT_BUDGET, Successor, Successors
from missionfsm.oracle.symbols import Part, Symbol
from missionfsm.oracle.transition import TransitionFunction

Tally = defaultdict[int, int]
"""How often which set of rules, by its number, was exercised."""


@define(eq=False, slots=True)
class Node:
    """All explanations of what was observed, and the edges that were walked from here.

    Attributes:
        width: how many names have numbers here.
        next: the edges, by symbol.
        away: how things are put away here (see `missionfsm.oracle.shelf`), or None.
        knows_away: from how many things on they are put away, as far as `away` says; 0 before somebody has asked.
        bytes: what the node takes, without its edges (see `missionfsm.oracle.memory`).
    """

    explanations: tuple[Explanation, ...]
    width: int
    next: dict[Symbol, Edge] = field(factory=dict, repr=False)
    away: tuple[Plan, Edge] | None = field(default=None, repr=False)
    knows_away: int = field(default=0, repr=False)
    bytes: int = field(init=False, repr=False)

    def __attrs_post_init__(self) -> None:
        self.bytes = ENTRY + sum(map(explanation_bytes, self.explanations))


def _retired(explanations: tuple[Explanation, ...], kept: Mapping[int, int]) -> tuple[int, ...]:
    """The numbers of the names that are gone in an explanation and left in none."""
    return tuple(dict.fromkeys(number for one in explanations for number in one.gone if number not in kept))


def _forgetting(explanation: Explanation, kept: Mapping[int, int]) -> Explanation:
    """The explanation without the names that are gone in all of them: nobody has to know any more that they were."""
    return explanation.replace(gone=tuple(number for number in explanation.gone if number in kept))


@define(eq=False, slots=True)
class Edge:
    """Where an event leads: the next node and what becomes of the names.

    Attributes:
        keep: for every name of the next node its number before (new names count on from the width); None: unchanged.
        retired: numbers of names that are gone for good.
        exercises: which rules it exercises, as the automaton numbers such sets.
        touched: the bits of the ambiguities of which other readings are possible after the event than before it.
        appends: whether nothing becomes of the names before but that others follow them.
        cuts: whether nothing becomes of the names but that the last ones are left out.
        presumes: whether nothing but a restart that nobody has seen yet explains the event.
        beyond_system: whether the system itself does not explain the event.
    """

    node: Node
    keep: tuple[int, ...] | None
    retired: tuple[int, ...]
    exercises: int
    touched: int
    appends: bool = False
    cuts: bool = False
    presumes: bool = False
    beyond_system: bool = False


class Automaton:
    """The belief automaton of a spec, as far as it has been walked.

    Args:
        spec: the system.
        driven: names of the drives that a tester commands.
        assumed: readings that are decided from the start (see `missionfsm.kernel.readings.constrain`).
        budget: how many explanations a single event may cost.
        eager: see `missionfsm.oracle.transition.TransitionFunction`.
        memory: how many bytes it may take, by estimate, together with what walks it.

    Attributes:
        tally: how often each set of rules was exercised by all beliefs that walked here and count nowhere else.
    """

    def __init__(
        self,
        spec: Spec,
        driven: Iterable[str] = (),
        assumed: int = UNCONSTRAINED,
        budget: int = EVENT_BUDGET,
        *,
        eager: bool = False,
        memory: int = MEMORY,
    ) -> None:
        self.spec = spec
        self.assumed = assumed
        self.memory = memory
        self.successors = Successors(spec, driven, assumed, budget, memory=memory)
        self.transitions = TransitionFunction(self.successors, eager=eager)
        self._unwatched = tuple(
            drive.unwatched
            for drive in spec.drives.values()
            if spec.transport and drive.unwatched and drive.name not in self.successors.driven
        )
        self._undriven = tuple(
            drive.undriven
            for drive in spec.drives.values()
            if drive.undriven and drive.name not in self.successors.driven
        )
        self._watched: TransitionFunction | None = None
        watched = meet(assumed, (one.reading["a"] for one in self._unwatched))
        if self._unwatched and watched and not eager:
            self._watched = TransitionFunction(Successors(spec, driven, watched, budget, memory=memory))
        self._nodes: dict[tuple[Explanation, ...], Node] = {}
        self._edges = 0
        self._has_calls_alone = not spec.drives and not any(one.streaming for one in spec.operations.values())
        self.bytes = 0
        self._rules: dict[tuple[str, ...], int] = {}
        self.tally: Tally = defaultdict(int)

    def start(self, world: object, *, used: bool = False) -> Node:
        """The node in which an instance in this world is that is fresh, or that was used and then cleared."""
        spec = self.successors.spec
        for unwatched in self._unwatched:
            world = unwatched.world(world)
        for undriven in self._undriven:
            world = undriven(world)
        state = (spec.used if used and spec.used else spec.initial)(world)
        unseen = tuple(GONE - 1 - number for number in range(self.spec.names(state)))
        return self._intern((Explanation(state, unseen, self.assumed),), 0)

    @functools.cached_property
    def without_restarts(self) -> Automaton:
        """The belief automaton of the same system where no robot restarts by itself."""
        spec, known = evolve(self.spec, restarted=None, decided=None), self.successors
        other = Automaton(spec, known.driven, self.assumed, known.budget, memory=self.memory)
        other._rules = self._rules  # what is told of both is counted alike
        return other

    def adopt(self, node: Node) -> Node:
        """The node of this automaton that stands for the same as one of another automaton."""
        return self._intern(node.explanations, node.width)

    def all_known(self, node: Node) -> Node:
        """The node in which nothing from before the log is on its way any more."""
        known = dict.fromkeys(evolve(one, all_known=True) for one in node.explanations)
        return self._intern(tuple(known), node.width)

    def _intern(self, explanations: tuple[Explanation, ...], width: int) -> Node:
        node = self._nodes.get(explanations)
        if node is None:
            node = Node(explanations, width)
            if self._nodes and self.bytes + node.bytes > self.memory // NODES:
                self._forget_nodes()
            self._nodes[explanations] = node
            self.bytes += node.bytes
        return node

    def _forget_nodes(self) -> None:
        """Forget everything but what the rules are that were exercised."""
        for node in self._nodes.values():
            node.next.clear()
            node.away, node.knows_away = None, 0
        self._nodes.clear()
        self._edges = self.bytes = 0
        self.successors.forget()
        if self._watched is not None:
            self._watched.successors.forget()

    def edge(self, node: Node, symbol: Symbol) -> Edge:
        """Compute where a symbol leads from a node and remember it. An empty node means: no explanation is left."""
        kind, *what = symbol
        successors = self.successors
        if self._has_calls_alone and not successors.live and all(map(is_of_calls_alone, node.explanations)):
            successors.limit = min(successors.budget, FEW)  # a search through calls is quicker than many explanations
        try:
            found, used = self._step(node.explanations, kind, *what)
            edge = self.arrive(node, found)
        finally:
            successors.limit = successors.budget
        edge.presumes, edge.beyond_system = used.presumes, used.beyond_system
        node.next[symbol] = edge
        self._edges += 1
        self.bytes += ENTRY
        return edge

    def _step(
        self, explanations: tuple[Explanation, ...], kind: type, *what: Part
    ) -> tuple[tuple[Successor, ...], TransitionFunction]:
        """What explains an event, and the transition function that says so.

        Live, what may happen unwatched is thought of only where nothing else is left.
        """
        if self._watched is not None and self.successors.live:
            found = self._watched.step(explanations, kind, *what)
            if found:
                return found, self._watched
        return self.transitions.step(explanations, kind, *what), self.transitions

    @property
    def shelving(self) -> Shelving | None:
        """How things are put away; None where they are not: the system has none, or anything may happen unseen."""
        spec = self.spec
        kept = self.successors.live or self.transitions.eager or spec.anywhere or spec.others
        return None if kept else spec.shelving

    def away(self, node: Node, shelving: Shelving, least: int) -> tuple[Plan, Edge] | None:
        """How things are put away at a node where so many are there at least, and where that leads; None: none are."""
        if node.knows_away != least:
            found = plan(shelving, node.explanations, least=least)
            arrived = found and self.arrive(node, tuple(map(Successor, found.explanations)))
            node.away, node.knows_away = (found, arrived) if found and arrived else None, least
        return node.away

    def arrive(self, node: Node, found: tuple[Successor, ...]) -> Edge:
        """Where explanations that were found lead from a node. An empty node means: no explanation is left."""
        explanations = tuple(successor.explanation for successor in found)
        new = surviving_names(explanations)
        retired = _retired(explanations, new)
        if retired:
            explanations = tuple(_forgetting(one, new) for one in explanations)
        keep = tuple(new)
        as_they_are = keep == tuple(range(len(keep)))
        renamed = explanations if as_they_are else tuple(rename(one, new) for one in explanations)
        next_node = self._intern(renamed, len(new))
        rests = not retired and as_they_are
        return Edge(
            next_node,
            keep=None if rests and len(keep) == node.width else keep,
            retired=retired,
            exercises=self.numbered(tuple(dict.fromkeys(rule for successor in found for rule in successor.rules))),
            touched=self.touched(node.explanations, explanations),
            appends=rests and len(keep) > node.width,
            cuts=rests and len(keep) < node.width,
        )

    def numbered(self, rules: tuple[str, ...]) -> int:
        """The number of a set of rules in a `Tally`."""
        return self._rules.setdefault(rules, len(self._rules))

    @property
    def numbers(self) -> tuple[tuple[str, ...], ...]:
        """The sets of rules by their numbers in a `Tally`."""
        return tuple(self._rules)

    def touched(self, before: Iterable[Explanation], after: Iterable[Explanation]) -> int:
        """The bits of the ambiguities of which other readings are possible after an event than before it."""
        assumed, assumed_after = {one.assumed for one in before}, {one.assumed for one in after}
        touched = 0
        if assumed != assumed_after:
            for ambiguity in self.spec.ambiguities:
                if {one & ambiguity.group for one in assumed} != {one & ambiguity.group for one in assumed_after}:
                    touched |= ambiguity.group
        return touched

    def exercised(self, tally: Tally | None = None) -> dict[str, int]:
        """How often each rule was exercised, by a tally of beliefs that walked here; by the automaton's own if none."""
        sets, times = self.numbers, dict[str, int]()
        for number, walked in (self.tally if tally is None else tally).items():
            for rule in sets[number]:
                times[rule] = times.get(rule, 0) + walked
        return times

    @property
    def size(self) -> tuple[int, int]:
        """How many nodes and edges have been built."""
        return len(self._nodes), self._edges
