"""What becomes of a robot when something happens to it: the steps of its drives.

Time passes only where the tester says so. No period is documented: RUNNING and the name may come at any time, and have
to come within their bounds. Of a time that is shorter it is asked whether they came in it, and what they may still say
then counts from there.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator

from attrs import evolve, frozen

from missionfsm.isaac.robot import readings, rules
from missionfsm.isaac.robot.inputs import BLANK, NULL, ODD, SHALLOW, UNUSABLE, Arrives
from missionfsm.isaac.robot.state import (
    NAME_BOUND,
    RUNNING_BOUND,
    TICK,
    Codelet,
    Introduction,
    Other,
    Report,
    Waiting,
    World,
)
from missionfsm.isaac.shared.drives import Passes
from missionfsm.kernel.language import Ambiguity, Assumption, Emission, Happening, Opening, Refs, Rule, Step

STATUSES, NAMES, OTHERS = "statuses", "names", "others"
"""The topics of the one connection: statuses, names and what else is sent come in any order among one another."""

MAX_WAITING = 32
"""How many statuses wait before the codelet is taken to have ticked when another one is due."""

NEW = -1
"""The reference to the identifier that a line brings along."""

FINAL = {"success": rules.SUCCESS, "failure": rules.FAILURE}


@frozen
class Due:
    """A status that is due: what it says, of the mission with which identifier (None for none), and when it is sent."""

    status: str
    about: int | None
    when: Ambiguity
    offered: bool = False
    """Whether RUNNING may come before it."""


def _emission(world: World, status: str, about: int | None, *, offer: bool = False) -> Emission:
    view = Report(status, about is not None, world.status_channel)
    return Emission(STATUSES, view, () if about is None else (about,), stays=offer, certain=not offer)


def _offer(here: Codelet, about: int | None) -> Emission:
    """RUNNING that may be said."""
    return _emission(here.world, "running", about, offer=True)


def introduction(world: World, *, offer: bool = False) -> Emission:
    """The name that is owed, or may be said."""
    return Emission(NAMES, Introduction(world.name, world.name_channel), (), stays=offer, certain=not offer)


def _anything(world: World) -> Emission:
    """What the application around the codelet may send besides."""
    return Emission(OTHERS, Other(world.channels), (), stays=True)


def _kept_names(here: Codelet) -> tuple[int, ...]:
    """The positions of the identifiers of the statuses that wait and are not lost for want of a connection."""
    named = [one for one in here.waiting if one.named]
    return tuple(at for at, one in enumerate(named) if one.kept)


def _said(here: Codelet, status: str, about: int | None, *, offered: bool) -> tuple[Emission, ...]:
    """A status, behind RUNNING where that may come before it."""
    said = _emission(here.world, status, about)
    return (_offer(here, about), said) if offered else (said,)


def _all_waiting(here: Codelet) -> Iterator[Emission]:
    """The statuses that waited, in order."""
    places = iter(here.waits)
    for one in here.waiting:
        yield from _said(here, one.status, next(places) if one.named else None, offered=one.offered)


def _concluded(
    here: Codelet, after: Codelet, mission: int | None, due: tuple[Due, ...], because: tuple[Rule, ...]
) -> Iterator[Step]:
    """The ways in which statuses become due: each is sent at once, or with those before it waits for the tick.

    Args:
        after: the codelet after it, what waits left out.
        mission: the reference to the identifier of the mission that runs then; None for none.
        due: the statuses, in order.
    """
    runs = () if mission is None else (mission,)
    ids = tuple(one.id for one in because)
    if not here.connected:
        yield from _unconnected(here, after, runs, due, ids)
        return
    for now, later, assumes in _divided(due):
        flushed = bool(now) or not (here.waiting or later) or len(here.waiting) >= MAX_WAITING
        waiting = (*(() if flushed else here.waiting), *(_waits(one) for one in later))
        waited = 0 if flushed else here.waited
        emits = (
            *(_all_waiting(here) if flushed else ()),
            *_sent(here, now),
            *((_offer(here, mission),) if after.running and not waiting else ()),
        )
        names = (*(() if flushed else here.waits), *_names_in(later), *runs)
        conclusion = evolve(after, waiting=waiting, waited=waited)
        yield Step(conclusion, names=names, emits=emits, rules=ids, assumes=assumes)


def _divided(due: tuple[Due, ...]) -> Iterator[tuple[tuple[Due, ...], tuple[Due, ...], tuple[Assumption, ...]]]:
    """Those that are sent at once and those that wait, with what that assumes: one that waits holds up those behind."""
    for sent in range(len(due), -1, -1):
        now, later = due[:sent], due[sent:]
        assumes = (*(one.when["a"] for one in now[-1:]), *(one.when["b"] for one in later[:1]))
        if len({one.ambiguity for one in assumes}) == len(assumes):
            yield now, later, assumes


def _sent(here: Codelet, due: tuple[Due, ...]) -> Iterator[Emission]:
    return (said for one in due for said in _said(here, one.status, one.about, offered=one.offered))


def _names_in(due: tuple[Due, ...]) -> Iterator[int]:
    return (one.about for one in due if one.about is not None)


def _waits(due: Due) -> Waiting:
    return Waiting(due.status, due.about is not None, due.offered)


def _unconnected(
    here: Codelet, after: Codelet, runs: tuple[int, ...], due: tuple[Due, ...], ids: tuple[str, ...]
) -> Iterator[Step]:
    ids = (*ids, rules.LINKED.id)
    before = here.waits
    yield Step(
        evolve(after, waiting=here.waiting), names=(*before, *runs), rules=ids, assumes=(readings.AI_15_STATUS["a"],)
    )
    reports = tuple(_waits(one) for one in due)
    names = (*before, *_names_in(due), *runs)
    kept = Step(evolve(after, waiting=(*here.waiting, *reports)), names=names, rules=ids)
    yield evolve(kept, assumes=(readings.AI_15_STATUS["b"],))
    # What waits for the codelet's tick is not due before that: whether it is lost shows only where time passes.
    yield evolve(kept, assumes=tuple(one.when["b"] for one in due[:1]))


# Lines.


@functools.lru_cache(maxsize=20_000)
def arrives(here: Codelet, event: Arrives, refs: Refs) -> tuple[Step, ...]:
    """A line arrives, which may bring the codelet to say its name, or that its mission runs."""
    if not here.connected:
        return ()
    return tuple(talk for step in _read(here, event, refs) for talk in _talks(here, step))


def _talks(here: Codelet, step: Step) -> Iterator[Step]:
    """What is said again and again may be said on any occasion, not only when time passes."""
    reported = _reports(step, _old(here), 0) if step.after == here and here.quiet else (step,)
    for one in reported:
        yield from _introduces(one, 0) if here.nameless else (one,)


def _read(here: Codelet, event: Arrives, refs: Refs) -> tuple[Step, ...]:
    """What comes of a line that arrives, by its channel and its content."""
    ignored = Step(here, rules=(rules.IGNORES.id,))
    if event.channel != here.world.channel:
        return (ignored,)
    if event.foreign:
        ways = (*_starts(here, event), *(_fails(here, event, None) if event.garbled else ()))
        return evolve(ignored, assumes=(readings.AI_27_TYPE["a"],)), *_all(ways, (readings.AI_27_TYPE["b"],))
    if event.mission is None:
        return (ignored,)
    found = tuple(_mission(here, event, refs))
    for odd, question in ((event.numeric, readings.AI_25_TAKEN), (event.untyped, readings.AI_27_TAKEN)):
        if odd:
            fails = _all(_fails(here, _unread(event), readings.AI_33_PREEMPTS["preempts-written"]), (question["c"],))
            found = (*_all(found, (question["a"],)), evolve(ignored, assumes=(question["b"],)), *fails)
    if event.garbled:
        # What is not written as documented need not be treated alike twice: no sentence is about it.
        found = (*found, ignored, *_fails(here, _unread(event), None))
    return found


def _unread(event: Arrives) -> Arrives:
    """The mission of which the identifier may not have been understood."""
    return evolve(event, named=False)


def _all(steps: Iterator[Step] | tuple[Step, ...], assumes: tuple[Assumption, ...]) -> tuple[Step, ...]:
    return tuple(evolve(step, assumes=(*assumes, *step.assumes)) for step in steps)


@frozen
class Doubt:
    """Something about a mission for which a robot may not run it.

    Attributes:
        question: what becomes of it.
        preempts: what becomes of the mission that runs, where that one does not.
        runs, fails, passed: the letters of the question under which it runs, fails, and is passed over.
        no_message: whether what is passed over is no message, so that nothing becomes of the mission that runs.
    """

    question: Ambiguity
    preempts: Ambiguity
    runs: str = "a"
    fails: str = "b"
    passed: str = "c"
    no_message: bool = False


_CONFIGURED: dict[str, Doubt] = {
    NULL: Doubt(readings.AI_33_CONFIGURED["null"], readings.AI_33_PREEMPTS["preempts-null"]),
    BLANK: Doubt(readings.AI_33_CONFIGURED["blank"], readings.AI_33_PREEMPTS["preempts-blank"]),
    SHALLOW: Doubt(readings.AI_33_CONFIGURED["node"], readings.AI_33_PREEMPTS["preempts-node"]),
    ODD: Doubt(readings.AI_33_CONFIGURED["value"], readings.AI_33_PREEMPTS["preempts-value"], "b", "a"),
    UNUSABLE: Doubt(readings.AI_33_UNUSABLE, readings.AI_33_PREEMPTS["preempts"], "b", "a"),
}
"""What may be wrong with a configuration."""

_MISPLACED = Doubt(readings.AI_28_TAKEN, readings.AI_33_PREEMPTS["preempts-written"], no_message=True)
_UNKNOWN = Doubt(readings.AI_33_CONFIGURED["unknown"], readings.AI_33_PREEMPTS["preempts-unknown"])


def _doubts(event: Arrives) -> tuple[Doubt, ...]:
    """Why a mission may not run, each asked about once those before it are no reason."""
    written = (_MISPLACED,) if event.misplaced else ()
    unknown = (_UNKNOWN,) if event.nodes else ()
    configured = (_CONFIGURED[event.mission],) if event.mission in _CONFIGURED else ()
    return (*written, *unknown, *configured)


def _mission(here: Codelet, event: Arrives, refs: Refs) -> Iterator[Step]:
    """A MissionProto arrives."""
    taken: tuple[Assumption, ...] = ()
    if event.named and here.mission and refs[:1] == here.mission:
        taken = (readings.AI_32_SAME["a"],)
        yield Step(here, rules=(rules.IGNORES.id,), assumes=(readings.AI_32_SAME["b"],))
    for doubt in _doubts(event):
        yield from _all(_fails(here, event, doubt.preempts), (*taken, doubt.question[doubt.fails]))
        yield from _all(_passed_over(here, doubt), (*taken, doubt.question[doubt.passed]))
        taken = (*taken, doubt.question[doubt.runs])
    yield from _all(_starts(here, event), taken)


def _passed_over(here: Codelet, doubt: Doubt) -> Iterator[Step]:
    """A mission arrives that is not run, and nothing is said of it."""
    ignored = Step(here, rules=(rules.IGNORES.id,))
    if doubt.no_message or not here.running:
        yield ignored
        return
    due = (Due("failure", _old(here), readings.AI_31_SENT["preempted"], offered=True),)
    preempts = _concluded(here, here.moved("an unusable mission arrives"), None, due, (rules.PREEMPTS,))
    yield from _all(preempts, (doubt.preempts["a"],))
    yield evolve(ignored, assumes=(doubt.preempts["b"],))


def _old(here: Codelet) -> int | None:
    return here.mission[0] if here.mission else None


def _starts(here: Codelet, event: Arrives) -> Iterator[Step]:
    """A mission arrives that can be run."""
    new = NEW if event.named else None
    after = evolve(here, named=event.named).moved("a mission arrives")
    because: tuple[Rule, ...] = (rules.STARTS,)
    due: tuple[Due, ...] = ()
    if here.running:
        due = (Due("failure", _old(here), readings.AI_31_SENT["preempted"], offered=True),)
        because = (rules.PREEMPTS, *because)
    elif here.used:
        because = (rules.LISTENS, *because)
    yield from _concluded(here, after, new, due, because)


def _fails(here: Codelet, event: Arrives, asked: Ambiguity | None) -> Iterator[Step]:
    """A mission arrives that cannot be run, and is said to have failed.

    Args:
        asked: the question what becomes of the mission that runs then; None where that may be this or that each time.
    """
    preempted, kept = ((asked["a"],), (asked["b"],)) if asked else ((), ())
    new = NEW if event.named else None
    for offered, said in ((False, readings.AI_33_RUNNING["a"]), (True, readings.AI_33_RUNNING["b"])):
        failure = Due("failure", new, readings.AI_31_SENT["unusable"], offered)
        if not here.running:
            after = evolve(here, named=False).moved("an unusable mission arrives")
            because = (rules.UNUSABLE, *((rules.LISTENS,) if here.used else ()))
            yield from _all(_concluded(here, after, None, (failure,), because), (said,))
            continue
        ended = here.moved("an unusable mission arrives")
        due = (Due("failure", _old(here), readings.AI_31_SENT["preempted"], offered=True), failure)
        preempts = _concluded(here, ended, None, due, (rules.UNUSABLE, rules.PREEMPTS))
        yield from _all(preempts, (said, *preempted))
        goes_on = _concluded(here, here, _old(here), (failure,), (rules.UNUSABLE,))
        yield from _all(goes_on, (said, *kept))


# The behavior tree.

_STOPS = {
    "behaviorSucceeded": ("the tree reports success", "success"),
    "behaviorFailed": ("the tree reports failure", "failure"),
}


@functools.lru_cache(maxsize=20_000)
def stops(here: Codelet, event: Happening, _: Refs) -> tuple[Step, ...]:
    """The behavior tree stops; RUNNING may still be on its way, the final status is the last word."""
    trigger, status = _STOPS[event.name]
    if here.running:
        due = (Due(status, _old(here), readings.AI_31_SENT["end"], offered=True),)
        ends = tuple(_concluded(here, here.moved(trigger), None, due, (FINAL[status],)))
    elif here.connected:
        ends = (Step(here, assumes=(readings.AI_31_IDLE["b"],)),)
    else:
        return ()
    return tuple(talk for step in ends for talk in (_talks(here, step) if here.connected else (step,)))


def ticks(here: Codelet) -> tuple[Step, ...]:
    """The codelet's own tick: the statuses that waited are sent."""
    if not (here.connected and here.waiting):
        return ()
    because = dict.fromkeys(FINAL[one.status].id for one in here.waiting)
    offers = (_offer(here, _old(here)),) if here.running else ()
    after = evolve(here, waiting=(), waited=0)
    return (Step(after, names=here.mission, emits=(*_all_waiting(here), *offers), rules=tuple(because)),)


