"""`missionfsm serve`: the reference as a robot that speaks gRPC.

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
    choice,
    refuse_given,
    refuse_outputs,
    stop,
    the_system,
)
from missionfsm.cli.options import Readings
from missionfsm.cli.overgrpc import (
    Certificate,
    Key,
    SystemArgument,
    TokenFile,
    bad_input,
    both_or_neither,
    needs_grpc,
    read_token,
    read_world,
)
from missionfsm.kernel.codec import JSON, UnreadableError

if TYPE_CHECKING:
    pass


def serve(
    context: typer.Context,
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
        typer.Option(
            metavar="NAME:NUMBER", help="deadline, unavailable, internal, lost, doubled (0 to 1); late, ends (s)."
        ),
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

    if not fault and auto is None:
        refuse_given(context, {"seed": "--seed"}, "without --fault or --auto: nothing else is drawn by lot")
    served = the_system(system)
    both_or_neither(tls_certificate, tls_key)
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
    with bad_input(), contextlib.ExitStack() as stack:
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
