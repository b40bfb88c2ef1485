"""What an adapter says that it has, and a system with no more in it than that.

A tester asks for nothing that an adapter has not declared. Everything that it does is drawn from the alphabet of a
system, so it is the alphabet that is made smaller here, once, for whoever draws from it.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Collection, Iterable, Iterator
from typing import Any

from attrs import evolve, frozen

from missionfsm.kernel.alphabet import Alphabet, Bounds, ScriptStep
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.matrix import Matrix
from missionfsm.kernel.subject import Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.kernel.text import brief

PROTOCOL = 1


@frozen
class AdapterInfo:
    """What an adapter said of itself.

    Attributes:
        name: the name of the implementation, with its version.
        drives: the drives of the system that it has.
        methods: the documented calls that it has; None if it did not say, which means all.
        world: the only world that it has; None if it takes any.
        soft_reset: whether ids, numbers and things survive a reset.
        binary: whether requests travel as binary protobuf.
        silences: whether it takes a silence for a sign that everything has settled. Then messages may still be on their
            way, and it understands ``"patiently": true`` with ``settle``.
        unknown: calls and drives that it declared and the system does not have, in words, with what may be meant.
    """

    name: str
    drives: tuple[str, ...]
    methods: tuple[str, ...] | None = None
    world: JSON = None
    soft_reset: bool = False
    binary: bool = False
    silences: bool = False
    unknown: tuple[str, ...] = ()


def handshake(system: System, subject: Subject) -> AdapterInfo:
    """Initialize an adapter. Raises SubjectError if what it says is not of the protocol."""
    exchange = subject.exchange("initialize", {"protocolVersion": PROTOCOL, "system": system.name})
    result = exchange.result if isinstance(exchange.result, dict) else {}
    about = result.get("implementation")
    if not isinstance(about, dict) or not isinstance(about.get("name"), str):
        message = f"the adapter answered initialize without an implementation name: {brief(exchange.result)}"
        raise SubjectError(message)
    version = about.get("version")
    drives, methods = _names(result, "drives"), _names(result, "methods")
    return AdapterInfo(
        about["name"] + (f" {version}" if isinstance(version, str) else ""),
        tuple(one for one in drives or () if one in system.spec.drives),
        None if methods is None else tuple(one for one in system.codec.methods if one in methods),
        _fixed_world(system, result) if _declared(result, "worlds", "fixed") else None,
        _declared(result, "reset", "soft"),
        _declared(result, "requests", "binary"),
        _declared(result, "settles", "silence"),
        (
            *_unknown("drive", drives, system.spec.drives),
            *_unknown("method", methods, system.codec.methods),
        ),
    )


def _fixed_world(system: System, result: dict[str, Any]) -> JSON:
    """The one world that an adapter has."""
    if "world" not in result:
        message = 'the adapter answered initialize with "worlds": "fixed" and without the world that it has'
        raise SubjectError(message)
    try:
        system.codec.read_world(result["world"])
    except UnreadableError as error:
        message = f"the adapter answered initialize with a world that cannot be read: {error}"
        raise SubjectError(message) from None
    return result["world"]


def _names(result: dict[str, Any], member: str) -> list[str] | None:
    names = result.get(member)
    if names is not None and (not isinstance(names, list) or not all(isinstance(one, str) for one in names)):
        message = f"the adapter answered initialize with {member} {brief(names)}, not with a list of names"
        raise SubjectError(message)
    return names


def _unknown(kind: str, given: Iterable[str] | None, known: Iterable[str]) -> Iterator[str]:
    """What is not known, with what may be meant."""
    there = {one.lower(): one for one in known}
    for one in given or ():
        if one not in there.values():
            near = difflib.get_close_matches(one.lower(), there, 1)
            yield f"{kind} {brief(one)}" + (f" ({there[near[0]]} may be meant)" if near else "")


def _declared(result: dict[str, Any], member: str, value: str) -> bool:
    if result.get(member) not in (None, value):
        message = f'the adapter answered initialize with {member} {brief(result[member])}; there is only "{value}"'
        raise SubjectError(message)
    return result.get(member) == value


def offered(system: System, info: AdapterInfo, only: Collection[str] = (), without: Collection[str] = ()) -> System:
    """The system with no more in its alphabet than an adapter has.

    Args:
        system: the system.
        info: what the adapter said of itself.
        only: the calls to make; all if there are none.
        without: calls and drives to leave out.
    """
    methods = tuple(
        one
        for one in system.codec.methods
        if (info.methods is None or one in info.methods) and (not only or one in only) and one not in without
    )
    drives = tuple(one for one in info.drives if one not in without)

    def has(method: str, params: JSON) -> bool:
        if method not in methods or not isinstance(params, dict):
            return False
        return not info.binary or system.codec.carries(method, params)

    def alphabet(world: JSON, bounds: Bounds) -> Alphabet:
        whole = system.alphabet(world, bounds)
        worlds = whole.worlds if info.world is None else (info.world,)
        return evolve(
            whole,
            inputs=tuple(one for one in whole.inputs if has(one.method, one.params)),
            core_inputs=tuple(one for one in whole.core_inputs if has(one.method, one.params)),
            drives=tuple(one for one in whole.drives if one["event"] in drives),
            core_drives=tuple(one for one in whole.core_drives if one["event"] in drives),
            worlds=worlds,
            look=whole.look if whole.look and whole.look.method in methods else None,
            scripts=tuple(script for one in whole.scripts if (script := _possible(one, drives, has))),
            apart=tuple(script for one in whole.apart if (script := _possible(one, drives, has))),
        )

    streams = tuple(one for one in system.codec.streams if one in methods)
    matrix = system.matrix and _reached(system.matrix, system, drives, has)
    codec = evolve(system.codec, methods=methods, streams=streams)
    return evolve(system, alphabet=alphabet, codec=codec, matrix=matrix)


Has = Callable[[str, JSON], bool]
"""(call, params) → whether an adapter has it."""


def _reached(matrix: Matrix, system: System, drives: tuple[str, ...], has: Has) -> Matrix | None:
    """The matrix, with the ways that an adapter can go; None if the implementation moves by itself."""
    if any(drive.by_itself and name not in drives for name, drive in system.spec.drives.items()):
        return None  # while it moves by itself, its situation is seldom sure
    ways = {
        situation: tuple(way for way in ways if _possible(way, drives, has) == way)
        for situation, ways in matrix.ways.items()
    }
    pause = matrix.pause and (matrix.pause if _possible((matrix.pause,), drives, has) else None)
    return evolve(matrix, ways=ways, pause=pause)


def _possible(script: tuple[ScriptStep, ...], drives: tuple[str, ...], has: Has) -> tuple[ScriptStep, ...]:
    """A script up to the first step that an adapter does not have."""
    done = []
    for line in script:
        if line.method == "drive":
            possible = line.params["event"] in drives
        else:
            possible = line.method in ("settle", "cancel") or has(line.method, line.params)
        if not possible:
            break
        done.append(line)
    return tuple(done)