# Time.


@functools.lru_cache(maxsize=20_000)
def passes(here: Codelet, event: Passes, _: Refs) -> tuple[Step, ...]:
    """Time passes: what has to be said within a bound was said by now, or may have been."""
    if not here.begun:
        return ()
    if not here.connected:
        # What was on its way when the connection dropped has come by now.
        return tuple(evolve(step, clears=(STATUSES, NAMES, OTHERS)) for step in _awaits(here, event.time))
    starts: tuple[Step, ...] = (Step(here),)
    if here.waiting:
        # What waits is sent in this time, or waits on.
        starts = ticks(here)
        if here.waited + event.time < TICK:
            starts += (Step(evolve(here, waited=here.waited + event.time)),)
    reported = (step for start in starts for step in _reports(start, _old(here), event.time))
    return tuple(step for one in reported for step in _introduces(one, event.time))


def _awaits(here: Codelet, time: int) -> Iterator[Step]:
    """Time passes without a connection: what waits becomes due, and is lost or kept, or waits for the tick."""
    if not here.waiting:
        yield Step(here)
        return
    kept = tuple(one for one in here.waiting if one.kept)
    if kept == here.waiting:
        yield Step(here, rules=(rules.LINKED.id,))
        return
    lost = evolve(here, waiting=kept, waited=0)
    names = (*_kept_names(here), *here.mission)
    yield Step(lost, names=names, rules=(rules.LINKED.id,), assumes=(readings.AI_15_STATUS["a"],))
    yield Step(here, rules=(rules.LINKED.id,), assumes=(readings.AI_15_STATUS["b"],))
    if here.waited + time < TICK:
        yield Step(evolve(here, waited=here.waited + time))


