"""Where to go next: the model says what each action would exercise, and the least exercised goes first.

An *edge* is a search key of the state, an operation or drive, and what the rules say to it there. Plain random
generation finds the common edges again and again; a guide counts them over a whole run and proposes actions on those
that were walked least, or that lead to situations that were seen least.
"""

from __future__ import annotations

import copy
from collections import Counter
from collections.abc import Hashable, Iterable, Iterator
from typing import Any

from attrs import frozen

from missionfsm.kernel.alphabet import Alphabet, Bounds, Input
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import meet
from missionfsm.kernel.step import Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Incident, Refs, Request, State
from missionfsm.oracle.explanation import Explanation
from missionfsm.oracle.successors import Successors
from missionfsm.tools.conform.actions import CANCEL, Bindings, NameRef
from missionfsm.tools.conform.conversation import Conversation
from missionfsm.tools.placeholders import fill, is_template, kind_of, slots, ways

Edge = tuple[Hashable, ...]

ENOUGH = 6
"""How many edges that were never walked are enough to choose from."""

_MADE_UP = 1_000_003
"""Serial numbers of names that templates are read with."""

MAX_PROPOSALS = 120
"""How many proposals are enough in any case."""


Named = tuple[int | None, NameRef | str | None]
"""A name that a call may be about, with its position among those of the state; None for what has none."""

_NAMELESS: list[Named] = [(None, None)]


@frozen
class Proposal:
    """An action that a guide proposes, and the edge that it would walk."""

    method: str
    params: JSON
    name: NameRef | str | None
    edge: Edge
    leads_to: Hashable
    phase: Hashable = None
    picks: Bindings = ()


@frozen(eq=False)
class Template:
    """Params with stand-ins: what they say, the kind of name in each slot, and for each name the slot that it is in."""

    method: str
    params: JSON
    what: Any
    wants: dict[int, str]
    slots: Refs


@frozen(eq=False)
class PreparedCall:
    """An input without stand-ins but perhaps for one name, and what it says."""

    prompt: Input
    request: Request
    named: bool


