"""One conversation with a live implementation, judged as it goes, in a form that can be had again.

What is done is a list of `Action`s. Names are not in it: an action refers to a name by the action that gave it, so that
the same list makes sense with a fresh instance, and with some of its actions left out.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from attrs import frozen

from missionfsm.kernel.alphabet import ANY_NAME
from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.rules import OK
from missionfsm.kernel.subject import Exchange, GibberishError, Notification, Subject, SubjectError
from missionfsm.kernel.system import System
from missionfsm.kernel.text import brief
from missionfsm.oracle.belief import Automaton
from missionfsm.oracle.transcript import STREAM_KEYS, Head
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.placeholders import fill, is_template

PROTOCOL = 1
WRONG_NAME = "no-such-name"
_Read = TypeVar("_Read")


@frozen
class Introduced:
    """What an adapter said of itself."""

    name: str
    drives: tuple[str, ...]


def introduce(system: System, subject: Subject) -> Introduced:
    """Initialize an adapter. Raises SubjectError if what it says is not of the protocol."""
    exchange = subject.exchange("initialize", {"protocolVersion": PROTOCOL, "system": system.name})
    result = exchange.result if isinstance(exchange.result, dict) else {}
    about = result.get("implementation")
    drives = result.get("drives", [])
    if not isinstance(about, dict) or not isinstance(about.get("name"), str):
        message = f"the adapter answered initialize without an implementation name: {brief(exchange.result)}"
        raise SubjectError(message)
    if not isinstance(drives, list) or not all(isinstance(one, str) for one in drives):
        message = f"the adapter answered initialize with drives {brief(drives)}"
        raise SubjectError(message)
    known = tuple(one for one in drives if one in system.spec.drives)
    version = about.get("version")
    return Introduced(about["name"] + (f" {version}" if isinstance(version, str) else ""), known)


@frozen
class Given:
    """A name, as the position-th that the action with a serial number was answered with."""

    by: int
    position: int


Picks = tuple[tuple[int, Given], ...]
"""For slots of a template the names that are meant."""


@frozen
class Action:
    """Something that a tester does.

    Attributes:
        serial: tells it from the others of its conversation.
        method: a documented call, or ``drive``, ``settle``, ``cancel``.
        params: its JSON, with `ANY_NAME` where `name` goes.
        name: the name that is meant: one that was given, or a text that nothing is called.
        picks: for each slot of the params (see `missionfsm.kernel.alphabet.pick`) the name that was given; a slot that
            is not here gets a name that is never anything's.
    """

    serial: int
    method: str
    params: JSON = None
    name: Given | str | None = None
    picks: Picks = ()


def filled(params: JSON, name: object) -> JSON:
    """Params with a name in place of every `ANY_NAME`."""
    if params == ANY_NAME:
        return name
    if isinstance(params, dict):
        return {key: filled(value, name) for key, value in params.items()}
    return [filled(value, name) for value in params] if isinstance(params, list) else params


class Conversation:
    """One conversation with a subject, from a reset on.

    Raises:
        SubjectError: the adapter failed; so does everything that it is asked.
    """

    def __init__(self, system: System, subject: Subject, about: Introduced, world: JSON, automaton: Automaton) -> None:
        self.system = system
        self.subject = subject
        self.world = world
        first = Head(system.name, world, about.drives, strict=True)
        self.judge = Judge(system, first, automaton, keep=1_000_000, waits=False)
        self.actions: list[Action] = []
        self.given: dict[Given, object] = {}
        self._acting = self._learnt = 0
        self._asked = ""
        self.succeeded = 0
        # What was still under way before a reset belongs to nobody.
        self._notifications(self._result("reset", {"world": world}).after)

    @property
    def right(self) -> bool:
        """Whether everything so far is explained."""
        return self.judge.right

    def perform(self, action: Action) -> bool:
        """Do something; False once the conversation cannot be explained any more."""
        self.actions.append(action)
        name = self.given.get(action.name, WRONG_NAME) if isinstance(action.name, Given) else action.name
        params = action.params if action.name is None else filled(action.params, name)
        if is_template(params):
            picked = {slot: self.given[given] for slot, given in action.picks if given in self.given}
            params = fill(params, picked, self.system.naming, action.serial, self.given.values())
        self._acting, self._learnt = action.serial, 0
        if action.method == "settle":
            self._settle()
        elif action.method == "drive":
            self._drive(params)
        else:
            self._call(action.serial, action.method, params)
        return self.right

    def _call(self, number: int, method: str, params: JSON) -> None:
        exchange = self.subject.exchange(method, params)
        self._notifications(exchange.earlier)
        self._note({"call": number, "method": method, "params": params})
        self._notifications(exchange.before)
        if exchange.error is None:
            self._hear({"return": number, "result": exchange.result})
            if method != "cancel":
                self._learn(method, exchange.result)
        else:
            self._hear({"return": number, "error": exchange.error})
        self._notifications(exchange.after)

    def _learn(self, method: str, result: JSON) -> None:
        answer, names = _heard(self.system.codec.answer, method, result)
        self._know(names)
        if answer.code == OK and method not in self.system.codec.streams:
            self.succeeded += 1

    def _know(self, names: tuple[object, ...]) -> None:
        for name in names:
            if name not in self.given.values():
                self.given[Given(self._acting, self._learnt)] = name
            self._learnt += 1

    def _drive(self, event: JSON) -> None:
        exchange = self._result("drive", event)
        result = exchange.result if isinstance(exchange.result, dict) else {}
        happened = result.get("happened")
        if not isinstance(happened, bool):
            message = f"the adapter answered drive with {brief(exchange.result)}, not with happened true or false"
            raise SubjectError(message)
        self._notifications(exchange.earlier)
        first = not happened or self.system.spec.drives[event["event"]].ends
        if first:
            self._notifications(exchange.before)
        if happened:
            # What the environment gave a name to (a connection), the history says with the drive.
            told = {**event, **{key: value for key, value in result.items() if key != "happened"}}
            if any(told[key] != value for key, value in event.items() if key not in self.system.codec.measured):
                message = f"the adapter answered drive {event['event']} with {brief(result)}, which is another drive"
                raise SubjectError(message)
            self._hear({"drive": told})
            self._know(_heard(self.system.codec.happened, told)[1])
        # What the drive caused may have come before its answer; what came earlier still may come now.
        self._notifications(exchange.after if first else exchange.before + exchange.after)

    def _settle(self) -> None:
        exchange = self._result("settle", {})
        self._notifications(exchange.earlier)
        self._notifications(exchange.before)
        self._note({"settled": True})
        self._notifications(exchange.after)

    def _result(self, method: str, params: JSON) -> Exchange:
        exchange = self.subject.exchange(method, params)
        if exchange.error is not None:
            message = f"the adapter answered {method} with {exchange.error.get('status')}"
            raise SubjectError(message)
        return exchange

    def _notifications(self, notifications: tuple[Notification, ...]) -> None:
        for one in notifications:
            if one.method in ("message", "closed"):
                said = {**one.params, "closed": True} if one.method == "closed" else one.params
                self._hear({key: said[key] for key in (*STREAM_KEYS, "connection") if key in said})
            elif one.method == "history":
                self._hear(one.params)
                self._asked = one.params.get("method", self._asked)
                if "result" in one.params:
                    self._learn(self._asked, one.params["result"])
            else:
                line = {"connection": one.params.get("connection", 1), "line": one.params["line"]}
                self._hear(line)
                self._know((("connection", line["connection"]),))
                for names, _, _ in _heard(self.system.codec.strip, line["line"]):
                    self._know(names)

    def _note(self, line: JSON) -> None:
        if self.right:
            self.judge.feed(line)

    def _hear(self, line: JSON) -> None:
        """Note what came from the adapter."""
        _heard(self._note, line)


def _heard(read: Callable[..., _Read], *sent: JSON) -> _Read:
    """What an adapter sent, as it is read; where that cannot be done, nobody but the adapter is to blame."""
    try:
        return read(*sent)
    except UnreadableError as error:
        message = f"the adapter sent what cannot be read: {error}"
        raise GibberishError(message) from None
