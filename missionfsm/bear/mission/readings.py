"""Where the Mission page can be read in more than one way, entry by entry; ``specs/bear-mission.md`` argues each.

Letters are those of the readings' list. An entry with several independent questions has an ambiguity for each, with a
word after its number. `WAIVED` has the entries without an ambiguity, and the letters that are not offered, with the
reason.
"""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.kernel.readings import Ambiguity

AM_01 = Ambiguity(
    "AM-01",
    "A request is malformed and the state forbids the call as well: which code?",
    {
        "a": "INVALID_ARGUMENT: the format is checked first",
        "b": "FAILED_PRECONDITION: the state is checked first",
        "c": "shape, then state, then goals and map",
    },
    default="a",
)
AM_02_ENDED = Ambiguity(
    "AM-02.ended",
    "UpdateMission names a listed mission that has ended: which code?",
    {
        "a": "FAILED_PRECONDITION",
        "b": "NOT_FOUND",
        "c": "FAILED_PRECONDITION if nothing is active, else NOT_FOUND",
        "d": "INVALID_ARGUMENT",
        "e": "FAILED_PRECONDITION if nothing is active, else INVALID_ARGUMENT",
    },
    default="a",
)
AM_02_UNKNOWN = Ambiguity(
    "AM-02.unknown",
    "UpdateMission names a mission that is not listed, though others are: which code?",
    {
        "a": "INVALID_ARGUMENT",
        "b": "NOT_FOUND",
        "e": "FAILED_PRECONDITION if nothing is active, else INVALID_ARGUMENT",
        "f": "FAILED_PRECONDITION if nothing is active, else NOT_FOUND",
    },
    default="a",
)
AM_03 = Ambiguity(
    "AM-03",
    "UpdateMission on a robot without any mission: which code?",
    {"a": "FAILED_PRECONDITION", "b": "NOT_FOUND", "c": "INVALID_ARGUMENT"},
    default="a",
)
AM_04 = Ambiguity(
    "AM-04",
    "UpdateMission has an invalid command and a wrong id: which is answered?",
    {"a": "the command", "b": "the id", "c": "the state: FAILED_PRECONDITION if nothing is active"},
    default="a",
)
AM_06 = Ambiguity(
    "AM-06",
    "Does a paused mission forbid CreateMissionBatch?",
    {"a": "yes, paused counts as running", "b": "no, the batch waits behind it"},
    default="a",
    flagged=frozenset("b"),
)
AM_07 = Ambiguity(
    "AM-07",
    "Do waiting missions alone forbid CreateMissionWorkflow?",
    {"a": "yes, as for CreateMission", "b": "no, the workflow joins the queue"},
    default="a",
)
AM_08 = Ambiguity(
    "AM-08",
    "Which state does a waiting mission report?",
    {"a": "STATE_DEFAULT", "b": "STATE_UNKNOWN or none", "c": "STATE_PAUSED, if the index does not point at it"},
    default="a",
)
AM_09 = Ambiguity(
    "AM-09",
    "What becomes of the queue when the active mission is cancelled?",
    {
        "a": "the next mission starts",
        "b": "the queue halts",
        "c": "the waiting missions are cancelled too",
        "d": "the waiting missions vanish",
    },
    default="a",
)
AM_10 = Ambiguity(
    "AM-10",
    "What becomes of the queue when the active mission fails?",
    AM_09.readings,
    default="a",
)
AM_11 = Ambiguity(
    "AM-11",
    "May a mission be appended when all listed ones have ended?",
    {"a": "yes, and it starts", "b": "no, FAILED_PRECONDITION"},
    default="a",
)
AM_12_PAUSED = Ambiguity(
    "AM-12.paused",
    "May a mission be appended while the active one is paused?",
    {"a": "yes", "b": "no, FAILED_PRECONDITION"},
    default="a",
    flagged=frozenset("b"),
)
AM_12_HALTED = Ambiguity(
    "AM-12.halted",
    "What does appending to a halted queue do?",
    {"a": "the mission waits with the others", "b": "FAILED_PRECONDITION", "c": "it sets the queue going again"},
    default="a",
)
AM_13 = Ambiguity(
    "AM-13",
    "What becomes of ended missions when new ones are created?",
    {"a": "they stay listed", "b": "the new ones replace them"},
    default="a",
)
AM_14_ENDED = Ambiguity(
    "AM-14.ended",
    "What is current_mission_index when nothing is active and nothing waits?",
    {"a": "-1", "b": "the last mission's"},
    default="a",
    flagged=frozenset("b"),
)
AM_14_GAP = Ambiguity(
    "AM-14.gap",
    "What is current_mission_index when nothing is active but missions wait?",
    {"c": "-1", "d": "the mission before", "e": "the next mission"},
    default="c",
)
AM_14_PAUSED = Ambiguity(
    "AM-14.paused",
    "What is current_mission_index while the mission is paused?",
    {"f": "its index", "g": "-1"},
    default="f",
)
AM_16 = Ambiguity(
    "AM-16",
    "May a goal of a paused mission be skipped?",
    {"a": "no, FAILED_PRECONDITION", "b": "yes, and it stays paused"},
    default="a",
    flagged=frozenset("b"),
)
AM_17_LAST = Ambiguity(
    "AM-17.last",
    "What does skipping the last goal do?",
    {
        "a": "the mission succeeds",
        "b": "FAILED_PRECONDITION, no change",
        "c": "INTERNAL, no change",
        "d": "the mission is cancelled",
    },
    default="a",
)
AM_17_PATROL = Ambiguity(
    "AM-17.patrol",
    "What does skipping the last goal of a patrol do?",
    {**AM_17_LAST.readings, "f": "it goes on at the first goal"},
    default="f",
)
AM_18 = Ambiguity(
    "AM-18",
    "What does skipping the goal of a NavigateAuto mission do?",
    {"a": "it takes the next free goal", "b": "it takes the next goal, free or not", "c": "it was the last goal"},
    default="a",
)
AM_19 = Ambiguity(
    "AM-19",
    "What does skipping do while charging?",
    {"a": "as at the last goal", "b": "FAILED_PRECONDITION", "c": "INTERNAL, no change"},
    default="b",
)
AM_25 = Ambiguity(
    "AM-25",
    "How many missions does a workflow create?",
    {
        "a": "one",
        "b": "the main one and a return",
        "c": "one for each goal",
        "d": "one for each goal and a return",
    },
    default="a",
)
AM_26 = tuple(
    Ambiguity(
        f"AM-26.{which}",
        f"Which servi_type does a {which} workflow report?",
        {"a": "SERVI_TYPE_UNKNOWN or none", "b": "a number that is not documented", "c": "a documented type"},
        default="a",
    )
    for which in ("birthday", "hosting", "hosting-patrol")
)
AM_27 = Ambiguity(
    "AM-27",
    "Is the automatically selected return point among the goals of a workflow's mission?",
    {"a": "no, the goals are those of the request", "b": "yes, it follows them"},
    default="a",
)
AM_29 = Ambiguity(
    "AM-29",
    "What does pausing a paused or resuming a running mission answer?",
    {"a": "FAILED_PRECONDITION", "b": "OK, and nothing changes"},
    default="a",
)
AM_30 = Ambiguity(
    "AM-30",
    "When does a finished mission succeed?",
    {"a": "at once", "b": "at its current goal"},
    default="a",
)
AM_31 = Ambiguity(
    "AM-31",
    "May a paused mission be finished?",
    {"a": "yes", "b": "no, FAILED_PRECONDITION"},
    default="a",
    flagged=frozenset("b"),
)
AM_33 = Ambiguity(
    "AM-33",
    "What does ClearMissionStatus answer when nothing is listed?",
    {"a": "OK without ids", "b": "FAILED_PRECONDITION", "c": "INVALID_ARGUMENT"},
    default="a",
    flagged=frozenset("c"),
)
AM_34_GAP = Ambiguity(
    "AM-34.gap",
    "What does ClearMissionStatus do when nothing is active but a mission is about to start?",
    {"a": "it clears everything", "b": "it clears the ended missions", "c": "FAILED_PRECONDITION"},
    default="c",
)
AM_34_HALTED = Ambiguity(
    "AM-34.halted",
    "What does ClearMissionStatus do when the queue is halted?",
    AM_34_GAP.readings,
    default="a",
)
AM_35 = Ambiguity(
    "AM-35",
    "What does a subscriber see after a clear?",
    {"a": "no missions", "c": "one unnamed mission in STATE_DEFAULT"},
    default="a",
)
AM_36 = Ambiguity(
    "AM-36",
    "What is the first message of a robot that never had a mission?",
    {"a": "no missions", "b": "one unnamed mission in STATE_DEFAULT", "c": "none, until there is a mission"},
    default="a",
)
AM_37_PAUSED = Ambiguity(
    "AM-37.paused",
    "Does a paused mission forbid ChargeRobot?",
    {"a": "yes", "b": "no, charging waits behind it"},
    default="a",
)
AM_37_QUEUED = Ambiguity(
    "AM-37.queued",
    "Do waiting missions alone forbid ChargeRobot?",
    {"a": "yes", "b": "no, charging joins the queue", "c": "no, charging comes first"},
    default="a",
)
AM_38_DOCK = Ambiguity(
    "AM-38.dock",
    "What does ChargeRobot answer on a robot without a contact dock?",
    {
        "a": "NOT_FOUND",
        "b": "FAILED_PRECONDITION",
        "c": "INTERNAL",
        "d": "UNIMPLEMENTED",
        "g": "INVALID_ARGUMENT",
    },
    default="a",
)
AM_38_RUNNING = Ambiguity(
    "AM-38.running",
    "A mission is running and there is no charger: what does ChargeRobot answer?",
    {"e": "FAILED_PRECONDITION", "f": "what it answers for the missing charger"},
    default="e",
)
AM_40 = Ambiguity(
    "AM-40",
    "May charging be paused?",
    {"a": "yes, it is a mission like others", "c": "no, FAILED_PRECONDITION"},
    default="a",
)
AM_41 = Ambiguity(
    "AM-41",
    "A mission is for another family: what do CreateMission and AppendMission answer?",
    {
        "a": "INVALID_ARGUMENT",
        "b": "FAILED_PRECONDITION",
        "c": "OK, and the mission fails when it is started",
        "d": "OK, and the mission fails on the way",
    },
    default="a",
    flagged=frozenset("cd"),
)
AM_43 = Ambiguity(
    "AM-43",
    "A destination is not on the map: when is it refused?",
    {
        "a": "at once, INVALID_ARGUMENT",
        "b": "the mission is accepted and fails when it is started",
        "d": "the mission is accepted and fails on the way",
    },
    default="a",
)
AM_44 = Ambiguity(
    "AM-44",
    "May a goal occur twice in one mission?",
    {"a": "yes", "i": "no, INVALID_ARGUMENT"},
    default="a",
)
AM_45_NONE = Ambiguity(
    "AM-45.none",
    "What does a NavigateAuto mission do when no goal is free?",
    {
        "a": "it waits, running",
        "b": "it fails",
        "c": "it is refused when it is created, INVALID_ARGUMENT or FAILED_PRECONDITION",
        "d": "it takes the first goal",
    },
    default="a",
)
AM_45_WHEN = Ambiguity(
    "AM-45.when",
    "When does a NavigateAuto mission select its goal?",
    {"h": "when it is created", "i": "when it starts", "j": "when it starts, and again on the way"},
    default="i",
)
AM_47_SKIP = Ambiguity(
    "AM-47.skip",
    "Is every change a message?",
    {"a": "yes", "b": "no, only the latest state is sure to be sent"},
    default="a",
)
AM_47_REPEAT = Ambiguity(
    "AM-47.repeat",
    "May a message repeat the one before?",
    {"a": "no", "c": "yes"},
    default="a",
)
AM_50_SHAPE = Ambiguity(
    "AM-50.shape",
    "Is the feedback of a Servi or Carti mission a message or a bare enum?",
    {"a": "a message with a status", "b": "a bare enum"},
    default="a",
)
AM_50_MEMBER = Ambiguity(
    "AM-50.member",
    "Which feedback does a base mission of a Servi or Carti robot report?",
    {"c": "that of the mission's kind", "d": "that of the robot's family"},
    default="c",
)
AM_51 = Ambiguity(
    "AM-51",
    "Which mission_type does a base mission of a Servi or Carti robot report?",
    {"a": "base_type", "b": "the type of the robot's family"},
    default="a",
)
AM_53 = Ambiguity(
    "AM-53",
    "A robot is unable to start a mission: does that forbid more than CreateMissionBatch?",
    {"a": "yes, CreateMission and CreateMissionWorkflow too", "b": "no, other missions are accepted and wait"},
    default="a",
)
AM_53_CHARGE = Ambiguity(
    "AM-53.charge",
    "A robot is unable to start a mission: does that forbid ChargeRobot?",
    {"a": "yes", "b": "no, charging waits"},
    default="a",
)
AM_53_THEN = Ambiguity(
    "AM-53.then",
    "A mission was accepted that the robot is unable to start: what becomes of it?",
    {"p": "it waits", "f": "it may fail"},
    default="p",
)
AM_54 = Ambiguity(
    "AM-54",
    "Is a batch seen all at once?",
    {"a": "yes", "b": "no, it may be seen growing"},
    default="a",
    flagged=frozenset("b"),
)
AM_58 = Ambiguity(
    "AM-58",
    "Is a request with an unknown field malformed?",
    {"a": "no, the field is ignored", "b": "yes, INVALID_ARGUMENT"},
    default="a",
)
AM_61 = Ambiguity(
    "AM-61",
    "May codes of the transport and of authentication come that no table lists?",
    {"a": "no", "b": "yes"},
    default="a",
    flagged=frozenset("b"),
)
AM_63 = Ambiguity(
    "AM-63",
    "Is a mission that was created seen before it runs?",
    {"a": "no, it is running at once", "b": "yes, waiting at first"},
    default="a",
)
AM_64 = Ambiguity(
    "AM-64",
    "Where does a resumed mission go on?",
    {"a": "at its goal", "b": "at its first goal", "c": "at its goal, though a NavigateAuto mission selects again"},
    default="a",
)

