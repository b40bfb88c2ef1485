"""The story of a violation is one that the implementation has played, with all that was done to it."""

from __future__ import annotations

import json

from attrs import evolve

from missionfsm.kernel.alphabet import pick
from missionfsm.kernel.codec import JSON
from missionfsm.kernel.readings import UNCONSTRAINED
from missionfsm.kernel.subject import Exchange, Notification
from missionfsm.oracle.automaton import Automaton
from missionfsm.systems import system
from missionfsm.tools.conform.actions import Action, NameRef
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.conversation import Conversation
from missionfsm.tools.conform.finding import verdict_of
from missionfsm.tools.conform.run import Run
from missionfsm.tools.reference.subject import ReferenceSubject

SERVER, ROBOT = system("isaac.server"), system("isaac.robot")


class AfterTheDrop:
    """A server that sends a robot's last line to it again when it drops."""

    def __init__(self) -> None:
        self._sound = ReferenceSubject(SERVER, {})
        self._last: dict[int, Notification] = {}

    def exchange(self, method: str, params: JSON) -> Exchange:
        answer = self._sound.exchange(method, params)
        for one in (*answer.before, *answer.after):
            if one.method == "line":
                self._last[one.params["connection"]] = one
        if method == "drive" and params["event"] == "disconnect" and answer.result["happened"]:
            last = self._last.get(params["connection"])
            return answer if last is None else evolve(answer, before=(*answer.before, last))
        return answer

    def close(self) -> None:
        self._sound.close()


def test_what_a_drop_makes_an_implementation_say_is_told_after_the_drop() -> None:
    """It comes before the answer to the drop; a history that ended there would be one that nobody can have again."""
    verdict = conform(SERVER, AfterTheDrop(), seed=1, advice=False)
    assert verdict.violation is not None, str(verdict)
    *_, before, last = verdict.violation.history
    assert (before.get("drive", {}).get("event"), "line" in last) == ("disconnect", True), str(verdict)


class Remembering:
    """A robot that takes what its behavior tree reports while no mission runs for what the next one comes to."""

    def __init__(self) -> None:
        self._sound = ReferenceSubject(ROBOT, {})
        self._kept = False

    def exchange(self, method: str, params: JSON) -> Exchange:
        answer = self._sound.exchange(method, params)
        if method == "reset":
            self._kept = False
        if method != "drive":
            return answer
        if params["event"] == "behaviorSucceeded":
            self._kept |= not answer.result["happened"]
        sent = [one for one in (*answer.before, *answer.after) if "running" in json.dumps(one.params)]
        if not (self._kept and sent):
            return answer
        done = evolve(sent[-1], params=json.loads(json.dumps(sent[-1].params).replace("running", "success")))
        return evolve(answer, after=(*answer.after, done))

    def close(self) -> None:
        self._sound.close()


def test_a_drive_that_did_not_happen_is_told_where_the_violation_needs_it() -> None:
    """No history has it: without a word of it, nobody could have the violation again."""
    verdict = conform(ROBOT, Remembering(), seed=1, advice=False)
    assert verdict.violation is not None, str(verdict)
    (note,) = verdict.notes
    assert "behaviorSucceeded, 'the behavior tree reports success', with happened: false before line 2" in note


def test_a_name_that_comes_with_a_later_action_this_time_is_still_meant() -> None:
    """Which action gave a name depends on when an implementation answers; a conversation had again is the same one."""
    name = {"$text": {"header": {"channel": "name"}, "payload": {"text": "carter-01"}}}
    uuid = pick("uuid", 3)
    done = {"$text": {"header": {"channel": "mission_status"}, "payload": {"missionStatus": "success", "uuid": uuid}}}
    link, connection = pick("connection", 2), NameRef(2, 0)

    def line(serial: int, text: JSON, *picks: tuple[int, NameRef]) -> Action:
        params = {"event": "line", "connection": link, "line": text}
        return Action(serial, "drive", params, None, ((2, connection), *picks))

    actions = (
        Action(1, "submit", {"mission": {"robot": "carter-01"}}),
        Action(2, "drive", {"event": "connect"}),
        line(3, name),
        line(4, done, (3, NameRef(2, 2))),
        Action(5, "statuses", {}),
    )
    had = Run.against(SERVER, ReferenceSubject(SERVER, {})).replay({}, actions)
    assert list(had.heard[-1]["result"]["missions"].values()) == ["SUCCESS"]


def test_an_event_that_cannot_be_decided_is_named_with_its_conversation() -> None:
    """What could not be decided is told as what is wrong is: which event of which conversation, and its story."""
    run = Run.against(SERVER, ReferenceSubject(SERVER, {}))
    run.ledger.examples = run.ledger.succeeded = 7
    run.found = Conversation(run.partner, {}, Automaton(SERVER.spec, run.partner.info.drives, UNCONSTRAINED, 1))
    for serial in range(1, 4):
        run.found.perform(Action(serial, "submit", {"mission": {"robot": "carter-01"}}))
        run.found.perform(Action(serial + 9, "drive", {"event": "advance", "seconds": 30}))
    assert run.found.judge.exhausted
    verdict = verdict_of(run, 1, advice=False)
    said = str(verdict)
    assert verdict.because.startswith("in conversation 7, event "), said
    assert "too many explanations to decide; what follows was not judged" in verdict.because
    assert ("1. submit(robot carter-01, channel mission)" in said, "--seed" in said) == (True, True)