class Guide:
    """Counts the edges that a run has walked, and proposes actions on the ones walked least.

    Args:
        system: the system.
        worlds: the worlds that conversations start in.
        bounds: for the alphabet; longer queues than `bounds.size` are not sought.

    Attributes:
        alphabets: what is worth trying in each world.
        drives: the names of all drives in them.
        calls, events, templates: the same, prepared, by operation or drive.
    """

    def __init__(self, system: System, worlds: tuple[JSON, ...], bounds: Bounds) -> None:
        self.system = system
        self.abstraction = system.spec.abstraction
        self.bounds = bounds
        self.worlds = worlds
        self.alphabets = [system.alphabet(world, bounds) for world in worlds]
        self.drives = tuple(dict.fromkeys(one["event"] for each in self.alphabets for one in each.drives))
        self.calls = [self._prepared(alphabet) for alphabet in self.alphabets]
        self.events = [self._prepared_events(alphabet) for alphabet in self.alphabets]
        self.templates = [_prepared_templates(system, alphabet) for alphabet in self.alphabets]
        self._labels = [
            list(dict.fromkeys((*calls, *events, *templates, *((CANCEL.method,) if system.codec.streams else ()))))
            for calls, events, templates in zip(self.calls, self.events, self.templates, strict=True)
        ]
        self.walked: Counter[Edge] = Counter()
        self.tried: Counter[tuple[Hashable, str]] = Counter()
        self.taken: Counter[str] = Counter()
        self.said: Counter[tuple[Hashable, ...]] = Counter()
        self.visited: Counter[Hashable] = Counter()
        self._edges: dict[Any, tuple[Edge, Hashable] | None] = {}
        self._growth: dict[Any, int] = {}
        self._idle: dict[Hashable, Edge] = {}

    def _prepared(self, alphabet: Alphabet) -> dict[str, list[PreparedCall]]:
        """The calls of each operation; those that are the same request in other words only once."""
        found: dict[str, dict[Any, PreparedCall]] = {}
        for prompt in alphabet.inputs:
            if is_template(prompt.params):
                continue
            names, rest = self.system.codec.split_request(prompt.method, prompt.params)
            request = self.system.codec.read_request(prompt.method, rest)
            found.setdefault(prompt.method, {}).setdefault(request, PreparedCall(prompt, request, bool(names)))
        return {method: list(calls.values()) for method, calls in found.items()}

    def _prepared_events(self, alphabet: Alphabet) -> dict[str, list[tuple[JSON, Any]]]:
        found: dict[str, list[tuple[JSON, Any]]] = {}
        for drive in alphabet.drives:
            if not is_template(drive):
                found.setdefault(drive["event"], []).append((drive, self.system.codec.read_drive(drive)[0]))
        return found

    def proposals(
        self, conversation: Conversation, world: int, only: str | None = None, *, rare: bool = False
    ) -> list[Proposal]:
        """What could be done now, least walked first: of the operations that were tried least, some edges each.

        Args:
            only: an operation or drive to look at alone.
            rare: look at all of them, and put first what the rules have said least often in the whole run.
        """
        belief = conversation.judge.belief
        here = rested(conversation.judge.automaton.successors, belief.node.explanations[0])
        search_key, phase = self.abstraction.search_key(here.state), self.abstraction.phase(here.state)
        found: list[Proposal] = []
        labels = [only] if only else self._labels[world]
        left_out = self._waiting(conversation).union(conversation.partner.absent)
        names = self._names(conversation, here, self.alphabets[world].wrong_names[:1])
        for label in sorted(labels, key=lambda one: (self.tried[search_key, one], self.taken[one])):
            if label in left_out:
                continue
            found += self._called(conversation, here, search_key, names, self.calls[world].get(label, ()))
            for drive, event in self.events[world].get(label, ()):
                edge = self._drive_edge(here, search_key, event)
                found.append(Proposal("drive", drive, None, *edge, phase))
            found += self._filled(conversation, here, search_key, self.templates[world].get(label, ()))
            if label == CANCEL.method:
                found += _cancellations(conversation, search_key, phase)
            enough = sum(not self.walked[one.edge] for one in found) >= ENOUGH or len(found) > MAX_PROPOSALS
            if enough and not rare:
                break
        if rare:
            found.sort(
                key=lambda one: (self.said[phase, one.edge[1:]], one.leads_to == search_key, self.walked[one.edge])
            )
        else:
            found.sort(key=lambda one: (self.walked[one.edge], self.visited[one.leads_to]))
        return found

    def _names(self, conversation: Conversation, here: Explanation, wrong: Iterable[str]) -> list[Named]:
        """What a call may be about: names of nothing, and those that were given, each with its position."""
        known = {name: given for given, name in conversation.given.items()}
        seen = ((at, conversation.judge.belief.name(number)) for at, number in enumerate(here.names))
        return [*((None, one) for one in wrong), *((at, known[name]) for at, name in seen if name in known)]

    def _called(
        self,
        conversation: Conversation,
        here: Explanation,
        search_key: Hashable,
        names: list[Named],
        calls: Iterable[PreparedCall],
    ) -> Iterator[Proposal]:
        """Proposals from calls, about each of some names where they are about any."""
        phase = self.abstraction.phase(here.state)
        for call in calls:
            for where, name in names if call.named else _NAMELESS:
                edge = self._edge(conversation, here, search_key, call.request, (where,) if call.named else ())
                if edge:
                    yield Proposal(call.prompt.method, call.prompt.params, name, *edge, phase)

    def _filled(
        self, conversation: Conversation, here: Explanation, search_key: Hashable, templates: Iterable[Template]
    ) -> Iterator[Proposal]:
        """Proposals from templates, with some of the names that were given in their slots."""
        belief = conversation.judge.belief
        phase = self.abstraction.phase(here.state)
        positions = {belief.name(number): position for position, number in enumerate(here.names)}
        given = {name: one for one, name in conversation.given.items()}
        for template in templates:
            for picked in ways(template.wants, given, self.system.naming):
                refs = tuple(positions.get(picked.get(-1 if slot is None else slot)) for slot in template.slots)
                edge: tuple[Edge, Hashable] | None
                if template.method == "drive":
                    edge = self._drive_edge(here, search_key, template.what, refs, exact=True)
                else:
                    edge = self._edge(conversation, here, search_key, template.what, refs, exact=True)
                if edge:
                    picks = tuple((slot, given[name]) for slot, name in picked.items() if name in given)
                    yield Proposal(template.method, template.params, None, *edge, phase, picks)

    def _waiting(self, conversation: Conversation) -> set[str]:
        """The drives of which one waits already, under some explanation: none may be driven now."""
        explanations = conversation.judge.belief.node.explanations
        drives = self.system.spec.drives.values()
        return {one.name for one in drives if any(one.waits(each.state) for each in explanations)}

    def fresh(self) -> Guide:
        """A guide to the same system that has not been anywhere yet."""
        other = copy.copy(self)
        other.walked, other.tried, other.taken, other.visited = Counter(), Counter(), Counter(), Counter()
        other.said = Counter()
        return other

    def note(self, proposal: Proposal) -> None:
        """A proposal was taken up."""
        label = proposal.method if proposal.method != "drive" else proposal.params["event"]
        self.tried[proposal.edge[0], label] += 1
        self.taken[label] += 1
        self.walked[proposal.edge] += 1
        self.said[proposal.phase, proposal.edge[1:]] += 1
        self.visited[proposal.leads_to] += 1

    def _edge(
        self,
        conversation: Conversation,
        here: Explanation,
        search_key: Hashable,
        request: Request,
        refs: Refs,
        *,
        exact: bool = False,
    ) -> tuple[Edge, Hashable] | None:
        size, places = self.system.spec.search_size, self._places(here, refs)
        idle = None
        if self.abstraction.rules_key is not None and not exact:
            idle = self.abstraction.rules_key(here.state), request, places
            if idle in self._idle:
                return (self._where(here, search_key, []), *self._idle[idle]), search_key
        key = (here.state if exact else search_key, request, places)
        if key not in self._edges:
            outcomes = conversation.judge.automaton.successors.outcomes(here.state, request, refs)
            steps = [step for step in outcomes if meet(here.assumed, step.assumes)]
            found = self._edges[key] = self._leading(here, search_key, request, steps)
            if idle and found and all(step.after is here.state for step in steps):
                self._idle[idle] = found[0][1:]
            self._growth[key] = size(_after(here, steps)) - size(here.state)
        grows = self._growth[key]
        return self._edges[key] if grows <= 0 or size(here.state) + grows <= self.bounds.size else None

    def _leading(
        self, here: Explanation, search_key: Hashable, request: Request, steps: list[Step]
    ) -> tuple[Edge, Hashable] | None:
        """The edge of a call that may take these steps, and the search key that it leads to; none without a step."""
        if not steps:
            return None
        says = tuple(sorted({rule for step in steps for rule in step.rules}))
        after = _after(here, steps)
        leads_to = search_key if after is here.state else self.abstraction.search_key(after)
        return (self._where(here, search_key, steps), self.system.spec.request_operation(request), says), leads_to

    def _places(self, here: Explanation, refs: Refs) -> tuple[Hashable, ...]:
        """Where the named things stand: a search key does not tell their positions apart."""
        return tuple(self.abstraction.name_key(here.state, ref) for ref in refs)

    def _drive_edge(
        self,
        here: Explanation,
        search_key: Hashable,
        event: Incident,
        refs: Refs = (),
        *,
        exact: bool = False,
    ) -> tuple[Edge, Hashable]:
        """The edge of a drive; that of a drive which cannot happen leads back to where it begins."""
        key = (here.state if exact else search_key, "drive", event, self._places(here, refs))
        if key not in self._edges:
            steps = [
                step
                for step in self.system.spec.drives[event.name].steps(here.state, event, refs)
                if meet(here.assumed, step.assumes)
            ]
            says: Hashable = event
            if exact or self.abstraction.idle_search_key is not None:
                says = (event.name, *sorted({rule for step in steps for rule in step.rules}))
            if not steps:
                says = (event.name, "does not happen")
            where = self._where(here, search_key, steps)
            after = steps[0].after if steps else here.state
            leads_to = search_key if after is here.state else self.abstraction.search_key(after)
            self._edges[key] = ((where, says), leads_to)
        return self._edges[key]  # type: ignore[return-value]  # a drive always has one

    def _where(self, here: Explanation, search_key: Hashable, steps: list[Step]) -> Hashable:
        """Where an edge begins; where nothing changes that may be said more coarsely."""
        idle = self.abstraction.idle_search_key
        return search_key if idle is None or any(step.after is not here.state for step in steps) else idle(here.state)


