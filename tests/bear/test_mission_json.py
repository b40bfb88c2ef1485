"""The JSON of the mission API: every kind of odd input has a meaning, and what is written is read again."""

from __future__ import annotations

from typing import Any

import pytest

from missionfsm.bear.mission.events import Event
from missionfsm.bear.mission.inputs import Defect, Request, Wanted
from missionfsm.bear.mission.state import Family, Fault, Kind, World
from missionfsm.bear.mission.views import MORE, Seen
from missionfsm.bear.wire.messages import Command, Goal, Pose
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON, Malformed, UnreadableError
from missionfsm.kernel.history import Answer
from missionfsm.kernel.rules import OK
from missionfsm.systems import system

CODEC = system("bear.mission").codec
TABLE = Goal(destination_id="table-1")


def navigate(goal: JSON) -> JSON:
    return {"mission": {"baseMission": {"navigateMission": {"goal": goal}}}}


def deliver(*goals: JSON) -> JSON:
    return {"mission": {"serviMission": {"deliveryMission": {"goals": [*goals]}}}}


def one(kind: Kind, *goals: Goal, defects: tuple[Defect, ...] = ()) -> Request:
    return Request("CreateMission", (Wanted(kind, goals),), None, defects)


# The page's own example, and everything that is as good.
WELL_FORMED = {
    "by name": (deliver({"destinationId": "table-1"}), one(Kind.SERVI_DELIVERY, TABLE)),
    "in snake case": (
        {"mission": {"servi_mission": {"delivery_mission": {"goals": [{"destination_id": "table-1"}]}}}},
        one(Kind.SERVI_DELIVERY, TABLE),
    ),
    "null members": (
        {
            "mission": {
                "baseMission": None,
                "serviMission": {"deliveryMission": {"goals": [{"destinationId": "table-1"}]}},
            }
        },
        one(Kind.SERVI_DELIVERY, TABLE),
    ),
    "a pose": (
        navigate({"pose": {"xMeters": 1, "yMeters": "2.5", "headingRadians": -0.5}}),
        one(Kind.BASE_NAVIGATE, Goal(pose=Pose(1.0, 2.5, -0.5))),
    ),
    "a pose at the origin": (navigate({"pose": {}}), one(Kind.BASE_NAVIGATE, Goal(pose=Pose()))),
    "twice the same goal": (
        deliver({"destinationId": "table-1"}, {"destinationId": "table-1"}),
        one(Kind.SERVI_DELIVERY, TABLE, TABLE),
    ),
}
# What is wrong in itself, and how.
DEFECTIVE: dict[str, tuple[JSON, tuple[Defect, ...]]] = {
    "nothing": ({}, (Defect.EMPTY,)),
    "null": (None, (Defect.EMPTY,)),
    "no mission": ({"mission": {}}, (Defect.EMPTY,)),
    "no kind of mission": ({"mission": {"baseMission": {}}}, (Defect.EMPTY,)),
    "no goal": ({"mission": {"baseMission": {"navigateMission": {}}}}, (Defect.MATCH,)),
    "no goals": (deliver(), (Defect.MATCH,)),
    "an empty goal": (navigate({}), (Defect.GOAL,)),
    "an empty destination": (navigate({"destinationId": ""}), (Defect.GOAL,)),
    "NaN in a pose": (navigate({"pose": {"xMeters": "NaN"}}), (Defect.GOAL,)),
    "infinity in a pose": (navigate({"pose": {"yMeters": "-Infinity"}}), (Defect.GOAL,)),
    "too large a number in a pose": (navigate({"pose": {"yMeters": 10**400}}), (Defect.FORMAT,)),
    "a number that no 32-bit float is near": (navigate({"pose": {"yMeters": 1e39}}), (Defect.FORMAT,)),
    "a number that only Python reads": (navigate({"pose": {"yMeters": "1_0"}}), (Defect.FORMAT,)),
    "an unknown field": ({**deliver({"destinationId": "table-1"}), "urgency": 1}, (Defect.FIELD,)),
    "an unknown field inside": (deliver({"destinationId": "table-1", "colour": "red"}), (Defect.FIELD,)),
    "two goals of one": (navigate({"destinationId": "table-1", "pose": {}}), (Defect.FORMAT,)),
    "two missions of one": (
        {"mission": {"baseMission": {"navigateMission": {}}, "serviMission": {}}},
        (Defect.FORMAT,),
    ),
    "a field in both spellings": (navigate({"destinationId": "a", "destination_id": "b"}), (Defect.FORMAT,)),
    "a number for a text": (navigate({"destinationId": 7}), (Defect.FORMAT,)),
    "a text for a number": (navigate({"pose": {"xMeters": "near"}}), (Defect.FORMAT,)),
    "a truth for a number": (navigate({"pose": {"xMeters": True}}), (Defect.FORMAT,)),
    "a text for a message": ({"mission": "go"}, (Defect.FORMAT,)),
    "a message for a list": ({"mission": {"serviMission": {"deliveryMission": {"goals": {}}}}}, (Defect.FORMAT,)),
    "a list for a request": ([], (Defect.FORMAT,)),
}


