"""Files as people record them: compressed with gzip or Zstandard, with a byte order mark; read as they come.

What a file is, its first bytes tell, not its name: a pipe has none. What is read is never held.
"""

from __future__ import annotations

import gzip
import io
import zlib
from typing import IO, Any, Protocol

from missionfsm.kernel.codec import UnreadableError

_GZIP, _ZSTD = b"\x1f\x8b", b"\x28\xb5\x2f\xfd"
_UTF_8, _UTF_16 = b"\xef\xbb\xbf", (b"\xff\xfe", b"\xfe\xff")
_OTHERS = {b"BZh": "bzip2", b"\xfd7zX": "xz", b"PK\x03\x04": "ZIP", b"\x04\x22\x4d\x18": "LZ4"}
"""The first bytes of compressed files that nothing here reads, and what they are."""
_LONGEST_MARK = 4
"""Bytes of the longest of these marks."""
_FED = 1 << 10
"""Compressed bytes that are taken at a time; they may stand for thirty thousand times as many."""


class Readable(Protocol):
    """What bytes are read from."""

    def read(self, size: int = -1, /) -> bytes:
        """So many bytes at most; none where there are no more."""

    def close(self) -> None:
        """Read no more."""


class _Ahead(io.RawIOBase):
    """A source whose first bytes were looked at, and are read all the same."""

    def __init__(self, source: Readable, *, stays_open: bool = False) -> None:
        self._stays_open = stays_open
        self._read = getattr(source, "read1", source.read)
        self._source = source
        self.ahead = b""
        while len(self.ahead) < _LONGEST_MARK and (more := self._read(_LONGEST_MARK - len(self.ahead))):
            self.ahead += more

    def readable(self) -> bool:
        """It is."""
        return True

    def readinto(self, into: Any) -> int:  # noqa: ANN401 - a buffer, which has no name before Python 3.12
        """Read what is there, without waiting for more."""
        size = len(memoryview(into))
        found = self.ahead[:size] or self._read(size)
        self.ahead = self.ahead[size:]
        into[: len(found)] = found
        return len(found)

    def close(self) -> None:
        """Close the source as well, unless it is to stay open."""
        if not (self.closed or self._stays_open):
            self._source.close()
        super().close()


class _Zstandard(io.RawIOBase):
    """What frames of Zstandard stand for; one that is cut short is noticed."""

    def __init__(self, source: _Ahead) -> None:
        try:
            import zstandard  # noqa: PLC0415 - an extra, needed by nothing else
        except ImportError:
            message = "it is compressed with Zstandard: install missionfsm[zst] to read it"
            raise UnreadableError(message) from None
        self._source = source
        self._frames = zstandard.ZstdDecompressor()
        self._error = zstandard.ZstdError
        self._frame: Any = None
        self._left = b""

    def readable(self) -> bool:
        """It is."""
        return True

    def readinto(self, into: Any) -> int:  # noqa: ANN401 - a buffer, which has no name before Python 3.12
        """Read what is there, without waiting for more."""
        size = len(memoryview(into))
        while not self._left and self._feed():
            pass
        found, self._left = self._left[:size], self._left[size:]
        into[: len(found)] = found
        return len(found)

    def _feed(self) -> bool:
        """Take in more; whether there was any."""
        unused = b"" if self._frame is None or not self._frame.eof else self._frame.unused_data
        given = unused or self._source.read(_FED) or b""
        if self._frame is None or (self._frame.eof and given):
            self._frame = self._frames.decompressobj()
        try:
            self._left = self._frame.decompress(given) if given else b""
        except self._error as error:
            raise OSError(str(error)) from None
        if not given and not self._frame.eof:
            raise EOFError
        return bool(given)

    def close(self) -> None:
        """Close the source as well."""
        if not self.closed:
            self._source.close()
        super().close()


def decompressed(source: Readable, *, stays_open: bool = False) -> IO[bytes]:
    """What a source stands for, without its compression and its byte order mark.

    The source is closed with what is returned, unless it is to stay open.

    Raises:
        UnreadableError: nothing here can read it.
        OSError, EOFError, zlib.error: as `DAMAGED`; reading what is returned raises them as well.
    """
    found = _Ahead(source, stays_open=stays_open)
    if found.ahead.startswith(_GZIP):
        found = _Ahead(gzip.GzipFile(fileobj=found))
    elif found.ahead.startswith(_ZSTD):
        found = _Ahead(_Zstandard(found))
    if found.ahead.startswith(_UTF_16):
        message = "it is UTF-16; what is read here is UTF-8"
        raise UnreadableError(message)
    for mark, name in _OTHERS.items():
        if found.ahead.startswith(mark):
            message = f"it is compressed ({name}); what is read here is plain, gzip or Zstandard"
            raise UnreadableError(message)
    found.ahead = found.ahead.removeprefix(_UTF_8)
    return io.BufferedReader(found)


DAMAGED = (OSError, EOFError, zlib.error)
"""What reading raises where the data are damaged or cut short."""
