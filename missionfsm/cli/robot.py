"""`missionfsm robot`: a simulated robot on a real socket.

Plain functions for typer; what takes long to import is imported inside them.
"""

import contextlib
import enum
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from missionfsm.cli.common import complain, one_line_errors, refuse_given, stop

if TYPE_CHECKING:
    from missionfsm.adapters.isaac.settings import Dialling
    from missionfsm.isaac.runtime.robot import RobotCore


class Outcome(enum.StrEnum):
    """How a simulated mission goes."""

    SUCCEED = "succeed"
    FAIL = "fail"
    HANG = "hang"


def robot(
    context: typer.Context,
    name: Annotated[str, typer.Option(help="The robot's name, as missions call it.")],
    host: Annotated[str, typer.Option(help="Where the mission server is.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=1, max=65535, help="The mission server's port.")] = 9998,
    behavior: Annotated[Outcome, typer.Option(help="How every mission goes.")] = Outcome.SUCCEED,
    duration: Annotated[float, typer.Option(min=0.0, help="How long a mission takes, in seconds.")] = 1.0,
    script: Annotated[
        str | None, typer.Option(help="How each mission goes, the last for all that follow: succeed:0.5,fail,hang")
    ] = None,
    line_limit: Annotated[int, typer.Option(min=1024, help="Bytes of the longest line that is read.")] = 1 << 20,
    token: Annotated[Path | None, typer.Option(help="A file with the token that goes with the name.")] = None,
    tls_ca: Annotated[
        Path | None, typer.Option(help="Speak TLS, with a server whose certificate these (PEM) vouch for.")
    ] = None,
) -> None:
    """Simulate a robot that connects to a mission server, again and again, until interrupted."""
    import asyncio  # noqa: PLC0415

    from missionfsm.adapters.isaac.secrets import client_tls  # noqa: PLC0415
    from missionfsm.adapters.isaac.secrets import token as read_token  # noqa: PLC0415
    from missionfsm.adapters.isaac.settings import Dialling  # noqa: PLC0415
    from missionfsm.app.ending import said  # noqa: PLC0415
    from missionfsm.isaac.runtime.robot import Behavior, RobotCore, ScriptProblem, parse_script  # noqa: PLC0415

    if script is not None:
        refuse_given(context, {"behavior": "--behavior"}, "with --script, which says how each mission goes")
        if all(":" in step or step.strip() == Outcome.HANG for step in script.split(",")):
            refuse_given(context, {"duration": "--duration"}, "where every step of --script has seconds, or hangs")
    elif behavior is Outcome.HANG:
        refuse_given(context, {"duration": "--duration"}, "with --behavior hang, which never ends")
    if not name:
        complain("--name: an empty name is no name")
        raise typer.Exit(2)
    try:
        steps = (Behavior(behavior.value, duration),) if script is None else parse_script(script, duration)
    except ValueError:
        complain(f"--duration: wanted a finite number of seconds, found {duration}")
        raise typer.Exit(2) from None
    if isinstance(steps, ScriptProblem):
        complain(f"--script: {steps}")
        raise typer.Exit(2)
    with one_line_errors():
        secret = None if token is None else read_token(str(token))
        tls = None if tls_ca is None else client_tls(str(tls_ca))
    core = RobotCore(name, script=steps, token=secret)
    ended: list[signal.Signals] = []
    try:
        asyncio.run(_be_a_robot(core, Dialling(host, port, tls), line_limit, ended))
    except KeyboardInterrupt:
        ended = [signal.SIGINT]
    stop(said(ended[0]), 128 + ended[0])


async def _be_a_robot(core: "RobotCore", dialling: "Dialling", line_limit: int, ended: list[signal.Signals]) -> None:
    """Be a robot until a signal ends it, which is then in `ended`."""
    import asyncio  # noqa: PLC0415

    from missionfsm.adapters.isaac.tcp import TcpRobot  # noqa: PLC0415
    from missionfsm.app.ending import told_to_end  # noqa: PLC0415
    from missionfsm.cli.isaac_view import Log, robot_line  # noqa: PLC0415

    log = Log()
    last: list[str] = []

    def observe(effect: object) -> None:
        line = robot_line(effect)
        if line is not None and [line] != last:  # RUNNING is said ten times a second, and shown once
            last[:] = [line]
            log.say(line)

    robot = TcpRobot(core, dialling, line_limit=line_limit, observer=observe, notes=log.say)
    work = asyncio.ensure_future(robot.run())

    def end(by: signal.Signals) -> None:
        ended.append(by)
        work.cancel()

    try:
        with told_to_end(end), contextlib.suppress(asyncio.CancelledError):
            await work
    finally:
        work.cancel()
        log.close()
