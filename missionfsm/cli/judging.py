"""The commands that judge: an implementation, a recorded history, the model itself."""

from __future__ import annotations

import secrets
import sys
from collections.abc import Callable
from typing import Annotated, Any

import typer

from missionfsm.cli.common import BAD_INPUT, DONE, FAILED, choice, one_line_errors, say, stop, the_system, write_json

Readings = Annotated[
    list[str] | None, typer.Option("--reading", metavar="AM-09=a", help="A reading that has to be followed; repeat it.")
]
JsonFile = Annotated[str | None, typer.Option("--json", metavar="FILE", help="Write the verdict as JSON; - is stdout.")]


def conform(  # noqa: PLR0913 - options of the command
    system: Annotated[str, typer.Argument(help="Which system: see `missionfsm readings`.")],
    command: Annotated[
        list[str] | None, typer.Argument(help="The adapter to judge, after --; the built-in reference if left out.")
    ] = None,
    examples: Annotated[int, typer.Option(min=1, help="Conversations, each from a reset on.")] = 100,
    steps: Annotated[int, typer.Option(min=1, help="Calls and drives in a conversation, at most.")] = 40,
    seed: Annotated[int | None, typer.Option(help="The same seed asks the same.")] = None,
    reading: Readings = None,
    timeout: Annotated[float, typer.Option(min=0.01, help="Seconds that an answer may take.")] = 10.0,
    record: Annotated[str | None, typer.Option(metavar="FILE", help="Write the history of a violation.")] = None,
    json: JsonFile = None,
) -> None:
    """Judge an implementation behind the adapter protocol."""
    from missionfsm.adapters.historyfile import write_history  # noqa: PLC0415 - commands load what they need
    from missionfsm.adapters.stdio import Child  # noqa: PLC0415
    from missionfsm.tools.conform import conform as judge  # noqa: PLC0415

    judged = the_system(system)
    readings = choice(reading)
    own = [sys.executable, "-m", "missionfsm", "adapter", system]
    with one_line_errors():
        child = Child(command or own, timeout)
        try:
            with _progress(examples) as progress:
                verdict = judge(
                    judged,
                    child,
                    examples=examples,
                    steps=steps,
                    seed=secrets.randbits(32) if seed is None else seed,
                    readings=readings,
                    progress=progress,
                )
        except ValueError as error:
            stop(str(error), BAD_INPUT)
        finally:
            child.close()
        if record and verdict.violation:
            write_history(record, verdict.violation.history)
    write_json(json, verdict.to_json())
    say(str(verdict), json=json)
    raise typer.Exit(DONE if verdict.conforms else FAILED)


class _progress:  # noqa: N801 - a context manager used like a function
    """A progress bar on a terminal, nothing on a pipe."""

    def __init__(self, total: int) -> None:
        self.total = total
        self.bar: Any = None

    def __enter__(self) -> Callable[[], None]:
        if not sys.stderr.isatty():
            return lambda: None
        from rich.console import Console  # noqa: PLC0415 - only a terminal needs it
        from rich.progress import Progress  # noqa: PLC0415

        self.bar = Progress(console=Console(stderr=True), transient=True)
        self.bar.start()
        task = self.bar.add_task("conversations", total=self.total)
        return lambda: self.bar.advance(task)

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.stop()


def check(
    files: Annotated[list[str], typer.Argument(metavar="FILE…", help="Recorded histories; - is stdin.")],
    reading: Readings = None,
    json: JsonFile = None,
) -> None:
    """Judge recorded histories."""
    from missionfsm.cli.recorded import check_file  # noqa: PLC0415 - commands load what they need

    readings = choice(reading)
    verdicts = []
    for path in files:
        with one_line_errors():
            try:
                found = check_file(path, readings)
            except ValueError as error:
                stop(str(error), BAD_INPUT)
        for robot, verdict in found:
            verdicts.append({"file": path, "robot": robot, **verdict.to_json()})
            say(f"{path}{f' {robot}' if robot else ''}: {verdict}", json=json)
    write_json(json, verdicts[0] if len(verdicts) == 1 else verdicts)
    raise typer.Exit(DONE if all(one["verdict"] == "conforms" for one in verdicts) else FAILED)


def explore(  # noqa: PLR0913 - options of the command
    system: Annotated[str, typer.Argument(help="Which system.")],
    missions: Annotated[int, typer.Option(min=0, max=8, help="Listed missions, at most.")] = 2,
    goals: Annotated[int, typer.Option(min=1, max=8, help="Goals of a mission, at most.")] = 2,
    batch: Annotated[int, typer.Option(min=1, max=8, help="Missions of a batch, at most.")] = 2,
    reading: Readings = None,
    forget_ended: Annotated[
        bool, typer.Option("--forget-ended", help="Only count what has ended: far fewer states, the same steps.")
    ] = False,
    json: JsonFile = None,
) -> None:
    """Visit every state within bounds: invariants, possibilities, which rules fire."""
    from missionfsm.kernel.alphabet import Bounds  # noqa: PLC0415 - commands load what they need
    from missionfsm.kernel.readings import constrain  # noqa: PLC0415
    from missionfsm.tools.explore import explore as visit  # noqa: PLC0415

    explored = the_system(system)
    try:
        assumed = constrain(explored.spec.ambiguities, choice(reading))
    except ValueError as error:
        stop(str(error), BAD_INPUT)
    found = visit(explored, Bounds(missions, goals, batch), assumed=assumed, forget_ended=forget_ended)
    write_json(json, found.to_json())
    say(str(found), json=json)
    raise typer.Exit(DONE if found.holds else FAILED)


def teeth(
    system: Annotated[str, typer.Argument(help="Which system.")],
    only: Annotated[str, typer.Option(help="Judge only implementations with this in their name.")] = "",
    seed: Annotated[int, typer.Option(help="The same seed asks the same.")] = 0,
    json: JsonFile = None,
) -> None:
    """Break every rule, one at a time, and see whether the oracle notices."""
    from missionfsm.tools.teeth import mutants  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.teeth import teeth as bite  # noqa: PLC0415

    judged = the_system(system)
    with _progress(sum(only in mutant.name for mutant in mutants(judged))) as progress:
        found = bite(judged, seed=seed, only=only, progress=lambda _: progress())
    write_json(json, found.to_json())
    say(str(found), json=json)
    raise typer.Exit(FAILED if found.missed or found.untested or not found.bites else DONE)


def adapter(
    system: Annotated[str, typer.Argument(help="Which system.")],
    reading: Readings = None,
) -> None:
    """Put the reference model behind the adapter protocol, on stdin and stdout."""
    from missionfsm.adapters.stdio import serve  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.subject import Reference  # noqa: PLC0415

    try:
        reference = Reference(the_system(system), choice(reading))
    except ValueError as error:
        stop(str(error), BAD_INPUT)
    serve(reference, sys.stdin.buffer, sys.stdout.buffer)
