"""The streams of the Robot Status page: what a message shows, what it may look like, and how one is made."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable, Iterator
from typing import Any

import attrs
from attrs import evolve, frozen

from missionfsm.bear.status.messages import (
    BatteryMode,
    BatteryState,
    ConnectionState,
    EmergencyStopState,
    ErrorCodes,
    NavigationState,
    RobotConnection,
    RobotState,
    StuckState,
    Twist,
)
from missionfsm.bear.status.readings import (
    AS_09_PART,
    AS_15_FULL,
    AS_17_OFFLINE,
    AS_17_ZERO,
    AS_18,
    AS_19,
    AS_21,
    AS_22,
    AS_27_OFFLINE,
    AS_27_UNKNOWN,
    AS_29_EMPTY,
    AS_32,
)
from missionfsm.bear.status.state import (
    GET,
    LOCALIZATION,
    STATUS,
    SYSTEM,
    TOPICAL,
    Endpoint,
    Robot,
    Value,
)
from missionfsm.bear.status.values import (
    CHECKS,
    a_stuck_state_is_known,
    faults,
    named,
    reserved_reasons_are_not_used,
    within,
)
from missionfsm.bear.wire.messages import MissionState, State
from missionfsm.kernel.codec import Malformed
from missionfsm.kernel.readings import UNCONSTRAINED, Ambiguity, Assumption, meet
from missionfsm.kernel.rules import Rule, promise
from missionfsm.kernel.step import Match, Mismatch
from missionfsm.kernel.text import brief

Assumed = tuple[Assumption, ...]


@frozen(cache_hash=True)
class Topic:
    """What a channel is about: one robot on one stream.

    Attributes:
        robot: empty for a channel that keeps a stream without robots.
        location: the location by which the stream was asked for, None for one by robot ids.
        member: whether the robot belonged to the stream at its start; always so for one by robot ids.
        partly: somebody else's robots were asked for as well (AS-01).
    """

    endpoint: Endpoint
    robot: str
    location: str | None = None
    member: bool = True
    partly: bool = False


@frozen(cache_hash=True)
class Told:
    """What an emission is about: one robot, where it is, and whether streams follow it there (AS-25)."""

    endpoint: Endpoint
    robot: str
    location: str
    followed: bool = False


def concerns(channel: Any, emission: Any) -> bool:  # noqa: ANN401 - a `Topic` and a `Told`
    """Whether a channel gets an emission."""
    if channel.robot != emission.robot or channel.endpoint is not emission.endpoint:
        return False
    if channel.location is None or not emission.followed:
        return bool(channel.member)
    return bool(channel.location == emission.location)


@frozen(cache_hash=True)
class View:
    """What a message shows of a robot.

    Attributes:
        value: the part that the stream is about, the whole state, or the network (None: it has none).
        unheard: any value may have been reported; `value` is None.
        unlinked: of a network, why it is open what is told of it; None where the robot is known to be connected.
        got: it is what GetRobotStatus answers, and no message.
    """

    robot: str
    endpoint: Endpoint
    value: Value = None
    unheard: bool = False
    unlinked: Ambiguity | None = None
    got: bool = False

    @property
    def call(self) -> str:
        """The call that shows it."""
        return GET if self.got else self.endpoint.value

    @property
    def offline(self) -> bool:
        """Whether it is the state of a robot that is known to be disconnected."""
        connection = self.value.connection if isinstance(self.value, RobotState) else None
        return connection is not None and connection.state is ConnectionState.STATE_DISCONNECTED


def view(robot: Robot, endpoint: Endpoint) -> View | None:
    """What a subscriber is shown of a robot; None where nothing is known."""
    if endpoint is Endpoint.NETWORK:
        unlinked = AS_27_OFFLINE if robot.offline else None if robot.connection else AS_27_UNKNOWN
        return View(robot.id, endpoint, robot.wifi, unlinked=unlinked)
    value = robot.topic(endpoint) if endpoint in TOPICAL else robot.state if robot.seen else None
    return None if value is None else View(robot.id, endpoint, value)


def blank(robot: Robot, endpoint: Endpoint) -> View:
    """UNKNOWN values, where nothing is known that could be shown."""
    return View(robot.id, endpoint, BLANK[endpoint])


@frozen(cache_hash=True)
class Seen:
    """A message about one robot without its metadata, as it came.

    Attributes:
        endpoint: None where it carries nothing that would tell.
        value: as in `View`; what is absent has its default.
        wrapped: the goals of the mission are wrapped (AS-22); None where there are none.
    """

    robot: str
    endpoint: Endpoint | None
    value: Value = None
    wrapped: bool | None = None

    def __str__(self) -> str:
        return brief_value(self.value)


@frozen(cache_hash=True)
class Promised:
    """What GetRobotStatus is to answer: a view, and one way to show it."""

    view: View
    shown: Seen

    def __str__(self) -> str:
        return brief_value(self.view.value) if not self.view.unheard else "any state"


# The promises.


def _promise(name: str, says: str, *place: str) -> Rule:
    return promise(name, says, cite=STATUS[place]).of(SYSTEM, "messages")


WELL_FORMED = _promise("messages-are-well-formed", "A message has the documented form.", "GetRobotStatus", "Response")
SEQUENCE = _promise(
    "sequence-numbers-grow",
    "A sequence number is larger than the robot's one before, or 0; never negative.",
    "SubscribeBatteryStatus",
    "EventMetadata",
)
SELECTED = _promise(
    "only-selected-robots-are-shown",
    "A message is about a robot that was selected, and says about which.",
    "SubscribeBatteryStatus",
    "Request",
)
UPDATES = _promise(
    "updates-follow-the-state",
    "Every change that lasts is streamed to all subscribers, in the order of the robot's changes.",
    "SubscribeBatteryStatus",
)
VALUES = {
    place: promise("values-are-those-reported", "What is shown is what the robot reported.", cite=STATUS[place,]).of(
        SYSTEM, place
    )
    for place in (GET, *(endpoint.value for endpoint in Endpoint))
}
RULES = (WELL_FORMED, SEQUENCE, SELECTED, UPDATES, *VALUES.values(), *(one.rule for one in CHECKS))


# Reading a message.

BLANK = {
    Endpoint.BATTERY: BatteryState(),
    Endpoint.ERRORS: ErrorCodes(),
    Endpoint.NAVIGATION: NavigationState(StuckState()),
    Endpoint.ONLINE: RobotConnection(),
    Endpoint.ROBOT: RobotState(),
}
_EMPTY_PARTS: dict[str, tuple[tuple[str, Any], ...]] = {
    "connection": (("c", RobotConnection()), ("e", RobotConnection(ConnectionState.STATE_DISCONNECTED))),
    "battery": (("c", BatteryState()),),
    "emergency_stop": (("c", EmergencyStopState()),),
    "error_codes": (("c", ErrorCodes()),),
    "navigation_state": (("c", NavigationState(StuckState())),),
}
"""What parts that are not reported may be shown as, with the reading of AS-09 under which they are."""

_NO_MISSION = (MissionState(state=State.STATE_DEFAULT), MissionState())


def matches(view: View, content: Seen | Malformed) -> tuple[Match, ...] | Mismatch:
    """The ways in which a message shows a view, or the first thing that is wrong with it."""
    if isinstance(content, Malformed):
        return Mismatch(WELL_FORMED.id, content.says)
    if content.robot != view.robot:
        return Mismatch(
            SELECTED.id, f"the message is about robot {brief(content.robot)}, not about {brief(view.robot)}"
        )
    if content.endpoint is not view.endpoint and not (content.endpoint is None and view.endpoint in BLANK):
        return Mismatch(WELL_FORMED.id, f"the message is none of {view.endpoint.value}")
    value = BLANK[view.endpoint] if content.endpoint is None else content.value
    found = _matched(view, value, content.wrapped, VALUES[view.endpoint.value])
    if isinstance(found, Mismatch):
        return found
    rules = (UPDATES.id, SELECTED.id, WELL_FORMED.id, VALUES[view.endpoint.value].id, *exercised(value))
    return tuple(Match(assumes, (), rules) for assumes in found)


def answers(promised: object, given: object) -> tuple[Match, ...] | Mismatch:
    """The ways in which an answer of GetRobotStatus is the one promised, or what is wrong with it."""
    if not isinstance(promised, Promised):
        return Mismatch(WELL_FORMED.id, f"the answer is {given}")
    if not isinstance(given, Seen):
        return Mismatch(WELL_FORMED.id, str(getattr(given, "says", given)))
    found = _matched(promised.view, given.value, given.wrapped, VALUES[GET])
    if isinstance(found, Mismatch):
        return found
    rules = (WELL_FORMED.id, VALUES[GET].id, *exercised(given.value))
    return tuple(Match(assumes, (), rules) for assumes in found)


@functools.lru_cache(maxsize=10_000)
def exercised(value: object) -> tuple[str, ...]:
    """The ids of the checks that a value was held to."""
    kinds = {type(part) for part in within(value)}
    return tuple(one.rule.id for one in CHECKS if one.of is None or one.of in kinds)


def _matched(view: View, value: Value, wrapped: bool | None, rule: Rule) -> tuple[Assumed, ...] | Mismatch:  # noqa: FBT001
    assumes: list[Assumption] = []
    for fault in faults(value):
        if fault.rule == a_stuck_state_is_known.rule.id and _may_be_unknown(view):
            assumes.append(AS_18[view.call]["b"])
        elif fault.rule == reserved_reasons_are_not_used.rule.id:
            assumes.append(AS_19[view.call]["z"])
        elif not fault.robots or (view.unheard and not fault.lasts):
            return Mismatch(fault.rule, fault.says)
    if wrapped is not None:
        assumes.append(AS_22[view.call]["b" if wrapped else "a"])
    if view.unheard:
        return ((*assumes, *_of_itself(value)),)
    if view.endpoint is Endpoint.NETWORK:
        found: tuple[Assumed, ...] | str = _network(view, value)
    elif view.endpoint is Endpoint.ROBOT:
        found = _whole(view, value)
    else:
        found = ((),) if view.value == value else difference(view.value, value)
    if isinstance(found, str):
        return Mismatch(rule.id, found)
    return tuple(tuple(dict.fromkeys((*assumes, *one))) for one in found)


def _may_be_unknown(view: View) -> bool:
    """AS-18: whether a stuck state of UNKNOWN could be shown."""
    if isinstance(view.value, RobotState):
        return view.value.navigation_state is None
    return view.unheard or view.value == BLANK[Endpoint.NAVIGATION]


def _of_itself(value: Value) -> Assumed:
    """What a message assumes about the robot where nothing is known of it (AS-15)."""
    for part in within(value):
        if isinstance(part, BatteryState) and part.state == BatteryMode.STATE_FULL and part.charge_percent < 100:
            return (AS_15_FULL["b"],)
    return ()


def _network(view: View, value: Value) -> tuple[Assumed, ...] | str:
    if value == view.value:
        return ((view.unlinked["a"],),) if value is not None and view.unlinked else ((),)
    if value is None and view.unlinked:
        return ((view.unlinked["b"],),)
    return difference(view.value, value)


def _whole(view: View, shown: RobotState) -> tuple[Assumed, ...] | str:
    """The ways in which a whole state shows another, part by part."""
    if view.value == shown == RobotState():
        # Without any values it says nothing about how a part looks that is not reported.
        return ((),)
    ways: list[list[Assumed]] = []
    for attribute in attrs.fields(RobotState):
        part = attribute.name
        found = _part(view, part, getattr(view.value, part), getattr(shown, part))
        if isinstance(found, str):
            return f"{part}: {found}"
        if found != [()]:
            ways.append(found)
    return tuple(tuple(itertools.chain.from_iterable(combination)) for combination in itertools.product(*ways))


def _part(view: View, part: str, wanted: Any, shown: Any) -> list[Assumed] | str:  # noqa: ANN401 - any part
    call = view.call
    if part == "mission" and wanted is None and (shown is None or shown in _NO_MISSION):
        return [(AS_21[call]["a" if shown is None else "b"],)]
    if part == "error_codes" and wanted == ErrorCodes() and shown in (None, wanted):
        return [(AS_29_EMPTY[call]["d" if shown is None else "c"],)]
    if part == "twist" and wanted is not None and shown in (None, wanted):
        return _twist(view, wanted, omitted=shown is None)
    if part in ("servi_state", "carti_state") and wanted is not None and shown is None:
        return [(AS_32[call]["b"],)]
    if wanted == shown:
        return [()]
    for letter, empty in _EMPTY_PARTS.get(part, ()):
        if wanted is None and shown == empty:
            return [(AS_09_PART[part][call][letter],)]
        if letter == "c" and wanted == empty and shown is None:
            return [()]
    return difference(wanted, shown)


def _twist(view: View, wanted: Twist, *, omitted: bool) -> list[Assumed] | str:
    """AS-17: a velocity that is reported may be left out if it is nothing or the robot is offline."""
    zero, offline = AS_17_ZERO[view.call], AS_17_OFFLINE[view.call]
    if not omitted:
        return [(*((zero["a"],) if wanted == Twist() else ()), *((offline["d"],) if view.offline else ()))]
    found: list[Assumed] = []
    if wanted == Twist():
        found.append((zero["b"],))
    if view.offline:
        found.append((offline["c"],))
    return found or difference(wanted, None)


def difference(wanted: Any, shown: Any) -> str:  # noqa: ANN401 - any values
    """In what a value differs from the one expected, in a few words."""
    if attrs.has(type(wanted)) and type(wanted) is type(shown):
        for attribute in attrs.fields(type(wanted)):
            one, other = getattr(wanted, attribute.name), getattr(shown, attribute.name)
            if one != other:
                inner = difference(one, other)
                return f"{attribute.name}{'.' if attrs.has(type(one)) and attrs.has(type(other)) else ' '}{inner}"
    return f"is {brief_value(shown)}, expected {brief_value(wanted)}"


def brief_value(value: Any) -> str:  # noqa: ANN401 - any value
    """A value as a message shows it: what is set, in short."""
    if value is None:
        return "unset"
    if isinstance(value, tuple):
        return "[" + ", ".join(map(brief_value, value[:3])) + (", …]" if len(value) > 3 else "]")
    if attrs.has(type(value)):
        fields = attrs.fields(type(value))
        parts = [(one.name, getattr(value, one.name)) for one in fields if getattr(value, one.name) is not None]
        return "{" + ", ".join(f"{name}: {brief_value(content)}" for name, content in parts) + "}"
    return named(value) if hasattr(value, "name") else brief(value)


# Making a message.


@functools.lru_cache(maxsize=10_000)
def shows(view: View) -> tuple[tuple[Seen, Assumed], ...]:
    """Every message that shows a view and that differs by a reading, with what it assumes; the usual one first."""
    shown = Seen(view.robot, view.endpoint, view.value)
    if view.endpoint is Endpoint.NETWORK and view.unlinked and view.value is not None:
        return (shown, (view.unlinked["a"],)), (evolve(shown, value=None), (view.unlinked["b", "c"],))
    if view.endpoint is not Endpoint.ROBOT or view.value in (None, RobotState()):
        return ((shown, ()),)
    return tuple(_whole_shown(view, view.value))


def _whole_shown(view: View, state: RobotState) -> Iterator[tuple[Seen, Assumed]]:
    call = view.call
    choices: list[list[tuple[dict[str, Any], Assumed]]] = []
    if state.mission is None:
        choices.append([({}, (AS_21[call]["a"],)), ({"mission": _NO_MISSION[0]}, (AS_21[call]["b"],))])
    if state.error_codes == ErrorCodes():
        choices.append([({}, (AS_29_EMPTY[call]["c"],)), ({"error_codes": None}, (AS_29_EMPTY[call]["d"],))])
    if state.twist == Twist():
        choices.append([({}, (AS_17_ZERO[call]["a"],)), ({"twist": None}, (AS_17_ZERO[call]["b"],))])
    if state.twist is not None and view.offline:
        choices.append([({}, (AS_17_OFFLINE[call]["d"],)), ({"twist": None}, (AS_17_OFFLINE[call]["c"],))])
    typed = next((name for name in ("servi_state", "carti_state") if getattr(state, name) is not None), None)
    if typed:
        choices.append([({}, (AS_32[call]["a"],)), ({typed: None}, (AS_32[call]["b"],))])
    for part, empty in _EMPTY_PARTS.items():
        if getattr(state, part) is None and part != "navigation_state":
            question = AS_09_PART[part][call]
            choices.append([({}, (question["a"],)), *(({part: value}, (question[letter],)) for letter, value in empty)])
    goals = bool(state.mission and state.mission.goals)
    for chosen in itertools.product(*choices):
        changed = {name: content for fields, _ in chosen for name, content in fields.items()}
        assumes = tuple(itertools.chain.from_iterable(assumed for _, assumed in chosen))
        for wrapped in (False, True) if goals else (None,):
            way = () if wrapped is None else (AS_22[call]["b" if wrapped else "a"],)
            yield Seen(view.robot, view.endpoint, evolve(state, **changed), wrapped), (*assumes, *way)


def show(view: View, choice: int = UNCONSTRAINED) -> Seen:
    """The message that an implementation with these readings sends."""
    return next(seen for seen, assumes in shows(view) if meet(choice, assumes))


def canonical(part: str, value: Any) -> Any:  # noqa: ANN401 - any part
    """A part in the form in which it is compared: what is absent has its default, codes have an order."""
    if part == LOCALIZATION or value is None:
        return None
    if isinstance(value, ErrorCodes):
        return ErrorCodes(tuple(sorted(value.codes, key=lambda one: (one.code, int(one.severity), one.message))))
    if isinstance(value, NavigationState) and value.stuck_state is None:
        return NavigationState(StuckState())
    return value


def canonical_state(state: RobotState) -> RobotState:
    """A whole state in the form in which it is compared."""
    return evolve(
        state,
        error_codes=canonical("error_codes", state.error_codes),
        navigation_state=canonical("navigation_state", state.navigation_state),
    )


def each(robots: Iterable[Robot]) -> Iterator[tuple[Endpoint, Robot]]:
    """Every robot on every subscription."""
    return ((endpoint, robot) for robot in robots for endpoint in Endpoint)
