"""Where a silence is all that tells a tester that everything has been seen, what is late is no violation."""

from __future__ import annotations

from attrs import Factory, define, evolve

from missionfsm.kernel.codec import JSON
from missionfsm.kernel.subject import Exchange, Notification
from missionfsm.oracle.automaton import Automaton
from missionfsm.systems import system
from missionfsm.tools.conform.actions import SETTLE, Action
from missionfsm.tools.conform.conversation import Conversation, Partner
from missionfsm.tools.conform.handshake import handshake
from missionfsm.tools.reference.subject import ReferenceSubject

MISSION = system("bear.mission")
NAVIGATE = {"mission": {"baseMission": {"navigateMission": {"goal": {"destinationId": "table-1"}}}}}
WATCHED = (("SubscribeMissionStatus", {}), (SETTLE, {}))


@define
class Distant:
    """The reference behind a network on which every message but the first is late.

    Attributes:
        arrives: whether they come once somebody waits for them; else never.
        patient: how often somebody waited for them.
    """

    arrives: bool
    patient: int = 0
    subject: ReferenceSubject = Factory(lambda: ReferenceSubject(MISSION))
    on_their_way: tuple[Notification, ...] = ()

    def exchange(self, method: str, params: JSON) -> Exchange:
        """What a tester is told."""
        if method == SETTLE and params.get("patiently"):
            self.patient += 1
            return Exchange({}, before=self._came() if self.arrives else ())
        if method == SETTLE:
            return Exchange({})
        answer = self.subject.exchange(method, params)
        if method == "initialize":
            return evolve(answer, result={**answer.result, "settles": "silence"})
        if method == "SubscribeMissionStatus":
            return answer
        self.on_their_way += answer.after
        return evolve(answer, after=())

    def _came(self) -> tuple[Notification, ...]:
        came, self.on_their_way = self.on_their_way, ()
        return came

    def close(self) -> None:
        """Nothing is held."""


def conversation(subject: Distant, *done: tuple[str, JSON]) -> Conversation:
    """Some things done with a subject."""
    info = handshake(MISSION, subject)
    found = Conversation(Partner(MISSION, subject, info), {}, Automaton(MISSION.spec, info.drives))
    for number, (method, params) in enumerate((*WATCHED, *done), 1):
        found.perform(Action(number, method, params))
    return found


def kinds(talk: Conversation) -> list[str]:
    """The kinds of lines of its history, in order."""
    return [next(iter(line)) for line in talk.heard]


def test_what_is_missing_is_waited_for() -> None:
    """An update that is later than a silence is awaited, and stands before the mark that everything has been seen."""
    subject = Distant(arrives=True)
    talk = conversation(
        subject, ("CreateMission", NAVIGATE), (SETTLE, {}), ("drive", {"event": "goalReached"}), (SETTLE, {})
    )
    assert (talk.right, subject.patient) == (True, 2)
    shown = ["stream", "settled"]
    assert kinds(talk) == ["call", "return", *shown, "call", "return", *shown, "drive", *shown]


def test_what_never_comes_is_a_violation_after_it_was_waited_for() -> None:
    """An update that is not there after it was waited for once is missing."""
    subject = Distant(arrives=False)
    talk = conversation(subject, ("CreateMission", NAVIGATE), (SETTLE, {}))
    assert (talk.right, subject.patient) == (False, 1)
    assert talk.judge.violation is not None
    assert talk.judge.violation.observed == "everything settled"


def test_a_subject_that_knows_when_all_was_seen_is_not_asked_twice() -> None:
    """Where an adapter promises that everything was seen, a message that is missing is so at once."""
    subject = Distant(arrives=False)
    info = evolve(handshake(MISSION, subject), silences=False)
    talk = Conversation(Partner(MISSION, subject, info), {}, Automaton(MISSION.spec, info.drives))
    for number, (method, params) in enumerate((*WATCHED, ("CreateMission", NAVIGATE), (SETTLE, {})), 1):
        talk.perform(Action(number, method, params))
    assert (talk.right, subject.patient) == (False, 0)
