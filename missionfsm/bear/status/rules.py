"""The Errors tables of the Robot Status page: every row as the conditions that its sentence names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from attrs import evolve

from missionfsm.bear.status.readings.selecting import (
    AS_01,
    AS_02,
    AS_03_EMPTY,
    AS_03_FOREIGN,
    AS_03_MIXED,
    AS_03_OTHERS,
    AS_03_UNKNOWN,
    AS_03_VACANT,
    AS_04,
    AS_05,
    AS_06_EMPTY,
    AS_06_FIELD,
    AS_06_LIST,
    AS_06_ORDER,
)
from missionfsm.bear.status.state import GET, STATUS, SYSTEM_NAME, Endpoint, Fleet, Location, Request, Robot
from missionfsm.kernel.readings import Ambiguity, Assumption
from missionfsm.kernel.rules import (
    INTERNAL,
    INVALID_ARGUMENT,
    NOT_FOUND,
    PERMISSION_DENIED,
    Operation,
    Rule,
    promise,
    refusal,
)

_GET = STATUS[GET, "Errors"]
_ANY = STATUS["SubscribeBatteryStatus", "Errors"]
"""The tables of the six subscriptions are the same but for a word; each is cited for its own operation."""


# The request by itself.


@refusal(INVALID_ARGUMENT, cite=_ANY)
def the_request_is_malformed(_: Fleet, request: Request) -> bool:
    """The request is not of the documented form: a value of another type."""
    return bool(request.malformed)


@refusal(INVALID_ARGUMENT, cite=_ANY)
def a_field_is_unknown(_: Fleet, request: Request) -> bool:
    """The request has a field that is not documented, and such a request is taken for malformed (AS-06)."""
    return "request" in request.unknown_fields


@refusal(INVALID_ARGUMENT, cite=_ANY)
def a_field_of_the_selector_is_unknown(_: Fleet, request: Request) -> bool:
    """The selector has a field that is not documented, and such a request is taken for malformed (AS-06)."""
    return "selector" in request.unknown_fields


@refusal(INVALID_ARGUMENT, cite=_ANY)
def a_field_of_the_robot_ids_is_unknown(_: Fleet, request: Request) -> bool:
    """The robot_ids have a field that is not documented, and such a request is taken for malformed (AS-06)."""
    return "ids" in request.unknown_fields


@refusal(INVALID_ARGUMENT, cite=_ANY)
def the_robot_ids_are_a_bare_list(_: Fleet, request: Request) -> bool:
    """The robot_ids are a list and no RobotIDs with a list in it, and that is taken for malformed (AS-06)."""
    return request.bare


@refusal(INVALID_ARGUMENT, cite=_GET)
def the_robot_id_is_empty(_: Fleet, request: Request) -> bool:
    """The robot_id is empty or not set."""
    return not request.malformed and request.ids == ("",)


@refusal(INVALID_ARGUMENT, cite=_ANY)
def the_selector_is_not_set(_: Fleet, request: Request) -> bool:
    """There is no selector, or it selects neither by ids nor by location."""
    return not request.malformed and not request.by_ids and request.location is None


@refusal(INVALID_ARGUMENT, cite=_ANY)
def the_list_of_robot_ids_is_empty(_: Fleet, request: Request) -> bool:
    """The selector's list of robot_ids is empty."""
    return request.by_ids and not request.ids


@refusal(INVALID_ARGUMENT, cite=_ANY)
def the_location_id_is_empty(_: Fleet, request: Request) -> bool:
    """The selector's location_id is empty."""
    return request.location == ""


@refusal(INVALID_ARGUMENT, cite=STATUS["SubscribeBatteryStatus", "Request"])
def the_selector_has_both_arms(_: Fleet, request: Request) -> bool:
    """The selector has robot_ids and a location_id, of which it takes one.

    AS-04: the arms are one oneof in the published definitions, which JSON may not set twice.
    """
    return request.both and not _blank(request)


@refusal(INVALID_ARGUMENT, cite=_ANY)
def a_robot_id_is_empty(_: Fleet, request: Request) -> bool:
    """One of the robot_ids is empty (AS-06)."""
    return _by_ids(request) and "" in request.ids


