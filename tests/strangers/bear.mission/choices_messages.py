"""Choices about messages: when they are sent, how they are numbered, and how they are written."""

from __future__ import annotations

import time
from dataclasses import replace

from catalogue import choice
from model import COMMANDS, MISSION_KINDS, Json, Mission, State
from reader import snake
from service import Robot
from stream import Event

STATUS_NAMES = ["STATUS_UNKNOWN", "STATUS_NAVIGATING", "STATUS_ARRIVED", "STATUS_DOCKING", "STATUS_UNDOCKING"]

# what is worth a message


@choice("SubscribeMissionStatus")
class _HandoverInTwoMessages(Robot):
    """The end of a mission and the start of the next are two updates, with no mission active in between."""

    def after_end(self, mission: Mission) -> None:
        self.changed()
        super().after_end(mission)


@choice("SubscribeMissionStatus")
class _QueuedBeforeRunning(Robot):
    """A mission that is created on a free robot is first shown waiting and then, in a second update, running."""

    def launch(self, mission: Mission) -> None:
        self.changed()
        super().launch(mission)


@choice("MissionFeedback › servi.Feedback enum")
class _ArrivalIsShown(Robot):
    """Servi and Carti missions show in an update of its own that a goal was reached, before they go on."""

    def reach(self, mission: Mission) -> None:
        if mission.kind.member == "base":
            super().reach(mission)
            return
        mission.feedback = "STATUS_ARRIVED"
        self.changed()
        super().reach(mission)
        if mission is self.current:
            mission.feedback = "STATUS_NAVIGATING"


@choice("MissionFeedback › servi.Feedback enum")
class _UndockingIsShown(Robot):
    """Servi and Carti missions show in an update of its own that the robot leaves its dock."""

    def start(self, mission: Mission) -> None:
        super().start(mission)
        if mission is self.current and mission.kind.member != "base" and not mission.kind.charge:
            mission.feedback = "STATUS_UNDOCKING"
            self.changed()
            mission.feedback = "STATUS_NAVIGATING"


@choice("ClearMissionStatus")
class _ClearAlwaysAnnounced(Robot):
    """ClearMissionStatus is followed by an update also where nothing was listed."""

    def clear(self) -> list[str]:
        before = self.event
        ids = super().clear()
        if self.event is before:
            self.announce(self.mission_states())
        return ids


@choice("servi.ServiType enum")
class _LoneRoundIsAnnounced(Robot):
    """A patrol over one goal is followed by an update each time it starts over, though it looks the same."""

    def reach(self, mission: Mission) -> None:
        super().reach(mission)
        if mission.kind.patrol and len(mission.goals) == 1:
            self.announce(self.mission_states())


@choice("SubscribeMissionStatus › Response")
class _MessagesBeforeAnswers(Robot):
    """The update that a call causes is sent before the call is answered."""

    def messages_first(self, method: str) -> bool:
        return method != "SubscribeMissionStatus"


@choice("SubscribeMissionStatus › Response")
class _MessagesAreLate(Robot):
    """Updates are collected and sent somewhat later; only the first message of a stream is immediate."""

    def messages_due(self, method: str) -> bool:
        return method in ("settle", "SubscribeMissionStatus")


# numbers


@choice("SubscribeMissionStatus › EventMetadata")
class _SnapshotHasItsNumber(Robot):
    """Each first message of a stream takes a new sequence number and the time at which it was made."""

    def snapshot(self) -> Event:
        self.event = replace(self.event, number=self.next_number(), moment=self.now(self.event.moment))
        return self.event


@choice("SubscribeMissionStatus › EventMetadata")
class _NumbersFromOne(Robot):
    """Sequence numbers begin with 1."""

    first_number = 1


@choice("SubscribeMissionStatus › EventMetadata")
class _NumbersWithGaps(Robot):
    """Sequence numbers grow in steps of seven, as the robot also numbers events that are not shown here."""

    def next_number(self) -> int:
        return self.event.number + 7


@choice("SubscribeMissionStatus › EventMetadata")
class _NumbersFromClock(Robot):
    """Sequence numbers are microseconds of the robot's clock."""

    first_number = int(time.time() * 1_000_000)

    def next_number(self) -> int:
        return max(int(time.time() * 1_000_000), self.event.number + 1)


@choice("SubscribeMissionStatus › EventMetadata")
class _NumbersPerStream(Robot):
    """Each stream has sequence numbers of its own, beginning with 0."""

    def send(self, stream: int, event: Event) -> None:
        self.sent = {**self.sent, stream: self.sent.get(stream, -1) + 1}
        super().send(stream, replace(event, number=self.sent[stream]))

    sent: dict[int, int] = {}


@choice("SubscribeMissionStatus › EventMetadata")
class _NumbersRestartOnClear(Robot):
    """Sequence numbers are reset to 0 when the list is cleared."""

    def next_number(self) -> int:
        return 0 if self.method == "ClearMissionStatus" and not self.missions else super().next_number()


@choice("SubscribeMissionStatus › EventMetadata")
class _NumbersWrap(Robot):
    """Sequence numbers start over at 0 after 15."""

    def next_number(self) -> int:
        return (self.event.number + 1) % 16


# feedback


@choice("MissionState")
class _FeedbackFollowsFamily(Robot):
    """A base mission on a Servi or Carti shows the feedback of that family."""

    def feedback_member(self, mission: Mission) -> str:
        return self.world.family


