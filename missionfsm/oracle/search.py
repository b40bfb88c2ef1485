"""A search for explanations of recorded events, for where a belief would have to imagine too much.

The belief holds all explanations at once. That is right while they are few. Where calls that are lost, timed out or
overlap make them many, a window of the events is searched instead: some explanations are followed as far as they go,
nearest first, and the others only where those fail. What was tried once is not tried again: the same calls have taken
effect, the state is the same, and no more is assumed. A `Lookahead` leaves out what cannot lead on.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TypeVar

from attrs import define, field

from missionfsm.kernel.history import Called, Driven, Ended, Received, Returned
from missionfsm.kernel.readings import UNCONSTRAINED, choose
from missionfsm.kernel.transport import REDELIVERED, TR_05
from missionfsm.oracle.calls import CallSearch, OtherwiseError, Standing, are_calls_alone
from missionfsm.oracle.coming import Excerpt, Horizon
from missionfsm.oracle.explanation import Explanation, Lost, within
from missionfsm.oracle.kinds import Kinds
from missionfsm.oracle.lookahead import Lookahead
from missionfsm.oracle.memory import ENTRY, MEMORY, bytes_besides
from missionfsm.oracle.replay import Replay
from missionfsm.oracle.restarts import NONE, Restarts, apparent_restarts
from missionfsm.oracle.shelf import Depot
from missionfsm.oracle.subsumption import prune
from missionfsm.oracle.successors import ExhaustedError, Place, Successor, Successors, place, weight
from missionfsm.oracle.symbols import Observer, names_of
from missionfsm.oracle.transition import TransitionFunction

T = TypeVar("T")
WIDTH, WIDER = 1, 8
"""How many explanations are followed at once: at first, and where half of the budget was spent on following so many.

