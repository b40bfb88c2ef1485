"""What a person is told of a message or an answer that is wrong: the right rule first, and nothing that has no part."""

from __future__ import annotations

from typing import Any

from missionfsm.app.asked import judged_system
from missionfsm.kernel.codec import JSON
from missionfsm.oracle.transcript import head
from missionfsm.tools.check.judge import check
from missionfsm.tools.check.suspects import with_suspects
from missionfsm.tools.check.verdict import Violation

DRIVES = ["goalReached", "missionSucceeded", "missionFailed", "world", "fault"]
KINDS = {
    "delivery": ("serviMission", "deliveryMission", {"serviType": "SERVI_TYPE_SERVING"}),
    "auto": ("baseMission", "navigateAutoMission", {"baseType": "BASE_TYPE_NAVIGATE_AUTO"}),
}


def goals(*tables: str) -> list[JSON]:
    return [{"destinationId": table} for table in tables]


def mission(kind: str, *tables: str) -> JSON:
    family, name, _ = KINDS[kind]
    return {"mission": {family: {name: {"goals": goals(*tables)}}}}


def command(name: str, what: str) -> JSON:
    return {"missionCommand": {"missionId": name, "command": f"COMMAND_{what}"}}


class Log:
    """Lines of a log, with one stream."""

    def __init__(self, **first: Any) -> None:
        self.head = {"missionfsm": 1, "system": "bear.mission", "world": {"family": "servi"}, **first}
        self.lines: list[JSON] = []
        self.calls = self.shown = 0
        self.asks("SubscribeMissionStatus", stream=1)
        if "begins" not in first:
            self.shows(index=-1)

    def asks(self, method: str, params: JSON = None, status: str = "", **result: Any) -> Log:
        """A call and its answer."""
        self.calls += 1
        self.lines.append({"call": self.calls, "method": method, "params": params or {}})
        self.lines.append({"return": self.calls, **({"error": {"status": status}} if status else {"result": result})})
        return self

    def creates(self, name: str, kind: str, *tables: str) -> Log:
        return self.asks("CreateMission", mission(kind, *tables), missionId=name)

    def shows(self, *missions: tuple[str, str, str, tuple[str, ...]], index: int = 0, at: int = 0) -> Log:
        """A message: of each mission its id, its kind, its state and its goals."""
        listed = [
            {
                "missionId": name,
                "state": f"STATE_{state}",
                "goals": goals(*tables),
                "currentGoalIndex": at if state in ("RUNNING", "PAUSED") else 0,
                "missionType": KINDS[kind][2],
                "owner": "api",
            }
            for name, kind, state, tables in missions
        ]
        self.shown += 1
        metadata = {"timestamp": f"2026-01-01T00:00:{self.shown:02}Z", "sequenceNumber": self.shown}
        states = {"missions": listed, "currentMissionIndex": index}
        self.lines.append({"stream": 1, "message": {"metadata": metadata, "missionStates": states}})
        return self

    def settles(self) -> Log:
        self.lines.append({"settled": True})
        return self

    @property
    def told(self) -> Violation:
        first = head(self.head)
        judged_by = judged_system(first.system, strict=first.strict, anywhere=first.anywhere)
        found = check(judged_by, first, self.lines, early=0 if first.anywhere else None).violation
        assert found is not None
        return found


def rules(violation: Violation) -> list[str]:
    return [rule.id.removeprefix("bear.mission/") for rule in violation.rules]


A = ("table-1", "table-2")


