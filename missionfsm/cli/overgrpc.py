"""What the commands that speak gRPC share: the extra, worlds and tokens in files, a server as subject."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionfsm.cli.common import BAD_INPUT, complain, stop
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.subject import Subject

TokenFile = Annotated[
    str | None, typer.Option("--token", metavar="FILE", help="A file that holds the token callers have to send.")
]


def needs_grpc() -> None:
    """End with one line where the extra is not installed."""
    from importlib.util import find_spec  # noqa: PLC0415 - commands load what they need

    if find_spec("grpc") is None or find_spec("grpc_reflection") is None:
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
        token = Path(path).read_text().strip()
    except (OSError, UnicodeDecodeError) as error:
        stop(f"{path}: {getattr(error, 'strerror', None) or 'it is no text'}", BAD_INPUT)
    if not token or not token.isascii() or not token.isprintable():
        stop(f"{path}: it holds no token of printable ASCII", BAD_INPUT)
    return token


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
        "--settle", metavar="SECONDS", min=0.001, max=3600, help="With --grpc: silence after which all has been seen."
    ),
]
Force = Annotated[bool, typer.Option("--force", help="With --grpc: a reset may end and clear missions of others.")]
TlsFile = Annotated[
    str | None,
    typer.Option("--tls", metavar="FILE", help="With --grpc: TLS, with that authority in PEM, or `system`."),
]
DRIVEN_SETTLE_SECONDS, SETTLE_SECONDS = 0.02, 0.2
"""Silence that is waited for where nothing else is said: of a server with the control service, and of any other."""


def over_grpc(  # noqa: PLR0913 - options of the command
    system: str,
    address: str,
    *,
    world: str | None,
    settle: float | None,
    force: bool,
    token: str | None,
    tls: str | None,
    timeout: float,
) -> Subject:
    """The server at an address as a subject; bad input ends the command. Raises SubjectError if nobody answers."""
    needs_grpc()
    from missionfsm.adapters.grpc.client import GrpcSubject, Target  # noqa: PLC0415 - an extra
    from missionfsm.adapters.grpc.descriptors import SERVICES  # noqa: PLC0415

    if system not in SERVICES:
        stop(f"--grpc: {' and '.join(SERVICES)} are judged so, not {system}", BAD_INPUT)
    host, colon, port = address.rpartition(":")
    if not colon or not host or not port.isdecimal() or not 0 < int(port) <= 65535:
        stop(f"--grpc {address}: expected HOST:PORT, such as localhost:50051", BAD_INPUT)
    target = Target(address, read_token(token), certificate=tls or "", timeout=timeout, settle=settle or SETTLE_SECONDS)
    subject = GrpcSubject(system, target, read_world(world), force=force, tell=complain)
    if settle is None and subject.driven:
        subject.settle_within(DRIVEN_SETTLE_SECONDS)
    return subject
