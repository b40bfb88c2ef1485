"""What becomes of a robot when something happens to it: the steps of its drives.

What it has to say then is in `due`. Time passes only where the tester says so. No period is documented: RUNNING and the
name may come at any time, and have to come within their bounds. Of a time that is shorter it is asked whether they came
in it, and what they may still say then counts from there.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator

from attrs import evolve, frozen

from missionfsm.isaac.robot import due, readings, rules
from missionfsm.isaac.robot.inputs import BLANK, NULL, ODD, SHALLOW, UNUSABLE, Arrives
from missionfsm.isaac.robot.state import NAME_BOUND, RUNNING_BOUND, TICK, Codelet, Waiting
from missionfsm.isaac.shared.drives import Passes
from missionfsm.kernel.language import Ambiguity, Assumption, Happening, Refs, Rule, Step

NEW = -1
"""The reference to the identifier that a line brings along."""


# Lines.


@functools.lru_cache(maxsize=20_000)
def arrives(here: Codelet, event: Arrives, refs: Refs) -> tuple[Step, ...]:
    """A line arrives, which may bring the codelet to say its name, or that its mission runs."""
    if not here.connected:
        return ()
    return tuple(talk for step in _read(here, event, refs) for talk in _talks(here, step))


def _talks(here: Codelet, step: Step) -> Iterator[Step]:
    """What is said again and again may be said on any occasion, not only when time passes."""
    reported = _reports(step, here.about, 0) if step.after == here and here.quiet else (step,)
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
    preempts = due.concluded(here, here.moved("an unusable mission arrives"), None, _preempted(here), _following(here))
    yield from _all(preempts, (doubt.preempts["a"],))
    yield evolve(ignored, assumes=(doubt.preempts["b"],))


def _preempted(here: Codelet) -> due.Statuses:
    """What is due of the mission that runs, if one does, where another one ends it."""
    return (due.Status("failure", here.about, readings.AI_31_SENT["preempted"], offered=True),) if here.running else ()


def _following(here: Codelet) -> tuple[Rule, ...]:
    """What a mission that arrives is to the one before it."""
    if here.running:
        return (rules.PREEMPTS,)
    return (rules.LISTENS,) if here.used else ()


def _starts(here: Codelet, event: Arrives) -> Iterator[Step]:
    """A mission arrives that can be run."""
    after = evolve(here, named=event.named).moved("a mission arrives")
    new = NEW if event.named else None
    yield from due.concluded(here, after, new, _preempted(here), (*_following(here), rules.STARTS))


def _fails(here: Codelet, event: Arrives, asked: Ambiguity | None) -> Iterator[Step]:
    """A mission arrives that cannot be run, and is said to have failed.

    Args:
        asked: the question what becomes of the mission that runs then; None where that may be this or that each time.
    """
    preempted, kept = ((asked["a"],), (asked["b"],)) if asked and here.running else ((), ())
    new = NEW if event.named else None
    idle = here.moved("an unusable mission arrives")
    for offered, said in ((False, readings.AI_33_RUNNING["a"]), (True, readings.AI_33_RUNNING["b"])):
        failure = due.Status("failure", new, readings.AI_31_SENT["unusable"], offered)
        because = (rules.UNUSABLE, *_following(here))
        yield from _all(due.concluded(here, idle, None, (*_preempted(here), failure), because), (said, *preempted))
        if here.running:
            goes_on = due.concluded(here, here, here.about, (failure,), (rules.UNUSABLE,))
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
    unread = tuple(_stops_unread(here, trigger, status))
    ends: tuple[Step, ...] = ()
    if here.running:
        final = (due.Status(status, here.about, readings.AI_31_SENT["end"], offered=True),)
        ends = tuple(due.concluded(here, here.moved(trigger), None, final, (due.FINAL[status],)))
    elif here.connected:
        ends = (Step(here, assumes=(readings.AI_31_IDLE["b"],)),)
    ends = (*unread, *(_all(ends, (readings.AI_31_READ["a"],)) if unread else ends))
    return tuple(talk for step in ends for talk in (_talks(here, step) if here.connected else (step,)))


def _stops_unread(here: Codelet, trigger: str, status: str) -> Iterator[Step]:
    """The tree stops that runs because the lines that came meanwhile have not been read (AI-31.read b)."""
    unread = next((at for at, one in enumerate(here.waiting) if one.unread), None)
    if unread is None:
        return
    before, first, behind = here.waiting[:unread], here.waiting[unread], here.waiting[unread + 1 :]
    because, assumes = (due.FINAL[status].id,), (readings.AI_31_READ["b"],)
    if first.preempted:
        ended = evolve(first, status=status, preempted=False, unread=False)
        yield Step(evolve(here, waiting=(*before, ended, *behind)), rules=because, assumes=assumes)
    elif here.running:
        ended = Waiting(status, here.named, offered=True)
        at = sum(one.named for one in before)
        names = (*here.waits[:at], *here.mission, *here.waits[at:])
        after = evolve(here.moved(trigger), waiting=(*before, ended, first, *behind))
        yield Step(after, names=names, rules=because, assumes=assumes)


def ticks(here: Codelet) -> tuple[Step, ...]:
    """The codelet's own tick: the statuses that waited are sent."""
    if not (here.connected and here.waiting):
        return ()
    because = dict.fromkeys(due.FINAL[one.status].id for one in here.waiting)
    offers = (due.may_report(here, here.about),) if here.running else ()
    after = evolve(here, waiting=(), waited=0)
    return (Step(after, names=here.mission, emits=(*due.all_waiting(here), *offers), rules=tuple(because)),)


