"""A robot to test client code with: it answers the mission API as the Mission page says, in this process.

    robot = Robot(destinations=["kitchen", "table-1"])
    mission = robot.create_mission(navigate("table-1"))
    robot.goal_reached()
    robot.mission(mission).state is State.STATE_SUCCEEDED

A call returns what the page promises or raises the documented error (`missionfsm.fakes.errors`), which names the
rule and its place on the page. What is not a call is the robot's own doing, and the test's to decide: a goal is
reached, a mission fails, the next call fails. Where the page can be read in several ways, `readings` says which the
robot follows (``missionfsm readings bear.mission`` lists them). There is no clock and no chance: the same calls give
the same answers and the same ids. A robot is for one thread at a time; `missionfsm.Shared` makes it one for several.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping

from attrs import frozen

from missionfsm.bear.mission.codec import EPOCH
from missionfsm.bear.mission.describe import describe
from missionfsm.bear.mission.render import rendered
from missionfsm.bear.mission.state import Family, World
from missionfsm.bear.mission.system import SYSTEM
from missionfsm.bear.mission.views import Listing, listing
from missionfsm.bear.wire.messages import (
    Command,
    EventMetadata,
    Mission,
    MissionState,
    MissionStates,
    MissionStatus,
    MissionWorkflow,
)
from missionfsm.bear.wire.protojson import camel, read, write
from missionfsm.fakes.fake import Fake
from missionfsm.fakes.updates import Updates as AnyUpdates
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.history import Answer, Name
from missionfsm.kernel.rules import OK
from missionfsm.kernel.text import brief
from missionfsm.tools.reference.model import Reply, Sent, Snapshot
from missionfsm.tools.reference.stamps import Stamps

_USUAL = World()

Callback = Callable[[MissionStatus], object]


@frozen
class Moment:
    """Where a robot stood, as a value: see `Robot.snapshot`."""

    here: Snapshot
    unread: tuple[tuple[Name, tuple[MissionStatus, ...]], ...] = ()


Updates = AnyUpdates[MissionStatus]
"""A subscription to a robot's mission status: a ``for`` loop over it takes the updates since the last loop."""


