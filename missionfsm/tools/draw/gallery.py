"""Every picture of a system, and every format that it can be had in."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from attrs import evolve, field, frozen

from missionfsm.kernel.chart import Chart
from missionfsm.kernel.picture import Part, Plan, Sketch
from missionfsm.kernel.readings import Ambiguity, choose
from missionfsm.kernel.system import System
from missionfsm.tools.draw import diagram as picture
from missionfsm.tools.draw import dot, machines, mermaid, plantuml, tables
from missionfsm.tools.draw.diagram import Diagram
from missionfsm.tools.draw.parts import apart, parts
from missionfsm.tools.draw.quotient import quotient


@frozen(eq=False)
class Picture:
    """Something that is drawn.

    Attributes:
        subject: the lifecycle, sketch or plan that it shows.
        name: the same with the readings that it is drawn under; its files are named after it.
        table: the same in words, as Markdown.
        chart: the lifecycle, if it shows one.
        whole: the name of the picture that this is a part of; empty if it is not a part.
        divided: whether it is too large for one picture, so that there are parts of it.
    """

    system: str
    subject: str
    name: str
    diagram: Diagram
    table: str
    chart: Chart[object] | None = None
    whole: str = ""
    divided: bool = False

    @property
    def id(self) -> str:
        """Its name among the pictures of all systems."""
        return f"{self.system}/{self.name}"


@frozen
class Format:
    """How a picture is written: what its files end in, and the text; None for a picture that it cannot say.

    An SVG is what Graphviz makes of the DOT, so its text is that; but for what is too much for one picture, of which
    only the parts are drawn. A table has the whole in it, so the parts have none.
    """

    suffix: str
    write: Callable[[Picture], str | None]


def _machine(shown: Picture) -> str:
    """The name of a machine: interpreters take it for the name of a function."""
    return picture.identifier(shown.id)


def _scxml(shown: Picture) -> str | None:
    return machines.scxml(_machine(shown), shown.chart) if shown.chart else None


def _xstate(shown: Picture) -> str | None:
    return machines.xstate(_machine(shown), shown.chart) if shown.chart else None


SVG = "svg"
FORMATS: Mapping[str, Format] = {
    "dot": Format(".dot", lambda shown: dot.write(shown.diagram)),
    SVG: Format(".svg", lambda shown: None if shown.divided else dot.write(shown.diagram)),
    "mermaid": Format(".mmd", lambda shown: mermaid.write(shown.diagram)),
    "plantuml": Format(".puml", lambda shown: plantuml.write(shown.diagram)),
    "scxml": Format(".scxml", _scxml),
    "xstate": Format(".xstate.json", _xstate),
    "table": Format(".md", lambda shown: shown.table or None),
}
DRAWN = frozenset({"dot", SVG, "mermaid", "plantuml"})
"""The formats that are pictures; they show refusals only if that is wanted."""


@frozen
class Wanted:
    """What is to be drawn.

    Attributes:
        readings: ambiguity to letter, where another than the reference's is followed.
        versus: ambiguity to letter, where that is drawn into the same picture.
        refusals: whether the pictures tell what is refused; the tables always do.
    """

    readings: Mapping[str, str] = field(factory=dict)
    versus: Mapping[str, str] = field(factory=dict)
    refusals: bool = False


def named(system: System, name: str) -> tuple[Ambiguity, ...]:
    """The ambiguities of a system that a name such as ``AM-14`` or ``AM-14.paused`` speaks of."""
    return tuple(one for one in system.spec.ambiguities if name in (one.id, one.id.partition(".")[0]))


def pictures(system: System, wanted: Wanted) -> Iterator[Picture]:
    """The pictures of a system: lifecycles, quotients of its explored graph, plans of missions.

    Readings of other systems are ignored. If two readings are drawn in one picture, only quotients are drawn. If no
    readings are given, the contrasts are drawn that the system itself names.

    Raises:
        ValueError: a reading that does not exist, or two that are the same.
    """
    readings = {name: letter for name, letter in wanted.readings.items() if named(system, name)}
    versus = {name: letter for name, letter in wanted.versus.items() if named(system, name)}
    if wanted.versus and not versus:
        return
    if not wanted.versus:
        for chart in system.spec.charts:
            yield from _with_parts(_of_chart(system, chart))
    for sketch in system.sketches:
        for shown in _of_system(system, sketch, readings, versus, wanted):
            yield from _with_parts(shown, sketch.parts)
    if not wanted.versus:
        yield from (of_plan(system.name, plan) for plan in system.plans)


def drawn(system: System, subject: str) -> tuple[Picture, ...]:
    """What is drawn of a lifecycle or a sketch under the reference's readings: it, or its parts; nothing of another."""
    charts = (chart for chart in system.spec.charts if chart.name.replace(" ", "-") == subject)
    sketches = (sketch for sketch in system.sketches if sketch.name == subject)
    found = (
        *(one for chart in charts for one in _with_parts(_of_chart(system, chart))),
        *(
            one
            for sketch in sketches
            for one in _with_parts(_of_sketch(system, sketch, {}, refusals=False), sketch.parts)
        ),
    )
    return tuple(one for one in found if not one.divided)


