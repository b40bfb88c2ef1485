"""Where the page can be read in more than one way as to the mission server; ``specs/isaac-server.md`` argues each.

Letters are those of its entries; an entry with several questions has an ambiguity for each. Readings that the
list calls violations are not offered.
"""

from __future__ import annotations

from collections.abc import Mapping

from missionfsm.isaac.shared import readings as shared
from missionfsm.kernel.readings import Ambiguity, declared

AI_02_CANCELED = Ambiguity(
    "AI-02.canceled",
    "How is a mission called that was cancelled?",
    {"a": "canceled", "b": "failed"},
)
AI_02_ABORTED = Ambiguity(
    "AI-02.aborted",
    "How is a mission called that was aborted?",
    {"a": "aborted", "b": "failed", "c": "timed out"},
    default="c",
)
AI_03 = Ambiguity(
    "AI-03",
    "Which failures of an upstream cancel a mission?",
    {
        "a": "all: cancelled and aborted upstreams as well",
        "b": "only what a robot reported; after others the mission waits for ever",
        "c": "all but cancellations; after those the mission waits for ever",
    },
    flagged="bc",
    rule="a-failed-upstream-cancels",
)
AI_03_WHEN = Ambiguity(
    "AI-03.when",
    "When is a mission cancelled whose upstream has failed?",
    {
        "n": "at once",
        "q": "in the next scheduling pass",
        "p": "in a scheduling pass in which it heads the queue of a robot that is there and idle",
        "h": "as soon as it heads the queue of a robot that is there and idle",
    },
    flagged="ph",
    rule="a-failed-upstream-cancels",
)
AI_04 = Ambiguity(
    "AI-04",
    "What is a submitted mission that waits for upstreams?",
    {"a": "QUEUED", "b": "CREATED"},
)
AI_04_ROBOT = Ambiguity(
    "AI-04.robot",
    "What is a submitted mission whose robot is not there?",
    {"q": "QUEUED", "r": "CREATED"},
)
AI_04_NEW = Ambiguity(
    "AI-04.new",
    "What is a mission that has just been submitted?",
    {"a": "what it is later on, as long as it is queued", "b": "CREATED until a scheduling pass has looked at it"},
)
AI_04_SENT = Ambiguity(
    "AI-04.sent",
    "What is a mission that was sent and not acknowledged?",
    {"s": "STARTED", "t": "QUEUED"},
    flagged="t",
    rule="every-mission-is-shown-with-its-status",
)
AI_05 = Ambiguity(
    "AI-05",
    "From when does start_timeout count?",
    {
        "a": "from when the mission is sent",
        "b": "from its submission",
        "c": "from when its upstreams have succeeded",
        "d": "from when its robot is connected",
    },
    flagged="bcd",
    rule="start-timeout-aborts",
)
AI_06 = Ambiguity(
    "AI-06",
    "From when does timeout count?",
    {
        "a": "from the acknowledgement",
        "b": "from when the mission is sent",
        "c": "from its submission",
        "d": "from when the mission is sent, though it aborts only what was acknowledged",
    },
    flagged="c",
    rule="/timeout-aborts",
)
AI_07 = Ambiguity(
    "AI-07",
    "What acknowledges a mission?",
    {
        "a": "any status",
        "b": "RUNNING only; a final status before it is not heard",
        "c": "that it could be sent",
    },
    flagged="bc",
    rule="a-final-status-ends-the-mission",
)
AI_08 = Ambiguity(
    "AI-08",
    "What does an abort do to the robot?",
    {
        "a": "nothing: it goes on until it is preempted",
        "c": "its connection is closed",
        "d": "nothing, and it is sent no other mission until it has said how that one ended",
        "e": "nothing; if it has said that it runs that one, it is sent no other until it has said how that ended",
    },
    flagged="cde",
    rule="a-ready-mission-is-sent-to-its-robot",
)
AI_09 = Ambiguity(
    "AI-09",
    "What is a final status worth that comes after the end?",
    {"a": "nothing", "b": "the last one counts", "c": "the first after an abort counts"},
    flagged="bc",
    rule="an-ended-mission-stays-ended",
)
AI_10 = Ambiguity(
    "AI-10",
    "How is a status matched to a mission?",
    {
        "a": "by the mission that it names, or else to the robot's current one on that channel",
        "b": "only by the mission that its payload names",
        "c": "only by the identifier in its header",
        "d": "by its channel alone: it is about the robot's current one there",
    },
    flagged="cd",
    rule="a-final-status-ends-the-mission",
)
AI_10_FROM = Ambiguity(
    "AI-10.from",
    "On which connections is a status heard of a mission?",
    {
        "r": "on that of its robot, or the one that it was sent on",
        "n": "on each that has said its robot's name, or the one that it was sent on",
        "w": "on any, if it names its mission",
    },
)
AI_11 = Ambiguity(
    "AI-11",
    "How many missions is a robot sent at a time?",
    {
        "a": "one",
        "b": "all that are ready",
        "c": "one on each channel",
        "d": "all that are ready when its connection is named, and one at a time after that",
    },
    flagged="bd",
    rule="a-ready-mission-is-sent-to-its-robot",
)
AI_12 = Ambiguity(
    "AI-12",
    "Does a mission that waits for upstreams hold up those behind it?",
    {"a": "no, they overtake it", "b": "yes"},
)
AI_13 = Ambiguity(
    "AI-13",
    "Which of several missions that are ready goes first?",
    {"a": "the one that was submitted first", "b": "any"},
)
AI_14_STATUS = Ambiguity(
    "AI-14.status",
    "On which channel are the statuses of a mission that names only its channel?",
    {"a": '"mission_status"', "b": "its channel's name with _status appended"},
    flagged="b",
    rule="running-acknowledges",
)
AI_15 = Ambiguity(
    "AI-15",
    "What becomes of a mission that was acknowledged when its robot's connection drops?",
    {"a": "nothing: its timeouts decide", "b": "it is sent again", "c": "it has failed"},
    default="c",
)
AI_15_SENT = Ambiguity(
    "AI-15.sent",
    "What becomes of a mission that was sent and not acknowledged when its robot's connection drops?",
    {"a": "nothing: its timeouts decide", "b": "it is sent again", "c": "it has failed"},
    default="c",
)
AI_15_WHEN = Ambiguity(
    "AI-15.when",
    "When does a mission that was sent fail, or is it sent again, whose robot's connection drops?",
    {
        "n": "at once",
        "p": "in the next scheduling pass",
        "r": "once the robot is back",
        "g": "after a while, unless the robot is back before: then it goes on",
    },
)
AI_16 = Ambiguity(
    "AI-16",
    "Which of two connections with one name is the robot?",
    {
        "a": "the newer",
        "b": "the one that had the name first",
        "d": "that one, and the other is closed",
        "n": "the one that said the name later",
        "s": "both: each is given what comes next",
    },
    flagged="s",
)
AI_16_OLDER = Ambiguity(
    "AI-16.older",
    "Another connection becomes the robot: what of the one that was it?",
    {"v": "it is kept", "w": "it is closed"},
)
AI_16_UNDER_WAY = Ambiguity(
    "AI-16.under-way",
    "A newer connection becomes the robot: what of the mission that was sent on the older?",
    {
        "k": "it goes on there, and the robot is busy with it",
        "l": "as if that connection had dropped",
        "m": "it goes on there without its timeouts, and the robot is free",
        "n": "it goes on on the newer one",
    },
    default="l",
)
AI_16_BACK = Ambiguity(
    "AI-16.back",
    "The connection that is the robot drops, and another has said the same name: is that the robot now?",
    {
        "p": "at once",
        "q": "when it says its name again; until then it has none",
        "s": "when it says its name again; until then another name is a second one (AI-17)",
        "r": "never",
    },
    default="q",
)
AI_16_AGAIN = Ambiguity(
    "AI-16.again",
    "What does a connection do by saying its name again while another with that name is the robot?",
    {"t": "nothing", "u": "what it would do by saying it for the first time"},
    default="u",
)
AI_17 = Ambiguity(
    "AI-17",
    "What does another name on a connection do?",
    {
        "a": "nothing",
        "b": "the connection is that robot's from then on",
        "d": "it closes the connection",
    },
)
AI_17_UNDER_WAY = Ambiguity(
    "AI-17.under-way",
    "A connection becomes another robot's by another name: what of the mission that was sent on it?",
    {"k": "it goes on there", "l": "as if that connection had dropped"},
    default="l",
)
AI_18_EARLY = Ambiguity(
    "AI-18.early",
    "What becomes of a status that comes before the name?",
    {"a": "it is ignored", "b": "it is kept until the name is known"},
)
AI_18_UNNAMED = Ambiguity(
    "AI-18.unnamed",
    "What becomes of a connection that says no name?",
    {"c": "it is kept", "d": "it is closed after a time"},
)
AI_19 = Ambiguity(
    "AI-19",
    "What becomes of a mission without a robot?",
    {"a": "it is never sent", "b": "any robot gets it", "c": "it is refused"},
    default="c",
    flagged="b",
)
AI_20_KEYS = Ambiguity(
    "AI-20.keys", "Is a mission with an unknown key refused?", {"a": "yes", "c": "no, the key is ignored"}, default="c"
)
AI_20_NULL = Ambiguity(
    "AI-20.null",
    "What is a field that is null?",
    {"a": "of the wrong type: the mission is refused", "c": "left out"},
)
AI_20_EMPTY = Ambiguity(
    "AI-20.empty", "Is a mission with an empty channel refused?", {"a": "yes", "c": "no"}, default="c"
)
AI_20_REPEATED = Ambiguity(
    "AI-20.repeated",
    "Is a mission refused that names an upstream twice?",
    {"a": "yes", "c": "no, it is waited for once"},
    default="c",
)
AI_22_STARTED = Ambiguity(
    "AI-22.started",
    "What is an upstream that was sent but not acknowledged when its downstream is submitted?",
    {
        "a": "waited for",
        "i": "as good as failed, as in the shipped software",
        "j": "waited for, and then as good as failed, however it ended",
    },
    flagged="ij",
    rule="a-failed-upstream-cancels",
)
AI_24 = Ambiguity("AI-24", "What is a timeout of 0?", {"a": "one that has elapsed at once", "b": "none"})
AI_24_WHOLE = Ambiguity(
    "AI-24.whole",
    "When has a timeout elapsed?",
    {
        "x": "as soon as that much time has passed",
        "w": "in the first scheduling pass in which more whole seconds of less than a day have passed",
    },
    flagged="w",
    rule="timeout-aborts",
)
AI_25_TAKEN = Ambiguity(
    "AI-25.taken",
    "Is a message understood whose 64-bit integers are numbers instead of strings?",
    {"a": "yes, both are", "b": "no, strings only"},
)
AI_25_HEADER = shared.AI_25_HEADER
AI_26 = Ambiguity(
    "AI-26",
    "What does a line do that cannot be read?",
    {"e": "it is skipped", "f": "its connection is closed"},
)
AI_26_BLANK = Ambiguity(
    "AI-26.blank",
    "What does a line do on which nothing stands?",
    {"e": "nothing", "f": "its connection is closed, as by one that cannot be read"},
)
AI_27_UUID = shared.AI_27_UUID
AI_27_TAKEN = Ambiguity(
    "AI-27.taken",
    "Is a message understood whose header has no type id, or an unsigned one?",
    {"a": "yes", "b": "no, it is no message"},
)
AI_28_TAKEN = Ambiguity(
    "AI-28.taken",
    "Is a status understood that is in capitals, or a number?",
    {"a": "yes", "b": "no, only a name in lower case is"},
)
AI_28_CONFIG = Ambiguity(
    "AI-28.config",
    "How does a MissionProto carry its configuration?",
    {"a": "as an object", "b": "as a string that holds JSON"},
    default="b",
    rule="a-mission-carries-its-configuration",
)
AI_28_UUID = Ambiguity(
    "AI-28.uuid",
    "Does a MissionProto say which mission it is?",
    {"y": "yes, its payload has the mission's uuid", "n": "no"},
    flagged="n",
    rule="a-line-is-one-message",
)
AI_29 = Ambiguity(
    "AI-29",
    "When may the server end, and its connections with it?",
    {"d": "once its missions are done, however they ended", "s": "at any time, as one that is stopped does"},
    flagged="s",
)
AI_31 = Ambiguity(
    "AI-31",
    "Is a mission lost whose robot stops reporting RUNNING?",
    {"a": "yes, after some time", "b": "no"},
    default="b",
    flagged="a",
    rule="silence-is-no-loss",
)
AI_33_NULL = Ambiguity(
    "AI-33.null", "What is a configuration that is null?", {"a": "an empty one", "b": "a reason to refuse"}
)
AI_36 = Ambiguity(
    "AI-36",
    "When is a mission cancelled that waits for other upstreams too?",
    {"a": "at once", "b": "when they have ended as well"},
)
AI_37 = Ambiguity(
    "AI-37",
    "How is the text taken that a robot says as its name?",
    {"a": "exactly", "b": "without the space around it"},
)
AI_37_EMPTY = Ambiguity(
    "AI-37.empty",
    "What is a text that is empty, said as a name?",
    {"d": "nothing: the name is still waited for", "n": "the connection's name, which is no robot's"},
)
AI_38 = Ambiguity(
    "AI-38",
    "What does a message of a type do that does not travel as JSON?",
    {"a": "it is skipped", "d": "its connection is closed"},
    flagged="d",
    rule="what-means-nothing-has-no-effect",
)
AI_39 = Ambiguity(
    "AI-39",
    "When is a mission sent that can be, and when is a timeout noticed?",
    {"a": "at once", "b": "when the server looks, about once a second"},
)
AI_39_FAILED = Ambiguity(
    "AI-39.failed",
    "When does a server that sends at once send the next mission to a robot whose mission has just failed?",
    {"a": "at once", "b": "up to a second later"},
)
AI_39_SUCCEEDED = Ambiguity(
    "AI-39.succeeded",
    "When does a server that sends at once send the next mission to a robot whose mission has just succeeded?",
    {"a": "at once", "b": "up to a second later"},
)
AI_39_ABORTED = Ambiguity(
    "AI-39.aborted",
    "When does a server that sends at once send the next mission to a robot whose mission has just timed out?",
    {"a": "at once", "b": "up to a second later"},
)
AI_39_LIMITS = Ambiguity(
    "AI-39.limits",
    "When does a server notice a timeout that sends at once?",
    {"a": "at once", "b": "when it looks, about once a second"},
)
AI_39_REPORTS = Ambiguity(
    "AI-39.reports",
    "When does a server that looks about once a second show what a robot has reported?",
    {"a": "at once", "b": "when it looks"},
)
AI_39_ORDER = Ambiguity(
    "AI-39.order",
    "A scheduling pass takes up names and drops, and sends: in which order?",
    {
        "n": "first it takes up names and drops",
        "s": "first it sends: to a name that it takes up then in the next pass, on a connection that dropped in vain",
    },
)

