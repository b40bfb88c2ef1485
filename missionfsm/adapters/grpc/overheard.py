"""The traffic on connections through a proxy, as the lines of a history.

Bytes are read after they were passed on, elsewhere: see `Overheard`. A call is noted when its request is complete, a
message when it is complete, and the end of a call when its trailers are. Each is noted before the other end can have
seen it, so that what an end does in response is noted later. What a tester does through the control service is noted as
well (`missionfsm.adapters.grpc.steering`).
"""

from __future__ import annotations

import enum
import itertools
from collections.abc import Iterator
from typing import NewType
from urllib.parse import unquote_to_bytes

import grpc
from attrs import Factory, define, frozen

from missionfsm.adapters.grpc.descriptors import NotOnTheWireError, decode, methods, path
from missionfsm.adapters.grpc.framing import Messages
from missionfsm.adapters.grpc.http2 import Data, Direction, Event, Headers, Reset, TableSize, UnreadableHttp2Error
from missionfsm.adapters.grpc.steering import PATHS, REFUSED, Line, Steered, Steering, Steers, struct
from missionfsm.bear.wire.methods import Method
from missionfsm.kernel.codec import JSON, UnreadableError

STATUS_OF_RESET = {0x7: "UNAVAILABLE", 0x8: "CANCELLED", 0xB: "RESOURCE_EXHAUSTED", 0xC: "PERMISSION_DENIED"}
"""What clients make of a stream that the server resets; of any other code they make INTERNAL."""
STATUS_OF_HTTP = {
    b"401": "UNAUTHENTICATED",
    b"403": "PERMISSION_DENIED",
    b"404": "UNIMPLEMENTED",
    **dict.fromkeys((b"429", b"502", b"503", b"504"), "UNAVAILABLE"),
}
"""What clients make of an answer of HTTP without a status of gRPC, such as a gateway's; of any other UNKNOWN."""
STATUSES = {str(code.value[0]).encode(): code.name for code in grpc.StatusCode}
LEAVE_OPEN = frozenset(("UNAVAILABLE", "CANCELLED", "RESOURCE_EXHAUSTED", "UNAUTHENTICATED", "UNKNOWN"))
"""What clients make by themselves and a history may hold; it says nothing of what became of the call."""


class End(enum.Enum):
    """An end of a connection."""

    CLIENT = "client"
    ROBOT = "robot"


Connection = NewType("Connection", int)


@frozen
class Chunk:
    """Bytes as they came in from one end of a connection.

    Attributes:
        at: seconds of the clock.
        data: b"" where that end sends no more.
    """

    at: float
    connection: Connection
    end: End
    data: bytes


@define
class Call:
    """A call of a method that is recorded.

    Attributes:
        number: as the history has it; 0 while the request is not whole.
        stream: that of the history; 0 where none has begun.
        refused: whether it ended with an error before it began.
        result: that of the answer, if it has come.
        http: the status of HTTP.
    """

    method: Method
    sent: Messages
    answered: Messages = Factory(Messages)
    number: int = 0
    stream: int = 0
    refused: bool = False
    result: JSON = None
    http: bytes = b""


class Overheard:
    """Reads what is said on many connections, and numbers the calls and streams of all of them.

    Args:
        system: which calls are noted: those of ``bear.mission`` or ``bear.status``, and what the control service is
            asked to do to it. Of others nothing is.
        others: whether others use it past here.
    """

    def __init__(self, system: str, *, others: bool = False) -> None:
        self._methods = {path(one).encode(): one for one in methods(system).values()}
        self._connections: dict[Connection, _Connection] = {}
        self._calls = itertools.count(1)
        self._streams = itertools.count(1)
        self._steering = Steering(system, others)

    def __call__(self, chunk: Chunk) -> list[Line]:
        """The lines that these bytes make, in order.

        Raises:
            UnreadableError: something was asked or answered that cannot be read.
        """
        connection = self._connections.get(chunk.connection)
        if connection is None:
            connection = _Connection(chunk.connection, self._methods, self._calls, self._streams)
            self._connections[chunk.connection] = connection
        at = round(chunk.at, 6)
        lines: list[Line] = []
        for one in connection.read(chunk.end, chunk.data) if chunk.data else connection.over(chunk.end):
            if isinstance(one, Steered):
                known, reset = self._steering.steered(one, at)
                lines += known
                for each in self._connections.values() if reset else ():
                    each.forget()
            else:
                lines += self._steering.line({**one, "at": at})
        if connection.is_over:
            del self._connections[chunk.connection]
        return lines


