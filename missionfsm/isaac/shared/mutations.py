"""How a message may be wrong, whoever sends it: one wrong thing at a time, to test the oracle."""

from __future__ import annotations

import json
from collections.abc import Callable

from missionfsm.isaac.wire import strictjson
from missionfsm.isaac.wire.messages import TYPE_IDS, MissionProto, signed, unsigned
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.mutations import MessageMutation
from missionfsm.kernel.rules import Rule


def changed(change: Callable[[JSON], object]) -> Callable[[JSON], JSON]:
    """A change of the object that a line holds."""

    def mutate_message(line: JSON) -> JSON:
        message = json.loads(line)
        change(message)
        return strictjson.compact(message)

    return mutate_message


def spoils(rule: Rule, **changes: Callable[[JSON], object]) -> tuple[MessageMutation, ...]:
    """Ways to break a rule in lines: what is done, its words joined by ``_``, to the change of the object in it."""
    return tuple(MessageMutation(rule.id, says.replace("_", " "), changed(change)) for says, change in changes.items())


def _bare_uuid(message: JSON) -> None:
    uuid = message["payload"].get("uuid", {})
    uuid.update({half: int(value) for half, value in uuid.items()})


def swapped(message: JSON) -> None:
    """The halves of the mission's identifier change places."""
    uuid = message["payload"].get("uuid", {})
    uuid.update(lower=uuid.get("upper", "0"), upper=uuid.get("lower", "0"))


def unsigned_type(message: JSON) -> None:
    """The type id is the unsigned one."""
    message["header"].update(proto=str(unsigned(int(message["header"]["proto"]))))


def mission_type(message: JSON) -> None:
    """The type id is that of a mission."""
    message["header"].update(proto=str(signed(TYPE_IDS[MissionProto])))


def line_mutations(envelope: str, integers: str, channel: str) -> tuple[MessageMutation, ...]:
    """Wrong lines, for the rules about the envelope, about integers and about the channel of messages."""
    return (
        MessageMutation(
            envelope, "sends the payload alone", lambda line: strictjson.compact(json.loads(line)["payload"])
        ),
        MessageMutation(
            envelope, "sends one message on several lines", lambda line: json.dumps(json.loads(line), indent=1)
        ),
        MessageMutation(envelope, "sends half a line", lambda line: line[: len(line) // 2]),
        MessageMutation(integers, "writes the mission's identifier in numbers", changed(_bare_uuid)),
        MessageMutation(
            integers,
            "writes the time as a number",
            changed(lambda message: message["header"].update(pubtime=int(message["header"]["pubtime"]))),
        ),
        MessageMutation(
            channel, "sends on another channel", changed(lambda one: one["header"].update(channel="elsewhere"))
        ),
    )
