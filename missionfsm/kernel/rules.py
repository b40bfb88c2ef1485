"""Documented conditions and what they allow: a `Rule` is a citation, a condition and a message in one function."""

from __future__ import annotations

import inspect
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping

from attrs import evolve, field, frozen

from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import UNCONSTRAINED, Ambiguity, Assumption, meet
from missionfsm.kernel.step import Step
from missionfsm.kernel.terms import Refs, Request, State

OK = "OK"
UNKNOWN = "UNKNOWN"
CANCELLED = "CANCELLED"
INVALID_ARGUMENT = "INVALID_ARGUMENT"
DEADLINE_EXCEEDED = "DEADLINE_EXCEEDED"
NOT_FOUND = "NOT_FOUND"
PERMISSION_DENIED = "PERMISSION_DENIED"
RESOURCE_EXHAUSTED = "RESOURCE_EXHAUSTED"
FAILED_PRECONDITION = "FAILED_PRECONDITION"
UNIMPLEMENTED = "UNIMPLEMENTED"
INTERNAL = "INTERNAL"
UNAVAILABLE = "UNAVAILABLE"
UNAUTHENTICATED = "UNAUTHENTICATED"

STATUS_NUMBERS: Mapping[str, int] = {
    OK: 0,
    CANCELLED: 1,
    UNKNOWN: 2,
    INVALID_ARGUMENT: 3,
    DEADLINE_EXCEEDED: 4,
    NOT_FOUND: 5,
    "ALREADY_EXISTS": 6,
    PERMISSION_DENIED: 7,
    RESOURCE_EXHAUSTED: 8,
    FAILED_PRECONDITION: 9,
    "ABORTED": 10,
    "OUT_OF_RANGE": 11,
    UNIMPLEMENTED: 12,
    INTERNAL: 13,
    UNAVAILABLE: 14,
    "DATA_LOSS": 15,
    UNAUTHENTICATED: 16,
}
"""The gRPC status names and their numbers."""


@frozen
class Citation:
    """A place in a document: its short name and the headings that lead there."""

    document: str
    headings: tuple[str, ...]

    def __str__(self) -> str:
        return " › ".join((self.document, *self.headings))


@frozen
class Document:
    """A page that is modelled. ``MISSION["CreateMission", "Errors"]`` cites a place in it."""

    name: str
    title: str

    def __getitem__(self, headings: str | tuple[str, ...]) -> Citation:
        return Citation(self.name, (headings,) if isinstance(headings, str) else headings)


@frozen
class Waiver:
    """A sentence of a document that is not checked.

    Attributes:
        name: what is not checked, as a phrase, words joined by hyphens.
        says: what is not checked and why, in one line for people.
        cite: where the sentence stands.
        shown_by: names of the calls and drives in whose use it could have shown; any use of the system if none.
    """

    name: str
    says: str
    cite: Citation
    shown_by: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.name}: {self.says} [{self.cite}]"


Condition = Callable[[State, Request], bool]


@frozen
class Rule:
    """A documented sentence that can be checked.

    A rule with a `code` is a *refusal*: where its condition holds, the operation may be (and if nothing else is said,
    must be) answered with that code and changes nothing. A rule without one is a *promise* about what happens or what
    is seen; it is checked by the step or by the reading of a message that names it.

    Attributes:
        name: the condition or the promise as a phrase, words joined by hyphens.
        says: one line for people.
        argues: why the sentence is read so; may be empty.
        cite: where the sentence stands.
        code: the gRPC status of a refusal; None for a promise.
        holds: the condition of a refusal.
        assumes: the reading that makes the condition refuse, or None where no reading matters.
        looks_at: what a refusal looks at, where readings rank that (the form of a request before the state).
        id: ``system/operation/code/name``, or ``system/topic/name`` for a promise; set when it is registered.
        everywhere: whether it stands in the section of every operation, of which `cite` names one.
        names: whether it says which names an answer has, so that of several promises a wrong name breaks this one.
    """

    name: str
    says: str
    argues: str
    cite: Citation
    code: str | None = None
    holds: Condition | None = field(default=None, eq=False, repr=False)
    assumes: Assumption | None = None
    looks_at: str = ""
    id: str = ""
    everywhere: bool = False
    names: bool = False

    def place(self, operation: str) -> Citation:
        """Where the sentence stands that is about an operation; any, where that is empty."""
        if not (self.everywhere and operation):
            return self.cite
        return evolve(self.cite, headings=(operation, *self.cite.headings[1:]))

    def __call__(self, state: State, call: Request) -> bool:
        """Whether the condition of a refusal holds."""
        return self.holds is not None and self.holds(state, call)

    def registered(self, *place: str) -> Rule:
        """This rule, registered at a place: ``rule.registered("bear.mission", "CreateMission")``."""
        middle = (*place, self.code) if self.code else place
        return evolve(self, id="/".join((*middle, self.name)))


