"""What may happen to a state, and what is seen of it: steps, the messages that they owe, and what shows them."""

from __future__ import annotations

from collections.abc import Hashable

from attrs import frozen

from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.terms import State, View
from missionfsm.kernel.values import value

ONCE_HAD = -1
"""What outcomes are given for a name that the state no longer has, instead of its position.

In the references of a `Step`, -1 means something else: the first name that the event brought along.
"""


@value
class Emission:
    """A message that a step owes to every channel that its topic concerns.

    Attributes:
        topic: what the message is about.
        view: what it shows.
        refs: the names that the view mentions, in its order, referred to as in `Step`; None: all names of the state
            after the step.
        only: the assumption without which the message is not sent; such a message may always be left out.
        optional: the message may be left out whatever is assumed. Until something later is shown it may come at any
            time, also after things have settled.
        stays: the message is optional, and may come more than once.
        certain: the message comes even if the state after the step does not last.
        fleeting: the message may be left out; it comes before things settle, or not at all.
    """

    topic: Hashable
    view: View
    refs: tuple[int, ...] | None = None
    only: Assumption | None = None
    optional: bool = False
    stays: bool = False
    certain: bool = False
    fleeting: bool = False


@value
class Opening:
    """A channel that a step opens.

    Attributes:
        topic: what it is about.
        ref: its name, as a reference like those in `Step.names`.
        owed: the messages that it starts with.
        kind: ``stream`` or ``connection``: the kind of its name.
    """

    topic: Hashable
    ref: int
    owed: tuple[Emission, ...] = ()
    kind: str = "stream"


@value
class Step:
    """Something that may happen, with the state after it.

    Names are referred to by number: 0…n-1 are those of the state before, n… are new ones that this step adds, and -1,
    -2… are the first, second… that the event itself brought along (a connection's).

    Attributes:
        after: the state after it; the very same object if nothing changes.
        names: the names of `after`, in order; None keeps those before.
        emits: what subscribers come to see, in order.
        opens: channels that come into being.
        closes: topics whose channels are gone, with what was still owed to them.
        drains: topics whose channels are gone; what was owed to them may still be seen until things settle.
        clears: topics whose channels lose everything that was on its way, owed or optional.
        lingers: topics whose channels owe nothing any more; what was on its way may still be seen until things settle.
        withdraws: topics whose channels lose their optional messages; what is owed stays.
        rules: ids of the rules that justify it.
        assumes: the readings without which it does not happen.
        answer: for the outcome of a call, what is answered.
        refs: the names that the answer mentions, in order.
        label: what happened, for people.
        applied: False for an outcome that may still take effect after its answer (a deadline that passed).
        kinds: the kinds of the names that it adds, in order, for a reference that makes names up.
        alone: for a step that happens unseen, and could be repeated for ever: it is considered only if a channel has
            shown all that there was before it, or if nobody watches.
    """

    after: State
    names: tuple[int, ...] | None = None
    emits: tuple[Emission, ...] = ()
    opens: tuple[Opening, ...] = ()
    closes: tuple[Hashable, ...] = ()
    drains: tuple[Hashable, ...] = ()
    clears: tuple[Hashable, ...] = ()
    lingers: tuple[Hashable, ...] = ()
    withdraws: tuple[Hashable, ...] = ()
    rules: tuple[str, ...] = ()
    assumes: tuple[Assumption, ...] = ()
    answer: Answer | None = None
    refs: tuple[int, ...] = ()
    label: str = ""
    applied: bool = True
    kinds: tuple[str, ...] = ()
    alone: bool = False

    def adds(self, names: int) -> int:
        """How many names it adds to a state that has so many."""
        referred = (*(self.names or ()), *self.refs, *[opening.ref for opening in self.opens])
        return max(0, max(referred, default=-1) + 1 - names)

    @property
    def ends(self) -> tuple[Hashable, ...]:
        """The topics whose channels are gone, whatever becomes of what they owed."""
        return (*self.closes, *self.drains) if self.drains else self.closes


@value
class Match:
    """One way in which a message shows a view.

    Attributes:
        assumes: the readings without which it does not.
        names: each position among the names of the view, paired with a position among those of the message.
        rules: ids of the rules that it exercises.
    """

    assumes: tuple[Assumption, ...] = ()
    names: tuple[tuple[int, int], ...] = ()
    rules: tuple[str, ...] = ()


@frozen
class Unowed:
    """Why a message is not due: the rules that it breaks, the nearest first, and what is wrong."""

    rules: tuple[str, ...]
    says: str


@frozen
class Mismatch:
    """Why a message does not show a view: the rule that it breaks, and what is wrong.

    It is `near` if the message would show the view but for that: then it is likelier meant than one that is not owed.
    It is `far` if the message is about something else, and shows something else of that: then any is likelier meant.
    """

    rule: str
    says: str
    near: bool = False
    far: bool = False
