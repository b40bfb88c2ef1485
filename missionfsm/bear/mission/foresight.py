"""Which robots a later status message excludes, so that a search through a recording need not consider them.

Whatever happens to a robot:

- Missions keep their order in the list.
- Ended missions are forgotten together, by a call that makes missions, or clears and empties the list.
- Waiting missions vanish together, where a mission has failed or was cancelled, or where a workflow takes their place.
- A new mission is made by a call and comes last; a charge may come before waiting missions, never before a started one.
- No call makes a mission that is there already, or moves one that has ended.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence

from attrs import frozen

from missionfsm.bear.mission.inputs import Request
from missionfsm.bear.mission.matching import has_goals
from missionfsm.bear.mission.readings.queue import AM_13
from missionfsm.bear.mission.readings.scope import ADDING
from missionfsm.bear.mission.state import Kind, Mission, Robot
from missionfsm.bear.mission.views import Seen
from missionfsm.bear.wire.messages import MissionState, State
from missionfsm.kernel.codec import Malformed

_ACTIVE = (State.STATE_RUNNING, State.STATE_PAUSED)
_BROKEN_OFF = (State.STATE_CANCELED, State.STATE_FAILED)
_CHARGE = Mission(Kind.CHARGE)


def foresees(
    robot: Robot,
    names: tuple[int, ...],
    content: Seen | Malformed,
    shown: tuple[int, ...],
    calls: frozenset[str],
    _topic: Hashable = None,
) -> bool:
    """Whether the robot may come to be shown as the content, by calls of some operations; see `Spec.foresees`."""
    if isinstance(content, Malformed) or not all(content.named):
        return True
    if not shown:
        return not names or _CLEARS in calls
    later = _Later(robot, names, content.states.missions, shown, calls, frozenset(names))
    forgets = not calls.isdisjoint(_FORGETS)
    if robot.assigned:
        return later.started_are_kept() or (forgets and frozenset(shown).isdisjoint(names[: len(robot.done)]))
    return later.all_kept() or (forgets and later.some_forgotten())


def succeeds(
    robot: Robot, names: tuple[int, ...], request: Request, args: tuple[int, ...], answered: tuple[int, ...]
) -> bool:
    """Whether the robot may come to answer a request OK with these names; see `Spec.succeeds`."""
    operation = request.operation
    if operation in _MAKES:
        return all(name not in names for name in answered)
    if operation in ("SkipGoal", "UpdateMission"):
        ended = names[: len(robot.done)]
        return not any(name in ended for name in (*args, *answered))
    return operation != _CLEARS or _may_clear(robot, names, answered)


def _may_clear(robot: Robot, names: tuple[int, ...], cleared: tuple[int, ...]) -> bool:
    """Whether the robot may come to clear the missions with these names: all of them, or those that have ended by then.

    If one of them has ended already, nothing was forgotten before. Then the active mission has to end, and so has every
    mission that has its turn before one of them, since waiting missions vanish together.
    """
    ended = len(robot.done)
    if not any(name in cleared for name in names[:ended]):
        return True
    last = max(at for at, name in enumerate(names) if name in cleared)
    gone = names[: max(last + 1, ended + (robot.active is not None))]
    unseen = sum(name < 0 for name in gone)
    new = sum(name not in names for name in cleared)
    return unseen <= new and all(name < 0 or name in cleared for name in gone)


_MAKES = frozenset(ADDING)
"""Operations that are answered with the names of new missions."""

_CLEARS = "ClearMissionStatus"
"""The operation that may leave the list empty."""

_FORGETS = frozenset({_CLEARS, *AM_13})
"""Operations that may make a robot forget missions that have ended."""


MOST_KEPT = 64
"""Of how many messages it is remembered which missions they list that have ended."""

_KEPT: dict[int, tuple[Sequence[MissionState], tuple[Mission, ...], tuple[int, ...]]] = {}
"""By the identity of the missions of a message: those missions, and the first that have ended, which it lists."""


@frozen
class _Later:
    """A robot, and a message that may come later.

    Attributes:
        robot: the robot.
        names: the names of its missions, in the order of their turns.
        missions: the missions that the message lists.
        shown: their names.
        calls: the operations that may have been called in between.
        known: the names of the missions of the robot.
    """

    robot: Robot
    names: tuple[int, ...]
    missions: Sequence[MissionState]
    shown: tuple[int, ...]
    calls: frozenset[str]
    known: frozenset[int]

    def all_kept(self) -> bool:
        """Whether the message may list every mission that has started, and those first."""
        robot = self.robot
        ended, started = len(robot.done), len(robot.done) + (robot.active is not None)
        return (
            started <= len(self.shown)
            and self._ended_are_kept()
            and (robot.active is None or self._is(robot.active, ended, ended))
            and self._waiting(0, started, survived=started > 0)
        )

    def _ended_are_kept(self) -> bool:
        """Whether the message may list the missions that have ended, and those first.

        Those that it lists by all that is known are not looked at again when more have ended.
        """
        done, names = self.robot.done, self.names[: len(self.robot.done)]
        missions, kept, kept_names = _KEPT.get(id(self.missions), ((), (), ()))
        first = len(kept)
        if missions is not self.missions or done[:first] != kept or names[:first] != kept_names:
            first = 0
        for at in range(first, len(done)):
            if not self._is(done[at], at, at) or self.missions[at].state != done[at].state:
                return False
        if names[first:] == self.shown[first : len(names)]:
            if len(_KEPT) >= MOST_KEPT:
                _KEPT.clear()
            _KEPT[id(self.missions)] = self.missions, done, names
        return True

    def started_are_kept(self) -> bool:
        """Whether the message may list every mission that has started, whatever the order of the turns is."""
        robot, names, shown = self.robot, self.names, self.shown
        ended = len(robot.done)
        started = ended + (robot.active is not None)
        places = {name: place for place, name in enumerate(shown)}
        known = [at for at, name in enumerate(names[:started]) if name in places]
        unseen = sum(name < 0 for name in names[:started])
        if len(known) + unseen < started or unseen > sum(map(self._is_new, range(len(shown)))):
            return False
        if not all(self._is(robot.turns[at], at, places[names[at]]) for at in known):
            return False
        if any(self.missions[places[names[at]]].state != robot.turns[at].state for at in known if at < ended):
            return False
        kept = [places[name] for name in robot.listed(names) if name in places]
        return kept == sorted(kept)

    def some_forgotten(self) -> bool:
        """Whether the message may list what is left once all missions that have ended by then were forgotten."""
        robot, listed = self.robot, frozenset(self.shown)
        ended = len(robot.done)
        if not listed.isdisjoint(self.names[:ended]):
            return False
        if (
            robot.active is not None
            and self.shown
            and self._is(robot.active, ended, 0)
            and self._waiting(0, 1, survived=True)
        ):
            return True
        for first in range(len(robot.pending) + 1):
            before = ended + (robot.active is not None) + first
            if not listed.isdisjoint(self.names[ended:before]):
                return False
            if self._waiting(first, 0, survived=False):
                return True
        return False

    def _is(self, mission: Mission, at: int, place: int) -> bool:
        """Whether the mission with the name at a position may be the one in that place of the message."""
        name, shown = self.names[at], self.shown[place]
        return (name == shown or (name < 0 and self._is_new(place))) and has_goals(mission, self.missions[place])

    def _is_new(self, place: int) -> bool:
        """Whether no mission of the robot has the name in that place of the message."""
        return self.shown[place] not in self.known

    def _is_charge(self, place: int) -> bool:
        """Whether a new mission in that place of the message may be a charge that goes before waiting missions."""
        new = "ChargeRobot" in self.calls and self._is_new(place)
        return new and has_goals(_CHARGE, self.missions[place])

    def _waiting(self, first: int, place: int, *, survived: bool) -> bool:
        """Whether the waiting missions may be what the message lists from a place on.

        Args:
            first: the first of them that is left.
            place: the place in the message.
            survived: whether a mission before them is listed.
        """
        pending, shown = self.robot.pending, self.shown
        behind = len(self.names) - len(pending)
        goes_on = survived and self.robot.active is not None and self.missions[place - 1].state in _ACTIVE
        # The places from which the message may go on, once the first so many of the waiting missions are accounted for.
        places = {place: survived}
        for at in range(first, len(pending) + 1):
            name = behind + at
            if not (goes_on and at < len(pending)) and any(
                self._end_here(name, last, survived=some) for last, some in places.items()
            ):
                return True
            if at == len(pending):
                return False
            following: dict[int, bool] = {}
            for here in places:
                for there in range(here, len(shown)):
                    if self._is(pending[at], name, there):
                        following[there + 1] = True
                    if not self._is_charge(there):
                        break
            places = following
        return False

    def _end_here(self, name: int, place: int, *, survived: bool) -> bool:
        """Whether the missions from a name on may have vanished, and those from a place on may be new."""
        new = range(place, len(self.shown))
        if new and (self.calls.isdisjoint(_MAKES) or not self.known.isdisjoint(self.shown[place:])):
            return False
        if name == len(self.names) or not survived:
            return True
        replaced = "CreateMissionWorkflow" in self.calls and (self.robot.halted or place < len(self.shown))
        # The queue vanishes with the mission that ran last before it: the last one listed, or a charge behind that.
        last = slice(place - 1, len(self.shown) if "ChargeRobot" in self.calls else place)
        return replaced or any(one.state in _BROKEN_OFF for one in self.missions[last])


__all__ = ["foresees", "succeeds"]