AMBIGUITIES: tuple[Ambiguity, ...] = (
    AM_01,
    AM_02_ENDED,
    AM_02_UNKNOWN,
    AM_03,
    AM_04,
    AM_06,
    AM_07,
    AM_08,
    AM_09,
    AM_10,
    AM_11,
    AM_12_PAUSED,
    AM_12_HALTED,
    AM_13,
    AM_14_ENDED,
    AM_14_GAP,
    AM_14_PAUSED,
    AM_16,
    AM_17_LAST,
    AM_17_PATROL,
    AM_18,
    AM_19,
    AM_25,
    *AM_26,
    AM_27,
    AM_29,
    AM_30,
    AM_31,
    AM_33,
    AM_34_GAP,
    AM_34_HALTED,
    AM_35,
    AM_36,
    AM_37_PAUSED,
    AM_37_QUEUED,
    AM_38_DOCK,
    AM_38_RUNNING,
    AM_40,
    AM_41,
    AM_43,
    AM_44,
    AM_45_NONE,
    AM_45_WHEN,
    AM_47_SKIP,
    AM_47_REPEAT,
    AM_50_SHAPE,
    AM_50_MEMBER,
    AM_51,
    AM_53,
    AM_53_CHARGE,
    AM_53_THEN,
    AM_54,
    AM_58,
    AM_61,
    AM_63,
    AM_64,
)
"""In the order of the list."""