@refusal(INVALID_ARGUMENT, cite=STATUS["SubscribeBatteryStatus", "Request"])
def a_robot_id_is_repeated(_: Fleet, request: Request) -> bool:
    """One of the robot_ids occurs twice, and that is taken for invalid (AS-05)."""
    return _by_ids(request) and request.repeated


# Whose robots and locations.


def _by_ids(request: Request) -> bool:
    return request.by_ids and request.location is None


def _blank(request: Request) -> bool:
    return not request.ids or not request.location


def foreign(fleet: Fleet, request: Request) -> tuple[Robot, ...]:
    """The robots among those named that belong to somebody else."""
    return tuple(one for one in map(fleet.by_id.get, request.ids) if one is not None and not one.owned)


def own(fleet: Fleet, request: Request) -> tuple[Robot, ...]:
    """The account's robots among those named."""
    return tuple(one for one in map(fleet.by_id.get, request.ids) if one is not None and one.owned)


def _is_unknown(fleet: Fleet, request: Request) -> bool:
    known = fleet.by_id
    return any(one and one not in known for one in request.ids)


@refusal(PERMISSION_DENIED, cite=_GET)
def the_robot_is_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """The robot belongs to another account."""
    return bool(foreign(fleet, request))


@refusal(PERMISSION_DENIED, cite=_GET)
def there_is_no_such_robot(fleet: Fleet, request: Request) -> bool:
    """No robot has this id, which is answered as if it were somebody else's (AS-02)."""
    return _is_unknown(fleet, request)


@refusal(NOT_FOUND, cite=_GET)
def the_robot_is_not_found(fleet: Fleet, request: Request) -> bool:
    """No robot has this id (AS-02 read as a matter of its own; the page lists NOT_FOUND for locations only)."""
    return _is_unknown(fleet, request)


@refusal(PERMISSION_DENIED, cite=_ANY)
def all_robots_are_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """None of the robots that exist among those selected is the account's."""
    return _by_ids(request) and bool(foreign(fleet, request)) and not own(fleet, request)


@refusal(PERMISSION_DENIED, cite=_ANY)
def some_robots_are_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """One of the selected robots belongs to another account (AS-01)."""
    return _by_ids(request) and bool(foreign(fleet, request)) and bool(own(fleet, request))


@refusal(PERMISSION_DENIED, cite=_ANY)
def a_robot_does_not_exist(fleet: Fleet, request: Request) -> bool:
    """No robot has one of the ids, which is answered as if it were somebody else's (AS-02)."""
    return _by_ids(request) and _is_unknown(fleet, request)


@refusal(NOT_FOUND, cite=_ANY)
def a_robot_is_not_found(fleet: Fleet, request: Request) -> bool:
    """No robot has one of the ids (AS-02 read as a matter of its own)."""
    return _by_ids(request) and _is_unknown(fleet, request)


@refusal(PERMISSION_DENIED, cite=_ANY)
def an_empty_robot_id_is_nobodys(_: Fleet, request: Request) -> bool:
    """One of the robot_ids is empty, and so not the account's (AS-06)."""
    return _by_ids(request) and "" in request.ids


@refusal(PERMISSION_DENIED, cite=_ANY)
def a_robot_beside_a_location_is_not_the_accounts(fleet: Fleet, request: Request) -> bool:
    """A selector with both arms names a robot that is not the account's: invalid and forbidden at once."""
    both = request.both and not _blank(request)
    return both and (bool(foreign(fleet, request)) or _is_unknown(fleet, request))


def _place(fleet: Fleet, request: Request) -> Location | None:
    return fleet.location(request.location) if request.location else None


def _is_unknown_place(fleet: Fleet, request: Request) -> bool:
    return bool(request.location) and _place(fleet, request) is None


def _is_own_place(fleet: Fleet, request: Request) -> bool:
    place = _place(fleet, request)
    return place is not None and place.owned


def _is_foreign_place(fleet: Fleet, request: Request) -> bool:
    place = _place(fleet, request)
    return place is not None and not place.owned


