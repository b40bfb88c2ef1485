"""The Robot Status page as a `Spec`: the rules and effects of the other modules, put together."""

from __future__ import annotations

import functools
from collections.abc import Hashable, Mapping

from attrs import evolve

from missionfsm.bear.status.describe import describe
from missionfsm.bear.status.effects import failing, outcomes
from missionfsm.bear.status.events import armed, moved, reported, restarted
from missionfsm.bear.status.messages import BatteryMode, ConnectionState, Stuck
from missionfsm.bear.status.readings import AMBIGUITIES
from missionfsm.bear.status.readings.selecting import AS_01, AS_34
from missionfsm.bear.status.readings.streams import AS_08, AS_12_EVENT, AS_12_HYBRID, AS_13_SKIP, AS_25, AS_26
from missionfsm.bear.status.readings.unknown import AS_09_PART
from missionfsm.bear.status.readings.values import AS_17_OFFLINE, AS_17_ZERO, AS_21, AS_22, AS_29_EMPTY
from missionfsm.bear.status.rules import OPERATIONS
from missionfsm.bear.status.state import (
    CHARTS,
    FORGET,
    GET,
    MAPS,
    STATE_PARTS,
    STATUS,
    SYSTEM_NAME,
    Endpoint,
    Event,
    Fleet,
    Request,
    Robot,
    World,
    initial,
    whose,
)
from missionfsm.bear.status.stream import (
    RULES,
    SELECTED,
    SEQUENCE,
    UPDATES,
    VALUES,
    WELL_FORMED,
    answers,
    matches,
    not_selected,
)
from missionfsm.bear.status.values import a_stuck_state_is_known, faults, reserved_reasons_are_not_used
from missionfsm.bear.status.views import Topic, concerns
from missionfsm.bear.wire.codes import UNLISTED
from missionfsm.kernel import history
from missionfsm.kernel.abstraction import Abstraction
from missionfsm.kernel.history import Called, Driven, Received
from missionfsm.kernel.possibilities import each_met
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import INTERNAL, NOT_FOUND, OK, PERMISSION_DENIED, Operation, Waiver
from missionfsm.kernel.spec import Delivery, Drive, Invariant, Middle, Parting, Spec
from missionfsm.kernel.step import Mismatch


def sequence(relation: str) -> tuple[Assumption, ...] | Mismatch:
    """How a number may compare with its predecessor: larger, or 0; anything but negative after a restart."""
    if relation in ("first", "larger", "zero", "renumbered"):
        return ()
    return Mismatch(SEQUENCE.id, f"the sequence number is {_COMPARED.get(relation, relation)}")


_COMPARED = {
    "equal": "the one before again",
    "smaller": "smaller than the one before",
    "stale": "the one before again",
}


@functools.cache
def _delivery(topic: Topic) -> Delivery:
    # A stream may break down (INTERNAL is documented) or be cut off by the transport; that it just ends is AS-26.
    call = topic.endpoint.value
    ends: dict[str, tuple[Assumption, ...]] = {
        INTERNAL: (),
        OK: (AS_26[call]["b"],),
        **dict.fromkeys(UNLISTED, (AS_34[call]["b"],)),
    }
    if topic.location is not None:
        ends[NOT_FOUND] = (AS_25[call]["e"],)
    if topic.partly:
        ends[PERMISSION_DENIED] = (AS_01[call]["c"],)
    return Delivery(
        skips=AS_13_SKIP[call]["c"],
        repeats=AS_12_HYBRID["a", "b"] if topic.endpoint is Endpoint.ROBOT else AS_12_EVENT[call]["b"],
        echoes=AS_08[call]["c"] if topic.endpoint in MAPS else None,
        ends=ends,
        unowed=(UPDATES.id,),
        first=tuple(rule.id for rule in OPERATIONS[topic.endpoint.value].promises),
        malformed=(WELL_FORMED.id,),
        operation=call,
    )


