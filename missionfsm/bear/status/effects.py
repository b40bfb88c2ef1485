"""What the calls of the Robot Status page do where they are not refused, and what reports, restarts and moves show."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping

from attrs import evolve

from missionfsm.bear.status.messages import (
    BatteryState,
    ConnectionState,
    ErrorCodes,
    NavigationState,
    RobotState,
    Stuck,
    Twist,
    Wifi,
)
from missionfsm.bear.status.readings import (
    AS_07,
    AS_09_OFFLINE,
    AS_09_STATE,
    AS_09_UNKNOWN,
    AS_09_UNSET,
    AS_13_FIELDS,
    AS_13_THROTTLE,
    AS_17_OFFLINE,
    AS_17_ZERO,
    AS_18,
    AS_25,
    AS_27,
    AS_28,
    AS_29_EMPTY,
    AS_32,
    AS_34,
)
from missionfsm.bear.status.rules import OPERATIONS, foreign, own, ranking
from missionfsm.bear.status.state import (
    GET,
    LOCALIZATION,
    STATE_PARTS,
    TOPICAL,
    WIFI,
    Endpoint,
    Fleet,
    Happening,
    Moves,
    Request,
    Robot,
    Value,
    reporting,
)
from missionfsm.bear.status.stream import UPDATES, Promised, Seen, Topic, View, each, shows, told, view
from missionfsm.bear.status.values import clamped
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
from missionfsm.kernel.spec import Emission, Failure, Opening, Step

Assumed = tuple[Assumption, ...]
TRANSPORT = (UNAUTHENTICATED, RESOURCE_EXHAUSTED, UNIMPLEMENTED, UNAVAILABLE, CANCELLED)


# Calls.


def outcomes(
    fleet: Fleet,
    request: Request,
    _: tuple[int | None, ...],
    operations: Mapping[str, Operation] = OPERATIONS,
) -> tuple[Step, ...]:
    """Every answer that the page allows to a call, success first."""
    operation = operations[request.operation]
    found: list[Step] = []
    for decision in decide(operation.blocking(fleet, request), ranking):
        if decision.code is None:
            rules = tuple(rule.id for rule in operation.promises)
            ways = _latest(fleet, request) if request.operation == GET else _opened(fleet, request)
            found += (evolve(one, assumes=(*decision.assumes, *one.assumes), rules=rules) for one in ways)
        else:
            rules = tuple(rule.id for rule in decision.rules)
            found.append(Step(fleet, answer=Answer(decision.code), assumes=decision.assumes, rules=rules))
    if request.operation == GET and fleet.fault:
        found = [_failed(fleet, one) for one in found]
    found.sort(key=lambda one: one.answer != Answer(OK))
    return tuple(found)


def failing(_: Request, code: str) -> Failure | None:
    """Codes that may come at any time: INTERNAL, and (AS-34) those of the transport and of authentication."""
    if code == INTERNAL:
        return Failure()
    return Failure((AS_34["b"],), driven=False) if code in TRANSPORT else None


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
        anything = View(robot.id, Endpoint.ROBOT, unheard=True)
        yield _got(fleet, anything, Seen("", Endpoint.ROBOT, RobotState()), ())
        yield Step(fleet, answer=Answer(INTERNAL), assumes=(AS_07["b"],))
        return
    full = View(robot.id, Endpoint.ROBOT, robot.state, offline=robot.offline)
    bare = evolve(full, value=RobotState(connection=robot.state.connection))
    for seen, assumes in shows(full):
        yield _got(fleet, full, evolve(seen, robot=""), (*assumes, *((AS_07["a"],) if robot.offline else ())))
    if robot.offline:
        for seen, assumes in shows(bare):
            yield _got(fleet, bare, evolve(seen, robot=""), (*assumes, AS_07["c"]))
        yield Step(fleet, answer=Answer(INTERNAL), assumes=(AS_07["b"],))


def _got(fleet: Fleet, shown: View, seen: Seen, assumes: Assumed) -> Step:
    return Step(fleet, answer=Answer(OK, Promised(shown, seen)), assumes=assumes)


def _opened(fleet: Fleet, request: Request) -> Iterator[Step]:
    """A subscription: a channel for every robot that it may ever be about, and what each is shown first."""
    endpoint = Endpoint(request.operation)
    by_location = request.location is not None
    selected = fleet.at(request.location or "") if by_location else own(fleet, request)
    candidates = tuple(one for one in fleet.robots if one.owned) if by_location else selected
    partly = not by_location and bool(foreign(fleet, request))
    topics = [Topic(endpoint, one.id, request.location, one in selected, partly) for one in candidates]
    if not topics:
        topics = [Topic(endpoint, "", request.location)]
    for owed, assumes in _firsts(fleet, endpoint, selected):
        opens = tuple(Opening(topic, 0, owed.get(topic.robot, ())) for topic in topics)
        yield Step(fleet, opens=opens, answer=Answer(OK), refs=(0,), assumes=assumes)
    for ambiguity in (AS_09_UNKNOWN, AS_09_STATE, AS_09_OFFLINE):
        if any(ambiguity in _open_questions(fleet, endpoint, robot) for robot in selected):
            yield Step(fleet, answer=Answer(INTERNAL), assumes=(ambiguity["d"],))


def _open_questions(fleet: Fleet, endpoint: Endpoint, robot: Robot) -> tuple[Ambiguity, ...]:
    """On which entries it depends what a new stream shows first of a robot."""
    shown = view(robot, endpoint)
    if endpoint is Endpoint.NETWORK:
        return (AS_27,) if fleet.unheard or (shown and not shown.linked) else ()
    if shown is None:
        return (AS_09_STATE,) if endpoint is Endpoint.ROBOT else (AS_09_UNKNOWN,)
    return (AS_09_OFFLINE,) if (robot.offline or fleet.unheard) and endpoint is not Endpoint.ONLINE else ()


_LETTERS = {AS_09_UNKNOWN: "bc", AS_09_STATE: "bc", AS_09_OFFLINE: "abc", AS_27: "abc"}


def _firsts(
    fleet: Fleet, endpoint: Endpoint, selected: tuple[Robot, ...]
) -> Iterator[tuple[dict[str, tuple[Emission, ...]], Assumed]]:
    """The first messages of a stream by robot, for every combination of the readings that matter."""
    questions = dict.fromkeys(one for robot in selected for one in _open_questions(fleet, endpoint, robot))
    for letters in itertools.product(*(_LETTERS[one] for one in questions)):
        choice = dict(zip(questions, letters, strict=True))
        owed = {
            robot.id: tuple(
                _first(fleet, robot, endpoint, [choice[one] for one in _open_questions(fleet, endpoint, robot)])
            )
            for robot in selected
        }
        yield owed, tuple(one[letter] for one, letter in choice.items())


def _first(fleet: Fleet, robot: Robot, endpoint: Endpoint, letters: list[str]) -> Iterator[Emission]:
    topic = told(fleet, robot, endpoint)
    letter = letters[0] if letters else "a"
    shown = view(robot, endpoint)
    if fleet.unheard:
        anything = View(robot.id, endpoint, unheard=True)
        if letter == "a":
            yield Emission(topic, anything, ())
        yield Emission(topic, anything, (), stays=True)
    elif shown is None and letter == "c":
        yield _blank(topic, robot, endpoint)
    elif shown is None or (endpoint is Endpoint.NETWORK and letter == "c"):
        return
    elif letter == "c" and endpoint is not Endpoint.NAVIGATION:
        yield _blank(topic, robot, endpoint)
    elif letter != "b" or endpoint is Endpoint.NETWORK:
        yield Emission(topic, shown, ())


def _blank(topic: object, robot: Robot, endpoint: Endpoint) -> Emission:
    """UNKNOWN values; of a stuck state only if AS-18 is read so."""
    only = AS_18["b"] if endpoint is Endpoint.NAVIGATION else None
    return Emission(topic, View(robot.id, endpoint, blank=True, offline=robot.offline), (), only=only)


# Drives.


def reported(fleet: Fleet, event: Happening, _: tuple[int | None, ...]) -> tuple[Step, ...]:
    """A robot reports the value of a part; without a robot: nobody knows what robots report."""
    if not event.robot:
        return () if fleet.unheard else (_forgotten(fleet),)
    robot = fleet.robot(event.robot)
    if robot is None:
        return ()
    return tuple(
        step
        for value, assumes in _accepted(robot, event.part, event.value)
        for step in _reported(fleet, robot, event.part, value, assumes)
    )


def _forgotten(fleet: Fleet) -> Step:
    """Any robot may report anything from now on: every stream may show it any number of times."""
    after = evolve(fleet, unheard=True)
    emits = tuple(
        Emission(told(fleet, robot, endpoint), View(robot.id, endpoint, unheard=True), (), stays=True)
        for endpoint, robot in each(one for one in fleet.robots if one.owned)
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
        yield right, (AS_28["a"],)
        yield robot.part(part), (AS_28["b"],)


def _reported(fleet: Fleet, robot: Robot, part: str, value: Value, assumes: Assumed) -> Iterator[Step]:
    if part == LOCALIZATION:
        # Its content is not looked at (AS-24), so whether a message is due is not known either.
        shown = view(robot, Endpoint.ROBOT)
        emits = (Emission(told(fleet, robot, Endpoint.ROBOT), shown, (), stays=True),) if shown and robot.owned else ()
        yield Step(fleet, emits=emits, assumes=assumes, label="report")
        return
    if value is None and part in TOPICAL.values() and part != WIFI and robot.part(part) is not None:
        for letter in "abc":
            after = reporting(robot, part, None, keep=letter == "a")
            yield from _shown(fleet, robot, after, part, (*assumes, AS_09_UNSET[letter]), blank=letter == "c")
    else:
        yield from _shown(fleet, robot, reporting(robot, part, value), part, assumes)


def _shown(  # noqa: PLR0913 - what a report is made of
    fleet: Fleet, before: Robot, after: Robot, part: str, assumes: Assumed, *, blank: bool = False
) -> Iterator[Step]:
    """What a change of a robot shows, in every combination of the readings that matter."""
    into = fleet.put(after)
    if not after.owned or after == before:
        yield Step(into, assumes=assumes, label="report")
        return
    ways: list[list[tuple[tuple[Emission, ...], Assumed]]] = []
    for endpoint, topical in TOPICAL.items():
        if topical == part:
            ways.append(list(_topical(into, before, after, endpoint, blank=blank)))
    if part in STATE_PARTS:
        ways.append(list(_whole(into, before, after, part)))
    if part == "connection":
        ways.append([(tuple(_reconnected(into, before, after)), ())])
    for combination in itertools.product(*ways):
        emits = tuple(one for emissions, _ in combination for one in emissions)
        assumed = tuple(one for _, more in combination for one in more)
        rules = (UPDATES.id,) if emits else ()
        yield Step(into, emits=emits, assumes=(*assumes, *assumed), rules=rules, label="report")


def _ways(
    fleet: Fleet, shown: View, robot: Robot, lenient: Iterable[Assumption]
) -> Iterator[tuple[tuple[Emission, ...], Assumed]]:
    """A message that is due; or, under each of some readings, one that may be sent from now on."""
    topic = told(fleet, robot, shown.endpoint)
    lenient = tuple(lenient)
    strict = tuple(one.of.besides(*one.letters) for one in lenient)
    yield (Emission(topic, shown, ()),), strict
    for one in lenient:
        yield (Emission(topic, shown, (), optional=True),), (one,)


def _topical(
    fleet: Fleet, before: Robot, after: Robot, endpoint: Endpoint, *, blank: bool
) -> Iterator[tuple[tuple[Emission, ...], Assumed]]:
    """A stream with a single topic, after a report about that topic."""
    if blank:
        yield (_blank(told(fleet, after, endpoint), after, endpoint),), ()
        return
    shown = view(after, endpoint)
    if shown is None or (shown == view(before, endpoint)):
        yield (), ()
    elif endpoint is Endpoint.NETWORK and not shown.linked:
        yield (Emission(told(fleet, after, endpoint), shown, (), optional=True, only=_told_of(shown)),), ()
    else:
        yield from _ways(fleet, shown, after, _minor(endpoint, before, after))


def _told_of(shown: View) -> Assumption | None:
    """AS-27: the readings without which nothing is told of a robot that is not known to be connected."""
    return None if shown.endpoint is not Endpoint.NETWORK or shown.linked or shown.unheard else AS_27["a", "b"]


def _minor(endpoint: Endpoint, before: Robot, after: Robot) -> Iterator[Assumption]:
    """AS-13: the readings under which a change need not be streamed, since it is a small one."""
    old, new = (
        (before.wifi, after.wifi) if endpoint is Endpoint.NETWORK else (before.topic(endpoint), after.topic(endpoint))
    )
    if isinstance(old, BatteryState) and isinstance(new, BatteryState) and old.state == new.state:
        yield AS_13_FIELDS["b"]
    if isinstance(old, NavigationState) and isinstance(new, NavigationState) and _stuck(old) == _stuck(new):
        yield AS_13_FIELDS["b"]
    if isinstance(old, Wifi) and isinstance(new, Wifi) and (old.ssid, old.security) == (new.ssid, new.security):
        yield AS_13_THROTTLE["b"]


def _stuck(navigation: NavigationState) -> Stuck | None:
    return navigation.stuck_state.state if navigation.stuck_state else None


def _whole(fleet: Fleet, before: Robot, after: Robot, part: str) -> Iterator[tuple[tuple[Emission, ...], Assumed]]:
    """SubscribeRobotStatus, after a report about a part of the state."""
    old, new = before.part(part), after.part(part)
    if before.state == after.state:
        yield (), ()
        return
    lenient: list[Assumption] = []
    if part in ("pose", "twist") and old is not None and new is not None:
        lenient.append(AS_13_THROTTLE["b"])
    if part == "twist" and {old, new} <= {None, Twist()}:
        lenient.append(AS_17_ZERO["b"])
    if part == "twist" and after.offline:
        lenient.append(AS_17_OFFLINE["c"])
    if part in ("servi_state", "carti_state"):
        lenient.append(AS_32["b"])
    if part == "error_codes" and {old, new} <= {None, ErrorCodes()}:
        lenient += (AS_29_EMPTY["c"], AS_29_EMPTY["d"])
    shown = View(after.id, Endpoint.ROBOT, after.state, offline=after.offline)
    if not after.seen:
        # The robot reports nothing at all any more: what that looks like is AS-09.
        yield (Emission(told(fleet, after, Endpoint.ROBOT), shown, (), optional=True),), ()
        return
    yield from _ways(fleet, shown, after, lenient)


def _reconnected(fleet: Fleet, before: Robot, after: Robot) -> Iterator[Emission]:
    """What a change of the connection may bring to the other streams: what they withheld, or a network that is gone."""
    network = view(after, Endpoint.NETWORK)
    if network:
        yield Emission(told(fleet, after, Endpoint.NETWORK), network, (), stays=True, only=_told_of(network))
    if before.offline and after.connection is ConnectionState.STATE_CONNECTED:
        for endpoint in (Endpoint.BATTERY, Endpoint.ERRORS, Endpoint.NAVIGATION):
            shown = view(after, endpoint)
            if shown:
                yield Emission(told(fleet, after, endpoint), shown, (), optional=True, only=AS_09_OFFLINE["b", "c"])


def restarted(fleet: Fleet, event: Happening, _: tuple[int | None, ...]) -> tuple[Step, ...]:
    """A robot restarts: its numbers start over, and it may announce itself on every stream."""
    robot = fleet.robot(event.robot)
    if robot is None:
        return ()
    emits = tuple(
        Emission(told(fleet, robot, endpoint), shown, (), stays=True, only=_told_of(shown))
        for endpoint in Endpoint
        if robot.owned and not fleet.unheard and (shown := view(robot, endpoint))
    )
    return (Step(fleet, emits=emits, label="restart"),)


def moved(fleet: Fleet, event: Happening, _: tuple[int | None, ...]) -> tuple[Step, ...]:
    """A robot is at another location from now on; whether streams by location follow it is AS-25."""
    robot = fleet.robot(event.robot)
    if robot is None:
        return ()
    after = evolve(robot, location=str(event.value))
    if after == robot:
        return (Step(fleet, label="move"),)
    found = []
    for moves, letter in ((Moves.FIXED, "a"), (Moves.FOLLOWED, "b")):
        into = evolve(fleet.put(after), moves=moves)
        emits: tuple[Emission, ...] = ()
        if moves is Moves.FOLLOWED and robot.owned:
            # It joins the streams of its new place; those by robot ids may see it announced again.
            emits = tuple(
                Emission(told(into, after, endpoint), shown, (), stays=True, only=_told_of(shown))
                for endpoint in Endpoint
                if (shown := _anything(fleet, after, endpoint))
            )
        found.append(Step(into, emits=emits, assumes=(AS_25[letter],), label="move"))
    return tuple(found)


def _anything(fleet: Fleet, robot: Robot, endpoint: Endpoint) -> View | None:
    return View(robot.id, endpoint, unheard=True) if fleet.unheard else view(robot, endpoint)


def armed(fleet: Fleet, _: Happening, __: tuple[int | None, ...]) -> tuple[Step, ...]:
    """The next GetRobotStatus that would succeed fails."""
    return (Step(fleet if fleet.fault else evolve(fleet, fault=True), label="fault"),)


__all__ = ["armed", "moved", "outcomes", "reported", "restarted"]
