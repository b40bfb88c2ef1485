"""One conversation with a live implementation, judged as it goes.

What is done is a list of `Action`s. What the protocol does not allow at the moment is not done, and is not in the list.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable
from typing import Self, TypeVar

from attrs import define, field

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.history import Name
from missionfsm.kernel.rules import OK
from missionfsm.kernel.subject import (
    Exchange,
    GibberishError,
    MissingMethodError,
    Notification,
    Subject,
    SubjectError,
)
from missionfsm.kernel.system import System
from missionfsm.kernel.text import brief
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.transcript import STREAM_KEYS, Head
from missionfsm.tools.check.judge import Judge
from missionfsm.tools.conform.actions import SETTLE, WRONG_NAME, Action, NameRef, filled
from missionfsm.tools.conform.handshake import AdapterInfo
from missionfsm.tools.placeholders import fill, is_template

MAX_WAITS = 10
"""How many times in a row something that is missing is waited for while something else comes."""
_Read = TypeVar("_Read")


@define(eq=False)
class Partner:
    """An implementation, as a conversation partner.

    Attributes:
        system: the system, as far as the implementation has it.
        subject: the implementation.
        info: what it said of itself.
        absent: the calls that turned out not to be there; they are not asked again.
        names: the names that it has given so far, if they survive a reset; None if a reset forgets them.
    """

    system: System
    subject: Subject
    info: AdapterInfo
    absent: dict[str, None] = field(factory=dict)
    names: dict[Name, None] | None = None

    def remember(self, names: Iterable[Name]) -> None:
        """Note names that survive a reset."""
        if self.names is not None:
            self.names.update(dict.fromkeys(names))


class Conversation:
    """One conversation with an implementation, from a reset on.

    Attributes:
        heard: every line of the history, also those after the one that cannot be explained.

    Raises:
        SubjectError: the adapter failed; so does everything that it is asked.
    """

    def __init__(self, partner: Partner, world: JSON, automaton: Automaton) -> None:
        self.partner = partner
        self.system = partner.system
        self.world = world
        # What was named before is gone with a reset; where nothing was reset, it may still be there.
        self.past = None if partner.names is None or self.system.spec.anywhere else tuple(partner.names)
        self.judge = self._judged(automaton)
        self.heard: list[JSON] = []
        self.actions: list[Action] = []
        self.given: dict[NameRef, object] = {}
        self._acting = self._learnt = 0
        self._asked = ""
        self.succeeded = 0
        # What was still under way before a reset belongs to nobody.
        self._notifications(self._result("reset", {"world": world}).after)

    def _judged(self, automaton: Automaton) -> Judge:
        spec = self.system.spec
        head = Head(
            self.system.name,
            self.world,
            self.partner.info.drives,
            strict=not spec.transport,
            anywhere=spec.anywhere,
            others=spec.others,
        )
        return Judge(self.system, head, automaton, keep=1_000_000, waits=False, past=self.past)

    @property
    def right(self) -> bool:
        """Whether everything so far is explained."""
        return self.judge.right

    def under(self, automaton: Automaton) -> Self:
        """The same conversation, what was heard judged by another automaton; nothing is asked again."""
        other = copy.copy(self)
        other.judge = self._judged(automaton)
        other.heard, other.actions, other.given = list(self.heard), list(self.actions), dict(self.given)
        for line in self.heard:
            if not other.judge.feed(line):
                break
        return other

    def may(self, action: Action) -> bool:
        """Whether the protocol allows it now: what turned out not to be there, and a second fault, are not asked."""
        if action.method in self.partner.absent:
            return False
        if action.method != "drive":
            return True
        waits = self.system.spec.drives[action.params["event"]].waits
        return not any(waits(one.state) for one in self.judge.belief.node.explanations)

    def perform(self, action: Action) -> bool:
        """Do something, if it may be done; False once the conversation cannot be explained any more."""
        if not self.may(action):
            return self.right
        self.actions.append(action)
        name = self.given.get(action.name, WRONG_NAME) if isinstance(action.name, NameRef) else action.name
        params = action.params if action.name is None else filled(action.params, name)
        if is_template(params):
            picked = {slot: self.given[given] for slot, given in action.picks if given in self.given}
            params = fill(params, picked, self.system.naming, action.serial, self.given.values())
        codec = self.system.codec
        if self.partner.info.binary and action.method in codec.methods and not codec.carries(action.method, params):
            self.actions.pop()  # a name of another kind may have come into it
            return self.right
        self._acting, self._learnt = action.serial, 0
        if action.method == SETTLE:
            self._settle()
        elif action.method == "drive":
            self._drive(params)
        else:
            self._call(action, params)
        return self.right

    def _call(self, action: Action, params: JSON) -> None:
        number, method = action.serial, action.method
        try:
            exchange = self.partner.subject.exchange(method, params)
        except MissingMethodError:
            if self.partner.info.methods is not None or method not in self.system.codec.methods:
                raise
            self.partner.absent[method] = None
            self.actions.remove(action)
            return
        self._notifications(exchange.earlier)
        self._append({"call": number, "method": method, "params": params})
        self._notifications(exchange.before)
        if exchange.error is None:
            self._receive({"return": number, "result": exchange.result})
            if method != "cancel":
                self._bind_answer(method, exchange.result)
        else:
            self._receive({"return": number, "error": exchange.error})
        self._notifications(exchange.after)

    def _bind_answer(self, method: str, result: JSON) -> None:
        answer, names = _read(self.system.codec.read_answer, method, result)
        self._bind(names)
        if answer.code == OK and method not in self.system.codec.streams:
            self.succeeded += 1

    def _bind(self, names: tuple[Name, ...]) -> None:
        self.partner.remember(names)
        for name in names:
            if name not in self.given.values():
                self.given[NameRef(self._acting, self._learnt)] = name
            self._learnt += 1

    def _drive(self, event: JSON) -> None:
        exchange = self._result("drive", event)
        result = exchange.result if isinstance(exchange.result, dict) else {}
        happened = result.get("happened")
        if not isinstance(happened, bool):
            message = f"the adapter answered drive with {brief(exchange.result)}, not with happened true or false"
            raise SubjectError(message)
        self._notifications(exchange.earlier)
        earlier, caused = exchange.before, exchange.after
        if happened:
            earlier, caused = self._about_what_ends(event, exchange.before)
            caused += exchange.after
        self._notifications(earlier)
        if happened:
            # What the environment gave a name to (a connection), the history says with the drive.
            driven = {**event, **{key: value for key, value in result.items() if key != "happened"}}
            if any(driven[key] != value for key, value in event.items() if key not in self.system.codec.measured):
                message = f"the adapter answered drive {event['event']} with {brief(result)}, which is another drive"
                raise SubjectError(message)
            self._receive({"drive": driven})
            self._bind(_read(self.system.codec.read_drive_result, driven)[1])
        # What the drive caused may have come before its answer; what came earlier still may come now.
        self._notifications(caused)

    def _about_what_ends(
        self, event: JSON, came: tuple[Notification, ...]
    ) -> tuple[tuple[Notification, ...], tuple[Notification, ...]]:
        """Of what came while something was driven: what came on a channel that this ends, and all else."""
        if not self.system.spec.drives[event["event"]].ends:
            return (), came
        own = [event.get("connection") in (None, one.params.get("connection", 1)) for one in came]
        first = tuple(one for one, ended in zip(came, own, strict=True) if ended)
        return first, tuple(one for one, ended in zip(came, own, strict=True) if not ended)

    def _settle(self) -> None:
        exchange = self._result(SETTLE, {})
        self._notifications(exchange.earlier)
        self._notifications(exchange.before)
        if self.partner.info.silences:
            self._wait_for_what_is_missing()
        self._append({"settled": True})
        self._notifications(exchange.after)

    def _wait_for_what_is_missing(self) -> None:
        """Where a silence was taken for the end, wait for what is missing until it comes, or until it does not.

        A network that is slow is no robot that says nothing.
        """
        for _ in range(MAX_WAITS):
            came = self._result(SETTLE, {"patiently": True}).before if self.judge.awaits else ()
            if not came:
                return
            self._notifications(came)

    def _result(self, method: str, params: JSON) -> Exchange:
        exchange = self.partner.subject.exchange(method, params)
        if exchange.error is not None:
            message = f"the adapter answered {method} with {exchange.error.get('status')}"
            raise SubjectError(message)
        return exchange

    def _notifications(self, notifications: tuple[Notification, ...]) -> None:
        for one in notifications:
            if one.method in ("message", "closed"):
                said = {**one.params, "closed": True} if one.method == "closed" else one.params
                self._receive({key: said[key] for key in (*STREAM_KEYS, "connection") if key in said})
            elif one.method == "history":
                self._receive(one.params)
                self._asked = one.params.get("method", self._asked)
                if "result" in one.params:
                    self._bind_answer(self._asked, one.params["result"])
            else:
                line = {"connection": one.params.get("connection", 1), "line": one.params["line"]}
                self._receive(line)
                self._bind((("connection", line["connection"]),))
                for names, _, _ in _read(self.system.codec.split_message, line["line"]):
                    self._bind(names)

    def _append(self, line: JSON) -> None:
        self.heard.append(line)
        if self.right:
            self.judge.feed(line)
            transitions = self.judge.automaton.transitions
            if not self.right and transitions.reckons and not transitions.eager:
                self._look_again()

    def _look_again(self) -> None:
        """What nothing explains may have its cause long before, in a message that was lost without a trace."""
        before = self.judge
        again = self._judged(Automaton(self.system.spec, before.head.drives, before.automaton.assumed, eager=True))
        if all(again.feed(line) for line in before.lines):
            self.judge = again

    def _receive(self, line: JSON) -> None:
        """Note what came from the adapter."""
        _read(self._append, line)


def _read(read: Callable[..., _Read], *sent: JSON) -> _Read:
    """What an adapter sent, as it is read; where that cannot be done, nobody but the adapter is to blame."""
    try:
        return read(*sent)
    except UnreadableError as error:
        message = f"the adapter sent what cannot be read: {error}"
        raise GibberishError(message) from None