@pytest.mark.parametrize("case", WELL_FORMED)
def test_a_well_formed_request_is_read(case: str) -> None:
    """Names in either spelling, numbers as texts, null for absent: all of it is protobuf JSON."""
    params, request = WELL_FORMED[case]
    assert CODEC.read_request("CreateMission", params) == request


@pytest.mark.parametrize("case", DEFECTIVE)
def test_an_odd_request_has_a_meaning(case: str) -> None:
    """A request that is empty, malformed, or wrong by itself is read as that, and never refused."""
    params, defects = DEFECTIVE[case]
    assert CODEC.read_request("CreateMission", params).defects == defects


@pytest.mark.parametrize(
    ("params", "command", "defects", "names"),
    [
        ({"missionCommand": {"missionId": "m", "command": "COMMAND_PAUSE"}}, Command.COMMAND_PAUSE, (), ("m",)),
        ({"mission_command": {"mission_id": "m", "command": 1}}, Command(1), (), ("m",)),
        ({"missionCommand": {"missionId": "m", "command": 99}}, None, (Defect.COMMAND,), ("m",)),
        ({"missionCommand": {"missionId": "m", "command": "COMMAND_UNKNOWN"}}, Command(0), (Defect.COMMAND,), ("m",)),
        ({"missionCommand": {"missionId": "m"}}, Command(0), (Defect.COMMAND,), ("m",)),
        ({"missionCommand": {"missionId": "m", "command": "PAUSE"}}, None, (Defect.FORMAT,), ("m",)),
        ({"missionCommand": {"missionId": 7, "command": "COMMAND_PAUSE"}}, None, (Defect.FORMAT,), ()),
        ({"missionCommand": {"command": "COMMAND_PAUSE"}}, Command.COMMAND_PAUSE, (Defect.EMPTY,), ()),
        ({"missionCommand": {"missionId": "", "command": "COMMAND_PAUSE"}}, Command.COMMAND_PAUSE, (Defect.EMPTY,), ()),
        ({}, Command(0), (Defect.EMPTY, Defect.COMMAND), ()),
    ],
)
def test_a_command_is_read(params: JSON, command: Command | None, defects: Any, names: tuple[str, ...]) -> None:
    """A command by name or number; one without a name, or without a mission, is what it is."""
    found, rest = CODEC.split_request("UpdateMission", params)
    request = CODEC.read_request("UpdateMission", rest)
    assert (found, request.command, request.defects) == (names, command, defects)


def test_a_batch_has_the_defects_of_its_entries() -> None:
    """What is wrong with a batch is what is wrong with any entry; an empty batch asks for nothing."""
    good, bad = deliver({"destinationId": "table-1"}), navigate({})
    request = CODEC.read_request("CreateMissionBatch", {"missions": [good, bad, {}]})
    assert request.defects == (Defect.EMPTY, Defect.GOAL)
    assert [wanted.kind for wanted in request.wanted] == [Kind.SERVI_DELIVERY, Kind.BASE_NAVIGATE, None]
    assert CODEC.read_request("AppendMissionBatch", {"missions": []}).defects == (Defect.EMPTY,)


@pytest.mark.parametrize("method", ["ChargeRobot", "ClearMissionStatus", "SkipGoal", "SubscribeMissionStatus"])
def test_a_call_without_parameters_takes_none(method: str) -> None:
    """Calls without parameters take an empty message or none; a field is unknown, a text is malformed."""
    found = [CODEC.read_request(method, params).defects for params in ({}, None, {"x": 1}, "all")]
    assert found == [(), (), (Defect.FIELD,), (Defect.FORMAT,)]