def test_a_call_that_failed_long_ago_is_no_cause() -> None:
    """Once another call has taken effect, what shows is not what one would have done that failed before."""
    begun = Log(drives=DRIVES).creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A))
    begun.asks("AppendMission", mission("delivery", "table-3"), missionId="m2")
    waits = ("m2", "delivery", "DEFAULT", ("table-3",))
    begun.shows(("m1", "delivery", "RUNNING", A), waits)
    begun.asks("UpdateMission", command("m2", "CANCEL"), "NOT_FOUND").asks("UpdateMission", command("m1", "FINISH"))
    ended = ("m1", "delivery", "SUCCEEDED", A)
    begun.shows(ended, ("m2", "delivery", "RUNNING", ("table-3",)), index=1)
    begun.asks("UpdateMission", command("m2", "FINISH"))
    found = begun.shows(ended, ("m2", "delivery", "CANCELED", ("table-3",)), index=-1).told
    assert found.notes == ("mission 1 is STATE_CANCELED, expected STATE_SUCCEEDED",)
    assert rules(found) == ["SubscribeMissionStatus/the-state-is-reported", "UpdateMission/finish"]


def test_a_call_that_failed_last_is_one() -> None:
    """A message right after a refusal shows what the call would have done."""
    begun = Log(drives=DRIVES[:4]).creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A))
    begun.asks("AppendMission", mission("delivery", "table-3"), "INTERNAL")
    found = begun.shows(("m1", "delivery", "RUNNING", A), ("m2", "delivery", "DEFAULT", ("table-3",))).told
    assert found.notes[0].startswith("it shows what a call would have done that failed: AppendMission(")


def test_a_mission_that_was_created_during_another() -> None:
    """Where nobody says what ends by itself, the message tells that nothing has, and the refusal is named first."""
    begun = Log().creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A))
    begun.creates("m2", "delivery", "table-3")
    found = begun.shows(("m1", "delivery", "RUNNING", A), ("m2", "delivery", "DEFAULT", ("table-3",))).told
    assert rules(found)[0] == "CreateMission/FAILED_PRECONDITION/another-mission-is-active-or-queued"
    says = (
        "it shows what CreateMission(servi delivery to 'table-3') has done, which was answered OK and had to be refused"
    )
    assert found.notes == (f"{says}: A mission is running, paused or waiting, so a first mission cannot be created",)


def test_missions_of_a_batch_the_wrong_way_round() -> None:
    """All of them are listed, so what is wrong is their order, which their goals tell."""
    begun = Log(drives=DRIVES).creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A))
    batch = {"missions": [mission("delivery", "table-1"), mission("delivery", "table-3")]}
    begun.asks("AppendMissionBatch", batch, missionIds=["m2", "m3"])
    turned = (("m2", "delivery", "DEFAULT", ("table-3",)), ("m3", "delivery", "DEFAULT", ("table-1",)))
    found = begun.shows(("m1", "delivery", "RUNNING", A), *turned).told
    assert found.notes == ("mission 1 has the goals [table-3], expected [table-1]",)
    assert rules(found)[0] == "SubscribeMissionStatus/the-goals-are-those-requested"


def test_missions_in_another_order() -> None:
    """Where their states tell that they are turned round, as their ids do, it is the order that is wrong."""
    begun = Log(drives=DRIVES).creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A))
    begun.asks("AppendMission", mission("delivery", "table-3"), missionId="m2")
    found = begun.shows(("m2", "delivery", "DEFAULT", ("table-3",)), ("m1", "delivery", "RUNNING", A), index=1).told
    assert found.notes[0] == "it has m2, m1 in another order than m1, m2"
    assert rules(found)[0] == "SubscribeMissionStatus/all-missions-are-listed"


def test_a_snapshot_that_leaves_missions_out() -> None:
    """Of what could be shown the list is nearest that has the mission that is shown, whatever may have happened."""
    begun = Log().creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A))
    begun.asks("AppendMission", mission("delivery", "table-3"), missionId="m2")
    begun.asks("UpdateMission", command("m1", "CANCEL"))
    ended = ("m1", "delivery", "CANCELED", A)
    begun.shows(ended, ("m2", "delivery", "RUNNING", ("table-3",)), index=1)
    found = begun.shows(ended, index=1).told
    assert found.notes[0] == "1 mission is listed; the robot has 2"
    assert rules(found)[0] == "SubscribeMissionStatus/all-missions-are-listed"