WAIVERS = (
    Waiver(
        "parts-that-contradict-one-another",
        "a battery that charges off its charger or discharges on it, and a stuck robot that moves, are judged in bare"
        " messages; in a history they are the robot's own doing",
        STATUS["SubscribeBatteryStatus", "State enum"],
        (GET, Endpoint.BATTERY.value, Endpoint.ROBOT.value),
    ),
    Waiver(
        "timestamps-that-go-on",
        "a timestamp has to be a time that exists; one that stands still or goes back is not compared",
        STATUS["SubscribeBatteryStatus", "EventMetadata"],
        tuple(endpoint.value for endpoint in Endpoint),
    ),
    Waiver(
        "an-answer-against-a-stream",
        "where nobody says what robots report, GetRobotStatus is not compared with what streams show",
        STATUS[GET,],
        (GET,),
    ),
)
"""What the page says and no rule checks in a history, with the calls in whose use it could have shown."""


def _whom(event: Event) -> tuple[str, ...]:
    return (event.robot,)


# What holds of every fleet, and what some fleet can come to.

INVARIANTS = (
    Invariant(
        "one-type-of-robot-at-a-time",
        "No robot reports the states of two types.",
        lambda fleet: all(one.state.servi_state is None or one.state.carti_state is None for one in fleet.robots),
    ),
    Invariant(
        "what-is-reported-is-known",
        "What a robot reports is what is known of it.",
        lambda fleet: all(
            one.state.connection in (None, one.topic(Endpoint.ONLINE))
            and one.state.battery in (None, one.topic(Endpoint.BATTERY))
            and one.state.error_codes in (None, one.topic(Endpoint.ERRORS))
            and one.state.navigation_state in (None, one.topic(Endpoint.NAVIGATION))
            for one in fleet.robots
        ),
    ),
    Invariant(
        "values-are-in-their-ranges",
        "What is known of a robot breaks no rule about values.",
        lambda fleet: all(
            fault.robots or fault.rule.endswith(("reserved-reasons-are-not-used", "a-stuck-state-is-known"))
            for one in fleet.robots
            for value in (one.state, one.wifi)
            for fault in faults(value)
        ),
    ),
)
POSSIBILITIES = (
    *each_met(
        (ConnectionState.STATE_CONNECTED, ConnectionState.STATE_DISCONNECTED),
        lambda fleet: (one.connection for one in fleet.robots),
        "a-robot-is-{}",
        "Some robot is in {}.",
    ),
    *each_met(
        filter(None, BatteryMode),
        lambda fleet: (one.state.battery.state for one in fleet.robots if one.state.battery is not None),
        "a-battery-is-{}",
        "Some battery is in {}.",
    ),
    Invariant(
        "a-robot-is-stuck",
        "Some robot is stuck.",
        lambda fleet: any(
            one.state.navigation_state is not None
            and one.state.navigation_state.stuck_state is not None
            and one.state.navigation_state.stuck_state.state is Stuck.STATE_STUCK
            for one in fleet.robots
        ),
    ),
    Invariant(
        "a-robot-has-no-network",
        "Some robot is on no network.",
        lambda fleet: any(one.wifi is None for one in fleet.robots),
    ),
    Invariant("a-fault-is-armed", "The next answer is a failure.", lambda fleet: fleet.fault),
)


_ANSWERS_FOR: Mapping[str, tuple[str, ...]] = {
    "AS-08": (UPDATES.id,),
    "AS-09.unset": (UPDATES.id,),
    "AS-12": (UPDATES.id,),
    "AS-13": (UPDATES.id,),
    "AS-14": (WELL_FORMED.id,),
    "AS-25": (SELECTED.id,),
    "AS-18": (a_stuck_state_is_known.rule.id,),
    "AS-19": (reserved_reasons_are_not_used.rule.id,),
    **{
        one.id: (VALUES[call].id,)
        for question in (*AS_09_PART.values(), AS_17_OFFLINE, AS_17_ZERO, AS_21, AS_22, AS_29_EMPTY)
        for call, one in question.items()
    },
}
"""By what is shown, the promise that a question is about; see `missionfsm.kernel.spec.Spec`."""


