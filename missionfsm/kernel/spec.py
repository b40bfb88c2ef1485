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
from missionfsm.kernel.step import Match, Mismatch, Step, Unowed
from missionfsm.kernel.terms import Content, Incident, Refs, Request, Shape, State, Topic, View, World


@frozen
class Failure:
    """That a call may fail with a code whatever the state is, without anybody's doing.

    Attributes:
        assumes: the readings under which it may.
        open_ended: whether the call may all the same take effect, at once or later (a deadline that passed).
        drive: the name of the drive that brings it about; where a tester has that drive it comes no other way.
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
        ends: status name to the readings under which the channel may end with it; one that is missing may not end it.
        unowed: ids of the rules that are broken by a message that nothing owes, and by one that is owed and does not
            come; the nearest first.
        named: ids of the rules that are broken by a message that names other things than it is about.
        first: ids of the rules that are broken where the first message does not come; those in `unowed` if none.
        unending: ids of the rules that are broken where the channel ends though it may not; if none, what goes
            without saying of the operation.
        malformed: ids of the rules that are broken by a message that cannot be read.
        every_time: whether a message has to come even where the one before it says the same, as lines do.
        stands: whether what a channel owes stays owed until it is shown or passed over: no step takes it back.
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
    operation: str = ""


@frozen
class Unwatched:
    """What of a drive may happen with no line that says so, where a log need not hold all there was.

    Attributes:
        reading: the question whether it did; "a" is no, and "b", which is flagged, is what such steps assume.
        world: a world to the one in which it may.
    """

    reading: Ambiguity
    world: Callable[[World], World]


@frozen
class Drive:
    """Something that a tester may be able to make happen.

    Attributes:
        name: what adapters and histories call it.
        steps: (state, event, refs) to the ways in which it happens; none where it does not apply. `refs` are the
            positions of the event's names among those of the state, as for outcomes.
        by_itself: the events that the environment may produce unseen where nobody drives them.
        cite: where the documents speak of it, if they do.
        renumbers: the event to the tracks whose numbers start over with it, on every channel.
        shows_again: the event to the tracks of which what came last may come again with its number, on every channel.
        ends: it ends a channel: what arrived on that while it was being done arrived before it.
        impossible: ids of the rules that are broken where it is said to have happened though it could not.
        waits: whether one that was driven before still waits in a state; the tester drives none while one does.
        later: for a drive that only lets time pass: its words before what comes next ("2 s later"); None for others.
        unwatched: what of it may happen unseen in recorded logs of those who do not command it; None for nothing but
            what is `by_itself`.
        undriven: a world to the one in which what it does may happen unseen at any time; for a drive that nobody
            commands.
        elapses: for a drive that lets time pass: how many seconds have passed between two lines of a log, None where
            the log does not say, to the event of that much time that nobody let pass; None for other drives.
    """

    name: str
    steps: Callable[[State, Incident, Refs], tuple[Step, ...]]
    by_itself: tuple[Hashable, ...] = ()
    cite: Citation | None = None
    renumbers: Callable[[Incident], tuple[Hashable, ...]] | None = None
    shows_again: Callable[[Incident], tuple[Hashable, ...]] | None = None
    ends: bool = False
    impossible: tuple[str, ...] = ()
    waits: Callable[[State], bool] = lambda _: False
    later: Callable[[Incident], str] | None = None
    unwatched: Unwatched | None = None
    undriven: Callable[[World], World] | None = None
    elapses: Callable[[float | None], Incident] | None = None


@frozen
class Invariant:
    """A condition on states that holds in all reachable ones, or (a possibility) in at least one."""

    name: str
    says: str
    holds: Callable[[State], bool]


@frozen
class Parting:
    """How a system falls into parts that do not touch one another, but for the readings that all of them follow.

    Attributes:
        parts: (world, names of the drives that a tester commands) to the parts; none where it does not fall apart.
        part: (the system, one of its parts) to the system as far as that part sees of it.
        whose: an event to the part that it is about; None where it is about all of them.
    """

    parts: Callable[[World, frozenset[str]], tuple[Hashable, ...]]
    part: Callable[[Spec, Hashable], Spec]
    whose: Callable[[Event], Hashable | None]


Things = tuple[tuple[int, Hashable], ...]
"""Each name with what is known of the thing that has it."""


@frozen
class Glimpses:
    """What messages tell of a system of which nothing else is known.

    Attributes:
        world: state to the world that it is in, as `Spec.initial` takes it.
        states: (world, content) to those that a message may show, each with the view of it, as long as it is well
            formed. The names of each are those of the content, as `Spec.matches` pairs them.
        samples: world to states that stand for all there are as far as answers differ.
        topic: content to the topic of a channel that shows it.
        things: (state, its names) to what there is of each, in the order in which it is shown: what nobody changes as
            long as it is there.
        shown: (view, its names) to the same of what was shown on a channel, which tells more of it.
        follows: (world, things that were there in their order, content, its names) to what is assumed where a message
            shows what these may have become by whatever calls; None where they cannot.
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
    """What lets a system be judged without its beginning.

    Attributes:
        glimpses: how its state becomes known from messages; None where nothing that it can be asked changes it, so
            that what it did unseen is all that is not known.
        undriven: names of the drives whose events before the log are not known, so that what they do may have happened
            unseen.
    """

    glimpses: Glimpses | None = None
    undriven: frozenset[str] = frozenset()


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
        initial: the state in a world (the parameters that `reset` is given, as a value of the system).
        operations: what callers may ask, by name; made from the operations alone, if those are given.
        outcomes: (state, request, refs) to every answer that the documents allow, each with the state after it. `refs`
            are the positions of the request's names among those of the state, None for one that the state has not, or
            `ONCE_HAD` for one that it had once, if the spec `recalls` names. Where nothing is given, those of the
            operations, by their refusals and effects.
        placed: (request, refs) to the request as those see it; itself, unless they have to know where its names stand.
        drives: what a tester may make happen, by name; made from the drives alone, if those are given.
        urgent: what must have happened once things have settled.
        matches: (view, content) to the ways in which the message shows the view, or why it does not; where nothing is
            said, nothing is shown.
        delivery: topic to how its messages travel.
        sequence: how a number on a track compares with the one before (one of the `RELATIONS` of
            `missionfsm.kernel.sequence`) to the readings under which that is right, or why it is wrong.
        names: how many names a state has.
        request_operation: request to the name of its operation: its attribute ``operation``, or itself.
        ambiguities: the questions that its documents leave open; an assumption is a set of their readings.
        failing: (request, code) to the failure that may come in any state, or None. What it says is not repeated among
            the outcomes.
        remembered: (view, content) to what is remembered of a message that came, so that an owed one which looks the
            same is not due: nobody could tell it from the one before. It is the content itself, or None where only an
            equal view looks the same, as in systems whose messages have names.
        spontaneous: what the system may do at any time although nobody can drive it; usually nothing.
        silent_for: (state, what is observed) to those among its urgent and spontaneous steps that are enough to be
            thought of before that, since the others can as well come after it; None: all are.
        calmed: state to the one in which nothing that a step has left open happened before things settled.
        closing: (state, topic) to the ways in which the system may at any time close the channel of that topic, and an
            end may be seen of one that a step has closed; None where only `Delivery.ends` allows an end.
        concerns: (topic of a channel, topic of an emission) to whether the channel is owed the emission.
        describe: a request, an event, a state, a view or what a message says, in a few words for people.
        rules: all rules of the system that belong to no operation.
        charts: the state machines of its documents, each a table: what they are drawn from.
        invariants: what holds in every state that can be reached.
        possibilities: what holds in some state that can be reached.
        answers: (shape of an answer that is allowed, shape of the one that came) to the ways in which they agree, or
            why they do not; None where they have to be equal.
        lasting: the content of a message to what of the thing with each of its names may never change as long as it is
            there: pairs of a relation, such as ``goals changed``, which `sequence` is asked about once it changes, and
            of a value. None where nothing is known to last.
        recalls: whether it matters to its outcomes that a name was something's once.
        decided: assumptions to the same system with no outcomes that contradict them, which is quicker; None where it
            is not. It speaks for `outcomes`: whoever replaces those drops it.
        rebuilt: operations to the same system with those instead of its own, for trying what a broken rule does.
        foresees: (state, its names, content, names of the content, operations) to whether the state may come to be
            shown as the content, by calls of those operations and whatever steps else; None where nothing is known of
            that. Names are numbers; one below -1 was not seen yet and may be any. It has to be true wherever it is
            possible: it only saves a search the trouble.
        succeeds: (state, its names, request, its names, names of the answer) to whether the state may come to one in
            which the request is answered OK so; None where nothing is known of that. As for `foresees`.
        abstraction: how a search and an exploration look at its states.
        parting: how it falls into parts that do not touch one another; None where it is one.
        answers_for: the id of an ambiguity, or how those of several begin up to a dot, to the ids of the promises that
            it is a question about: who follows none of its readings breaks those. Of the others it is what was
            exercised.
        waived: what its documents say and no rule checks.
        unopened: ids of the rules that are broken by what comes on a channel that was never opened, or has ended.
        unowed: (state, topic, content, positions of its names among those of the state) to the ids of the rules that
            are broken by a message that nothing owes, or what is wrong with one; None where those of the topic's
            `Delivery` say it.
        undelivered: view to the ids of the rules that are broken where it is owed and does not come; None where those
            of the topic's `Delivery` say it.
        transport: whether what is observed came over a transport that is not perfect (`missionfsm.kernel.transport`).
        restarted: state to the step in which everything that it remembers is forgotten; None where that is a drive's.
        added: the operations that came with the latest version of the interface, all at once: older software refuses
            them.
        middle: what lets it be judged without its beginning, or None where that cannot be.
        anywhere: whether what is observed began while it was in use (`missionfsm.kernel.middle`).
        others: whether others, whose calls are not observed, use it as well.
        used: world to the state after a soft reset, in which ids that were given before stay used; None where that is
            the initial one.
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
    foresees: Callable[[State, tuple[int, ...], Content, tuple[int, ...], frozenset[str]], bool] | None = None
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
        """The same system where the steps from a state that no request brings about are changed."""

        def driven(drive: Drive) -> Drive:
            return evolve(drive, steps=lambda state, event, refs: change(state, drive.steps(state, event, refs)))

        silent_for, closing = self.silent_for, self.closing
        return evolve(
            self,
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
        """Ids of the promises that an ambiguity is a question about, by the longest of the names that begin its id."""
        names = (name for name in self.answers_for if f"{ambiguity.id}.".startswith(f"{name}."))
        return self.answers_for.get(max(names, key=len, default=""), ())

    @property
    def implied(self) -> Mapping[str, Rule]:
        """What goes without saying of each operation and each drive, by its id: named where no other rule is broken."""
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