def test_a_well_formed_request_is_written_and_read_again() -> None:
    """What is written for a request, with its names, is read as that request with those names."""
    alphabet = system("bear.mission").alphabet
    worlds = [{"family": family.value} for family in Family]
    prompts = [prompt for world in worlds for prompt in alphabet(world, Bounds(2, goals=3, batch=2)).core_inputs]
    for prompt in prompts:
        names, rest = CODEC.split_request(prompt.method, prompt.params)
        request = CODEC.read_request(prompt.method, rest)
        again, rest = CODEC.split_request(prompt.method, CODEC.write_request(request, names))
        assert (again, CODEC.read_request(prompt.method, rest)) == (names, request)


# Answers.


@pytest.mark.parametrize(
    ("method", "result", "answer", "names"),
    [
        ("CreateMission", {"missionId": "m"}, Answer(OK), ("m",)),
        ("CreateMission", {"mission_id": "m"}, Answer(OK), ("m",)),
        ("SkipGoal", {"missionId": "m", "more": 1}, Answer(OK, MORE), ("m",)),
        ("ClearMissionStatus", {"missionIds": ["a"], "more": 1}, Answer(OK, MORE, unordered=True), ("a",)),
        ("UpdateMission", {"missionId": None}, Answer(OK), ()),
        ("UpdateMission", {"more": 1}, Answer(OK, Malformed("it has 'more'; the answer has no fields")), ()),
        ("CreateMissionBatch", {"missionIds": ["a", "b"]}, Answer(OK), ("a", "b")),
        ("CreateMissionBatch", {}, Answer(OK), ()),
        ("ClearMissionStatus", {"missionIds": ["a"]}, Answer(OK, unordered=True), ("a",)),
        ("UpdateMission", {}, Answer(OK), ()),
        ("SubscribeMissionStatus", {"stream": 3}, Answer(OK), (("stream", 3),)),
        ("CreateMission", {}, Answer(OK, Malformed("a mission id is missing")), ()),
        ("CreateMission", {"missionId": ""}, Answer(OK, Malformed("a mission id is missing")), ()),
        ("CreateMission", {"missionId": 7}, Answer(OK, Malformed("missionId: 7 is not a text")), ()),
        ("CreateMission", "m", Answer(OK, Malformed("the message: 'm' is not an object")), ()),
        (
            "ClearMissionStatus",
            {"missionIds": ["a", None]},
            Answer(OK, Malformed("missionIds[1]: null is not a text"), unordered=True),
            (),
        ),
        ("UpdateMission", [], Answer(OK, Malformed("the message: [] is not an object")), ()),
    ],
)
def test_an_answer_is_read(method: str, result: JSON, answer: Answer, names: tuple[Any, ...]) -> None:
    """An answer has names and nothing else; one that is not of the documented form is garbled, and says how."""
    assert CODEC.read_answer(method, result) == (answer, names)


@pytest.mark.parametrize("result", [{}, {"stream": "1"}, {"stream": True}, [], None])
def test_a_stream_without_a_number_is_refused(result: JSON) -> None:
    """The number of a stream is the adapter's business: without it the history is malformed."""
    with pytest.raises(UnreadableError, match="carries no stream number"):
        CODEC.read_answer("SubscribeMissionStatus", result)


# Status messages.


def shown(*missions: JSON, **metadata: JSON) -> JSON:
    return {"metadata": metadata, "missionStates": {"missions": [*missions], "currentMissionIndex": 0}}


def test_a_message_is_taken_apart() -> None:
    """The ids and the number of a message are names and a mark; messages that differ in nothing else are one."""
    contents = []
    for ids, number in ((("a", "b"), 3), (("x", "y"), "4")):
        missions = [{"missionId": name, "state": "STATE_RUNNING"} for name in ids]
        ((names, marks, rest),) = CODEC.split_message(
            shown(*missions, timestamp="2025-01-01T00:00:00Z", sequenceNumber=number)
        )
        assert (names, marks) == (ids, ((None, int(number)),))
        contents.append(CODEC.read_content(rest))
    assert contents[0] == contents[1]
    assert isinstance(contents[0], Seen)
    assert contents[0].named == (True, True)


@pytest.mark.parametrize(
    "metadata", [{}, {"timestamp": "2025-01-01T00:00:00.5+01:00"}, {"sequence_number": 0}, {"sequenceNumber": None}]
)
def test_a_number_that_is_missing_is_zero(metadata: JSON) -> None:
    """A sequence number that is left out is 0, as protobuf JSON has it."""
    ((_, marks, rest),) = CODEC.split_message(shown(**metadata))
    assert marks == ((None, 0),)
    assert rest.get("metadata") in (None, {"timestamp": None})


