"""What the commands that speak gRPC share: the extra, worlds and tokens in files, a server as subject."""

from __future__ import annotations

import contextlib
import enum
import functools
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from attrs import evolve, frozen

from missionfsm.cli.common import BAD_INPUT, complain, stop
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.system import System

if TYPE_CHECKING:
    from missionfsm.kernel.subject import Subject

TokenFile = Annotated[
    str | None, typer.Option("--token", metavar="FILE", help="A file that holds the token callers have to send.")
]
Certificate = Annotated[str, typer.Option(metavar="FILE", help="For TLS at the own port, in PEM.")]
Key = Annotated[str, typer.Option(metavar="FILE", help="For TLS at the own port, in PEM.")]
SystemArgument = Annotated[str, typer.Argument(metavar="SYSTEM", help="bear.mission or bear.status.")]


def needs_grpc() -> None:
    """End with one line where the extra is not installed."""
    from importlib.util import find_spec  # noqa: PLC0415 - commands load what they need

    if any(find_spec(name) is None for name in ("grpc", "grpc_reflection", "hpack")):
        stop("this needs gRPC, which is an extra: pip install 'missionfsm[grpc]'", BAD_INPUT)


def read_world(path: str | None) -> JSON:
    """The world in a file, as JSON; an empty one without a file. Bad input ends the command."""
    from missionfsm.adapters.historyfile import read_whole  # noqa: PLC0415 - commands load what they need
    from missionfsm.adapters.jsonlines import loads  # noqa: PLC0415

    if path is None:
        return {}
    try:
        return loads(read_whole(path))
    except UnreadableError as error:
        stop(str(error) if path in str(error) else f"{path}: {error}", BAD_INPUT)


def read_token(path: str | None) -> str:
    """The token in a file, without the white space around it; bad input if it holds none."""
    if path is None:
        return ""
    try:
        return _token(path)
    except ValueError as error:
        stop(str(error), BAD_INPUT)


def _token(path: str) -> str:
    """The token in a file. Raises ValueError, which says what is wrong with the file."""
    try:
        token = Path(path).read_text().strip()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: {getattr(error, 'strerror', None) or 'it is no text'}") from None
    if not token or not token.isascii() or not token.isprintable():
        raise ValueError(f"{path}: it holds no token of printable ASCII")
    return token


def _token_again(path: str) -> str:
    """The token in a file that may have been renewed. Raises SubjectError: the implementation cannot be asked more."""
    from missionfsm.kernel.subject import SubjectError  # noqa: PLC0415 - commands load what they need

    try:
        return _token(path)
    except ValueError as error:
        raise SubjectError(str(error)) from None


@contextlib.contextmanager
def bad_input() -> Iterator[None]:
    """What a user asked that cannot be ends in one line."""
    try:
        yield
    except OSError as error:
        named = f"{error.filename}: " if error.filename else ""
        stop(f"{named}{error.strerror or error}", BAD_INPUT)
    except ValueError as error:  # UnreadableError is one
        stop(str(error), BAD_INPUT)


def both_or_neither(certificate: str, key: str) -> None:
    """Refuse a certificate without its key, and a key without its certificate."""
    if bool(certificate) != bool(key):
        stop("--tls-certificate and --tls-key: one does not go without the other", BAD_INPUT)


GrpcAddress = Annotated[
    str | None, typer.Option("--grpc", metavar="HOST:PORT", help="Judge the gRPC server there, with no adapter.")
]
WorldFile = Annotated[
    str | None,
    typer.Option("--world", metavar="FILE", help="With --grpc: the robot's world as JSON, which cannot be changed."),
]
SettleSeconds = Annotated[
    float | None,
    typer.Option(
        "--settle",
        metavar="SECONDS",
        min=0.001,
        max=3600,
        help="With --grpc: silence after which all has been seen (0.2).",
    ),
]
Force = Annotated[bool, typer.Option("--force", help="With --grpc: a reset may end and clear missions of others.")]
TlsFile = Annotated[
    str | None,
    typer.Option("--tls", metavar="FILE", help="With --grpc: TLS, with that authority in PEM, or `system`."),
]
MetadataEntries = Annotated[
    list[str] | None,
    typer.Option("--metadata", metavar="KEY:VALUE", help="With --grpc: sent with every call; repeat it."),
]
KeepaliveSeconds = Annotated[
    float | None,
    typer.Option(
        "--keepalive",
        metavar="SECONDS",
        min=1,
        max=86_400,
        help="With --grpc: silence after which a connection is asked whether it is alive, if the server permits it.",
    ),
]


