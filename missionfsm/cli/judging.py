"""The commands that judge: an implementation, a recorded history, the model itself."""

from __future__ import annotations

import difflib
import enum
import math
import re
import secrets
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from attrs import define

from missionfsm.cli.common import (
    ADAPTER_FAILED,
    BAD_INPUT,
    DONE,
    FAILED,
    INTERRUPTED,
    Troubles,
    choice,
    one_line_errors,
    profiled,
    readable,
    refuse_options,
    refuse_outputs,
    say_shown,
    stop,
    the_system,
    write_json,
)
from missionfsm.cli.helping import SystemName
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
from missionfsm.cli.pages import HtmlFile, write_explorer, write_report
from missionfsm.cli.printing import JsonFile, in_github, say_annotations, say_verdict, stamped, told
from missionfsm.cli.progress import Bar
from missionfsm.kernel.codec import UnreadableError
from missionfsm.kernel.system import System
from missionfsm.kernel.text import printable
from missionfsm.systems import names
from missionfsm.tools.check.verdict import Verdict

if TYPE_CHECKING:
    from missionfsm.kernel.subject import Subject

Readings = Annotated[
    list[str] | None, typer.Option("--reading", metavar="AM-09=a", help="A reading that has to be followed; repeat it.")
]
ProfileName = Annotated[
    str | None,
    typer.Option(
        "--profile",
        metavar="NAME",
        help="Readings of Isaac's systems together: documented (nothing departs from the text) or as-shipped.",
    ),
]
NoFlagged = Annotated[
    bool, typer.Option("--no-flagged", help="What is explained, and yet departs from the text, is a violation.")
]
JunitFile = Annotated[
    str | None, typer.Option("--junit", metavar="FILE", help="Write the verdict as JUnit XML; - is stdout.")
]
Verbose = Annotated[
    bool, typer.Option("--verbose", "-v", help="Tell all readings, what would decide those that are open, rare rules.")
]
Github = Annotated[
    bool | None,
    typer.Option(
        "--github/--no-github", help="Annotations for GitHub Actions; by default where GITHUB_ACTIONS is true."
    ),
]
KnownFile = Annotated[
    str | None,
    typer.Option(
        "--expect-violations",
        metavar="FILE",
        help="Ids of rules that are known to be broken, one a line, # for comments; one that is not met fails.",
    ),
]


GRPC_EXAMPLES = 20
"""Conversations over gRPC, where silence has to be waited for."""

TOLERANCE = 0.2
"""Seconds that times may be off over TCP."""

DAY = 24 * 60 * 60.0
"""Seconds that anything may be waited for."""


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


def _finite(seconds: float | None) -> float | None:
    if seconds is not None and not math.isfinite(seconds):
        message = f"{seconds:g} is no number of seconds"
        raise typer.BadParameter(message)
    return seconds


class Transport(enum.Enum):
    """What lies between an implementation and its log."""

    IMPERFECT = "imperfect"
    STRICT = "strict"


