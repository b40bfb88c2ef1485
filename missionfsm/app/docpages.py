"""The computed parts of the pages in ``docs/``: what a reader copies is what the reference really says.

A computed part stands between ``<!-- generated: KIND WHAT -->`` and ``<!-- end -->``, as in ``specs/``. Kinds:

- ``session SYSTEM``: a session with the reference, line by line;
- ``history SYSTEM``: the same session as a history;
- ``calls SYSTEM``: every call with a request and the answer of the reference;
- ``messages SYSTEM``: every message with its members;
- ``world SYSTEM``: the default world;
- ``statuses``: the status names with their numbers;
- ``transport``: what may happen on the way from an implementation to a log of it.
"""

from __future__ import annotations

import io
import json
import re
from collections.abc import Iterator, Mapping

from missionfsm.adapters.stdio import serve
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.rules import STATUS_NUMBERS
from missionfsm.kernel.system import System
from missionfsm.kernel.transport import TRANSPORT
from missionfsm.systems import system as the_system
from missionfsm.tools.reference.subject import ReferenceSubject

_PART = re.compile(r"(<!-- generated: (\w+)(?: ([\w.]+))? -->\n).*?(<!-- end -->)", re.DOTALL)

Asked = tuple[str, JSON]
_DELIVERY = {"mission": {"serviMission": {"deliveryMission": {"goals": [{"destinationId": "table-1"}]}}}}
SESSIONS: Mapping[str, tuple[Asked, ...]] = {
    "bear.mission": (
        ("reset", {"world": {}}),
        ("SubscribeMissionStatus", {}),
        ("CreateMission", _DELIVERY),
        ("CreateMission", _DELIVERY),
        ("settle", {}),
        ("drive", {"event": "goalReached"}),
        ("settle", {}),
        ("cancel", {"stream": 1}),
    ),
}
"""System to what the session on its page asks, after ``initialize``."""
_OWN_METHODS = ("reset", "settle", "drive")
MAX_CELL = 160
"""Characters of an answer that are shown in a table."""
_EXAMPLE_ID = "mission-1"


def regenerate(text: str) -> str:
    """A page with its computed parts as they should be. Raises KeyError for a kind or a system that does not exist."""
    kinds = {
        "session": _session,
        "history": _history,
        "calls": _calls,
        "messages": _messages,
        "world": _world,
        "statuses": _statuses,
        "transport": _transport,
    }
    return _PART.sub(lambda part: f"{part[1]}\n{kinds[part[2]](part[3] or '')}\n\n{part[4]}", text)


def _fenced(kind: str, lines: Iterator[str]) -> str:
    return "\n".join((f"```{kind}", *lines, "```"))


def _talk(name: str) -> Iterator[tuple[bytes, list[bytes]]]:
    """The lines of a session: each request, and what the reference writes for it."""
    reference = ReferenceSubject(the_system(name))
    asked = (("initialize", {"protocolVersion": 1, "system": name}), *SESSIONS[name])
    for number, (method, params) in enumerate(asked, 1):
        request = json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params}).encode()
        written = io.BytesIO()
        serve(reference, io.BytesIO(request + b"\n"), written)
        yield request, written.getvalue().splitlines()


def _session(name: str) -> str:
    def lines() -> Iterator[str]:
        for request, answers in _talk(name):
            yield f"→ {request.decode()}"
            yield from (f"← {answer.decode()}" for answer in answers)

    return _fenced("text", lines())


def _history(name: str) -> str:
    def lines() -> Iterator[str]:
        drives = list(the_system(name).spec.drives)
        yield json.dumps({"missionfsm": 1, "system": name, "world": {}, "drives": drives})
        for request, answers in _talk(name):
            asked = json.loads(request)
            if asked["method"] not in ("initialize", *_OWN_METHODS):
                yield json.dumps({"call": asked["id"], "method": asked["method"], "params": asked["params"]})
            yield from map(json.dumps, _seen(asked, [json.loads(answer) for answer in answers]))

    return _fenced("jsonl", lines())