def test_another_id_accuses_no_state() -> None:
    """Where only the id is wrong, nothing is said of how the mission came to run."""
    found = Log(drives=DRIVES).creates("m1", "delivery", *A).shows(("m9", "delivery", "RUNNING", A)).told
    assert found.notes[0] == "it names m9 where it should name m1"
    named = ["SubscribeMissionStatus/all-missions-are-listed", "CreateMission/the-answer-names-the-new-mission"]
    assert rules(found) == named


def test_the_first_free_goal() -> None:
    """A mission that chooses its goal says that free goals are taken in their order."""
    found = Log(drives=DRIVES).creates("m1", "auto", *A).shows(("m1", "auto", "RUNNING", A), at=1).told
    assert found.notes[0] == "mission 0 has current_goal_index 1, expected 0: free goals are taken in their order"


def test_an_answer_without_an_id() -> None:
    """The nearest answer has one."""
    workflow = {"missionWorkflow": {"serviWorkflow": {"delivery": {"goals": goals(*A)}}}}
    found = Log(drives=DRIVES).asks("CreateMissionWorkflow", workflow, missionIds=[]).told
    assert found.notes == ("it names nothing, expected 1 new name",)


def test_an_id_that_another_mission_has() -> None:
    """The answer itself breaks the sentence about ids, whatever becomes of the queue; so does one id for two."""
    begun = Log(drives=DRIVES).creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A)).settles()
    found = begun.asks("AppendMission", mission("delivery", "table-3"), missionId="m1").told
    assert found.notes == ("it names m1 where a name is due that nothing had before",)
    assert rules(found)[0] == "AppendMission/the-answer-names-the-new-mission"
    begun = Log(drives=DRIVES).creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A)).settles()
    batch = {"missions": [mission("delivery", "table-1"), mission("delivery", "table-3")]}
    found = begun.asks("AppendMissionBatch", batch, missionIds=["m2", "m2"]).told
    assert found.notes == ("each thing has a name of its own, and m2 is given twice",)
    assert rules(found)[0] == "AppendMissionBatch/the-answer-names-the-new-missions-in-order"


def test_of_what_is_allowed_that_comes_first_for_which_nothing_has_to_happen_yet() -> None:
    """An unknown id where a mission has just been created: the mission runs, and that is what the rows are about."""
    begun = Log(drives=DRIVES).creates("m1", "delivery", *A)
    found = begun.asks("UpdateMission", command("m9", "PAUSE")).told
    assert {one.assumes for one in found.expected} == {
        ("AM-02.unknown.busy=a",),
        ("AM-02.unknown.busy=b",),
        ("AM-02.unknown.busy=e",),
    }


def test_nothing_came_after_a_call() -> None:
    """Also where only later messages show that none comes: what was shown last is said, with the call after it."""
    three, waits = (
        ("table-1", "table-2", "table-3"),
        (("m2", "delivery", "DEFAULT", A), ("m3", "delivery", "DEFAULT", A)),
    )
    begun = Log(begins="anywhere", transport="strict").shows(("m1", "delivery", "RUNNING", three), *waits).settles()
    for what, state in (("PAUSE", "PAUSED"), ("RESUME", "RUNNING")) * 3:
        begun.asks("UpdateMission", command("m1", what)).shows(("m1", "delivery", state, three), *waits).settles()
    begun.asks("ClearMissionStatus", missionIds=["m1", "m2", "m3"]).settles().asks(
        "UpdateMission", command("m1", "PAUSE")
    )
    found = begun.shows(("m1", "delivery", "PAUSED", three), *waits).settles().told
    last = "[RUNNING at goal 0, WAITING, WAITING], current_mission_index 0 (m1, m2, m3)"
    says = f"after ClearMissionStatus() → OK m1, m2, m3 stream 1 showed nothing new; it showed {last} last"
    assert (found.observed, found.notes) == ("everything settled", (says,))