class _Connection:
    """What is said on one connection."""

    def __init__(
        self, name: Connection, methods: dict[bytes, Method], calls: Iterator[int], streams: Iterator[int]
    ) -> None:
        self._name = name
        self._methods = methods
        self._numbers = calls
        self._streams = streams
        self._directions = {end: Direction(preface=end is End.CLIENT) for end in End}
        self._readable = set(End)
        self._there = set(End)
        self._asked = 0
        self._heard = False
        self._calls: dict[int, Call] = {}
        self._steers: dict[int, Steers] = {}
        self._beginning: list[Call] = []

    @property
    def is_over(self) -> bool:
        """Whether neither end sends any more."""
        return not self._there

    def forget(self) -> None:
        """Pass over what is under way: the robot was reset."""
        self._calls.clear()
        self._beginning.clear()

    def read(self, end: End, data: bytes) -> Iterator[Line | Steered]:
        """The lines that these bytes from one end make, and what they say of the control service."""
        if end not in self._readable:
            return
        try:
            for event in self._directions[end].read(data):
                yield from self._asks(event) if end is End.CLIENT else self._answers(event)
        except UnreadableHttp2Error:
            # A client that sends what is no HTTP/2 is refused; if calls go on all the same, `_headers` finds out.
            self._readable.discard(end)
            if end is End.ROBOT and self._heard:
                raise UnreadableError("the robot sends what cannot be read") from None
        for call in self._beginning:
            yield from self._begun(call)
        self._beginning.clear()

    def over(self, end: End) -> Iterator[Line | Steered]:
        """One end is gone: the client from its streams, or the robot from all that was asked."""
        self._there.discard(end)
        for stream in tuple(self._steers):
            yield from self._has_steered(stream, lost=True)
        for stream in tuple(self._calls):
            if end is End.CLIENT:
                yield from self._gone(stream)
            else:
                yield from self._ended(stream, "UNAVAILABLE", "the robot is gone")

    # The client's end.

    def _asks(self, event: Event) -> Iterator[Line | Steered]:
        match event:
            case TableSize(size):
                self._directions[End.ROBOT].allow_table(size)
            case Headers(stream, fields):
                self._asked = max(self._asked, stream)
                method = self._methods.get(fields.get(b":path", b""))
                if method is not None and stream not in self._calls:
                    self._calls[stream] = Call(method, Messages(fields.get(b"grpc-encoding", b"identity")))
                steers = PATHS.get(fields.get(b":path", b""))
                if steers is not None:
                    sent = Messages(fields.get(b"grpc-encoding", b"identity"))
                    self._steers[stream] = Steers((self._name, stream), steers, sent)
            case Data(stream, data) if stream in self._calls:
                call = self._calls[stream]
                for message in call.sent.read(data):
                    if not call.number:
                        call.number = next(self._numbers)
                        params = _json(call.method.request, message)
                        yield {"call": call.number, "method": call.method.name, "params": params}
            case Data(stream, data) if stream in self._steers:
                steered = self._steers[stream]
                for message in steered.sent.read(data):
                    steered.params = struct(message)
                    yield Steered(steered.call, steered.name, steered.params)
            case Reset(stream):
                yield from self._gone(stream)
                yield from self._has_steered(stream, lost=True)

    def _has_steered(self, stream: int, *, refused: bool = False, lost: bool = False) -> Iterator[Steered]:
        """A call of the control service is over, if it is one."""
        one = self._steers.pop(stream, None)
        if one is not None:
            result = None if refused else one.result
            yield Steered(one.call, one.name, one.params, result, ended=True, lost=lost)

    def _gone(self, stream: int) -> Iterator[Line]:
        """The client gives up: a stream is cancelled, a call stays without an answer."""
        call = self._calls.pop(stream, None)
        if call is not None and call.stream:
            number = next(self._numbers)
            yield {"call": number, "method": "cancel", "params": {"stream": call.stream}}
            yield {"return": number, "result": {}}

    # The robot's end.

    def _answers(self, event: Event) -> Iterator[Line | Steered]:
        self._heard = True
        match event:
            case TableSize(size):
                self._directions[End.CLIENT].allow_table(size)
            case Headers(stream, fields, ends):
                yield from self._headers(stream, fields, ends=ends)
            case Data(stream, data, ends) if stream in self._calls:
                call = self._calls[stream]
                for message in call.answered.read(data):
                    yield from self._message(call, _json(call.method.response, message))
                if ends:  # without trailers, which only what does not speak gRPC does
                    yield from self._ended(stream, STATUS_OF_HTTP.get(call.http, "UNKNOWN"), "", made=True)
            case Data(stream, data) if stream in self._steers:
                steered = self._steers[stream]
                for message in steered.answered.read(data):
                    steered.result = struct(message)
            case Reset(stream, code):
                yield from self._has_steered(stream, lost=True)
                yield from self._ended(stream, STATUS_OF_RESET.get(code, "INTERNAL"), "", made=True)

    def _headers(self, stream: int, fields: dict[bytes, bytes], *, ends: bool) -> Iterator[Line | Steered]:
        steered = self._steers.get(stream)
        if steered is not None:
            if ends:
                said = fields.get(b"grpc-status", b"")
                refused = STATUSES.get(said) in REFUSED
                yield from self._has_steered(stream, refused=refused, lost=not refused and said != b"0")
            else:
                steered.answered.encoding = fields.get(b"grpc-encoding", b"identity")
            return
        if stream > self._asked and End.CLIENT not in self._readable:
            raise UnreadableError("a call is answered that could not be read")
        call = self._calls.get(stream)
        if call is None:
            return
        call.http = fields.get(b":status", call.http)
        if ends:
            status = fields.get(b"grpc-status")
            if status is None:
                yield from self._ended(stream, STATUS_OF_HTTP.get(call.http, "UNKNOWN"), "", made=True)
            else:
                message = unquote_to_bytes(fields.get(b"grpc-message", b"")).decode(errors="replace")
                yield from self._ended(stream, STATUSES.get(status, "UNKNOWN"), message)
        else:
            call.answered.encoding = fields.get(b"grpc-encoding", b"identity")
            if call.method.streams and call.number:
                self._beginning.append(call)  # if it is not refused with the same bytes

    def _begun(self, call: Call) -> Iterator[Line]:
        if not call.stream and not call.refused:
            call.stream = next(self._streams)
            yield {"return": call.number, "result": {"stream": call.stream}}

    def _message(self, call: Call, message: JSON) -> Iterator[Line]:
        if not call.number:
            return
        if call.method.streams:
            yield from self._begun(call)
            yield {"stream": call.stream, "message": message}
        elif call.result is None:
            call.result = message

    def _ended(self, stream: int, status: str, message: str, *, made: bool = False) -> Iterator[Line]:
        """Note the end of a call.

        Args:
            stream: its HTTP/2 stream.
            status, message: its status.
            made: whether the client made the status itself, since the robot sent none.
        """
        call = self._calls.pop(stream, None)
        if call is None or not call.number:
            return
        error = {} if status == "OK" else {"error": {"status": status, "message": message}}
        if call.stream or (call.method.streams and not error):
            yield from self._begun(call)
            yield {"stream": call.stream, "closed": True, **error}
        elif error:
            call.refused = True
            if not made or status in LEAVE_OPEN:
                yield {"return": call.number, **error}
        elif call.result is not None:
            yield {"return": call.number, "result": call.result}


def _json(name: str, message: bytes | str) -> JSON:
    """The protobuf JSON of a message; for bytes that are no message, a text that says so."""
    try:
        if isinstance(message, str):
            raise NotOnTheWireError(message)
        return decode(name, message)
    except NotOnTheWireError as error:
        return f"(malformed: {error})"
