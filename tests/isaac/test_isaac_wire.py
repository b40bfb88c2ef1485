"""The wire: bytes in, messages out. Each test states one claim."""

import itertools
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from missionfsm.isaac.wire.framing import Decoder, WireError, decode_line, encode
from missionfsm.isaac.wire.messages import (
    TYPE_IDS,
    Header,
    Message,
    MissionProto,
    MissionStatusProto,
    TextProto,
    Uuid,
    WireStatus,
    signed,
    unsigned,
)

U64 = st.integers(0, 2**64 - 1)
UUIDS = st.builds(Uuid, U64, U64)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
TIMES = st.none() | st.integers(-(2**63), 2**63 - 1)
PAYLOADS = (
    st.builds(TextProto, TEXTS)
    | st.builds(MissionStatusProto, st.none() | UUIDS, st.sampled_from(WireStatus))
    | st.builds(MissionProto, st.none() | UUIDS, TEXTS)
)
MESSAGES = st.builds(Message, st.builds(Header, TEXTS, TIMES, TIMES, st.none() | UUIDS), PAYLOADS)


def line(payload: object, proto: object = None, **header: object) -> bytes:
    made = {"channel": "c", **header}
    if proto is not None:
        made["proto"] = proto
    return json.dumps({"header": made, "payload": payload}).encode()


STATUS_ID = str(signed(TYPE_IDS[MissionStatusProto]))
MISSION_ID = str(signed(TYPE_IDS[MissionProto]))
TEXT_ID = str(signed(TYPE_IDS[TextProto]))


@given(st.lists(MESSAGES, max_size=5), st.lists(st.integers(0, 600), max_size=6), st.booleans())
def test_isaac_messages_come_back_whole_however_the_bytes_are_cut(
    messages: list[Message],
    cuts: list[int],
    windows: bool,  # noqa: FBT001
) -> None:
    """What is encoded is decoded to the same values, under every fragmentation and with either line end."""
    data = b"".join(encode(message) for message in messages)
    if windows:
        data = data.replace(b"\n", b"\r\n")
    decoder = Decoder()
    places = [0, *sorted(cut for cut in cuts if cut < len(data)), len(data)]
    found = [item for a, b in itertools.pairwise(places) for item in decoder.feed(data[a:b])]
    assert found == messages
    assert decoder.close() == []


@given(
    st.lists(
        st.binary(max_size=30) | MESSAGES.map(encode) | st.sampled_from([b"\n", b"\r\n", b"[" * 9, b"x" * 90]),
        max_size=8,
    ),
    st.integers(1, 7),
)
def test_isaac_rubbish_gives_the_same_errors_however_it_is_cut(parts: list[bytes], step: int) -> None:
    """Whatever the bytes are, the results do not depend on the fragmentation, and nothing is raised."""
    data = b"".join(parts)
    whole, pieces = Decoder(limit=64), Decoder(limit=64)
    expected = whole.feed(data) + whole.close()
    found = [item for start in range(0, len(data), step) for item in pieces.feed(data[start : start + step])]
    assert found + pieces.close() == expected
    assert all("\n" not in str(item) for item in expected if isinstance(item, WireError))


def test_isaac_a_mission_looks_like_this_on_the_wire() -> None:
    """The encoder's output is pinned: every 64-bit integer a string, the type id signed, LF at the end."""
    message = Message(Header("mission", 5, 6, Uuid(1, 2)), MissionProto(Uuid(2**64 - 1, 0), '{"a":1}'))
    assert encode(message) == (
        b'{"header":{"channel":"mission","pubtime":"5","acqtime":"6","proto":"-9035847460398774087",'
        b'"uuid":{"lower":"1","upper":"2"}},"payload":{"uuid":{"lower":"18446744073709551615","upper":"0"},'
        b'"config":{"serialized":"{\\"a\\":1}"}}}\n'
    )


def test_isaac_the_shipped_server_sends_the_header_uuid_as_numbers() -> None:
    """The deviation changes the header's identifier and nothing else, and is read all the same."""
    message = Message(Header("m", None, None, Uuid(1, 2)), MissionStatusProto(Uuid(3, 4), WireStatus.FAILURE))
    sent = encode(message, header_uuid_as_numbers=True)
    assert json.loads(sent) == {
        "header": {"channel": "m", "proto": "-8059665372481944188", "uuid": {"lower": 1, "upper": 2}},
        "payload": {"uuid": {"lower": "3", "upper": "4"}, "missionStatus": "failure"},
    }
    assert Decoder().feed(sent) == [message]


