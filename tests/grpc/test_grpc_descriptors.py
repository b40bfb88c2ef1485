"""The descriptors that are built at run time, against the model's own reading of protobuf JSON."""

from __future__ import annotations

import attrs
import pytest
from google.protobuf import descriptor_pb2
from hypothesis import given
from hypothesis import strategies as st

from missionfsm.adapters.grpc.descriptors import (
    NotOnTheWireError,
    decode,
    encode,
    message_class,
    methods,
    path,
    pool,
    unknown,
)
from missionfsm.bear.wire import messages as wire
from missionfsm.bear.wire.enums import ENUMS
from missionfsm.bear.wire.fields import MESSAGES, PACKAGE
from missionfsm.bear.wire.methods import METHODS
from missionfsm.bear.wire.protojson import MalformedError, read, write
from missionfsm.systems import system
from missionfsm.tools.conform.run import BOUNDS

KINDS: dict[str, type] = {
    "services.robot.CreateMissionRequest": wire.MissionRequest,
    "services.robot.CreateMissionBatchRequest": wire.BatchRequest,
    "services.robot.CreateMissionWorkflowRequest": wire.WorkflowRequest,
    "services.robot.UpdateMissionRequest": wire.UpdateRequest,
    "services.robot.SubscribeMissionStatusResponse": wire.MissionStatus,
}


def test_every_name_of_the_table_is_in_the_pool() -> None:
    """Every message, enum and call of the table has its descriptor, with its number."""
    for name, fields in MESSAGES.items():
        found = pool().FindMessageTypeByName(f"{PACKAGE}.{name}")
        assert {one.name: one.number for one in found.fields} == {one.name: one.number for one in fields}
    for name, values in ENUMS.items():
        found = pool().FindEnumTypeByName(f"{PACKAGE}.{name}")
        assert {one.name: one.number for one in found.values} == values
    for one in METHODS:
        service = pool().FindServiceByName(f"{PACKAGE}.{one.service}")
        assert service.FindMethodByName(one.name).input_type.full_name == f"{PACKAGE}.{one.request}"


def test_every_type_of_the_table_exists() -> None:
    """No field of the table has a type that the table, the scalars and google.protobuf do not have."""
    known = {*MESSAGES, *ENUMS, "string", "int32", "int64", "float", "google.protobuf.Timestamp", "google.protobuf.Any"}
    assert {field.type for fields in MESSAGES.values() for field in fields} <= known


def test_bytes_are_those_of_the_published_numbers() -> None:
    """A request has the bytes that the numbers of the published definitions give, worked out by hand."""
    request = {"mission": {"serviMission": {"deliveryMission": {"goals": [{"destinationId": "a"}]}}}}
    # 1: mission { 2: servi_mission { 1: delivery_mission { 1: goals { 1: "a" } } } }
    assert encode("services.robot.CreateMissionRequest", request) == bytes.fromhex("0a0912070a050a030a0161")


def test_a_path_names_package_service_and_call() -> None:
    """The path of a call is what a generated client sends."""
    called = methods("bear.mission")["SkipGoal"]
    assert path(called) == "/bearrobotics.api.v1.services.robot.APIService/SkipGoal"


@pytest.mark.parametrize(
    "value",
    [
        {"mission": {"serviMission": {}, "baseMission": {}}},
        {"mission": 5},
        {"mission": {"noSuchField": 1}},
        [],
        None,
    ],
)
def test_what_binary_cannot_say_is_refused_in_one_line(value: object) -> None:
    """Two members of a oneof, wrong types and unknown fields are no message; the reason is one line."""
    with pytest.raises(NotOnTheWireError) as refused:
        encode("services.robot.CreateMissionRequest", value)
    assert "\n" not in str(refused.value)


@given(st.binary(max_size=40))
def test_any_bytes_are_a_message_or_refused(data: bytes) -> None:
    """Bytes are read, and then can be written again, or refused."""
    for name in KINDS:
        try:
            value = decode(name, data)
        except NotOnTheWireError:
            continue
        unknown(name, data)
        assert decode(name, encode(name, value)) == value


def test_a_field_that_the_table_does_not_know_is_told() -> None:
    """Unknown fields are named by the way to them."""
    inner = bytes.fromhex("9a0601ff")  # field 99, one byte
    data = b"\x0a" + bytes([len(inner)]) + inner
    assert unknown("services.robot.CreateMissionRequest", data) == ("mission.99",)
    assert decode("services.robot.CreateMissionRequest", data) == {"mission": {}}


