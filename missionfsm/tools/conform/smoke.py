"""The first minutes of an adapter: each method once, each shape looked at, each fault in one line with its remedy.

Whether what is answered is right is not asked here: that is what `conform` finds out.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterator

from attrs import define, field, frozen

from missionfsm.kernel.alphabet import Alphabet
from missionfsm.kernel.codec import JSON, Malformed, UnreadableError
from missionfsm.kernel.rules import STATUS_NUMBERS
from missionfsm.kernel.subject import Exchange, MissingMethodError, Notification, Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.kernel.text import brief
from missionfsm.tools.conform.handshake import AdapterInfo, handshake, offered
from missionfsm.tools.conform.run import BOUNDS
from missionfsm.tools.placeholders import is_template

ADVICE = (
    (re.compile(r"did not answer|did not read"), "flush stdout after every line, and answer every request"),
    (re.compile(r"a line that is"), "write nothing but the protocol to stdout: logs go to stderr"),
    (re.compile(r"no notification of the protocol"), "answers carry the id of their request; messages have no id"),
    (re.compile(r"instead of"), "answer each request with its own id, in order"),
    (
        re.compile(r"without a result or an error"),
        "answer with a result, {} if nothing else, or an error",
    ),
    (re.compile(r"exited|was ended|closed its output"), "answer, and exit only at the end of stdin"),
    (re.compile(r"without an implementation name"), 'answer with {"implementation": {"name": …}, "drives": […]}'),
)
"""What to change, by what is said of a failure."""

_NOT_GRPC = re.compile(r"with error (-?\d+), status .([A-Z_]+).: not a gRPC error")


@frozen
class Smoke:
    """What came of it.

    Attributes:
        name: the implementation's; empty where it has not said.
        tried: what was asked, in order.
        faults: what is not of the protocol, each in a line.
        left: what could still be done: calls and drives that are not there.
    """

    system: str
    name: str
    tried: tuple[str, ...]
    faults: tuple[str, ...]
    left: tuple[str, ...]

    @property
    def is_adapter(self) -> bool:
        """Whether `conform` can judge what is behind it."""
        return not self.faults

    def __str__(self) -> str:
        says = f"is an adapter of {self.system}" if self.is_adapter else f"is no adapter of {self.system} yet"
        tried = self.tried[0] if len(self.tried) == 1 else f"{len(self.tried)} methods and drives"
        lines = [f"{self.name or 'the program'} {says}: {tried} tried"]
        lines += (f"  fault: {one}" for one in self.faults)
        lines += (f"  to do: {one}" for one in self.left)
        return "\n".join(lines)

    def to_json(self) -> JSON:
        """The same for machines."""
        return {
            "adapter": self.is_adapter,
            "system": self.system,
            "implementation": self.name,
            "tried": list(self.tried),
            "faults": list(self.faults),
            "left": list(self.left),
        }


def smoke(system: System, begin: Callable[[], Subject]) -> Smoke:
    """Ask an adapter for everything once, but for drives that need a name which it has yet to give.

    Args:
        begin: starts it; once more after each failure. Raises SubjectError where it cannot be started.
    """
    found = _Smoke(system, begin)
    try:
        found.run()
    finally:
        found.end()
    name = found.info.name if found.info else ""
    return Smoke(system.name, name, tuple(found.tried), tuple(found.faults), tuple(found.left))


@define(eq=False)
class _Smoke:
    system: System
    begin: Callable[[], Subject]
    info: AdapterInfo | None = None
    subject: Subject | None = None
    asked: str = ""
    tried: list[str] = field(factory=list)
    faults: list[str] = field(factory=list)
    left: list[str] = field(factory=list)

    def end(self) -> None:
        """Let go of the adapter."""
        subject, self.subject = self.subject, None
        if subject is not None:
            subject.close()

    def run(self) -> None:
        """Ask for everything."""
        if not self._try("initialize", lambda: None):
            return
        assert self.info is not None  # noqa: S101 - initialize was answered
        self.faults += (f"initialize declares {one}, which is not known" for one in self.info.unknown)
        given = offered(self.system, self.info)
        alphabet = given.alphabet({}, BOUNDS)
        if not self._try("reset", lambda: self._empty("reset", {"world": alphabet.worlds[0]})):
            return
        self._try("settle", lambda: self._empty("settle", {}))
        self._try_calls(given, alphabet)
        self._try_drives(self.info, alphabet)
        missing = [one for one in self.system.codec.methods if one not in given.codec.methods]
        self.left += (f"{one} is not there: calls that are left out are not judged" for one in missing)
        drives = [one for one in self.system.spec.drives if one not in self.info.drives]
        self.left += (f"the drive {one} is not there: rules that need it are not tested" for one in drives)

    def _try_calls(self, given: System, alphabet: Alphabet) -> None:
        """Every call once, with the first params that need no names."""
        for method in given.codec.methods:
            prompts = (*alphabet.core_inputs, *alphabet.inputs)
            fitting = (one.params for one in prompts if one.method == method and not is_template(one.params))
            self._try(method, functools.partial(self._call, alphabet.worlds[0], method, next(fitting, {})))

    def _try_drives(self, info: AdapterInfo, alphabet: Alphabet) -> None:
        """Every drive once of which there is an example that needs no names."""
        for name in info.drives:
            event = next((one for one in alphabet.drives if one["event"] == name and not is_template(one)), None)
            if event is not None:
                self._try(f"drive {name}", functools.partial(self._drive, alphabet.worlds[0], event))

    def _try(self, what: str, ask: Callable[[], None]) -> bool:
        """Ask for something of an adapter that runs; whether it was answered as the protocol says."""
        self.tried.append(what)
        try:
            if self.subject is None:
                self.subject = self.begin()
                self.info = handshake(self.system, self.subject)
            ask()
        except MissingMethodError:
            if self.asked in self.system.codec.methods and self.info is not None and self.info.methods is None:
                self.left.append(f'{what} is not there (error -32601): add it, or declare "methods" without it')
                return True
            self.faults.append(f"{what}: {self.asked} was asked and JSON-RPC error -32601 came; add that method")
        except SubjectError as error:
            self.faults.append(f"{what}: {error}{_advice(str(error))}")
            self.end()
        except UnreadableError as error:
            self.faults.append(f"{what}: what was sent cannot be read: {error}")
        else:
            return True
        return False

    def _ask(self, method: str, params: JSON) -> Exchange:
        assert self.subject is not None  # noqa: S101 - it was begun
        self.asked = method
        exchange = self.subject.exchange(method, params)
        for one in (*exchange.earlier, *exchange.before, *exchange.after):
            self._look(one)
        return exchange

    def _empty(self, method: str, params: JSON) -> None:
        exchange = self._ask(method, params)
        if exchange.error is not None or exchange.result != {}:
            came = exchange.result if exchange.error is None else f"error {exchange.error['status']}"
            self.faults.append(f"{method}: {{}} was expected and {brief(came)} came; answer with an empty object")

    def _begun(self, world: JSON) -> None:
        exchange = self._ask("reset", {"world": world})
        if exchange.error is not None:
            message = f"the adapter answered reset with {exchange.error['status']}"
            raise SubjectError(message)

    def _call(self, world: JSON, method: str, params: JSON) -> None:
        self._begun(world)
        exchange = self._ask(method, params)
        if exchange.error is None:
            shape = self.system.codec.read_answer(method, exchange.result)[0].shape
            if isinstance(shape, Malformed):
                self.faults.append(f"{method}: {brief(exchange.result)} came, which is no answer to it: {shape.says}")
        self._empty("settle", {})
        if exchange.error is None and method in self.system.codec.streams:
            self._empty("cancel", {"stream": exchange.result["stream"]})

    def _drive(self, world: JSON, event: JSON) -> None:
        self._begun(world)
        exchange = self._ask("drive", event)
        came = exchange.result if exchange.error is None else f"error {exchange.error['status']}"
        if not isinstance(came, dict) or not isinstance(came.get("happened"), bool):
            expected = '{"happened": true} or {"happened": false}'
            self.faults.append(f"drive {event['event']}: {expected} was expected and {brief(came)} came")
        self._empty("settle", {})

    def _look(self, one: Notification) -> None:
        """Look at the shape of a message."""
        if one.method != "message":
            return
        for says in self._wrong(one.params["message"]):
            fault = f"a message on stream {one.params['stream']} is malformed: {says}"
            if fault not in self.faults:
                self.faults.append(fault)

    def _wrong(self, message: JSON) -> Iterator[str]:
        for _, _, rest in self.system.codec.split_message(message):
            content = self.system.codec.read_content(rest)
            if isinstance(content, Malformed):
                yield content.says


def _advice(says: str) -> str:
    """What to change about a failure, if that is known."""
    wrong = _NOT_GRPC.search(says)
    if wrong:
        code, status = int(wrong[1]), wrong[2]
        name = next((one for one, number in STATUS_NUMBERS.items() if number == code), None)
        right = f"code {STATUS_NUMBERS[status]} for {status}" if status in STATUS_NUMBERS else "a status of gRPC"
        return f"; send {right}" + (f", or status {name} for code {code}" if name else "")
    return next((f"; {advice}" for pattern, advice in ADVICE if pattern.search(says)), "")