class Beginning(enum.Enum):
    """With what a log, or a conversation, begins."""

    FRESH = "fresh"
    ANYWHERE = "anywhere"


COUNTED_SETTLE_SECONDS, SETTLE_SECONDS = 0.02, 0.2
"""Silence that is waited for where nothing else is said: of a server that counts its messages, and of any other."""


@frozen
class Wire:
    """How a gRPC server is judged, as the options of the command say it.

    Attributes:
        address: ``HOST:PORT``.
        begins: whether conversations begin with a robot that has no missions, or with whatever there is.
        others: whether others use the robot at the same time.
        strict: whether nothing is lost, doubled or made up on the way.
    """

    address: str
    world: str | None
    settle: float | None
    force: bool
    token: str | None
    tls: str | None
    metadata: list[str]
    keepalive: float | None
    begins: Beginning
    others: bool
    strict: bool

    @property
    def anywhere(self) -> bool:
        """Whether conversations begin with whatever there is."""
        return self.begins is Beginning.ANYWHERE

    def system(self, name: str, readings: Mapping[str, str]) -> System:
        """The system as a server of it is judged by some readings; bad input ends the command."""
        from missionfsm.app.asked import judged_system, refuse_json_only  # noqa: PLC0415 - commands load what they need

        try:
            found = judged_system(name, strict=self.strict, anywhere=self.anywhere, others=self.others)
        except UnreadableError as error:
            stop(f"--begins, --others: {error}", BAD_INPUT)
        with bad_input():
            refuse_json_only(found, readings)
        return found

    def subject(self, system: str, timeout: float) -> Subject:
        """The server as a subject; bad input ends the command. Raises SubjectError if nobody answers."""
        needs_grpc()
        from missionfsm.adapters.grpc.client import GrpcSubject, Use  # noqa: PLC0415 - an extra
        from missionfsm.adapters.grpc.descriptors import SERVICES  # noqa: PLC0415
        from missionfsm.adapters.grpc.target import Target  # noqa: PLC0415 - an extra

        if system not in SERVICES:
            stop(f"--grpc: {' and '.join(SERVICES)} are judged so, not {system}", BAD_INPUT)
        target = Target(
            target_address(self.address),
            read_token(self.token),
            metadata=read_metadata(self.metadata),
            certificate=self.tls or "",
            timeout=timeout,
            settle=self.settle or SETTLE_SECONDS,
        )
        if self.keepalive is not None:
            target = evolve(target, keepalive=self.keepalive)
        subject = GrpcSubject(
            system,
            target,
            read_world(self.world),
            use=Use(self.force, self.others, self.anywhere),
            renewed=None if self.token is None else functools.partial(_token_again, self.token),
            tell=complain,
        )
        if self.settle is None and subject.counts:
            subject.settle_within(COUNTED_SETTLE_SECONDS)
        return subject


def target_address(text: str) -> str:
    """``HOST:PORT``; anything else ends the command."""
    host, colon, port = text.rpartition(":")
    if not colon or not host or not port.isdecimal() or not 0 < int(port) <= 65535:
        stop(f"--grpc {text}: expected HOST:PORT, such as localhost:50051", BAD_INPUT)
    return text


def read_metadata(entries: list[str]) -> tuple[tuple[str, str], ...]:
    """Metadata from ``KEY:VALUE``; bad input for what gRPC does not send."""
    found = []
    for entry in entries:
        key, colon, value = entry.partition(":")
        key, value = key.strip().lower(), value.strip()
        wrong = not colon or not _KEY.fullmatch(key) or not (value.isascii() and value.isprintable())
        if wrong or key.endswith("-bin") or key.startswith("grpc-"):
            stop(f"--metadata {entry}: expected KEY:VALUE in printable ASCII, such as x-site:lab-2", BAD_INPUT)
        found.append((key, value))
    return tuple(found)


_KEY = re.compile("[a-z0-9_.-]+")
