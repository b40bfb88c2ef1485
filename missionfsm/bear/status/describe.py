"""The values of the status API in words, for people: short, and never a whole state where a difference will do."""

from __future__ import annotations

from missionfsm.bear.status.messages import ErrorCodes
from missionfsm.bear.status.state import GET, Event, Fleet, Request
from missionfsm.bear.status.values import brief_value
from missionfsm.bear.status.views import BLANK, Promised, Seen, View
from missionfsm.bear.wire.protojson import camel
from missionfsm.kernel.text import brief


def describe(value: object) -> str:
    """A request, a state, a view, a message or an event in a few words."""
    if isinstance(value, Request):
        return _request(value)
    if isinstance(value, Fleet):
        fault = ", a fault armed" if value.fault else ""
        return f"{len(value.robots)} robots at {len(value.locations)} locations{fault}"
    if isinstance(value, View):
        return f"{value.robot}: {_view(value)}"
    if isinstance(value, Seen):
        return f"{value.robot}: {brief_value(value.value)}"
    if isinstance(value, Promised):
        return str(value)
    if isinstance(value, Event):
        return _event(value)
    return str(value)


def _view(value: View) -> str:
    if value.unheard:
        return "any state"
    nothing_known = value.value not in (None, ErrorCodes()) and value.value == BLANK.get(value.endpoint)
    return "UNKNOWN values" if nothing_known else brief_value(value.value)


def _request(request: Request) -> str:
    if request.malformed:
        return f"{request.operation}(malformed: {request.malformed})"
    if request.operation == GET:
        return f"{GET}({brief(request.ids[0]) if request.ids else ''})"
    parts = []
    if request.by_ids:
        ids = ", ".join(map(brief, request.ids))
        parts.append(f"robots {ids or 'none'}{', one of them twice' if request.repeated else ''}")
    if request.bare:
        parts.append("in a bare list")
    if request.location is not None:
        parts.append(f"location {brief(request.location)}")
    if request.unknown_fields:
        parts.append("an unknown field")
    return f"{request.operation}({'; '.join(parts)})"


def _event(event: Event) -> str:
    if event.name == "report":
        return f"{event.robot} reports {camel(event.part)} {brief_value(event.value)}"
    if event.name == "move":
        return f"{event.robot} moves to {event.value}"
    if event.name == "fault":
        return f"fault {event.value}"
    return f"{event.robot} restarts"


__all__ = ["describe"]
