"""The Errors tables of the Robot Status page: every row as the conditions that its sentence names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from attrs import evolve

from missionfsm.bear.status.readings import (
    AS_01,
    AS_02,
    AS_03_EMPTY,
    AS_03_FOREIGN,
    AS_03_UNKNOWN,
    AS_04,
    AS_05,
    AS_06_EMPTY,
    AS_06_FIELD,
    AS_06_ORDER,
)
from missionfsm.bear.status.state import GET, STATUS, SYSTEM, Endpoint, Fleet, Request, Robot
from missionfsm.kernel.readings import Assumption
from missionfsm.kernel.rules import (
    INTERNAL,
    INVALID_ARGUMENT,
    NOT_FOUND,
    PERMISSION_DENIED,
    Operation,
    Rule,
    promise,
    rule,
)

_GET = STATUS[GET, "Errors"]
_ANY = STATUS["SubscribeBatteryStatus", "Errors"]
"""The tables of the six subscriptions are the same but for a word; each is cited for its own operation."""


# The request by itself.


@rule(INVALID_ARGUMENT, cite=_ANY)
def the_request_is_malformed(_: Fleet, request: Request) -> bool:
    """The request is not of the documented form: a value of another type."""
    return bool(request.malformed)


@rule(INVALID_ARGUMENT, cite=_ANY, under=AS_06_FIELD["b"])
def a_field_is_unknown(_: Fleet, request: Request) -> bool:
    """The request has a field that is not documented, and such a request is taken for malformed (AS-06)."""
    return request.unknown_field


@rule(INVALID_ARGUMENT, cite=_GET)
def the_robot_id_is_empty(_: Fleet, request: Request) -> bool:
    """The robot_id is empty or not set."""
    return not request.malformed and request.ids == ("",)


@rule(INVALID_ARGUMENT, cite=_ANY)
def the_selector_is_not_set(_: Fleet, request: Request) -> bool:
    """There is no selector, or it selects neither by ids nor by location."""
    return not request.malformed and not request.by_ids and request.location is None


@rule(INVALID_ARGUMENT, cite=_ANY)
def the_list_of_robot_ids_is_empty(_: Fleet, request: Request) -> bool:
    """The selector's list of robot_ids is empty."""
    return request.by_ids and not request.ids and request.location is None


@rule(INVALID_ARGUMENT, cite=_ANY)
def the_location_id_is_empty(_: Fleet, request: Request) -> bool:
    """The selector's location_id is empty."""
    return request.location == ""


@rule(INVALID_ARGUMENT, cite=STATUS["SubscribeBatteryStatus", "Request"], under=AS_04["a"])
def the_selector_has_both_arms(_: Fleet, request: Request) -> bool:
    """The selector has robot_ids and a location_id, of which it takes one.

    AS-04: the arms are one oneof in the published definitions, which JSON may not set twice.
    """
    return request.by_ids and request.location is not None


@rule(INVALID_ARGUMENT, cite=_ANY, under=AS_06_EMPTY["a"])
def a_robot_id_is_empty(_: Fleet, request: Request) -> bool:
    """One of the robot_ids is empty (AS-06)."""
    return _by_ids(request) and "" in request.ids


@rule(INVALID_ARGUMENT, cite=STATUS["SubscribeBatteryStatus", "Request"], under=AS_05["c"])
def a_robot_id_is_repeated(_: Fleet, request: Request) -> bool:
    """One of the robot_ids occurs twice, and that is taken for invalid (AS-05)."""
    return _by_ids(request) and request.repeated


# Whose robots and locations.


def _by_ids(request: Request) -> bool:
    return request.by_ids and request.location is None


def foreign(fleet: Fleet, request: Request) -> tuple[Robot, ...]:
    """The robots among those named that belong to somebody else."""
    return tuple(one for one in map(fleet.robot, request.ids) if one is not None and not one.owned)


def own(fleet: Fleet, request: Request) -> tuple[Robot, ...]:
    """The account's robots among those named."""
    return tuple(one for one in map(fleet.robot, request.ids) if one is not None and one.owned)


def _is_unknown(fleet: Fleet, request: Request) -> bool:
    return any(one and fleet.robot(one) is None for one in request.ids)


@rule(PERMISSION_DENIED, cite=_GET)
def the_robot_is_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """The robot belongs to another account."""
    return bool(foreign(fleet, request))


@rule(PERMISSION_DENIED, cite=_GET, under=AS_02["a"])
def there_is_no_such_robot(fleet: Fleet, request: Request) -> bool:
    """No robot has this id, which is answered as if it were somebody else's (AS-02)."""
    return _is_unknown(fleet, request)


@rule(NOT_FOUND, cite=_GET, under=AS_02["b"])
def the_robot_is_not_found(fleet: Fleet, request: Request) -> bool:
    """No robot has this id (AS-02 read as a matter of its own; the page lists NOT_FOUND for locations only)."""
    return _is_unknown(fleet, request)


@rule(PERMISSION_DENIED, cite=_ANY)
def all_robots_are_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """None of the robots that exist among those selected is the account's."""
    return _by_ids(request) and bool(foreign(fleet, request)) and not own(fleet, request)


@rule(PERMISSION_DENIED, cite=_ANY, under=AS_01["a"])
def some_robots_are_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """One of the selected robots belongs to another account (AS-01)."""
    return _by_ids(request) and bool(foreign(fleet, request)) and bool(own(fleet, request))


