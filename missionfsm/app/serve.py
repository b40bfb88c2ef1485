"""The reference of a Bear system as a real gRPC robot, for a test, a terminal or a client under development.

with missionfsm.serve("bear.mission") as robot:
    client = connect(robot.target)
    ...
    robot.drive("goalReached")
"""

from __future__ import annotations

import difflib
import json
import random
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from attrs import frozen

from missionfsm.app.asked import refuse_json_only
from missionfsm.app.live import Live
from missionfsm.bear.mission.codec import EPOCH
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.subject import SubjectError
from missionfsm.kernel.system import System
from missionfsm.kernel.text import brief
from missionfsm.systems import system as the_system
from missionfsm.tools.reference.stamps import Stamps
from missionfsm.tools.reference.subject import ReferenceSubject

if TYPE_CHECKING:
    from missionfsm.adapters.grpc.server import Server


@frozen
class Cue:
    """A drive that happens by itself, so many seconds after the cue before it."""

    after: float
    drive: JSON


def read_script(text: str, system: System) -> tuple[Cue, ...]:
    """A script: a JSON object a line, ``{"after": seconds, "drive": {"event": …}}``.

    Raises:
        UnreadableError: a line is none; the text says which and why.
    """
    cues = []
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip():
            try:
                cues.append(_cue(line, system))
            except (ValueError, RecursionError) as error:  # UnreadableError is one
                raise UnreadableError(f"line {number}: {error}") from None
    return tuple(cues)


def _cue(line: str, system: System) -> Cue:
    found = json.loads(line)
    if not isinstance(found, dict) or found.keys() - {"after", "drive"} or "drive" not in found:
        raise ValueError(f'{brief(found)} is not like {{"after": 1.5, "drive": {{"event": "goalReached"}}}}')
    after = found.get("after", 0)
    if isinstance(after, bool) or not isinstance(after, int | float) or not 0 <= after < float("inf"):
        raise ValueError(f"after: {brief(after)} is no number of seconds")
    system.codec.read_drive(found["drive"])
    return Cue(float(after), found["drive"])


def _by_itself(live: Live, seed: int) -> Callable[[], None]:
    """What a robot that nobody drives does next.

    A robot reaches its goals and ends what has none; of a fleet now one value is reported and now another.
    """
    if live.system.name == "bear.mission":

        def reach() -> None:
            if not live.drive({"event": "goalReached"})["happened"]:
                live.drive({"event": "missionSucceeded"})

        return reach
    chance = random.Random(seed)  # noqa: S311 - no secret
    world = live.history()[0]["world"]
    reports = [one for one in live.system.alphabet(world, Bounds()).drives if one.get("event") == "report"]

    def report() -> None:
        live.drive(chance.choice(reports))

    return report


class _Driver(threading.Thread):
    """Lets things happen in a thread of its own until it is told to stop."""

    def __init__(self, live: Live, script: Iterable[Cue], auto: float | None, seed: int) -> None:
        super().__init__(name="missionfsm-driver", daemon=True)
        self._live, self._script, self._auto = live, tuple(script), auto
        self._act = _by_itself(live, seed) if auto is not None else None
        self._over = threading.Event()

    def run(self) -> None:
        """Follow the script, then go on automatically."""
        for cue in self._script:
            if self._over.wait(cue.after):
                return
            self._live.drive(cue.drive)
        while self._act is not None and not self._over.wait(self._auto):
            self._act()

    def stop(self) -> None:
        """Let nothing more happen."""
        self._over.set()
        self.join()


class Served:
    """A robot, or a fleet, that is served over gRPC, as a test sees it.

    Attributes:
        target: what a client connects to, ``host:port``.
    """

    def __init__(self, live: Live, server: Server) -> None:
        self._live = live
        self._server = server
        self.target: str = server.target

    @property
    def port(self) -> int:
        """Where it listens."""
        return self._server.port

    def reset(self, world: JSON = None) -> None:
        """Begin anew in a world; every stream is forgotten. Raises UnreadableError for what is no world."""
        self._live.reset({} if world is None else world)

    def drive(self, event: str, **fields: JSON) -> bool:
        """Make something happen, such as ``drive("goalReached")``; False where it does not apply now.

        Raises:
            ValueError: there is no such drive, or its fields are wrong.
        """
        try:
            return bool(self._live.drive({"event": event, **fields})["happened"])
        except SubjectError as error:
            raise ValueError(str(error)) from None

    def call(self, method: str, params: JSON = None) -> JSON:
        """A call with one answer, as a client would make it, without the network: its result in protobuf JSON.

        Raises:
            ValueError: the call is refused; the text says with which code and why.
        """
        answered = self._live.call(method, {} if params is None else params)
        if answered.error is not None:
            raise ValueError(f"{method}: {answered.error['status']}: {answered.error.get('message', '')}")
        return answered.result

    def world(self, **fields: JSON) -> bool:
        """The world becomes another: the fields of the protocol, such as ``blocked=True``."""
        return self.drive("world", **fields)

    def fault(self, status: str, *, applied: bool = False) -> bool:
        """The next call that would succeed and whose Errors table has that status answers with it."""
        return self.drive("fault", status=status, **({"applied": applied} if applied else {}))

    def renew(self, token: str) -> None:
        """The token expires: from now on callers have to send this one, and streams that are open are ended.

        Raises:
            ValueError: it is served without a token.
        """
        self._server.renew(token)

    def history(self) -> tuple[JSON, ...]:
        """All that was seen since the last reset, as lines of the history format: ``missionfsm.check`` judges them."""
        return self._live.history()