def _owners_at(fleet: Fleet, request: Request) -> set[bool]:
    """Whether the robots at the location are the account's: {True, False} where some are."""
    return {one.owned for one in fleet.robots if one.location == request.location}


@refusal(NOT_FOUND, cite=_ANY)
def the_location_does_not_exist(fleet: Fleet, request: Request) -> bool:
    """There is no such location, so no robots are found for it (AS-03)."""
    return _is_unknown_place(fleet, request)


@refusal(PERMISSION_DENIED, cite=_ANY)
def the_unknown_location_is_not_the_accounts(fleet: Fleet, request: Request) -> bool:
    """There is no such location, which is answered as if it were somebody else's (AS-03)."""
    return _is_unknown_place(fleet, request)


@refusal(NOT_FOUND, cite=_ANY)
def no_robot_is_at_the_location(fleet: Fleet, request: Request) -> bool:
    """No robot is at the account's location (AS-03)."""
    return _is_own_place(fleet, request) and not _owners_at(fleet, request)


@refusal(NOT_FOUND, cite=_ANY)
def no_robot_of_the_account_is_at_the_location(fleet: Fleet, request: Request) -> bool:
    """Only robots of somebody else are at the account's location, so that none is found for it (AS-03)."""
    return _is_own_place(fleet, request) and _owners_at(fleet, request) == {False}


@refusal(PERMISSION_DENIED, cite=_ANY)
def the_robots_at_the_location_are_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """Only robots of somebody else are at the account's location, and they may not be seen (AS-03)."""
    return _is_own_place(fleet, request) and _owners_at(fleet, request) == {False}


@refusal(PERMISSION_DENIED, cite=_ANY)
def a_robot_at_the_location_is_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """Robots of the account are at its location, and one of somebody else, which may not be seen (AS-03)."""
    return _is_own_place(fleet, request) and _owners_at(fleet, request) == {True, False}


@refusal(PERMISSION_DENIED, cite=_ANY)
def the_location_is_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """The location belongs to another account (AS-03)."""
    return _is_foreign_place(fleet, request) and bool(_owners_at(fleet, request))


@refusal(NOT_FOUND, cite=_ANY)
def nothing_is_found_at_somebody_elses_location(fleet: Fleet, request: Request) -> bool:
    """The location belongs to another account, so nothing is found for it (AS-03)."""
    return _is_foreign_place(fleet, request) and bool(_owners_at(fleet, request))


@refusal(PERMISSION_DENIED, cite=_ANY)
def the_vacant_location_is_somebody_elses(fleet: Fleet, request: Request) -> bool:
    """The location belongs to another account, though no robot is there (AS-03)."""
    return _is_foreign_place(fleet, request) and not _owners_at(fleet, request)


@refusal(NOT_FOUND, cite=_ANY)
def no_robot_is_at_somebody_elses_location(fleet: Fleet, request: Request) -> bool:
    """No robot is at the location, which belongs to another account (AS-03)."""
    return _is_foreign_place(fleet, request) and not _owners_at(fleet, request)


def ranking(request: Request, fleet: Fleet, holding: tuple[Rule, ...]) -> Iterator[tuple[str, tuple[Assumption, ...]]]:
    """AS-06: of several codes INVALID_ARGUMENT comes first or last; the others are not ranked."""
    codes = dict.fromkeys(str(one.code) for one in holding)
    for code in codes:
        if INVALID_ARGUMENT not in codes:
            yield code, ()
        else:
            order = AS_06_ORDER[_situation(request, fleet)][request.operation]
            yield code, (order["a" if code == INVALID_ARGUMENT else "b"],)


def _situation(request: Request, fleet: Fleet) -> str:
    """What is invalid about a request that names what may not be seen as well."""
    if request.unknown_fields:
        return "field"
    if request.bare:
        return "list"
    if request.both:
        return "both"
    if "" not in request.ids:
        return "twice"
    known = {one.id for one in own(fleet, request)}
    hidden = next((position for position, one in enumerate(request.ids) if one and one not in known), len(request.ids))
    return "empty-first" if request.ids.index("") < hidden else "empty-last"


