"""What may happen to a state, and what is seen of it: steps, the messages that they owe, and what shows them."""

from __future__ import annotations

from collections.abc import Hashable

from attrs import frozen

from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.terms import State, View
from missionfsm.kernel.values import value

ONCE_HAD = -1
"""In the place of the position of a name, for outcomes: the state has it no more.

References in a `Step` count otherwise: there -1 is the first name that the event brought along. The oracle numbers
observed names; its `GONE` is neither.
"""


@value
class Emission:
    """A message that a step owes to every channel that its topic concerns.

    `refs` are the names that the view mentions, in its order, referred to as in `Step`; None stands for all names of
    the state after the step.
    `only` is the assumption without which the message is not sent at all; such a message may always be left out.
    `optional` is a message that may be left out whatever is assumed, and that may come at any time, settled or not,
    until something later is shown. One that `stays` is optional as well, and may come more than once.
    `certain` is a message that comes even where the state after the step does not last.
    """

    topic: Hashable
    view: View
    refs: tuple[int, ...] | None = None
    only: Assumption | None = None
    optional: bool = False
    stays: bool = False
    certain: bool = False


@value
class Opening:
    """A channel that a step opens: its topic, and its name as a reference like those in `Step.names`.

    `owed` are the messages that it starts with. `kind` is what its name is one of: ``stream`` or ``connection``.
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
        after: the state after it; the very same object where nothing changes.
        names: the names of `after`, in order; None keeps those before.
        emits: what subscribers come to see, in order.
        opens: channels that come into being.
        closes: topics whose channels are gone, with what was still owed to them.
        drains: topics whose channels are gone; what they owed may be seen until things settle, and need not be.
        clears: topics whose channels owe nothing any more, and offer nothing: what was on its way is lost.
        lingers: topics whose channels owe nothing any more; what they owed or offered may be seen until things settle.
        withdraws: topics whose channels offer nothing any more; what they owe stays.
        rules: ids of the rules that justify it.
        assumes: the readings without which it does not happen.
        answer: for the outcome of a call, what is answered.
        refs: the names that the answer mentions, in order.
        label: what happened, for people.
        applied: False for an outcome that may still take effect after its answer (a deadline that passed).
        kinds: what the names that it adds are names of, in order, for a model that makes them up.
        alone: for one that happens unseen: it is imagined only where somebody has been shown all there was before it,
            or nobody watches. It is for what could go on and on, one such step after the other.
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
        """How many names it adds to so many that the state before it has."""
        referred = (*(self.names or ()), *self.refs, *[opening.ref for opening in self.opens])
        return max(0, max(referred, default=-1) + 1 - names)

    @property
    def ends(self) -> tuple[Hashable, ...]:
        """The topics whose channels are gone, whatever becomes of what they owed."""
        return (*self.closes, *self.drains) if self.drains else self.closes


@value
class Match:
    """One way in which a message can be the showing of a view.

    `names` pairs each position among the names of the view with a position among those of the message.
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
    """Why a message cannot be the showing of a view: the rule that it breaks, and what is wrong.

    A `near` one is what is owed but for that, so that it is likelier meant than a message that nothing owes.
    """

    rule: str
    says: str
    near: bool = False