def _seconds() -> float:
    """Now, as the reference counts seconds."""
    return time.time() - EPOCH.timestamp()


@contextmanager
def serve(  # noqa: PLR0913 - each with a default
    system: str = "bear.mission",
    *,
    host: str = "127.0.0.1",
    port: int = 0,
    world: JSON = None,
    readings: Mapping[str, str] | None = None,
    auto: float | None = None,
    script: Iterable[Cue] = (),
    faults: Iterable[str] = (),
    broken: str = "",
    seed: int = 0,
    certificate: str = "",
    key: str = "",
    token: str = "",
    control: bool = True,
    record: Callable[[JSON], None] = lambda _: None,
) -> Iterator[Served]:
    """Serve the reference over gRPC for as long as the ``with`` block lasts. Needs the extra ``grpc``.

    Args:
        system: ``bear.mission`` or ``bear.status``.
        host, port: where it listens; port 0 is any free one.
        world: its world, as in the adapter protocol; what is left out has its default.
        readings: ambiguity id to letter; the others follow their defaults.
        auto: every so many seconds something happens by itself: a goal is reached, a mission ends, a value is reported.
        script: what happens first.
        faults: what goes wrong on the network, such as ``deadline:0.05``; see `missionfsm.adapters.grpc.faults.Faults`.
        broken: the id of a rule that the robot breaks, with the kind of break that ``missionfsm teeth`` names after
            it, if it is not to be the first; "" for none. Readings are then those under which the rule is in force.
        seed: the same seed, the same faults.
        certificate, key: files in PEM, for TLS.
        token: what callers have to send as ``authorization: Bearer TOKEN``.
        control: whether the control service is there, for tests in other languages.
        record: takes every line of the history as it happens.

    Raises:
        ValueError: there is no such system, world, reading, fault or break, or the reading is one that only JSON says.
        OSError: it cannot listen there, or a file cannot be read.
        ModuleNotFoundError: the extra is not installed.
    """
    from missionfsm.adapters.grpc.faults import Faults  # noqa: PLC0415 - grpc is an extra
    from missionfsm.adapters.grpc.server import Security, Server  # noqa: PLC0415

    wrong = Faults.parse(faults)
    undriven = ("fault",) if wrong.deadline or wrong.unavailable or wrong.internal else ()
    served = _served(system)
    refuse_json_only(served, readings or {})
    subject = _mutant(served, broken, readings) if broken else None
    live = Live(served, world, readings, clock=_seconds, record=record, undriven=undriven, subject=subject)
    security = Security(certificate, key, token)
    with Server(live, host=host, port=port, faults=wrong, seed=seed, security=security, with_control=control) as server:
        driver = _Driver(live, script, auto, seed)
        driver.start()
        try:
            yield Served(live, server)
        finally:
            driver.stop()


def _mutant(system: System, name: str, readings: Mapping[str, str] | None) -> ReferenceSubject:
    """The reference with a rule broken, by the rule's id or the name that teeth gives the mutant."""
    from missionfsm.tools.mutate.mutants import mutants  # noqa: PLC0415 - few need it

    if readings:
        raise ValueError("what is broken has the readings under which its rule is in force, and no others")
    known = tuple(mutants(system))
    found = next((mutant for mutant in known if name in (mutant.rule, mutant.name)), None)
    if found is None:
        near = difflib.get_close_matches(name, [mutant.name for mutant in known], 1, 0)
        raise ValueError(f"--break {name}: no break has that name; is {near[0]!r} meant?")
    return found.subject(system, Stamps(_seconds))


def _served(name: str) -> System:
    from missionfsm.adapters.grpc.descriptors import SERVICES  # noqa: PLC0415 - as above

    if name not in SERVICES:
        raise ValueError(f"{brief(name)} is not served over gRPC; {' and '.join(SERVICES)} are")
    return the_system(name)


__all__: list[Any] = ["Cue", "Served", "read_script", "serve"]