def _words(function: Condition) -> tuple[str, str, str]:
    text = inspect.getdoc(function) or ""
    says, _, argues = text.partition("\n")
    if not says:
        message = f"{function.__qualname__} has no docstring: its first line is what a person is told"
        raise TypeError(message)
    return function.__name__.strip("_").replace("_", "-"), says.strip(), " ".join(argues.split())


def refusal(
    code: str, *, cite: Citation, assumes: Assumption | None = None, looks_at: str = ""
) -> Callable[[Condition], Rule]:
    """Make a refusal of a condition: its name is the name, its docstring the message and the argument.

    Args:
        code: the gRPC status that the document gives.
        cite: where it stands.
        assumes: the reading that makes the condition refuse.
        looks_at: what it looks at, for readings that rank that (the form before the state, say).
    """

    def register(condition: Condition) -> Rule:
        name, says, argues = _words(condition)
        return Rule(name, says, argues, cite, code, condition, assumes, looks_at)

    return register


def promise(name: str, says: str, *, cite: Citation, argues: str = "", names: bool = False) -> Rule:
    """A documented sentence that is no error: an effect, an order, a range, a move of a lifecycle.

    Args:
        names: whether it says which names an answer has.
    """
    return Rule(name, says, argues, cite, names=names)


Effect = Callable[[State, Request, Refs], Iterable[Step]]
"""Of a state, a request and the places of its names: the ways in which it takes effect."""


def _unchanged(state: State, _request: Request, _refs: Refs) -> Iterable[Step]:
    return (Step(state),)


@frozen(eq=False)
class Operation:
    """What a caller may ask, with the rules of its Errors table in the order in which a reader meets them.

    Attributes:
        name: what the document calls it.
        cite: where the document describes it.
        refusals: rules with a code.
        promises: rules that its effects are justified by.
        effect: what takes effect where nothing refuses; by default nothing changes.
        failures: codes that may come at any time without anybody's doing (INTERNAL, DEADLINE_EXCEEDED).
        streaming: whether the answer opens a stream.
        system: whose it is; set when it is registered, and its rules under its name.
    """

    name: str
    cite: Citation
    refusals: tuple[Rule, ...] = field(default=(), converter=tuple[Rule, ...])
    promises: tuple[Rule, ...] = field(default=(), converter=tuple[Rule, ...])
    effect: Effect = _unchanged
    failures: tuple[str, ...] = field(default=(), converter=tuple[str, ...])
    streaming: bool = False
    system: str = ""

    @classmethod
    def with_rules(
        cls,
        name: str,
        system: str,
        cite: Citation,
        *,
        refusals: Iterable[Rule] = (),
        promises: Iterable[Rule] = (),
        failures: Iterable[str] = (),
        streaming: bool = False,
    ) -> Operation:
        """An operation that is registered at once, for those who name the ids of its rules."""
        return cls(name, cite, refusals, promises, failures=failures, streaming=streaming).registered(system)

    def registered(self, system: str) -> Operation:
        """This operation with its rules as those of a system, under its name; itself if they are that already."""
        if self.system:
            return self
        refusals, promises = (
            tuple(rule.registered(system, self.name) for rule in rules) for rules in (self.refusals, self.promises)
        )
        return evolve(self, refusals=refusals, promises=promises, system=system)

    def outcomes(self, state: State, request: Request, refs: Refs) -> tuple[Step, ...]:
        """Every answer that its rules allow: what refuses, and under other readings what takes effect.

        A step of the effect that has no answer is answered OK; one that names no rules is justified by all promises.
        """
        promised = tuple(rule.id for rule in self.promises)
        steps: list[Step] = []
        for decision in decide(self.blocking(state, request)):
            if decision.code is not None:
                steps.append(decision.refused(state))
                continue
            steps += (
                evolve(
                    step,
                    answer=step.answer or Answer(OK),
                    rules=step.rules or promised,
                    assumes=(*decision.assumes, *step.assumes),
                )
                for step in self.effect(state, request, refs)
            )
        return tuple(steps)

    def blocking(self, state: State, call: Request) -> tuple[Rule, ...]:
        """The refusals whose condition holds."""
        # As `Rule.__call__`, without a call in between: the oracle and whoever looks for what to ask do little else.
        return tuple([rule for rule in self.refusals if rule.holds is not None and rule.holds(state, call)])