@pytest.mark.parametrize("kind", TYPE_IDS)
def test_isaac_type_ids_are_taken_signed_and_unsigned_as_strings_and_numbers(kind: type) -> None:
    """All four ways to write a type id mean the same type."""
    payload = {
        TextProto: {"text": "x"},
        MissionProto: {"config": "{}"},
        MissionStatusProto: {"missionStatus": "success"},
    }
    type_id = TYPE_IDS[kind]
    assert unsigned(signed(type_id)) == type_id
    forms = (type_id, signed(type_id), str(type_id), str(signed(type_id)))
    found = {decode_line(line(payload[kind], proto))[0] for proto in (*forms, None)}
    assert len(found) == 1
    (message,) = found
    assert isinstance(message, Message)
    assert isinstance(message.payload, kind)


@pytest.mark.parametrize("text", ["running", "RUNNING", "Running", 0])
def test_isaac_a_status_is_read_in_any_case_and_by_number(text: object) -> None:
    """Running in any spelling is RUNNING."""
    assert decode_line(line({"missionStatus": text}, STATUS_ID)) == [
        Message(Header("c"), MissionStatusProto(None, WireStatus.RUNNING))
    ]


@pytest.mark.parametrize(
    ("config", "text"),
    [
        ({"serialized": '{"a": 1}'}, '{"a": 1}'),
        ({"a": {"b": [1, 2.5, None]}}, '{"a":{"b":[1,2.5,null]}}'),
        ('{"a": 1}', '{"a": 1}'),
        ("not json", "not json"),
        (None, "{}"),
        ({}, "{}"),
        ({"serialized": {"p": 1}}, '{"serialized":{"p":1}}'),
    ],
)
def test_isaac_a_config_is_read_nested_and_as_text(config: object, text: str) -> None:
    """Every form of a configuration comes out as JSON text with the same meaning."""
    assert decode_line(line({"config": config}, MISSION_ID)) == [Message(Header("c"), MissionProto(None, text))]


@pytest.mark.parametrize(
    ("data", "errors"),
    [
        (b"{", ["line 1, byte 1: not JSON: expecting property name enclosed in double quotes"]),
        ('{"ä": }'.encode(), ["line 1, byte 7: not JSON: expecting value"]),
        (b'{"a": "\xff"}', ["line 1, byte 7: not UTF-8"]),
        (b"[]", ["line 1, byte 0: wanted an object with header and payload, found a list"]),
        (b"{}", ["line 1, byte 0, header: is missing", "line 1, byte 0, payload: is missing"]),
        (b'{"header": 1, "payload": {}}', ["line 1, byte 0, header: wanted an object, found 1"]),
        (line({"text": 5}, TEXT_ID), ["line 1, byte 0, payload.text: wanted a string, found 5"]),
        (
            line({"uuid": {"lower": "-1", "upper": 2**64}}, STATUS_ID, pubtime="1e3"),
            [
                'line 1, byte 0, header.pubtime: wanted a 64-bit integer, found "1e3"',
                'line 1, byte 0, payload.uuid.lower: "-1" is outside 0 … 18446744073709551615',
                "line 1, byte 0, payload.uuid.upper: 18446744073709551616 is outside 0 … 18446744073709551615",
                "line 1, byte 0, payload.missionStatus: wanted running, success or failure, found nothing",
            ],
        ),
        (
            line({"missionStatus": True}, STATUS_ID),
            ["line 1, byte 0, payload.missionStatus: wanted running, success or failure, found true"],
        ),
        (
            line({}, "TensorProto"),
            ["line 1, byte 0, header.proto: TensorProto uses data buffers, which do not travel as JSON"],
        ),
        (
            line({}, 17),
            [
                "line 1, byte 0, header.proto: type 17 does not travel here; "
                "MissionProto, MissionStatusProto, TextProto do"
            ],
        ),
        (
            line({}),
            ["line 1, byte 0, header.proto: is missing, and the payload's fields do not tell the type"],
        ),
        (
            b'{"header": {"channel": "a", "channel": "b"}, "payload": {"text": "x"}}',
            ["line 1, byte 0, header.channel: is given more than once"],
        ),
        (
            b'{"header": {"channel": "a"}, "payload": {"config": {"x": NaN, "y": [1e999]}}}',
            [
                "line 1, byte 0, payload.config.x: is not a finite number",
                "line 1, byte 0, payload.config.y[0]: is not a finite number",
            ],
        ),
        (
            b'{"header": {"channel": "\\ud800"}, "payload": {"text": "x"}}',
            ["line 1, byte 0, header.channel: holds half of a surrogate pair, which is no Unicode text"],
        ),
        (b'{"a": ' + b"9" * 5000 + b"}", ["line 1, byte 0: holds a number of thousands of digits"]),
        (b"[" * 100_000, ["line 1, byte 0: nested more than 200 deep"]),
        (b"[" * 300 + b"]" * 300, [f"line 1, byte 0, {'[0]' * 200}: is nested more than 200 deep"]),
    ],
    ids=range(18),
)
def test_isaac_an_error_says_where_and_what(data: bytes, errors: list[str]) -> None:
    """Each problem of a line is reported, with its place, in one line; all problems of a line are."""
    assert [str(error) for error in decode_line(data)] == errors