# The operation table.

_Row = tuple[Rule, Mapping[str, Ambiguity] | None, str]
"""A rule, and the question (by call) and the letter under which it refuses."""

_SELECTION: tuple[_Row, ...] = (
    (the_request_is_malformed, None, ""),
    (the_selector_is_not_set, None, ""),
    (the_list_of_robot_ids_is_empty, None, ""),
    (the_location_id_is_empty, None, ""),
    (the_selector_has_both_arms, AS_04, "a"),
    (a_robot_id_is_empty, AS_06_EMPTY, "a"),
    (a_robot_id_is_repeated, AS_05, "c"),
    (a_field_is_unknown, AS_06_FIELD["request"], "b"),
    (a_field_of_the_selector_is_unknown, AS_06_FIELD["selector"], "b"),
    (a_field_of_the_robot_ids_is_unknown, AS_06_FIELD["ids"], "b"),
    (the_robot_ids_are_a_bare_list, AS_06_LIST, "a"),
    (the_location_does_not_exist, AS_03_UNKNOWN, "a"),
    (no_robot_is_at_the_location, AS_03_EMPTY, "c"),
    (no_robot_of_the_account_is_at_the_location, AS_03_OTHERS, "c"),
    (nothing_is_found_at_somebody_elses_location, AS_03_FOREIGN, "f"),
    (no_robot_is_at_somebody_elses_location, AS_03_VACANT, "f"),
    (a_robot_is_not_found, AS_02, "b"),
    (all_robots_are_somebody_elses, None, ""),
    (some_robots_are_somebody_elses, AS_01, "a"),
    (a_robot_does_not_exist, AS_02, "a"),
    (an_empty_robot_id_is_nobodys, AS_06_EMPTY, "b"),
    (a_robot_beside_a_location_is_not_the_accounts, AS_04, "a"),
    (the_unknown_location_is_not_the_accounts, AS_03_UNKNOWN, "b"),
    (the_robots_at_the_location_are_somebody_elses, AS_03_OTHERS, "g"),
    (a_robot_at_the_location_is_somebody_elses, AS_03_MIXED, "g"),
    (the_location_is_somebody_elses, AS_03_FOREIGN, "e"),
    (the_vacant_location_is_somebody_elses, AS_03_VACANT, "e"),
)
_GETTING: tuple[_Row, ...] = (
    (the_request_is_malformed, None, ""),
    (the_robot_id_is_empty, None, ""),
    (a_field_is_unknown, AS_06_FIELD["request"], "b"),
    (the_robot_is_somebody_elses, None, ""),
    (there_is_no_such_robot, AS_02, "a"),
    (the_robot_is_not_found, AS_02, "b"),
)


def _placed(call: str, rows: tuple[_Row, ...]) -> Iterator[Rule]:
    """The rules of a call: each cites the call's own table, and is read as that call is read."""
    for one, question, letter in rows:
        yield evolve(one, cite=STATUS[call, one.cite.headings[1]], assumes=question[call][letter] if question else None)


def _subscription(endpoint: Endpoint) -> Operation:
    first = promise(
        "the-latest-state-comes-first",
        "A new stream begins with what is known last of every selected robot.",
        cite=STATUS[endpoint.value,],
    )
    return Operation.with_rules(
        endpoint.value,
        SYSTEM_NAME,
        STATUS[endpoint.value,],
        refusals=_placed(endpoint.value, _SELECTION),
        promises=(first,),
        failures=(INTERNAL,),
        streaming=True,
    )


_LATEST = promise(
    "the-answer-is-the-latest-state", "The answer is the latest state of the robot.", cite=STATUS[GET, "Response"]
)
OPERATIONS: Mapping[str, Operation] = {
    GET: Operation.with_rules(
        GET,
        SYSTEM_NAME,
        STATUS[GET,],
        refusals=_placed(GET, _GETTING),
        promises=(_LATEST,),
        failures=(INTERNAL,),
    ),
    **{endpoint.value: _subscription(endpoint) for endpoint in Endpoint},
}
