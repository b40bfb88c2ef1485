"""Faults of batches and of appending."""

from __future__ import annotations

from typing import Any

from catalogue import bug
from errors import Refusal, not_found, not_now
from model import Json, Mission, Plan, State
from service import Commit, Fault, Robot

# CreateMissionBatch


class _HalfBatch(Robot):
    """Takes in the valid beginning of a batch that is refused."""

    half = ""

    def read_entries(self, entries: list[Any]) -> list[Plan]:
        plans: list[Plan] = []
        try:
            for entry in entries:
                plans.append(self.read_mission_request(entry))
        except Refusal:
            free = self.current is None and not self.queued()
            if plans and self.method == self.half and free == self.half.startswith("Create"):
                self.append(plans)
            raise
        return plans


@bug("CreateMissionBatch")
class _BatchNotAtomic(_HalfBatch):
    """A CreateMissionBatch that is refused for a malformed entry creates the missions before that entry."""

    half = "CreateMissionBatch"


@bug("AppendMissionBatch")
class _AppendBatchNotAtomic(_HalfBatch):
    """An AppendMissionBatch that is refused for a malformed entry appends the missions before that entry."""

    half = "AppendMissionBatch"


@bug("CreateMissionBatch › Errors")
class _BatchDropsMalformed(Robot):
    """Malformed entries of a batch are left out, and the others accepted."""

    def read_entries(self, entries: list[Any]) -> list[Plan]:
        plans = []
        for entry in entries:
            try:
                plans.append(self.read_mission_request(entry))
            except Refusal as refusal:
                problem = refusal
        if not plans:
            raise problem
        return plans


class _LastEntryUnread(Robot):
    """Does not check the destinations of the last entry of a batch."""

    trusting = False
    careless = ""

    def read_entries(self, entries: list[Any]) -> list[Plan]:
        plans = [self.read_mission_request(entry) for entry in entries[:-1]]
        self.trusting = bool(plans) and self.method == self.careless
        try:
            return [*plans, self.read_mission_request(entries[-1])]
        finally:
            self.trusting = False

    def on_map(self, destination: str) -> bool:
        return self.trusting or super().on_map(destination)


@bug("CreateMissionBatch › Errors")
class _BatchLastEntryUnchecked(_LastEntryUnread):
    """The goals of the last mission in a CreateMissionBatch are not compared with the map."""

    careless = "CreateMissionBatch"


@bug("AppendMissionBatch › Errors")
class _AppendBatchLastEntryUnchecked(_LastEntryUnread):
    """The goals of the last mission in an AppendMissionBatch are not compared with the map."""

    careless = "AppendMissionBatch"


@bug("CreateMissionBatch › Response")
class _BatchIdsReversed(Robot):
    """CreateMissionBatch answers the ids in reverse order."""

    def create(self, plans: list[Plan]) -> list[str]:
        return super().create(plans)[::-1]


@bug("CreateMissionBatch")
class _BatchQueuedReversed(Robot):
    """CreateMissionBatch queues its missions last one first, and answers the ids in the order of the queue."""

    def create(self, plans: list[Plan]) -> list[str]:
        return super().create(plans[::-1])


@bug("CreateMissionBatch › Response")
class _BatchFirstIdOnly(Robot):
    """CreateMissionBatch answers the id of its first mission alone."""

    def create_mission_batch(self, request: Json) -> Commit:
        commit = super().create_mission_batch(request)
        return lambda: {"missionIds": commit()["missionIds"][:1]}


@bug("CreateMissionBatch")
class _BatchCreatesTwo(Robot):
    """CreateMissionBatch takes in two missions at most; the other ids that it answers are never listed."""

    def create(self, plans: list[Plan]) -> list[str]:
        return [*super().create(plans[:2]), *[self.new_id() for _ in plans[2:]]]


@bug("CreateMissionBatch")
class _BatchSharesGoals(Robot):
    """All missions of a batch have the goals of its last one."""

    def read_entries(self, entries: list[Any]) -> list[Plan]:
        plans = super().read_entries(entries)
        for plan in plans:
            plan.goals[:] = plans[-1].goals
        return plans


@bug("CreateMissionBatch")
class _BatchRunsAll(Robot):
    """All missions of a CreateMissionBatch run at once."""

    def create(self, plans: list[Plan]) -> list[str]:
        ids = super().create(plans)
        for mission in self.queued():
            mission.state = State.RUNNING
        self.changed()
        return ids


class _EmptyListAccepted(Robot):
    """Accepts a batch without entries."""

    careless = ""

    def list_of(self, value: object, what: str) -> list[Any]:
        if what == "missions" and not value and self.method == self.careless:
            return []
        return super().list_of(value, what)

    def create(self, plans: list[Plan]) -> list[str]:
        return super().create(plans) if plans else []


@bug("CreateMissionBatch › Errors")
class _EmptyBatchAccepted(_EmptyListAccepted):
    """A CreateMissionBatch without missions is accepted and answers no ids."""

    careless = "CreateMissionBatch"


@bug("AppendMissionBatch › Errors")
class _EmptyAppendBatchAccepted(_EmptyListAccepted):
    """An AppendMissionBatch without missions is accepted and answers no ids."""

    careless = "AppendMissionBatch"


@bug("CreateMissionBatch › Errors")
class _BatchWhileRunning(Robot):
    """CreateMissionBatch on a busy robot appends its missions."""

    def require_free(self) -> None:
        if self.method != "CreateMissionBatch" or self.current is None:
            super().require_free()


