"""The command that judges an implementation, through its adapter, a socket or gRPC."""

from __future__ import annotations

import difflib
import math
import os
import sys
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import define, frozen

from missionfsm.cli.common import (
    BAD_INPUT,
    DONE,
    FAILED,
    INTERRUPTED,
    Troubles,
    choice,
    one_line_errors,
    profiled,
    refuse_options,
    refuse_outputs,
    stop,
    the_system,
)
from missionfsm.cli.helping import SystemName
from missionfsm.cli.options import (
    DAY,
    Github,
    KnownFile,
    NoFlagged,
    ProfileName,
    Readings,
    Transport,
    Verbose,
    finite,
)
from missionfsm.cli.overgrpc import (
    Beginning,
    Force,
    GrpcAddress,
    KeepaliveSeconds,
    MetadataEntries,
    SettleSeconds,
    TlsFile,
    TokenFile,
    Wire,
    WorldFile,
)
from missionfsm.cli.printing import made, say_verdict
from missionfsm.cli.progress import Bar
from missionfsm.cli.reports import NO_REPORTS, Reports, annotate, known_violations, with_reports, write_record
from missionfsm.kernel.system import System
from missionfsm.reports.report import Finding, Report

if TYPE_CHECKING:
    from missionfsm.adapters.stdio import Trace
    from missionfsm.app.bridged import Bridged, Sockets
    from missionfsm.kernel.subject import Subject
    from missionfsm.tools.check.verdict import Verdict
    from missionfsm.tools.conform.plan import Plan


GRPC_EXAMPLES = 20
"""Conversations over gRPC, where silence has to be waited for."""

TOLERANCE = 0.2
"""Seconds that times may be off over TCP."""


@define
class TimeLimit:
    """The seconds that a run may take, from when its adapter is there: what is slow to start does not use them up."""

    seconds: float | None
    began: float | None = None

    def reached(self) -> bool:
        """Whether they have passed; the first time that it is asked, they begin."""
        if self.began is None:
            self.began = time.monotonic()
        return self.over

    @property
    def over(self) -> bool:
        """Whether they have begun and passed."""
        began, seconds = self.began, self.seconds
        return began is not None and seconds is not None and time.monotonic() > began + seconds

    def left(self) -> float:
        """How many are left; infinite where there is no limit."""
        if self.seconds is None:
            return math.inf
        return self.seconds if self.began is None else max(0.0, self.began + self.seconds - time.monotonic())


