"""The model's codec and protobuf's own JSON agree: on what is a message, and on what it says."""

from __future__ import annotations

import functools
import itertools
import math
import random
import struct
from typing import Any, get_args

import attrs
import pytest
from google.protobuf import json_format, timestamp_pb2
from hypothesis import given, settings
from hypothesis import strategies as st
from wirevalues import NOT_MODELLED, TOLERATED, laxities, message, mutated, usually

from missionfsm.adapters.grpc import usual
from missionfsm.adapters.grpc.descriptors import NotOnTheWireError, decode, encode, message_class, methods, pool
from missionfsm.app.live import Live
from missionfsm.bear.status import messages as status
from missionfsm.bear.wire import messages as wire
from missionfsm.bear.wire.enums import ENUMS
from missionfsm.bear.wire.fields import MESSAGES
from missionfsm.bear.wire.methods import Method
from missionfsm.bear.wire.protojson import MalformedError, camel, read, unknown_fields, write
from missionfsm.kernel.codec import JSON
from missionfsm.systems import system
from missionfsm.tools.conform.run import BOUNDS

ROBOT, CLOUD = "services.robot", "services.cloud"
ROOTS: dict[str, type] = {
    f"{ROBOT}.CreateMissionRequest": wire.MissionRequest,
    f"{ROBOT}.AppendMissionRequest": wire.MissionRequest,
    f"{ROBOT}.CreateMissionBatchRequest": wire.BatchRequest,
    f"{ROBOT}.CreateMissionWorkflowRequest": wire.WorkflowRequest,
    f"{ROBOT}.UpdateMissionRequest": wire.UpdateRequest,
    f"{ROBOT}.ChargeRobotRequest": wire.Empty,
    f"{ROBOT}.ClearMissionStatusRequest": wire.Empty,
    f"{ROBOT}.SkipGoalRequest": wire.Empty,
    f"{ROBOT}.SubscribeMissionStatusRequest": wire.Empty,
    f"{ROBOT}.SubscribeMissionStatusResponse": wire.MissionStatus,
    f"{ROBOT}.UpdateMissionResponse": wire.Empty,
    **{
        f"{ROBOT}.{call}Response": wire.MissionId
        for call in ("CreateMission", "AppendMission", "ChargeRobot", "SkipGoal")
    },
    **{
        f"{ROBOT}.{call}Response": wire.MissionIds
        for call in ("CreateMissionBatch", "AppendMissionBatch", "CreateMissionWorkflow", "ClearMissionStatus")
    },
    f"{CLOUD}.GetRobotStatusRequest": status.StatusRequest,
    f"{CLOUD}.GetRobotStatusResponse": status.StatusResponse,
    **{
        f"{CLOUD}.Subscribe{what}Request": status.SubscribeRequest
        for what in ("BatteryStatus", "ErrorCodes", "NavigationStatus", "NetworkStatus", "OnlineStatus", "RobotStatus")
    },
    f"{CLOUD}.SubscribeBatteryStatusResponse": status.BatteryMessage,
    f"{CLOUD}.SubscribeNavigationStatusResponse": status.NavigationMessage,
    f"{CLOUD}.SubscribeRobotStatusResponse": status.RobotMessage,
    "core.ErrorCodesWithMetadata": status.ErrorCodesEntry,
    "core.NetworkStateWithMetadata": status.NetworkEntry,
    "core.RobotConnectionWithMetadata": status.OnlineEntry,
}
"""The outermost messages, and what the model reads them as."""
MAPS = {f"{CLOUD}.Subscribe{what}Response" for what in ("ErrorCodes", "NetworkStatus", "OnlineStatus")}
"""Messages that the model takes apart by robot before it reads the entries."""
ONEOFS_BY_RULE = {"core.RobotState", "core.RobotSelector"}
"""Messages whose oneofs the model leaves to its rules, so that two members are told as what they break."""


def _inner(attribute: attrs.Attribute[Any]) -> Any:
    """The type of a field's content, whether it is optional or a list."""
    inner = [one for one in get_args(attribute.type) if one not in (type(None), ...)]
    return inner[0] if inner else attribute.type