def _names(_: Fleet) -> int:
    return 0


def _search_key(fleet: Fleet) -> tuple[object, ...]:
    """Fleets that differ in values alone are of one shape: what is reported, who is offline, what is armed."""
    return (tuple(map(_outline, fleet.robots)), fleet.fault, fleet.unheard)


@functools.lru_cache(maxsize=10_000)
def _outline(robot: Robot) -> tuple[object, ...]:
    return (robot.connection, bool(robot.left), *(part for part in STATE_PARTS if robot.part(part) is not None))


# A fleet falls into robots: what is streamed of one says nothing of another.


def _parts(world: World, driven: frozenset[str]) -> tuple[str, ...]:
    """The robots; a fault that is armed hits the next call, whichever robot it is about, and so ties all of them."""
    return () if "fault" in driven else tuple(robot.id for robot in world.robots)


def _whose(event: history.Event) -> str | None:
    if isinstance(event, Received):
        return getattr(event.content, "robot", "")
    if isinstance(event, Driven):
        driven: Event = event.event  # type: ignore[assignment]  # of this system
        return driven.robot if driven.name in ("report", "restart") else None
    if isinstance(event, Called):
        request: Request = event.request  # type: ignore[assignment]  # of this system
        return request.ids[0] if request.operation == GET and request.ids else None
    return None


def _alone(spec: Spec, robot: Hashable) -> Spec:
    """The system with channels for one robot only."""
    asked = functools.partial(outcomes, operations=spec.operations, alone=str(robot))
    report = evolve(spec.drives["report"], steps=functools.partial(reported, alone=str(robot)))
    return evolve(spec, outcomes=asked, drives={**spec.drives, "report": report}, rebuilt=None)


def specification(operations: Mapping[str, Operation] = OPERATIONS) -> Spec:
    """The page as a specification, perhaps with other rules of refusal."""
    return Spec(
        system=SYSTEM_NAME,
        title="the status of an account's fleet",
        initial=initial,
        operations=operations,
        outcomes=functools.partial(outcomes, operations=operations),
        failing=failing,
        drives={
            one.name: one
            for one in (
                Drive("report", reported, (FORGET,), impossible=(SELECTED.id,)),
                # Numbers that start over are recognised by their 0; nothing else tells of a restart that nobody drove.
                Drive("restart", restarted, renumbers=_whom, impossible=(SELECTED.id,)),
                # A robot that comes back to a location is shown as to a new stream, perhaps under the same number.
                Drive("move", moved, shows_again=_whom, impossible=(SELECTED.id,)),
                # Failures that nobody arms are outcomes of their own.
                Drive("fault", armed, waits=lambda fleet: fleet.fault),
            )
        },
        urgent=lambda _: (),
        matches=matches,
        delivery=_delivery,
        remembered=lambda view, content: None if view.unheard else content,
        sequence=sequence,
        names=_names,
        request_operation=lambda request: request.operation,
        ambiguities=AMBIGUITIES,
        answers_for=_ANSWERS_FOR,
        waived=WAIVERS,
        concerns=concerns,
        unowed=not_selected,
        describe=describe,
        rules=RULES,
        charts=CHARTS,
        invariants=INVARIANTS,
        possibilities=POSSIBILITIES,
        answers=answers,
        abstraction=Abstraction(search_key=_search_key, rules_key=lambda fleet: (whose(fleet), fleet.fault)),
        parting=Parting(_parts, _alone, _whose),
        rebuilt=specification,
        # No call changes a fleet. What robots reported before a log, and a fault that waits, nobody has seen.
        middle=Middle(undriven=frozenset({"report", "fault"})),
        unopened=(UPDATES.id,),
        added=frozenset({"SubscribeNavigationStatus"}),
    )


SPEC = specification()

__all__ = ["SPEC"]
