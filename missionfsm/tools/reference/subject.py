"""The reference model in the role of an implementation under test."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.rules import OK
from missionfsm.kernel.subject import Exchange, Notification, SubjectError
from missionfsm.kernel.system import System
from missionfsm.tools.reference.model import Reference, Reply, Sent, Snapshot, StepMutator, unchanged_step


class ReferenceSubject:
    """The reference model of a system behind the adapter protocol, in this process.

    Args:
        system: the system.
        choice: the readings that it follows; see `Reference`.
        mutate_step: how its steps are broken; see `Reference`.
        mutate_message: message → the message that is sent instead, for a broken one.
        seconds: number of an event → its timestamp, in seconds since the epoch.

    Attributes:
        rules: the ids of the rules that justify the last answer.
    """

    def __init__(
        self,
        system: System,
        choice: Mapping[str, str] | None = None,
        mutate_step: StepMutator = unchanged_step,
        mutate_message: Callable[[JSON], JSON] = lambda message: message,
        seconds: Callable[[int], float] = float,
    ) -> None:
        self.model = Reference(system, choice, mutate_step=mutate_step)
        self.rules: tuple[str, ...] = ()
        self._says = {name: rule.says for name, rule in system.spec.rules_by_id.items()}
        self._mutate_message = mutate_message
        self._seconds = seconds
        self._here: Snapshot | None = None
        self._minted = 0

    @property
    def drives(self) -> tuple[str, ...]:
        """The drives that it has: all of the system's."""
        return tuple(self.model.system.spec.drives)

    def close(self) -> None:
        """Nothing is held."""

    def exchange(self, method: str, params: JSON) -> Exchange:
        """Answer one request of the protocol. Raises SubjectError for one that the protocol does not have."""
        codec = self.model.system.codec
        try:
            if method == "initialize":
                return Exchange(self._initialized(params))
            if method == "reset":
                return self._reset(params)
            if method == "settle":
                return Exchange({})
            if method == "drive":
                return self._drive(params)
            if method == "cancel":
                return self._cancel(params)
            if method in codec.methods:
                return self._call(method, params)
        except UnreadableError as error:
            raise SubjectError(str(error)) from None
        message = f"{method!r} is not a method of {self.model.system.name}"
        raise SubjectError(message)

    def _initialized(self, params: JSON) -> JSON:
        wanted = params.get("system") if isinstance(params, dict) else None
        if wanted != self.model.system.name:
            message = f"this is an adapter of {self.model.system.name}, not of {wanted!r}"
            raise SubjectError(message)
        return {
            "implementation": {"name": "missionfsm reference", "version": "1"},
            "drives": list(self.drives),
            "concurrent": False,
        }

    def _started(self) -> Snapshot:
        if self._here is None:
            message = "nothing can be asked before reset"
            raise SubjectError(message)
        return self._here

    def _reset(self, params: JSON) -> Exchange:
        world = self.model.system.codec.read_world(params.get("world", {}) if isinstance(params, dict) else {})
        fresh = self.model.start(world)
        # Stream numbers are never used twice in one process, so the serial numbers go on.
        self._here = Snapshot(fresh.state, fresh.names, fresh.channels, max(self._minted, fresh.minted))
        return Exchange({})

    def _drive(self, params: JSON) -> Exchange:
        codec = self.model.system.codec
        event, names = codec.read_drive(params)
        self._here, reply = self.model.drive(self._started(), event, names)
        self._minted = self._here.minted
        measured = codec.write_drive_result(event, reply.names) if reply.happened else {}
        return Exchange({"happened": reply.happened, **measured}, after=self._notifications(reply))

    def _cancel(self, params: JSON) -> Exchange:
        stream = params.get("stream") if isinstance(params, dict) else None
        self._here = self.model.cancel(self._started(), ("stream", stream))
        return Exchange({})

    def _call(self, method: str, params: JSON) -> Exchange:
        codec = self.model.system.codec
        names, rest = codec.split_request(method, params)
        self._here, reply = self.model.call(self._started(), codec.read_request(method, rest), names)
        self._minted = self._here.minted
        self.rules = reply.rules
        answer = reply.answer
        assert answer is not None, "a call is answered"  # noqa: S101 - a model always answers
        if answer.code != OK:
            said = "; ".join(self._says[rule] for rule in reply.rules)
            error = {"status": answer.code, "message": said}
            return Exchange(error=error, after=self._notifications(reply))
        return Exchange(codec.write_answer(method, answer, reply.names), after=self._notifications(reply))

    def _notifications(self, reply: Reply) -> tuple[Notification, ...]:
        """What is sent; streams that show the same event share its message."""
        found: list[Notification] = []
        last: Sent | None = None
        for sent in reply.sent:
            one = last is not None and (sent.number, sent.names) == (last.number, last.names) and sent.view is last.view
            found.append(self._notification(sent, found[-1].params if one else None))
            last = sent
        return tuple(found)

    def _notification(self, sent: Sent, same: JSON) -> Notification:
        """The notification of what is sent; `same` is what was sent last, if it shows the same event."""
        codec, choice = self.model.system.codec, self.model.choice
        if same is None:
            seconds = self._seconds(sent.number)
            message = codec.write_message(sent.view, sent.names, choice, sent.number, seconds)
            message = message if message is None else self._mutate_message(message)
        else:
            message = same.get("message", same.get("line"))
        kind, number = _channel(sent.channel)
        if message is None:
            return Notification("closed", {kind: number})
        if kind == "connection":
            return Notification("line", {"connection": number, "line": message})
        return Notification("message", {"stream": number, "message": message})


def _channel(name: Any) -> tuple[str, int]:  # noqa: ANN401 - the name of a channel, a pair
    kind, number = name
    return kind, number