def _pairs() -> dict[str, type]:
    """Every message of the table that the model knows, with its class."""
    found: dict[str, type] = {}

    def walk(name: str, kind: type) -> None:
        if name in found:
            assert found[name] is kind
            return
        found[name] = kind
        attrs.resolve_types(kind)
        fields = {one.name: one for one in attrs.fields(kind)}
        for field in MESSAGES[name]:
            if field.type in MESSAGES and field.name in fields:
                walk(field.type, _inner(fields[field.name]))

    for name, kind in ROOTS.items():
        walk(name, kind)
    return found


PAIRS = _pairs()


def test_the_model_has_the_messages_of_the_table() -> None:
    """Fields, oneofs and enums of the model's classes are those of the table, but for what is waived."""
    only_in_table = {}
    for name, kind in PAIRS.items():
        fields = {one.name: one for one in attrs.fields(kind)}
        table = {field.name: field for field in MESSAGES[name]}
        assert set(fields) <= set(table), name
        only_in_table |= {f"{name}.{field}": True for field in set(table) - set(fields)}
        for field, attribute in fields.items():
            if name not in ONEOFS_BY_RULE:
                assert attribute.metadata.get("oneof", "") == table[field].oneof, (name, field)
            if table[field].type in ENUMS:
                assert {one.name: one.value for one in _inner(attribute)} == ENUMS[table[field].type], (name, field)
    assert set(only_in_table) == {"core.Mission.extension", "core.RobotState.localization_state"}
    assert set(MESSAGES) - set(PAIRS) == MAPS | {"core.LocalizationState", f"{ROBOT}.AppendMissionBatchRequest"}


def modelled(name: str, value: JSON) -> object:
    """What the model reads; None where it does not, or finds fields that the table does not have."""
    try:
        found = read(PAIRS[name], value)
    except MalformedError:
        return None
    strange = [path for path in unknown_fields(PAIRS[name], value) if path.rpartition(".")[2] not in NOT_MODELLED]
    return None if strange else found


def encoded(name: str, value: JSON) -> bytes | None:
    """The bytes that protobuf's own JSON makes; None where it makes none."""
    try:
        return encode(name, value)
    except NotOnTheWireError:
        return None


def comparable(value: Any, name: str = "") -> Any:
    """What a message says: floats as 32 bits hold them, timestamps as points in time."""
    if attrs.has(type(value)):
        return tuple((one.name, comparable(getattr(value, one.name), one.name)) for one in attrs.fields(type(value)))
    if isinstance(value, tuple):
        return tuple(map(comparable, value))
    if name == "timestamp" and value is not None:
        point = timestamp_pb2.Timestamp()
        point.FromJsonString(value)
        return point.seconds, point.nanos
    if isinstance(value, float) and math.isfinite(value):
        return struct.unpack("f", struct.pack("f", value))[0]
    return "NaN" if isinstance(value, float) and math.isnan(value) else value


def agree(name: str, value: JSON) -> None:
    """Fail where the model and protobuf do not agree on a value."""
    found, data = modelled(name, value), encoded(name, value)
    lax = set(laxities(name, value))
    if lax or _two_by_rule(name, value):
        assert found is None or lax <= TOLERATED, (name, value, lax)
        return
    assert (found is None) == (data is None), (name, value)
    if found is None or data is None:
        return
    assert comparable(read(PAIRS[name], decode(name, data))) == comparable(found), (name, value)
    again = encoded(name, write(found))
    assert again is not None, (name, value)
    assert comparable(read(PAIRS[name], decode(name, again))) == comparable(found), (name, value)


