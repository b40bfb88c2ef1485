"""The command that draws: lifecycles, quotients of the explored graph, plans of missions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from missionfsm.cli.common import BAD_INPUT, choice, one_line_errors, refuse_options, say, stop, the_system
from missionfsm.kernel.system import System

if TYPE_CHECKING:  # drawing is loaded when something is drawn
    from missionfsm.tools.draw.gallery import Picture, Wanted

_WITHOUT_DOT = "SVG is drawn by Graphviz, whose program dot was not found: install the package graphviz"


def diagram(
    what: Annotated[
        list[str] | None,
        typer.Argument(metavar="[SYSTEM…]", help="Systems, or pictures such as bear.mission/queue; all if left out."),
    ] = None,
    form: Annotated[
        list[str] | None,
        typer.Option(
            "--format", metavar="FORMAT", help="dot, svg, mermaid, plantuml, scxml, xstate, table; repeat it."
        ),
    ] = None,
    output: Annotated[
        str | None,
        typer.Option("-o", "--output", metavar="DIR", help="Write files there; without it one picture goes to stdout."),
    ] = None,
    reading: Annotated[
        list[str] | None,
        typer.Option("--reading", metavar="AM-09=b", help="A reading to follow instead of the reference's; repeat it."),
    ] = None,
    versus: Annotated[
        list[str] | None,
        typer.Option("--versus", metavar="AM-09=b", help="A reading to draw into the same picture, in another colour."),
    ] = None,
    refusals: Annotated[bool, typer.Option("--refusals", help="Tell below the pictures what is refused.")] = False,
    missions: Annotated[
        str | None, typer.Option("--missions", metavar="FILE", help="Draw the missions of a mission file (Isaac).")
    ] = None,
) -> None:
    """Draw state diagrams from the model itself."""
    from missionfsm.tools.draw.gallery import FORMATS, Wanted  # noqa: PLC0415 - commands load what they need

    if output == "":
        stop("--output: an empty name is no name of a folder", BAD_INPUT)
    forms = _forms(form or (FORMATS if output else ("dot",)))
    wanted = Wanted(choice(reading), choice(versus), refusals)
    chosen = any((what, reading, versus, refusals))
    if missions and chosen:
        stop("--missions draws a mission file, which needs no SYSTEM and has no readings and no refusals", BAD_INPUT)
    with one_line_errors():
        shown = (_of_file(missions),) if missions else tuple(_chosen(what or (), wanted))
    _effective(shown, forms, wanted)
    if output:
        _write(Path(output), shown, forms, whole=not (chosen or form or missions))
    else:
        _print(shown, forms)


def _forms(wanted: Iterable[str]) -> tuple[str, ...]:
    """The formats that are asked for; one that there is not is bad usage."""
    from missionfsm.tools.draw.gallery import FORMATS  # noqa: PLC0415 - commands load what they need

    for form in wanted:
        if form not in FORMATS:
            stop(f"--format {form}: there are {', '.join(FORMATS)}", BAD_INPUT)
    return tuple(dict.fromkeys(wanted))


def _chosen(what: Sequence[str], wanted: Wanted) -> Iterator[Picture]:
    """The pictures that are asked for."""
    from missionfsm.systems import names  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.draw.gallery import pictures  # noqa: PLC0415

    systems = tuple(the_system(one) for one in dict.fromkeys(one.partition("/")[0] for one in what) or names())
    _known(systems, wanted)
    try:
        shown = [one for system in systems for one in pictures(system, wanted)]
    except ValueError as error:
        stop(str(error), BAD_INPUT)
    chosen = shown if not what else [picture for one in what for picture in _called(one, shown)]
    yield from dict.fromkeys(chosen)


def _effective(shown: Sequence[Picture], forms: Sequence[str], wanted: Wanted) -> None:
    """What is asked for has to show in some picture: calls, refusals and readings are in quotients alone."""
    from missionfsm.tools.draw.gallery import DRAWN  # noqa: PLC0415 - commands load what they need

    quotients = any(one.subject in {sketch.name for sketch in the_system(one.system).sketches} for one in shown)
    if shown and not quotients:
        where = f"on {', '.join(one.id for one in shown)}: a lifecycle and a plan have no calls that could be refused"
        refuse_options({"--refusals": wanted.refusals, "--reading": wanted.readings}, where)
    if not DRAWN.intersection(forms):
        refuse_options({"--refusals": wanted.refusals}, f"on {' and '.join(forms)}: tables always tell what is refused")


def _called(name: str, shown: Sequence[Picture]) -> list[Picture]:
    """The picture that is called so, with its parts; or what is so under whatever readings; or all of a system."""
    called = [one for one in shown if name in (one.id, one.whole and f"{one.system}/{one.whole}")]
    called = called or [one for one in shown if name in (one.system, f"{one.system}/{one.subject}")]
    if not called:
        stop(f"there is no picture {name}; there are {', '.join(one.id for one in shown) or 'none'}", BAD_INPUT)
    return called


def _known(systems: tuple[System, ...], wanted: Wanted) -> None:
    """A reading has to be one of some system at least."""
    from missionfsm.tools.draw.gallery import named  # noqa: PLC0415 - commands load what they need

    for name in (*wanted.readings, *wanted.versus):
        if not any(named(system, name) for system in systems):
            stop(f"{', '.join(one.name for one in systems)}: there is no ambiguity {name}", BAD_INPUT)


def _of_file(path: str) -> Picture:
    """The missions of a file, which wait for one another."""
    from missionfsm.adapters.historyfile import STDIN, read_whole  # noqa: PLC0415 - commands load what they need
    from missionfsm.isaac.runtime.missionfile import MissionFile, parse  # noqa: PLC0415
    from missionfsm.isaac.server.plans import plan  # noqa: PLC0415
    from missionfsm.tools.draw.gallery import of_plan  # noqa: PLC0415

    found = parse(read_whole(path))
    if not isinstance(found, MissionFile):
        stop(f"{path}: {found[0]}", BAD_INPUT)
    name = "stdin" if path == STDIN else Path(path).name
    return of_plan("isaac.server", plan(Path(name).stem, f"the missions of {name}", found))


def _print(shown: tuple[Picture, ...], forms: tuple[str, ...]) -> None:
    """Write one picture. A picture that is too large is written whole, unless it is an SVG, which has its parts."""
    asked = shown
    if len(shown) > 1:
        shown = _drawn(shown, forms)
    if len(shown) != 1 or len(forms) != 1:
        ids = ", ".join(picture.id for picture in shown)
        whole = next((one for one in asked if one.divided), None)
        if whole is not None and len(forms) == 1 and all(one.whole == whole.name for one in shown):
            # Nothing else was asked for than what one picture has no room for.
            stop(
                f"as {forms[0]}, {whole.id} is {len(shown)} pictures: name one of {ids}, or a folder with -o", BAD_INPUT
            )
        stop(f"only one picture in one format goes to stdout; name a folder with -o, or one of {ids}", BAD_INPUT)
    text = _text(shown[0], forms[0])
    if text is None:
        stop(_no_machine(shown[0], forms[0]), BAD_INPUT)
    say(text.rstrip("\n"))


def _drawn(shown: tuple[Picture, ...], forms: tuple[str, ...]) -> tuple[Picture, ...]:
    """Of pictures and their parts the parts where an SVG is asked for, else the wholes."""
    from missionfsm.tools.draw.gallery import SVG  # noqa: PLC0415 - commands load what they need

    if forms == (SVG,):
        return tuple(one for one in shown if not one.divided)
    wholes = {(one.system, one.name) for one in shown}
    return tuple(one for one in shown if (one.system, one.whole) not in wholes)


def _no_machine(shown: Picture, form: str) -> str:
    if shown.whole:
        return f"{shown.id} cannot be had as {form}: parts are only drawn; the whole is {shown.system}/{shown.whole}"
    return f"{shown.id} cannot be had as {form}: only a lifecycle is a machine, in which every event leads to one state"


def _write(folder: Path, shown: tuple[Picture, ...], forms: tuple[str, ...], *, whole: bool) -> None:
    """Write every picture in every format that it can be had in; SVG comes last, as it may not work."""
    from missionfsm.tools.draw.gallery import FORMATS, SVG  # noqa: PLC0415 - commands load what they need
    from missionfsm.tools.draw.index import index, path  # noqa: PLC0415

    if whole:
        _write_file(folder / "README.md", index(shown))
    written = 0
    for form in sorted(forms, key=lambda one: one == SVG):
        for one in shown:
            text = _text(one, form)
            if text is not None:
                _write_file(folder / path(one, form), text)
                written += 1
    if not written:
        stop(_no_machine(shown[0], forms[0]), BAD_INPUT)
    files = "file" if written == 1 else "files"
    say(f"{written} {files} in {folder}: {', '.join(FORMATS[one].suffix for one in forms)}")


def _write_file(path: Path, text: str) -> None:
    from missionfsm.adapters.outputs import write_whole  # noqa: PLC0415 - commands load what they need

    with one_line_errors():
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            stop(f"{path.parent}: {error.strerror}", BAD_INPUT)
        write_whole(str(path), text.encode())


def _text(shown: Picture, form: str) -> str | None:
    from missionfsm.tools.draw.gallery import FORMATS, SVG  # noqa: PLC0415 - commands load what they need

    text = FORMATS[form].write(shown)
    return _svg(text) if form == SVG and text is not None else text


def _svg(dot: str) -> str:
    """What Graphviz makes of DOT."""
    import graphviz  # noqa: PLC0415 - only SVG needs it here

    from missionfsm.tools.draw.svg import drawn  # noqa: PLC0415 - as above

    try:
        return drawn(dot, lambda text: str(graphviz.Source(text).pipe(format="svg", encoding="utf-8")))
    except graphviz.ExecutableNotFound:
        stop(_WITHOUT_DOT, BAD_INPUT)
