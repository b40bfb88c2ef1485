"""The robot's side of mission submission as a `Spec`: what a correct mission codelet may say on its connection.

Time passes only where the tester says so. No period of RUNNING is documented, so it may come at any time while a
behavior tree runs, and has to come at least once when `RUNNING_BOUND` passes in one go.
"""

from __future__ import annotations

from collections.abc import Callable

from attrs import evolve, frozen

from missionfsm.isaac.robot import rules
from missionfsm.isaac.robot.readings import (
    AI_10,
    AI_25_HEADER,
    AI_25_TAKEN,
    AI_27_TYPE,
    AI_28_STATUS,
    AI_33_NULL,
    AI_33_UNUSABLE,
    AMBIGUITIES,
)
from missionfsm.isaac.robot.rules import LIFECYCLE, RULES, SYSTEM
from missionfsm.isaac.shared.line import MICROSECONDS, Said
from missionfsm.kernel.codec import Garbled
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.spec import Delivery, Drive, Emission, Invariant, Match, Mismatch, Opening, Spec, Step

RUNNING_BOUND = 5 * MICROSECONDS
"""Time within which RUNNING has to be reported at least once, in microseconds. The tester's choice (AI-31)."""

STATUS_CHANNEL = "mission_status"
_TOPIC = "line"


@frozen(cache_hash=True)
class Codelet:
    """A robot's mission codelet.

    Attributes:
        connected: whether its connection is there; it comes at the very start.
        running: whether a behavior tree runs.
        named: whether its mission has an identifier.
        used: whether a mission was ended before.
    """

    connected: bool = False
    running: bool = False
    named: bool = False
    used: bool = False

    @property
    def state(self) -> str:
        """Where it is on the chart."""
        return "RUNNING" if self.running else "IDLE"


@frozen(cache_hash=True)
class Report:
    """A status that is owed: ``running``, ``success`` or ``failure``, of a mission with or without an identifier."""

    status: str
    named: bool


USABLE, NULL, UNUSABLE = "usable", "null", "unusable"


@frozen(cache_hash=True)
class Arrives:
    """A line arrives: a mission (its configuration `USABLE`, `NULL` or `UNUSABLE`), or something without effect (None).

    `numeric` says that 64-bit integers in it are numbers, `foreign` that it is another message on the mission channel.
    """

    mission: str | None = None
    named: bool = False
    numeric: bool = False
    foreign: bool = False
    name: str = "line"


@frozen(cache_hash=True)
class Stops:
    """The behavior tree stops, as ``behaviorSucceeded`` or ``behaviorFailed``."""

    name: str


@frozen(cache_hash=True)
class Passes:
    """Time passes, in microseconds."""

    time: int
    name: str = "advance"


_RULE = {"running": rules.RUNNING, "success": rules.SUCCESS, "failure": rules.FAILURE}


def _report(here: Codelet, status: str, *, ref: int = 0, offer: bool = False) -> Emission:
    return Emission(_TOPIC, Report(status, here.named), (ref,) if here.named else (), stays=offer, certain=not offer)


def _moved(here: Codelet, trigger: str) -> Codelet:
    after = LIFECYCLE.after(trigger, here.state)
    assert after is not None, f"{trigger} is no move from {here.state}"  # noqa: S101 - the caller has looked
    return evolve(here, running=after == "RUNNING", named=here.named and after == "RUNNING", used=True)


def _arrives(here: Codelet, event: Arrives, _: tuple[int | None, ...]) -> tuple[Step, ...]:
    if not here.connected:
        return ()
    ignored = Step(here, rules=(rules.IGNORES.id,))
    if event.foreign:
        heeded = _mission(here, event, (AI_27_TYPE["b"],), usable=True)
        return (evolve(ignored, assumes=(AI_27_TYPE["a"],)), heeded)
    if event.mission is None:
        return (ignored,)
    ways: list[tuple[bool, tuple[Assumption, ...]]] = []
    if event.mission == USABLE:
        ways = [(True, ())]
    elif event.mission == NULL:
        ways = [(True, (AI_33_NULL["a"],)), (True, (AI_33_NULL["b"], AI_33_UNUSABLE["b"]))]
        ways.append((False, (AI_33_NULL["b"], AI_33_UNUSABLE["a"])))
    else:
        ways = [(False, (AI_33_UNUSABLE["a"],)), (True, (AI_33_UNUSABLE["b"],))]
    if not event.numeric:
        return tuple(_mission(here, event, assumes, usable=usable) for usable, assumes in ways)
    taken = AI_25_TAKEN["a"]
    return (
        *(_mission(here, event, (taken, *assumes), usable=usable) for usable, assumes in ways),
        evolve(ignored, assumes=(AI_25_TAKEN["b"],)),
    )


def _mission(here: Codelet, event: Arrives, assumes: tuple[Assumption, ...], *, usable: bool) -> Step:
    emits: list[Emission] = []
    because: list[Rule] = [rules.STARTS if usable else rules.UNUSABLE]
    if here.running:
        # What the codelet said of the old mission until now may still be on its way.
        emits += [_report(here, "running", offer=True), _report(here, "failure")]
        because.append(rules.PREEMPTS)
    elif here.used:
        because.append(rules.LISTENS)
    new = evolve(here, named=event.named)
    emits.append(_report(new, "running", ref=-1, offer=True) if usable else _report(new, "failure", ref=-1))
    after = _moved(new, "a mission arrives" if usable else "an unusable mission arrives")
    return Step(
        after,
        names=(-1,) if after.named else (),
        emits=tuple(emits),
        rules=tuple(one.id for one in because),
        assumes=assumes,
    )


