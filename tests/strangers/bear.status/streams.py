"""The subscriptions: their snapshots, their updates, and the robots that they follow."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any

from access import Selection
from changes import worth_telling
from schema import Json
from variants import Options
from views import MAP_FIELDS, METHODS, Views
from world import STATE, WIFI, Metadata, Robot, World


@dataclass
class Stream:
    """One open subscription."""

    number: int
    method: str
    topic: str
    selection: Selection
    sent: int = 0
    updates: int = 0
    base: dict[str, Json] = field(default_factory=dict)

    def follows(self, robot_id: str) -> bool:
        """Whether the stream shows that robot."""
        return robot_id in self.selection.robot_ids


@dataclass
class Letter:
    """A message that waits to be written, or, without one, the end of its stream."""

    stream: Stream
    message: Json | None
    update: bool


class Streams:
    """All open subscriptions of a world and the messages that wait to be written."""

    def __init__(self, options: Options, world: World, views: Views) -> None:
        self._options = options
        self._world = world
        self._views = views
        self._open: dict[int, Stream] = {}
        self.outbox: list[Letter] = []

    def open(self, number: int, method: str, selection: Selection) -> None:
        """Start a stream and queue its snapshot."""
        topic = METHODS[method]
        stream = Stream(number, method, topic, selection)
        others = [other for other in self._open.values() if other.topic == topic]
        self._open[number] = stream
        for robot_id in selection.robot_ids:
            stream.base[robot_id] = self._views.content(self._world.robots[robot_id], topic)
        if self._options.topic_is("no-battery-snapshot", topic, "battery"):
            return
        if self._options.topic_is("no-network-snapshot", topic, WIFI):
            return
        if self._options.topic_is("status-snapshot-waits", topic, STATE):
            return
        if others and self._options.on("second-subscriber-without-snapshot"):
            return
        if self._options.topic_is("snapshot-to-everyone", topic, "connection", "navigationState"):
            for other in others:
                self._snapshot(other, [robot_id for robot_id in selection.robot_ids if other.follows(robot_id)])
        self._snapshot(stream, selection.robot_ids)

    def close(self, number: int) -> None:
        """End a stream at the client's wish; nothing of it is written any more."""
        ended = self._open.pop(number, None)
        if ended is not None and self._options.on("cancel-ends-topic"):
            for other in [stream for stream in self._open.values() if stream.topic == ended.topic]:
                del self._open[other.number]
        self.outbox = [letter for letter in self.outbox if letter.stream.number != number]

    def _snapshot(self, stream: Stream, robot_ids: list[str]) -> None:
        robots = [self._world.robots[robot_id] for robot_id in robot_ids]
        if self._options.on("snapshots-by-name"):
            robots.sort(key=lambda robot: robot.robot_id)
        if self._options.on("unknown-snapshot-skipped") and stream.topic not in (WIFI, STATE):
            robots = [robot for robot in robots if robot.part(stream.topic) is not None]
        if self._options.topic_is("navigation-first-snapshot-only", stream.topic, "navigationState"):
            robots = robots[:1]
        if self._options.topic_is("online-snapshot-connected-only", stream.topic, "connection"):
            robots = [robot for robot in robots if robot.online()]
        if self._options.on("snapshot-numbered-anew"):
            for robot in robots:
                self._world.record(robot, (stream.topic,))
        self._send(stream, robots, update=False)

    def _send(self, stream: Stream, robots: list[Robot], update: bool) -> None:
        if not robots:
            return
        if stream.topic in MAP_FIELDS and not self._options.on("maps-one-robot-each"):
            groups = [robots]
        else:
            groups = [[robot] for robot in robots]
        for group in groups:
            self._queue(stream, self._compose(stream, group, update), update)

    def _queue(self, stream: Stream, message: Json, update: bool) -> None:
        stream.sent += 1
        stream.updates += update
        if (
            update
            and stream.updates > 3
            and self._options.topic_is("battery-stops-after-three", stream.topic, "battery")
        ):
            return
        self.outbox.append(Letter(stream, message, update))
        if update and self._options.topic_is("update-doubled", stream.topic, "battery", "wifi"):
            self.outbox.append(Letter(stream, copy.deepcopy(message), update))

    def _compose(self, stream: Stream, robots: list[Robot], update: bool) -> Json:
        entries: dict[str, Json] = {}
        shared: Json | None = None
        for robot in robots:
            metadata = self._metadata(stream, robot, update)
            if self._options.topic_is("map-shares-metadata", stream.topic, WIFI, "errorCodes"):
                shared = shared or metadata
                metadata = shared
            entry: Json = {"metadata": metadata} | self._content(stream, robot, update)
            if update and self._options.topic_is("online-updates-without-metadata", stream.topic, "connection"):
                entry.pop("metadata")
            entries[self._shown_id(stream, robot, update)] = entry
        if stream.topic in MAP_FIELDS:
            if update and self._options.topic_is("error-map-blanks-others", stream.topic, "errorCodes"):
                entries |= self._blanks(stream, entries)
            return {MAP_FIELDS[stream.topic]: entries}
        robot_id, entry = next(iter(entries.items()))
        message = {"metadata": entry.pop("metadata"), "robotId": robot_id} | entry
        if update and self._options.topic_is("navigation-updates-without-id", stream.topic, "navigationState"):
            message.pop("robotId")
        return message

    def _blanks(self, stream: Stream, entries: dict[str, Json]) -> dict[str, Json]:
        others = [self._world.robots[robot_id] for robot_id in stream.selection.robot_ids if robot_id not in entries]
        return {robot.robot_id: {"metadata": self._metadata(stream, robot, True), "codes": []} for robot in others}

    def _shown_id(self, stream: Stream, robot: Robot, update: bool) -> str:
        selection = stream.selection
        if selection.location_id is not None and self._options.topic_is("location-id-as-robot-id", stream.topic, STATE):
            return selection.location_id
        if update and self._options.topic_is("online-update-under-first-id", stream.topic, "connection"):
            return selection.robot_ids[0]
        return robot.robot_id

    def _metadata(self, stream: Stream, robot: Robot, update: bool) -> Json:
        event = robot.events[stream.topic]
        if self._options.on("counter-per-stream"):
            event = Metadata(stream.sent, event.timestamp)
        if not update and self._options.on("snapshot-number-ahead"):
            event = Metadata(event.number + 100, event.timestamp)
        if self._options.on("timestamp-of-sending"):
            event = Metadata(event.number, self._world.clock.read(robot.index))
        metadata = event.as_json()
        if self._options.topic_is("battery-without-timestamp", stream.topic, "battery"):
            metadata.pop("timestamp")
        return metadata

    def _content(self, stream: Stream, robot: Robot, update: bool) -> Json:
        on = self._options.on
        content = self._views.content(robot, stream.topic)
        previous = stream.base.get(robot.robot_id, {})
        if not update and self._options.topic_is("error-snapshot-from-start", stream.topic, "errorCodes"):
            return {"codes": list((robot.first_state.get("errorCodes") or {}).get("codes") or [])}
        if not update and self._options.topic_is("status-snapshot-from-start", stream.topic, STATE):
            return {"robotState": copy.deepcopy(robot.first_state)}
        if update and self._options.topic_is("network-update-one-behind", stream.topic, WIFI):
            stream.base[robot.robot_id] = content
            return previous
        if update and stream.topic == STATE and on("status-update-partial"):
            old = previous.get("robotState", {})
            new = content["robotState"]
            stream.base[robot.robot_id] = copy.deepcopy(content)
            return {"robotState": {part: value for part, value in new.items() if old.get(part) != value}}
        stream.base.setdefault(robot.robot_id, content)
        return content

    def announce(self, robot: Robot, part: str, old: Any, topics: tuple[str, ...], changed: bool) -> None:
        """Queue the updates that a report of the robot causes, on every stream that follows it."""
        streams = list(self._open.values())
        if self._options.on("newest-stream-first"):
            streams.reverse()
        for stream in streams:
            if stream.topic not in topics or not self._reaches(stream, robot):
                continue
            if worth_telling(self._options, stream.topic, robot, part, old, changed):
                self._update(stream, robot, part)

    def _reaches(self, stream: Stream, robot: Robot) -> bool:
        on = self._options.on
        selection = stream.selection
        if self._options.topic_is("navigation-update-to-everyone", stream.topic, "navigationState"):
            return True
        if not stream.follows(robot.robot_id):
            return False
        if on("later-ids-without-updates") and selection.location_id is None:
            return robot.robot_id == selection.robot_ids[0]
        if on("moved-robot-lost") and selection.location_id is None:
            return robot.location_id == self._world.first_locations[robot.robot_id]
        if on("one-stream-per-topic"):
            same = [other for other in self._open.values() if other.topic == stream.topic]
            return stream.number == max(other.number for other in same)
        if on("restart-cuts-updates") and robot.restarted:
            return False
        return not (on("reconnect-leaves-deaf") and robot.was_offline and stream.topic not in ("connection", STATE))

    def _update(self, stream: Stream, robot: Robot, part: str) -> None:
        on = self._options.on
        if stream.topic in MAP_FIELDS and on("maps-whole"):
            self._send(stream, [self._world.robots[robot_id] for robot_id in stream.selection.robot_ids], update=True)
            return
        self._send(stream, [robot], update=True)
        if on("status-update-merged") and stream.topic == STATE:
            letter = self.outbox[-1]
            kept = stream.base[robot.robot_id]["robotState"]
            assert letter.message is not None
            shown = letter.message["robotState"]
            merged = {name: value for name, value in kept.items() if name != part}
            letter.message["robotState"] = merged | ({part: shown[part]} if part in shown else {})

    def repeat(self) -> None:
        """Send the whole state once more on the streams of SubscribeRobotStatus."""
        for stream in list(self._open.values()):
            if stream.topic == STATE:
                for robot_id in stream.selection.robot_ids:
                    robot = self._world.robots[robot_id]
                    self._world.record(robot, (STATE,))
                    self._send(stream, [robot], update=True)

    def show_again(self, robot: Robot) -> None:
        """Send the robot's latest values on every stream that follows it, as after its restart."""
        for stream in list(self._open.values()):
            if stream.follows(robot.robot_id):
                self._send(stream, [robot], update=True)

    def moved(self, robot: Robot, location_id: str) -> None:
        """Follow a robot that came to a location, and leave one that went from it."""
        on = self._options.on
        if on("membership-frozen"):
            return
        for stream in list(self._open.values()):
            if stream.selection.location_id is None:
                continue
            ids = stream.selection.robot_ids
            if stream.selection.location_id == location_id:
                if robot.robot_id not in ids and (robot.owned or on("foreign-robot-at-location-served")):
                    ids.append(robot.robot_id)
                    if not on("newcomer-waits"):
                        self._snapshot(stream, [robot.robot_id])
            elif robot.robot_id in ids and not on("membership-grows"):
                ids.remove(robot.robot_id)
                if not ids and on("emptied-location-ends"):
                    del self._open[stream.number]
                    self.outbox.append(Letter(stream, None, False))