def _reports(step: Step, about: int | None, time: int) -> Iterator[Step]:
    """RUNNING of a mission with an identifier is reported in some time, or, if it is short enough, is not."""
    here: Codelet = step.after
    if not here.running or here.waiting:
        yield step
        return
    said = (_emission(here.world, "running", about), _offer(here, about))
    reported = evolve(here, quiet=0)
    yield evolve(step, after=reported, emits=step.emits + said, rules=(*step.rules, rules.RUNNING.id))
    if here.quiet + time < RUNNING_BOUND and not step.emits:
        yield evolve(step, after=evolve(here, quiet=here.quiet + time), withdraws=(STATUSES,))


def _introduces(step: Step, time: int) -> Iterator[Step]:
    """The name is said in some time, or, if it is short enough, is not."""
    here: Codelet = step.after
    said = (introduction(here.world), introduction(here.world, offer=True))
    introduced = evolve(here, nameless=0)
    yield evolve(step, after=introduced, emits=step.emits + said, rules=(*step.rules, rules.NAMED.id))
    if here.nameless + time < NAME_BOUND:
        silent = evolve(here, nameless=here.nameless + time)
        yield evolve(step, after=silent, withdraws=(*step.withdraws, NAMES))


# The connection.


@functools.lru_cache(maxsize=20_000)
def connection(here: Codelet, event: Happening, _: Refs) -> tuple[Step, ...]:
    """The connection drops, with all that was on its way or behind that, or is there again."""
    if event.name == "connect":
        return () if here.connected or not here.begun else (_connected(here),)
    if not here.connected:
        return ()
    gone = Step(evolve(here, connected=False), lingers=(STATUSES, NAMES, OTHERS), rules=(rules.LINKED.id,))
    ways = (gone, _forgetful(gone)) if here.waiting else (gone,)
    if not here.running:
        return ways
    return (
        *(evolve(way, assumes=(*way.assumes, readings.AI_15_MISSION["a"])) for way in ways),
        *(_given_up(way) for way in ways),
        *(_failed(way) for way in ways),
    )


