"""Faults of streams: what is sent, to whom, in which order, and with which number."""

from __future__ import annotations

import copy
from dataclasses import replace

from catalogue import bug
from model import Json, Mission, Plan, State, World
from service import Robot
from stream import Event

# the first message of a stream


@bug("SubscribeMissionStatus")
class _NoSnapshot(Robot):
    """A stream begins with the next change, without the state that is known."""

    def open_stream(self, stream: int) -> None:
        self.streams.append(stream)


@bug("SubscribeMissionStatus")
class _SnapshotIsFirstState(Robot):
    """Every stream begins with the state in which the robot was started."""

    def __init__(self, world: World) -> None:
        super().__init__(world)
        self.first = self.event

    def snapshot(self) -> Event:
        return replace(self.event, states=self.first.states)


@bug("SubscribeMissionStatus")
class _SnapshotIsOneBehind(Robot):
    """A stream begins with the state before the last change."""

    def announce(self, states: Json) -> None:
        self.before = self.event
        super().announce(states)

    def snapshot(self) -> Event:
        return self.before or self.event

    before: Event | None = None


@bug("SubscribeMissionStatus")
class _SecondStreamHasNoSnapshot(Robot):
    """Only the first of several streams begins with the state that is known."""

    def open_stream(self, stream: int) -> None:
        if self.streams:
            self.streams.append(stream)
        else:
            super().open_stream(stream)


@bug("MissionStates")
class _SnapshotWithoutQueue(Robot):
    """The first message of a stream lists no missions that wait."""

    def snapshot(self) -> Event:
        states = copy.deepcopy(self.event.states)
        states["missions"] = [m for m in states["missions"] if m["state"] != State.DEFAULT.value]
        return replace(self.event, states=states)


@bug("MissionState › State enum")
class _SnapshotHidesPause(Robot):
    """The first message of a stream shows a paused mission as running."""

    def snapshot(self) -> Event:
        states = copy.deepcopy(self.event.states)
        for mission in states["missions"]:
            if mission["state"] == State.PAUSED.value:
                mission["state"] = State.RUNNING.value
        return replace(self.event, states=states)


@bug("MissionStates")
class _SnapshotIndexIsZero(Robot):
    """The first message of a stream has the index 0 also when no mission is active."""

    def snapshot(self) -> Event:
        index = max(self.event.states["currentMissionIndex"], 0)
        return replace(self.event, states={**self.event.states, "currentMissionIndex": index})


# who is told


@bug("SubscribeMissionStatus")
class _OnlyNewestStreamIsTold(Robot):
    """Updates go to the newest stream alone."""

    def announce(self, states: Json) -> None:
        everyone, self.streams = self.streams, self.streams[-1:]
        super().announce(states)
        self.streams = everyone


@bug("SubscribeMissionStatus")
class _OnlyFirstStreamIsTold(Robot):
    """Updates go to the oldest stream alone."""

    def announce(self, states: Json) -> None:
        everyone, self.streams = self.streams, self.streams[:1]
        super().announce(states)
        self.streams = everyone


@bug("SubscribeMissionStatus")
class _CancelSilencesOthers(Robot):
    """When one stream is given up, the others are told nothing more."""

    def close_stream(self, stream: int) -> None:
        super().close_stream(stream)
        self.streams = []


@bug("SubscribeMissionStatus")
class _StreamsEndWithMission(Robot):
    """Streams fall silent when the last mission has ended."""

    def announce(self, states: Json) -> None:
        super().announce(states)
        if self.missions and self.current is None:
            self.streams = []


# what is told


@bug("SubscribeMissionStatus")
class _GoalChangeIsNotAnnounced(Robot):
    """No update follows when a mission turns to its next goal."""

    def reach(self, mission: Mission) -> None:
        super().reach(mission)
        self.silent = mission is self.current

    def changed(self) -> None:
        if not self.silent:
            super().changed()
        self.silent = False

    silent = False


@bug("SubscribeMissionStatus")
class _NewRoundIsNotAnnounced(Robot):
    """No update follows when a patrol starts over."""

    def changed(self) -> None:
        mission = self.current
        shown = self.event.states["missions"]
        again = mission is not None and mission.kind.patrol and mission.goal_index == 0
        if not again or not shown or shown[-1]["currentGoalIndex"] == 0:
            super().changed()


@bug("SubscribeMissionStatus")
class _FailureIsNotAnnounced(Robot):
    """No update follows when a mission fails and none is waiting."""

    def mission_failed(self) -> bool:
        self.silent = not self.queued()
        happened = super().mission_failed()
        self.silent = False
        return happened

    def changed(self) -> None:
        if not self.silent:
            super().changed()

    silent = False


