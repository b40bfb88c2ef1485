"""What the calls of the Robot Status page do where they are not refused; what drives do is in `events`."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Iterator, Mapping

from attrs import evolve

from missionfsm.bear.status.messages import (
    ConnectionState,
    RobotConnection,
    RobotState,
)
from missionfsm.bear.status.readings.selecting import AS_03_SERVED, AS_04, AS_04_BLANK, AS_34
from missionfsm.bear.status.readings.unknown import (
    AS_07,
    AS_07_UNKNOWN,
    AS_09_CEASED,
    AS_09_GONE,
    AS_09_OFFLINE,
    AS_09_UNKNOWN,
    AS_27_OFFLINE,
)
from missionfsm.bear.status.readings.values import AS_18
from missionfsm.bear.status.rules import OPERATIONS, foreign, own, ranking
from missionfsm.bear.status.state import (
    GET,
    Endpoint,
    Fleet,
    Request,
    Robot,
    Unset,
    whose,
)
from missionfsm.bear.status.stream import renderings
from missionfsm.bear.status.views import BLANK, About, Assumed, Promised, Seen, Topic, View, blank, view
from missionfsm.bear.wire.codes import UNLISTED
from missionfsm.kernel.history import Answer
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.rules import (
    INTERNAL,
    OK,
    Decision,
    Operation,
    decide,
)
from missionfsm.kernel.spec import Failure
from missionfsm.kernel.step import Emission, Opening, Step
from missionfsm.kernel.terms import Refs

# Calls.


def outcomes(
    fleet: Fleet,
    request: Request,
    _: Refs,
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
        for decision in _decisions(operation, whose(fleet), asked):
            assumes = (*assumed, *decision.assumes)
            if decision.code is None:
                rules = tuple(rule.id for rule in operation.promises)
                ways = _latest(fleet, asked) if asked.operation == GET else _opened(fleet, asked, alone)
                found += (evolve(one, assumes=(*assumes, *one.assumes), rules=rules) for one in ways)
            else:
                found.append(decision.refused(fleet, assumed))
    if request.operation == GET and fleet.fault:
        found = [_failed(fleet, one) for one in found]
    found.sort(key=lambda one: one.answer != Answer(OK))
    return tuple(found)


@functools.lru_cache(maxsize=10_000)
def _decisions(operation: Operation, fleet: Fleet, asked: Request) -> tuple[Decision, ...]:
    """What the rules decide about a request; whose robots and locations there are is all that it depends on."""
    return decide(operation.blocking(fleet, asked), functools.partial(ranking, asked, fleet))


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
    return Failure((AS_34[request.operation]["b"],)) if code in UNLISTED else None


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
    for seen, assumes in renderings(full):
        yield _got(fleet, full, evolve(seen, robot=""), (*assumes, *((question["a"],) if question else ())))
    if question is AS_07:
        bare = evolve(full, value=RobotState(connection=robot.state.connection))
        for seen, assumes in renderings(bare):
            yield _got(fleet, bare, evolve(seen, robot=""), (*assumes, AS_07["c"]))
    if question:
        yield Step(fleet, answer=Answer(INTERNAL), assumes=(question["b"],))


def _got(fleet: Fleet, shown: View, seen: Seen, assumes: Assumed) -> Step:
    return Step(fleet, answer=Answer(OK, Promised(shown, seen)), assumes=assumes)


def _opened(fleet: Fleet, request: Request, alone: str | None) -> Iterator[Step]:
    """A subscription: a channel for every robot that it may ever be about, and what each is shown first."""
    endpoint = Endpoint(request.operation)
    selected, others, candidates = (
        tuple(one for one in some if alone is None or one.id == alone) for some in _subscribed(fleet, request)
    )
    partly = request.location is None and bool(foreign(fleet, request))
    there = (*selected, *others)
    topics = [Topic(endpoint, one.id, request.location, one in there, partly) for one in candidates]
    if not topics:
        topics = [Topic(endpoint, "", request.location)]
    perhaps = {one.id: tuple(_first_of_others(fleet, one, endpoint)) for one in others}
    for first, assumes in _firsts(fleet, endpoint, selected):
        owed = {**first, **perhaps}
        opens = tuple(Opening(topic, 0, owed.get(topic.robot, ())) for topic in topics)
        yield Step(fleet, opens=opens, answer=Answer(OK), refs=(0,), assumes=assumes)


def _subscribed(fleet: Fleet, request: Request) -> tuple[Iterable[Robot], Iterable[Robot], Iterable[Robot]]:
    """The robots that a subscription selects now, those of others that it may show, and all it may ever be about."""
    if request.location is None:
        selected = own(fleet, request)
        return selected, (), selected
    others = tuple(_others_at(fleet, request.location))
    return fleet.at(request.location), others, (*(one for one in fleet.robots if one.owned), *others)


def _others_at(fleet: Fleet, location: str | None) -> Iterator[Robot]:
    """Robots of somebody else at a location of the account."""
    place = fleet.location(location or "")
    if place is not None and place.owned:
        yield from (one for one in fleet.robots if not one.owned and one.location == location)


def _first_of_others(fleet: Fleet, robot: Robot, endpoint: Endpoint) -> Iterator[Emission]:
    """AS-03: the first message about somebody else's robot, on a stream that serves it."""
    unknown = blank(robot, endpoint) if endpoint in BLANK else None
    shown = View(robot.id, endpoint, unheard=True) if fleet.unheard else view(robot, endpoint) or unknown
    if shown:
        about = About(endpoint, robot.id, robot.location)
        yield Emission(about, shown, (), only=AS_03_SERVED[endpoint.value]["s"], stays=fleet.unheard)


