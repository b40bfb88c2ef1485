"""`missionfsm dispatch` and `missionfsm robot`: a mission server and a simulated robot on real sockets.

Plain functions for typer; what takes long to import is imported inside them.
"""

import enum
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from missionfsm.cli.common import BAD_INPUT, complain, stop
from missionfsm.kernel.codec import UnreadableError

if TYPE_CHECKING:
    from missionfsm.cli.isaac_view import View
    from missionfsm.isaac.runtime.missionfile import MissionFile
    from missionfsm.isaac.runtime.profile import Profile
    from missionfsm.isaac.runtime.robot import Behavior

_INTERRUPTED = 128 + signal.SIGINT


class ProfileName(enum.StrEnum):
    """Which readings of the document the server follows."""

    DOCUMENTED = "documented"
    AS_SHIPPED = "as-shipped"


class Outcome(enum.StrEnum):
    """How a simulated mission goes."""

    SUCCEED = "succeed"
    FAIL = "fail"
    HANG = "hang"


def dispatch(
    file: Annotated[Path, typer.Argument(help="The missions, as a JSON file; - is stdin.")],
    host: Annotated[str, typer.Option(help="The address to listen on.")] = "0.0.0.0",  # noqa: S104 - robots are elsewhere
    port: Annotated[int, typer.Option(min=0, max=65535, help="The port to listen on; 0 is any free one.")] = 9998,
    name_channel: Annotated[str, typer.Option(help="The channel on which robots say their names.")] = "name",
    profile: Annotated[ProfileName, typer.Option(help="The readings to follow.")] = ProfileName.DOCUMENTED,
) -> None:
    """Send the missions of a file to the robots that connect, until all have ended.

    Exit status: 0 if all succeeded, 1 if not, 2 if the file or the address cannot be used.
    """
    import asyncio  # noqa: PLC0415

    from missionfsm.adapters.historyfile import read_whole  # noqa: PLC0415
    from missionfsm.cli.isaac_view import view_for  # noqa: PLC0415
    from missionfsm.isaac.runtime.missionfile import MissionFile, parse  # noqa: PLC0415
    from missionfsm.isaac.runtime.profile import PROFILES  # noqa: PLC0415

    readings = PROFILES[profile.value]
    try:
        text = read_whole(str(file))
    except UnreadableError as error:
        stop(str(error), BAD_INPUT)
    missions = parse(text, readings)
    if not isinstance(missions, MissionFile):
        for problem in missions:
            complain(f"{file}: {problem}")
        raise typer.Exit(2)
    view = view_for(missions)
    try:
        asyncio.run(_serve(missions, host, port, name_channel, readings, view))
    except KeyboardInterrupt:
        complain(f"interrupted: {view.unfinished} of {len(missions.missions)} missions had not ended")
        raise typer.Exit(_INTERRUPTED) from None
    except OSError as error:
        complain(f"cannot listen on {host}:{port}: {error.strerror or error}")
        raise typer.Exit(2) from None
    raise typer.Exit(0 if view.succeeded == len(missions.missions) else 1)


async def _serve(  # noqa: PLR0913 - the options
    missions: "MissionFile", host: str, port: int, name_channel: str, profile: "Profile", view: "View"
) -> None:
    import asyncio  # noqa: PLC0415

    from missionfsm.adapters.isaac.tcp import TcpMissionServer, fresh_uuid  # noqa: PLC0415

    done = asyncio.Event()

    def observe(effect: object) -> None:
        view.see(effect)
        if not view.unfinished:
            done.set()

    uuids = tuple(fresh_uuid() for _ in missions.missions)
    view.name(uuids)
    server = TcpMissionServer(host=host, port=port, name_channel=name_channel, profile=profile, observer=observe)
    await server.start()
    try:
        with view:
            view.say(f"listening on {host}:{server.port}")
            refused = server.submit_file(missions, uuids)
            if refused is not None:  # the file was read with this profile, so this does not happen
                raise RuntimeError(str(refused))
            if view.unfinished:
                await done.wait()
    finally:
        await server.close()
    view.summarize()


def robot(  # noqa: PLR0913 - the options
    name: Annotated[str, typer.Option(help="The robot's name, as missions call it.")],
    host: Annotated[str, typer.Option(help="Where the mission server is.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=1, max=65535, help="The mission server's port.")] = 9998,
    behavior: Annotated[Outcome, typer.Option(help="How every mission goes.")] = Outcome.SUCCEED,
    duration: Annotated[float, typer.Option(min=0.0, help="How long a mission takes, in seconds.")] = 1.0,
    script: Annotated[
        str | None, typer.Option(help="How each mission goes, the last for all that follow: succeed:0.5,fail,hang")
    ] = None,
) -> None:
    """Simulate a robot that connects to a mission server, again and again, until interrupted."""
    import asyncio  # noqa: PLC0415

    from missionfsm.isaac.runtime.robot import Behavior, ScriptProblem, parse_script  # noqa: PLC0415

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
    try:
        asyncio.run(_be_a_robot(name, host, port, steps))
    except KeyboardInterrupt:
        complain("interrupted")
        raise typer.Exit(_INTERRUPTED) from None


async def _be_a_robot(name: str, host: str, port: int, script: "tuple[Behavior, ...]") -> None:
    from missionfsm.adapters.isaac.tcp import TcpRobot  # noqa: PLC0415
    from missionfsm.cli.isaac_view import Printer, robot_line  # noqa: PLC0415
    from missionfsm.isaac.runtime.robot import RobotCore  # noqa: PLC0415

    printer = Printer()
    last: list[str] = []

    def observe(effect: object) -> None:
        line = robot_line(effect)
        if line is not None and [line] != last:  # RUNNING is said ten times a second, and shown once
            last[:] = [line]
            printer.say(line)

    core = RobotCore(name, script=script)
    await TcpRobot(core, host=host, port=port, observer=observe, notes=printer.say).run()