WAIVED: Mapping[str, str] = {
    "AM-05": "whose state it is cannot matter: any active or waiting mission forbids the calls, and ended ones do not",
    "AM-08 d": "a waiting mission that is reported as running is not actively running",
    "AM-11 c": "a mission that is accepted and never starts is a defect, and a blocked robot is another question",
    "AM-13 c": "no bound is documented",
    "AM-15": "the index is judged where there is an active goal; elsewhere -1 to the number of goals will do",
    "AM-16 c": "a skip that resumes is documented nowhere",
    "AM-17 e": "OK would claim a skip that did not happen",
    "AM-20": "no choice to make: such a call took effect, takes it later, or never, and the stream tells",
    "AM-21": "a request that failed had no effect, but for SkipGoal (AM-24)",
    "AM-22": "no choice to make: each attempt whose effect is open may have had it once, and copies are counted so",
    "AM-23": "the page calls batches atomic without an exception: all or nothing under every code",
    "AM-24": "no choice to make: DEADLINE_EXCEEDED leaves the effect open, and so does INTERNAL for SkipGoal alone",
    "AM-28": "nobody outside sees weight: a patrol wraps to its first goal and may end well at any time while it runs",
    "AM-30 c": "a mission marked as completed is not cancelled",
    "AM-32": "no choice to make: answers and messages are not ordered, but both are owed once things have settled",
    "AM-35 b": "updates are promised for changes, and a clear is one",
    "AM-39": "type, place and end of a charge are not described: any type, at most one goal, an end whenever it comes",
    "AM-40 b": "the page calls it a mission and reports it among them, so it can be appended to",
    "AM-42": "the number of goals is all that can be told from this page; kinds of destinations are not on it",
    "AM-43 c": "NOT_FOUND is in no table of these calls; names are compared as they are",
    "AM-45 f, g": "what others claim is part of the world that a tester sets; a robot's own queue claims nothing",
    "AM-45 l": "the page says that lower indices are preferred",
    "AM-46": "numbers are compared within one stream alone, which is right under every scope; an equal one is invalid",
    "AM-48": "the example is careless: a mission lists the goals of its request, one for Navigate",
    "AM-49": "the encoding tells nothing about the robot: both forms are read everywhere",
    "AM-50 e, f": "feedback after the end may be kept or cleared; nothing follows from it",
    "AM-52": "owners are free texts, and the adapter protocol has no touchscreen to start missions with",
    "AM-55": "two members of a oneof are malformed JSON and cannot be said in binary; a bare mission is an empty entry",
    "AM-56": "a history is explained by some order of the calls or not at all; two racing creates that win have none",
    "AM-57": "a conversation is with one robot; whoever records several marks the lines with the robot's name",
    "AM-58 c": "which robot is addressed is not part of a request",
    "AM-59": "ended missions stay until they are cleared or replaced (AM-13); no bound and no restart is documented",
    "AM-60": "the next mission starts once things have settled, unless the queue is halted or the robot blocked",
    "AM-62": "two spellings of one state: STATE_CANCELED on the wire",
}
"""Entries without an ambiguity, and letters that are not offered, with the reason."""
