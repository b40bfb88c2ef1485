"""JSON Schemas of every line of the adapter protocol and of the history format: for one system, or for any.

A well-formed line of either format is valid under its schema; `$defs` names the parts, so that the schema of requests
or of messages can be used by itself. Malformed requests are sent on purpose, to see that they are refused, so params of
a documented call may be any object; what a well-formed one looks like stands in `$defs` as ``CALL request``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.rules import OK, STATUS_NUMBERS
from missionfsm.kernel.shapes import BOOLEAN, NUMBER, OBJECT, TEXT, Shapes, record
from missionfsm.kernel.system import System

FORMATS = ("adapter", "history")
_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_TEXTS = {"type": "array", "items": TEXT}
_ID = {"type": ["integer", "string"]}
_NULL = {"type": "null"}
_NUMBER = {"type": "integer"}
_STATUS = {"enum": [name for name in STATUS_NUMBERS if name != OK]}
_SAID = record({"status": _STATUS, "message": TEXT}, ("status",), more=True)


def schema(which: str, system: System | None = None) -> dict[str, JSON]:
    """The schema of a line.

    Args:
        which: ``adapter`` (every line in both directions) or ``history``.
        system: whose worlds, drives, calls and messages are described; of any system where it is None.
    """
    shapes = Shapes() if system is None else system.shapes()
    lines = (_adapter if which == "adapter" else _history)(system, shapes)
    about = "any system" if system is None else system.name
    return {
        "$schema": _DIALECT,
        "title": f"a line of the {which} {'protocol' if which == 'adapter' else 'format'}, version 1, for {about}",
        "anyOf": [{"$ref": f"#/$defs/{name}"} for name in lines],
        "$defs": {
            **lines,
            **{f"{method} request": one for method, one in shapes.requests.items()},
            **shapes.definitions,
        },
    }


def _any_of(found: Iterable[object], otherwise: object = OBJECT) -> object:
    """One of several schemas; another where there are none."""
    several = list(found)
    return {"anyOf": several} if len(several) > 1 else several[0] if several else otherwise


def _results(shapes: Shapes, *others: object) -> object:
    """What any call may answer with."""
    return _any_of((*shapes.results.values(), *others)) if shapes.results else OBJECT


def _rpc(fields: Mapping[str, object], required: tuple[str, ...]) -> dict[str, Any]:
    return record({"jsonrpc": {"const": "2.0"}, **fields}, ("jsonrpc", *required))


def _request(method: object, params: object) -> dict[str, Any]:
    return _rpc({"id": _ID, "method": method, "params": params}, ("id", "method", "params"))


def _notification(method: str, params: object) -> dict[str, Any]:
    return _rpc({"method": {"const": method}, "params": params}, ("method", "params"))


def _adapter(system: System | None, shapes: Shapes) -> dict[str, Any]:
    name = TEXT if system is None else {"const": system.name}
    calls = TEXT if system is None else {"enum": [*system.codec.methods]}
    world = shapes.world or OBJECT
    declared = record(
        {
            "implementation": record({"name": TEXT, "version": TEXT}, ("name",), more=True),
            "drives": _TEXTS,
            "concurrent": BOOLEAN,
            "methods": _TEXTS,
            "worlds": {"const": "fixed"},
            "world": world,
            "reset": {"const": "soft"},
            "requests": {"const": "binary"},
        },
        ("implementation",),
        more=True,
    )
    extra = {key: schema for fields in shapes.happened.values() for key, schema in fields.items()}
    own = (declared, record({"happened": BOOLEAN, **extra}, ("happened",)), _STREAM, record({}))
    error = record(
        {"code": _NUMBER, "message": TEXT, "data": {"anyOf": [_SAID, {"type": "null"}]}}, ("code", "message")
    )
    return {
        "initialize": _request(
            {"const": "initialize"},
            record({"protocolVersion": {"const": 1}, "system": name}, ("protocolVersion", "system"), more=True),
        ),
        "reset": _request({"const": "reset"}, record({"world": world}, more=True)),
        "settle": _request({"const": "settle"}, OBJECT),
        "drive": _request({"const": "drive"}, _any_of(shapes.drives.values())),
        "cancel": _request({"const": "cancel"}, _STREAM),
        "call": _request(calls, OBJECT),
        "answer": _rpc({"id": _ID, "result": _results(shapes, *own), "error": _NULL}, ("id", "result")),
        "refusal": _rpc({"id": _ID, "error": error, "result": _NULL}, ("id", "error")),
        **_notifications(system, shapes),
    }


_STREAM = record({"stream": _NUMBER}, ("stream",))


def _notifications(system: System | None, shapes: Shapes) -> dict[str, Any]:
    found = {}
    ended = {"error": _SAID}
    if system is None or system.codec.streams:
        shown = _any_of(shapes.messages)
        found["message"] = _notification(
            "message", record({"stream": _NUMBER, "message": shown}, ("stream", "message"))
        )
        found["closed stream"] = _notification("closed", record({"stream": _NUMBER, **ended}, ("stream",)))
    if system is None or shapes.lines:
        fields = {"connection": _NUMBER, "line": TEXT}
        needed = ("connection", "line") if shapes.connections else ("line",)
        found["line"] = _notification("line", record(fields, needed))
        found["closed connection"] = _notification("closed", record({"connection": _NUMBER, **ended}))
    return found


def _history(system: System | None, shapes: Shapes) -> dict[str, Any]:
    calls = TEXT if system is None else {"enum": [*system.codec.methods, "cancel"]}
    first = {
        "missionfsm": {"const": 1},
        "system": TEXT if system is None else {"const": system.name},
        "world": shapes.world or OBJECT,
        "drives": _TEXTS,
        "begins": {"const": "anywhere"},
        "others": {"type": "boolean"},
        "transport": {"const": "strict"},
    }

    def line(fields: dict[str, Any], *required: str) -> dict[str, Any]:
        return record({**fields, "at": NUMBER, "robot": TEXT}, required)

    result = _results(shapes, _STREAM, record({}))
    drive = _any_of(shapes.drives.values())
    found = {
        "first line": record(first, ("missionfsm", "system"), more=True),
        "call": line({"call": _ID, "method": calls, "params": OBJECT}, "call", "method"),
        "return": line({"return": _ID, "result": result, "error": _NULL}, "return", "result"),
        "refused return": line({"return": _ID, "error": _SAID, "result": _NULL}, "return", "error"),
        "drive": line({"drive": drive}, "drive"),
        "settled": line({"settled": {"const": True}}, "settled"),
    }
    if system is None or system.codec.streams:
        found["message"] = line({"stream": _NUMBER, "message": _any_of(shapes.messages)}, "stream", "message")
        found["closed stream"] = line(
            {"stream": _NUMBER, "closed": {"const": True}, "error": _SAID}, "stream", "closed"
        )
    if system is None or shapes.lines:
        found["line"] = line({"connection": _NUMBER, "line": TEXT}, "line")
        found["closed connection"] = line({"connection": _NUMBER, "closed": {"const": True}}, "closed")
    return found