def _two_by_rule(name: str, value: JSON) -> bool:
    """Whether two members of a oneof are set that the model leaves to its rules."""
    if not isinstance(value, dict):
        return False
    set_ = {field.name: value.get(field.name, value.get(camel(field.name))) for field in MESSAGES[name]}
    if name in ONEOFS_BY_RULE and sum(set_[field.name] is not None for field in MESSAGES[name] if field.oneof) > 1:
        return True
    return any(
        _two_by_rule(field.type, one)
        for field in MESSAGES[name]
        if field.type in MESSAGES
        for one in (set_[field.name] if isinstance(set_[field.name], list) else [set_[field.name]])
    )


def mutants(chance: random.Random) -> None:
    """A message and three mutants of it, each of the one before."""
    name = chance.choice(sorted(PAIRS))
    value: JSON = message(chance, name)
    for _ in range(4):
        agree(name, value)
        value = mutated(chance, value)


@given(st.randoms(use_true_random=False))
@settings(max_examples=300)
def test_the_model_and_protobuf_agree(chance: random.Random) -> None:
    """What the model reads protobuf reads, with the same content, and nothing else; so of what the model writes."""
    mutants(chance)


@pytest.mark.long
@given(st.integers(0, 2**32))
@settings(max_examples=100)
def test_the_model_and_protobuf_agree_on_much_more(seed: int) -> None:
    """The same for many messages."""
    chance = random.Random(seed)
    for _ in range(100):
        mutants(chance)


@given(st.randoms(use_true_random=False))
@settings(max_examples=300)
def test_what_is_written_as_usual_has_the_bytes_of_protobufs_own_json(chance: random.Random) -> None:
    """Whatever is read the fast way, whole or mutated, protobuf's own JSON reads as well, and gives the same bytes."""
    name = chance.choice(sorted(MESSAGES))
    value: JSON = usually(name, message(chance, name))
    for _ in range(4):
        data = at_once(name, value)
        assert data is None or data == by_its_own_json(name, value), (name, value)
        value = mutated(chance, value)


def at_once(name: str, value: JSON) -> bytes | None:
    """The bytes that the fast way makes; None where it makes none."""
    try:
        return message_class(name)(**usual.fields(name, value)).SerializeToString(deterministic=True)
    except (ValueError, TypeError):
        return None


def by_its_own_json(name: str, value: JSON) -> bytes:
    """The bytes that protobuf's own JSON makes."""
    found = json_format.ParseDict(value, message_class(name)(), descriptor_pool=pool())
    return found.SerializeToString(deterministic=True)


@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_what_the_model_writes_is_written_as_usual(name: str) -> None:
    """All that a reference answers and shows, in a conversation of its alphabet, takes the fast way."""
    served = system(name)
    live = Live(served, clock=itertools.count().__next__)
    world = served.alphabet({}, BOUNDS).worlds[0]
    live.reset(world)
    seen: list[str] = []

    def take(method: Method, shown: JSON) -> None:
        assert at_once(method.response, shown) is not None, (method.name, shown)
        seen.append(method.name)

    alphabet = served.alphabet(world, BOUNDS)
    for prompt in (one for one in alphabet.inputs if served.codec.carries(one.method, one.params)):
        method = methods(name)[prompt.method]
        if method.streams:
            live.subscribe(prompt.method, prompt.params, functools.partial(take, method))
        else:
            answered = live.call(prompt.method, prompt.params)
            if answered.error is None:
                take(method, answered.result)
        for drive in alphabet.drives[:3]:
            live.drive(drive)
    assert len(set(seen)) > 3


@pytest.mark.parametrize("name", sorted(MAPS))
def test_maps_by_robot_come_back_as_they_were(name: str) -> None:
    """Messages with an entry for each robot survive the way through bytes."""
    chance = random.Random(0)
    for _ in range(50):
        value = message(chance, name)
        read_back = decode(name, encode(name, value))
        assert decode(name, encode(name, read_back)) == read_back


@pytest.mark.parametrize("value", [{"status": float("inf")}, {"status": "\ud800"}, {"status": 2**70}])
def test_whatever_protobuf_raises_is_a_refusal(value: JSON) -> None:
    """Values on which protobuf fails in other ways than by saying so are refused like any other."""
    with pytest.raises(NotOnTheWireError):
        encode("core.BaseFeedback", value)