@bug("CreateMissionBatch › Errors")
class _BatchIgnoresBlocked(Robot):
    """CreateMissionBatch is accepted by a robot that cannot start any."""

    def require_able(self) -> None:
        if self.method != "CreateMissionBatch":
            super().require_able()


@bug("CreateMissionBatch › Errors")
class _BatchRefusedAfterEnd(Robot):
    """CreateMissionBatch is refused while ended missions are listed."""

    def require_free(self) -> None:
        super().require_free()
        if self.method == "CreateMissionBatch" and self.missions:
            raise not_now("there are missions")


@bug("CreateMissionBatch")
class _FailedBatchLeavesFirst(Robot):
    """A CreateMissionBatch that fails with INTERNAL leaves its first mission running."""

    def fail(self, fault: Fault, commit: Commit) -> None:
        super().fail(fault, commit)
        if self.method == "CreateMissionBatch" and not fault.applied and fault.status == "INTERNAL":
            self.create(self.plans[:1])

    def read_entries(self, entries: list[Any]) -> list[Plan]:
        self.plans = super().read_entries(entries)
        return self.plans

    plans: list[Plan] = []


# AppendMission and AppendMissionBatch


@bug("AppendMission › Errors")
class _AppendCreatesFirst(Robot):
    """AppendMission on a robot that lists no missions creates the first one."""

    def require_queue(self) -> None:
        if self.method != "AppendMission" or self.missions:
            super().require_queue()


@bug("AppendMissionBatch › Errors")
class _AppendBatchCreatesFirst(Robot):
    """AppendMissionBatch on a robot that lists no missions creates them."""

    def require_queue(self) -> None:
        if self.method != "AppendMissionBatch" or self.missions:
            super().require_queue()


@bug("AppendMission › Errors")
class _AppendToNothingNotFound(Robot):
    """AppendMission to an empty queue is answered with NOT_FOUND."""

    def require_queue(self) -> None:
        try:
            super().require_queue()
        except Refusal as refusal:
            raise not_found(refusal.message) from None


@bug("AppendMission")
class _AppendJumpsQueue(Robot):
    """AppendMission puts the new mission right behind the active one."""

    def append(self, plans: list[Plan]) -> list[str]:
        missions = [self.make(plan) for plan in plans]
        if self.current is None or self.method != "AppendMission":
            return super().append(plans)
        place = self.missions.index(self.current) + 1
        self.missions[place:place] = missions
        self.changed()
        return [mission.mission_id for mission in missions]


@bug("AppendMissionBatch")
class _AppendBatchRefusedWhenQueued(Robot):
    """AppendMissionBatch is refused when a mission is already waiting."""

    def require_queue(self) -> None:
        super().require_queue()
        if self.method == "AppendMissionBatch" and self.queued():
            raise not_now("a mission is already waiting")


@bug("AppendMission › Errors")
class _AppendRefusedWhilePaused(Robot):
    """AppendMission is refused while the active mission is paused."""

    def require_queue(self) -> None:
        super().require_queue()
        if self.current is not None and self.current.state is State.PAUSED:
            raise not_now("the mission is paused")


@bug("AppendMission")
class _AppendRunsAtOnce(Robot):
    """A mission that is appended is set running beside the active one."""

    def append(self, plans: list[Plan]) -> list[str]:
        ids = super().append(plans)
        for mission in self.queued():
            mission.state = State.RUNNING
        self.changed()
        return ids


@bug("AppendMission › Errors")
class _AppendGoalsUnchecked(Robot):
    """AppendMission does not compare goals with the map."""

    def on_map(self, destination: str) -> bool:
        return super().on_map(destination) or (self.method == "AppendMission" and bool(destination))


@bug("AppendMission")
class _AppendResumesPaused(Robot):
    """AppendMission sets a paused mission running again."""

    def append(self, plans: list[Plan]) -> list[str]:
        if self.current is not None:
            self.current.state = State.RUNNING
        return super().append(plans)


@bug("AppendMission")
class _FourthMissionLost(Robot):
    """What is appended as the fourth mission or later is answered with an id and lost."""

    def take_in(self, plans: list[Plan]) -> list[Mission]:
        missions = super().take_in(plans)
        if self.method.startswith("Append"):
            lost = [mission for mission in missions if len([m for m in self.missions if not m.ended]) > 3]
            self.missions = [mission for mission in self.missions if mission not in lost]
        return missions


@bug("AppendMissionBatch › Response")
class _AppendBatchIdsReversed(Robot):
    """AppendMissionBatch answers the ids in reverse order."""

    def append(self, plans: list[Plan]) -> list[str]:
        return super().append(plans)[::-1]


@bug("AppendMissionBatch")
class _AppendBatchReversed(Robot):
    """AppendMissionBatch appends its missions last one first."""

    def append(self, plans: list[Plan]) -> list[str]:
        return super().append(plans[::-1])


@bug("AppendMission")
class _AppendedGoalsAreShared(Robot):
    """A mission of the same type that is appended brings its goals to the one before it, too."""

    def append(self, plans: list[Plan]) -> list[str]:
        if self.missions and self.missions[-1].kind == plans[0].kind and not self.missions[-1].ended:
            self.missions[-1].goals = plans[0].goals
        return super().append(plans)