def _of_system(
    system: System, sketch: Sketch, readings: Mapping[str, str], versus: Mapping[str, str], wanted: Wanted
) -> Iterator[Picture]:
    """The pictures that are made of one sketch."""
    if versus:
        yield _of_contrast(system, sketch, readings, versus, refusals=wanted.refusals)
        return
    yield _of_sketch(system, sketch, readings, refusals=wanted.refusals)
    if not wanted.readings:
        for contrast in sketch.contrasts:
            name, _, letter = contrast.partition("=")
            yield _of_contrast(system, sketch, {}, {name: letter}, refusals=wanted.refusals)


def _with_parts(shown: Picture, wanted: tuple[Part, ...] = ()) -> Iterator[Picture]:
    """A picture, and its parts if it is too large for one."""
    found = tuple(parts(shown.diagram, wanted))
    yield evolve(shown, divided=bool(found))
    for part, drawn in found:
        yield Picture(shown.system, shown.subject, f"{shown.name}-{part.name}", drawn, "", whole=shown.name)


def _of_chart(system: System, chart: Chart[object]) -> Picture:
    name = chart.name.replace(" ", "-")
    return Picture(system.name, name, name, picture.of_chart(system.name, chart), tables.of_chart(chart), chart)


def of_plan(system: str, plan: Plan) -> Picture:
    """The picture of a plan."""
    return Picture(system, plan.name, plan.name, picture.of_plan(system, plan), tables.of_plan(plan))


def _of_sketch(system: System, sketch: Sketch, readings: Mapping[str, str], *, refusals: bool) -> Picture:
    shown = quotient(system, sketch, choose(system.spec.ambiguities, readings))
    following = tuple(f"{name}={letter}" for name, letter in readings.items())
    drawn = picture.of_quotient(_title(system, sketch, following), shown, refusals=refusals)
    return Picture(system.name, sketch.name, _stem(sketch.name, *following), drawn, tables.of_quotient(shown))


def _of_contrast(
    system: System, sketch: Sketch, readings: Mapping[str, str], versus: Mapping[str, str], *, refusals: bool
) -> Picture:
    ambiguities = system.spec.ambiguities
    choices = choose(ambiguities, readings), choose(ambiguities, {**readings, **versus})
    differing = tuple(one for one in ambiguities if one.possible(choices[0]) != one.possible(choices[1]))
    if not differing:
        same = ", ".join(f"{name}={letter}" for name, letter in versus.items())
        message = f"--versus {same}: that is how it is read anyway, so there is nothing to tell apart"
        raise ValueError(message)
    first, second = (_following(differing, assumed) for assumed in choices)
    one, other = (quotient(system, sketch, assumed) for assumed in choices)
    following = tuple(f"{name}={letter}" for name, letter in readings.items() if name not in versus)
    title = _title(system, sketch, (*following, f"{first} against {second}"))
    drawn = picture.of_contrast(
        title, one, other, (first, second), refusals=refusals, remarks=_asked(differing, choices)
    )
    letters = tuple("".join("-".join(one.possible(assumed)) for one in differing) for assumed in choices)
    stem = _stem(sketch.name, *following, *(one.id for one in differing), *letters)
    return Picture(system.name, sketch.name, stem, apart(drawn), tables.of_contrast(one, other, (first, second)))


def _following(ambiguities: Iterable[Ambiguity], assumed: int) -> str:
    return ", ".join(f"{one.id}={'|'.join(one.possible(assumed))}" for one in ambiguities)


def _asked(ambiguities: Iterable[Ambiguity], choices: Iterable[int]) -> tuple[str, ...]:
    """What is asked, and how each choice answers."""
    ambiguities = tuple(ambiguities)
    answers = (
        f"{_following([one], assumed)}: {' or '.join(one.readings[letter] for letter in one.possible(assumed))}"
        for assumed in choices
        for one in ambiguities
    )
    return (*(one.question for one in ambiguities), *answers)


def _title(system: System, sketch: Sketch, following: tuple[str, ...]) -> str:
    said = f", {', '.join(following)}" if following else ""
    return f"{system.name}: {sketch.title}{said}"


def _stem(name: str, *following: str) -> str:
    return "-".join((name, *(one.replace("=", "-").replace(", ", "-") for one in following)))
