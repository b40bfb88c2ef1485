"""Events of the robot and the streams that carry them."""

from __future__ import annotations

import time
from dataclasses import dataclass

from model import Json, World
from status import StatusView


@dataclass(frozen=True)
class Event:
    """A change of the mission status that was recorded once, for all streams."""

    number: int
    moment: float
    states: Json


class Publisher(StatusView):
    """Records changes and hands them to the streams."""

    first_number = 0

    def __init__(self, world: World) -> None:
        """Begin with the state in which nothing has happened."""
        super().__init__(world)
        self.streams: list[int] = []
        self.outbox: list[Json] = []
        self.event = Event(self.first_number, self.now(0.0), self.mission_states())

    def now(self, before: float) -> float:
        """The time, never before the last event."""
        return max(time.time(), before + 0.001)

    def changed(self) -> None:
        """Announce the status if it is another one than before."""
        states = self.mission_states()
        if states != self.event.states:
            self.announce(states)

    def announce(self, states: Json) -> None:
        """Record an event and send it on every stream."""
        self.event = Event(self.next_number(), self.now(self.event.moment), states)
        for stream in self.streams:
            self.send(stream, self.event)

    def next_number(self) -> int:
        """The number of the next event."""
        return self.event.number + 1

    def send(self, stream: int, event: Event) -> None:
        """Put an event on a stream."""
        self.outbox.append({"stream": stream, "message": self.message(event)})

    def message(self, event: Event) -> Json:
        """An event as a SubscribeMissionStatusResponse."""
        return {"metadata": self.metadata(event), "missionStates": event.states}

    def metadata(self, event: Event) -> Json:
        """The metadata of an event."""
        return {"timestamp": self.timestamp(event.moment), "sequenceNumber": event.number}

    def timestamp(self, moment: float) -> object:
        """A moment in UTC with milliseconds."""
        text = time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(moment))
        return f"{text}.{int(moment % 1 * 1000):03d}Z"

    def open_stream(self, stream: int) -> None:
        """Begin a stream with the latest known state."""
        self.streams.append(stream)
        self.send(stream, self.snapshot())

    def snapshot(self) -> Event:
        """What a new stream is told first."""
        return self.event

    def close_stream(self, stream: int) -> None:
        """Forget a stream and whatever it still had to show."""
        self.streams = [other for other in self.streams if other != stream]
        self.outbox = [item for item in self.outbox if item["stream"] != stream]

    # when messages are written

    def messages_first(self, method: str) -> bool:
        """Whether the messages that a request causes are written before its answer."""
        return False

    def messages_due(self, method: str) -> bool:
        """Whether messages are written now, at the end of that request."""
        return True

    def take_messages(self, method: str) -> list[Json]:
        """The messages that are due."""
        if not self.messages_due(method):
            return []
        due, self.outbox = self.outbox, []
        return due