@with_reports(several=False)
def conform(
    system: SystemName,
    command: Annotated[
        list[str] | None, typer.Argument(help="The adapter to judge, after --; the built-in reference if left out.")
    ] = None,
    examples: Annotated[
        int | None, typer.Option(min=1, help="Conversations in all, each from a reset on: some 300, or 5 in real time.")
    ] = None,
    steps: Annotated[int, typer.Option(min=1, help="Calls and drives in a conversation, at most.")] = 40,
    seed: Annotated[int | None, typer.Option(help="The same seed asks the same.")] = None,
    seconds: Annotated[
        float | None,
        typer.Option("--time", metavar="SECONDS", min=0.1, callback=finite, help="Begin no further step after that."),
    ] = None,
    reading: Readings = None,
    profile: ProfileName = None,
    no_flagged: NoFlagged = False,
    expect_violations: KnownFile = None,
    only: Annotated[
        list[str] | None, typer.Option(metavar="CALL", help="Make this call and no others; repeat it, or use commas.")
    ] = None,
    without: Annotated[
        list[str] | None, typer.Option(metavar="CALL", help="Leave this call or drive out; repeat it, or use commas.")
    ] = None,
    distinguish: Annotated[
        bool, typer.Option("--distinguish", help="Try at the end to tell readings apart that are still open.")
    ] = False,
    timeout: Annotated[
        float, typer.Option(min=0.01, max=DAY, callback=finite, help="Seconds that an answer may take.")
    ] = 10.0,
    tcp: Annotated[
        str | None,
        typer.Option(metavar="HOST:PORT", help="Judge the mission server that listens there (isaac.server)."),
    ] = None,
    missions: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="With --tcp: the server's mission file; the command after -- starts it."),
    ] = None,
    tcp_listen: Annotated[
        int | None,
        typer.Option(
            metavar="PORT",
            min=1,
            max=65535,
            help="Judge the robot that connects there; the command after -- starts it.",
        ),
    ] = None,
    grpc: GrpcAddress = None,
    world: WorldFile = None,
    settle: SettleSeconds = None,
    force: Force = False,
    token: TokenFile = None,
    tls: TlsFile = None,
    metadata: MetadataEntries = None,
    keepalive: KeepaliveSeconds = None,
    transport: Annotated[
        Transport | None,
        typer.Option(help="With --grpc: whether messages may be lost, doubled or made up on the way."),
    ] = None,
    begins: Annotated[
        Beginning | None,
        typer.Option(help="With --grpc: whether the robot is begun anew, or is in use and left so."),
    ] = None,
    others: Annotated[
        bool, typer.Option("--others", help="With --grpc: others use the robot at the same time.")
    ] = False,
    tolerance: Annotated[
        float | None,
        typer.Option(min=0, callback=finite, help=f"Over TCP: seconds that times may be off; {TOLERANCE} by default."),
    ] = None,
    trace: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Write every line that is sent and that comes, with its time; - is stdout."),
    ] = None,
    record: Annotated[
        str | None,
        typer.Option(
            metavar="FILE", help="Write the history of a violation; as a pytest function to .py, as Mermaid to .mmd."
        ),
    ] = None,
    reports: Reports = NO_REPORTS,
    github: Github = None,
    verbose: Verbose = False,
) -> None:
    """Judge an implementation behind the adapter protocol.

    Exit status: 0 if it conforms, flagged or not, 1 if it violates or the verdict is inconclusive, 2 for bad usage or
    bad input, 3 if the adapter failed, which is no verdict.
    """
    from missionfsm.adapters.tracefile import tracing  # noqa: PLC0415 - commands load what they need
    from missionfsm.app.bridged import Sockets  # noqa: PLC0415
    from missionfsm.cli.signals import interruptible  # noqa: PLC0415

    judged = the_system(system)
    readings = profiled(profile, choice(reading), judged)
    calls = {option: _listed(judged, option, given) for option, given in (("only", only), ("without", without))}
    known = known_violations(expect_violations, judged=judged)
    refuse_outputs({"--record": record, **reports.outputs, "--trace": trace}, (expect_violations, missions))
    with one_line_errors():
        reports.refuse_impossible()
    sockets = Sockets(tcp, tcp_listen, missions, TOLERANCE if tolerance is None else tolerance)
    over_grpc = {
        "world": world,
        "settle": settle,
        "force": force,
        "token": token,
        "tls": tls,
        "metadata": metadata,
        "keepalive": keepalive,
        "transport": transport,
        "begins": begins,
        "others": others,
    }
    wire = _wire(grpc, over_grpc)
    if wire is not None:
        judged = wire.system(system, readings)
    own_sockets = {"--tcp": tcp, "--tcp-listen": tcp_listen, "--missions": missions, "COMMAND": command}
    asking = {"--only": only, "--without": without, "--trace": trace, "--distinguish": distinguish}
    _refuse_without_effect(sockets, wire, own_sockets, asking, tolerance)
    limit = TimeLimit(seconds)
    with one_line_errors(), interruptible() as interruption, tracing(trace) as traced:
        way = _Way(judged, system, sockets, wire, command, examples, timeout)
        reached = way.reached(limit, traced, lambda: interruption.asked)
        plan = reached.plan(steps)
        try:
            with Bar("conversations", reached.conversations(plan)) as bar:
                asked: dict[str, Any] = {
                    "seed": int.from_bytes(os.urandom(4), "big") if seed is None else seed,
                    "readings": readings,
                    "no_flagged": no_flagged,
                    "expected": known,
                    "enough": lambda: interruption.asked or limit.reached(),
                    "progress": bar.conversation,
                }
                # What nobody is told need not be thought about: it takes as long as a third of the run.
                advice = verbose or reports.advises
                verdict = reached.judge(plan, asked, {"distinguish": distinguish, "advice": advice, **calls})
        except ValueError as error:
            stop(str(error), BAD_INPUT)
        finally:
            reached.subject.close()
    troubles, found = Troubles(), (Finding(verdict),)
    with troubles.kept():
        say_verdict(verdict.text(verbose=verbose), json=reports.taken)
    with troubles.kept():
        annotate(found, github, reports.taken)
    reports.write(Report(found, made()), troubles)
    with troubles.kept():
        write_record(record, judged, verdict)
    status = DONE if verdict.conforms else FAILED
    troubles.end(INTERRUPTED if interruption.asked and verdict.violation is None else status)


