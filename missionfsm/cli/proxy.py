"""`missionfsm proxy`: what stands between clients and a robot, records and judges.

Plain functions for typer; what takes long to import, and what the extra ``grpc`` brings, is imported inside them.
"""

import contextlib
from typing import TYPE_CHECKING, Annotated

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
    write_json,
)
from missionfsm.cli.options import Readings
from missionfsm.cli.overgrpc import (
    Beginning,
    Certificate,
    Key,
    SystemArgument,
    bad_input,
    both_or_neither,
    needs_grpc,
    read_world,
    target_address,
)
from missionfsm.cli.printing import JsonFile
from missionfsm.kernel.codec import JSON

if TYPE_CHECKING:
    from missionfsm.adapters.grpc.proxy import Proxy


def proxy(
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
    from functools import partial  # noqa: PLC0415

    from missionfsm.adapters.grpc.descriptors import SERVICES  # noqa: PLC0415
    from missionfsm.adapters.grpc.overheard import Chunk, Overheard  # noqa: PLC0415
    from missionfsm.adapters.grpc.proxy import Proxy  # noqa: PLC0415
    from missionfsm.adapters.grpc.server import Security  # noqa: PLC0415
    from missionfsm.adapters.grpc.target import Target  # noqa: PLC0415
    from missionfsm.app.asked import judged_system, refuse_json_only  # noqa: PLC0415
    from missionfsm.app.recorder import Recorder  # noqa: PLC0415

    if system not in SERVICES:
        stop(f"{system}: there is a proxy for {' and '.join(SERVICES)}", BAD_INPUT)
    both_or_neither(tls_certificate, tls_key)
    refuse_outputs({"--record": record, "--json": json, "--html": html}, (world,))
    head: dict[str, JSON] = {"missionfsm": 1, "system": system, "world": read_world(world), "drives": []}
    if begins is Beginning.ANYWHERE:
        head["begins"] = begins.value
    if others:
        head["others"] = True
    with bad_input():
        seen_as = judged_system(system, strict=False, anywhere=begins is Beginning.ANYWHERE, others=others)
        refuse_json_only(seen_as, choice(reading))
        recorder: Recorder[Chunk] = Recorder(
            head,
            partial(Overheard, system, others=others),
            file=record or "",
            readings=choice(reading),
            html=html or "",
            tell=complain,
        )

        def seen(chunk: Chunk) -> None:
            recorder.record(chunk, len(chunk.data))

        security = Security(tls_certificate, tls_key)
        relay = Proxy(Target(target_address(grpc), certificate=tls), seen, security=security)
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
