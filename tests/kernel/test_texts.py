"""A line that is known by its text says what it says when it is read: whatever was remembered before."""

from __future__ import annotations

import json

import orjson
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.history import Event, Received
from missionfsm.oracle.line_cache import LONG, Texts
from missionfsm.oracle.transcript import Transcript
from missionfsm.systems import system

CODEC = system("bear.mission").codec

ENDS = (
    ',"method":"SkipGoal","params":{}}',
    ',"method":"SkipGoal"}',
    ', "method": "SkipGoal", "params": {}}',
    ',"method":"ClearMissionStatus","params":{}}',
    ',"method":"UpdateMission","params":{"missionCommand":{"missionId":"m","command":"COMMAND_PAUSE"}}}',
    ',"method":"cancel","params":{"stream":1}}',
    ',"method":"SkipGoal","params":{},"call":7}',
    ',"method":"Skip"}',
    ',"result":{}}',
    ',"result":{"missionIds":[]}}',
    ',"result":{"missionIds":["m"]}}',
    ',"error":{"status":"FAILED_PRECONDITION"}}',
    ',"error":{"status":"OK"}}',
    ',"result":{},"return":2}',
    "}",
)
NAMES = ("m", "n", "a b", "-", "call", "result", "COMMAND_PAUSE", "ü", "\\u006d", 'q\\"', "", "\t", "mission-12")
NAMED = (
    ',"method":"UpdateMission","params":{"missionCommand":{"missionId":"%s","command":"COMMAND_PAUSE"}}}',
    ',"method":"UpdateMission","params":{"missionCommand":{"command":"COMMAND_PAUSE","missionId":"%s"}}}',
    ',"result":{"missionId":"%s"}}',
    ',"result":{"missionIds":["%s"]}}',
    ',"result":{"missionIds":["%s","x"]}}',
)
NUMBERS = ("1", "2", "3", "7", "12", "007", "-1", "1.5", "1e2", " 1", "true", '"1"', "9" * 20, "")
WHOLE = (
    '{"settled":true}',
    '{"settled":false}',
    '{"drive":{"event":"goalReached"}}',
    '{"drive":{"event":"world","blocked":true}}',
    '{"stream":1,"message":{"missionStates":{"missions":[],"currentMissionIndex":-1}}}',
    '{"stream":1,"closed":true}',
    "[]",
    "{}",
)

METADATA = (
    *(f'"metadata":{{"timestamp":"2025-01-01T00:00:0{n}Z","sequenceNumber":{n}}},' for n in range(4)),
    '"metadata":{"timestamp":"2025-01-01T00:00:00.5+01:00","sequenceNumber":"7"},',
    '"metadata":{"timestamp":"2025-01-01t00:00:00z","sequenceNumber":07},',
    '"metadata":{"timestamp":"2025-01-01","sequenceNumber":8},',
    '"metadata":{"sequenceNumber":8,"timestamp":"2025-01-01T00:00:00Z"},',
    '"metadata": {"timestamp":"2025-01-01T00:00:00Z","sequenceNumber":8},',
    '"metadata":{"timestamp":"2025-01-01T00:00:00Z","sequenceNumber":8,"x":1},',
    "",
)
MISSIONS = (
    '{"missionId":"%s","state":"STATE_RUNNING","owner":"api"}',
    '{"missionId":"%s","state":"STATE_RUNNING","owner":"%s"}',
    '{"mission_id":"%s","state":"STATE_RUNNING","owner":"api"}',
    '{"missionId":"%s","missionId":"n","state":"STATE_RUNNING"}',
    '{"missionId":"%s","mission_id":"m","state":"STATE_RUNNING"}',
    '{"missionId":"%s","state":"STATE_RUNNING","missionFeedback":{"missionId":"%s"}}',
    '{"x":{"missionId":"%s"},"mission_id":"m","state":"STATE_RUNNING"}',
    '{"state":"STATE_RUNNING","owner":"%s"}',
)
MESSAGES = (
    '{"stream":%s,"message":{%s"missionStates":{"missions":[%s],"currentMissionIndex":0}}}',
    '{"stream":%s,"message":{%s"missionStates":{"missions":[%s],"currentMissionIndex":0}},"closed":true}',
    '{"stream":%s,"message":{%s"missionStates":{"missions":[%s],"currentMissionIndex":0}},"stream":2}',
    '{"stream":%s,"message":{%s"missionStates":{"missions":[%s]}},"message":{"missionStates":{"missions":[]}}}',
    '{"stream":%s,"message":{%s"missionStates":{"missions":[%s]},"metadata":null}}',
    '{"stream":%s,"message":{%s"mission_states":{"missions":[%s]}}}',
    '{"stream":%s,"message":{%s"missionStates":{"missions":[%s]}}',
    '{"stream":%s,"closed":true,"message":{%s"missionStates":{"missions":[%s]}}}',
)

BEGINNINGS = ('{"call":', '{"return":')
line = st.one_of(
    st.builds("".join, st.tuples(*map(st.sampled_from, (BEGINNINGS, NUMBERS, ENDS)))),
    st.sampled_from(WHOLE),
)
named = st.builds(str.__mod__, st.sampled_from(NAMED), st.sampled_from(NAMES))
CREATES = ',"method":"CreateMission","params":{}}'
mission = st.builds(
    lambda form, name: form.replace("%s", name), st.sampled_from(MISSIONS), st.sampled_from((*NAMES, "mn"))
)
message = st.builds(
    str.__mod__,
    st.sampled_from(MESSAGES),
    st.tuples(
        st.sampled_from(NUMBERS),
        st.sampled_from(METADATA),
        st.builds(",".join, st.lists(mission, max_size=3)),
    ),
)
call, answer = (
    st.builds(begins.__add__, st.builds("{}{}".format, st.integers(1, 30), st.one_of(st.sampled_from(ends), named)))
    for begins, ends in (('{"call":', (*ENDS[:5], CREATES)), ('{"return":', ENDS[8:12]))
)