@choice("MissionState")
class _FeedbackClearedAtEnd(Robot):
    """A mission that has ended shows no feedback any more."""

    def feedback_status(self, mission: Mission) -> str:
        return "" if mission.ended else super().feedback_status(mission)


@choice("MissionFeedback › servi.Feedback enum")
class _ArrivedAtEnd(Robot):
    """A Servi or Carti mission that went well ends with the feedback that the robot has arrived."""

    def feedback_status(self, mission: Mission) -> str:
        if mission.state is State.SUCCEEDED and mission.kind.member != "base" and not mission.kind.charge:
            return "STATUS_ARRIVED"
        return super().feedback_status(mission)


@choice("MissionState")
class _NoFeedbackWhilePaused(Robot):
    """A paused mission shows no feedback."""

    def feedback_status(self, mission: Mission) -> str:
        return "" if mission.state is State.PAUSED else super().feedback_status(mission)


@choice("MissionFeedback")
class _QueuedFeedbackUnknown(Robot):
    """A mission that waits shows feedback whose status is unknown."""

    def feedback_status(self, mission: Mission) -> str:
        return super().feedback_status(mission) or "STATUS_UNKNOWN"


@choice("MissionFeedback › servi.Feedback enum")
class _ChargeIsDocking(Robot):
    """A charge on a Servi or Carti shows that the robot is docking."""

    def first_feedback(self, mission: Mission) -> str:
        if mission.kind.charge and mission.kind.member != "base":
            return "STATUS_DOCKING"
        return super().first_feedback(mission)


@choice("ChargeRobot")
class _ChargeWithoutFeedback(Robot):
    """A charge shows no feedback."""

    def first_feedback(self, mission: Mission) -> str:
        return "" if mission.kind.charge else super().first_feedback(mission)


# the JSON of a message


@choice("SubscribeMissionStatus › JSON Response Example")
class _DefaultsLeftOut(Robot):
    """Members that have their default are left out of messages."""

    def message(self, event: Event) -> Json:
        shown = _without_defaults(super().message(event))
        return shown if isinstance(shown, dict) else {}


@choice("SubscribeMissionStatus › JSON Response Example")
class _NamesInSnakeCase(Robot):
    """Members of messages have the names of the fields as they are in the tables."""

    def message(self, event: Event) -> Json:
        shown = _snake_cased(super().message(event))
        return shown if isinstance(shown, dict) else {}


@choice("SubscribeMissionStatus › JSON Response Example")
class _EnumsByNumber(Robot):
    """Enums in messages are written as numbers."""

    def message(self, event: Event) -> Json:
        shown = _numbered(super().message(event))
        return shown if isinstance(shown, dict) else {}


@choice("SubscribeMissionStatus › EventMetadata")
class _SequenceNumberAsText(Robot):
    """The sequence number is written as text, as 64-bit integers are in protobuf JSON."""

    def metadata(self, event: Event) -> Json:
        return {**super().metadata(event), "sequenceNumber": str(event.number)}


@choice("SubscribeMissionStatus › EventMetadata")
class _TimestampInParts(Robot):
    """The timestamp is written as seconds and nanoseconds."""

    def timestamp(self, moment: float) -> object:
        return {"seconds": int(moment), "nanos": int(moment % 1 * 1e9)}


def _without_defaults(value: object) -> object:
    if isinstance(value, dict):
        shown = {name: _without_defaults(item) for name, item in value.items()}
        unset: tuple[object, ...] = ("", 0, "STATUS_UNKNOWN", [])
        return {name: item for name, item in shown.items() if name == "destinationId" or item not in unset}
    return [_without_defaults(item) for item in value] if isinstance(value, list) else value


def _snake_cased(value: object) -> object:
    if isinstance(value, dict):
        return {snake(name): _snake_cased(item) for name, item in value.items()}
    return [_snake_cased(item) for item in value] if isinstance(value, list) else value


def _numbered(value: object) -> object:
    if isinstance(value, dict):
        return {name: _enum_number(name, _numbered(item)) for name, item in value.items()}
    return [_numbered(item) for item in value] if isinstance(value, list) else value


def _enum_number(name: str, value: object) -> object:
    types: dict[str, list[str]] = {"baseType": [], "serviType": [], "cartiType": []}
    order = {
        "base": ["BASE_TYPE_UNKNOWN", "BASE_TYPE_NAVIGATE", "BASE_TYPE_NAVIGATE_AUTO"],
        "servi": ["SERVI_TYPE_UNKNOWN", "SERVI_TYPE_SERVING", "SERVI_TYPE_SERVING_PATROL", "SERVI_TYPE_BUSSING"],
        "carti": ["CARTI_TYPE_UNKNOWN", "CARTI_TYPE_TRAVERSE", "CARTI_TYPE_TRAVERSE_PATROL", "CARTI_TYPE_NAVIGATE"],
    }
    order["servi"] += ["SERVI_TYPE_BUSSING_PATROL", "SERVI_TYPE_NAVIGATE", "SERVI_TYPE_NAVIGATE_AUTO"]
    order["carti"] += ["CARTI_TYPE_NAVIGATE_AUTO"]
    for family in MISSION_KINDS:
        types[f"{family}Type"] = order[family]
    names = {"state": [state.value for state in State], "status": STATUS_NAMES, "command": list(COMMANDS), **types}
    return names[name].index(value) if name in names and isinstance(value, str) else value