# Time.


@functools.lru_cache(maxsize=20_000)
def passes(here: Codelet, event: Passes, _: Refs) -> tuple[Step, ...]:
    """Time passes: what has to be said within a bound was said by now, or may have been."""
    if not here.begun:
        return ()
    if not here.connected:
        # What was on its way when the connection dropped has come by now.
        return tuple(evolve(step, clears=due.TOPICS) for step in _awaits(here, event.time))
    starts: tuple[Step, ...] = (Step(here),)
    if here.waiting:
        # What waits is sent in this time, or waits on.
        starts = ticks(here)
        if here.waited + event.time < TICK:
            starts += (Step(evolve(here, waited=here.waited + event.time)),)
    if here.earlier:
        starts = tuple(_said_by_now(step, event.time) for step in starts)
    reported = (step for start in starts for step in _reports(start, here.about, event.time))
    return tuple(step for one in reported for step in _introduces(one, event.time))


def _said_by_now(step: Step, time: int) -> Step:
    """Time passes in which statuses of missions from before the log are said."""
    here: Codelet = step.after
    left = here.earlier - time
    if left > 0 or here.earlier > 1:
        return evolve(step, after=evolve(here, earlier=max(1, left)))
    return evolve(step, after=evolve(here, earlier=0), withdraws=(due.STATUSES,))


def _kept_names(here: Codelet) -> tuple[int, ...]:
    """The positions of the identifiers of the statuses that wait and are not lost for want of a connection."""
    named = [one for one in here.waiting if one.named]
    return tuple(at for at, one in enumerate(named) if one.kept)


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
    said = (due.emission(here.world, "running", about), due.may_report(here, about))
    reported = evolve(here, quiet=0)
    yield evolve(step, after=reported, emits=step.emits + said, rules=(*step.rules, rules.RUNNING.id))
    if here.quiet + time < RUNNING_BOUND and not step.emits:
        yield evolve(step, after=evolve(here, quiet=here.quiet + time), withdraws=(due.STATUSES,))


def _introduces(step: Step, time: int) -> Iterator[Step]:
    """The name is said in some time, or, if it is short enough, is not."""
    here: Codelet = step.after
    said = (due.introduction(here.world), due.introduction(here.world, offer=True))
    introduced = evolve(here, nameless=0)
    yield evolve(step, after=introduced, emits=step.emits + said, rules=(*step.rules, rules.NAMED.id))
    if here.nameless + time < NAME_BOUND:
        silent = evolve(here, nameless=here.nameless + time)
        yield evolve(step, after=silent, withdraws=(*step.withdraws, due.NAMES))


# The connection.


@functools.lru_cache(maxsize=20_000)
def connection(here: Codelet, event: Happening, _: Refs) -> tuple[Step, ...]:
    """The connection drops, with all that was on its way or behind that, or is there again."""
    if event.name == "connect":
        return () if here.connected or not here.begun else (_connected(here),)
    if not here.connected:
        return ()
    gone = Step(evolve(here, connected=False), lingers=due.TOPICS, rules=(rules.LINKED.id,))
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
    after = evolve(here, connected=True, quiet=0, nameless=0, waited=0, earlier=TICK if here.earlier else 0)
    emits = [due.introduction(here.world, offer=True), due.anything(here.world), *due.of_before(after)]
    if here.running and not here.waiting:
        emits.append(due.may_report(here, here.about))
    return Step(after, emits=tuple(emits), clears=due.TOPICS, rules=(rules.NAMED.id,))
