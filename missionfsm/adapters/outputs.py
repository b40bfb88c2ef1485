"""Where what was found is written: to files, whole or not at all, and to stdout.

What is no plain file (a device, a pipe, a terminal) is written to as it stands; links are followed.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import sys
from collections.abc import Iterator
from pathlib import Path

import orjson

from missionfsm.kernel.codec import JSON, UnreadableError

STDOUT = "-"
_NO_STDOUT = "stdout is closed"


def write_history(path: str, history: tuple[JSON, ...]) -> None:
    """Write the lines of a history to a file, whole or not at all."""
    write_whole(path, b"".join(orjson.dumps(line) + b"\n" for line in history))


def write_whole(path: str, data: bytes) -> None:
    """Write a file whole or not at all; ``-`` is stdout. Raises UnreadableError if that is not possible."""
    if path == STDOUT or _is_stdout(path):
        with to_stdout():
            sys.stdout.buffer.write(data)
        return
    with naming(path):
        found = _found(path)
        if found is None or stat.S_ISREG(found.st_mode):
            _replace(Path(os.path.realpath(path)), data, found)
        else:
            Path(path).write_bytes(data)


def refuse_unwritable(path: str) -> None:
    """Raises UnreadableError if nothing can be written there, whatever it is; nothing is touched."""
    if path == STDOUT:
        if sys.stdout is None:
            raise UnreadableError(_NO_STDOUT)
        return
    with naming(path):
        found = _found(path)
        target = path
        if found is None or stat.S_ISREG(found.st_mode):  # it is the folder that is written to
            target = str(Path(os.path.realpath(path)).parent)
            found = Path(target).stat()
            if not stat.S_ISDIR(found.st_mode):
                raise OSError(errno.ENOTDIR, os.strerror(errno.ENOTDIR))
        elif stat.S_ISDIR(found.st_mode):
            raise OSError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not os.access(target, os.W_OK):
            raise OSError(errno.EACCES, os.strerror(errno.EACCES))


def same_file(one: str, other: str) -> bool:
    """Whether two names stand for one file, which the second to be written would destroy; devices and pipes do not."""
    if STDOUT in (one, other):
        return False
    try:
        status = Path(one).stat()
        return stat.S_ISREG(status.st_mode) and os.path.samestat(status, Path(other).stat())
    except OSError:
        return os.path.realpath(one) == os.path.realpath(other)


@contextlib.contextmanager
def to_stdout() -> Iterator[None]:
    """What is written to stdout meanwhile is on its way at the end.

    Whoever has stopped reading has seen enough: nothing is said of it, and what follows goes nowhere. Raises
    UnreadableError if it cannot be written to.
    """
    if sys.stdout is None:
        raise UnreadableError(_NO_STDOUT)
    try:
        sys.stdout.flush()
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        silence_stdout()
    except OSError as error:
        silence_stdout()
        raise UnreadableError(f"stdout: {error.strerror or error}") from None


def silence_stdout() -> None:
    """Discard what is still to be written to stdout, which would fail as well, even when the interpreter ends."""
    with contextlib.suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def _is_stdout(path: str) -> bool:
    """Whether it is a name of what stdout goes to, as /dev/stdout is: there is one place in it to write at."""
    try:
        return os.path.samestat(os.fstat(sys.stdout.fileno()), Path(path).stat())
    except (OSError, ValueError, AttributeError):  # there is no such file, or stdout is closed or none of the system's
        return False


def _found(path: str) -> os.stat_result | None:
    """What is there; None if it can be made."""
    if not path:
        raise OSError(errno.ENOENT, "an empty name is no name of a file")
    try:
        return Path(path).stat()
    except FileNotFoundError:
        if path.endswith(os.sep):
            raise OSError(errno.EISDIR, os.strerror(errno.EISDIR)) from None
        return None


def _replace(target: Path, data: bytes, found: os.stat_result | None) -> None:
    """Write a file beside it, which then takes its place and its mode."""
    part = target.with_name(f".{os.urandom(8).hex()}.part")
    try:
        with part.open("xb") as file:
            if found is not None:
                os.fchmod(file.fileno(), stat.S_IMODE(found.st_mode))
            file.write(data)
        part.replace(target)
    finally:
        with contextlib.suppress(OSError):
            part.unlink()


@contextlib.contextmanager
def naming(path: str) -> Iterator[None]:
    """Within it an OSError becomes an UnreadableError that names the file."""
    try:
        yield
    except OSError as error:
        raise UnreadableError(f"{path or repr(path)}: {error.strerror or error}") from None