class Robot(Fake[Updates]):
    """A robot that does what the Mission page says.

    Args:
        family: ``base``, ``servi`` or ``carti``.
        destinations: the display names on its map.
        occupied: the destinations that another robot holds or claims.
        contact_dock: whether it has a contact-based charging dock.
        charging_location: whether its map has a contact charger.
        blocked: whether it is unable to start a mission.
        readings: ambiguity id to letter, such as ``{"AM-09": "b"}``; the others follow their defaults.
        clock: seconds since the epoch of 1970, for the timestamps of updates; without one there is a second for every
            event.

    Raises:
        ValueError: a family, an ambiguity or a letter that does not exist.
    """

    def __init__(  # noqa: PLR0913 - what a robot is made of, each with a default
        self,
        family: Family | str = _USUAL.family,
        *,
        destinations: Iterable[str] = _USUAL.destinations,
        occupied: Iterable[str] = _USUAL.occupied,
        contact_dock: bool = _USUAL.contact_dock,
        charging_location: bool = _USUAL.charging_location,
        blocked: bool = _USUAL.blocked,
        readings: Mapping[str, str] | None = None,
        clock: Callable[[], float] | None = None,
    ) -> None:
        self._seconds = float if clock is None else Stamps(lambda: clock() - EPOCH.timestamp())
        self._on_the_way: deque[tuple[Updates, MissionStatus]] = deque()
        self._delivering = False
        fields = {
            "family": family.value if isinstance(family, Family) else family,
            "destinations": _texts(destinations),
            "occupied": _texts(occupied),
            "contactDock": contact_dock,
            "chargingLocation": charging_location,
            "blocked": blocked,
        }
        super().__init__(SYSTEM, fields, readings)

    def __repr__(self) -> str:
        return f"<Robot {self._here.state.world.family.value}: {describe(self._here.state)}>"

    # The calls of the Mission page.

    def create_mission(self, mission: Mission | JSON) -> str:
        """CreateMission: the first mission of a robot that has nothing to do. Returns its id.

        Args:
            mission: a message of `missionfsm.fakes.missions`, or the protobuf JSON of a ``Mission``.

        Raises:
            FailedPrecondition: a mission is active or waits, or the robot is unable to start one.
            InvalidArgument: the mission is malformed, for another family, or its goals are invalid.
        """
        return self._one("CreateMission", {"mission": _json(mission)})

    def create_mission_batch(self, missions: Iterable[Mission | JSON]) -> tuple[str, ...]:
        """CreateMissionBatch: several first missions, all of them or none. Returns their ids in the same order.

        Raises as `create_mission` does.
        """
        return self._ids("CreateMissionBatch", {"missions": [{"mission": _json(one)} for one in missions]})

    def create_mission_workflow(self, workflow: MissionWorkflow | JSON) -> tuple[str, ...]:
        """CreateMissionWorkflow: a preset of `missionfsm.fakes.workflows`. Returns the ids of what it created.

        Raises as `create_mission` does.
        """
        return self._ids("CreateMissionWorkflow", {"missionWorkflow": _json(workflow)})

    def append_mission(self, mission: Mission | JSON) -> str:
        """AppendMission: one more mission at the end of the queue. Returns its id.

        Raises:
            FailedPrecondition: there is no mission in the queue.
            InvalidArgument: as for `create_mission`.
        """
        return self._one("AppendMission", {"mission": _json(mission)})

    def append_mission_batch(self, missions: Iterable[Mission | JSON]) -> tuple[str, ...]:
        """AppendMissionBatch: several more missions, all of them or none. Returns their ids in the same order.

        Raises as `append_mission` does.
        """
        return self._ids("AppendMissionBatch", {"missions": [{"mission": _json(one)} for one in missions]})

    def charge_robot(self) -> str:
        """ChargeRobot: a mission that takes the robot to its charger. Returns its id.

        Raises:
            FailedPrecondition: another mission is active or waits.
            NotFound: the map has no charging location, or the robot no dock.
        """
        return self._one("ChargeRobot", {})

    def clear_mission_status(self) -> tuple[str, ...]:
        """ClearMissionStatus: forget the missions that have ended. Returns their ids.

        Raises:
            FailedPrecondition: a mission is running or paused.
        """
        return self._ids("ClearMissionStatus", {})

    def skip_goal(self) -> str:
        """SkipGoal: on to the next goal of the running mission. Returns the mission's id.

        Raises:
            FailedPrecondition: no mission is running.
        """
        return self._one("SkipGoal", {})

    def update_mission(self, mission_id: str, command: Command | str | int) -> None:
        """UpdateMission: command the active mission.

        Args:
            mission_id: which mission it is about.
            command: a `Command`, or its name or number as in protobuf JSON.

        Raises:
            FailedPrecondition: the mission has ended, or the command does not fit the state that it is in.
            InvalidArgument: the command is none, or the id is that of no mission.
            NotFound: the mission still waits.
        """
        wanted = command.name if isinstance(command, Command) else command
        self._ids("UpdateMission", {"missionCommand": {"missionId": mission_id, "command": wanted}})

    def cancel(self, mission_id: str) -> None:
        """UpdateMission with COMMAND_CANCEL; raises as `update_mission` does."""
        self.update_mission(mission_id, Command.COMMAND_CANCEL)

    def pause(self, mission_id: str) -> None:
        """UpdateMission with COMMAND_PAUSE; raises as `update_mission` does."""
        self.update_mission(mission_id, Command.COMMAND_PAUSE)

    def resume(self, mission_id: str) -> None:
        """UpdateMission with COMMAND_RESUME; raises as `update_mission` does."""
        self.update_mission(mission_id, Command.COMMAND_RESUME)

    def finish(self, mission_id: str) -> None:
        """UpdateMission with COMMAND_FINISH; raises as `update_mission` does."""
        self.update_mission(mission_id, Command.COMMAND_FINISH)

    def updates(self, callback: Callback | None = None) -> Updates:
        """SubscribeMissionStatus: the updates from now on, the latest state first.

        Args:
            callback: called with every update as it comes, in the place of keeping it to be taken.
        """
        found: Updates = AnyUpdates(callback)
        names = self._ask("SubscribeMissionStatus", {}, found).names
        self._subscriptions[names[0]] = found
        return found

    def call(self, method: str, params: JSON) -> JSON:
        """Any call in protobuf JSON, malformed ones included: request message to response message.

        Raises:
            ApiError: the documented error.
            ValueError: there is no such call, or it opens a stream (`updates` does that).
        """
        codec = SYSTEM.codec
        if method not in codec.methods or method in codec.streams:
            unary = ", ".join(one for one in codec.methods if one not in codec.streams)
            message = f"{brief(method)} is no call of the mission API with one answer; those are {unary}"
            raise ValueError(message)
        names = self._ask(method, params).names
        return codec.write_answer(method, Answer(OK), names)

    def _one(self, method: str, params: JSON) -> str:
        return self._ids(method, params)[0]

    def _ids(self, method: str, params: JSON) -> tuple[str, ...]:
        return tuple(map(str, self._ask(method, params).names))

    # The robot's own doing.

    def goal_reached(self) -> bool:
        """The running mission is done with its goal: it goes on to the next, or ends well after the last.

        False, and nothing happens, where no mission with goals is running.
        """
        return self._drive({"event": "goalReached"})

    def mission_succeeded(self) -> bool:
        """The running mission ends well: a patrol has done enough, the battery is full. False if none is running."""
        return self._drive({"event": "missionSucceeded"})

    def mission_failed(self) -> bool:
        """The running or paused mission fails. False if there is none."""
        return self._drive({"event": "missionFailed"})

    def world(
        self,
        *,
        destinations: Iterable[str] | None = None,
        occupied: Iterable[str] | None = None,
        contact_dock: bool | None = None,
        charging_location: bool | None = None,
        blocked: bool | None = None,
    ) -> None:
        """The world becomes another; what is left out stays as it is. Arguments are those of `Robot`."""
        flags = {"contact_dock": contact_dock, "charging_location": charging_location, "blocked": blocked}
        lists = {"destinations": destinations, "occupied": occupied}
        fields: dict[str, JSON] = {camel(name): flag for name, flag in flags.items() if flag is not None}
        fields |= {name: _texts(names) for name, names in lists.items() if names is not None}
        self._drive({"event": "world", **fields})

    def fail_next(self, code: str = "INTERNAL", *, applied: bool = False) -> None:
        """Let the next call fail that would succeed and whose Errors table has the code.

        Args:
            code: ``INTERNAL`` or ``DEADLINE_EXCEEDED``.
            applied: whether the call takes effect all the same.

        Raises:
            ValueError: another code.
        """
        self._drive({"event": "fault", "status": code, "applied": applied})

    # What can be seen.

    @property
    def status(self) -> MissionStates:
        """What a subscriber would be shown now: all listed missions, and which of them is active."""
        return self._message(listing(self._here.state), self._here.state.listed(self._here.names))

    def mission(self, mission_id: str) -> MissionState:
        """One listed mission as a subscriber would be shown it. Raises KeyError if it is not listed."""
        for one in self.status.missions:
            if one.mission_id == mission_id:
                return one
        listed = ", ".join(map(str, self._here.names)) or "none"
        message = f"no mission {mission_id!r} is listed; listed: {listed}"
        raise KeyError(message)

    def _message(self, view: Listing, names: tuple[Name, ...]) -> MissionStates:
        return rendered(view, tuple(map(str, names)), self._model.choice)

    def _deliver(self, reply: Reply, opened: Updates | None = None) -> None:
        """Hand the messages to subscribers, in order: messages that a callback causes come after all others."""
        for sent in reply.sent:
            updates = self._subscriptions.get(sent.channel, opened)
            if updates is not None:
                self._on_the_way.append((updates, self._update(sent)))
        if self._delivering:
            return
        self._delivering = True
        try:
            while self._on_the_way:
                updates, update = self._on_the_way.popleft()
                updates._come(update)  # noqa: SLF001 - a subscription is filled here and nowhere else
        finally:
            self._delivering = False

    def _update(self, sent: Sent) -> MissionStatus:
        message = SYSTEM.codec.write_message(
            sent.view, sent.names, self._model.choice, sent.number, self._seconds(sent.number)
        )
        return MissionStatus(read(EventMetadata, message["metadata"]), self._message(sent.view, sent.names))

    # Back and forth.

    def snapshot(self) -> Moment:
        """Where the robot stands, as a value to `restore`; it never changes."""
        self._give_up()
        return Moment(self._here, tuple((channel, tuple(one._unread)) for channel, one in self._subscriptions.items()))  # noqa: SLF001 - as above

    def restore(self, moment: Moment) -> None:
        """Go back to where the robot stood, ids and updates not yet taken included.

        Subscriptions that were made since are closed; those that were given up since stay so.
        """
        unread = dict(moment.unread)
        for channel, updates in tuple(self._subscriptions.items()):
            if channel in unread and updates.open:
                updates._put_back(unread[channel])  # noqa: SLF001 - as above
            else:
                updates.cancel()
                del self._subscriptions[channel]
        self._here = moment.here
        for channel in unread:
            if channel not in self._subscriptions:
                self._here = self._model.cancel(self._here, channel)


def _texts(names: Iterable[str]) -> list[str]:
    if isinstance(names, str):
        message = f"{names!r} is one text, not several: write [{names!r}]"
        raise TypeError(message)
    return list(names)


def _json(message: Mission | MissionWorkflow | JSON) -> JSON:
    """The protobuf JSON of a message; JSON stays as it is."""
    return write(message) if isinstance(message, Mission | MissionWorkflow) else message
