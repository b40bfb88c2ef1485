"""What can be tried in a state of a system, each with the line that it is in a history."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterator

from attrs import field, frozen

from missionfsm.kernel.alphabet import ANY_NAME, Alphabet
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Name
from missionfsm.kernel.step import Step
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Incident, Refs, Request, State
from missionfsm.pages.naming import TEXT, Writer, dumped, put
from missionfsm.tools.placeholders import kind_of, slots

CALL, DRIVE, ITSELF = "call", "drive", "itself"
FIXED = -1
"""Instead of the slot of a name: it stands there as it is."""
ENVIRONMENT, BY_ITSELF = "environment", "by itself"
"""The headings under which drives and what a system does by itself stand."""


@frozen
class Doing:
    """Something that may be tried in a state: a request, an event, or what the system does by itself.

    Attributes:
        group: the heading under which it stands: an operation, or what sort of thing it is.
        line: the line that it is in a history, as a template; empty for what nobody sees.
        refs: positions of the names that it is about, among those of the state and then those that it brings along;
            None for a name that nothing has.
        kinds: of each of these names the kind.
        brings: the kinds of the names that an event brings along.
    """

    kind: str
    group: str
    words: str
    line: str = ""
    refs: Refs = ()
    kinds: tuple[str, ...] = ()
    brings: tuple[str, ...] = ()


@frozen
class Tried:
    """A doing with all that may come of it; `method` is the method of a call."""

    doing: Doing
    steps: tuple[Step, ...]
    method: str = ""


@frozen
class _Filled:
    """An input or a drive with names in it: the params, the positions of the names, and the names.

    Attributes:
        kinds: of each name its kind.
        fixed: of each name whether it stood there from the start.
    """

    params: JSON
    refs: Refs
    names: tuple[Name, ...]
    kinds: tuple[str, ...]
    fixed: tuple[bool, ...]


@frozen
class _Asked:
    doing: Doing
    method: str
    request: Request


@frozen
class _Event:
    event: Incident
    filled: _Filled
    words: str
    made: dict[tuple[str, ...], Doing] = field(factory=dict)


class Doings:
    """All that an alphabet has to try. How it is asked depends on the kinds of a state's names alone, and is kept."""

    def __init__(self, system: System, alphabet: Alphabet, writer: Writer) -> None:
        self.system = system
        self.writer = writer
        self.alphabet = alphabet
        self._asked: dict[tuple[str, ...], tuple[_Asked, ...]] = {}
        self._events: dict[tuple[str, ...], tuple[_Event, ...]] = {}

    def __call__(self, here: State, kinds: tuple[str, ...]) -> Iterator[Tried]:
        """All that can be tried in a state whose names are of these kinds."""
        spec = self.system.spec
        if kinds not in self._asked:
            self._asked[kinds] = tuple(self._requests(kinds))
            self._events[kinds] = tuple(self._drives(kinds))
        for asked in self._asked[kinds]:
            yield Tried(asked.doing, spec.outcomes(here, asked.request, asked.doing.refs), asked.method)
        for one in self._events[kinds]:
            steps = tuple(spec.drives[one.event.name].steps(here, one.event, one.filled.refs))
            opened = {opening.ref: opening.kind for step in steps for opening in step.opens if opening.ref < 0}
            brought = tuple(opened[ref] for ref in sorted(opened, reverse=True))
            if brought not in one.made:
                one.made[brought] = self._driven(one, len(kinds), brought)
            yield Tried(one.made[brought], steps)
        for step in (*spec.urgent(here), *spec.spontaneous(here)):
            yield Tried(Doing(ITSELF, BY_ITSELF, self._unasked(step)), (step,))

    def _unasked(self, step: Step) -> str:
        """What a system does by itself, in words."""
        says = (self.system.spec.rules_by_id[one].says for one in step.rules)
        opens = (f"a {opening.kind} opens" for opening in step.opens)
        return step.label or next(itertools.chain(says, opens), "something happens unseen")

    def _requests(self, kinds: tuple[str, ...]) -> Iterator[_Asked]:
        codec, spec = self.system.codec, self.system.spec
        seen: set[tuple[Request, Refs]] = set()
        for prompt in self.alphabet.core_inputs:
            method = prompt.method
            for filled in self._filled(prompt.params, kinds, functools.partial(self._names_asked, method)):
                request = codec.read_request(method, codec.split_request(method, filled.params)[1])
                if (request, filled.refs) in seen:
                    continue
                seen.add((request, filled.refs))
                line = self.writer.text({"call": 0, "method": method, "params": filled.params})
                doing = Doing(
                    CALL, spec.request_operation(request), spec.describe(request), line, filled.refs, filled.kinds
                )
                yield _Asked(doing, method, request)

    def _names_asked(self, method: str, params: JSON) -> tuple[Name, ...]:
        return self.system.codec.split_request(method, params)[0]

    def _drives(self, kinds: tuple[str, ...]) -> Iterator[_Event]:
        for drive in self.alphabet.core_drives:
            for filled in self._filled(drive, kinds, lambda given: self.system.codec.read_drive(given)[1]):
                event = self.system.codec.read_drive(filled.params)[0]
                yield _Event(event, filled, self.system.spec.describe(event))

    def _driven(self, one: _Event, names: int, opened: tuple[str, ...]) -> Doing:
        """An event. It brings along the names that are written in it, and those of channels that it opens."""
        filled = one.filled
        fixed = [at for at, stands in enumerate(filled.fixed) if stands]
        positions = {at: names + number for number, at in enumerate(fixed)}
        first = names + len(fixed)
        places = [self.writer.place(kind, first + at) for at, kind in enumerate(opened)]
        drive = {**filled.params, **self.system.codec.write_drive_result(one.event, (*filled.names, *places))}
        line = self.writer.text({"drive": drive}, {filled.names[at]: position for at, position in positions.items()})
        refs = (
            *(positions.get(at, ref) for at, ref in enumerate(filled.refs)),
            *range(first, first + len(opened)),
        )
        brings = (*(kind_of(filled.names[at]) or TEXT for at in fixed), *opened)
        return Doing(DRIVE, ENVIRONMENT, one.words, line, refs, (*filled.kinds, *opened), brings)

    def _filled(
        self, params: JSON, kinds: tuple[str, ...], names_in: Callable[[JSON], tuple[Name, ...]]
    ) -> Iterator[_Filled]:
        """Params with every way to put names of a state, or one that it does not have, where names go."""
        naming, writer = self.system.naming, self.writer
        any_name = ((None, TEXT),) if ANY_NAME in dumped(params) else ()
        wanted: dict[int | None, str] = dict((*slots(params).items(), *any_name))
        stand_ins = {writer.place(kind, at): slot for at, (slot, kind) in enumerate(wanted.items())}
        # The names in params are picked by us, or stand there as they are.
        order = names_in(put(params, {slot: name for name, slot in stand_ins.items()}, naming))
        free = [stand_ins.get(name, FIXED) for name in order]
        sorts = tuple(
            wanted[slot] if slot != FIXED else kind_of(name) or TEXT for slot, name in zip(free, order, strict=True)
        )
        for refs in itertools.product(*self._choices(free, wanted, kinds)):
            chosen = {
                slot: writer.made(wanted[slot], 0) if at is None else writer.place(wanted[slot], at)
                for slot, at in zip(free, refs, strict=True)
                if slot != FIXED
            }
            filled = put(params, chosen, naming)
            yield _Filled(filled, refs, names_in(filled), sorts, tuple(slot == FIXED for slot in free))

    def _choices(
        self, free: list[int | None], wanted: dict[int | None, str], kinds: tuple[str, ...]
    ) -> Iterator[list[int | None]]:
        """For every name: the positions of those of its kind that may stand there, and None for one that is no name."""
        for slot in free:
            positions = () if slot == FIXED else (at for at, kind in enumerate(kinds) if kind == wanted[slot])
            yield [None, *positions]
