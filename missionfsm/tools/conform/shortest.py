"""The shortest conversation that cannot be explained: all of some kinds of things are had, short ones first.

What leads where another conversation led is not gone on from: to go on from there was tried already.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

from attrs import define, evolve, field

from missionfsm.kernel.alphabet import ANY_NAME, Alphabet, Input
from missionfsm.oracle.automaton import Node
from missionfsm.tools.conform.actions import CANCEL, SETTLE, WRONG_NAME, Action, NameRef
from missionfsm.tools.conform.conversation import Conversation
from missionfsm.tools.conform.shrink import unexplained
from missionfsm.tools.placeholders import is_template, kind_of, slots, ways

MAX_TRIED = 3_000
"""How many things are done at most."""


def shortest(
    found: Conversation,
    attempt: Callable[[tuple[Action, ...]], Conversation],
    alphabet: Alphabet,
    depth: int,
    *,
    shows: Callable[[Conversation], bool] = unexplained,
    enough: Callable[[], bool] = lambda: False,
) -> Conversation | None:
    """A conversation that cannot be explained, of few calls and drives of the kinds in one that was found.

    Args:
        found: one that cannot be explained.
        attempt: has one anew in the same world.
        alphabet: what is worth trying there.
        depth: how many calls and drives it has at most.
        shows: whether a conversation is one that is looked for.
        enough: whether no more should be done.

    Returns:
        the shortest; none where nothing was found within these bounds.
    """
    kinds = {action.method for action in found.actions}
    own = tuple(Input(one.method, one.params) for one in found.actions if one.method not in (SETTLE, "drive"))
    events = tuple(one.params for one in found.actions if one.method == "drive")
    like = evolve(
        alphabet,
        inputs=own,
        core_inputs=tuple(one for one in alphabet.core_inputs if one.method in kinds),
        drives=events,
        core_drives=tuple(one for one in alphabet.core_drives if one in events),
    )
    return everything(attempt, like, depth, shows=shows, enough=enough)


def everything(
    attempt: Callable[[tuple[Action, ...]], Conversation],
    alphabet: Alphabet,
    depth: int,
    *,
    shows: Callable[[Conversation], bool] = unexplained,
    enough: Callable[[], bool] = lambda: False,
) -> Conversation | None:
    """The same of anything in an alphabet: anything at the end, and on the way there what brings the system on."""
    return _Search(attempt, alphabet, shows, enough).run(depth)


@define(eq=False)
class _Search:
    attempt: Callable[[tuple[Action, ...]], Conversation]
    alphabet: Alphabet
    shows: Callable[[Conversation], bool]
    enough: Callable[[], bool]
    left: int = MAX_TRIED
    seen: set[Node] = field(factory=set)
    serials: Iterator[int] = field(factory=lambda: itertools.count(1))

    def run(self, depth: int) -> Conversation | None:
        way: list[tuple[Action, ...]] = [()]
        for _ in range(depth):
            onward: list[tuple[Action, ...]] = []
            for begun in way:
                found = self._from(begun, onward)
                if found is not None or self._is_over():
                    return found
            way = onward
        return None

    def _is_over(self) -> bool:
        return self.left <= 0 or self.enough()

    def _from(self, begun: tuple[Action, ...], onward: list[tuple[Action, ...]]) -> Conversation | None:
        """Try everything after what was begun; `onward` gets what leads somewhere new."""
        here = self.attempt(begun)
        for one, leads_on in list(self._actions(here)):
            if self._is_over():
                return None
            self.left -= 1
            before = here.judge.belief.node
            action, settled = evolve(one, serial=next(self.serials)), Action(next(self.serials), SETTLE)
            if not (here.perform(action) and here.perform(settled)):
                found = self._confirmed((*begun, action), settled)
                if found is not None:
                    return found
            elif here.judge.belief.node is before:
                continue  # nothing came of it: the next is tried in the same conversation
            elif leads_on and here.judge.belief.node not in self.seen:
                self.seen.add(here.judge.belief.node)
                onward.append((*begun, action, settled))
            here = self.attempt(begun)
            self.left -= len(begun)
        return None

    def _confirmed(self, actions: tuple[Action, ...], settled: Action) -> Conversation | None:
        """A conversation of these actions alone, if it cannot be explained; perhaps one has to wait at the end."""
        for done in (actions, (*actions, settled)):
            found = self.attempt(done)
            if self.shows(found):
                return found
        return None

    def _actions(self, here: Conversation) -> Iterator[tuple[Action, bool]]:
        """Everything worth doing here, and whether it brings the system on."""
        plain = (*self.alphabet.core_inputs, *(Input("drive", one) for one in self.alphabet.core_drives))
        others = (*self.alphabet.inputs, CANCEL, *(Input("drive", one) for one in self.alphabet.drives))
        for prompt in {repr(one): one for one in (*plain, *others)}.values():
            for action in _named(here, prompt, self.alphabet.wrong_names):
                yield action, prompt in plain


def _named(here: Conversation, prompt: Input, wrong: tuple[str, ...]) -> Iterator[Action]:
    """An input with each of the names that were given, and with one that was not."""
    if is_template(prompt.params):
        wanted = slots(prompt.params)
        given = {name: by for by, name in here.given.items()}
        if prompt is CANCEL and not any(kind_of(name) == "stream" for name in given):
            return
        for picked in ways(wanted, given, here.system.naming):
            picks = tuple((slot, given[name]) for slot, name in picked.items() if name in given)
            yield Action(0, prompt.method, prompt.params, None, picks)
        return
    names: tuple[NameRef | str | None, ...] = (None,)
    if ANY_NAME in repr(prompt.params):
        names = (*here.given, *(wrong[:1] or (WRONG_NAME,)))
    for name in names:
        yield Action(0, prompt.method, prompt.params, name)
