"""In which situations of a fleet a tester should have asked what: who watches whom, and what then changes."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping

from missionfsm.bear.status.messages import RobotConnection, RobotState
from missionfsm.bear.status.samples import CONNECTIONS, CONVEYOR, at, by_ids, report
from missionfsm.bear.status.state import (
    GET,
    STATE_PARTS,
    TOPICAL,
    Endpoint,
    Event,
    Fleet,
    Request,
    Robot,
)
from missionfsm.bear.status.views import Topic
from missionfsm.bear.wire.protojson import camel
from missionfsm.kernel.alphabet import Bounds, ScriptStep
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.matrix import Matrix
from missionfsm.kernel.terms import Refs

NOBODY, SEVERAL = "nobody watches", "several streams are watched"
ONE, SOME, PLACE = "one robot", "several robots", "a location"
OFFLINE = " that is offline"
AGAIN, UP = "comes again", "comes up"
_SELECTIONS = {ONE: by_ids("r1"), SOME: by_ids("r1", "r2"), PLACE: at("L1")}

Streams = tuple[tuple[Topic, ...], ...]
"""The streams that are open, each as what its channels are about."""


def situation(_: Fleet, streams: Streams) -> str:
    """The situation that a fleet is in: which subscription is open, and whom it is to."""
    if len(streams) != 1:
        return SEVERAL if streams else NOBODY
    (topics,) = streams
    whom = PLACE if topics[0].location is not None else ONE if len(topics) == 1 else SOME
    return f"{topics[0].endpoint.value} to {whom}"


def columns(fleet: Fleet, streams: Streams, asked: Request | Event, _: Refs = ()) -> tuple[str, ...]:
    """The kinds of actions that a request or an event is an example of."""
    if isinstance(asked, Request):
        return tuple(_of_request(fleet, streams, asked))
    return (_of_event(fleet, streams, asked),)


def _of_request(fleet: Fleet, streams: Streams, asked: Request) -> Iterator[str]:
    kind = _whom(_outline(fleet), asked)
    if not streams:
        yield f"{asked.operation} of {kind}"
    # What is watched has no say in whether a request is right: those that are will do.
    elif asked.operation == GET:
        if kind in (ONE, f"{ONE}{OFFLINE}"):
            yield f"{GET} of {kind}"
    elif kind in (ONE, SOME, PLACE):
        watched = {topics[0].endpoint.value for topics in streams}
        yield "the same subscription" if asked.operation in watched else "another subscription"


@functools.lru_cache(maxsize=1_000)
def _outline(fleet: Fleet) -> Fleet:
    """All of a fleet that decides whom a request is about; the same object for fleets that are alike in it."""
    return _outlined(tuple(map(_as_known, fleet.robots)), fleet.locations)


_outlined = functools.lru_cache(maxsize=1_000)(Fleet)


@functools.lru_cache(maxsize=1_000)
def _as_known(robot: Robot) -> Robot:
    said = RobotState(connection=robot.state.connection or RobotConnection()) if robot.seen else RobotState()
    return Robot(robot.id, robot.location, robot.owned, said)


@functools.lru_cache(maxsize=10_000)
def _whom(fleet: Fleet, asked: Request) -> str:
    """Whom a request is about, or what is wrong with it."""
    if asked.malformed or asked.bare or asked.unknown_fields:
        return "a malformed request"
    if asked.location is not None:
        return "robots and a location" if asked.by_ids else _which_location(fleet, asked.location)
    return _which_robots(fleet, asked) if any(asked.ids) else "nobody"


def _which_location(fleet: Fleet, name: str) -> str:
    location = fleet.location(name)
    if location is None:
        return "an unknown location"
    whose = "a location" if location.owned else "somebody else's location"
    return whose if fleet.at(name) else f"{whose} without robots"


def _which_robots(fleet: Fleet, asked: Request) -> str:
    robots = [robot for robot in map(fleet.robot, asked.ids) if robot]
    alone = len(asked.ids) == 1
    if len(robots) < len(asked.ids):
        return "an unknown robot" if alone else "an unknown robot and another"
    if not all(robot.owned for robot in robots):
        return "somebody else's robot" if alone else "somebody else's robot and another"
    if asked.repeated:
        return "the same robot twice"
    return f"{ONE}{_situation(robots[0])}" if alone else SOME


def _situation(robot: Robot) -> str:
    return OFFLINE if robot.offline else "" if robot.seen else " that never reported anything"


def _of_event(fleet: Fleet, streams: Streams, event: Event) -> str:
    robot = fleet.robot(event.robot)
    if robot is None:
        return event.name
    topics = [one for topics in streams for one in topics if one.robot == robot.id and _follows(one, robot)]
    whose = "a watched robot" if topics else "a robot that nobody watches"
    if event.name == "move":
        return f"{whose} {'stays where it is' if event.value == robot.location else 'moves'}"
    offline = OFFLINE if robot.offline and topics else ""
    if event.name != "report":
        return f"{event.name} of {whose}{offline}"
    return _of_report(robot, topics, event, whose, offline, many=len(streams) > 1)


def _of_report(robot: Robot, topics: list[Topic], event: Event, whose: str, offline: str, *, many: bool) -> str:
    if not any(event.part in _parts_of(one.endpoint) for one in topics):
        return f"{whose} reports what is not shown"
    change = _change(robot.part(event.part), event.value)
    many = many or any(one.endpoint is Endpoint.ROBOT for one in topics)
    return f"{_part(event.part, change, offline, many=many)} {change}, of {whose}{offline}"


def _part(part: str, change: str, offline: str, *, many: bool) -> str:
    """What changed: of many parts that are shown any will do for what is the same for all."""
    return "a part" if many and (offline or change in (AGAIN, UP)) else part.replace("_", " ")


def _follows(topic: Topic, robot: Robot) -> bool:
    return topic.member if topic.location is None else topic.member or topic.location == robot.location


def _parts_of(endpoint: Endpoint) -> tuple[str, ...]:
    return (TOPICAL[endpoint],) if endpoint in TOPICAL else STATE_PARTS


def _change(before: object, after: object) -> str:
    if before == after:
        return AGAIN
    return UP if before is None else "is unset" if after is None else "changes"


def _reported(part: str, value: JSON) -> ScriptStep:
    return ScriptStep("drive", report("r1", part, value))


_OFF = _reported("connection", CONNECTIONS[1])
_CARTI = _reported("cartiState", CONVEYOR)
_SETTLE = ScriptStep("settle")


def _forgets(*parts: str) -> tuple[ScriptStep, ...]:
    return (*(_reported(camel(part), None) for part in parts), _SETTLE)


def _ways() -> Iterator[tuple[str, tuple[tuple[ScriptStep, ...], ...]]]:
    yield NOBODY, ((), (_OFF, _SETTLE))
    for endpoint in Endpoint:
        shown = _parts_of(endpoint)
        others = tuple(part for part in shown if part != "connection")
        for whom, selection in _SELECTIONS.items():
            begun = (ScriptStep(endpoint.value, selection), _SETTLE)
            ways = (
                begun,
                (*begun, _CARTI, _SETTLE),
                (*begun, *_forgets(*shown)),
                (*begun, _OFF, *_forgets(*others)),
            )
            yield f"{endpoint.value} to {whom}", ways
    battery, robot = (ScriptStep(one.value, _SELECTIONS[ONE]) for one in (Endpoint.BATTERY, Endpoint.ROBOT))
    yield (
        SEVERAL,
        (
            (battery, battery, _SETTLE),
            (battery, robot, _CARTI, _SETTLE),
            (battery, robot, *_forgets(*STATE_PARTS)),
            (battery, robot, _OFF, _SETTLE),
        ),
    )


WAYS: Mapping[str, tuple[tuple[ScriptStep, ...], ...]] = dict(_ways())

MATRIX = Matrix(situation, columns, WAYS, Bounds())
