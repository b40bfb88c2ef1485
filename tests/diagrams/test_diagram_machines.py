"""Lifecycles as machines: SCXML is what its schema says, and every interpreter moves as the chart does."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import sys
from collections.abc import Callable, Iterable, Iterator
from types import ModuleType
from typing import Any

import attrs
import pytest

from missionfsm.kernel.chart import Chart
from missionfsm.tools.draw.diagram import state_name
from missionfsm.tools.draw.gallery import FORMATS, Picture
from missionfsm.tools.draw.machines import event

Successors = dict[str, dict[str, str]]


def of_chart(chart: Chart[object]) -> Successors:
    """Where every event leads from every state; an event that is no move changes nothing."""
    return {
        state_name(state): {
            event(trigger): state_name(state if after is None else after)
            for trigger in chart.triggers
            for after in [chart.after(trigger, state)]
        }
        for state in chart.states
    }


def walked(run: Callable[[list[str]], str], events: Iterable[str]) -> Successors:
    """Where every event leads from every state; `run` sends events to a fresh machine and says where it is then."""
    events = tuple(events)
    moves: Successors = {}
    paths: dict[str, list[str]] = {run([]): []}
    todo = list(paths)
    for state in todo:  # grows while it is walked
        moves[state] = {}
        for one in events:
            after = run([*paths[state], one])
            moves[state][one] = after
            if after not in paths:
                paths[after] = [*paths[state], one]
                todo.append(after)
    return moves


def test_triggers_are_told_apart(charts: dict[str, Picture]) -> None:
    """No two triggers of a chart become one event."""
    for name, one in charts.items():
        assert one.chart is not None
        assert len(set(map(event, one.chart.triggers))) == len(one.chart.triggers), name


def test_scxml_moves_as_the_chart_does(charts: dict[str, Picture]) -> None:
    """An interpreter in Python that passes the W3C's tests, sent every event in every state."""
    statemachine = pytest.importorskip("statemachine", reason="python-statemachine is not installed")
    processor = importlib.import_module("statemachine.io.scxml.processor")

    def machine(text: str) -> Callable[[list[str]], str]:
        def run(events: list[str]) -> str:
            fresh = processor.SCXMLProcessor()
            fresh.parse_scxml("chart", text)
            running = fresh.start()
            for one in events:
                if not running.is_terminated:
                    # Events are methods there as well, and one of ours is called "send".
                    statemachine.StateChart.send(running, one)
            (state,) = running.configuration
            return str(state.id)

        return run

    for name, one in charts.items():
        assert one.chart is not None
        text = FORMATS["scxml"].write(one)
        assert text is not None
        assert walked(machine(text), map(event, one.chart.triggers)) == of_chart(one.chart), name


@pytest.mark.parametrize("form", ["scxml", "xstate"])
def test_interpreters_in_javascript_move_as_the_chart_does(
    form: str, readers: dict[str, dict[str, Any]], charts: dict[str, Picture]
) -> None:
    """SCION runs the SCXML and XState its configuration; each was sent every event in every state."""
    for name, one in charts.items():
        assert one.chart is not None
        assert readers[form][name] == of_chart(one.chart), name


def schema() -> ModuleType:
    """The types that scjson has generated from the W3C's strict schema, without the rest of it."""
    pytest.importorskip("xsdata", reason="xsdata is not installed, which reads XML by a schema")
    try:
        found = importlib.metadata.distribution("scjson")
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("scjson is not installed, which carries the W3C's schema of SCXML")
    place = found.locate_file("scjson/dataclasses_strict/generated.py")
    spec = importlib.util.spec_from_file_location("scxml_schema", str(place))
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def foreign(node: object) -> Iterator[object]:
    """What a document holds that the schema does not name: it lets in elements and attributes of other namespaces."""
    fields = getattr(node, "__dataclass_fields__", {})
    for name in fields:
        value = getattr(node, name)
        if name in ("other_element", "other_attributes"):
            yield from value
        for part in value if isinstance(value, list) else [value]:
            yield from foreign(part)


@pytest.fixture(scope="module")
def validate() -> Callable[[str], list[object]]:
    """Read SCXML by its schema; what it holds besides, which has to be nothing. Raises what xsdata raises."""
    types = schema()
    parsers = importlib.import_module("xsdata.formats.dataclass.parsers")
    config = importlib.import_module("xsdata.formats.dataclass.parsers.config")
    strict = config.ParserConfig(
        fail_on_unknown_properties=True, fail_on_unknown_attributes=True, fail_on_converter_warnings=True
    )
    return lambda text: list(foreign(parsers.XmlParser(config=strict).from_string(text, types.Scxml)))


def test_scxml_is_valid(validate: Callable[[str], list[object]], charts: dict[str, Picture]) -> None:
    """Every document is read by the types of the W3C's schema without anything left over."""
    for name, one in charts.items():
        text = FORMATS["scxml"].write(one)
        assert text is not None
        assert validate(text) == [], name


@pytest.mark.parametrize(
    ("wrong", "right"),
    [("<final id=", "<end id="), ("target=", "to="), ('version="1.0"', 'version="1.0" binding="never"')],
)
def test_what_is_no_scxml_is_noticed(
    wrong: str, right: str, validate: Callable[[str], list[object]], charts: dict[str, Picture]
) -> None:
    """An element, an attribute or a value that the schema does not know does not pass."""
    text = str(FORMATS["scxml"].write(charts["bear.mission/mission"]))
    assert wrong in text
    try:
        left = validate(text.replace(wrong, right))
    except ValueError as error:
        left = [error]
    assert left


def test_walk_notices_another_move(charts: dict[str, Picture]) -> None:
    """A machine with one move less does not pass for its chart."""
    chart = charts["bear.mission/mission"].chart
    assert chart is not None
    less = attrs.evolve(chart, table=chart.table[:-1])
    assert of_chart(less) != of_chart(chart)