def _forgetful(gone: Step) -> Step:
    """The statuses that waited are lost with the connection (AI-15.status a)."""
    here: Codelet = gone.after
    after = evolve(here, waiting=(), waited=0)
    return evolve(gone, after=after, names=here.mission, assumes=(readings.AI_15_STATUS["a"],))


def _given_up(gone: Step) -> Step:
    """The mission that runs is given up with the connection (AI-15.mission b)."""
    here: Codelet = gone.after
    after = here.moved("the connection drops")
    return evolve(gone, after=after, names=here.waits, assumes=(*gone.assumes, readings.AI_15_MISSION["b"]))


def _failed(gone: Step) -> Step:
    """The mission that runs fails with the connection, and its FAILURE waits with what waits (AI-15.mission c)."""
    here: Codelet = gone.after
    failure = Waiting("failure", here.named, offered=False, kept=True)
    after = evolve(here.moved("the connection drops"), waiting=(*here.waiting, failure))
    names = tuple(range(here.identifiers)) if gone.names is None else gone.names
    return evolve(gone, after=after, names=names, assumes=(*gone.assumes, readings.AI_15_MISSION["c"]))


def _connected(here: Codelet) -> Step:
    after = evolve(here, connected=True, quiet=0, nameless=0, waited=0)
    emits = [introduction(here.world, offer=True), _anything(here.world)]
    if here.running and not here.waiting:
        emits.append(_offer(here, _old(here)))
    return Step(after, emits=tuple(emits), clears=(STATUSES, NAMES, OTHERS), rules=(rules.NAMED.id,))


def begins(here: Codelet) -> tuple[Step, ...]:
    """The connection, which is there from the start, is opened like any other."""
    if here.begun:
        return ()
    openings = (
        Opening(STATUSES, 0, kind="connection"),
        Opening(NAMES, 0, (introduction(here.world, offer=True),), kind="connection"),
        Opening(OTHERS, 0, (_anything(here.world),), kind="connection"),
    )
    return (Step(evolve(here, begun=True, connected=True), opens=openings),)
