"""HTTP/2 as somebody reads it who stands beside a connection: the bytes of one direction in, what gRPC needs out.

Nothing is answered and nothing is enforced that the two ends enforce themselves. What cannot be read is no HTTP/2, and
the end that it was sent to will say so as well.
"""

from __future__ import annotations

from collections.abc import Iterator

from attrs import frozen
from hpack import Decoder, HPACKError
from hyperframe.exceptions import HyperframeError
from hyperframe.frame import (
    ContinuationFrame,
    DataFrame,
    Frame,
    HeadersFrame,
    PushPromiseFrame,
    RstStreamFrame,
    SettingsFrame,
)

PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
"""What a client sends first."""
HEAD_BYTES = 9
"""The length of a frame's head."""
MAX_HEADER_BYTES = 1024 * 1024
"""Metadata of one call; gRPC allows some kilobytes unless told otherwise."""


class UnreadableHttp2Error(Exception):
    """Bytes that are no HTTP/2."""


@frozen
class Headers:
    """Headers or trailers of a stream.

    Attributes:
        fields: the last value of each name.
        ends: whether the stream ends with them, in this direction.
    """

    stream: int
    fields: dict[bytes, bytes]
    ends: bool


@frozen
class Data:
    """Bytes of a stream's body."""

    stream: int
    data: bytes
    ends: bool


@frozen
class Reset:
    """A stream is ended at once, in both directions."""

    stream: int
    code: int


@frozen
class TableSize:
    """How large a table of headers the sender of this allows the other end, in bytes."""

    size: int


Event = Headers | Data | Reset | TableSize


def frames(buffer: bytearray) -> Iterator[tuple[Frame, bytes]]:
    """Takes the whole frames that a buffer begins with off it: the head as a frame without its body, and all bytes.

    Raises:
        HyperframeError: a frame that cannot be.
    """
    while len(buffer) >= HEAD_BYTES:
        frame, length = Frame.parse_frame_header(memoryview(bytes(buffer[:HEAD_BYTES])))
        if len(buffer) < HEAD_BYTES + length:
            return
        whole = bytes(buffer[: HEAD_BYTES + length])
        del buffer[: HEAD_BYTES + length]
        yield frame, whole


class Direction:
    """What one end of a connection sends.

    Args:
        preface: whether it begins with a client's preface.
    """

    def __init__(self, *, preface: bool) -> None:
        self._preface = preface
        self._buffer = bytearray()
        self._decoder = Decoder(MAX_HEADER_BYTES)
        self._block = bytearray()
        self._headers: HeadersFrame | None = None

    def allow_table(self, size: int) -> None:
        """The other end allows a table of headers of so many bytes; a smaller one is never wrong."""
        self._decoder.max_allowed_table_size = max(size, self._decoder.max_allowed_table_size)

    def read(self, data: bytes) -> Iterator[Event]:
        """What is complete with these bytes.

        Raises:
            UnreadableHttp2Error: this is no HTTP/2; nothing that follows can be read either.
        """
        self._buffer += data
        if self._preface:
            if not PREFACE.startswith(self._buffer[: len(PREFACE)]):
                raise UnreadableHttp2Error
            if len(self._buffer) < len(PREFACE):
                return
            del self._buffer[: len(PREFACE)]
            self._preface = False
        try:
            for frame, whole in frames(self._buffer):
                yield from self._read(frame, whole)
        except (HyperframeError, HPACKError) as error:
            raise UnreadableHttp2Error from error

    def _read(self, frame: Frame, whole: bytes) -> Iterator[Event]:
        if (self._headers is None) == isinstance(frame, ContinuationFrame) or isinstance(frame, PushPromiseFrame):
            raise UnreadableHttp2Error
        if not isinstance(frame, HeadersFrame | ContinuationFrame | DataFrame | RstStreamFrame | SettingsFrame):
            return
        frame.parse_body(memoryview(whole)[HEAD_BYTES:])
        if isinstance(frame, DataFrame):
            yield Data(frame.stream_id, frame.data, "END_STREAM" in frame.flags)
        elif isinstance(frame, RstStreamFrame):
            yield Reset(frame.stream_id, frame.error_code)
        elif isinstance(frame, SettingsFrame):
            if SettingsFrame.HEADER_TABLE_SIZE in frame.settings:
                yield TableSize(frame.settings[SettingsFrame.HEADER_TABLE_SIZE])
        else:
            yield from self._headers_read(frame)

    def _headers_read(self, frame: HeadersFrame | ContinuationFrame) -> Iterator[Headers]:
        if isinstance(frame, HeadersFrame):
            self._headers = frame
        self._block += frame.data
        if len(self._block) > MAX_HEADER_BYTES:
            raise UnreadableHttp2Error
        if "END_HEADERS" in frame.flags:
            assert self._headers is not None  # noqa: S101 - `_read` has looked
            fields = {bytes(name): bytes(value) for name, value in self._decoder.decode(bytes(self._block), raw=True)}
            yield Headers(self._headers.stream_id, fields, "END_STREAM" in self._headers.flags)
            self._block.clear()
            self._headers = None