What was wrong long before is found out sooner where those that are followed differ in it.
"""

EFFORT = 300
"""How much of the budget goes into finding more than one explanation of an event at once, the first time."""


LOOK_BACK = 128
"""How many events are looked back to where more of them are known."""

USUAL, USUAL_EACH = 5_000, 50
"""How many explanations may be looked at where every ambiguity is read in its usual way, and how many more an event."""

FURTHER = 64
"""How many events behind the one where that leads nowhere are looked at under all readings."""

NEAR = 8
"""How many events before the one where the usual readings lead nowhere are looked at for those to be given up."""

FIRST_LOOK = 3
"""How many times the budget for the usual readings goes at first into learning which others there are."""

NO_FURTHER = 300
"""How many explanations are looked at without coming any further, where more events will come that tell more."""

CHEAP = 16
"""Which part of the budget goes into explaining events without the restarts that they seem to show."""

PUT_OFF = 64
"""How many explanations under unusual readings are put off at once."""


@define(eq=False, slots=True)
class _Tried:
    """An explanation that was followed, and leads nowhere.

    Attributes:
        assumed, lost: what it assumes, and the lost calls that it has left.
        depends: the bits of the ambiguities on which that depends; all of them while it is not known.
    """

    assumed: int
    lost: Lost
    depends: int = UNCONSTRAINED


@define(eq=False)
class Layer:
    """Some explanations of all events before one, and those after it that were not looked at yet.

    Attributes:
        rules: what was exercised by the event before.
        more: what else explains the event as well; None where that is all.
        begun: whether the event was looked at; once it was too dear to look at all of it, it is looked at anew.
        effort: how much of the budget goes into finding more than one explanation at once.
        tried: what is remembered of the explanations.
        depends: the bits of the ambiguities on which it has depended what comes of them.
        withheld: whether unusual readings were not looked at.
    """

    explanations: tuple[Explanation, ...]
    rules: tuple[str, ...] = ()
    more: Iterator[Successor] | None = field(default=None, repr=False)
    begun: bool = False
    effort: int = EFFORT
    tried: tuple[_Tried, ...] = field(default=(), repr=False)
    depends: int = 0
    withheld: bool = False

    @property
    def unfinished(self) -> bool:
        """Whether there may be other explanations of the event after these that were not looked at."""
        return self.more is not None or self.withheld


class Search:
    """Looks for explanations of a window of events.

    Args:
        transitions: the transition function.
        start: all explanations of what was before.
        excerpt: the events of the window.
        budget: how many explanations may be looked at.
        memory: how many bytes those may take, by estimate, that are remembered.
        kinds: the kinds of calls that other searches through the same window have met.

    Attributes:
        whole: whether no events come after those of the window.
        width: how many explanations are followed at once.
        reached: how many events were explained that have some more behind them in mind.
        calls_alone: whether it looks at nothing but which calls took effect (see `missionfsm.oracle.calls`).
        beyond: the positions of events that the system itself does not explain; what lies between it and the recording
            is asked for them.
        strictly: the position of the first event that the system itself does not explain, once that is known.
        restarts: those that are taken for granted.
    """

    def __init__(
        self,
        transitions: TransitionFunction,
        start: Sequence[Explanation],
        excerpt: Excerpt,
        budget: int,
        memory: int = MEMORY,
        kinds: Kinds | None = None,
    ) -> None:
        self.transitions = transitions
        self.successors: Successors = transitions.successors
        self._start = tuple(start)
        self._excerpt = excerpt
        self._symbols = symbols = excerpt.symbols
        ambiguities = transitions.spec.ambiguities
        self._defaults = choose(ambiguities) & functools.reduce(operator.or_, (one.group for one in ambiguities), 0)
        # Of several explanations one is followed first that reads most in its usual way.
        usual = [one.assumed & self._defaults for one in start]
        self._required, self._built = max(usual, key=int.bit_count, default=0), 0
        self.budget = budget
        self._memory = memory
        self._bytes = 0
        self.whole = False
        self.width = WIDTH
        self.layers: list[Layer] = []
        self._end: tuple[CallSearch, Standing] | None = None
        self._explained: int | None = None
        self.reached = 0
        self.beyond: set[int] = set()
        self.strictly: int | None = None
        self.restarts = NONE
        self._rules: dict[int, tuple[str, ...]] = {}
        self._alone = self._stopped = self._hurries = False
        self._depot = self._new_depot()
        self._named: dict[int, int] = {}
        self._read = 0
        self._kinds = kinds or Kinds(self.successors)
        self.calls_alone = are_calls_alone(self.successors, symbols, self._start)

    def told(self) -> tuple[list[Layer], list[tuple[str, ...]]]:
        """The layers, and of each event that was explained the rules that it exercised.

        Where nothing but calls was looked at, there are two layers: before all events, and behind them.
        """
        if self._end is None:
            return self.layers, [layer.rules for layer in self.layers[1:]]
        replay = Replay(*self._end)
        # Other orders may explain it as well; none of them was looked at.
        return [Layer((one,), more=iter(())) for one in (replay.start, replay.explanation)], replay.exercised

    def explain(self, horizon: int) -> bool:
        """Whether the first events up to a horizon are explained.

        Every ambiguity is first read in its usual way: few implementations need many other readings. Which ones, is
        learned where that leads nowhere, by looking at all readings of what is before and a little behind that. Where
        that is too dear, those are given up that kept anything from being looked at near there, or all of them, with
        more events in mind.

        Raises:
            ExhaustedError: it costs more than the budget.
        """
        if self.calls_alone:
            try:
                return self._spending_on_calls(horizon)
            except OtherwiseError:
                self.calls_alone = False
        usual, may_give_up = min(USUAL + USUAL_EACH * horizon, self.budget), self.whole
        while self._required:
            if self._explains_usually(horizon, usual):
                return True
            usual -= self.successors.spent
            required, stuck, blamed = self._required, self._stuck, self._ahead.blamed
            if may_give_up and self._gives_up_few(horizon):
                return True
            may_give_up = False
            nearer, effort = min(stuck + FURTHER, horizon), USUAL + USUAL_EACH * horizon
            found = self._explains_under(0, nearer, min(FIRST_LOOK * effort, self.budget))
            if found is None and self.whole:
                fewer = required & ~_near(blamed, stuck)
                if self._explains_under(fewer, horizon, effort) or self._explains_under(0, horizon, effort):
                    return True
                found = self._explains_under(0, nearer, self.budget)
            if found is None:
                self._required = required  # nothing was learned
                raise ExhaustedError
            if not found:
                return False
            left = self._left_of(required)
            self._required = left if left != required and usual > 0 else 0
        return self._go_on(horizon, self.budget)

    def _explains_usually(self, horizon: int, budget: int) -> bool:
        """Whether the first events up to a horizon are explained under the readings that are required; no, if too dear.

        Raises:
            ExhaustedError: it is too dear, and what comes later tells more than other readings do.
        """
        try:
            return self._go_on(horizon, budget)
        except ExhaustedError:
            if not self.whole:
                raise
            return False

    def _left_of(self, required: int) -> int:
        """What is left of required readings in all that explains the events up to the last one that was reached."""
        return functools.reduce(operator.and_, (one.assumed for one in self.layers[-1].explanations), required)

    def _gives_up_few(self, horizon: int) -> bool:
        """Whether the first events up to a horizon are explained once few readings are given up.

        Those are given up, again and again, that kept anything from being looked at near where it led no further.
        """
        most, left = NO_FURTHER + USUAL_EACH * horizon, USUAL + USUAL_EACH * horizon
        self._hurries = True
        try:
            while left > 0:
                fewer = self._required & ~_near(self._ahead.blamed, self._stuck)
                if fewer == self._required:
                    break
                if self._explains_under(fewer, horizon, min(most, left)):
                    return True
                left -= self.successors.spent
        finally:
            self._hurries = False
        return False

    def _explains_under(self, required: int, horizon: int, budget: int) -> bool | None:
        """Whether the first events up to a horizon are explained where readings have to stay; None: too dear."""
        self._required = required
        try:
            return self._go_on(horizon, budget)
        except ExhaustedError:
            return None

    def _go_on(self, horizon: int, budget: int) -> bool:
        """Whether the first events up to a horizon are explained under the readings that are required.

        It goes on where it has explained those up to a nearer one: what it tried before leads nowhere still.
        """
        before, self._explained = self._explained, None
        anew = self._reads_on() or before is None or before > horizon or self._built & ~self._required or self._alone
        last = self.whole and (self._alone or horizon == len(self._symbols))
        known = Horizon(horizon, last, self.beyond | self.restarts.shown)
        self._ahead = ahead = Lookahead(self.transitions.spec, self._excerpt, known, self._rules, self._depot)
        self._horizon, self._built = horizon, self._required
        self.successors.reset()
        if anew:
            self._begin_anew()
        else:
            ahead.required = self._required
            self._drop_what_leads_nowhere()
        self._stuck = 0
        try:
            found = self._widening(budget)
        finally:
            self._stuck, self._stopped = max(self._stuck, len(self.layers) - 1), ahead.stopped
            self.reached = max(self.reached, min(self._stuck, horizon))
        self._explained = horizon if found else None
        return found

    def _reads_on(self) -> bool:
        """Note where calls and answers name something for the last time. Whether that was put away."""
        if self._depot is None:
            return False
        names: set[int] = set()
        for position in range(self._read, len(self._symbols)):
            if self._symbols[position][0] in (Called, Returned, Driven):
                named = names_of(self._symbols[position])
                names.update(named)
                self._named.update(dict.fromkeys(named, position))
        self._read = len(self._symbols)
        if self._depot.names.isdisjoint(names):
            return False
        self._depot = self._new_depot()
        return True

    def _new_depot(self) -> Depot | None:
        spec = self.transitions.spec
        return None if spec.anywhere or spec.others or not spec.shelving else Depot(spec.shelving)

    def _begin_anew(self) -> None:
        """Forget what was tried, and stand before the first event; no reading has to stay for what was before."""
        ahead = self._ahead
        self._bytes, ahead.at, ahead.required = 0, 0, 0
        start = (ahead.narrowed(one) for one in self._start)
        self.layers = [Layer(tuple(one for one in start if one))]
        self._tried: list[dict[Place, list[_Tried]]] = []

    def _widening(self, budget: int) -> bool:
        """Look for explanations on a budget; once half of it is spent, for several of an event at once."""
        if not self.whole or self._hurries:
            return self._spending(self._explain, budget)
        try:
            return self._spending(self._explain, budget // 2)
        except ExhaustedError:
            self._begin_anew()
        width, self.width = self.width, max(self.width, WIDER)
        try:
            return self._spending(self._explain, budget)
        finally:
            self.width = width

    def _drop_what_leads_nowhere(self) -> None:
        """Go back before the explanations that cannot lead to what is known now; only the last ones are looked at."""
        layers, ahead = self.layers, self._ahead
        for position in range(max(1, len(layers) - LOOK_BACK), len(layers)):
            ahead.at = position
            if not any(ahead.narrowed(one) for one in layers[position].explanations):
                del layers[position:]
                layers[-1].depends, layers[-1].withheld = UNCONSTRAINED, True
                return

    def _spending_on_calls(self, horizon: int) -> bool:
        """Whether a window of calls alone is explained up to a horizon. Raises OtherwiseError if it is not one."""
        successors = self.successors
        budget = successors.budget
        successors.budget = successors.limit = min(self.budget, self._memory // ENTRY)
        successors.reset()
        try:
            self._end = None
            for start in self._start:
                search = CallSearch(self._kinds, self._symbols, horizon, start)
                end = search.path()
                self.reached = max(self.reached, search.reached)
                if end:
                    self._end = search, end
                    return True
        finally:
            successors.budget = successors.limit = budget
        return False

    def _spending(self, work: Callable[[], T], limit: int) -> T:
        """Do some work on a budget of the search."""
        successors = self.successors
        budget, successors.budget, successors.ahead = successors.budget, limit, self._ahead
        successors.limit = limit
        try:
            return work()
        finally:
            successors.ahead, successors.budget, successors.limit = None, budget, budget

    def _enter(self, found: tuple[Successor, ...]) -> None:
        rules = tuple(dict.fromkeys(rule for one in found for rule in one.rules))
        self.layers.append(Layer(tuple(one.explanation for one in found), rules, tried=tuple(self._entering)))

    def _leave(self) -> None:
        """Go back from explanations that lead nowhere, and remember on which readings that depends."""
        failed = self.layers.pop()
        for one in failed.tried:
            one.depends = failed.depends
        if self.layers:
            self.layers[-1].depends |= failed.depends

    def _explain(self) -> bool:
        self._tried += [{} for _ in range(self._horizon + 1 - len(self._tried))]
        self._ahead.required = self._required
        layers, advanced = self.layers, self.successors.spent
        while len(layers) <= self._horizon:
            if not layers:
                if self._ahead.stopped and not self._ahead.last:  # what was not imagined may explain them
                    raise ExhaustedError
                return False
            position = len(layers) - 1
            if position > self._stuck:
                self._stuck, advanced = position, self.successors.spent
            elif (self._hurries or not self.whole) and self.successors.spent - advanced > NO_FURTHER:
                raise ExhaustedError
            self._ahead.at = position
            found = self._next(layers[-1], position)
            if found:
                self._enter(found)
            else:
                self._leave()
        return True

    def _next(self, here: Layer, position: int) -> tuple[Successor, ...]:
        """Some more explanations of the next event; none where there are no others."""
        ahead, tried, successors = self._ahead, self._tried[position + 1], self.successors
        ahead.consulted, ahead.depends, ahead.withheld = 0, 0, False
        if not here.begun:
            self._begin(here, position)
        self._entering: list[_Tried] = []
        found: list[Successor] = []
        begun = successors.spent
        if self._hurries:
            successors.limit = min(successors.budget, begun + 2 * NO_FURTHER)
        try:
            while here.more is not None and not found:
                for one in here.more:
                    narrow = self._narrowed_behind(one.explanation, position)
                    if narrow and not self._outdone(tried, narrow):
                        self._remember(narrow, here.explanations[0])
                        found.append(one if narrow is one.explanation else Successor(narrow, one.rules))
                        successors.limit = min(successors.budget, begun + here.effort)
                    if len(found) >= self.width:
                        break
                else:
                    here.more = None
        except ExhaustedError:
            if not found or successors.spent > successors.budget:
                raise
            # It begins anew where these lead nowhere; what was tried is passed over then.
            here.begun, here.effort = False, here.effort * 4
        finally:
            successors.limit = successors.budget
            here.depends |= ahead.depends
            here.withheld |= ahead.withheld
        return prune(successors, found)

    def _begin(self, here: Layer, position: int) -> None:
        """Look at the next event from the beginning."""
        here.begun = True
        kind, *what = self._symbols[position]
        explains = self._explaining(position)
        before = [one for one in here.explanations if not self._ahead.withholds(one.assumed)]
        if self._depot and self._concerns_all(position):
            before = list(map(self._depot.whole, before))
        here.more = self._usual_first(before, lambda: explains(before, kind, *what))
        if self._reckons_at(position):
            here.depends = UNCONSTRAINED  # what lies between the system and the recording notes nothing

    def _concerns_all(self, position: int) -> bool:
        """Whether an event may tell of what was put away, or something besides the system is asked for it."""
        kind, *what = self._symbols[position]
        shelving = self.transitions.spec.shelving
        asks = kind is Called and shelving is not None and shelving.asks(what[0])
        return asks or kind in (Received, Ended) or self._reckons_at(position)

    def _explaining(self, position: int) -> Observer[Iterator[Successor]]:
        """What explains the event in a place."""
        if position in self.beyond:
            return self.transitions.beyond
        if position not in self.restarts:
            return self.transitions.explained
        return functools.partial(self.transitions.restarting, surely=position in self.restarts.surely)

    def _usual_first(
        self, before: Sequence[Explanation], explains: Callable[[], Iterable[Successor]]
    ) -> Iterator[Successor]:
        """What is found, but first what every ambiguity may be read in its default way for, as far as before.

        Most implementations read most of them so. What is put off is bounded, and so is what is spent on finding more
        than that: once it is too dear, what was put off comes first, and then all is looked for anew, on more. What was
        tried is passed over then.
        """
        successors, usual, effort = self.successors, 0, EFFORT
        for explanation in before:
            usual |= explanation.assumed & self._defaults
        while True:
            off: list[Successor] = []
            begun, found = successors.spent, iter(explains())
            try:
                while one := self._found_on(found, begun + effort if off else successors.budget):
                    if usual & ~one.explanation.assumed:
                        off.append(one)
                    else:
                        yield one
                        begun = successors.spent
                    if len(off) >= PUT_OFF:
                        yield from off
                        off.clear()
                        begun = successors.spent
            except ExhaustedError:
                if not off or successors.spent > successors.limit:
                    raise
                yield from off
                effort *= 4
            else:
                yield from off
                return

    def _found_on(self, found: Iterator[Successor], limit: int) -> Successor | None:
        """The next one that is found, None where there is no other.

        Raises:
            ExhaustedError: it costs more than there is, or more than a limit.
        """
        successors = self.successors
        successors.limit, usual = min(successors.limit, limit), successors.limit
        try:
            return next(found, None)
        finally:
            successors.limit = usual

    def _narrowed_behind(self, explanation: Explanation, position: int) -> Explanation | None:
        """An explanation of an event, as far as it leads on; None where it does not."""
        ahead = self._ahead
        if ahead.withholds(explanation.assumed):
            return None
        ahead.at = position + 1
        narrow = ahead.narrowed(explanation)
        ahead.at = position
        if narrow is None or self._depot is None:
            return narrow
        return self._depot.without(narrow, lambda name: self._named.get(name, -1) > position)

    def brought(self, explanation: Explanation) -> Explanation:
        """An explanation of a layer with all that it has put away."""
        return explanation if self._depot is None else self._depot.whole(explanation)

    def _reckons_at(self, position: int) -> bool:
        """Whether something besides the system itself is asked for an event."""
        spec, (kind, *what) = self.transitions.spec, self._symbols[position]
        aside = position in self.beyond or position in self.restarts
        return aside or spec.anywhere or spec.others or (kind is Received and REDELIVERED in what[2])

    def _outdone(self, tried: dict[Place, list[_Tried]], explanation: Explanation) -> bool:
        """Whether it leads nowhere since another one at the same point does not; notes it otherwise.

        The other one had all the lost calls, and assumed no more of what that depends on.
        """
        self.successors.spend(weight(explanation))
        others = tried.setdefault((self._ahead.state(explanation), *place(explanation)[1:]), [])
        for one in others:
            if not explanation.assumed & ~one.assumed & one.depends and within(explanation.lost, one.lost):
                self._ahead.depends |= one.depends
                return True
        entry = _Tried(explanation.assumed, explanation.lost)
        others.append(entry)
        self._entering.append(entry)
        return False

    def _remember(self, explanation: Explanation, before: Explanation) -> None:
        """Count an explanation that is going to be remembered. Raises ExhaustedError when it is too much."""
        self._bytes += bytes_besides(explanation, before)
        if self._bytes > self._memory:
            self.successors.spent = self.successors.budget + 1
            raise ExhaustedError

    def first_unexplained(self) -> int | None:
        """The position of the first event that nothing explains, given those before it; None where all are explained.

        The layers are those of the events before it.

        Raises:
            ExhaustedError: it costs more than the budget.
        """
        restarts = apparent_restarts(self._symbols, self._excerpt.latest) if self.transitions.spec.transport else NONE
        if not restarts.shown:
            return self._first_unexplained_leniently()
        if not self.restarts.shown and self._explains_without_restarts():
            return None
        supposed = self._first_unexplained_after(restarts)
        if supposed is not None and supposed == len(self._symbols):
            return None
        self._suppose(NONE)
        found = self._first_unexplained_leniently()
        if found is None or supposed is None or supposed <= found:
            return found
        self._suppose(restarts)
        self._explain_alone(supposed)
        return supposed

    def _explains_without_restarts(self) -> bool:
        """Whether all events are explained by the system itself, as far as that is cheap to find out."""
        horizon, budget, required = len(self._symbols), self.budget // CHEAP, self._required
        found = self._explains_under(required, horizon, budget) or self._explains_under(0, horizon, budget)
        self._required = required
        return found is True

    def _first_unexplained_after(self, restarts: Restarts) -> int | None:
        """The position of the first event that nothing explains where a robot has restarted; None if that is too dear.

        It is that behind the last one where everything is explained.
        """
        self._suppose(restarts)
        try:
            found = self._first_unexplained_leniently()
        except ExhaustedError:
            return None
        return len(self._symbols) if found is None else found

    def _suppose(self, restarts: Restarts) -> None:
        if restarts != self.restarts:
            self.restarts, self._explained, self.reached = restarts, None, 0
            self._required &= ~TR_05["b"].group
            self.beyond.clear()

    def _first_unexplained_leniently(self) -> int | None:
        """The same where what lies between the system and the recording is asked where the system does not explain."""
        found = self._first_unexplained()
        while found is not None and found not in self.beyond and self.transitions.reckons:
            if self.transitions.is_hopeless(*self._symbols[found], leniently=True):
                break
            if not self.beyond and not self.restarts.shown:
                self.strictly = found
            self.beyond.add(found)
            self._explained = None
            found = self._first_unexplained()
        return found

    def _first_unexplained(self) -> int | None:
        is_hopeless, beyond = self.transitions.is_hopeless, self.beyond
        hopeless = (
            at
            for at, symbol in enumerate(self._symbols)
            if symbol[0] is not Called and at not in beyond and is_hopeless(*symbol)
        )
        bad, stride = next(hopeless, len(self._symbols)), 1
        if self._explain_alone(bad):
            return None if bad == len(self._symbols) else bad
        good = self.reached
        while good + 1 < bad:
            middle = min(good + stride, (good + bad) // 2) if stride else (good + bad) // 2
            if self._explain_alone(middle):
                good, stride = middle, stride * 2
            else:
                bad, stride = middle, 0
        self._explain_alone(good)
        return good

    def _explain_alone(self, horizon: int) -> bool:
        """See `explain`; where everybody who sees what happens is too far behind, as if nothing came after these.

        What nobody comes to see can be imagined then. Only where no events come after those of the window.
        """
        try:
            return self.explain(horizon)
        except ExhaustedError:
            if not (self.whole and self._stopped and horizon < len(self._symbols)):
                raise
        self._alone, self._explained = True, None
        try:
            return self.explain(horizon)
        finally:
            self._alone, self._explained = False, None

    @property
    def exact(self) -> bool:
        """Whether the last layer has every explanation there is."""
        return self._end is None and not any(layer.unfinished for layer in self.layers[:-1])


def _near(blamed: Mapping[int, int], stuck: int) -> int:
    """The bits of the readings that kept anything from being looked at near the event where nothing led further.

    Args:
        blamed: the bits of those that did, by the position of the next event.
        stuck: how far it led.
    """
    return functools.reduce(operator.or_, (bits for at, bits in blamed.items() if at >= stuck - NEAR), 0)
