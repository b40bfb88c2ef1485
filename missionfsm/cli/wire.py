"""`missionfsm serve` and `missionfsm proxy`: the Bear API over gRPC.

Plain functions for typer; what takes long to import, and what the extra ``grpc`` brings, is imported inside them.
"""

import contextlib
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import orjson
import typer

from missionfsm.cli.common import (
    BAD_INPUT,
    DONE,
    FAILED,
    Troubles,
    choice,
    complain,
    refuse_outputs,
    stop,
    the_system,
    write_json,
)
from missionfsm.cli.judging import Readings
from missionfsm.cli.overgrpc import Beginning, TokenFile, needs_grpc, read_token, read_world, target_address
from missionfsm.cli.printing import JsonFile
from missionfsm.kernel.codec import JSON, UnreadableError

if TYPE_CHECKING:
    from missionfsm.adapters.grpc.proxy import Proxy

Certificate = Annotated[str, typer.Option(metavar="FILE", help="For TLS at the own port, in PEM.")]
Key = Annotated[str, typer.Option(metavar="FILE", help="For TLS at the own port, in PEM.")]
SystemArgument = Annotated[str, typer.Argument(metavar="SYSTEM", help="bear.mission or bear.status.")]


@contextlib.contextmanager
def _bad_input() -> Iterator[None]:
    """What a user asked that cannot be ends in one line."""
    try:
        yield
    except OSError as error:
        named = f"{error.filename}: " if error.filename else ""
        stop(f"{named}{error.strerror or error}", BAD_INPUT)
    except ValueError as error:  # UnreadableError is one
        stop(str(error), BAD_INPUT)


def serve(  # noqa: PLR0913 - options of the command
    system: SystemArgument,
    grpc: Annotated[int, typer.Option("--grpc", metavar="PORT", min=0, max=65535, help="The port; 0 is any free one.")],
    host: Annotated[str, typer.Option(help="The address to listen on; 0.0.0.0 is all of them.")] = "127.0.0.1",
    world: Annotated[str | None, typer.Option(metavar="FILE", help="The world, as JSON; - is stdin.")] = None,
    reading: Readings = None,
    auto: Annotated[
        float | None, typer.Option(metavar="SECONDS", min=0.001, help="Every so often something happens by itself.")
    ] = None,
    script: Annotated[
        str | None, typer.Option(metavar="FILE", help='What happens first: {"after": S, "drive": {…}} a line.')
    ] = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME:NUMBER", help="deadline, unavailable, lost, doubled (0 to 1), ends (s); repeat it."),
    ] = None,
    broken: Annotated[
        str, typer.Option("--break", metavar="RULE", help="Break a rule on purpose: its id, or a name of `teeth`.")
    ] = "",
    seed: Annotated[int, typer.Option(help="The same seed, the same faults.")] = 0,
    control: Annotated[bool, typer.Option(help="The control service, by which tests set the scene.")] = True,
    record: Annotated[
        str | None, typer.Option(metavar="FILE", help="Write the history, a line at a time; check judges it.")
    ] = None,
    tls_certificate: Certificate = "",
    tls_key: Key = "",
    token: TokenFile = None,
) -> None:
    """Serve the reference as a real robot, or a fleet, to develop against, until interrupted."""
    needs_grpc()
    from missionfsm.adapters.historyfile import read_whole  # noqa: PLC0415 - commands load what they need
    from missionfsm.app.serve import Cue, read_script  # noqa: PLC0415
    from missionfsm.app.serve import serve as serving  # noqa: PLC0415

    served = the_system(system)
    _both_or_neither(tls_certificate, tls_key)
    refuse_outputs({"--record": record}, (world, script, token))
    the_world, the_token = read_world(world), read_token(token)
    cues: tuple[Cue, ...] = ()
    if script is not None:
        try:
            cues = read_script(read_whole(script).decode(), served)
        except UnicodeDecodeError:
            stop(f"{script}: it is not UTF-8", BAD_INPUT)
        except UnreadableError as error:
            stop(f"{script}: {error}", BAD_INPUT)
    with _bad_input(), contextlib.ExitStack() as stack:
        note = stack.enter_context(_noting(record))
        robot = stack.enter_context(
            serving(
                system,
                host=host,
                port=grpc,
                world=the_world,
                readings=choice(reading),
                auto=auto,
                script=cues,
                faults=fault or (),
                broken=broken,
                seed=seed,
                certificate=tls_certificate,
                key=tls_key,
                token=the_token,
                control=control,
                record=note,
            )
        )
        typer.echo(f"{system} listens on {robot.target}; Ctrl-C ends it")
        with contextlib.suppress(KeyboardInterrupt):
            threading.Event().wait()
    raise typer.Exit(DONE)


