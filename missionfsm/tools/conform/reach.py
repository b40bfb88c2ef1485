"""Which actions a run has done in which situations, and what it can do where that was too seldom.

A system says what its situations are and which kinds of actions matter (`missionfsm.kernel.matrix`). Every cell of
situation × kind that comes up in some conversation is to be met `OFTEN` times.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Hashable, Iterator
from typing import Any

from attrs import define, field, frozen

from missionfsm.kernel.alphabet import ANY_NAME
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.matrix import Matrix, Open
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Incident, Refs, Request, State
from missionfsm.oracle.explanation import Explanation
from missionfsm.tools.check.basis import OFTEN, MatrixCoverage
from missionfsm.tools.conform.actions import CANCEL, SETTLE, Action, Bindings, NameRef, filled
from missionfsm.tools.conform.conversation import Conversation
from missionfsm.tools.conform.guide import Guide, Template, rested, template_of
from missionfsm.tools.placeholders import is_template, kind_of, ways

ALIKE = 8
"""How many explanations are compared at most to be sure of a situation; with more it is not sure."""

Cell = tuple[str, str]
"""A situation and a kind of action."""

Columns = dict[tuple[Request | Incident, Refs], tuple[Cell, ...]]
"""For each request or event and the places of its names, the cells that it meets."""


@frozen
class Choice:
    """Something that could be done now.

    Attributes:
        method, params, name, picks: as those of an `Action`.
        cells: the cells that it would meet.
        event: the event, if it is a drive.
        refs: the positions of the event's names among those of the state.
    """

    method: str
    params: JSON
    name: NameRef | str | None
    picks: Bindings
    cells: tuple[Cell, ...]
    event: Incident | None = None
    refs: Refs = ()


@define(eq=False)
class Reach:
    """Which cells a run has met, and how often.

    Attributes:
        matrix: what the system says of its situations.
        times: how often each cell was met; 0 for a cell that could have been met and was not.
        guide: what is worth trying, as large as the matrix says.
    """

    system: System
    matrix: Matrix
    worlds: tuple[JSON, ...]
    times: dict[Cell, int] = field(factory=dict)
    _read: dict[tuple[str, str], Any] = field(factory=dict)
    _templates: dict[tuple[str, str], Template] = field(factory=dict)
    _guide: Guide | None = None
    _columns: dict[tuple[State, Open], tuple[State, Open, Columns]] = field(factory=dict)
    _at: tuple[Explanation, State, Open, Columns] | None = None

    @property
    def guide(self) -> Guide:
        """What is worth trying, in each world."""
        if self._guide is None:
            self._guide = Guide(self.system, self.worlds, self.matrix.bounds)
        return self._guide

    def situation(self, conversation: Conversation) -> tuple[str | None, Explanation]:
        """The situation of a conversation, if that is sure, and its first explanation."""
        judge = conversation.judge
        successors = judge.automaton.successors
        explanations = judge.belief.node.explanations
        here = rested(successors, explanations[0])
        name = self._situation(here)
        if len(explanations) > ALIKE or any(
            self._situation(rested(successors, one)) != name for one in explanations[1:]
        ):
            return None, here
        return name, here

    def _situation(self, here: Explanation) -> str | None:
        return self.matrix.situation(here.state, opened(here))

    def note(self, conversation: Conversation, action: Action) -> None:
        """Count the cells that an action is about to meet."""
        if action.method not in (*self.system.codec.methods, "drive", CANCEL.method):
            return
        situation, here = self.situation(conversation)
        if situation is None:
            return
        if action.method == CANCEL.method:
            columns: tuple[str, ...] = (CANCEL.method,)
        else:
            what, refs = self._said(conversation, here, action)
            if action.method == "drive" and not tuple(self.system.spec.drives[what.name].steps(here.state, what, refs)):
                return  # it cannot happen there
            columns = self.matrix.columns(here.state, opened(here), what, refs)
        for column in columns:
            self.times[situation, column] = self.times.get((situation, column), 0) + 1

    def _said(self, conversation: Conversation, here: Explanation, action: Action) -> tuple[Request | Incident, Refs]:
        """The request or event of an action, and the positions of its names among those of the state."""
        if is_template(action.params):
            key = (action.method, repr(action.params))
            if key not in self._templates:
                self._templates[key] = template_of(self.system, action.method, action.params)
            template, picked = self._templates[key], dict(action.picks)
            names = (None if slot is None else picked.get(slot) for slot in template.slots)
            return template.what, tuple(None if one is None else _position(conversation, here, one) for one in names)
        if action.name is not None and ANY_NAME in repr(action.params):
            return self._what(action), (_position(conversation, here, action.name),)
        return self._what(action), ()

    def _what(self, action: Action) -> Request | Incident:
        """The request or event of an action, without the names in it."""
        key = (action.method, repr(action.params))
        if key not in self._read:
            codec = self.system.codec
            if action.method == "drive":
                self._read[key] = codec.read_drive(action.params)[0]
            else:
                rest = codec.split_request(action.method, filled(action.params, "any"))[1]
                self._read[key] = codec.read_request(action.method, rest)
        return self._read[key]

    def choose(self, conversation: Conversation, world: int, draw: random.Random) -> Choice | None:
        """Something to do now in a cell that was met too seldom, one of those that were met least often."""
        situation, here = self.situation(conversation)
        if situation is None:
            return self._pause(conversation)
        left: list[Choice] = []
        for one in self._possible(conversation, here, world, situation):
            # It costs much to tell whether a drive happens: that is asked only for new cells, and for what is chosen.
            if self.times.keys() >= set(one.cells) or self._happens(here, one):
                for cell in one.cells:
                    self.times.setdefault(cell, 0)
                left.append(one)
        while left:
            # Another stream may lead to another situation, so it comes only when nothing else is left to do here.
            here_still = [one for one in left if one.method not in (*self.system.codec.streams, CANCEL.method)] or left
            seldom = min(map(self._least, here_still))
            some = [one for one in here_still if self._least(one) == seldom]
            chosen = some[draw.randrange(len(some))]
            if self._happens(here, chosen):
                return chosen
            left = [one for one in left if one is not chosen]
        return None

    def _pause(self, conversation: Conversation) -> Choice | None:
        """The pause that makes the situation sure, unless it was made just now."""
        pause = self.matrix.pause
        last = next((one for one in reversed(conversation.actions) if one.method != SETTLE), None)
        if pause is None or (last is not None and last.params == pause.params):
            return None
        return Choice(pause.method, pause.params, None, (), ())

    def _happens(self, here: Explanation, one: Choice) -> bool:
        event = one.event
        return event is None or bool(tuple(self.system.spec.drives[event.name].steps(here.state, event, one.refs)))

    def _least(self, one: Choice) -> int:
        return min(self.times[cell] for cell in one.cells)

    def lacks(self, situation: str) -> bool:
        """Whether a known cell of a situation was met too seldom."""
        return any(where == situation and times < OFTEN for (where, _), times in self.times.items())

    def _possible(self, conversation: Conversation, here: Explanation, world: int, situation: str) -> Iterator[Choice]:
        """Everything that could be done now in a cell that was met too seldom."""
        streams = [ref for ref, name in conversation.given.items() if kind_of(name) == "stream"]
        cancels = ((situation, CANCEL.method),)
        yield from self._calls(conversation, here, world, situation)
        yield from self._events(conversation, here, world, situation)
        yield from self._filled(conversation, here, world, situation)
        if streams and self._lack(cancels):
            yield Choice(CANCEL.method, CANCEL.params, None, ((0, streams[-1]),), cancels)

    def _calls(self, conversation: Conversation, here: Explanation, world: int, situation: str) -> Iterator[Choice]:
        absent = conversation.partner.absent
        belief, given = conversation.judge.belief, {name: one for one, name in conversation.given.items()}
        known = ((position, given.get(belief.name(number))) for position, number in enumerate(here.names))
        names = [(position, name) for position, name in known if name is not None]
        for method, calls in self.guide.calls[world].items():
            for call in calls if method not in absent else ():
                for where, name in names if call.named else ((None, None),):
                    cells = self._cells(here, situation, call.request, (where,) if call.named else ())
                    if self._lack(cells):
                        yield Choice(method, call.prompt.params, name, (), cells)

    def _events(self, conversation: Conversation, here: Explanation, world: int, situation: str) -> Iterator[Choice]:
        explanations = conversation.judge.belief.node.explanations
        for drive, event in itertools.chain.from_iterable(self.guide.events[world].values()):
            cells = self._cells(here, situation, event, ())
            waits = self.system.spec.drives[event.name].waits
            if self._lack(cells) and not any(waits(one.state) for one in explanations):
                yield Choice("drive", drive, None, (), cells, event)

    def _filled(self, conversation: Conversation, here: Explanation, world: int, situation: str) -> Iterator[Choice]:
        """What has names in it, with those that were given, each in each place that it may have."""
        absent, naming = conversation.partner.absent, self.system.naming
        belief = conversation.judge.belief
        positions = {belief.name(number): position for position, number in enumerate(here.names)}
        given = {name: one for one, name in conversation.given.items()}
        streams = opened(here)
        for template in itertools.chain.from_iterable(self.guide.templates[world].values()):
            if template.method in absent:
                continue
            event = template.what if template.method == "drive" else None
            for picked in ways(template.wants, given, naming):
                refs = tuple(None if slot is None else positions.get(picked[slot]) for slot in template.slots)
                # A state with names in it seldom comes again: nothing is kept of it.
                kinds = self.matrix.columns(here.state, streams, template.what, refs)
                cells = tuple((situation, kind) for kind in kinds)
                if self._lack(cells):
                    picks = tuple((slot, given[name]) for slot, name in picked.items() if name in given)
                    yield Choice(template.method, template.params, None, picks, cells, event, refs)

    def _cells(self, here: Explanation, situation: str, asked: Request | Incident, refs: Refs) -> tuple[Cell, ...]:
        """The cells of the matrix that asking for something meets."""
        if self._at is None or self._at[0] is not here:
            there = here.state, opened(here)
            # What equals a state that was looked at is that one from now on, so that nobody compares the two again.
            self._at = here, *self._columns.setdefault(there, (*there, {}))
        _, state, streams, known = self._at
        cells = known.get((asked, refs))
        if cells is None:
            kinds = self.matrix.columns(state, streams, asked, refs)
            cells = known[asked, refs] = tuple((situation, kind) for kind in kinds)
        return cells

    def _lack(self, cells: tuple[Cell, ...]) -> bool:
        return any(self.times.get(cell, 0) < OFTEN for cell in cells)

    @property
    def met(self) -> int:
        """How many of the times that cells are to be met they were."""
        return sum(min(times, OFTEN) for times in self.times.values())

    def reached(self) -> MatrixCoverage:
        """What it came to."""
        met = {situation for situation, _ in self.times}
        return MatrixCoverage(
            len(self.times),
            {
                f"{situation} × {kind}": times
                for (situation, kind), times in sorted(self.times.items())
                if times < OFTEN
            },
            tuple(situation for situation in self.matrix.ways if situation not in met),
        )


def opened(here: Explanation) -> Open:
    """What the channels of each stream or connection that is open are about."""
    found: dict[int, list[Hashable]] = {}
    for channel in here.channels:
        found.setdefault(channel.name, []).append(channel.topic)
    return tuple(map(tuple, found.values()))


def _position(conversation: Conversation, here: Explanation, name: NameRef | str) -> int | None:
    """Where the thing that a name is of stands among those of the state."""
    wanted = conversation.given.get(name) if isinstance(name, NameRef) else name
    belief = conversation.judge.belief
    return next((place for place, number in enumerate(here.names) if belief.name(number) == wanted), None)
