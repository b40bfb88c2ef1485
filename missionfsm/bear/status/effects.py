"""What the calls of the Robot Status page do where they are not refused, and what reports, restarts and moves show."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Iterator, Mapping

from attrs import evolve

from missionfsm.bear.status.messages import (
    BatteryState,
    ConnectionState,
    NavigationState,
    RobotConnection,
    RobotState,
    Stuck,
    Wifi,
)
from missionfsm.bear.status.readings import (
    AS_04,
    AS_04_BLANK,
    AS_07,
    AS_07_UNKNOWN,
    AS_09_GONE,
    AS_09_OFFLINE,
    AS_09_UNKNOWN,
    AS_09_UNSET,
    AS_13_FIELDS,
    AS_13_SIGNAL,
    AS_13_THROTTLE,
    AS_18,
    AS_25,
    AS_27_OFFLINE,
    AS_28,
    AS_34,
)
from missionfsm.bear.status.rules import OPERATIONS, foreign, own, ranking
from missionfsm.bear.status.state import (
    GET,
    LOCALIZATION,
    STATE_PARTS,
    TOPICAL,
    Endpoint,
    Fleet,
    Happening,
    Request,
    Robot,
    Value,
    reporting,
)
from missionfsm.bear.status.stream import UPDATES, shows
from missionfsm.bear.status.values import clamped
from missionfsm.bear.status.views import Promised, Seen, Told, Topic, View, blank, each, view
from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.rules import (
    CANCELLED,
    INTERNAL,
    OK,
    RESOURCE_EXHAUSTED,
    UNAUTHENTICATED,
    UNAVAILABLE,
    UNIMPLEMENTED,
    Operation,
    decide,
)
from missionfsm.kernel.spec import Failure
from missionfsm.kernel.step import Emission, Opening, Step

Assumed = tuple[Assumption, ...]
TRANSPORT = (UNAUTHENTICATED, RESOURCE_EXHAUSTED, UNIMPLEMENTED, UNAVAILABLE, CANCELLED)


# Calls.


def outcomes(
    fleet: Fleet,
    request: Request,
    _: tuple[int | None, ...],
    operations: Mapping[str, Operation] = OPERATIONS,
    alone: str | None = None,
) -> tuple[Step, ...]:
    """Every answer that the page allows to a call, success first.

    Args:
        alone: the one robot that subscriptions are looked at for; None for all of them.
    """
    operation = operations[request.operation]
    found: list[Step] = []
    for asked, assumed in _arms(request):
        for decision in decide(operation.blocking(fleet, asked), functools.partial(ranking, asked, fleet)):
            assumes = (*assumed, *decision.assumes)
            if decision.code is None:
                rules = tuple(rule.id for rule in operation.promises)
                ways = _latest(fleet, asked) if asked.operation == GET else _opened(fleet, asked, alone)
                found += (evolve(one, assumes=(*assumes, *one.assumes), rules=rules) for one in ways)
            else:
                rules = tuple(rule.id for rule in decision.rules)
                found.append(Step(fleet, answer=Answer(decision.code), assumes=assumes, rules=rules))
    if request.operation == GET and fleet.fault:
        found = [_failed(fleet, one) for one in found]
    found.sort(key=lambda one: one.answer != Answer(OK))
    return tuple(found)


def _arms(request: Request) -> Iterator[tuple[Request, Assumed]]:
    """AS-04: what a request asks for that has robot ids and a location: both, or one of them alone."""
    if not request.both or not (request.ids or request.location):
        yield request, ()
        return
    by_ids, by_location = evolve(request, location=None), evolve(request, ids=(), by_ids=False, repeated=False)
    if request.ids and request.location:
        question = AS_04[request.operation]
        yield request, (question["a"],)
        yield by_location, (question["b"],)
        yield by_ids, (question["e"],)
    else:
        question = AS_04_BLANK["location" if request.ids else "ids"][request.operation]
        yield request, (question["a"],)
        yield by_ids if request.ids else by_location, (question["z"],)


def failing(request: Request, code: str) -> Failure | None:
    """Codes that may come at any time: INTERNAL, and (AS-34) those of the transport and of authentication.

    Faults are driven for GetRobotStatus alone: to a subscription INTERNAL may come whoever drives what.
    """
    if code == INTERNAL:
        return Failure(drive="fault" if request.operation == GET else None)
    return Failure((AS_34[request.operation]["b"],)) if code in TRANSPORT else None


def _failed(fleet: Fleet, step: Step) -> Step:
    """The step, or the failure that a tester has armed in its place."""
    if step.answer is None or step.answer.code != OK:
        return step
    return Step(evolve(fleet, fault=False), answer=Answer(INTERNAL), assumes=step.assumes, label="the armed fault")


def _latest(fleet: Fleet, request: Request) -> Iterator[Step]:
    """GetRobotStatus: the state of the robot, in every form that a reading gives it."""
    robot = fleet.robot(request.ids[0])
    assert robot is not None, "a robot that does not exist is refused"  # noqa: S101 - said by the rules
    if fleet.unheard:
        anything = View(robot.id, Endpoint.ROBOT, unheard=True, got=True)
        yield _got(fleet, anything, Seen("", Endpoint.ROBOT, RobotState()), ())
        return
    full = View(robot.id, Endpoint.ROBOT, robot.state, got=True)
    question = AS_07 if robot.offline else None if robot.seen else AS_07_UNKNOWN
    for seen, assumes in shows(full):
        yield _got(fleet, full, evolve(seen, robot=""), (*assumes, *((question["a"],) if question else ())))
    if question is AS_07:
        bare = evolve(full, value=RobotState(connection=robot.state.connection))
        for seen, assumes in shows(bare):
            yield _got(fleet, bare, evolve(seen, robot=""), (*assumes, AS_07["c"]))
    if question:
        yield Step(fleet, answer=Answer(INTERNAL), assumes=(question["b"],))


def _got(fleet: Fleet, shown: View, seen: Seen, assumes: Assumed) -> Step:
    return Step(fleet, answer=Answer(OK, Promised(shown, seen)), assumes=assumes)


def _opened(fleet: Fleet, request: Request, alone: str | None) -> Iterator[Step]:
    """A subscription: a channel for every robot that it may ever be about, and what each is shown first."""
    endpoint = Endpoint(request.operation)
    by_location = request.location is not None
    selected = fleet.at(request.location or "") if by_location else own(fleet, request)
    candidates = tuple(one for one in fleet.robots if one.owned) if by_location else selected
    if alone is not None:
        selected, candidates = (tuple(one for one in some if one.id == alone) for some in (selected, candidates))
    partly = not by_location and bool(foreign(fleet, request))
    topics = [Topic(endpoint, one.id, request.location, one in selected, partly) for one in candidates]
    if not topics:
        topics = [Topic(endpoint, "", request.location)]
    for owed, assumes in _firsts(fleet, endpoint, selected):
        opens = tuple(Opening(topic, 0, owed.get(topic.robot, ())) for topic in topics)
        yield Step(fleet, opens=opens, answer=Answer(OK), refs=(0,), assumes=assumes)


def _question(fleet: Fleet, endpoint: Endpoint, robot: Robot) -> Ambiguity | None:
    """On which ambiguity it depends what a new stream shows first of a robot."""
    shown = view(robot, endpoint)
    if endpoint is Endpoint.NETWORK:
        return AS_27_OFFLINE if fleet.unheard else shown.unlinked if shown else None
    if shown is None:
        return (AS_09_GONE if robot.offline and endpoint.value in AS_09_GONE else AS_09_UNKNOWN)[endpoint.value]
    offline = (robot.offline or fleet.unheard) and endpoint is not Endpoint.ONLINE
    return AS_09_OFFLINE[endpoint.value] if offline else None


def _firsts(
    fleet: Fleet, endpoint: Endpoint, selected: tuple[Robot, ...]
) -> Iterator[tuple[dict[str, tuple[Emission, ...]], Assumed]]:
    """The first messages of a stream by robot, for every combination of the readings that matter."""
    questions = {robot.id: _question(fleet, endpoint, robot) for robot in selected}
    asked = [one for one in dict.fromkeys(questions.values()) if one]
    for letters in itertools.product(*(one.readings for one in asked)):
        choice: dict[Ambiguity | None, str] = {None: "a", **dict(zip(asked, letters, strict=True))}
        owed = {robot.id: tuple(_first(fleet, robot, endpoint, choice[questions[robot.id]])) for robot in selected}
        yield owed, tuple(one[letter] for one, letter in zip(asked, letters, strict=True))


def _first(fleet: Fleet, robot: Robot, endpoint: Endpoint, letter: str) -> Iterator[Emission]:
    """What a new stream shows first of a robot, as its question is read: a, without one."""
    topic = Told(endpoint, robot.id, robot.location)
    shown = view(robot, endpoint)
    if fleet.unheard:
        anything = View(robot.id, endpoint, unheard=True)
        if letter == "a" and shown:
            yield Emission(topic, anything, ())
        yield Emission(topic, anything, (), stays=True)
    elif letter == "e":
        yield Emission(topic, View(robot.id, endpoint, RobotConnection(ConnectionState.STATE_DISCONNECTED)), ())
    elif endpoint is Endpoint.NETWORK:
        if shown and letter != "c":
            yield Emission(topic, shown, ())
    elif letter == "c":
        yield _blank(topic, robot, endpoint)
    elif shown and letter == "a":
        yield Emission(topic, shown, ())


def _blank(topic: Told, robot: Robot, endpoint: Endpoint) -> Emission:
    """UNKNOWN values; of a stuck state only if AS-18 is read so."""
    only = AS_18[endpoint.value]["b"] if endpoint is Endpoint.NAVIGATION else None
    return Emission(topic, blank(robot, endpoint), (), only=only)


# Drives.


def reported(fleet: Fleet, event: Happening, _: tuple[int | None, ...], alone: str | None = None) -> tuple[Step, ...]:
    """A robot reports the value of a part; without a robot: nobody knows what robots report, or what this one does."""
    if not event.robot:
        return () if fleet.unheard else (_forgotten(fleet, alone),)
    robot = fleet.robot(event.robot)
    if robot is None:
        return ()
    if fleet.unheard:
        # What it reported before may have been the same, and of its other parts nothing is known: nothing is due.
        return (Step(fleet, label="report"),)
    return tuple(
        step
        for value, assumes in _accepted(robot, event.part, event.value)
        for step in _reported(fleet, robot, event.part, value, assumes)
    )


def _forgotten(fleet: Fleet, alone: str | None) -> Step:
    """Any robot may report anything from now on: every stream may show it any number of times."""
    after = evolve(fleet, unheard=True)
    emits = tuple(
        Emission(Told(endpoint, robot.id, robot.location), View(robot.id, endpoint, unheard=True), (), stays=True)
        for endpoint, robot in each(one for one in fleet.robots if one.owned and alone in (None, one.id))
    )
    return Step(after, emits=emits, label="robots report by themselves")


def _accepted(robot: Robot, part: str, value: Value) -> Iterator[tuple[Value, Assumed]]:
    """AS-28: what becomes of a report; one of a stuck state that is an error (AS-18) is not passed on."""
    if isinstance(value, NavigationState) and (not value.stuck_state or value.stuck_state.state == Stuck.STATE_UNKNOWN):
        yield robot.part(part), ()
        return
    right = clamped(value)
    if right is value:
        yield value, ()
    else:
        yield right, (AS_28[part]["a"],)
        yield robot.part(part), (AS_28[part]["b"],)


Way = tuple[tuple[Emission, ...], Assumed]
"""What a report makes one kind of stream show, and the readings that this assumes."""


def _reported(fleet: Fleet, robot: Robot, part: str, value: Value, assumes: Assumed) -> Iterator[Step]:
    if part == LOCALIZATION:
        # Its content is not looked at (AS-24), so whether a message is due is not known either.
        shown = view(robot, Endpoint.ROBOT)
        ways = _addressed(robot, Endpoint.ROBOT, shown, stays=True) if shown and robot.owned else [((), ())]
        for emits, assumed in ways:
            yield Step(fleet, emits=emits, assumes=(*assumes, *assumed), label="report")
        return
    endpoint = next((one for one, topic in TOPICAL.items() if topic == part), None)
    if value is None and endpoint in _UNSET and robot.part(part) is not None:
        question = AS_09_UNSET[endpoint.value]
        for letter in question.readings:
            after = reporting(robot, part, None, keep=letter == "a")
            yield from _shown(
                fleet, robot, after, part, (*assumes, question[letter]), unset=_unset(after, endpoint, letter)
            )
    else:
        yield from _shown(fleet, robot, reporting(robot, part, value), part, assumes)


def _unset(robot: Robot, endpoint: Endpoint, letter: str) -> View | None:
    """AS-09: what a stream shows of a topic that is not reported any more; None for nothing."""
    if letter == "e":
        return View(robot.id, endpoint, RobotConnection(ConnectionState.STATE_DISCONNECTED))
    return blank(robot, endpoint) if letter == "c" else None


_UNSET = tuple(one for one in Endpoint if one.value in AS_09_UNSET)


def _shown(  # noqa: PLR0913 - what a report is made of
    fleet: Fleet, before: Robot, after: Robot, part: str, assumes: Assumed, *, unset: View | None = None
) -> Iterator[Step]:
    """What a change of a robot shows, in every combination of the readings that matter."""
    into = fleet.put(after)
    if not after.owned or after == before:
        yield Step(into, assumes=assumes, label="report")
        return
    ways: list[list[Way]] = []
    for endpoint, topical in TOPICAL.items():
        if topical == part:
            ways.append(list(_topical(before, after, endpoint, unset=unset)))
    if part in STATE_PARTS:
        ways.append(list(_whole(before, after, part)))
    if part == "connection":
        ways += _reconnected(before, after)
    for combination in itertools.product(*ways):
        emits = tuple(one for emissions, _ in combination for one in emissions)
        assumed = tuple(one for _, more in combination for one in more)
        rules = (UPDATES.id,) if emits else ()
        yield Step(into, emits=emits, assumes=(*assumes, *assumed), rules=rules, label="report")


def _addressed(  # noqa: PLR0913 - an emission's own fields
    robot: Robot,
    endpoint: Endpoint,
    shown: View,
    *,
    only: Assumption | None = None,
    optional: bool = False,
    stays: bool = False,
) -> list[Way]:
    """A message about a robot, once for each way to find its streams (AS-25), which matters once it has moved."""
    question = AS_25[endpoint.value]
    return [
        (
            (Emission(Told(endpoint, robot.id, robot.location, followed), shown, (), only, optional, stays),),
            (question["b" if followed else "a"],) if robot.moved else (),
        )
        for followed in ((False, True) if robot.moved else (False,))
    ]


def _due(robot: Robot, endpoint: Endpoint, shown: View, lenient: Iterable[Assumption] = ()) -> Iterator[Way]:
    """A message that is due; or, under each of some readings, one that may be sent from now on."""
    lenient = tuple(lenient)
    strict = tuple(one.ambiguity.besides(*one.letters) for one in lenient)
    for emits, assumed in _addressed(robot, endpoint, shown):
        yield emits, (*strict, *assumed)
    for one in lenient:
        for emits, assumed in _addressed(robot, endpoint, shown, optional=True):
            yield emits, (one, *assumed)


def _topical(before: Robot, after: Robot, endpoint: Endpoint, *, unset: View | None) -> Iterator[Way]:
    """A stream with a single topic, after a report about that topic."""
    if unset:
        only = AS_18[endpoint.value]["b"] if endpoint is Endpoint.NAVIGATION else None
        yield from _addressed(after, endpoint, unset, only=only)
        return
    shown = view(after, endpoint)
    if shown is None or shown == view(before, endpoint):
        yield (), ()
    elif shown.unlinked:
        yield from _addressed(after, endpoint, shown, optional=True, only=shown.unlinked["a", "b"])
    else:
        yield from _due(after, endpoint, shown, _minor(endpoint, before, after))


def _withheld(before: Robot, after: Robot, endpoint: Endpoint) -> Iterator[Assumption]:
    """AS-09: the readings under which what an offline robot reports is shown only once it is back."""
    if before.offline and after.offline and endpoint.value in AS_09_OFFLINE:
        yield AS_09_OFFLINE[endpoint.value]["b", "c"]


def _minor(endpoint: Endpoint, before: Robot, after: Robot) -> Iterator[Assumption]:
    """The readings under which a change need not be streamed: a small one (AS-13), or one of an offline robot."""
    yield from _withheld(before, after, endpoint)
    old, new = (
        (before.wifi, after.wifi) if endpoint is Endpoint.NETWORK else (before.topic(endpoint), after.topic(endpoint))
    )
    if isinstance(old, BatteryState) and isinstance(new, BatteryState) and old.state == new.state:
        yield AS_13_FIELDS[endpoint.value]["b"]
    if isinstance(old, NavigationState) and isinstance(new, NavigationState) and _stuck(old) == _stuck(new):
        yield AS_13_FIELDS[endpoint.value]["b"]
    if isinstance(old, Wifi) and isinstance(new, Wifi) and (old.ssid, old.security) == (new.ssid, new.security):
        yield AS_13_SIGNAL["b"]


def _stuck(navigation: NavigationState) -> Stuck | None:
    return navigation.stuck_state.state if navigation.stuck_state else None


def _whole(before: Robot, after: Robot, part: str) -> Iterator[Way]:
    """SubscribeRobotStatus, after a report about a part of the state."""
    if before.state == after.state:
        yield (), ()
        return
    shown = View(after.id, Endpoint.ROBOT, after.state)
    if not after.seen:
        # The robot reports nothing at all any more: what that looks like is AS-09.
        yield from _addressed(after, Endpoint.ROBOT, shown, optional=True)
        return
    lenient = list(_withheld(before, after, Endpoint.ROBOT))
    if part in AS_13_THROTTLE and before.part(part) is not None and after.part(part) is not None:
        lenient.append(AS_13_THROTTLE[part]["b"])
    yield from _due(after, Endpoint.ROBOT, shown, lenient)


def _reconnected(before: Robot, after: Robot) -> Iterator[list[Way]]:
    """What a change of the connection brings to the other streams: what they withheld, or a network that is gone."""
    network = view(after, Endpoint.NETWORK)
    if network and network.unlinked:
        only = network.unlinked["a", "b"]
        yield _addressed(after, Endpoint.NETWORK, network, stays=True, only=only)
    elif network:
        yield _addressed(after, Endpoint.NETWORK, network)
    if before.offline and not after.offline:
        for endpoint in (Endpoint.BATTERY, Endpoint.ERRORS, Endpoint.NAVIGATION):
            shown = view(after, endpoint)
            if shown:
                question = AS_09_OFFLINE[endpoint.value]
                back = [
                    (emits, (*assumed, question["b", "c"])) for emits, assumed in _addressed(after, endpoint, shown)
                ]
                yield [*back, ((), (question["a"],))]


def restarted(fleet: Fleet, event: Happening, _: tuple[int | None, ...]) -> tuple[Step, ...]:
    """A robot restarts: its numbers start over, and it may announce itself on every stream."""
    robot = fleet.robot(event.robot)
    if robot is None:
        return ()
    if not robot.owned or fleet.unheard:
        return (Step(fleet, label="restart"),)
    ways = [
        _addressed(robot, endpoint, shown, stays=True, only=shown.unlinked["a", "b"] if shown.unlinked else None)
        for endpoint in Endpoint
        if (shown := view(robot, endpoint))
    ]
    return tuple(
        Step(
            fleet,
            emits=tuple(one for emissions, _ in combination for one in emissions),
            assumes=tuple(one for _, assumed in combination for one in assumed),
            label="restart",
        )
        for combination in itertools.product(*ways)
    )


def moved(fleet: Fleet, event: Happening, _: tuple[int | None, ...]) -> tuple[Step, ...]:
    """A robot is at another location from now on; it may join the streams of that one (AS-25)."""
    robot = fleet.robot(event.robot)
    if robot is None:
        return ()
    after = evolve(robot, location=str(event.value), moved=True)
    if after.location == robot.location:
        return (Step(fleet, label="move"),)
    emits = tuple(
        Emission(
            Told(endpoint, after.id, after.location, followed=True), shown, (), AS_25[endpoint.value]["b"], stays=True
        )
        for endpoint in Endpoint
        if robot.owned and (shown := _anything(fleet, after, endpoint))
    )
    return (Step(fleet.put(after), emits=emits, label="move"),)


def _anything(fleet: Fleet, robot: Robot, endpoint: Endpoint) -> View | None:
    return View(robot.id, endpoint, unheard=True) if fleet.unheard else view(robot, endpoint)


def armed(fleet: Fleet, _: Happening, __: tuple[int | None, ...]) -> tuple[Step, ...]:
    """The next GetRobotStatus that would succeed fails."""
    return (Step(fleet if fleet.fault else evolve(fleet, fault=True), label="fault"),)


__all__ = ["armed", "moved", "outcomes", "reported", "restarted"]
