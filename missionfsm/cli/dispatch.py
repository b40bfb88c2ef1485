"""`missionfsm dispatch`: a mission server on a real socket, for the missions of a file.

Plain functions for typer; what takes long to import is imported inside them.
"""

from __future__ import annotations

import enum
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from missionfsm.cli.common import BAD_INPUT, complain, refuse_given, stop
from missionfsm.kernel.codec import UnreadableError

if TYPE_CHECKING:
    from missionfsm.adapters.isaac.settings import Settings
    from missionfsm.app.dispatch import Dispatch
    from missionfsm.isaac.runtime.missionfile import MissionFile
    from missionfsm.isaac.runtime.profile import Profile


class ProfileName(enum.StrEnum):
    """Which readings of the document the server follows."""

    DOCUMENTED = "documented"
    AS_SHIPPED = "as-shipped"


class ResumeName(enum.StrEnum):
    """What becomes of a mission that was under way when the server died."""

    RERUN = "rerun"
    FAIL = "fail"


class LogName(enum.StrEnum):
    """How lines are written."""

    TEXT = "text"
    JSON = "json"


class LevelName(enum.StrEnum):
    """How much a line has to matter."""

    DEBUG = "debug"
    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


def dispatch(
    context: typer.Context,
    file: Annotated[Path, typer.Argument(help="The missions, as a JSON file; - is stdin.")],
    host: Annotated[
        str, typer.Option(help="The address to listen on; :: is every one of this machine, IPv4 and IPv6.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="The port to listen on; 0 is any free one.")] = 9998,
    name_channel: Annotated[str, typer.Option(help="The channel on which robots say their names.")] = "name",
    profile: Annotated[ProfileName, typer.Option(help="The readings to follow.")] = ProfileName.DOCUMENTED,
    line_limit: Annotated[int, typer.Option(min=1024, help="Bytes of the longest line that is read or sent.")] = 1
    << 20,
    journal: Annotated[
        Path | None,
        typer.Option(help="Keep what was accepted and what became of it here; a second start goes on from it."),
    ] = None,
    resume: Annotated[
        ResumeName, typer.Option(help="What becomes of a mission that was under way when the server died.")
    ] = ResumeName.FAIL,
    token: Annotated[
        Path | None, typer.Option(help="A JSON object of names and tokens: nobody is a robot without its token.")
    ] = None,
    tls_cert: Annotated[Path | None, typer.Option(help="The server's certificate, PEM; with --tls-key.")] = None,
    tls_key: Annotated[Path | None, typer.Option(help="Its key, PEM.")] = None,
    http: Annotated[
        int | None, typer.Option(min=0, max=65535, help="Show where all stands on this port of loopback, read only.")
    ] = None,
    log: Annotated[
        LogName | None, typer.Option(help="Lines with time and level, instead of the table or of plain lines.")
    ] = None,
    log_level: Annotated[LevelName, typer.Option(help="What is told: this and what matters more.")] = LevelName.INFO,
) -> None:
    """Send the missions of a file to the robots that connect, until all have ended.

    Exit status: 0 if all succeeded, 1 if not, 2 if the file or the address cannot be used, 130 and 143 if a signal
    ended it.
    """
    from missionfsm.adapters.historyfile import read_whole  # noqa: PLC0415 - commands load what they need
    from missionfsm.adapters.isaac.secrets import server_tls, tokens  # noqa: PLC0415
    from missionfsm.adapters.isaac.settings import Settings  # noqa: PLC0415 - commands load what they need
    from missionfsm.app.dispatch import Dispatch  # noqa: PLC0415
    from missionfsm.app.ending import said  # noqa: PLC0415
    from missionfsm.isaac.runtime.profile import PROFILES  # noqa: PLC0415

    if journal is None:
        refuse_given(context, {"resume": "--resume"}, "without --journal")
    if log is None and sys.stdout is not None and sys.stdout.isatty():
        refuse_given(context, {"log_level": "--log-level"}, "on a live table; --log text writes lines")
    readings = PROFILES[profile.value]
    if (tls_cert is None) is not (tls_key is None):
        stop("--tls-cert and --tls-key go together", BAD_INPUT)
    try:
        text = read_whole(str(file))
        names = None if token is None else tokens(str(token))
        tls = None if tls_cert is None else server_tls(str(tls_cert), str(tls_key))
    except UnreadableError as error:
        stop(str(error), BAD_INPUT)
    missions = _missions(file, text, readings, line_limit)
    kept = None if journal is None else str(journal)
    settings = Settings(host, port, name_channel, readings, line_limit, kept, resume.value, names, tls, http)
    work = Dispatch(missions, settings)
    _run(work, settings, log, log_level)
    if work.ended_by is None:
        raise typer.Exit(0 if work.succeeded == len(missions.missions) else 1)
    left = f"{work.unfinished} of {len(missions.missions)} missions had not ended"
    stop(f"{said(work.ended_by)}: {left}", 128 + work.ended_by)


def _missions(file: Path, text: bytes, readings: Profile, line_limit: int) -> MissionFile:
    """The missions of a file; what is odd about them is said, and what is wrong ends the command."""
    from missionfsm.isaac.runtime.missionfile import MissionFile, parse  # noqa: PLC0415 - commands load what they need

    missions = parse(text, readings, line_limit=line_limit)
    for odd in missions.warnings if isinstance(missions, MissionFile) else missions:
        complain(f"{file}: {odd}")
    if not isinstance(missions, MissionFile):
        raise typer.Exit(BAD_INPUT)
    return missions


def _run(work: Dispatch, settings: Settings, log: LogName | None, level: LevelName) -> None:
    """Serve until all missions have ended, or a signal comes; bad input where the address or the journal is no good."""
    import asyncio  # noqa: PLC0415 - commands load what they need

    from missionfsm.adapters.isaac.journal import JournalError  # noqa: PLC0415
    from missionfsm.adapters.isaac.lines import address  # noqa: PLC0415
    from missionfsm.app.dispatch import JournalMismatchError  # noqa: PLC0415
    from missionfsm.cli.isaac_view import LogFormat, view_for  # noqa: PLC0415
    from missionfsm.isaac.runtime.log import Level  # noqa: PLC0415

    style = None if log is None else LogFormat(log.value)
    try:
        with view_for(work, style, Level[level.name]) as view:
            asyncio.run(work.run(view.tell))
    except KeyboardInterrupt:  # before or after the event loop
        work.ended_by = signal.SIGINT
    except OSError as error:
        stop(f"cannot listen on {address((settings.host, settings.port))}: {error.strerror or error}", BAD_INPUT)
    except (JournalError, JournalMismatchError) as error:
        which = f"{settings.journal}: " if isinstance(error, JournalMismatchError) else ""
        stop(f"--journal: {which}{error}", BAD_INPUT)
