"""What the fakes have in common: a model of what a page says, where it stands, and who is subscribed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Generic, TypeVar

from missionfsm.fakes.errors import error
from missionfsm.fakes.updates import Updates
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Name
from missionfsm.kernel.rules import OK
from missionfsm.kernel.system import System
from missionfsm.tools.reference.model import Reference, Reply

U = TypeVar("U", bound=Updates[Any])


class Fake(Generic[U]):
    """What answers calls as a page says, in this process, and lets a test make happen what is no call.

    Args:
        system: what the page says.
        world: what it is configured with, as JSON.
        readings: ambiguity id to letter; the others follow their defaults.
    """

    def __init__(self, system: System, world: JSON, readings: Mapping[str, str] | None) -> None:
        self._model = Reference(system, readings)
        self._here = self._model.start(system.codec.read_world(world))
        self._subscriptions: dict[Name, U] = {}

    def drive(self, event: str, **fields: JSON) -> bool:
        """Make something happen by its name in the adapter protocol, such as ``drive("fault", status="INTERNAL")``.

        False, and nothing happens, where it does not apply.

        Raises:
            ValueError: there is no such drive, or its fields are wrong.
        """
        return self._drive({"event": event, **fields})

    def _drive(self, given: JSON) -> bool:
        event, names = self._model.system.codec.read_drive(given)
        self._give_up()
        self._here, reply = self._model.drive(self._here, event, names)
        self._deliver(reply)
        return reply.happened

    def _ask(self, method: str, params: JSON, opened: U | None = None) -> Reply:
        """A call, with what it causes; raises the documented error where it is refused."""
        system = self._model.system
        names, rest = system.codec.split_request(method, params)
        self._give_up()
        self._here, reply = self._model.call(self._here, system.codec.read_request(method, rest), names)
        self._deliver(reply, opened)
        assert reply.answer is not None, "a call is answered"  # noqa: S101 - a model always answers
        if reply.answer.code != OK:
            raise error(reply.answer.code, system.spec.operations[method], tuple(map(system.spec.rule, reply.rules)))
        return reply

    def _deliver(self, reply: Reply, opened: U | None = None) -> None:
        """Hand out what was sent; `opened` is the subscription that the call has just made."""
        raise NotImplementedError

    def _give_up(self) -> None:
        """Close the subscriptions that were cancelled."""
        for channel, updates in tuple(self._subscriptions.items()):
            if not updates.open:
                self._here = self._model.cancel(self._here, channel)
                del self._subscriptions[channel]