@given(st.data())
def test_what_the_model_writes_protobuf_reads_alike(data: st.DataObject) -> None:
    """A message that the model writes as JSON comes back the same through binary protobuf."""
    name, kind = data.draw(st.sampled_from(sorted(KINDS.items(), key=lambda one: one[0])))
    value = data.draw(st.sampled_from(EXAMPLES[name]))
    there = write(read(kind, value))
    assert read(kind, decode(name, encode(name, there))) == read(kind, there)


EXAMPLES: dict[str, list[object]] = {
    "services.robot.CreateMissionRequest": [
        {},
        {"mission": {}},
        {"mission": {"baseMission": {"navigateMission": {"goal": {"pose": {"xMeters": 0.5, "headingRadians": -1.5}}}}}},
        {"mission": {"cartiMission": {"traversePatrolMission": {"goals": [{"destinationId": "a"}, {}]}}}},
    ],
    "services.robot.CreateMissionBatchRequest": [{"missions": [{}, {"mission": {"serviMission": {}}}]}],
    "services.robot.CreateMissionWorkflowRequest": [
        {"missionWorkflow": {"serviWorkflow": {"birthday": {"goal": {"destinationId": "x"}}}}}
    ],
    "services.robot.UpdateMissionRequest": [{"missionCommand": {"missionId": "m", "command": "COMMAND_CANCEL"}}],
    "services.robot.SubscribeMissionStatusResponse": [
        {
            "metadata": {"timestamp": "2025-06-01T12:00:00Z", "sequenceNumber": "9007199254740993"},
            "missionStates": {
                "missions": [{"missionId": "m", "state": "STATE_PAUSED", "missionType": {"serviType": 4}}],
                "currentMissionIndex": -1,
            },
        }
    ],
}


@pytest.mark.parametrize("name", sorted(KINDS))
@pytest.mark.parametrize(
    "text",
    [
        {"metadata": {"sequenceNumber": "12"}},
        {"metadata": {"sequence_number": 12}},
        {"metadata": {"timestamp": "2025-02-30T00:00:00Z"}},
        {"missionStates": {"currentMissionIndex": 2147483648}},
        {"missionStates": {"missions": [{"state": 77}]}},
        {"missionStates": {"missions": [{"state": "STATE_NONE"}]}},
        {"missionStates": {"missions": {}}},
        {"missionStates": None},
        {"missionCommand": {"command": "COMMAND_NONE"}},
        {"missions": None},
        {"missions": [None]},
        {"mission": {"baseMission": {"navigateMission": {"goal": {"pose": {"xMeters": "NaN"}}}}}},
        {"mission": {"baseMission": {"navigateMission": {"goal": {"pose": {"xMeters": 1e39}}}}}},
    ],
)
def test_the_model_and_protobuf_agree_on_what_is_malformed(name: str, text: object) -> None:
    """Where a message has the field, the model reads it or refuses it just as protobuf's own JSON does."""
    fields = {attribute.name for attribute in attrs.fields(KINDS[name])}
    given_fields = {"".join(f"_{c.lower()}" if c.isupper() else c for c in key) for key in text}  # type: ignore[union-attr]
    if not given_fields <= fields:
        return
    try:
        encode(name, text)
        protobuf_reads = True
    except NotOnTheWireError:
        protobuf_reads = False
    try:
        read(KINDS[name], text)
        model_reads = True
    except MalformedError:
        model_reads = False
    assert model_reads == protobuf_reads


def test_descriptors_are_files_that_any_tool_reads() -> None:
    """Each file of the pool is a complete FileDescriptorProto, so that reflection can hand it out."""
    message = message_class("core.MissionState")
    file = descriptor_pb2.FileDescriptorProto()
    message.DESCRIPTOR.file.CopyToProto(file)
    assert file.syntax == "proto3"
    assert [one.name for one in file.message_type] == ["MissionState"]


@pytest.mark.parametrize("name", ["bear.mission", "bear.status"])
def test_what_binary_can_carry_is_known_without_its_library(name: str) -> None:
    """Of everything that the tester tries, in every world: what is said to be carried is what can be encoded."""
    tried = system(name)
    worlds = tried.alphabet({}, BOUNDS).worlds
    told, right = {}, {}
    for prompt in (one for world in worlds for one in tried.alphabet(world, BOUNDS).inputs):
        said = repr(prompt)
        told[said] = tried.codec.carries(prompt.method, prompt.params)
        try:
            encode(methods(name)[prompt.method].request, prompt.params)
            right[said] = True
        except NotOnTheWireError:
            right[said] = False
    assert set(told.values()) == {True, False}
    # The library takes an empty list for an empty message; it is of the wrong type all the same.
    assert {one: can for one, can in right.items() if "'serviWorkflow': []" not in one} == {
        one: can for one, can in told.items() if "'serviWorkflow': []" not in one
    }
