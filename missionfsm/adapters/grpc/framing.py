"""The messages in one direction of a gRPC call, out of bytes that come as they like."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

from attrs import Factory, define

from missionfsm.kernel.codec import UnreadableError

MAX_MESSAGE_BYTES = 64 * 1024 * 1024
"""A longer message is not read; servers of gRPC take 4 MB unless told otherwise."""
PREFIX_BYTES = 5
"""Before every message: whether it is compressed, and its length."""
WINDOW_BITS = {b"gzip": 16 + zlib.MAX_WBITS, b"deflate": zlib.MAX_WBITS}
"""The encodings that gRPC has, but for ``identity``, as zlib names them."""


@define
class Messages:
    """The messages in one direction of a call, whose bytes may come in any pieces.

    Attributes:
        encoding: how the messages are encoded that are marked as encoded.
    """

    encoding: bytes = b"identity"
    _buffer: bytearray = Factory(bytearray)
    _passed_over: int = 0

    def read(self, data: bytes) -> Iterator[bytes | str]:
        """The messages that are whole with these bytes; of one that cannot be read a text that says why.

        Raises:
            UnreadableError: a message in an encoding that gRPC does not have by itself.
        """
        skipped = min(self._passed_over, len(data))
        self._passed_over -= skipped
        self._buffer += data[skipped:]
        while len(self._buffer) >= PREFIX_BYTES:
            encoded, length = self._buffer[0], int.from_bytes(self._buffer[1:PREFIX_BYTES], "big")
            if length > MAX_MESSAGE_BYTES:
                self._passed_over = max(0, PREFIX_BYTES + length - len(self._buffer))
                del self._buffer[: PREFIX_BYTES + length]
                yield f"longer than {MAX_MESSAGE_BYTES:,} bytes"
                continue
            if len(self._buffer) < PREFIX_BYTES + length:
                return
            message = bytes(self._buffer[PREFIX_BYTES : PREFIX_BYTES + length])
            del self._buffer[: PREFIX_BYTES + length]
            yield self._decoded(message) if encoded else message

    def _decoded(self, message: bytes) -> bytes | str:
        if self.encoding not in WINDOW_BITS:
            raise UnreadableError(
                f"a message is encoded as {self.encoding.decode(errors='replace')}, which is not read"
            )
        reader = zlib.decompressobj(WINDOW_BITS[self.encoding])
        try:
            data = reader.decompress(message, MAX_MESSAGE_BYTES)
        except zlib.error:
            return f"no {self.encoding.decode()}"
        if reader.unconsumed_tail:
            return f"longer than {MAX_MESSAGE_BYTES:,} bytes"
        return data if reader.eof else f"no {self.encoding.decode()}"


__all__ = ["MAX_MESSAGE_BYTES", "Messages"]