@pytest.mark.parametrize(
    ("message", "says"),
    [
        ("news", "the message: 'news' is not an object"),
        ({"metadata": {}, "missionStates": []}, "missionStates: [] is not an object"),
        ({"metadata": {}, "missionStates": {"missions": {}}}, "missionStates.missions: {} is not a list"),
        ({"missionStates": {}}, "metadata: it is missing"),
        (shown(timestamp="yesterday"), "metadata.timestamp: 'yesterday' is not a time"),
        ({"metadata": {}, "missionStates": {"missions": [3]}}, "missionStates.missions[0]: 3 is not an object"),
        (shown({"missionId": 7}), "missionStates.missions[0].missionId: 7 is not a text"),
        (
            shown({"state": "STATE_FLYING"}),
            "missions[0].state: 'STATE_FLYING' is none of STATE_UNKNOWN, STATE_DEFAULT, STATE_",
        ),
        (shown({"currentGoalIndex": 1.5}), "missionStates.missions[0].currentGoalIndex: 1.5 is not an integer"),
        (shown({"currentGoalIndex": 2**40}), "missionStates.missions[0].currentGoalIndex: 1099511627776 does not fit"),
        (shown({"goals": [{"destinationId": "a", "pose": {}}]}), "destinationId and pose are set; only one may be"),
        (shown(sequenceNumber="many"), "metadata.sequenceNumber: 'many' is not an integer"),
        (shown(sequenceNumber=1e20), "metadata.sequenceNumber: 1e+20 does not fit into 64 bits"),
        (shown({"state": None, "mission_feedback": {"base_feedback": {"status": True}}}), "status: true is neither"),
        (shown(sequenceNumber=2**63), "metadata.sequenceNumber: 9223372036854775808 does not fit into 64 bits"),
        (shown(timestamp=7), "metadata.timestamp: 7 is not a timestamp"),
    ],
)
def test_a_garbled_message_says_where(message: JSON, says: str) -> None:
    """A message that is not of the documented form is garbled; what is wrong is told with its place."""
    ((_, _, rest),) = CODEC.split_message(message)
    content = CODEC.read_content(rest)
    assert isinstance(content, Malformed)
    assert says in content.says


def test_a_state_without_a_name_is_kept() -> None:
    """A number that an enum does not have is no malformed message."""
    ((_, _, rest),) = CODEC.split_message(shown({"missionId": "m", "state": 99}))
    content = CODEC.read_content(rest)
    assert isinstance(content, Seen)
    assert content.states.missions[0].state == 99


# Worlds and drives.


def test_a_world_has_defaults() -> None:
    """What a world leaves out is as the adapter protocol says; what is written is read again."""
    tables = ("table-1", "table-2", "table-3")
    assert CODEC.read_world({}) == World(
        Family.SERVI, contact_dock=True, charging_location=True, destinations=tables, occupied=(), blocked=False
    )
    for world in (World(), World(Family.CARTI, contact_dock=False, occupied=("table-2",), blocked=True)):
        assert CODEC.read_world(CODEC.write_world(world)) == world


DRIVES = (
    Event("goalReached"),
    Event("world", (("blocked", True), ("occupied", ("table-1",)))),
    Event("fault", Fault("INTERNAL", applied=True)),
)


@pytest.mark.parametrize("event", DRIVES, ids=[one.name for one in DRIVES])
def test_a_drive_is_written_and_read_again(event: Event) -> None:
    """What is written for an event of the environment is read as that event."""
    assert CODEC.read_drive(CODEC.write_drive(event, ())) == (event, ())


@pytest.mark.parametrize(
    ("drive", "says"),
    [
        ({"event": "fault", "status": "NOT_FOUND"}, "a fault has status INTERNAL or DEADLINE_EXCEEDED"),
        ({"event": "fault", "status": "INTERNAL", "applied": 1}, "a fault has status INTERNAL or DEADLINE_EXCEEDED"),
        ({"event": "world", "blocked": "yes"}, "world.blocked: 'yes' is not true or false"),
        ({"event": "world", "destinations": "table"}, "world.destinations: 'table' is not a list of texts"),
        ("goalReached", "drive: 'goalReached' names no event"),
    ],
)
def test_a_wrong_drive_is_refused(drive: JSON, says: str) -> None:
    """A drive that the protocol does not have is the tester's mistake."""
    with pytest.raises(UnreadableError, match=says):
        CODEC.read_drive(drive)
