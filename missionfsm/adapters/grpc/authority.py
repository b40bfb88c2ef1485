"""The name under which a server is asked, put into a client's bytes on their way."""

from __future__ import annotations

from hpack import Decoder, Encoder, HeaderTuple, HPACKError
from hyperframe.exceptions import HyperframeError
from hyperframe.frame import ContinuationFrame, Frame, HeadersFrame

from missionfsm.adapters.grpc.http2 import HEAD_BYTES, MAX_HEADER_BYTES, PREFACE, frames

FRAME_BYTES = 16_384
"""Every server takes frames of so many bytes."""
KEY = b":authority"


class Renamed:
    """The bytes that a client sends, with another ``:authority`` in every call; all else is as it was.

    Headers are encoded anew without the table that both ends keep, which no server can forbid.
    """

    def __init__(self, authority: str) -> None:
        self._authority = authority.encode()
        self._preface = len(PREFACE)
        self._buffer = bytearray()
        self._decoder = Decoder(MAX_HEADER_BYTES)
        self._decoder.max_allowed_table_size = MAX_HEADER_BYTES
        self._encoder = Encoder()
        self._encoder.header_table_size = 0
        self._headers: HeadersFrame | None = None
        self._block = bytearray()

    def __call__(self, data: bytes) -> bytes:
        """What goes out for these bytes; what is not whole yet goes out later.

        Raises:
            ValueError: this is no HTTP/2.
        """
        out = bytearray(data[: self._preface])
        self._buffer += data[self._preface :]
        self._preface -= len(out)
        try:
            for frame, whole in frames(self._buffer):
                out += self._passed(frame, whole)
        except (HyperframeError, HPACKError) as error:
            raise ValueError(str(error)) from None
        return bytes(out)

    def _passed(self, frame: Frame, whole: bytes) -> bytes:
        if not isinstance(frame, HeadersFrame | ContinuationFrame):
            return whole
        frame.parse_body(memoryview(whole)[HEAD_BYTES:])
        if isinstance(frame, HeadersFrame):
            self._headers = frame
        self._block += frame.data
        if len(self._block) > MAX_HEADER_BYTES or self._headers is None:
            raise ValueError("no HTTP/2")
        if "END_HEADERS" not in frame.flags:
            return b""
        fields = self._decoder.decode(bytes(self._block), raw=True)
        block = self._encoder.encode([HeaderTuple(KEY, self._authority) if one[0] == KEY else one for one in fields])
        out = bytearray()
        for at in range(0, len(block), FRAME_BYTES):
            kind = ContinuationFrame if at else HeadersFrame
            part = kind(self._headers.stream_id, block[at : at + FRAME_BYTES])
            if not at and "END_STREAM" in self._headers.flags:
                part.flags.add("END_STREAM")
            if at + FRAME_BYTES >= len(block):
                part.flags.add("END_HEADERS")
            out += part.serialize()
        self._block.clear()
        self._headers = None
        return bytes(out)