def _cancellations(conversation: Conversation, search_key: Hashable, phase: Hashable) -> Iterator[Proposal]:
    """To give up each of the streams that were opened, also those that have ended."""
    streams = [ref for ref, name in conversation.given.items() if kind_of(name) == "stream"]
    for position, ref in enumerate(streams):
        edge = (search_key, (CANCEL.method, position, len(streams)))
        yield Proposal(CANCEL.method, CANCEL.params, None, edge, search_key, phase, ((0, ref),))


def rested(successors: Successors, here: Explanation) -> Explanation:
    """Where an explanation comes to rest."""
    while step := next((one for one in successors.urgent(here.state) if meet(here.assumed, one.assumes)), None):
        taken = successors.advance(here, step)
        if taken is None:
            break
        here = taken[0]
    return here


def _prepared_templates(system: System, alphabet: Alphabet) -> dict[str, list[Template]]:
    """The inputs and drives with stand-ins, by the name of the operation or the drive."""
    asked = {repr(one.params): (one.method, one.params) for one in alphabet.inputs if is_template(one.params)}
    driven = {repr(one): ("drive", one) for one in alphabet.drives if is_template(one)}
    found: dict[str, list[Template]] = {}
    for method, params in (*asked.values(), *driven.values()):
        label = params["event"] if method == "drive" else method
        found.setdefault(label, []).append(template_of(system, method, params))
    return found


def template_of(system: System, method: str, params: JSON) -> Template:
    """Params with stand-ins, and what they say whichever names are picked: it is read once, with made up ones."""
    wants = slots(params)
    made = {slot: system.naming.make(kind, _MADE_UP + slot) for slot, kind in wants.items()}
    filled = fill(params, made, system.naming, _MADE_UP - 1)
    if method == "drive":
        what, names = system.codec.read_drive(filled)
    else:
        names, rest = system.codec.split_request(method, filled)
        what = system.codec.read_request(method, rest)
    of = {name: slot for slot, name in made.items()}
    return Template(method, params, what, wants, tuple(of.get(one) for one in names))


def _after(here: Explanation, steps: Iterable[Step]) -> State:
    """The state after the first of the steps that changes it."""
    return next((step.after for step in steps if step.after is not here.state), here.state)