@bug("SubscribeMissionStatus")
class _AppendIsNotAnnounced(Robot):
    """No update follows when a mission is appended."""

    def append(self, plans: list[Plan]) -> list[str]:
        self.silent = True
        ids = super().append(plans)
        self.silent = False
        return ids

    def changed(self) -> None:
        if not self.silent:
            super().changed()

    silent = False


@bug("SubscribeMissionStatus")
class _NextStartIsNotAnnounced(Robot):
    """When a mission ends the next one starts, but only the end is shown until something else changes."""

    def after_end(self, mission: Mission) -> None:
        self.changed()
        super().after_end(mission)
        self.silent = self.current is not None

    def changed(self) -> None:
        if not self.silent:
            super().changed()
        self.silent = False

    silent = False


@bug("SubscribeMissionStatus")
class _UpdatesAreOneBehind(Robot):
    """Updates show the state before the last change."""

    def announce(self, states: Json) -> None:
        shown, self.next_shown = self.next_shown or states, states
        super().announce(shown)

    def changed(self) -> None:
        states = self.mission_states()
        if states != self.next_shown:
            self.announce(states)

    next_shown: Json | None = None


@bug("SubscribeMissionStatus › EventMetadata")
class _UpdatesAreDoubled(Robot):
    """Every update is sent twice with the same sequence number."""

    def announce(self, states: Json) -> None:
        super().announce(states)
        for stream in self.streams:
            self.send(stream, self.event)


@bug("SubscribeMissionStatus › EventMetadata")
class _HandoverIsOutOfOrder(Robot):
    """The end of a mission and the start of the next are two updates, sent in the wrong order."""

    def after_end(self, mission: Mission) -> None:
        self.changed()
        super().after_end(mission)
        self.changed()
        last = self.outbox[-2 * len(self.streams) :] if self.streams and self.current is not None else []
        if last:
            self.outbox[-len(last) :] = last[::-1]


# numbers


@bug("SubscribeMissionStatus › EventMetadata")
class _NumberStaysTheSame(Robot):
    """After the first update all sequence numbers are 1."""

    def next_number(self) -> int:
        return 1


@bug("SubscribeMissionStatus › EventMetadata")
class _NumberGoesDown(Robot):
    """Sequence numbers go down from a million."""

    first_number = 1_000_000

    def next_number(self) -> int:
        return self.event.number - 1


@bug("SubscribeMissionStatus › EventMetadata")
class _NumberIsNegative(Robot):
    """Sequence numbers begin with -1."""

    first_number = -1


@bug("SubscribeMissionStatus › EventMetadata")
class _NumberRestartsAtOne(Robot):
    """Sequence numbers start over at 1 when the list is cleared."""

    def next_number(self) -> int:
        return 1 if self.method == "ClearMissionStatus" and not self.missions else super().next_number()


@bug("SubscribeMissionStatus › EventMetadata")
class _NumberCountsMissions(Robot):
    """The sequence number is the number of missions, so that it stays while one goes on."""

    def next_number(self) -> int:
        return len(self.missions)


@bug("SubscribeMissionStatus › EventMetadata")
class _NumberRepeatsOnPause(Robot):
    """The update that shows a pause has the sequence number of the one before it."""

    def next_number(self) -> int:
        paused = self.current is not None and self.current.state is State.PAUSED
        return self.event.number if paused else super().next_number()


@bug("SubscribeMissionStatus › EventMetadata")
class _TimestampMissing(Robot):
    """Messages carry no timestamp."""

    def metadata(self, event: Event) -> Json:
        return {"sequenceNumber": event.number}


@bug("SubscribeMissionStatus › EventMetadata")
class _TimestampIsCountdown(Robot):
    """Each event is recorded one second before the one that came before it."""

    def now(self, before: float) -> float:
        return before - 1.0 if before else super().now(before)


@bug("SubscribeMissionStatus › Response")
class _MetadataOnlyAtFirst(Robot):
    """Only the first message of a stream carries metadata."""

    def announce(self, states: Json) -> None:
        super().announce(states)
        for item in self.outbox:
            item["message"].pop("metadata", None)


@bug("SubscribeMissionStatus")
class _ThirdStreamIsNotTold(Robot):
    """Only two streams are told of changes; further ones end with their first message."""

    def announce(self, states: Json) -> None:
        everyone, self.streams = self.streams, self.streams[:2]
        super().announce(states)
        self.streams = everyone


@bug("SubscribeMissionStatus")
class _ClearEndsStreams(Robot):
    """After the update that shows a cleared list, streams are told nothing more."""

    def clear(self) -> list[str]:
        ids = super().clear()
        self.streams = [] if ids else self.streams
        return ids