def test_isaac_an_error_does_not_stop_the_lines_after_it() -> None:
    """Bad lines are counted, blank ones too, and the good ones among them are read."""
    good = Message(Header("name"), TextProto("r"))
    found = Decoder(limit=100).feed(b"\xff\n\r\n" + encode(good) + b"x" * 101 + b"\n \n" + encode(good) + b"nonsense\n")
    assert [item if isinstance(item, Message) else (item.line, item.kind) for item in found] == [
        (1, "syntax"),
        good,
        (4, "framing"),
        good,
        (7, "syntax"),
    ]


def test_isaac_a_line_at_the_limit_is_read_and_one_beyond_is_not() -> None:
    """The limit counts the bytes before the LF."""
    text = encode(Message(Header("name"), TextProto("r")))
    assert Decoder(limit=len(text) - 1).feed(text) == [Message(Header("name"), TextProto("r"))]
    assert Decoder(limit=len(text) - 2).feed(text) == [
        WireError(1, len(text) - 2, "", f"the line is longer than {len(text) - 2} bytes", "framing")
    ]


def test_isaac_no_more_than_the_limit_is_ever_held() -> None:
    """Ten megabytes without a line end leave one error and no memory behind."""
    decoder = Decoder(limit=1000)
    found = []
    for _ in range(160):
        found += decoder.feed(b"x" * 65536)
        assert decoder.buffered <= 1000
    assert len(found) == 1
    assert decoder.feed(b"\n" + encode(Message(Header("n"), TextProto("t")))) == [Message(Header("n"), TextProto("t"))]


def test_isaac_the_last_line_needs_no_end_and_half_a_line_is_an_error() -> None:
    """At the end of the bytes what is whole is read, what is not is reported."""
    text = encode(Message(Header("name"), TextProto("r")))
    decoder = Decoder()
    assert decoder.feed(text[:-1]) == []
    assert decoder.close() == [Message(Header("name"), TextProto("r"))]
    decoder = Decoder()
    decoder.feed(text[:20])
    assert [type(item) for item in decoder.close()] == [WireError]


def test_isaac_strings_only_refuses_numbers() -> None:
    """Under the other reading of 64-bit integers a number is an error, a string is not."""
    assert [str(error) for error in decode_line(line({"text": ""}, 5), numbers=False)] == [
        "line 1, byte 0, header.proto: wanted a 64-bit integer as a string, found the number 5"
    ]
    assert decode_line(line({"text": ""}, TEXT_ID), numbers=False) == [Message(Header("c"), TextProto(""))]


def test_isaac_other_payloads_are_not_sent() -> None:
    """A type that does not travel is refused by its name."""

    class ImageProto:
        pass

    with pytest.raises(
        TypeError, match=r"^ImageProto does not travel here; MissionProto, MissionStatusProto, TextProto do$"
    ):
        encode(Message(Header("c"), ImageProto()))  # type: ignore[arg-type]


def test_isaac_an_identifier_reads_as_one() -> None:
    """The value is upper * 2**64 + lower, and halves outside 64 bits are refused."""
    assert str(Uuid(lower=1, upper=0xABCDEF0000000000)) == "abcdef00-0000-0000-0000-000000000001"
    assert Uuid.of(Uuid(5, 6).value) == Uuid(5, 6)
    for lower, upper in ((-1, 0), (0, 2**64)):
        with pytest.raises(ValueError, match="must be"):
            Uuid(lower, upper)