def conform(  # noqa: PLR0913, PLR0915 - options of the command, and what they do
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
        typer.Option("--time", metavar="SECONDS", min=0.1, callback=_finite, help="Begin no further step after that."),
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
        float, typer.Option(min=0.01, max=DAY, callback=_finite, help="Seconds that an answer may take.")
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
        typer.Option(min=0, callback=_finite, help=f"Over TCP: seconds that times may be off; {TOLERANCE} by default."),
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
    json: JsonFile = None,
    html: HtmlFile = None,
    junit: JunitFile = None,
    github: Github = None,
    verbose: Verbose = False,
) -> None:
    """Judge an implementation behind the adapter protocol."""
    from missionfsm.adapters.stdio import Child  # noqa: PLC0415 - commands load what they need
    from missionfsm.adapters.tracefile import tracing  # noqa: PLC0415
    from missionfsm.app.bridged import Sockets, bridged  # noqa: PLC0415
    from missionfsm.cli.signals import interruptible  # noqa: PLC0415
    from missionfsm.tools.conform.conform import Plan  # noqa: PLC0415
    from missionfsm.tools.conform.conform import conform as judge  # noqa: PLC0415

    judged = the_system(system)
    readings = profiled(profile, choice(reading), judged)
    calls: dict[str, Any] = {
        option: _listed(judged, option, given) for option, given in (("only", only), ("without", without))
    }
    known = _known(expect_violations, judged)
    outputs = {"--record": record, "--json": json, "--html": html, "--junit": junit, "--trace": trace}
    refuse_outputs(outputs, (expect_violations, missions))
    limit = TimeLimit(seconds)
    own = [sys.executable, "-m", "missionfsm", "adapter", system]
    sockets = Sockets(tcp, tcp_listen, missions, TOLERANCE if tolerance is None else tolerance)
    wire = None
    if grpc is None:
        options = {
            "--world": world,
            "--settle": settle,
            "--force": force,
            "--token": token,
            "--tls": tls,
            "--metadata": metadata,
            "--keepalive": keepalive,
            "--transport": transport,
            "--begins": begins,
            "--others": others,
        }
        refuse_options(options, "without --grpc")
    else:
        wire = Wire(
            grpc,
            world=world,
            settle=settle,
            force=force,
            token=token,
            tls=tls,
            metadata=metadata or [],
            keepalive=keepalive,
            begins=begins or Beginning.FRESH,
            others=others,
            strict=transport is Transport.STRICT,
        )
        judged = wire.system(system)
        refuse_options(
            {"--tcp": tcp, "--tcp-listen": tcp_listen, "--missions": missions, "COMMAND": command, "--trace": trace},
            "where --grpc says which server is judged",
        )
    if sockets.wanted:
        refuse_options(
            {"--only": only, "--without": without, "--trace": trace, "--distinguish": distinguish}, "over TCP"
        )
    else:
        refuse_options({"--tolerance": tolerance}, "without --tcp or --tcp-listen")
    with one_line_errors(), interruptible() as interruption, tracing(trace) as traced:

        def enough() -> bool:
            return interruption.asked or limit.reached()

        try:
            bridge = bridged(judged, sockets, command, examples, timeout) if sockets.wanted else None
        except ValueError as error:
            stop(str(error), BAD_INPUT)
        if wire is not None:
            child: Subject = wire.subject(system, timeout)
            examples = examples or GRPC_EXAMPLES
        elif bridge:
            child = bridge.subject
        else:
            child = Child(command or own, timeout, stopped=lambda: interruption.asked or limit.over, trace=traced)
        plan = Plan(steps=steps) if examples is None else Plan.sharing(examples, steps)
        try:
            with Bar("conversations", bridge.conversations if bridge else plan.conversations(judged)) as bar:
                asked: dict[str, Any] = {
                    "seed": secrets.randbits(32) if seed is None else seed,
                    "readings": readings,
                    "no_flagged": no_flagged,
                    "expected": known,
                    "enough": enough,
                    "progress": bar.conversation,
                }
                if bridge:
                    verdict = bridge.judge(steps, **asked)
                else:
                    # What nobody is told need not be thought about: it takes as long as a third of the run.
                    advice = verbose or json is not None or html is not None
                    verdict = judge(judged, child, plan=plan, distinguish=distinguish, advice=advice, **calls, **asked)
        except ValueError as error:
            stop(str(error), BAD_INPUT)
        finally:
            child.close()
    troubles = told(verdict, json, verbose=verbose)
    with troubles.kept():
        _annotate(github, [(None, "", verdict)], json)
    with troubles.kept():
        write_report(html, ("", None, verdict))
    with troubles.kept():
        _write_junit(junit, [(verdict.implementation or system, verdict)])
    with troubles.kept():
        _record(record, judged, verdict)
    troubles.end(FAILED if verdict.violation else INTERRUPTED if interruption.asked else _status(verdict))


def smoke(
    system: SystemName,
    command: Annotated[list[str], typer.Argument(help="The adapter to look at, after --.")],
    timeout: Annotated[
        float, typer.Option(min=0.01, max=DAY, callback=_finite, help="Seconds that an answer may take.")
    ] = 3.0,
    json: JsonFile = None,
) -> None:
    """Ask an adapter for each method once, and say what is not of the protocol and how to mend it.

    Exit status: 0 for an adapter, 3 for something that is none yet.
    """
    from missionfsm.adapters.stdio import Child  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.conform.smoke import smoke as looked_at  # noqa: PLC0415

    refuse_outputs({"--json": json})
    found = looked_at(the_system(system), lambda: Child(command, timeout))
    troubles = told(found, json)
    troubles.end(DONE if found.is_adapter else ADAPTER_FAILED)


def _status(verdict: Verdict) -> int:
    return DONE if verdict.conforms else FAILED


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


def _annotate(wanted: bool | None, judged: list[tuple[str | None, str, Verdict]], json: str | None) -> None:
    """Write what GitHub shows beside the files, where it is wanted: each verdict with its file and its robot."""
    if not in_github(wanted):
        return
    from missionfsm.tools.check.github import workflow_commands  # noqa: PLC0415 - commands load what they need

    named = ((path, robot or verdict.implementation or verdict.system, verdict) for path, robot, verdict in judged)
    say_annotations(list(workflow_commands(named)), json=json)