def test_half_of_a_batch_that_timed_out() -> None:
    """It takes effect whole or not at all, whatever it was answered."""
    begun = Log(drives=DRIVES[:4], transport="strict").creates("m1", "delivery", *A)
    begun.shows(("m1", "delivery", "RUNNING", A))
    batch = {"missions": [mission("delivery", "table-1"), mission("delivery", "table-3")]}
    begun.asks("AppendMissionBatch", batch, "DEADLINE_EXCEEDED")
    found = begun.shows(("m1", "delivery", "RUNNING", A), ("m2", "delivery", "DEFAULT", ("table-1",))).settles().told
    assert "AppendMissionBatch/missions-are-appended-at-the-end" in rules(found)


def test_what_only_a_restart_explains() -> None:
    """A line that is wrong and explained by a restart is said where a later one contradicts that."""
    begun = Log(drives=DRIVES).creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A))
    begun.shown = -1  # its numbers start anew
    found = begun.shows(index=-1).shows(("m1", "delivery", "PAUSED", A), at=1).told
    shown = "stream 1 showed [], current_mission_index -1"
    assert f"unless it has restarted, nothing explains an earlier line: {shown}" in found.notes


def test_a_failure_that_nobody_drove() -> None:
    """Where the drives of a log say who makes calls fail, a failure that nobody drove is told as that."""
    begun = Log(drives=DRIVES)
    found = begun.asks("CreateMission", mission("delivery", *A), "INTERNAL").told
    says = "INTERNAL comes to this call only where a drive makes it fail (the log says all of those), and none did"
    assert found.notes == (says,)


def test_what_a_refused_batch_has_left_behind() -> None:
    """A refusal changes nothing: what was done before it has no part in what shows after it."""
    begun = Log(drives=DRIVES, transport="strict").creates("m1", "delivery", *A)
    begun.shows(("m1", "delivery", "RUNNING", A))
    batch = {"missions": [mission("delivery", "table-1"), mission("delivery", "nowhere")]}
    begun.asks("AppendMissionBatch", batch, "INVALID_ARGUMENT")
    found = begun.shows(("m1", "delivery", "RUNNING", A), ("m2", "delivery", "DEFAULT", ("table-1",))).told
    assert found.notes[1].startswith("the last call was refused, which changes nothing: AppendMissionBatch(")
    named = ["SubscribeMissionStatus/all-missions-are-listed", "SubscribeMissionStatus/updates-follow-the-state"]
    assert rules(found) == named


def test_a_stream_that_begins_with_what_was_before() -> None:
    """It breaks the sentence about first messages as well, which no step would explain."""
    found = Log(drives=DRIVES, transport="strict").creates("m1", "delivery", *A).shows(("m1", "delivery", "RUNNING", A))
    found.asks("SubscribeMissionStatus", stream=2)
    metadata = {"timestamp": "2026-01-01T00:01:00Z", "sequenceNumber": 1}
    states = {"missions": [], "currentMissionIndex": -1}
    found.lines.append({"stream": 2, "message": {"metadata": metadata, "missionStates": states}})
    told = with_suspects(judged_system("bear.mission", strict=True), found.told)
    named = ["SubscribeMissionStatus/all-missions-are-listed", "SubscribeMissionStatus/the-latest-state-comes-first"]
    assert rules(told)[:2] == named


def test_what_departs_from_the_text_is_accused_before_what_comes_of_it() -> None:
    """A destination that is not on the map is accepted, which a reading explains; that it is reached, none does."""
    begun = Log(drives=DRIVES, transport="strict").creates("m1", "delivery", "nowhere")
    begun.lines.append({"drive": {"event": "goalReached"}})
    told = with_suspects(judged_system("bear.mission", strict=True), begun.told)
    assert rules(told) == [
        "CreateMission/INVALID_ARGUMENT/a-destination-is-not-on-the-map",
        "lifecycle/goals-are-taken-up-in-order",
    ]
    says = "only a reading that departs from the text explains this before it"
    assert told.notes[0] == f"{says}: CreateMission(servi delivery to 'nowhere') was answered OK m1"


