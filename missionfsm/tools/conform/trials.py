"""Conversations in which two readings would be told apart: a search over models of both, walked side by side."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from typing import Any

from attrs import evolve, frozen

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Name
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.step import Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import View
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.check.experiment import Experiment
from missionfsm.tools.check.narrate import story
from missionfsm.tools.conform.actions import WRONG_NAME, Action, Bindings, NameRef
from missionfsm.tools.conform.conversation import Conversation, Partner
from missionfsm.tools.conform.guide import Guide, Template
from missionfsm.tools.conform.handshake import AdapterInfo
from missionfsm.tools.conform.shrink import shrink
from missionfsm.tools.placeholders import fill, ways
from missionfsm.tools.reference.model import Reference, Reply, Snapshot
from missionfsm.tools.reference.subject import ReferenceSubject

EFFORT = 8_000
"""How many steps the references may take in the search for experiments about one ambiguity, if they are to be tried."""

ASIDE = 2
"""How many steps an action counts for that does not bring the system on."""

DOUBTFUL = 25
"""How many conversations are judged in vain for a reading before it counts as one that cannot be shown."""

Naming = list[tuple[tuple[Name, ...], NameRef | str | None]]
"""Names that a call may be about, each with how an action refers to them."""

_NAMELESS: Naming = [((), None)]


@frozen(eq=False)
class Trial:
    """An experiment as actions in a world."""

    ambiguity: Ambiguity
    follows: str
    against: tuple[str, ...]
    world: JSON
    actions: tuple[Action, ...]
    history: tuple[JSON, ...]

    def experiment(self, system: System) -> Experiment:
        """The experiment as a verdict shows it."""
        says = story(system, self.history)
        return Experiment(self.ambiguity.id, self.follows, self.against, says, self.history)


@frozen(eq=False)
class _Node:
    """The snapshots of the references, one for each reading, and the actions that led to them."""

    world: int
    here: tuple[Snapshot, ...]
    actions: tuple[Action, ...]
    given: Mapping[Name, NameRef]

    @property
    def agreed(self) -> bool:
        return all(one == self.here[0] for one in self.here)


@frozen(eq=False)
class _Move:
    """A call or a drive that can be done at a node."""

    what: Any
    names: tuple[Name, ...]
    action: Action
    driven: bool
    plain: bool = True


class Lab:
    """Looks for experiments.

    Args:
        guide: what is worth trying.
        info: what the adapter said of itself.
        automaton: judges the conversations; it assumes what has been decided.
        readings: ambiguity id to the letters that are still possible, as far as any were ruled out.
        effort: how many steps of references one search may take.
        enough: whether no more should be done.

    Attributes:
        spent: how many the last one took.
    """

    def __init__(
        self,
        guide: Guide,
        info: AdapterInfo,
        automaton: Automaton,
        readings: Mapping[str, tuple[str, ...]],
        effort: int = EFFORT,
        enough: Callable[[], bool] = lambda: False,
    ) -> None:
        self.effort = effort
        self.enough = enough
        self.spent = 0
        self.guide = guide
        self.info = info
        self.automaton = automaton
        self.readings = readings
        spec, successors = guide.system.spec, automaton.successors
        # What the spec says is remembered for all references.
        remembered = evolve(spec, outcomes=successors.outcomes, urgent=successors.urgent, decided=None)
        self.system = evolve(guide.system, spec=remembered)
        self.choice = {
            one.id: one.default if one.default in readings.get(one.id, (one.default,)) else readings[one.id][0]
            for one in spec.ambiguities
            if readings.get(one.id, (one.default,))
        }

        self.plain = [frozenset(_plain(guide, world)) for world in range(len(guide.worlds))]

    def trials(self, ambiguity: Ambiguity, letters: tuple[str, ...]) -> tuple[Trial, ...]:
        """Experiments that tell some of these readings from others, the shortest first."""
        search = _Search(self, ambiguity, letters)
        found = tuple(search.run())
        self.spent = search.spent
        return found

    def play(self, letter: tuple[str, str], world: JSON, actions: Iterable[Action]) -> Conversation:
        """The conversation with the reference that follows a reading besides what has been decided."""
        subject = ReferenceSubject(self.guide.system, {**self.choice, letter[0]: letter[1]})
        conversation = Conversation(Partner(self.guide.system, subject, self.info), world, self.automaton)
        for action in actions:
            if self.enough() or not conversation.perform(action):
                break
        return conversation


class _Search:
    """The search for the experiments on one ambiguity."""

    def __init__(self, lab: Lab, ambiguity: Ambiguity, letters: tuple[str, ...]) -> None:
        self.lab = lab
        self.system = lab.system
        self.ambiguity = ambiguity
        self.letters = letters
        self.models = [Reference(self.system, {**lab.choice, ambiguity.id: letter}) for letter in letters]
        self.wanted = set(itertools.permutations(letters, 2))
        self.doubts = dict.fromkeys(letters, 0)
        self.effort = lab.effort
        self.spent = 0
        self._seen: set[Hashable] = set()
        self._once: set[Hashable] = set()
        self._thorough: set[Hashable] = set()
        self._written: dict[Any, str] = {}

    def run(self) -> Iterator[Trial]:
        """Half of the effort goes into the usual world, since what can be seen there needs no other."""
        worlds = range(len(self.lab.guide.worlds))
        for some in (worlds[:1], worlds[1:]):
            self.effort = self.lab.effort // 2
            yield from self._nearest_first(some)
            self.spent += self.lab.effort // 2 - self.effort

    def _nearest_first(self, worlds: Iterable[int]) -> Iterator[Trial]:
        todo: list[tuple[int, int, _Node]] = []
        serial = itertools.count()
        for node, differs in map(self._root, worlds):
            if differs:
                yield from self._judged(node)
            todo.append((0, next(serial), node))
        while todo:
            far, _, node = heapq.heappop(todo)
            for move in self._moves(node):
                if not self.wanted or self.effort <= 0 or self.lab.enough():
                    return
                found = self._step(node, move)
                if found is None:
                    continue
                after, differs = found
                if differs:
                    yield from self._judged(after)
                if self._is_new(after):
                    heapq.heappush(todo, (far + (1 if move.plain else ASIDE), next(serial), after))

    def _root(self, world: int) -> tuple[_Node, bool]:
        """A fresh instance in a world, with a subscription if the system has just one stream.

        A subscriber sees more; if that was not needed, the subscription is left out in the end.
        """
        streams = self.system.codec.streams
        params = self.lab.guide.worlds[world]
        here = tuple(model.start(self.system.codec.read_world(params)) for model in self.models)
        node = _Node(world, here, (), {})
        if len(streams) != 1:
            return node, False
        watching = _Move(self.system.codec.read_request(streams[0], {}), (), Action(1, streams[0], {}), driven=False)
        return self._step(node, watching) or (node, False)

    # What can be done.

    def _moves(self, node: _Node) -> Iterator[_Move]:
        """What is worth trying: everything in a situation that is met first, else only what brings the system on."""
        keys = (node.world, *(self.system.spec.abstraction.enabled_key(one.state) for one in node.here))
        everything = keys not in self._thorough
        self._thorough.add(keys)
        yield from self._calls(node, everything=everything)
        yield from self._drives(node)
        yield from self._templates(node, everything=everything)

    def _calls(self, node: _Node, *, everything: bool) -> Iterator[_Move]:
        """Calls without stand-ins, about every name that is known."""
        serial, plain = len(node.actions) + 1, self.lab.plain[node.world]
        texts: Naming = [((name,), given) for name, given in node.given.items() if isinstance(name, str)]
        wrong: Naming = [((WRONG_NAME,), WRONG_NAME)] if everything else []
        for call in itertools.chain.from_iterable(self.lab.guide.calls[node.world].values()):
            if everything or id(call.prompt) in plain:
                for name, given in [*texts, *wrong] if call.named else _NAMELESS:
                    action = Action(serial, call.prompt.method, call.prompt.params, given)
                    yield _Move(call.request, name, action, driven=False, plain=id(call.prompt) in plain)

    def _drives(self, node: _Node) -> Iterator[_Move]:
        """Events without stand-ins, but for those of which one waits already."""
        serial, plain = len(node.actions) + 1, self.lab.plain[node.world]
        for drive, event in itertools.chain.from_iterable(self.lab.guide.events[node.world].values()):
            if not any(self.system.spec.drives[event.name].waits(one.state) for one in node.here):
                yield _Move(event, (), Action(serial, "drive", drive), driven=True, plain=id(drive) in plain)

    def _templates(self, node: _Node, *, everything: bool) -> Iterator[_Move]:
        """Calls and events with stand-ins, with what may be put there."""
        serial, plain = len(node.actions) + 1, self.lab.plain[node.world]
        for template in itertools.chain.from_iterable(self.lab.guide.templates[node.world].values()):
            if everything or id(template.params) in plain:
                for names, picks in self._fillings(node, template):
                    action = Action(serial, template.method, template.params, None, picks)
                    driven = template.method == "drive"
                    yield _Move(template.what, names, action, driven=driven, plain=id(template.params) in plain)

    def _fillings(self, node: _Node, template: Template) -> Iterator[tuple[tuple[Name, ...], Bindings]]:
        for picked in ways(template.wants, node.given, self.system.naming):
            names = tuple(picked.get(-1 if slot is None else slot) for slot in template.slots)
            if None in template.slots:  # a name is new: it is made up as a conversation would make it up
                codec, serial = self.system.codec, len(node.actions) + 1
                params = fill(template.params, picked, self.system.naming, serial, node.given)
                driven = template.method == "drive"
                names = codec.read_drive(params)[1] if driven else codec.split_request(template.method, params)[0]
            yield names, tuple((slot, node.given[name]) for slot, name in picked.items() if name in node.given)

    # What comes of it.

    def _step(self, node: _Node, move: _Move) -> tuple[_Node, bool] | None:
        """The node after a move and whether the references are seen to differ; None where nothing comes of it."""
        if self._is_dull(node, move):
            return None
        self.effort -= len(self.models)
        taken = [
            (model.drive if move.driven else model.call)(here, move.what, move.names)
            for model, here in zip(self.models, node.here, strict=True)
        ]
        seen = {self._seen_of(model, reply) for model, (_, reply) in zip(self.models, taken, strict=True)}
        given = dict(node.given)
        for position, name in enumerate(_learnt(taken[0][1])):
            given.setdefault(name, NameRef(move.action.serial, position))
        settle = Action(move.action.serial + 1, "settle")
        here = tuple(after for after, _ in taken)
        return _Node(node.world, here, (*node.actions, move.action, settle), given), len(seen) > 1

    def _is_dull(self, node: _Node, move: _Move) -> bool:
        """Whether every reference takes the very same step, and it changes nothing or was seen to make no difference.

        What it makes subscribers see may differ all the same, so it is looked at once.
        """
        first: Step | None = None
        for position, (model, here) in enumerate(zip(self.models, node.here, strict=True)):
            refs = tuple(map(here.ref, move.names))
            step = (model.driven if move.driven else model.outcome)(here.state, move.what, refs)
            if position and step is not first:
                return False
            if step is not None and step.after is not here.state and (move.plain or move.driven):
                return False
            first = step
        if first is None or not (first.emits or first.opens or first.after is not node.here[0].state):
            return True
        once = (node.world, move.what, first.rules)
        if once in self._once:
            return True
        self._once.add(once)
        return False

    def _seen_of(self, model: Reference, reply: Reply) -> Hashable:
        sent = tuple((one.channel, self._text(model, one.view, one.names)) for one in reply.sent)
        return reply.happened, reply.answer, reply.names, sent

    def _text(self, model: Reference, view: View, names: tuple[Name, ...]) -> str:
        key = (view, names, model.choice)
        text = self._written.get(key)
        if text is None:
            text = self._written[key] = repr(self.system.codec.write_message(view, names, model.choice, 1, 0.0))
        return text

    def _is_new(self, node: _Node) -> bool:
        spec = self.system.spec
        size = spec.search_size
        if max(size(one.state) for one in node.here) > self.lab.guide.bounds.size:
            return False
        shapes = tuple((spec.abstraction.search_key(one.state), len(one.channels)) for one in node.here)
        key = (node.world, shapes, node.agreed)
        if key in self._seen:
            return False
        self._seen.add(key)
        return True

    def _judged(self, node: _Node) -> Iterator[Trial]:
        """The experiments that a conversation is in which the references are seen to differ."""
        world = self.lab.guide.worlds[node.world]
        for letter in self.letters:
            wanted = {other for one, other in self.wanted if one == letter}
            if not wanted or self.doubts[letter] > DOUBTFUL:
                continue
            against = self._rules_out(self.lab.play((self.ambiguity.id, letter), world, node.actions)) & wanted
            if not against:
                self.doubts[letter] += 1
                continue
            self.wanted -= {(letter, other) for other in against}
            yield self._shortened(letter, against, world, node.actions)

    def _rules_out(self, conversation: Conversation) -> set[str]:
        if not conversation.right:
            return set()
        left = conversation.judge.belief.readings.get(self.ambiguity.id, self.letters)
        return {letter for letter in self.letters if letter not in left}

    def _shortened(self, letter: str, against: set[str], world: JSON, actions: tuple[Action, ...]) -> Trial:
        lab = self.lab

        def attempt(where: JSON, some: tuple[Action, ...]) -> Conversation:
            return lab.play((self.ambiguity.id, letter), where, some)

        def shows(tried: Conversation) -> bool:
            return against <= self._rules_out(tried)

        found = shrink(attempt(world, actions), attempt, lambda _, __: (), world, shows, enough=lab.enough)
        ruled_out = tuple(one for one in self.letters if one in self._rules_out(found))
        return Trial(self.ambiguity, letter, ruled_out, found.world, tuple(found.actions), found.judge.history)


def _plain(guide: Guide, world: int) -> Iterator[int]:
    """Which of the prepared inputs and drives of a world are those that bring the system on, by identity."""
    alphabet = guide.alphabets[world]
    wanted = {repr(one.params) for one in alphabet.core_inputs} | {repr(one) for one in alphabet.core_drives}
    for calls in guide.calls[world].values():
        yield from (id(call.prompt) for call in calls if repr(call.prompt.params) in wanted)
    for events in guide.events[world].values():
        yield from (id(drive) for drive, _ in events if repr(drive) in wanted)
    for templates in guide.templates[world].values():
        yield from (id(template.params) for template in templates if repr(template.params) in wanted)


def _learnt(reply: Reply) -> Iterator[Name]:
    """The names that a tester comes to know by a reply, in the order of `missionfsm.tools.conform.conversation`."""
    yield from reply.names
    for sent in reply.sent:
        if isinstance(sent.channel, tuple) and sent.channel[0] == "connection":
            yield sent.channel
            yield from sent.names