def _seen(asked: JSON, answers: list[JSON]) -> Iterator[JSON]:
    """What was asked and answered, as lines of a history."""
    for one in answers:
        if "method" in one:
            yield one["params"]
        elif asked["method"] == "settle":
            yield {"settled": True}
        elif asked["method"] == "drive":
            yield {"drive": asked["params"]}
        elif asked["method"] not in ("initialize", "reset"):
            error = one.get("error")
            outcome = (
                {"result": one["result"]}
                if error is None
                else {"error": {"status": error["data"]["status"], "message": error["message"]}}
            )
            yield {"return": asked["id"], **outcome}


def _calls(name: str) -> str:
    found = the_system(name)
    rows = ("| call | a request | its answer |", "| --- | --- | --- |")
    return "\n".join((*rows, *(_call(found, method) for method in found.codec.methods)))


def _call(found: System, method: str) -> str:
    """A row: the first request worth trying that succeeds, at once or after another call, and the answer."""
    alphabet = found.alphabet({}, Bounds())
    world = alphabet.worlds[0]
    tried = [prompt.params for prompt in (*alphabet.core_inputs, *alphabet.inputs) if prompt.method == method]
    for before in (None, *alphabet.core_inputs):
        for params in tried:
            reference = ReferenceSubject(found)
            reference.exchange("reset", {"world": world})
            if before is not None:
                if "$" in json.dumps(before.params):
                    continue
                reference.exchange(before.method, before.params)
            asked = json.loads(json.dumps(params).replace('"$name"', f'"{_EXAMPLE_ID}"'))
            if "$" in json.dumps(asked):
                continue
            exchange = reference.exchange(method, asked)
            if exchange.error is None:
                return f"| `{method}` | `{json.dumps(asked)}` | `{_cut(json.dumps(exchange.result))}` |"
    message = f"{found.name}: no request of {method} that is worth trying succeeds"
    raise AssertionError(message)


def _messages(name: str) -> str:
    """Every message that requests, answers and streams are made of; names as they are read, in their first form."""
    shapes = the_system(name).shapes()
    rows = [
        f"| {message} | {_members(schema)} |" for message, schema in shapes.definitions.items() if schema["properties"]
    ]
    return "\n".join(("| message | members |", "| --- | --- |", *rows))


def _members(schema: JSON) -> str:
    exclusive = {one for rule in schema.get("allOf", ()) for one in rule.get("not", {}).get("required", ())}
    members = [(one, _kind(kind)) for one, kind in schema["properties"].items() if "_" not in one]
    described = [f"`{one}` {kind}" for one, kind in members if one not in exclusive]
    *others, last = [f"`{one}` {kind}" for one, kind in members if one in exclusive] or [""]
    return ", ".join((*([f"one of {', '.join(others)} or {last}"] if others else []), *described))


def _kind(schema: JSON) -> str:
    """What a member is, in a few words: the first thing that its schema allows, which is how it is written best."""
    if "anyOf" in schema:
        return _kind(next(one for one in schema["anyOf"] if one != {"type": "null"}))
    if "$ref" in schema:
        return str(schema["$ref"].rpartition("/")[2])
    if "enum" in schema:
        return f"({', '.join(schema['enum'])})"
    if schema.get("type") == "array":
        return f"{_kind(schema['items'])}[]"
    kind = schema.get("type", "any")
    return kind if isinstance(kind, str) else str(kind[0])


def _cut(text: str) -> str:
    """A text that fits into a cell; of a long one the beginning."""
    return text if len(text) <= MAX_CELL else f"{text[:MAX_CELL]} …"


def _world(name: str) -> str:
    codec = the_system(name).codec
    return _fenced("json", iter((json.dumps(codec.write_world(codec.read_world({}))),)))


def _statuses(_: str) -> str:
    names = ", ".join(f"{number} {name}" for name, number in STATUS_NUMBERS.items())
    return f"The statuses are {names}."


def _transport(_: str) -> str:
    rows = [f"| `{one.id}` | {one.question} | {one.readings['b']} |" for one in TRANSPORT]
    return "\n".join(("| reading | question | what the log is explained by |", "| --- | --- | --- |", *rows))