def test_the_nearest_rule_is_told_before_others_also_where_it_stands_with_what_was_allowed() -> None:
    """A skip that names the wrong mission breaks the sentence about its answer, and not that about a last goal."""
    log = (
        Log(drives=DRIVES)
        .creates("A", "delivery", "table-1")
        .asks("AppendMission", mission("delivery", "table-2"), missionId="B")
    )
    log.lines.append({"drive": {"event": "missionSucceeded"}})
    told = log.asks("SkipGoal", missionId="A").told
    assert told.against[0].id == "bear.mission/SkipGoal/the-next-goal-is-taken-up"
    assert "it names A where it should name B" in told.notes


def test_what_had_to_be_refused_is_told_before_what_only_an_odd_reading_finds_wrong() -> None:
    """A batch with a mission of another family that comes to one mission should not have come to anything."""
    two = {
        "missions": [
            mission("delivery", "table-1"),
            {"mission": {"cartiMission": {"traverseMission": {"goals": goals("table-2")}}}},
        ]
    }
    told = Log(drives=DRIVES).asks("CreateMissionBatch", two, missionIds=["A"]).told
    assert rules(told)[0] == "CreateMissionBatch/INVALID_ARGUMENT/the-mission-is-for-another-family"
    assert [one.what.partition(" ")[0] for one in told.expected] == ["INVALID_ARGUMENT", "FAILED_PRECONDITION", "OK"]


def test_ids_the_wrong_way_round_break_the_sentence_about_them() -> None:
    """The list is right, and the answer is what is wrong: it is accused beside the list that tells."""
    both = {"missions": [mission("delivery", "table-1"), mission("delivery", "table-2")]}
    log = Log(drives=DRIVES, transport="strict").asks("CreateMissionBatch", both, missionIds=["B", "A"])
    listed = ("A", "delivery", "RUNNING", ("table-1",)), ("B", "delivery", "DEFAULT", ("table-2",))
    told = with_suspects(judged_system("bear.mission", strict=True), log.shows(*listed).told)
    assert "CreateMissionBatch/the-answer-names-the-new-missions-in-order" in rules(told)


def test_a_mission_whose_turn_it_is_not_breaks_the_sentence_about_turns() -> None:
    """The last that waits runs instead of the first: the states are those of the robot, and it does the wrong thing."""
    both = {"missions": [mission("delivery", "table-1"), mission("delivery", "table-2")]}
    log = Log(drives=DRIVES, transport="strict").asks("CreateMissionBatch", both, missionIds=["A", "B"])
    listed = ("A", "delivery", "DEFAULT", ("table-1",)), ("B", "delivery", "RUNNING", ("table-2",))
    told = with_suspects(judged_system("bear.mission", strict=True), log.shows(*listed, index=1).told)
    assert "lifecycle/start" in rules(told)


def test_what_contradicts_an_earlier_answer_breaks_the_rule_by_which_that_was_right() -> None:
    """An empty request is refused by the state, where another that is wrong was refused by its form (AM-01)."""
    first = Log(drives=DRIVES, transport="strict").asks(
        "AppendMissionBatch", {"missions": [mission("delivery", "nowhere")]}, "INVALID_ARGUMENT"
    )
    told = first.asks("AppendMissionBatch", {"missions": []}, "FAILED_PRECONDITION").told
    assert rules(told)[0] == "AppendMissionBatch/INVALID_ARGUMENT/the-request-is-empty"


def test_an_appended_batch_is_told_of_by_its_own_section() -> None:
    """The page says of both batches by themselves in which order their missions are, and which ids the answer has."""
    both = {"missions": [mission("delivery", "table-1"), mission("delivery", "table-2")]}
    begun = Log(drives=DRIVES, transport="strict").creates("A", "delivery", "table-3")
    told = begun.asks("AppendMissionBatch", both, missionIds=["B"]).told
    assert told.rules[0].id.endswith("AppendMissionBatch/the-answer-names-the-new-missions-in-order")
    assert "Mission › AppendMissionBatch" in str(told.rules[0])
