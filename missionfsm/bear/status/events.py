"""What the environment does to a fleet, and what subscribers come to see of it."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping

from attrs import evolve

from missionfsm.bear.status.messages import (
    BatteryState,
    ConnectionState,
    NavigationState,
    RobotConnection,
    Stuck,
    Wifi,
)
from missionfsm.bear.status.readings.selecting import AS_03_SERVED
from missionfsm.bear.status.readings.streams import AS_13_FIELDS, AS_13_SIGNAL, AS_13_THROTTLE, AS_25
from missionfsm.bear.status.readings.unknown import AS_09_OFFLINE, AS_09_UNSET
from missionfsm.bear.status.readings.values import AS_18, AS_28, AS_32
from missionfsm.bear.status.state import (
    LOCALIZATION,
    STATE_PARTS,
    TOPICAL,
    TYPED,
    Endpoint,
    Event,
    Fleet,
    Robot,
    Value,
    reporting,
)
from missionfsm.bear.status.stream import UPDATES
from missionfsm.bear.status.values import clamped
from missionfsm.bear.status.views import BLANK, MEMBERS, About, Assumed, Tie, View, blank, each, view
from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.step import Emission, Step
from missionfsm.kernel.terms import Refs


def reported(fleet: Fleet, event: Event, _: Refs, alone: str | None = None) -> tuple[Step, ...]:
    """A robot reports the value of a part. Without a robot: nobody knows what all robots, or this one alone, report."""
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
        Emission(
            About(endpoint, robot.id, robot.location),
            View(robot.id, endpoint, unheard=True),
            (),
            only=None if robot.owned else AS_03_SERVED[endpoint.value]["s"],
            stays=True,
        )
        for endpoint, robot in each(one for one in fleet.robots if alone in (None, one.id))
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
            yield from _reporting_steps(
                fleet, robot, after, part, (*assumes, question[letter]), unset=_unset(after, endpoint, letter)
            )
    elif value is None and robot.part(part) is None:
        yield Step(fleet.put(reporting(robot, part, None)), assumes=assumes, label="report")
    else:
        yield from _reporting_steps(fleet, robot, reporting(robot, part, value), part, assumes)


def _unset(robot: Robot, endpoint: Endpoint, letter: str) -> View | None:
    """AS-09: what a stream shows of a topic that is not reported any more; None for nothing."""
    if letter == "e":
        return View(robot.id, endpoint, RobotConnection(ConnectionState.STATE_DISCONNECTED))
    return blank(robot, endpoint) if letter == "c" else None


_UNSET = tuple(one for one in Endpoint if one.value in AS_09_UNSET)


def _reporting_steps(
    fleet: Fleet, before: Robot, after: Robot, part: str, assumes: Assumed, *, unset: View | None = None
) -> Iterator[Step]:
    """What a change of a robot shows, in every combination of the readings that matter."""
    into = fleet.put(after)
    if not after.owned or after == before:
        emits = () if after == before else tuple(_of_others(after, part))
        yield Step(into, emits=emits, assumes=assumes, label="report")
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


def _of_others(robot: Robot, part: str) -> Iterator[Emission]:
    """AS-03: what streams that serve robots of somebody else may show of a change of one."""
    for endpoint in Endpoint:
        shown = view(robot, endpoint)
        concerned = part == TOPICAL[endpoint] if endpoint in TOPICAL else part in STATE_PARTS
        if shown and concerned:
            only = AS_03_SERVED[endpoint.value]["s"]
            yield Emission(About(endpoint, robot.id, robot.location), shown, (), only=only)


def _addressed(
    robot: Robot,
    endpoint: Endpoint,
    shown: View,
    *,
    only: Assumption | None = None,
    optional: bool = False,
    stays: bool = False,
) -> list[Way]:
    """A message about a robot, once for each way to find its streams (AS-25), which matters once it has moved.

    Of one that may be left out nobody sees which streams it should have been on: only one that shows it decides that.
    """
    about, question = About(endpoint, robot.id, robot.location, robot.left), AS_25[endpoint.value]
    message = Emission(about, shown, (), only, optional, stays)
    if not robot.left:
        return [((message,), ())]
    if only is None and (optional or stays):
        return [(tuple(_offered(message, about, question)), ())]
    ways: list[Way] = []
    for letters, owed, besides in _FOLLOWING:
        emits = [evolve(message, topic=evolve(about, ties=owed))]
        for ties, some in besides.items():
            also = evolve(message, topic=evolve(about, ties=ties))
            emits.append(evolve(also, optional=True) if some == letters else evolve(also, only=only or question[some]))
        ways.append((tuple(emits), (question[letters],)))
    return ways


_Letters = tuple[str, ...]
_Ties = tuple[Tie, ...]
_FOLLOWING: tuple[tuple[_Letters, _Ties, Mapping[_Ties, _Letters]], ...] = (
    # Of those that have come nobody sees whether the stream began before they did, so that nothing of them is owed.
    (("a", "d"), MEMBERS, {(Tie.COME, Tie.PASSED): ("d",)}),
    (("b",), (Tie.NAMED, Tie.STAYED, Tie.COME), {}),
    # It may have left in between, and a stream that it has left does not follow it when it is back.
    (("c", "e"), (Tie.NAMED,), {(Tie.STAYED,): ("c", "e")}),
)
"""Letters of AS-25: the ties of the streams on which a robot that has moved is due, and by which ties, and letters of
those, it may be shown besides."""


def _follow(tie: Tie) -> Iterator[str]:
    """The letters of AS-25 under which a stream may show a robot that has moved and belongs to it so."""
    for letters, owed, besides in _FOLLOWING:
        yield from letters if tie in owed else ()
        for ties, some in besides.items():
            yield from some if tie in ties else ()


_FOLLOWED: Mapping[Tie, _Letters] = {tie: tuple(sorted(_follow(tie))) for tie in Tie}


def _offered(message: Emission, about: About, question: Ambiguity) -> Iterator[Emission]:
    """A message that may be left out, for each tie of a stream on which it may come, with the letters of AS-25."""
    for tie, letters in _FOLLOWED.items():
        only = question[letters] if len(letters) < len(question.readings) else None
        yield evolve(message, topic=evolve(about, ties=(tie,)), only=only)


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
    if part in TYPED:
        lenient.append(AS_32[Endpoint.ROBOT.value]["b"])  # where it is left out, nothing has changed
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
                # Once the robot has moved, nothing is required then: which streams follow it would be asked of all
                # endpoints at once, in too many combinations.
                found = _addressed(after, endpoint, shown, optional=bool(after.left))
                back = [(emits, (*assumed, question["b", "c"])) for emits, assumed in found]
                yield [*back, ((), (question["a"],))]


def restarted(fleet: Fleet, event: Event, _: Refs) -> tuple[Step, ...]:
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


def moved(fleet: Fleet, event: Event, _: Refs) -> tuple[Step, ...]:
    """A robot moves to another location, whose streams it may join (AS-25)."""
    robot = fleet.robot(event.robot)
    if robot is None:
        return ()
    after = evolve(robot, location=str(event.value), left=tuple(sorted({*robot.left, robot.location})))
    if after.location == robot.location:
        return (Step(fleet, label="move"),)
    emits = tuple(
        Emission(About(endpoint, after.id, after.location, after.left, _HERE), shown, (), only, stays=True)
        for endpoint in Endpoint
        if robot.owned
        for shown, only in _joining(fleet, after, endpoint)
    )
    return (Step(fleet.put(after), emits=emits, label="move"),)


_HERE = (Tie.STAYED, Tie.COME)
"""The ties of a robot to the streams of the location where it is."""


def _joining(fleet: Fleet, robot: Robot, endpoint: Endpoint) -> Iterator[tuple[View, Assumption]]:
    """What a stream of a location may show of a robot that has come: what a new one could begin with (AS-09)."""
    followed = AS_25[endpoint.value][_FOLLOWED[Tie.COME]]
    if fleet.unheard:
        yield View(robot.id, endpoint, unheard=True), followed
        return
    shown = view(robot, endpoint)
    if shown:
        yield shown, followed
    if endpoint in BLANK and (shown is None or robot.offline):
        yield blank(robot, endpoint), AS_18[endpoint.value]["b"] if endpoint is Endpoint.NAVIGATION else followed
    if endpoint is Endpoint.ONLINE and shown is None:
        yield View(robot.id, endpoint, RobotConnection(ConnectionState.STATE_DISCONNECTED)), followed


def armed(fleet: Fleet, _: Event, __: Refs) -> tuple[Step, ...]:
    """The next GetRobotStatus that would succeed fails."""
    return (Step(fleet if fleet.fault else evolve(fleet, fault=True), label="fault"),)