@rule(PERMISSION_DENIED, cite=_ANY, under=AS_02["a"])
def a_robot_does_not_exist(fleet: Fleet, request: Request) -> bool:
    """No robot has one of the ids, which is answered as if it were somebody else's (AS-02)."""
    return _by_ids(request) and _is_unknown(fleet, request)


@rule(NOT_FOUND, cite=_ANY, under=AS_02["b"])
def a_robot_is_not_found(fleet: Fleet, request: Request) -> bool:
    """No robot has one of the ids (AS-02 read as a matter of its own)."""
    return _by_ids(request) and _is_unknown(fleet, request)


@rule(PERMISSION_DENIED, cite=_ANY, under=AS_06_EMPTY["b"])
def an_empty_robot_id_is_nobodys(_: Fleet, request: Request) -> bool:
    """One of the robot_ids is empty, and so not the account's (AS-06)."""
    return _by_ids(request) and "" in request.ids


@rule(PERMISSION_DENIED, cite=_ANY, under=AS_04["a"])
def a_robot_beside_a_location_is_not_the_accounts(fleet: Fleet, request: Request) -> bool:
    """A selector with both arms names a robot that is not the account's: invalid and forbidden at once."""
    both = request.by_ids and request.location is not None
    return both and (bool(foreign(fleet, request)) or _is_unknown(fleet, request))


def _is_unknown_place(fleet: Fleet, request: Request) -> bool:
    return bool(request.location) and fleet.location(request.location or "") is None


def _place_is_owned(fleet: Fleet, request: Request) -> bool | None:
    location = fleet.location(request.location) if request.location else None
    return None if location is None else location.owned


@rule(NOT_FOUND, cite=_ANY, under=AS_03_UNKNOWN["a"])
def the_location_does_not_exist(fleet: Fleet, request: Request) -> bool:
    """There is no such location, so no robots are found for it (AS-03)."""
    return _is_unknown_place(fleet, request)


@rule(PERMISSION_DENIED, cite=_ANY, under=AS_03_UNKNOWN["b"])
def the_unknown_location_is_not_the_accounts(fleet: Fleet, request: Request) -> bool:
    """There is no such location, which is answered as if it were somebody else's (AS-03)."""
    return _is_unknown_place(fleet, request)


@rule(NOT_FOUND, cite=_ANY, under=AS_03_EMPTY["c"])
def no_robot_is_at_the_location(fleet: Fleet, request: Request) -> bool:
    """The account has no robot at its location (AS-03)."""
    return _place_is_owned(fleet, request) is True and not fleet.at(request.location or "")


@rule(PERMISSION_DENIED, cite=_ANY, under=AS_03_FOREIGN["e"])
def the_location_is_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """The location belongs to another account (AS-03)."""
    return _place_is_owned(fleet, request) is False


@rule(NOT_FOUND, cite=_ANY, under=AS_03_FOREIGN["f"])
def nothing_is_found_at_somebody_elses_location(fleet: Fleet, request: Request) -> bool:
    """The location belongs to another account, so nothing is found for it (AS-03)."""
    return _place_is_owned(fleet, request) is False


def ranking(holding: tuple[Rule, ...]) -> Iterator[tuple[str, tuple[Assumption, ...]]]:
    """AS-06: of several codes INVALID_ARGUMENT comes first or last; the others are not ranked."""
    codes = dict.fromkeys(str(one.code) for one in holding)
    for code in codes:
        if INVALID_ARGUMENT not in codes:
            yield code, ()
        else:
            yield code, (AS_06_ORDER["a" if code == INVALID_ARGUMENT else "b"],)


# The operation table.

_SELECTION = (
    the_request_is_malformed,
    the_selector_is_not_set,
    the_list_of_robot_ids_is_empty,
    the_location_id_is_empty,
    the_selector_has_both_arms,
    a_robot_id_is_empty,
    a_robot_id_is_repeated,
    a_field_is_unknown,
    the_location_does_not_exist,
    no_robot_is_at_the_location,
    nothing_is_found_at_somebody_elses_location,
    a_robot_is_not_found,
    all_robots_are_somebody_elses,
    some_robots_are_somebody_elses,
    a_robot_does_not_exist,
    an_empty_robot_id_is_nobodys,
    a_robot_beside_a_location_is_not_the_accounts,
    the_unknown_location_is_not_the_accounts,
    the_location_is_somebody_elses,
)


def _subscription(endpoint: Endpoint) -> Operation:
    first = promise(
        "the-latest-state-comes-first",
        "A new stream begins with what is known last of every selected robot.",
        cite=STATUS[endpoint.value,],
    )
    return Operation.of(
        endpoint.value,
        SYSTEM,
        STATUS[endpoint.value,],
        refusals=(evolve(one, cite=STATUS[endpoint.value, one.cite.headings[1]]) for one in _SELECTION),
        promises=(first,),
        failures=(INTERNAL,),
        streaming=True,
    )


_LATEST = promise(
    "the-answer-is-the-latest-state", "The answer is the latest state of the robot.", cite=STATUS[GET, "Response"]
)
OPERATIONS: Mapping[str, Operation] = {
    GET: Operation.of(
        GET,
        SYSTEM,
        STATUS[GET,],
        refusals=(
            evolve(the_request_is_malformed, cite=_GET),
            the_robot_id_is_empty,
            evolve(a_field_is_unknown, cite=_GET),
            the_robot_is_somebody_elses,
            there_is_no_such_robot,
            the_robot_is_not_found,
        ),
        promises=(_LATEST,),
        failures=(INTERNAL,),
    ),
    **{endpoint.value: _subscription(endpoint) for endpoint in Endpoint},
}