_STOPS = {
    "behaviorSucceeded": ("the tree reports success", "success"),
    "behaviorFailed": ("the tree reports failure", "failure"),
}


def _stops(here: Codelet, event: Stops, _: tuple[int | None, ...]) -> tuple[Step, ...]:
    trigger, status = _STOPS[event.name]
    if LIFECYCLE.after(trigger, here.state) is None:
        return ()
    # RUNNING may be on its way still; the final status is the last word.
    emits = (_report(here, "running", offer=True), _report(here, status))
    return (Step(_moved(here, trigger), names=(), emits=emits, rules=(_RULE[status].id,)),)


def _passes(here: Codelet, event: Passes, _: tuple[int | None, ...]) -> tuple[Step, ...]:
    if not here.connected:
        return ()
    if not here.running or event.time < RUNNING_BOUND:
        return (Step(here),)
    emits = (_report(here, "running"), _report(here, "running", offer=True))
    return (Step(here, emits=emits, rules=(rules.RUNNING.id,)),)


def _urgent(here: Codelet) -> tuple[Step, ...]:
    """The connection, which is there from the start and has to be opened like any other."""
    if here.connected:
        return ()
    return (Step(evolve(here, connected=True), opens=(Opening(_TOPIC, 0, kind="connection"),)),)


def _matches(view: Report, content: Said | Garbled) -> tuple[Match, ...] | Mismatch:
    if isinstance(content, Garbled):
        return Mismatch(rules.ENVELOPE.id, content.says)
    if content.kind != "status":
        return Mismatch(_RULE[view.status].id, f"{view.status} is due, not a {content.kind} message")
    wrong = [path for path in content.bare if path != "header.uuid"]
    if wrong:
        return Mismatch(rules.INTEGERS.id, f"{wrong[0]} is a number")
    if content.channel != STATUS_CHANNEL:
        return Mismatch(rules.CHANNEL.id, f"the status came on channel {content.channel!r}")
    if content.what != view.status:
        return Mismatch(_RULE[view.status].id, f"{view.status} is due, not {content.what}")
    forms = {"upper": "c", "lower": "d", "number": "e"}
    assumes = [AI_28_STATUS[forms[content.form]], AI_25_HEADER["n" if content.bare else "s"]]
    if not view.named:
        return (Match(tuple(assumes), rules=(_RULE[view.status].id, rules.ENVELOPE.id)),)
    if not content.named:
        return (Match((*assumes, AI_10["a"]), rules=(_RULE[view.status].id, rules.ENVELOPE.id)),)
    told = (_RULE[view.status].id, rules.ABOUT.id, rules.CHANNEL.id, rules.ENVELOPE.id, rules.INTEGERS.id)
    return (Match((*assumes, AI_10["b"]), ((0, 0),), told),)


def describe(value: object) -> str:
    """A state, an event, a view or a line in a few words."""
    if isinstance(value, Codelet):
        return "a mission runs" if value.running else "no mission runs"
    if isinstance(value, Report):
        return f"{value.status.upper()} of its mission"
    if isinstance(value, Said):
        return f"{value.what.upper()} on {value.channel}" if value.kind == "status" else f"a {value.kind} message"
    if isinstance(value, Garbled):
        return f"a malformed line: {value.says}"
    if isinstance(value, Arrives):
        return (
            "a line without effect"
            if value.mission is None
            else f"a mission with a configuration that is {value.mission}"
        )
    if isinstance(value, Passes):
        return f"{value.time / MICROSECONDS:g} s pass"
    return {"behaviorSucceeded": "the tree reports success", "behaviorFailed": "the tree reports failure"}[
        getattr(value, "name", "")
    ]


_SAYS: Callable[[str], Invariant] = lambda state: Invariant(  # noqa: E731 - one line of a table
    f"the-codelet-is-{state.lower()}", f"Some codelet is {state}.", lambda here: here.state == state
)

SPEC = Spec(
    system=SYSTEM,
    title="a robot's mission codelet",
    initial=lambda _: Codelet(),
    operations={},
    outcomes=lambda *_: (),
    drives={
        one.name: one
        for one in (
            Drive("line", _arrives),
            Drive("behaviorSucceeded", _stops, (Stops("behaviorSucceeded"),)),
            Drive("behaviorFailed", _stops, (Stops("behaviorFailed"),)),
            Drive("advance", _passes),
        )
    },
    urgent=_urgent,
    matches=_matches,
    delivery=lambda _: Delivery(),
    sequence=lambda _: (),
    names=lambda here: int(here.running and here.named),
    request_operation=str,
    ambiguities=AMBIGUITIES,
    describe=describe,
    rules=RULES,
    charts=(LIFECYCLE,),
    invariants=(
        Invariant(
            "only-missions-are-named", "An idle codelet has no mission.", lambda here: here.running or not here.named
        ),
    ),
    possibilities=(
        *map(_SAYS, LIFECYCLE.states),
        Invariant("a-mission-follows", "A mission runs after another.", lambda here: here.running and here.used),
    ),
)
