"""Mission › SubscribeMissionStatus, what the robot does by itself, and what holds at all times."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import strategies as st
from hypothesis.stateful import consumes, invariant, precondition, rule
from mission_base import BUSY, IDLE, SELDOM, STREAMS, Fault, MissionBase, Subscription
from mission_model import (
    ACTIVE,
    ENDED,
    FAILED,
    PAUSED,
    RUNNING,
    SUCCEEDED,
    WAITING,
    active,
    ends,
    indices,
    next_runs,
    put,
)
from mission_requests import PLACES

from missionfsm import State
from missionfsm.bear.wire.messages import MissionState, MissionStates

_NEXT = {
    # UpdateMission › Command enum and SubscribeMissionStatus › State enum: a mission waits, runs, is paused and resumed
    # and ends; it may be gone through by more than one change between two messages.
    WAITING: {WAITING, RUNNING, *ENDED},
    RUNNING: {RUNNING, PAUSED, *ENDED},
    PAUSED: {PAUSED, RUNNING, *ENDED},
    **{state: {state} for state in ENDED},
}


class Watching(MissionBase):
    """The stream, the environment and the invariants."""

    # SubscribeMissionStatus

    @rule(target=STREAMS)
    @precondition(lambda self: len(self.subscriptions) < 3)
    def subscribe_mission_status(self) -> Subscription:
        """SubscribeMissionStatus: the latest known state is sent at once.

        Its Errors table has two rows. INVALID_ARGUMENT: the request has no fields, so there is nothing in it that could
        be wrong. INTERNAL: a stream of this robot does not break down; the client would subscribe again.
        """
        subscription = Subscription(self.robot)
        assert [one.mission_states for one in subscription.messages] == [self.robot.status]
        self.subscriptions.append(subscription)
        return subscription

    @rule(subscription=consumes(STREAMS))
    def unsubscribe(self, subscription: Subscription) -> None:
        """Who gives a subscription up is sent nothing more."""
        subscription.updates.cancel()
        self.subscriptions.remove(subscription)
        subscription.messages.clear()
        self.robot.goal_reached()  # something that may be shown
        assert subscription.messages == []
        self.goal_was_reached(happened=None)

    # What the robot does by itself.

    def goal_was_reached(self, *, happened: bool | None) -> None:
        """The running mission is done with its goal: on to the next; after the last it succeeds, a patrol starts over.

        Args:
            happened: what the robot said; None where nobody listened.
        """
        running = next(iter(indices(self.missions, RUNNING)), None)
        if running is None or self.missions[running].kind == "charge":
            assert not happened
            self.stays()
            return
        mission = self.missions[running]
        if mission.kind == "other":
            further = put(self.missions, running, RUNNING, None)
            self.becomes(self.missions, further, *ends(self.world, self.missions, running, SUCCEEDED))
            return
        assert happened is not False
        assert mission.at is not None
        if mission.kind in ("list", "patrol") and mission.at < len(mission.goals or ()) - 1:
            self.becomes(put(self.missions, running, RUNNING, mission.at + 1))
        elif mission.kind == "patrol":
            self.becomes(put(self.missions, running, RUNNING, 0))
        else:
            self.becomes(*ends(self.world, self.missions, running, SUCCEEDED))

    @IDLE
    @rule()
    def nothing_happens(self) -> None:
        """Where no mission is active, none is done with a goal, succeeds or fails."""
        self.seldom += 1
        assert not self.robot.goal_reached()
        assert not self.robot.mission_succeeded()
        assert not self.robot.mission_failed()
        self.stays()

    @BUSY
    @rule(times=st.integers(1, 3))
    def goal_reached(self, times: int) -> None:
        """A goal is reached, or several one after the other. Mission › ServiType, CartiType, BaseType enum."""
        for _ in range(times):
            self.goal_was_reached(happened=self.robot.goal_reached())

    @BUSY
    @rule()
    def mission_succeeded(self) -> None:
        """The running mission ends well; a paused one does not. Mission › State enum."""
        happened = self.robot.mission_succeeded()
        running = indices(self.missions, RUNNING)
        assert happened == bool(running)
        self.becomes(*(ends(self.world, self.missions, running[0], SUCCEEDED) if running else [self.missions]))

    @BUSY
    @rule()
    def mission_failed(self) -> None:
        """The running or paused mission encounters a failure. Mission › State enum."""
        index = active(self.missions)
        assert index is not None
        assert self.robot.mission_failed()
        self.becomes(*ends(self.world, self.missions, index, FAILED))

    @precondition(lambda self: self.fault is None)
    @rule(code=st.sampled_from(["INTERNAL", "DEADLINE_EXCEEDED"]), applied=st.booleans())
    def next_call_fails(self, *, code: str, applied: bool) -> None:
        """The next call that would succeed is answered with a row of its table that is nobody's fault."""
        self.robot.fail_next(code, applied=applied)
        self.fault = Fault(code, applied)
        self.stays()

    @SELDOM
    @rule(
        destinations=st.sets(st.sampled_from(PLACES), min_size=3).map(lambda found: tuple(sorted(found))),
        occupied=st.sets(st.sampled_from(PLACES), max_size=2).map(lambda found: tuple(sorted(found))),
    )
    def map_changes(self, destinations: tuple[str, ...], occupied: tuple[str, ...]) -> None:
        """Destinations come and go, and others occupy some.

        Open: what becomes of a mission that is on its way to a place that is not on the map any more.
        """
        self.seldom += 1
        self.robot.world(destinations=destinations, occupied=occupied)
        self.world = self.world._replace(destinations=destinations, occupied=occupied)
        index = active(self.missions)
        found = [self.missions]
        if index is not None and not self.world.knows(self.missions[index].goals):
            found += ends(self.world, self.missions, index, FAILED)
        if index is not None and self.missions[index].kind == "other":  # it may find a free goal now
            found.append(put(self.missions, index, self.missions[index].state, None))
        self.becomes(*found)

    @SELDOM
    @rule(contact_dock=st.booleans(), charging_location=st.booleans(), blocked=st.booleans())
    def robot_changes(self, *, contact_dock: bool, charging_location: bool, blocked: bool) -> None:
        """Docks come and go, and the robot becomes unable to start a mission, or able again."""
        self.seldom += 1
        self.robot.world(contact_dock=contact_dock, charging_location=charging_location, blocked=blocked)
        self.world = self.world._replace(
            contact_dock=contact_dock, charging_location=charging_location, blocked=blocked
        )
        self.becomes(self.missions, *(next_runs(self.world, self.missions) if active(self.missions) is None else []))

    # What holds at all times.

    @invariant()
    def the_index_is_that_of_the_active_mission(self) -> None:
        """SubscribeMissionStatus › MissionStates › current_mission_index: -1 if no mission is active."""
        index = active(self.missions)
        assert self.robot.status.current_mission_index == (-1 if index is None else index)

    @invariant()
    def one_mission_is_active(self) -> None:
        """Missions are executed one after the other, in the order in which they were appended."""
        for message in self.shown():
            states = [one.state for one in message.missions]
            assert sum(state in ACTIVE for state in states) <= 1
            first = next((index for index, state in enumerate(states) if state in (WAITING, *ACTIVE)), len(states))
            assert not any(state in ACTIVE or state in ENDED for state in states[first + 1 :])

    @invariant()
    def ids_are_unique(self) -> None:
        """SubscribeMissionStatus › MissionState › mission_id: unique; none that was cleared comes back."""
        ids = [one.mission_id for one in self.robot.status.missions]
        assert len(set(ids)) == len(ids)
        assert all(ids)
        assert self.cleared.isdisjoint(ids)

    @invariant()
    def goals_and_feedback_fit(self) -> None:
        """SubscribeMissionStatus › MissionState: the current goal is one of the goals; feedback is that of the type.

        A mission that has not been run has no feedback (State enum › STATE_DEFAULT).
        """
        for mission in self.robot.status.missions:
            assert 0 <= mission.current_goal_index < max(1, len(mission.goals))
            assert mission.state is not State.STATE_UNKNOWN
            kind, feedback = mission.mission_type, mission.mission_feedback
            if mission.state is WAITING:
                assert feedback is None
            if kind is not None and feedback is not None:
                arms = (feedback.base_feedback, feedback.servi_feedback, feedback.carti_feedback)
                types = (kind.base_type, kind.servi_type, kind.carti_type)
                assert [one is None for one in arms] == [one is None for one in types]

    @invariant()
    def streams_show_the_latest_state(self) -> None:
        """SubscribeMissionStatus: whenever the state changes, every subscriber is sent it."""
        for subscription in self.subscriptions:
            assert subscription.messages[-1].mission_states == self.robot.status

    @invariant()
    def sequence_numbers_grow(self) -> None:
        """SubscribeMissionStatus › EventMetadata › sequence_number: never negative; larger than the last one, or 0."""
        for subscription in self.subscriptions:
            numbers = [one.metadata.sequence_number for one in subscription.messages if one.metadata is not None]
            assert len(numbers) == len(subscription.messages)
            assert all(number >= 0 for number in numbers)
            assert all(after > before or after == 0 for before, after in pairwise(numbers))

    @invariant()
    def what_is_shown_follows_the_lifecycle(self) -> None:
        """SubscribeMissionStatus › State enum: what has ended stays so; nothing that has been run waits again.

        A mission keeps its goals, type and owner as long as it is listed.
        """
        for subscription in self.subscriptions:
            shown = [one.mission_states for one in subscription.messages if one.mission_states is not None]
            for before, after in pairwise(shown):
                was = {one.mission_id: one for one in before.missions}
                for one in after.missions:
                    if one.mission_id in was:
                        _follows(was[one.mission_id], one)
            del subscription.messages[:-1]  # what was looked at once is not looked at again

    def shown(self) -> list[MissionStates]:
        """All messages that came since the last look, and what is shown now."""
        messages = [one.mission_states for subscription in self.subscriptions for one in subscription.messages]
        return [self.robot.status, *(one for one in messages if one is not None)]


def _follows(before: MissionState, after: MissionState) -> None:
    assert after.state in _NEXT[before.state], f"{before} became {after}"
    assert (before.goals, before.mission_type, before.owner) == (after.goals, after.mission_type, after.owner)