def _write_junit(path: str | None, named: list[tuple[str, Verdict]]) -> None:
    """Write verdicts for build servers, if that is wanted."""
    if path is None:
        return
    from missionfsm.adapters.outputs import write_whole  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.check.junit import junit  # noqa: PLC0415

    write_whole(path, junit(named))


def _record(path: str | None, system: System, verdict: Verdict) -> None:
    """Write the history of a violation in the form that the name of the file asks for, if there is one."""
    if path is None or verdict.violation is None:
        return
    from missionfsm.adapters.outputs import write_history, write_whole  # noqa: PLC0415
    from missionfsm.tools.check.narrate import as_mermaid, as_pytest  # noqa: PLC0415

    history = verdict.violation.history
    form = Path(path).suffix
    if form == ".py":
        name = re.sub(r"\W+", "_", Path(path).stem.removeprefix("test_")).strip("_") or system.name.replace(".", "_")
        write_whole(path, as_pytest(history, name).encode())
    elif form == ".mmd":
        write_whole(path, as_mermaid(system, history).encode())
    else:
        write_history(path, history)


def _known(path: str | None, *judged: System) -> tuple[str, ...]:
    """The rules that a file lists as known to be broken; bad input if one of them is none."""
    if path is None:
        return ()
    from missionfsm.adapters.historyfile import read_whole  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.check.baseline import read_expected  # noqa: PLC0415

    with one_line_errors():
        data = read_whole(path)
    try:
        return read_expected(data.decode(), [one.spec for one in judged])
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        stop(f"{path}:{line}: byte 0x{data[error.start]:02x} is not UTF-8", BAD_INPUT)
    except ValueError as error:
        stop(f"{path}:{error}", BAD_INPUT)


def check(  # noqa: PLR0913 - options of the command
    files: Annotated[
        list[str], typer.Argument(metavar="FILE…", help="Recorded histories, or folders of them; - is stdin.")
    ],
    reading: Readings = None,
    profile: ProfileName = None,
    no_flagged: NoFlagged = False,
    transport: Annotated[
        Transport, typer.Option(help="Whether messages may be lost, doubled or made up on the way.")
    ] = Transport.IMPERFECT,
    begins: Annotated[
        Beginning,
        typer.Option(help="Whether the logs begin with a robot that has done nothing, or while it is in use."),
    ] = Beginning.FRESH,
    others: Annotated[
        bool, typer.Option("--others", help="Others, whose calls are not in the logs, use the robots as well.")
    ] = False,
    settled_after: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", min=0, callback=_finite, help="What is due so long (of `at`) is late."),
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(min=1, max=1024, help="Files judged at a time; by default as many as are worth it.")
    ] = None,
    summary: Annotated[
        bool | None,
        typer.Option("--summary/--no-summary", help="Only what all verdicts come to, as for folders; or every one."),
    ] = None,
    expect_violations: KnownFile = None,
    json: JsonFile = None,
    html: HtmlFile = None,
    junit: JunitFile = None,
    github: Github = None,
    verbose: Verbose = False,
) -> None:
    """Judge recorded histories, or bare messages of live subscriptions and bodies of webhooks."""
    from missionfsm.app.many import histories, judge_files  # noqa: PLC0415 - commands load what they need
    from missionfsm.cli.summary import Told  # noqa: PLC0415
    from missionfsm.tools.check.baseline import Baseline, excused  # noqa: PLC0415

    readings = choice(reading)
    how = {
        "no_flagged": no_flagged,
        "profile": profile,
        "strict": transport is Transport.STRICT,
        "anywhere": begins is Beginning.ANYWHERE,
        "others": others,
        "settled_after": settled_after,
    }
    known = Baseline(_known(expect_violations, *map(the_system, names())) if expect_violations is not None else ())
    with one_line_errors():
        found = histories(files)
    refuse_outputs({"--json": json, "--html": html, "--junit": junit}, (*found, expect_violations))
    many = found != files
    told = Told(json) if (many if summary is None else summary) else None
    reached: list[tuple[str, str | None, Verdict]] = []
    troubles = Troubles()

    def tell(line: str) -> None:
        with troubles.kept():
            say_shown(line, json=json)

    with Bar("files", len(found)) as bar:
        live = tell if told is None else None
        for one in judge_files(found, readings, jobs=jobs, progress=bar.one_more, tell=live, **how):
            with troubles.kept():
                for line in () if told else one.said:
                    say_shown(line, json=json)
                for robot, judged in one.verdicts:
                    reached.append((readable(one.path), robot, excused(judged, known)))
                    if told is None:
                        say_verdict(_headed(*reached[-1], verbose=verbose), json=json)
                if one.trouble:  # one that cannot be read keeps none of the others from being judged
                    raise UnreadableError(one.trouble)
    if told is not None:
        with troubles.kept():
            told.say(reached)
    stale = () if troubles else known.stale  # they may be met in what cannot be read
    with troubles.kept():
        for rule in stale:
            say_shown(f"a violation of {rule} was expected and was not met: take it off the list", json=json)
    if reached:
        more = {"stale": list(stale)} if stale else {}
        verdicts = [{"file": path, "robot": robot, **one.to_json(), **more} for path, robot, one in reached]
        with troubles.kept():
            write_json(json, stamped(verdicts[0] if len(verdicts) == 1 and not many else verdicts))
        with troubles.kept():
            _annotate(github, [(path, robot or "", verdict) for path, robot, verdict in reached], json)
        with troubles.kept():
            write_report(html, *reached)
        with troubles.kept():
            _write_junit(junit, [(f"{path} {robot}" if robot else path, verdict) for path, robot, verdict in reached])
    troubles.end(DONE if not stale and all(verdict.conforms for _, _, verdict in reached) else FAILED)


