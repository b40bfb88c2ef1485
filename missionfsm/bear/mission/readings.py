"""Where the Mission page can be read in more than one way, entry by entry; ``specs/bear-mission.md`` argues each.

Letters are those of its entries. An entry with several independent questions has an ambiguity for each, with a
word after its number, and a question that no sentence answers for several calls, situations or kinds of missions at
once has one for each of those (`_each`). `WAIVED` has the entries without an ambiguity, and the letters that are not
offered, with the reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from missionfsm.bear.mission.state import AUTOMATIC, GOALLESS, PATROLS, Kind
from missionfsm.kernel.readings import Ambiguity

CREATING = ("CreateMission", "CreateMissionBatch", "CreateMissionWorkflow")
APPENDING = ("AppendMission", "AppendMissionBatch")
BATCHES = ("CreateMissionBatch", "AppendMissionBatch")
ADDING = (*CREATING, *APPENDING, "ChargeRobot")
FIELDLESS = ("ChargeRobot", "ClearMissionStatus", "SkipGoal")
EVERY_CALL = (*CREATING, *APPENDING, *FIELDLESS, "UpdateMission", "SubscribeMissionStatus")
WORKFLOWS = (
    Kind.SERVI_DELIVERY,
    Kind.SERVI_DELIVERY_PATROL,
    Kind.SERVI_BUSSING,
    Kind.SERVI_BUSSING_PATROL,
    Kind.SERVI_BIRTHDAY,
    Kind.SERVI_HOSTING,
    Kind.SERVI_HOSTING_PATROL,
    Kind.CARTI_TRAVERSE,
    Kind.CARTI_TRAVERSE_PATROL,
)
GAP, HALTED, BLOCKED = "gap", "halted", "blocked"
WAITING: Mapping[str, str] = {
    GAP: "the next mission is about to start",
    HALTED: "the queue is halted",
    BLOCKED: "the robot is unable to start the next mission",
}
"""Situations in which missions wait and none is active."""


def _each(
    entry: str,
    question: str,
    readings: Mapping[str, str],
    default: str,
    parts: Mapping[str, str] | Iterable[str],
    flagged: str = "",
    *,
    alike: bool = True,
) -> Mapping[str, Ambiguity]:
    """One ambiguity for each part, since nothing that is written ties one to another.

    Args:
        question: what is asked, with `{}` for the part.
        parts: the word after the entry to what the question says of it; themselves if there is nothing more to say.
        alike: whether different answers are more often wrong than free.
    """
    said = parts if isinstance(parts, Mapping) else {part: part for part in parts}
    return {
        part: Ambiguity(
            f"{entry}.{part}",
            question.format(words),
            readings,
            default,
            frozenset(flagged),
            alike=entry if alike and len(said) > 1 else None,
        )
        for part, words in said.items()
    }


def part_of(kind: Kind) -> str:
    """What a kind of missions is called in the id of an ambiguity."""
    return kind.value.replace(" ", "-")


def _kinds(kinds: Iterable[Kind]) -> Mapping[str, str]:
    return {part_of(kind): f"a {kind.value} mission" for kind in kinds}


AM_01 = _each(
    "AM-01",
    "{}: a request is malformed and the state forbids the call as well: which code?",
    {
        "a": "INVALID_ARGUMENT: the format is checked first",
        "b": "FAILED_PRECONDITION: the state is checked first, of what can be decoded at all",
        "c": "shape, then state, then goals and map",
    },
    "a",
    (*CREATING, *APPENDING, *FIELDLESS),
)
AM_01_BLOCKED = _each(
    "AM-01.blocked",
    "{}: a request is malformed and the robot unable to start a mission: which code?",
    AM_01["CreateMission"].readings,
    "a",
    CREATING,
)
IDLE, BUSY = "idle", "busy"
_WHILE = {IDLE: "while no mission is active", BUSY: "while another mission is active"}
AM_02_QUEUED = Ambiguity(
    "AM-02.queued",
    "UpdateMission names a waiting mission while no mission is active: which code?",
    {"a": "NOT_FOUND", "b": "FAILED_PRECONDITION"},
    default="a",
    flagged=frozenset("b"),
)
AM_02_ENDED = _each(
    "AM-02.ended",
    "UpdateMission names a listed mission that has ended, {}: which code?",
    {"a": "FAILED_PRECONDITION", "b": "NOT_FOUND", "d": "INVALID_ARGUMENT"},
    "a",
    _WHILE,
    alike=False,
)
AM_02_CLEARED = _each(
    "AM-02.cleared",
    "UpdateMission names a mission that is not listed any more, {}: which code?",
    {"a": "INVALID_ARGUMENT", "b": "NOT_FOUND", "e": "FAILED_PRECONDITION"},
    "a",
    _WHILE,
    alike=False,
)
AM_02_UNKNOWN = {
    IDLE: Ambiguity(
        "AM-02.unknown.idle",
        f"UpdateMission names a mission that never was, {_WHILE[IDLE]}: which code?",
        AM_02_CLEARED[IDLE].readings,
        default="a",
    ),
    BUSY: Ambiguity(
        "AM-02.unknown.busy",
        f"UpdateMission names a mission that never was, {_WHILE[BUSY]}: which code?",
        AM_02_CLEARED[BUSY].readings,
        default="a",
        flagged=frozenset("e"),
    ),
}
AM_03 = _each(
    "AM-03",
    "UpdateMission, {}: which code?",
    {"a": "FAILED_PRECONDITION", "b": "NOT_FOUND", "c": "INVALID_ARGUMENT"},
    "a",
    {
        "fresh": "on a robot that never had a mission",
        "unknown": "on a robot that lists no mission any more, of one that never was",
        "cleared": "on a robot that lists no mission any more, of one that was listed",
    },
    alike=False,
)
AM_04 = _each(
    "AM-04",
    "UpdateMission has an invalid command and {}: which is answered?",
    {"a": "the command", "b": "the id: the code that it gets with a valid command"},
    "a",
    {
        f"{which}-{when}": f"names {whose} mission, {_WHILE[when]}"
        for which, whose in (("queued", "a waiting"), ("ended", "an ended"), ("cleared", "a past"), ("unknown", "no"))
        for when in (IDLE, BUSY)
    }
    | {part: f"is asked {one.question.partition(', ')[2].partition(':')[0]}" for part, one in AM_03.items()},
)
AM_04_NO_ID = Ambiguity(
    "AM-04.no-id",
    "UpdateMission does not say readably which mission it is about, and none is active: which is answered?",
    {"a": "the format: INVALID_ARGUMENT", "c": "the state: FAILED_PRECONDITION"},
    default="a",
)
AM_06 = Ambiguity(
    "AM-06",
    "Does a paused mission forbid CreateMissionBatch?",
    {"a": "yes, paused counts as running", "b": "no, the batch waits behind it"},
    default="a",
    flagged=frozenset("b"),
)
AM_07 = _each(
    "AM-07",
    "Do waiting missions alone forbid CreateMissionWorkflow where {}?",
    {
        "a": "yes, as for CreateMission",
        "b": "no, the workflow joins the queue",
        "o": "no, it is begun first, though it is listed behind them",
        "r": "no, the workflow replaces the queue",
        "v": "yes, with INVALID_ARGUMENT: it does not fit the robot's state",
    },
    "a",
    WAITING,
    flagged="v",
)
AM_08 = Ambiguity(
    "AM-08",
    "Which state does a waiting mission report?",
    {"a": "STATE_DEFAULT", "b": "STATE_UNKNOWN or none", "c": "STATE_PAUSED, if the index does not point at it"},
    default="a",
    flagged=frozenset("bc"),
)
_QUEUE_AFTER_CANCEL = {
    "a": "the next mission starts",
    "b": "the queue halts",
    "c": "the waiting missions are cancelled too",
    "d": "the waiting missions vanish",
}
AM_09 = Ambiguity(
    "AM-09",
    "What becomes of the queue when the active mission is cancelled?",
    _QUEUE_AFTER_CANCEL,
    default="a",
    flagged=frozenset("d"),
    alike="AM-09",
)
AM_09_SKIP = Ambiguity(
    "AM-09.skip",
    "What becomes of the queue when skipping the last goal cancels the active mission?",
    _QUEUE_AFTER_CANCEL,
    default="a",
    flagged=frozenset("d"),
    alike="AM-09",
)
_QUEUE_AFTER_FAILURE = {**_QUEUE_AFTER_CANCEL, "e": "the waiting missions fail too"}
AM_10 = Ambiguity(
    "AM-10",
    "What becomes of the queue when the active mission fails?",
    _QUEUE_AFTER_FAILURE,
    default="a",
    flagged=frozenset("d"),
    alike="AM-10",
)
AM_10_START = Ambiguity(
    "AM-10.start",
    "What becomes of the queue when a mission fails as it is to start?",
    _QUEUE_AFTER_FAILURE,
    default="a",
    flagged=frozenset("d"),
    alike="AM-10",
)
AM_11 = _each(
    "AM-11",
    "May {} be called when all listed missions have ended?",
    {"a": "yes, and what it appends starts", "b": "no, FAILED_PRECONDITION"},
    "a",
    APPENDING,
)
AM_12_PAUSED = _each(
    "AM-12.paused",
    "May {} be called while the active mission is paused?",
    {"a": "yes", "b": "no, FAILED_PRECONDITION"},
    "a",
    APPENDING,
    flagged="b",
)
AM_12_HALTED = _each(
    "AM-12.halted",
    "What does {} do to a halted queue?",
    {"a": "the mission waits with the others", "b": "FAILED_PRECONDITION", "c": "it sets the queue going again"},
    "a",
    APPENDING,
    flagged="b",
)
AM_13 = _each(
    "AM-13",
    "What becomes of ended missions when {} creates new ones?",
    {"a": "they stay listed", "b": "the new ones replace them"},
    "a",
    (*CREATING, "ChargeRobot"),
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
    "What is current_mission_index when nothing is active but a mission is about to start?",
    {"c": "-1", "d": "the mission before", "e": "the next mission"},
    default="c",
    flagged=frozenset("de"),
)
AM_14_HALTED = Ambiguity(
    "AM-14.halted",
    "What is current_mission_index when nothing is active and missions wait in a halted queue?",
    AM_14_GAP.readings,
    default="c",
    flagged=frozenset("de"),
)
AM_16 = Ambiguity(
    "AM-16",
    "May a goal of a paused mission be skipped?",
    {"a": "no, FAILED_PRECONDITION", "b": "yes, and it stays paused"},
    default="a",
    flagged=frozenset("b"),
)
_AT_THE_LAST = {
    "a": "the mission succeeds",
    "b": "FAILED_PRECONDITION, no change",
    "c": "INTERNAL, no change",
    "d": "the mission is cancelled",
}
AM_17_LAST = _each(
    "AM-17.last",
    "What does skipping the last goal of {} do?",
    _AT_THE_LAST,
    "a",
    _kinds(kind for kind in Kind if kind not in PATROLS | GOALLESS),
)
LOOPS = PATROLS - {Kind.SERVI_HOSTING_PATROL}
"""The patrols of which the page says that they loop, so that another goal follows the last."""
AM_17_PATROL = {
    part: one
    for kinds, flagged in ((LOOPS, "abcd"), (PATROLS - LOOPS, ""))
    for part, one in _each(
        "AM-17.patrol",
        "What does skipping the last goal of {} do?",
        {**_AT_THE_LAST, "f": "it goes on at the first goal"},
        "f",
        _kinds(kind for kind in Kind if kind in kinds),
        flagged,
    ).items()
}
AM_18 = _each(
    "AM-18",
    "What does skipping the goal of {} do?",
    {"a": "it takes the next free goal", "b": "it takes the next goal, free or not", "c": "it was the last goal"},
    "a",
    _kinds(kind for kind in Kind if kind in AUTOMATIC),
)
AM_19 = Ambiguity("AM-19.charge", "What does skipping do while charging?", _AT_THE_LAST, default="b")
AM_19_RETURN = Ambiguity(
    "AM-19.return",
    "What does skipping do to the return mission of a workflow?",
    {**_AT_THE_LAST, "g": "it goes on to its next goal; the last is skipped as in another reading"},
    default="b",
)
AM_25 = _each(
    "AM-25",
    "How many missions does a {} workflow create?",
    {
        "a": "one",
        "b": "the main one and a return",
        "c": "one for each goal",
        "d": "one for each goal and a return",
        "x": "others, among which the goals of the request stand in their order",
    },
    "a",
    {part_of(kind): kind.value for kind in WORKFLOWS},
    alike=False,
)
UNNAMED = (Kind.SERVI_BIRTHDAY, Kind.SERVI_HOSTING, Kind.SERVI_HOSTING_PATROL)
"""Workflows whose types no enum names (AM-26)."""
AM_26 = {
    kind: Ambiguity(
        f"AM-26.{part_of(kind).removeprefix('servi-')}",
        f"Which servi_type does a {kind.value.removeprefix('servi ')} workflow report?",
        {"a": "SERVI_TYPE_UNKNOWN or none", "b": "a number that is not documented", "c": "a documented type"},
        default="a",
    )
    for kind in UNNAMED
}
AM_27 = _each(
    "AM-27",
    "Is the automatically selected return point among the goals of a {} workflow's mission?",
    {"a": "no, the goals are those of the request", "b": "yes, it follows them"},
    "a",
    {part_of(kind): kind.value for kind in WORKFLOWS},
    alike=False,
)
AM_29 = _each(
    "AM-29",
    "What does {} answer?",
    {"a": "FAILED_PRECONDITION", "b": "OK, and nothing changes"},
    "a",
    {"pause": "pausing a paused mission", "resume": "resuming a running mission"},
    flagged="b",
)
AM_30 = Ambiguity(
    "AM-30",
    "When does a finished mission succeed?",
    {"a": "at once", "b": "at its current goal"},
    default="a",
    flagged=frozenset("b"),
)
AM_31 = Ambiguity(
    "AM-31",
    "May a paused mission be finished?",
    {"a": "yes", "b": "no, FAILED_PRECONDITION"},
    default="a",
    flagged=frozenset("b"),
)
AM_33 = _each(
    "AM-33",
    "What does ClearMissionStatus answer {}?",
    {"a": "OK without ids", "b": "FAILED_PRECONDITION", "c": "INVALID_ARGUMENT"},
    "a",
    {"fresh": "a robot that never had a mission", "cleared": "when nothing is listed any more"},
    flagged="c",
)
AM_34 = {
    where: Ambiguity(
        f"AM-34.{where}",
        f"What does ClearMissionStatus do when nothing is active and {words}?",
        {"a": "it clears everything", "b": "it clears the ended missions", "c": "FAILED_PRECONDITION"},
        default="a" if where == HALTED else "c",
    )
    for where, words in WAITING.items()
}
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
    flagged=frozenset("b"),
)
AM_37_QUEUED = _each(
    "AM-37.queued",
    "Do waiting missions alone forbid ChargeRobot where {}?",
    {
        "a": "yes",
        "b": "no, charging joins the queue",
        "c": "no, charging comes first",
        "o": "no, charging comes first, though it is listed behind them",
    },
    "a",
    WAITING,
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
    flagged=frozenset("cdg"),
)
DOCK, LOCATION = "dock", "location"
AM_38_BUSY = {
    state: _each(
        f"AM-38.{state}",
        f"{words} and {{}}: what does ChargeRobot answer?",
        {"e": "FAILED_PRECONDITION", "f": "what it answers for what is missing"},
        "e",
        {DOCK: "the robot has no contact dock", LOCATION: "the map has no charging location"},
    )
    for state, words in (
        ("running", "A mission is running"),
        ("paused", "A mission is paused"),
    )
}
AM_40 = Ambiguity(
    "AM-40",
    "May charging be paused?",
    {"a": "yes, it is a mission like others", "c": "no, FAILED_PRECONDITION"},
    default="a",
)
AM_41 = _each(
    "AM-41",
    "A mission is for another family: what does {} answer?",
    {
        "a": "INVALID_ARGUMENT",
        "b": "FAILED_PRECONDITION",
        "c": "OK, and the mission fails when it is started",
        "d": "OK, and the mission fails on the way",
    },
    "a",
    (*BATCHES, "CreateMission", "AppendMission"),
    flagged="cd",
)
AM_43 = _each(
    "AM-43",
    "{}: a destination is not on the map: when is it refused?",
    {
        "a": "at once, INVALID_ARGUMENT",
        "b": "the mission is accepted and fails when it is started",
        "d": "the mission is accepted and fails on the way",
    },
    "a",
    (*CREATING, *APPENDING),
    flagged="bd",
)
AM_43_LEFT = Ambiguity(
    "AM-43.left",
    "What becomes of a mission under way of which a goal leaves the map?",
    {"a": "it goes on", "e": "it may fail", "p": "the goal is passed over; where none is left, the mission fails"},
    default="a",
)
AM_44 = _each(
    "AM-44",
    "{}: may a goal occur twice in one mission?",
    {"a": "yes", "i": "no, INVALID_ARGUMENT"},
    "a",
    (*CREATING, *APPENDING),
)
AM_44_AUTOMATIC = _each(
    "AM-44.automatic",
    "{}: may a goal occur twice in the list of a NavigateAuto mission?",
    {"a": "yes", "i": "no, INVALID_ARGUMENT"},
    "a",
    (*BATCHES, "CreateMission", "AppendMission"),
)
AM_45_NONE = _each(
    "AM-45.none",
    "What does {} do when no goal is free?",
    {"a": "it waits, running", "b": "it fails", "d": "it takes the first goal"},
    "a",
    _kinds(kind for kind in Kind if kind in AUTOMATIC),
)
AM_45_REFUSED = _each(
    "AM-45.none.refused",
    "{}: is a NavigateAuto mission refused of which no goal is free?",
    {
        "a": "no",
        "c": "yes, INVALID_ARGUMENT or FAILED_PRECONDITION",
        "s": "yes, INVALID_ARGUMENT or FAILED_PRECONDITION, where it would start at once",
    },
    "a",
    (*BATCHES, "CreateMission", "AppendMission"),
)
AM_45_WHEN = _each(
    "AM-45.when",
    "When does {} select its goal?",
    {
        "h": "when it is created",
        "i": "when it starts",
        "j": "when it starts, and again on the way",
        "o": "when it starts, and again where another robot takes its goal",
    },
    "i",
    _kinds(kind for kind in Kind if kind in AUTOMATIC),
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
AM_49 = Ambiguity(
    "AM-49.timestamp",
    "Does every message say when it was recorded?",
    {"a": "yes", "b": "no, the timestamp may be absent"},
    default="a",
    flagged=frozenset("b"),
)
AM_50_SHAPE = Ambiguity(
    "AM-50.shape",
    "Is the feedback of a Servi or Carti mission a message or a bare enum?",
    {"a": "a message with a status", "b": "a bare enum, which only JSON can say"},
    default="a",
    json_only=frozenset("b"),
)
AM_50_MEMBER = Ambiguity(
    "AM-50.member",
    "Which feedback does a base mission of a Servi or Carti robot report?",
    {"c": "that of the mission's kind", "d": "that of the robot's family"},
    default="c",
    flagged=frozenset("d"),
)
AM_51 = _each(
    "AM-51",
    "Which mission_type does {} of a Servi or Carti robot report?",
    {"a": "base_type", "b": "the type of the robot's family"},
    "a",
    _kinds((Kind.BASE_NAVIGATE, Kind.BASE_NAVIGATE_AUTO)),
    flagged="b",
)
_UNABLE = "{}: what is answered where the robot is unable to start a mission?"
_UNABLE_FIRST = {
    "a": "FAILED_PRECONDITION",
    "b": "OK",
    "i": "INTERNAL: that it cannot be started is a failure of the mission system",
    "t": "OK, or DEADLINE_EXCEEDED",
}
AM_53 = {
    **_each("AM-53", _UNABLE, _UNABLE_FIRST, "a", ("CreateMission", "ChargeRobot"), flagged="i", alike=False),
    "CreateMissionWorkflow": Ambiguity(
        "AM-53.CreateMissionWorkflow",
        _UNABLE.format("CreateMissionWorkflow"),
        {**_UNABLE_FIRST, "v": "INVALID_ARGUMENT: the workflow does not fit the robot's state"},
        default="a",
        flagged=frozenset("iv"),
    ),
    **_each("AM-53", _UNABLE, {"b": "OK", "t": "OK, or DEADLINE_EXCEEDED"}, "b", APPENDING, alike=False),
    "CreateMissionBatch": Ambiguity(
        "AM-53.CreateMissionBatch",
        _UNABLE.format("CreateMissionBatch"),
        {"a": "FAILED_PRECONDITION", "t": "FAILED_PRECONDITION, or DEADLINE_EXCEEDED"},
        default="a",
    ),
}
QUEUE = "queue"
AM_53_THEN = _each(
    "AM-53.then",
    "What becomes of {}, while the robot is unable to start a mission?",
    {"p": "it waits", "f": "it may fail", "s": "it starts all the same"},
    "p",
    {QUEUE: "a mission whose turn it is", **{call: f"a first mission that {call} makes" for call in ADDING}},
)
AM_54 = {
    **_each(
        "AM-54",
        "Is what {} makes seen all at once?",
        {"a": "yes", "b": "no, it may be seen growing"},
        "a",
        BATCHES,
        flagged="b",
    ),
    "CreateMissionWorkflow": Ambiguity(
        "AM-54.CreateMissionWorkflow",
        "Are the missions of a workflow seen all at once?",
        {"a": "yes", "b": "no, they may be seen growing"},
        default="a",
    ),
}
AM_58 = _each(
    "AM-58",
    "{}: is a request with an unknown field malformed?",
    {"a": "no, the field is ignored", "b": "yes, INVALID_ARGUMENT"},
    "a",
    EVERY_CALL,
)
AM_58_SENT = _each(
    "AM-58.sent",
    "Do {} have fields that are not documented?",
    {"a": "no", "b": "yes"},
    "a",
    ("answers", "messages"),
    flagged="b",
    alike=False,
)
AM_61 = Ambiguity(
    "AM-61",
    "May codes of the transport and of authentication come that no table lists?",
    {"a": "no", "b": "yes"},
    default="a",
    flagged=frozenset("b"),
)
AM_63 = _each(
    "AM-63",
    "Is the first mission that {} makes seen before it runs?",
    {"a": "no, it is running at once", "b": "yes, waiting at first"},
    "a",
    ADDING,
    alike=False,
)
AM_64 = Ambiguity(
    "AM-64.goals",
    "Where does a resumed mission go on?",
    {"a": "at its goal", "b": "at its first goal"},
    default="a",
    flagged=frozenset("b"),
)
AM_64_AUTOMATIC = Ambiguity(
    "AM-64.automatic",
    "Where does a resumed NavigateAuto mission go on?",
    {"a": "at its goal", "c": "it selects again"},
    default="a",
)


def _ambiguities(value: object) -> Iterable[Ambiguity]:
    if isinstance(value, Ambiguity):
        yield value
    elif isinstance(value, Mapping):
        for one in value.values():
            yield from _ambiguities(one)


AMBIGUITIES: tuple[Ambiguity, ...] = tuple(
    one for name, value in tuple(globals().items()) if name.startswith("AM_") for one in _ambiguities(value)
)
"""In the order of the list."""

WAIVED: Mapping[str, str] = {
    "AM-05": "whose state it is cannot matter: any active or waiting mission forbids the calls, and ended ones do not",
    "AM-08 d": "a waiting mission that is reported as running is not actively running",
    "AM-11 c": "a mission that is accepted and never starts is a defect, and a blocked robot is another question",
    "AM-13 c": "no bound is documented",
    "AM-14 g": "a paused mission is active: it is to be finished or cancelled before a clear, as an active one is",
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
    "AM-39": "type, place and end of a charge are not described: any type and at most one goal that stay, any end",
    "AM-40 b": "the page calls it a mission and reports it among them, so it can be appended to",
    "AM-42": "the number of goals is all that can be told from this page; kinds of destinations are not on it",
    "AM-43 c": "NOT_FOUND is in no table of these calls; names are compared as they are",
    "AM-45 f, g": "what others claim is part of the world that a tester sets; a robot's own queue claims nothing",
    "AM-45 l": "the page says that lower indices are preferred",
    "AM-46": "numbers are compared within one stream alone, which is right under every scope; an equal one is invalid",
    "AM-48": "the example is careless: a mission lists the goals of its request, one for Navigate",
    "AM-49 a, b": "the encoding tells nothing about the robot: both forms are read everywhere",
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
