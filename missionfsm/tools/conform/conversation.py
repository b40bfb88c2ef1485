"""One conversation with a live implementation, judged as it goes.

What is done is a list of `Action`s. What the protocol does not allow at the moment is not done, and is not in the list.
"""

from __future__ import annotations

import copy
from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any, Self, TypeVar

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
from missionfsm.tools.placeholders import fill, is_template, kind_of, slots

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
        early: whether it was seen to send what a request causes before it answers that.
    """

    system: System
    subject: Subject
    info: AdapterInfo
    absent: dict[str, None] = field(factory=dict)
    names: dict[Name, None] | None = None
    early: bool = False

    def remember(self, names: Iterable[Name]) -> None:
        """Note names that survive a reset."""
        if self.names is not None:
            self.names.update(dict.fromkeys(names))


class Conversation:
    """One conversation with an implementation, from a reset on.

    Attributes:
        heard: every line of the history, also those after the one that cannot be explained.
        in_vain: the drives of which the implementation said that they did not happen, which no history has: each with
            how many lines had been heard.

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
        self.in_vain: list[tuple[int, JSON]] = []
        self.actions: list[Action] = []
        self.given: dict[NameRef, object] = {}
        self._acting = self._before = 0
        self._learnt: Counter[int] = Counter()
        self._late: tuple[Notification, ...] = ()
        self._is_quiet = True
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
        other.in_vain = list(self.in_vain)
        other._learnt = Counter(self._learnt)  # noqa: SLF001 - it is one of these
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
        self._let_names_come(action)
        if not self.right:
            return False
        self.actions.append(action)
        name = self.given.get(action.name, WRONG_NAME) if isinstance(action.name, NameRef) else action.name
        params = action.params if action.name is None else filled(action.params, name)
        if is_template(params):
            picked = self._picked(action)
            params = fill(params, picked, self.system.naming, action.serial, self.given.values())
        codec = self.system.codec
        if self.partner.info.binary and action.method in codec.methods and not codec.carries(action.method, params):
            self.actions.pop()  # a name of another kind may have come into it
            return self.right
        self._before, self._acting = self._acting, action.serial
        if action.method == SETTLE:
            self._settle()
        elif action.method == "drive":
            self._drive(params)
        else:
            self._call(action, params)
        return self.right

    def _let_names_come(self, action: Action) -> None:
        """What an action is about may have been sent and be on its way: it is waited for, or nobody could mean it."""
        meant = (action.name, *(given for _, given in action.picks))
        if self.actions and any(isinstance(one, NameRef) and one not in self.given for one in meant):
            exchange = self._result(SETTLE, {})
            self._notifications((*exchange.earlier, *exchange.before, *exchange.after))

    def _picked(self, action: Action) -> dict[int, Any]:
        """The names that an action picks.

        One that nothing gives any more, since what gave it was left out or did something else this time, is the one of
        its kind that was given last before: the same is done to another. If there is none, it is the first that was
        given after: an implementation that turned out to answer late gives the same names to an action that came later.
        """
        kinds = slots(action.params)
        picked: dict[int, Any] = {}
        for slot, given in action.picks:
            like = sorted(
                (one for one, name in self.given.items() if kind_of(name) == kinds.get(slot)),
                key=lambda one: (one.by, one.position),
            )
            before = [one for one in like if one.by <= given.by]
            meant = given if given in self.given else next(iter((*before[-1:], *like)), None)
            if meant is not None:
                picked[slot] = self.given[meant]
        return picked

    def _call(self, action: Action, params: JSON) -> None:
        number, method = action.serial, action.method
        try:
            exchange = self._exchange(method, params)
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

    def _bind(self, names: tuple[Name, ...], *, late: bool = False) -> None:
        """Names were given by what is being done, or by what was done before that and came late."""
        self.partner.remember(names)
        by = self._before if late else self._acting
        for name in names:
            if name not in self.given.values():
                self.given[NameRef(by, self._learnt[by])] = name
            self._learnt[by] += 1

    def _drive(self, event: JSON) -> None:
        exchange = self._result("drive", event)
        result = exchange.result if isinstance(exchange.result, dict) else {}
        happened = result.get("happened")
        if not isinstance(happened, bool):
            message = f"the adapter answered drive with {brief(exchange.result)}, not with happened true or false"
            raise SubjectError(message)
        self._notifications(exchange.earlier)
        caused = exchange.after
        if happened:
            earlier, caused = self._about_what_ends(event, exchange.before)
            caused += exchange.after
            if not self._goes_before(earlier):
                caused = (*exchange.before, *exchange.after)
            # What the environment gave a name to (a connection), the history says with the drive.
            driven = {**event, **{key: value for key, value in result.items() if key != "happened"}}
            if any(driven[key] != value for key, value in event.items() if key not in self.system.codec.measured):
                message = f"the adapter answered drive {event['event']} with {brief(result)}, which is another drive"
                raise SubjectError(message)
            self._receive({"drive": driven})
            self._bind(_read(self.system.codec.read_drive_result, driven)[1])
        else:
            self._notifications(exchange.before)
            self.in_vain.append((len(self.heard), event))
        # What the drive caused may have come before its answer; what came earlier still may come now.
        self._notifications(caused)

    def _goes_before(self, earlier: tuple[Notification, ...]) -> bool:
        """Note what came before a drive was answered as what came before the drive, unless nothing explains that there.

        What is said on a connection while that is dropped was on its way. If it has no business there either, then it
        was caused by the drop, and a history that ends before the drop is one that nobody could have again.
        """
        here = (self.right, len(self.heard), dict(self.given), Counter(self._learnt))
        self._notifications(earlier)
        if self.right or not here[0] or self.judge.exhausted:
            return True
        del self.heard[here[1] :]
        self.given, self._learnt = here[2:]
        self.judge = self.under(self.judge.automaton).judge
        return False

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

    def _exchange(self, method: str, params: JSON) -> Exchange:
        """Ask for something, and tell what comes with it from what is late.

        What comes before an answer was caused before that was asked for, but of an adapter that causes first and then
        answers: that is one that has something to say when all had settled.
        """
        exchange = self.partner.subject.exchange(method, params)
        self.partner.early |= self._is_quiet and bool(exchange.before)
        self._late = exchange.earlier if self.partner.early else (*exchange.earlier, *exchange.before)
        self._is_quiet = method == SETTLE
        return exchange

    def _result(self, method: str, params: JSON) -> Exchange:
        exchange = self._exchange(method, params)
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
                late = any(one is came for came in self._late)
                self._bind((("connection", line["connection"]),), late=late)
                for names, _, _ in _read(self.system.codec.split_message, line["line"]):
                    self._bind(names, late=late)

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