def _headed(path: str, robot: str | None, verdict: Verdict, *, verbose: bool) -> str:
    """The verdict with what it is about."""
    return f"{printable(path)}{f' {printable(robot)}' if robot else ''}: {verdict.told(verbose=verbose)}"


def explore(  # noqa: PLR0913 - options of the command
    system: SystemName,
    missions: Annotated[int, typer.Option(min=0, max=8, help="Listed missions, at most.")] = 2,
    goals: Annotated[int, typer.Option(min=1, max=8, help="Goals of a mission, at most.")] = 2,
    batch: Annotated[int, typer.Option(min=1, max=8, help="Missions of a batch, at most.")] = 2,
    reading: Readings = None,
    profile: ProfileName = None,
    forget_ended: Annotated[
        bool, typer.Option("--forget-ended", help="Only count what has ended: far fewer states, the same steps.")
    ] = False,
    hazards: Annotated[
        bool, typer.Option("--hazards", help="What a retry can lead to, for every call and failure; nothing else.")
    ] = False,
    json: JsonFile = None,
    html: HtmlFile = None,
) -> None:
    """Visit every state within bounds: invariants, possibilities, which rules fire."""
    from missionfsm.kernel.alphabet import Bounds  # noqa: PLC0415 - commands load what they need
    from missionfsm.kernel.readings import constrain  # noqa: PLC0415
    from missionfsm.tools.explore.explore import explore as visit  # noqa: PLC0415

    explored = the_system(system)
    readings = profiled(profile, choice(reading), explored)
    try:
        assumed = constrain(explored.spec.ambiguities, readings)
    except ValueError as error:
        stop(str(error), BAD_INPUT)
    refuse_outputs({"--json": json, "--html": html})
    bounds = Bounds(missions, goals=goals, batch=batch)
    if hazards:
        from missionfsm.tools.explore.hazards import hazards as retries  # noqa: PLC0415

        if html is not None or forget_ended:
            stop("--hazards: it goes with no --html and no --forget-ended", BAD_INPUT)
        told(retries(explored, bounds, readings), json).end(DONE)
    found = visit(explored, bounds, assumed=assumed, forget_ended=forget_ended)
    troubles = told(found, json)
    with troubles.kept():
        write_explorer(html, explored, bounds, assumed)
    troubles.end(DONE if found.holds else FAILED)


def adapter(
    system: SystemName,
    reading: Readings = None,
    profile: ProfileName = None,
) -> None:
    """Put the reference model behind the adapter protocol, on stdin and stdout."""
    from missionfsm.adapters.historyfile import stdin  # noqa: PLC0415 - commands load what they need
    from missionfsm.adapters.outputs import to_stdout  # noqa: PLC0415
    from missionfsm.adapters.stdio import serve  # noqa: PLC0415
    from missionfsm.tools.reference.subject import ReferenceSubject  # noqa: PLC0415

    try:
        reference = ReferenceSubject(the_system(system), profiled(profile, choice(reading), the_system(system)))
    except ValueError as error:
        stop(str(error), BAD_INPUT)
    requests = stdin()
    with to_stdout():
        serve(reference, requests, sys.stdout.buffer)
