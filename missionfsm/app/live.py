"""The reference of a system as something that lives: for many callers at a time, with a clock, and with a record.

The reference itself is pure and answers one request after the other. `Live` adds what a server needs around it: a lock,
listeners that are told what their streams show, a clock for timestamps, and the history of all that was seen, which
``missionfsm check`` judges.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Collection, Mapping

from attrs import evolve

from missionfsm.adapters.grpc.answers import Answered, Listener, Spoilt
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification
from missionfsm.kernel.system import System
from missionfsm.tools.reference.stamps import Stamps
from missionfsm.tools.reference.subject import ReferenceSubject

MAX_HISTORY_LINES = 100_000
"""Lines of the history that are kept; of a longer one the beginning is forgotten."""


class Live:
    """A reference for callers of several threads.

    Args:
        system: the system.
        world: the parameters of its world, as JSON; what is left out has its default.
        readings: ambiguity id to letter; the others follow their defaults.
        clock: seconds since the epoch of the reference, for timestamps.
        record: takes every line of the history as it happens.
        undriven: drives that come about in other ways as well, so that the history does not claim them.
        subject: the implementation that lives, where it is not the reference under `readings`.

    Raises:
        ValueError: a reading that does not exist.
        UnreadableError: the world is none.
    """

    def __init__(
        self,
        system: System,
        world: JSON = None,
        readings: Mapping[str, str] | None = None,
        *,
        clock: Callable[[], float],
        record: Callable[[JSON], None] = lambda _: None,
        undriven: Collection[str] = (),
        subject: ReferenceSubject | None = None,
    ) -> None:
        self.system = system
        self._lock = threading.RLock()
        self._record = record
        self._rules = system.spec.rules_by_id
        self._drives = [one for one in system.spec.drives if one not in undriven]
        self._listeners: dict[int, Listener] = {}
        self._calls = 0
        self._history: deque[JSON] = deque(maxlen=MAX_HISTORY_LINES)
        self._subject = subject or ReferenceSubject(system, readings, seconds=Stamps(clock))
        self.reset({} if world is None else world)

    def _note(self, line: JSON) -> None:
        self._history.append(line)
        self._record(line)

    def _pass_on(self, notifications: tuple[Notification, ...]) -> None:
        for one in notifications:
            stream = one.params.get("stream")
            self._note(one.params)
            listener = self._listeners.get(stream)
            if listener is not None:
                listener(one.params["message"])

    def _ask(self, method: str, params: JSON, spoilt: Spoilt | None = None) -> Exchange:
        self._calls += 1
        self._note({"call": self._calls, "method": method, "params": params})
        exchange = self._subject.exchange(method, params)
        if spoilt is not None and exchange.error is None:
            exchange = evolve(exchange, result=None, error=dict(spoilt.error))
        self._note({"return": self._calls, **_outcome(exchange)})
        return exchange

    def _answered(self, exchange: Exchange) -> Answered:
        if exchange.error is None:
            return Answered(exchange.result)
        rules = tuple(self._rules[rule] for rule in self._subject.rules)
        return Answered(None, exchange.error, tuple(rule.id for rule in rules), tuple(str(rule.cite) for rule in rules))

    def reset(self, world: JSON) -> None:
        """Begin anew in a world; every stream is forgotten. Raises UnreadableError for what is no world."""
        with self._lock:
            self.system.codec.read_world(world)
            self._subject.exchange("reset", {"world": world})
            self._listeners.clear()
            self._history.clear()
            self._note({"missionfsm": 1, "system": self.system.name, "world": world, "drives": self._drives})

    def call(self, method: str, params: JSON, spoilt: Spoilt | None = None) -> Answered:
        """Ask a documented call with one answer; what streams show of it is passed on before this returns.

        Args:
            spoilt: what the network makes of it. A call that is refused is answered so all the same.
        """
        with self._lock:
            if spoilt is not None and not spoilt.applied:
                return self._unasked(method, params, spoilt.error)
            exchange = self._ask(method, params, spoilt)
            self._pass_on((*exchange.before, *exchange.after))
            return self._answered(exchange)

    def _unasked(self, method: str, params: JSON, error: Mapping[str, str]) -> Answered:
        self._calls += 1
        self._note({"call": self._calls, "method": method, "params": params})
        self._note({"return": self._calls, "error": dict(error)})
        return Answered(None, error)

    def subscribe(self, method: str, params: JSON, listener: Listener, spoilt: Spoilt | None = None) -> Answered:
        """Open a documented stream; the result is its number.

        Args:
            listener: is given every message, the first before this returns.
            spoilt: how the network fails here, without an effect on the robot.
        """
        with self._lock:
            if spoilt is not None:
                return self._unasked(method, params, spoilt.error)
            exchange = self._ask(method, params)
            if exchange.error is None:
                stream = exchange.result["stream"]
                self._listeners[stream] = listener
                self._pass_on((*exchange.before, *exchange.after))
                return Answered(stream)
            return self._answered(exchange)

    def cancel(self, stream: int) -> None:
        """Give a stream up; one that is unknown or was forgotten is no error."""
        with self._lock:
            if self._listeners.pop(stream, None) is not None:
                self._calls += 1
                self._note({"call": self._calls, "method": "cancel", "params": {"stream": stream}})
                self._subject.exchange("cancel", {"stream": stream})
                self._note({"return": self._calls, "result": {}})

    def drive(self, event: JSON) -> JSON:
        """Make something happen, as the protocol's ``drive`` does.

        Raises:
            SubjectError: there is no such drive, or something of it is wrong.
        """
        with self._lock:
            exchange = self._subject.exchange("drive", event)
            if exchange.result["happened"]:
                self._note({"drive": {**event, **{k: v for k, v in exchange.result.items() if k != "happened"}}})
            self._pass_on((*exchange.before, *exchange.after))
            return exchange.result

    def history(self) -> tuple[JSON, ...]:
        """All that was seen since the last reset, as lines of the history format."""
        with self._lock:
            return tuple(self._history)


def _outcome(exchange: Exchange) -> dict[str, JSON]:
    return {"result": exchange.result} if exchange.error is None else {"error": exchange.error}