@frozen
class _Reached:
    """An implementation that can be talked to.

    Attributes:
        system: the system that it is judged by.
        bridge: how it is judged in real time; None where it is asked through an adapter or gRPC.
        examples: how many conversations are asked for; None where nobody said.
    """

    system: System
    subject: Subject
    bridge: Bridged | None = None
    examples: int | None = None

    def plan(self, steps: int) -> Plan:
        """How many conversations of which kind are had."""
        from missionfsm.tools.conform.plan import Plan  # noqa: PLC0415 - commands load what they need

        return Plan.of(self.examples, steps)

    def conversations(self, plan: Plan) -> int:
        """How many there will be, for the progress bar."""
        return self.bridge.conversations if self.bridge else plan.conversations(self.system)

    def judge(self, plan: Plan, asked: dict[str, Any], asked_without_sockets: dict[str, Any]) -> Verdict:
        """The verdict; the options are those of `conform`, some of which judging over sockets does not have."""
        from missionfsm.tools.conform.conform import conform as judge  # noqa: PLC0415 - commands load what they need

        if self.bridge:
            return self.bridge.judge(plan.steps, **asked)
        return judge(self.system, self.subject, plan=plan, **asked_without_sockets, **asked)


@frozen
class _Way:
    """How the implementation that is judged is reached, as the options say it."""

    judged: System
    name: str
    sockets: Sockets
    wire: Wire | None
    command: list[str] | None
    examples: int | None
    timeout: float

    def reached(self, limit: TimeLimit, traced: Trace, interrupted: Callable[[], bool]) -> _Reached:
        """The implementation, started. Bad input ends the command; raises SubjectError where it does not start."""
        from missionfsm.adapters.stdio import Child  # noqa: PLC0415 - commands load what they need
        from missionfsm.app.bridged import bridged  # noqa: PLC0415

        if self.wire is not None:
            subject = self.wire.subject(self.name, self.timeout)
            return _Reached(self.judged, subject, examples=self.examples or GRPC_EXAMPLES)
        if self.sockets.wanted:
            try:
                bridge = bridged(self.judged, self.sockets, self.command, self.examples, self.timeout)
            except ValueError as error:
                stop(str(error), BAD_INPUT)
            bridge.subject.left = limit.left
            return _Reached(self.judged, bridge.subject, bridge, self.examples)
        command = self.command or [sys.executable, "-m", "missionfsm", "adapter", self.name]
        child = Child(command, self.timeout, stopped=lambda: interrupted() or limit.over, trace=traced)
        return _Reached(self.judged, child, examples=self.examples)


def _refuse_without_effect(
    sockets: Sockets,
    wire: Wire | None,
    own_sockets: Mapping[str, object],
    asking: Mapping[str, object],
    tolerance: float | None,
) -> None:
    """End the command where an option is given that has no effect on the way in which the implementation is reached."""
    if wire is not None:
        refuse_options({**own_sockets, "--trace": asking["--trace"]}, "where --grpc says which server is judged")
    if sockets.wanted:
        refuse_options(asking, "over TCP")
    else:
        refuse_options({"--tolerance": tolerance}, "without --tcp or --tcp-listen")


def _wire(grpc: str | None, options: dict[str, Any]) -> Wire | None:
    """How a gRPC server is judged; None where none is, which takes the options that say how for bad usage."""
    if grpc is None:
        refuse_options({f"--{name}": given for name, given in options.items()}, "without --grpc")
        return None
    given = dict(options)
    strict = given.pop("transport") is Transport.STRICT
    begins, metadata = given.pop("begins") or Beginning.FRESH, given.pop("metadata") or []
    return Wire(grpc, begins=begins, metadata=metadata, strict=strict, **given)


def _listed(judged: System, option: str, given: list[str] | None) -> tuple[str, ...]:
    """The calls, or with --without the calls and drives, that an option names; bad input if there is no such one."""
    named = tuple(name.strip() for one in given or () for name in one.split(",") if name.strip())
    known = (*judged.codec.methods, *(judged.spec.drives if option == "without" else ()))
    for name in named:
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            meant = f"; is {near[0]} meant?" if near else f"; there are {', '.join(known)}"
            stop(f"--{option} {name}: {judged.name} has no such call{meant}", BAD_INPUT)
    return named
