"""A lifecycle as a machine that runs: SCXML for the interpreters of the W3C's notation, JSON for XState.

Only charts are deterministic: in a quotient one call leads to several states, and which of them no machine can tell.
"""

from __future__ import annotations

import json
import re
from xml.etree import ElementTree as ET

from missionfsm.kernel.chart import Chart
from missionfsm.tools.draw.diagram import state_name

NAMESPACE = "http://www.w3.org/2005/07/scxml"


def event(trigger: str) -> str:
    """A trigger as the name of an event: one token."""
    return re.sub(r"\W+", "-", trigger).strip("-")


def scxml(name: str, chart: Chart[object]) -> str:
    """The chart as SCXML."""
    root = ET.Element(
        "scxml",
        {
            "xmlns": NAMESPACE,
            "version": "1.0",
            "datamodel": "null",
            "name": name,
            "initial": state_name(chart.initial),
        },
    )
    for about, note in chart.notes.items():
        root.append(ET.Comment(f" {about}: {note} "))
    for state in chart.states:
        node = ET.SubElement(root, "final" if state in chart.final else "state", {"id": state_name(state)})
        for trigger, source, target in chart.table:
            if source == state:
                ET.SubElement(node, "transition", {"event": event(trigger), "target": state_name(target)})
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def xstate(name: str, chart: Chart[object]) -> str:
    """The chart as the configuration of an XState machine."""
    states: dict[str, object] = {}
    for state in chart.states:
        moves = {
            event(trigger): {"target": state_name(target), "description": _said(chart, trigger)}
            for trigger, source, target in chart.table
            if source == state
        }
        states[state_name(state)] = {"on": moves} if moves else {"type": "final"}
    found = {"id": name, "initial": state_name(chart.initial), "states": states}
    return json.dumps(found, indent=2, ensure_ascii=False) + "\n"


def _said(chart: Chart[object], trigger: str) -> str:
    return f"{trigger} ({chart.notes[trigger]})" if trigger in chart.notes else trigger