def read(transcript: Transcript, texts: Texts | None, text: str) -> tuple[Event, ...] | str:
    """The events of a line, or what is wrong with it."""
    try:
        known = texts.known(text.encode()) if texts else None
        if known is not None:
            return known
        parsed: JSON = orjson.loads(text)
        return texts.read(text.encode(), parsed) if texts else transcript.read(parsed)
    except (UnreadableError, json.JSONDecodeError) as error:
        return str(error)


@given(st.lists(st.one_of(line, call, answer, message), max_size=40), st.frozensets(st.integers(1, 30), max_size=3))
@example(['{"call":1,"method":"SkipGoal","params":{}}', '{"call":1,"method":"SkipGoal","params":{}}'], frozenset())
@example(
    [
        *(BEGINNINGS[0] + str(number) + NAMED[0] % name for number, name in enumerate(NAMES, 1)),
        *(BEGINNINGS[0] + str(number) + CREATES for number in range(20, 20 + len(NAMES))),
        *(BEGINNINGS[1] + str(number) + NAMED[2] % name for number, name in enumerate(NAMES, 20)),
    ],
    frozenset(),
)
@example(
    ['{"call":1,"method":"SkipGoal"}', '{"call":2,"method":"SkipGoal"}', '{"return":2,"result":{}}'], frozenset({2})
)
@example(
    [
        text
        for form in MESSAGES
        for metadata in METADATA
        for one in MISSIONS
        for text in (form % ("1", metadata, one.replace("%s", name)) for name in NAMES)
    ],
    frozenset(),
)
def test_a_known_text_says_what_its_line_says(lines: list[str], lost: frozenset[int]) -> None:
    """With texts remembered and without: the same events, and the same complaints."""
    plain, known = Transcript(CODEC, lost=lost), Transcript(CODEC, lost=lost)
    texts = Texts(known, orjson.dumps)
    for text in lines:
        assert read(known, texts, text) == read(plain, None, text)
        assert (known.pending, known.answered) == (plain.pending, plain.answered)


def test_what_comes_again_is_known() -> None:
    """A call, its answer, a drive and a silence need to be read once, whatever name is in them; not so a long line."""
    transcript = Transcript(CODEC)
    texts = Texts(transcript, orjson.dumps)
    long = json.dumps({"call": 5, "method": "SkipGoal", "params": {"x": LONG * "x"}}, separators=(",", ":"))
    named = (
        '{"call":6,"method":"UpdateMission","params":{"missionCommand":{"missionId":"m","command":"COMMAND_PAUSE"}}}'
    )
    once = ['{"call":1' + ENDS[0], '{"return":1' + ENDS[11], WHOLE[0], WHOLE[2], long, named]
    for text in once:
        assert texts.known(text.encode()) is None
        read(transcript, texts, text)
    repeats = [text.replace(":1,", ":2,").replace(":5,", ":7,").replace(":6,", ":8,") for text in once]
    assert [texts.known(text.encode()) is not None for text in repeats] == [True, True, True, True, False, True]


def test_a_message_is_known_whatever_its_ids_and_its_metadata_are() -> None:
    """So that each thing shown is read once; but one that is written in another way, or with a key twice, anew."""
    transcript = Transcript(CODEC)
    texts = Texts(transcript, orjson.dumps)
    form, two = MESSAGES[0], f"{MISSIONS[0]},{MISSIONS[0]}"
    assert texts.known((form % (1, METADATA[1], two % ("a", "b"))).encode()) is None
    read(transcript, texts, form % (1, METADATA[1], two % ("a", "b")))
    known = texts.known((form % (3, METADATA[4], two % ("n-2", "a b"))).encode())
    assert known is not None
    (event,) = known
    assert isinstance(event, Received)
    assert (event.channel, event.names, event.marks) == (("stream", 3), ("n-2", "a b"), ((None, 7),))
    for other in (
        form % (3, METADATA[4], two % ("n-2", "\\u0061")),
        form % (3, METADATA[4], two % ("n-2", "")),
        form % (3, METADATA[4], two % ("n-2", "ü")),
        form % (3, METADATA[6], two % ("a", "b")),
        form % (3, METADATA[4], two % ("a", "b") + "," + MISSIONS[0] % "c"),
        form % ("03", METADATA[4], two % ("a", "b")),
    ):
        assert texts.known(other.encode()) is None
    twice = MESSAGES[3] % (1, METADATA[1], MISSIONS[0] % "a")
    read(transcript, texts, twice)
    assert texts.known(twice.encode()) is None


@pytest.mark.parametrize("number", ["02", "2.0", "true", '"2"', " 2", "-2", "2e0", "9" * 30, ""])
def test_only_plain_numbers_are_known(number: str) -> None:
    """A number that is written in another way, or is none, is left to be read."""
    texts = Texts(Transcript(CODEC), orjson.dumps)
    read(texts._transcript, texts, '{"call":1' + ENDS[0])
    assert texts.known(f'{{"call":{number}{ENDS[0]}'.encode()) is None
    assert texts.known(f'{{"call":2{ENDS[0]}'.encode()) is not None
