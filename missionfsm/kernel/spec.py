"""What a specification is: a nondeterministic labelled transition system whose steps say what they assume.

The laws that every `Spec` obeys (``tests/test_laws.py`` holds the shipped ones to them):

1. *Pure.* Its functions return the same for the same arguments, in the same order, under any hash seed.
2. *Total.* Every call of the alphabet has at least one outcome in every reachable state, under every choice of
   readings; so has every drive, or it is said not to apply by having no step.
3. *A refusal changes nothing.* An outcome whose code is neither OK nor a failure keeps the state, emits nothing.
4. *Names are kept apart.* A step says which names of the state it keeps and how many it adds; every name that an
   answer or a message mentions is one of those; a state has `names(state)` of them.
5. *Urgency ends.* Urgent steps alone come to rest after finitely many.
6. *Invariants* hold in every reachable state, every *possibility* is met in some.
7. *What is shown is recognised.* A message made from a view under some choice of readings is accepted for that view,
   with assumptions that agree with the choice.

Attributes that are functions are described by what they take and what they give: ``(state, event) → steps``.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Hashable, Iterable, Mapping

from attrs import evolve, field, frozen

from missionfsm.kernel.abstraction import Abstraction
from missionfsm.kernel.chart import Chart
from missionfsm.kernel.focus import Focus
from missionfsm.kernel.history import Event
from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.rules import Citation, Operation, Rule, Waiver, promise
from missionfsm.kernel.shelving import Shelving
from missionfsm.kernel.step import Match, Mismatch, Step, Unowed
from missionfsm.kernel.terms import Content, Incident, Refs, Request, Shape, State, Topic, View, World


@frozen
class Failure:
    """That a call may fail with a code in any state, although no rule refuses it.

    Attributes:
        assumes: the readings under which it may.
        open_ended: whether the call may take effect all the same, at once or later (a deadline that passed).
        drive: the name of the drive that brings it about; a tester who has that drive sees it for no other reason.
    """

    assumes: tuple[Assumption, ...] = ()
    open_ended: bool = False
    drive: str | None = None


@frozen
class Delivery:
    """How messages of a topic travel.

    Attributes:
        skips: the assumption under which only the latest of several owed messages needs to be sent; None: never.
        repeats: the assumption under which the last message may come again; None: never.
        echoes: the assumption under which the last message may come again with its old number; None: never.
        ends: each status that may end the channel, with the readings under which it may.
        unowed: ids of the rules that a message breaks which is not owed, and a message which is owed and does not come;
            the nearest first.
        named: ids of the rules that a message breaks which names other things than it is about.
        first: ids of the rules that are broken if the first message does not come; those in `unowed` if there are none.
        unending: ids of the rules that are broken if the channel ends although it may not; the operation's implied
            rule if there are none.
        malformed: ids of the rules that a message breaks which cannot be read.
        every_time: whether an owed message has to come even if it says the same as the one before, as lines do.
        stands: whether a message stays owed until it is shown or passed over: no step takes it back.
        lasts: whether no step closes the channel.
        operation: name of the operation that opens the channel, for rules that stand in the section of each.
    """

    skips: Assumption | None = None
    repeats: Assumption | None = None
    echoes: Assumption | None = None
    ends: Mapping[str, tuple[Assumption, ...]] = field(factory=dict)
    unowed: tuple[str, ...] = ()
    named: tuple[str, ...] = ()
    first: tuple[str, ...] = ()
    unending: tuple[str, ...] = ()
    malformed: tuple[str, ...] = ()
    every_time: bool = False
    stands: bool = False
    lasts: bool = False
    operation: str = ""


@frozen
class Unwatched:
    """A drive may happen without a line that says so, in a log that need not hold every event.

    Attributes:
        reading: the question whether it happened: "a" is no; "b", which is flagged, is yes.
        world: world → the same world, in which the drive may happen by itself.
    """

    reading: Ambiguity
    world: Callable[[World], World]


@frozen
class Drive:
    """Something that a tester may be able to make happen.

    Attributes:
        name: what adapters and histories call it.
        steps: (state, event, refs) → the ways in which it happens; none if it does not apply. `refs` are the positions
            of the event's names among those of the state, as for outcomes.
        by_itself: the events that the environment may produce unseen if no tester commands the drive.
        cite: where the documents speak of it, if they do.
        renumbers: event → the tracks whose numbers start over with it, on every channel.
        shows_again: event → the tracks whose last message may come again with its number, on every channel.
        revives: whether it may bring back names of things that are gone.
        ends: whether it ends a channel. Messages that arrive on the channel while it is being done came before the end.
        impossible: ids of the rules that are broken if it is said to have happened although it could not.
        waits: state → whether an earlier drive of this kind still waits there; the tester does not drive another then.
        later: for a drive that only lets time pass: event → the words before what comes next ("2 s later").
        unwatched: how it may happen unseen in logs of somebody who does not command it; None: only as `by_itself` says.
        undriven: for a drive that nobody commands: world → the same world, in which it may happen unseen at any time.
        heeded: event → what `Spec.foresees` is told of it beside the operations; None: nothing.
        elapses: for a drive that lets time pass: (seconds between two lines of a log, None if the log does not say;
            after how many something is late, None if nobody knows) → the event that this much time passed although
            nobody let it pass.
    """

    name: str
    steps: Callable[[State, Incident, Refs], Iterable[Step]]
    by_itself: tuple[Hashable, ...] = ()
    cite: Citation | None = None
    renumbers: Callable[[Incident], tuple[Hashable, ...]] | None = None
    shows_again: Callable[[Incident], tuple[Hashable, ...]] | None = None
    revives: bool = False
    ends: bool = False
    impossible: tuple[str, ...] = ()
    waits: Callable[[State], bool] = lambda _: False
    later: Callable[[Incident], str] | None = None
    unwatched: Unwatched | None = None
    undriven: Callable[[World], World] | None = None
    heeded: Callable[[Incident], str] | None = None
    elapses: Callable[[float | None, float | None], Incident] | None = None


@frozen
class Invariant:
    """A condition on states that holds in all reachable ones, or (a possibility) in at least one."""

    name: str
    says: str
    holds: Callable[[State], bool]


@frozen
class Parting:
    """How a system falls into parts that share nothing but the readings that they follow.

    Attributes:
        parts: (world, names of the drives that a tester commands) → the parts; none if the system does not fall apart.
        part: (system, part) → the system as that part sees it.
        whose: event → the part that it is about; None if it is about all of them.
    """

    parts: Callable[[World, frozenset[str]], tuple[Hashable, ...]]
    part: Callable[[Spec, Hashable], Spec]
    whose: Callable[[Event], Hashable | None]


Things = tuple[tuple[int, Hashable], ...]
"""Names, each with what is known of the thing that it names."""


@frozen
class Glimpses:
    """What messages tell of a system whose state is not known.

    Attributes:
        world: state → the world that it is in, as `Spec.initial` takes it.
        states: (world, content) → the states that a well-formed message may show, each with its view. The names of each
            state are those of the content, as `Spec.matches` pairs them.
        samples: world → states that stand for all others: in any state, a request is answered as in one of them.
        topic: content → the topic of a channel that shows it.
        things: (state, its names) → what every thing in it keeps as long as it is there, in the order of a message.
        shown: (view, its names) → the same, of what was shown on a channel; a view tells more than a state.
        follows: (world, things that were there, content, its names) → what is assumed if the message shows what calls
            may have made of those things; None if no calls can.
    """

    world: Callable[[State], Hashable]
    states: Callable[[World, Content], tuple[tuple[State, View], ...]]
    samples: Callable[[World], tuple[State, ...]]
    topic: Callable[[Content], Hashable]
    things: Callable[[State, tuple[int, ...]], Things]
    shown: Callable[[View, tuple[int, ...]], Things]
    follows: Callable[[World, Things, Content, tuple[int, ...]], tuple[Assumption, ...] | None]


@frozen
class Middle:
    """How a system is judged by a log that does not hold its beginning.

    Attributes:
        glimpses: how its state becomes known from messages; None if no call changes the state, so
            that only what happened unseen is not known.
        undriven: names of the drives that may have happened before the log, so that what they do may happen unseen.
        used: the initial state → one of a system that was in use before, from which `urgent` leads to every state in
            which a log may begin, with the channels that are open. Nothing more is unknown then. None if there is none.
    """

    glimpses: Glimpses | None = None
    undriven: frozenset[str] = frozenset()
    used: Callable[[State], State] | None = None


def _operations(given: Mapping[str, Operation] | Iterable[Operation]) -> Mapping[str, Operation]:
    return given if isinstance(given, Mapping) else {one.name: one for one in given}


def _drives(given: Mapping[str, Drive] | Iterable[Drive]) -> Mapping[str, Drive]:
    return given if isinstance(given, Mapping) else {one.name: one for one in given}


@frozen(eq=False)
class Spec:
    """A system as a nondeterministic labelled transition system.

    Every system has the first three; the others have a default, which says that there is nothing of the kind.

    Attributes:
        system: its name on the command line.
        title: what it is, in a few words.
        initial: world → the state that it begins in. A world is the parameters of `reset`, as a value of the system.
        operations: what callers may ask, by name; an iterable of operations will do.
        outcomes: (state, request, refs) → every answer that the documents allow, each with the state after it. `refs`
            are the positions of the request's names among those of the state: None for a name that the state does not
            have, `ONCE_HAD` for one that it had once, if the spec `recalls` names. By default the refusals and effects
            of the operations say it.
        placed: (request, refs) → the request as the operations see it. By default that is the request itself; a system
            whose rules have to know where the names stand puts that in.
        drives: what a tester may make happen, by name; an iterable of drives will do.
        urgent: state → the steps that must have happened once things have settled.
        matches: (view, content) → the ways in which the message shows the view, or why it does not. By default nothing
            is shown.
        delivery: topic → how its messages travel.
        sequence: how a number on a track compares with the one before (one of the `RELATIONS` of
            `missionfsm.kernel.sequence`) → the readings under which that is right, or why it is wrong.
        names: state → how many names it has.
        request_operation: request → the name of its operation: its attribute ``operation``, or itself.
        ambiguities: the questions that its documents leave open; an assumption is a set of their readings.
        failing: (request, code) → the failure that may come in any state, or None. Outcomes do not repeat it.
        remembered: (view, content) → what is remembered of a message that came. An owed message that looks the same
            need not come: nobody could tell it from the one before. It is the content itself, or None if only an equal
            view looks the same, as in systems whose messages have names.
        spontaneous: state → what the system may do at any time although nobody can drive it; usually nothing.
        silent_for: (state, focus) → those of its urgent and spontaneous steps that have to be considered before the
            observation, since all others can as well come after it; None if all have to be.
        calmed: state → the same state, in which nothing that a step left open happened before things settled.
        closing: (state, topic) → the ways in which the system may close the channel of that topic at any time, and in
            which the end of a channel is seen that a step has closed; None if only `Delivery.ends` allows an end.
        concerns: (topic of a channel, topic of an emission) → whether the channel is owed the emission.
        describe: a request, an event, a state, a view or the content of a message → a few words for people.
        rules: all rules of the system that belong to no operation.
        charts: the state machines of its documents, each a table: what they are drawn from.
        invariants: what holds in every state that can be reached.
        possibilities: what holds in some state that can be reached.
        answers: (shape of an allowed answer, shape of the answer that came) → the ways in which they agree, or why they
            do not; None if they have to be equal.
        lasting: content → of each thing that it names, what may not change as long as the thing is there: pairs of a
            relation, such as ``goals changed``, and a value. `sequence` is asked about the relation when the value
            changes. None if nothing is known to last.
        recalls: whether outcomes depend on a name having belonged to something once.
        decided: assumptions → the same system without outcomes that contradict them, which is quicker; None if it is
            not. It stands for `outcomes`: whoever replaces those drops it.
        rebuilt: operations → the same system with those instead of its own, to see what a broken rule does.
        foresees: (state, its names, content, names of the content, operations, topic) → whether the state may come to
            be shown as the content on the topic (None: any), by calls of those operations and any other steps; None if
            nothing is known of that. Among the operations stands what `Drive.heeded` says of the drives. Names are
            numbers; a number below -1 was not seen yet and may be any name. It has to be true wherever that is
            possible: it only saves a search some work. Whoever changes other steps drops it.
        succeeds: (state, its names, request, its names, names of the answer) → whether a state may follow in which the
            request is answered OK with those names; None if nothing is known of that. As for `foresees`.
        abstraction: how a search and an exploration look at its states.
        parting: how it falls into parts that share nothing; None if it does not.
        answers_for: the id of an ambiguity, or the beginning of several ids up to a dot → the ids of the promises that
            it is about. Whoever follows none of its readings breaks those; without an entry, what was exercised.
        waived: what its documents say and no rule checks.
        unopened: ids of the rules that a message breaks on a channel that was never opened, or has ended.
        unowed: (state, topic, content, positions of its names among those of the state) → the ids of the rules that the
            message breaks if it is not owed, or what is wrong with it; None if the topic's `Delivery` says it.
        undelivered: view → the ids of the rules that are broken if it is owed and does not come; None if the topic's
            `Delivery` says it.
        transport: whether what is observed came over a transport that is not perfect (`missionfsm.kernel.transport`).
        restarted: state → the step in which the system forgets everything; None if a drive does that.
        added: the operations that came with the latest version of the interface: older software refuses all of them.
        middle: how it is judged by a log that does not hold its beginning; None if it cannot be.
        anywhere: whether the log began while the system was in use (`missionfsm.kernel.middle`).
        others: whether others use the system as well, whose calls are not observed.
        used: world → the state after a soft reset, in which ids that were given before stay used; None if that is the
            initial state.
        shelving: how things are put away that decide nothing any more; None if it has none.
    """

    system: str
    title: str
    initial: Callable[[World], State]
    operations: Mapping[str, Operation] = field(default=(), converter=_operations)
    _outcomes: Callable[[State, Request, Refs], tuple[Step, ...]] | None = None
    drives: Mapping[str, Drive] = field(default=(), converter=_drives)
    urgent: Callable[[State], tuple[Step, ...]] = lambda _: ()
    matches: Callable[[View, Content], tuple[Match, ...] | Mismatch] = lambda _, __: Mismatch("", "nothing is shown")
    delivery: Callable[[Topic], Delivery] = lambda _: Delivery()
    sequence: Callable[[str], tuple[Assumption, ...] | Mismatch] = lambda _: ()
    placed: Callable[[Request, Refs], Request] = lambda request, _: request
    names: Callable[[State], int] = lambda _: 0
    request_operation: Callable[[Request], str] = lambda request: str(getattr(request, "operation", request))
    ambiguities: tuple[Ambiguity, ...] = ()
    failing: Callable[[Request, str], Failure | None] = lambda _, __: None
    remembered: Callable[[View, Content], Hashable] = lambda _, __: None
    spontaneous: Callable[[State], tuple[Step, ...]] = lambda _: ()
    silent_for: Callable[[State, Focus], tuple[Step, ...]] | None = None
    calmed: Callable[[State], State] = lambda state: state
    closing: Callable[[State, Topic], tuple[Step, ...]] | None = None
    concerns: Callable[[Topic, Topic], bool] = operator.eq
    describe: Callable[[object], str] = str
    rules: tuple[Rule, ...] = ()
    charts: tuple[Chart[State], ...] = ()
    invariants: tuple[Invariant, ...] = ()
    possibilities: tuple[Invariant, ...] = ()
    answers: Callable[[Shape, Shape], tuple[Match, ...] | Mismatch] | None = None
    lasting: Callable[[Content], tuple[tuple[tuple[str, Hashable], ...], ...]] | None = None
    recalls: bool = False
    decided: Callable[[int], Spec] | None = None
    rebuilt: Callable[[Mapping[str, Operation]], Spec] | None = None
    foresees: Callable[[State, tuple[int, ...], Content, tuple[int, ...], frozenset[str], Topic], bool] | None = None
    succeeds: Callable[[State, tuple[int, ...], Request, tuple[int, ...], tuple[int, ...]], bool] | None = None
    abstraction: Abstraction = field(factory=Abstraction)
    parting: Parting | None = None
    answers_for: Mapping[str, tuple[str, ...]] = field(factory=dict)
    waived: tuple[Waiver, ...] = ()
    unopened: tuple[str, ...] = ()
    unowed: Callable[[State, Hashable, Content, Refs], tuple[str, ...] | Mismatch | Unowed] | None = None
    undelivered: Callable[[View], tuple[str, ...]] | None = None
    transport: bool = False
    restarted: Callable[[State], Step] | None = None
    added: frozenset[str] = frozenset()
    middle: Middle | None = None
    anywhere: bool = False
    others: bool = False
    used: Callable[[World], State] | None = None
    shelving: Shelving | None = None

    def __attrs_post_init__(self) -> None:
        registered = {name: one.registered(self.system) for name, one in self.operations.items()}
        object.__setattr__(self, "operations", registered)

    def outcomes(self, state: State, request: Request, refs: Refs) -> tuple[Step, ...]:
        """Every answer that the documents allow to a request, each with the state after it."""
        if self._outcomes is not None:
            return self._outcomes(state, request, refs)
        operation = self.operations[self.request_operation(request)]
        return operation.outcomes(state, self.placed(request, refs), refs)

    @property
    def follows_operations(self) -> bool:
        """Whether other operations would make it do other things."""
        return self._outcomes is None or self.rebuilt is not None

    def with_operations(self, operations: Mapping[str, Operation]) -> Spec:
        """The same system with those operations instead of its own."""
        return evolve(self, operations=operations) if self.rebuilt is None else self.rebuilt(operations)

    def with_steps(self, change: Callable[[State, Iterable[Step]], tuple[Step, ...]]) -> Spec:
        """The same system, in which every step is changed that no request brings about."""

        def driven(drive: Drive) -> Drive:
            return evolve(drive, steps=lambda state, event, refs: change(state, drive.steps(state, event, refs)))

        silent_for, closing = self.silent_for, self.closing
        return evolve(
            self,
            foresees=None,
            drives=[driven(one) for one in self.drives.values()],
            urgent=lambda state: change(state, self.urgent(state)),
            spontaneous=lambda state: change(state, self.spontaneous(state)),
            silent_for=silent_for and (lambda state, focus: change(state, silent_for(state, focus))),
            closing=closing and (lambda state, topic: change(state, closing(state, topic))),
        )

    def search_size(self, state: State) -> int:
        """How large a state is for a search."""
        return (self.abstraction.search_size or self.names)(state)

    def explore_size(self, state: State) -> int:
        """How large a state is for an exploration."""
        return (self.abstraction.explore_size or self.names)(state)

    def promised_about(self, ambiguity: Ambiguity) -> tuple[str, ...]:
        """Ids of the promises that an ambiguity is about: the entry of `answers_for` with most of its id."""
        names = (name for name in self.answers_for if f"{ambiguity.id}.".startswith(f"{name}."))
        return self.answers_for.get(max(names, key=len, default=""), ())

    @property
    def implied(self) -> Mapping[str, Rule]:
        """Rules that go without saying, by id: each call is answered as documented, each drive happens where it can.

        A violation names one of them if it breaks no other rule.
        """
        answered = (
            promise("it-answers-as-documented", f"{one.name} is answered as its page says.", cite=one.cite)
            for one in self.operations.values()
        )
        happens = (
            promise(
                "it-happens-only-where-it-can",
                f"{one.name} happens only where it can.",
                cite=one.cite or Citation(self.system, ()),
            )
            for one in self.drives.values()
        )
        places = (*self.operations, *self.drives)
        rules = (rule.registered(self.system, name) for name, rule in zip(places, (*answered, *happens), strict=True))
        return {rule.id: rule for rule in rules}

    @property
    def all_rules(self) -> tuple[Rule, ...]:
        """Every rule: the refusals and promises of each operation, then those of the system."""
        own = (rule for operation in self.operations.values() for rule in (*operation.refusals, *operation.promises))
        return (*own, *self.rules)

    def rule(self, rule_id: str) -> Rule:
        """The rule with this id. Raises KeyError."""
        return self.rules_by_id[rule_id]

    @property
    def rules_by_id(self) -> Mapping[str, Rule]:
        """Every rule by its id."""
        return {rule.id: rule for rule in self.all_rules}