@frozen
class Decision:
    """What the rules allow in one case of the readings: a refusal with one code, or (None) that it takes effect."""

    code: str | None
    rules: tuple[Rule, ...]
    assumes: tuple[Assumption, ...]

    def refused(self, state: State, assumes: tuple[Assumption, ...] = ()) -> Step:
        """The answer with its code, which changes nothing; `assumes` was assumed before."""
        rules = tuple(rule.id for rule in self.rules)
        return Step(state, answer=Answer(str(self.code)), rules=rules, assumes=(*assumes, *self.assumes))


Ranking = Callable[[tuple[Rule, ...]], Iterable[tuple[str, tuple[Assumption, ...]]]]
"""Of rules that hold together: the codes that may be answered, each with the readings that this assumes."""


def unranked(holding: tuple[Rule, ...]) -> Iterable[tuple[str, tuple[Assumption, ...]]]:
    """Any code of a rule that holds: no document ranks one above another."""
    return tuple((code, ()) for code in dict.fromkeys(str(rule.code) for rule in holding))


def decide(holding: tuple[Rule, ...], rank: Ranking = unranked) -> tuple[Decision, ...]:
    """Every decision that some consistent choice of readings allows where these rules hold.

    A rule under a reading holds in those cases of its ambiguity alone; the cases are told apart only as far as the
    rules at hand do. Without any rule the one decision is to let the operation take effect.
    """
    always = tuple(rule for rule in holding if rule.assumes is None)
    if always and len({rule.code for rule in holding}) == 1:
        return (Decision(always[0].code, always, ()),)
    decisions: list[Decision] = []
    for case in itertools.product(*_cases([rule.assumes for rule in holding if rule.assumes is not None])):
        active = tuple(rule for rule in holding if rule.assumes is None or meet(UNCONSTRAINED, (*case, rule.assumes)))
        decisions += _decided(active, case, rank) if active else (Decision(None, (), case),)
    return tuple(decisions)


def _decided(active: tuple[Rule, ...], case: tuple[Assumption, ...], rank: Ranking) -> Iterator[Decision]:
    """A decision for each code that may be answered where these rules hold in a case of the readings."""
    codes = {rule.code for rule in active}
    for code, assumes in rank(active) if len(codes) > 1 else ((str(active[0].code), ()),):
        justified = tuple(rule for rule in active if rule.code == code)
        yield Decision(code, justified, (*case, *assumes))


def _cases(assumptions: Iterable[Assumption]) -> list[list[Assumption]]:
    """For every ambiguity its readings, split as far as the assumptions tell them apart."""
    cells: dict[Ambiguity, list[int]] = {}
    for assumption in assumptions:
        ambiguity, kept = assumption.ambiguity, assumption.kept & assumption.group
        split = (part for cell in cells.get(ambiguity, [ambiguity.group]) for part in (cell & kept, cell & ~kept))
        cells[ambiguity] = [part for part in split if part]
    return [[ambiguity.where(cell) for cell in parts] for ambiguity, parts in cells.items()]
