"""The bridges of `conform` to real sockets: which one the options mean, and what is tried over it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from attrs import frozen

from missionfsm.kernel.system import System

if TYPE_CHECKING:
    from missionfsm.adapters.isaac.bridge import RobotBridge, ServerBridge
    from missionfsm.tools.check.verdict import Verdict

CONVERSATIONS = 5
"""How many conversations are had in real time by default."""


@frozen
class Sockets:
    """The options about sockets.

    Attributes:
        tcp: the address of the mission server that is judged.
        listen: the port that the robot connects to that is judged.
        missions: the mission file that the server was given.
        tolerance: by how many seconds times may be off.
    """

    tcp: str | None
    listen: int | None
    missions: str | None
    tolerance: float

    @property
    def wanted(self) -> bool:
        """Whether real sockets are to be judged at all."""
        return self.tcp is not None or self.listen is not None or self.missions is not None


@frozen
class Bridged:
    """How a system is tried over a bridge.

    Attributes:
        system: the system, as it is tried in real time.
        subject: the bridge.
        conversations: how many conversations are had.
        note: what the verdict says of it.
    """

    system: System
    subject: RobotBridge | ServerBridge
    conversations: int
    note: str

    def judge(self, steps: int, **options: Any) -> Verdict:  # noqa: ANN401 - as `missionfsm.tools.conform.live.live` has them
        """The verdict; options are those of `missionfsm.tools.conform.live.live`."""
        from missionfsm.tools.conform.live import live  # noqa: PLC0415 - commands load what they need

        return live(self.system, self.subject, self.conversations, steps, notes=(self.note,), **options)


def bridged(
    system: System, sockets: Sockets, command: list[str] | None, conversations: int | None, timeout: float
) -> Bridged:
    """The bridge that the options mean.

    Raises:
        ValueError: the options do not go together, or a file cannot be used.
        SubjectError: an adapter cannot be started, or a port cannot be had.
    """
    if sockets.tolerance <= 0:
        raise ValueError(f"--tolerance {sockets.tolerance:g}: times are never exact over TCP")
    if sockets.tcp is not None and sockets.listen is not None:
        raise ValueError("--tcp and --tcp-listen: one or the other")
    if sockets.missions is not None and sockets.tcp is None:
        raise ValueError("--missions: it belongs to --tcp, which says where the mission server listens")
    judge = _robot if sockets.listen is not None else _server
    wanted = "isaac.robot" if judge is _robot else "isaac.server"
    if system.name != wanted:
        option = "--tcp-listen" if judge is _robot else "--tcp"
        raise ValueError(f"{option}: it is {wanted} that is judged so, not {system.name}")
    return judge(system, sockets, command, conversations or CONVERSATIONS, timeout)


def _robot(system: System, sockets: Sockets, command: list[str] | None, conversations: int, _: float) -> Bridged:
    from missionfsm.adapters.isaac.bridge import RobotBridge  # noqa: PLC0415 - commands load what they need
    from missionfsm.adapters.isaac.programs import Program  # noqa: PLC0415 - commands load what they need
    from missionfsm.isaac.realtime import in_real_time  # noqa: PLC0415

    assert sockets.listen is not None  # noqa: S101 - the caller has looked
    bridge = RobotBridge(sockets.listen, sockets.tolerance, program=Program(command) if command else None)
    return Bridged(in_real_time(system, world={"name": None}), bridge, conversations if command else 1, _note(sockets))


def _server(system: System, sockets: Sockets, command: list[str] | None, conversations: int, timeout: float) -> Bridged:
    from missionfsm.adapters.historyfile import read_whole  # noqa: PLC0415 - commands load what they need
    from missionfsm.adapters.isaac.bridge import ServerBridge, address  # noqa: PLC0415
    from missionfsm.adapters.isaac.programs import Program  # noqa: PLC0415
    from missionfsm.adapters.stdio import Child  # noqa: PLC0415
    from missionfsm.isaac.realtime import in_real_time, submissions, with_file  # noqa: PLC0415
    from missionfsm.isaac.runtime.missionfile import MissionFile, parse  # noqa: PLC0415

    assert sockets.tcp is not None  # noqa: S101 - the caller has looked
    host, port = address(sockets.tcp)
    if sockets.missions is None:
        if not command:
            raise ValueError("--tcp: say how missions are submitted, by --missions FILE or by an adapter after --")
        bridge = ServerBridge(host, port, sockets.tolerance, adapter=Child(command, timeout))
        tried = in_real_time(system, sockets.tolerance, scripts=conversations)
        return Bridged(tried, bridge, conversations, _note(sockets))
    file = parse(read_whole(sockets.missions))
    if not isinstance(file, MissionFile):
        raise ValueError(f"{sockets.missions}: {file[0]}")  # noqa: TRY004 - it is what the file holds that is wrong
    bridge = ServerBridge(
        host,
        port,
        sockets.tolerance,
        submitted=submissions(file),
        program=Program(command) if command else None,
    )
    tried = with_file(system, file, "name", sockets.tolerance)
    return Bridged(tried, bridge, conversations if command else 1, _note(sockets))


def _note(sockets: Sockets) -> str:
    return (
        f"in real time, with a tolerance of {sockets.tolerance:g} s: what is caused is awaited for that long, and what "
        "is due may come so much earlier or later"
    )