def _both_or_neither(certificate: str, key: str) -> None:
    if bool(certificate) != bool(key):
        stop("--tls-certificate and --tls-key: one does not go without the other", BAD_INPUT)


@contextlib.contextmanager
def _noting(record: str | None) -> Iterator[Callable[[JSON], None]]:
    """What writes a line of the history to the file, if there is one."""
    if record is None:
        yield lambda _: None
        return
    with Path(record).open("wb") as file:

        def note(line: JSON) -> None:
            with contextlib.suppress(OSError):  # a full disk does not end the robot
                file.write(orjson.dumps(line) + b"\n")
                file.flush()

        yield note


def proxy(  # noqa: PLR0913 - options of the command
    system: SystemArgument,
    grpc: Annotated[str, typer.Option("--grpc", metavar="HOST:PORT", help="The robot.")],
    listen: Annotated[int, typer.Option(metavar="PORT", min=0, max=65535, help="Where clients connect.")],
    host: Annotated[str, typer.Option(help="The address to listen on.")] = "127.0.0.1",
    record: Annotated[str | None, typer.Option(metavar="FILE", help="Write the history, as traffic goes.")] = None,
    world: Annotated[str | None, typer.Option(metavar="FILE", help="The robot's world, as JSON.")] = None,
    reading: Readings = None,
    tls: Annotated[
        str, typer.Option(metavar="FILE", help="The robot has TLS: its authority in PEM, or system for the machine's.")
    ] = "",
    tls_certificate: Certificate = "",
    tls_key: Key = "",
    begins: Annotated[
        Beginning, typer.Option(help="Whether the robot has done nothing yet, or is in use already.")
    ] = Beginning.FRESH,
    others: Annotated[
        bool, typer.Option("--others", help="Others, who do not go through the proxy, use the robot as well.")
    ] = False,
    json: JsonFile = None,
    html: Annotated[
        str | None, typer.Option(metavar="FILE", help="A page that says how it stands; it refreshes itself.")
    ] = None,
) -> None:
    """Stand between clients and a robot: pass everything on, record it, say what breaks as soon as it does.

    Traffic is never held up by a verdict, a full disk or a slow terminal. Exit status when interrupted: 0 if what was
    seen conforms, 1 if not.

    Example: missionfsm proxy bear.mission --grpc robot:50051 --listen 50052 --record day.jsonl
    """
    needs_grpc()
    import asyncio  # noqa: PLC0415 - commands load what they need

    from missionfsm.adapters.grpc.client import Target  # noqa: PLC0415
    from missionfsm.adapters.grpc.descriptors import SERVICES  # noqa: PLC0415
    from missionfsm.adapters.grpc.proxy import Proxy, read_line  # noqa: PLC0415
    from missionfsm.adapters.grpc.server import Security  # noqa: PLC0415
    from missionfsm.app.asked import judged_system  # noqa: PLC0415
    from missionfsm.app.recorder import Recorder  # noqa: PLC0415

    if system not in SERVICES:
        stop(f"{system}: there is a proxy for {' and '.join(SERVICES)}", BAD_INPUT)
    _both_or_neither(tls_certificate, tls_key)
    refuse_outputs({"--record": record, "--json": json, "--html": html}, (world,))
    head: dict[str, JSON] = {"missionfsm": 1, "system": system, "world": read_world(world), "drives": []}
    if begins is Beginning.ANYWHERE:
        head["begins"] = begins.value
    if others:
        head["others"] = True
    with _bad_input():
        judged_system(system, strict=False, anywhere=begins is Beginning.ANYWHERE, others=others)
        recorder = Recorder(
            head, file=record or "", read=read_line, readings=choice(reading), html=html or "", tell=complain
        )
        security = Security(tls_certificate, tls_key)
        relay = Proxy(system, Target(target_address(grpc), certificate=tls), recorder.record, security=security)
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(_relayed(relay, host, listen, f"to {grpc}; Ctrl-C ends it"))
        judged = recorder.close()
    if judged is None:
        later = f": missionfsm check {record}" if record else ""
        stop(f"the judge has come to no verdict in time{later}", FAILED)
    typer.echo(judged.text)
    troubles = Troubles()
    with troubles.kept():
        write_json(json, judged.verdict)
    troubles.end(DONE if judged.conforms else FAILED)


async def _relayed(relay: "Proxy", host: str, port: int, says: str) -> None:
    import asyncio  # noqa: PLC0415 - commands load what they need

    await relay.start(host, port)
    typer.echo(f"listening on {host}:{relay.port}, passing on {says}")
    try:
        await asyncio.Event().wait()
    finally:
        await relay.stop()