AMBIGUITIES = declared(globals(), Ambiguity)

WAIVED: Mapping[str, str] = {
    "AI-01": "one reading is left, completed successfully; sending a downstream after a failure is a violation",
    "AI-08 b": "no stop message is documented, so none could be told from a mistake",
    "AI-14 a, b": "several channels of one robot are the question of AI-11 c",
    "AI-16 c": "both connections getting the mission is a violation",
    "AI-20 b": "mission files are not the server's; a submission is refused for all that is not asked apart",
    "AI-21": "a handle exists once that mission was submitted: no upstream is further down, none makes a cycle",
    "AI-22 a to h": "it makes and submits in one; an ended upstream counts at once (g); h is a violation",
    "AI-23": "not observable: slips in the sample",
    "AI-27 a": "other fields of a header may be missing; that a uuid comes again after others is not noticed",
    "AI-29 a to c": "with what status the program around the server exits is not seen on its connections",
    "AI-30": "about the program around the server",
    "AI-32": "a FAILURE fails the mission that it is about, preempted or not (c); a and b are about the robot",
    "AI-34": "the statuses of the server are those of AI-04; STARTED is sent and not acknowledged (b)",
    "AI-35": "one reading is left: a failure does not affect missions that do not depend on it",
    "AI-37 c": "neither the default nor tolerated: robots whose names differ in case are two",
}
"""Entries, or readings of them, that make no ambiguity of the server, each with the reason."""