def _question(fleet: Fleet, endpoint: Endpoint, robot: Robot) -> Ambiguity | None:
    """On which ambiguity it depends what a new stream shows first of a robot; None where that is certain, or free."""
    shown = view(robot, endpoint)
    if endpoint is Endpoint.NETWORK:
        return AS_27_OFFLINE if fleet.unheard else shown.unlinked if shown else None
    if shown is None and robot.unset(endpoint):
        return None if robot.offline or robot.unset(endpoint) is Unset.TOLD else AS_09_CEASED[endpoint.value]
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
    topic = About(endpoint, robot.id, robot.location)
    shown = view(robot, endpoint)
    if fleet.unheard:
        anything = View(robot.id, endpoint, unheard=True)
        if letter == "a" and shown:
            yield Emission(topic, anything, ())
        yield Emission(topic, anything, (), stays=True)
    elif letter == "e":
        yield _disconnected(topic)
    elif endpoint is Endpoint.NETWORK:
        if shown and letter != "c":
            yield Emission(topic, shown, ())
    elif letter == "c":
        yield _blank(topic, robot, endpoint)
    elif shown and letter == "a":
        yield Emission(topic, shown, ())
    elif letter == "a":  # AS-09: it is offline as well, or said of itself what nobody had asked
        yield evolve(_blank(topic, robot, endpoint), optional=True)
        for question in (AS_09_UNKNOWN, AS_09_CEASED) if endpoint is Endpoint.ONLINE else ():
            yield evolve(_disconnected(topic), only=question[endpoint.value]["e"])


def _disconnected(topic: About) -> Emission:
    view = View(topic.robot, topic.endpoint, RobotConnection(ConnectionState.STATE_DISCONNECTED))
    return Emission(topic, view, ())


def _blank(topic: About, robot: Robot, endpoint: Endpoint) -> Emission:
    """UNKNOWN values; of a stuck state only if AS-18 is read so."""
    only = AS_18[endpoint.value]["b"] if endpoint is Endpoint.NAVIGATION else None
    return Emission(topic, blank(robot, endpoint), (), only=only)


# Drives.
