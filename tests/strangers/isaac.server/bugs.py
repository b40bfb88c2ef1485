"""Faults that contradict the page."""

from __future__ import annotations

from declared import Declared

_DEPENDENCIES = "MissionServer Class › Mission Dependencies"
_NAMING = "MissionServer Class › Robot Identification"
_FIELDS = "Sample Usage › mission file table"
_CLIENT = "JsonTcpClient Codelet"
_SERVER = "JsonTcpServer Class"
_CODELET = "Mission Codelet"

SUBMISSION_BUGS: tuple[Declared, ...] = (
    Declared("unknown-upstream-accepted", "An upstream that does not exist is passed over in silence.", _FIELDS),
    Declared("negative-limit-accepted", "A negative limit is taken as no limit.", _FIELDS),
    Declared("nameless-mission-accepted", "A mission without a robot is queued.", _FIELDS),
    Declared("list-config-accepted", "A configuration that is no object is accepted.", _FIELDS),
    Declared("text-limit-accepted", "A limit given as text is read as a number.", _FIELDS),
    Declared("fractional-limit-refused", "A limit that is no whole number is refused.", _FIELDS),
    Declared("limit-truncated", "Fractions of a second in a limit are cut off.", _FIELDS),
    Declared("two-upstreams-refused", "A mission with more than one upstream is refused.", _FIELDS),
    Declared("foreign-upstream-refused", "An upstream that is meant for another robot is refused.", _DEPENDENCIES),
    Declared("finished-upstream-refused", "An upstream that is over is no longer known and refused.", _FIELDS),
    Declared("start-default-doubled", "Without a start limit it is ten seconds.", _FIELDS),
    Declared("run-default-hour", "Without a run limit it is an hour.", _FIELDS),
    Declared("channel-default-wrong", "Without a channel a mission goes out on the channel missions.", _FIELDS),
    Declared("status-default-wrong", "Without a status channel reports are expected on the channel status.", _FIELDS),
    Declared(
        "config-default-shared",
        "A mission without a configuration gets that of the mission submitted before it.",
        _FIELDS,
    ),
)

DEPENDENCY_BUGS: tuple[Declared, ...] = (
    Declared("upstream-ignored", "Upstreams are not waited for.", _DEPENDENCIES),
    Declared("only-first-upstream", "Only the first upstream is looked at.", _DEPENDENCIES),
    Declared("only-last-upstream", "Only the last upstream is looked at.", _DEPENDENCIES),
    Declared("third-upstream-ignored", "Upstreams after the second are not looked at.", _DEPENDENCIES),
    Declared("newest-upstream-only", "Of the upstreams only the one submitted last is looked at.", _DEPENDENCIES),
    Declared("any-upstream-suffices", "A mission goes as soon as one of its upstreams has succeeded.", _DEPENDENCIES),
    Declared(
        "diamond-opens-early",
        "Where two upstreams have an upstream in common, the first to succeed suffices.",
        _DEPENDENCIES,
    ),
    Declared(
        "same-robot-upstream-ignored",
        "Upstreams on the mission's own robot are left to the order of the queue.",
        _DEPENDENCIES,
    ),
    Declared("other-robot-upstream-ignored", "Upstreams on other robots are not waited for.", _DEPENDENCIES),
    Declared("running-upstream-suffices", "A mission goes as soon as its upstreams are running.", _DEPENDENCIES),
    Declared("sent-upstream-suffices", "A mission goes as soon as its upstreams were sent.", _DEPENDENCIES),
    Declared("failed-upstream-counts", "An upstream that the robot reported as failed counts as done.", _DEPENDENCIES),
    Declared("timed-out-upstream-counts", "An aborted upstream counts as done.", _DEPENDENCIES),
    Declared("lost-upstream-counts", "An upstream that failed by a lost connection counts as done.", _DEPENDENCIES),
    Declared(
        "cancelled-upstream-counts", "A cancelled upstream counts as done: the third of a chain runs.", _DEPENDENCIES
    ),
    Declared("failed-upstream-unnoticed", "A mission whose upstream failed stays queued for ever.", _DEPENDENCIES),
    Declared("abort-unnoticed", "An aborted upstream cancels nothing: its downstreams stay queued.", _DEPENDENCIES),
    Declared("lost-unnoticed", "An upstream that failed by a lost connection cancels nothing.", _DEPENDENCIES),
    Declared("second-failure-unnoticed", "Only a failure of the first upstream cancels a mission.", _DEPENDENCIES),
    Declared(
        "failure-before-submission-runs",
        "An upstream that had failed before the mission was submitted counts as done.",
        _DEPENDENCIES,
    ),
    Declared(
        "success-before-submission-missed",
        "An upstream that had succeeded before the mission was submitted is waited for in vain.",
        _DEPENDENCIES,
    ),
    Declared("repeated-upstream-deadlocks", "An upstream that is named twice is waited for in vain.", _DEPENDENCIES),
    Declared("failure-cancels-queue", "A failed mission cancels all queued missions of its robot.", _DEPENDENCIES),
    Declared(
        "failure-cancels-siblings", "A failed mission cancels the others that share an upstream with it.", _DEPENDENCIES
    ),
    Declared("cancelled-still-sent", "A cancelled mission is sent to its robot all the same.", _DEPENDENCIES),
    Declared("cancelled-blocks-queue", "A cancelled mission stays at the head of its robot's queue.", _NAMING),
    Declared(
        "cancel-spreads-two-levels",
        "A cancellation reaches two levels of downstreams; the third waits for ever.",
        _DEPENDENCIES,
    ),
    Declared(
        "last-ended-decides",
        "Once all upstreams are over, the outcome of the one that ended last decides.",
        _DEPENDENCIES,
    ),
)

SENDING_BUGS: tuple[Declared, ...] = (
    Declared("unnamed-served", "A connection without a name gets the missions of absent robots.", _NAMING),
    Declared("name-prefix-matched", "A robot also gets missions of robots whose name begins with its own.", _NAMING),
    Declared("last-named-gets-all", "Missions go to the connection named last, whoever they are for.", _NAMING),
    Declared("sent-to-all", "A mission goes out on the connections of all robots.", _NAMING),
    Declared("resent-on-name", "A robot that says its name again gets its mission under way again.", _NAMING),
    Declared("name-again-fails", "A robot that says its name again loses the mission under way.", _NAMING),
    Declared("resent-after-success", "A robot that reports success gets the same mission once more.", _CODELET),
    Declared(
        "sent-all-at-once", "All free missions of a robot are sent at once, so that they preempt one another.", _CODELET
    ),
    Declared(
        "sent-after-acknowledgement", "The next mission is sent as soon as the one before it is running.", _CODELET
    ),
    Declared(
        "later-missions-not-sent",
        "What is submitted after the robot said its name waits for a new connection.",
        _NAMING,
    ),
    Declared("earlier-missions-not-sent", "Missions submitted before the robot said its name are never sent.", _NAMING),
    Declared("away-missions-not-sent", "Missions submitted while a robot is away after a drop are not sent.", _NAMING),
    Declared("return-replays", "A robot that comes back gets the missions again in which it had succeeded.", _NAMING),
    Declared("cancel-marks-idle", "The cancellation of a queued mission makes its robot count as idle.", _CODELET),
    Declared("stalls-after-drop", "A robot that dropped during a mission never gets one again.", _NAMING),
    Declared("one-mission-a-connection", "A connection gets one mission and no more.", _NAMING),
    Declared("stalls-after-failure", "A robot that reported a failure never gets a mission again.", _CODELET),
    Declared("stalls-after-abort", "A robot whose mission was aborted never gets a mission again.", _NAMING),
    Declared("one-robot-at-a-time", "While one robot has a mission the others get none.", _SERVER),
    Declared("one-connection", "While a robot is connected no other is listened to.", _SERVER),
    Declared("three-connections", "At most two robots are listened to at once.", _SERVER),
    Declared("dead-robot-served", "Missions are sent to a robot whose connection has dropped.", _NAMING),
    Declared("return-unnoticed", "A robot that comes back is still served on its first connection.", _NAMING),
    Declared("drop-fails-queued", "When a robot drops, its queued missions fail as well.", _NAMING),
    Declared("drop-fails-all", "When a robot drops, the missions under way on other robots fail too.", _SERVER),
    Declared("rubbish-stops-server", "After an unreadable line nobody is served any more.", _SERVER),
    Declared("name-channel-fixed", "Names are read on the channel name, whatever the server was told.", _NAMING),
    Declared("name-on-any-channel", "A text on any channel is taken as the robot's name.", _NAMING),
    Declared("name-lower-cased", "Names are turned to lower case before missions are looked up.", _NAMING),
    Declared(
        "old-drop-loses-robot", "When the older of a robot's two connections drops, the newer is not served.", _NAMING
    ),
    Declared("name-cut", "Names are cut to eight letters.", _NAMING),
)

MESSAGE_BUGS: tuple[Declared, ...] = (
    Declared("channel-fixed", "All missions go out on the channel mission.", _FIELDS),
    Declared("channels-swapped", "Missions go out on their status channel.", _FIELDS),
    Declared("header-left-out", "Lines hold the bare payload.", _CLIENT),
    Declared("uuid-as-numbers", "The halves of the mission's uuid go out as numbers.", _CLIENT),
    Declared("time-as-number", "Publishing times go out as numbers.", _CLIENT),
    Declared("halves-swapped", "The halves of the mission's uuid go out in each other's place.", _CODELET),
    Declared("uuid-rounded", "The halves of the mission's uuid are rounded to floating point.", _CODELET),
    Declared("uuid-from-content", "Missions with the same robot and configuration share a uuid.", _CLIENT),
    Declared("line-broken-up", "Messages are laid out over several lines.", _CLIENT),
    Declared("line-cut", "Lines are cut after 1024 characters.", _CLIENT),
    Declared("config-left-out", "The configuration sent is always empty.", _FIELDS),
    Declared("config-of-upstream", "A mission with an upstream is sent with that upstream's configuration.", _FIELDS),
    Declared("config-twice-serialized", "The configuration is serialized twice.", _FIELDS),
    Declared("config-falsy-dropped", "Members of the configuration that are false, zero or empty are lost.", _FIELDS),
    Declared("config-whole-numbers", "Numbers in lists of the configuration lose their fraction.", _FIELDS),
    Declared("config-large-numbers", "Large whole numbers in the configuration go through floating point.", _FIELDS),
    Declared("config-letters-lost", "Letters outside ASCII in the configuration become question marks.", _FIELDS),
    Declared("config-cut-deep", "Objects of the configuration below the third level are emptied.", _FIELDS),
    Declared("config-booleans-numbers", "True and false in the configuration become 1 and 0.", _FIELDS),
)

REPORT_BUGS: tuple[Declared, ...] = (
    Declared("running-ignored", "A running report changes nothing.", _CODELET),
    Declared("success-needs-running", "A success without a running report before it is ignored.", _CODELET),
    Declared("failure-needs-running", "A failure without a running report before it is ignored.", _CODELET),
    Declared("failure-ignored", "A failure report is ignored.", _CODELET),
    Declared("failure-as-success", "A failure report is taken as the mission's success.", _CODELET),
    Declared("report-on-any-channel", "Reports are accepted on any channel.", _FIELDS),
    Declared("report-channel-fixed", "Reports are accepted on the channel mission_status alone.", _FIELDS),
    Declared("report-uuid-unchecked", "A report is taken to be about its connection's mission under way.", _CODELET),
    Declared("report-upper-ignored", "Only the lower half of a report's uuid is compared.", _CODELET),
    Declared(
        "late-report-hits-next",
        "A report about a mission that is over is applied to the robot's next mission.",
        _CODELET,
    ),
    Declared(
        "reports-of-return-ignored",
        "A robot that comes back is still listened to on its first connection alone.",
        _NAMING,
    ),
    Declared("report-to-last-sent", "A report is taken to be about the mission sent last to any robot.", _CODELET),
    Declared("running-reopens", "A running report brings a mission that is over back to running.", _CODELET),
    Declared("success-reopens-abort", "A success report turns an aborted mission into a successful one.", _FIELDS),
    Declared("success-overrides-failure", "A success report turns a failed mission into a successful one.", _CODELET),
    Declared("failure-overrides-success", "A failure report turns a successful mission into a failed one.", _CODELET),
    Declared("shown-running-early", "A mission shows RUNNING as soon as it is sent.", _CODELET),
    Declared("failed-mission-retried", "A mission that failed is sent once more.", _CODELET),
)

LIMIT_BUGS: tuple[Declared, ...] = (
    Declared("start-limit-ignored", "A mission that is never acknowledged is never aborted.", _FIELDS),
    Declared("run-limit-ignored", "A mission that is never completed is never aborted.", _FIELDS),
    Declared("start-limit-in-minutes", "The start limit is counted in minutes.", _FIELDS),
    Declared("run-limit-in-milliseconds", "The run limit is counted in milliseconds.", _FIELDS),
    Declared("run-limit-doubled", "The run limit is twice as long.", _FIELDS),
    Declared("limits-swapped", "The start limit is used for the run and the run limit for the start.", _FIELDS),
    Declared(
        "start-limit-from-submission",
        "The start limit counts from submission, so that waiting missions are aborted.",
        _FIELDS,
    ),
    Declared("run-limit-from-submission", "The run limit counts from submission.", _FIELDS),
    Declared("run-clock-kept", "The run limits of all of a robot's missions count from its first run.", _FIELDS),
    Declared("run-limit-restarts", "Every running report starts the run limit anew.", _FIELDS),
    Declared(
        "start-limit-as-heartbeat", "A running mission is aborted when no report came for the start limit.", _FIELDS
    ),
    Declared("any-line-restarts-start", "Any line of the robot starts the start limit anew.", _FIELDS),
    Declared("zero-is-endless", "A limit of zero is taken as no limit.", _FIELDS),
    Declared("acknowledged-still-aborted", "The start limit strikes a mission that is running as well.", _FIELDS),
    Declared("completed-still-aborted", "The run limit strikes a mission that has succeeded as well.", _FIELDS),
    Declared("one-timer", "Only the mission sent last, to whatever robot, has limits.", _FIELDS),
    Declared("day-wraps", "Elapsed seconds are counted within a day: a longer limit never ends.", _FIELDS),
    Declared("abort-sends-again", "A mission that was not acknowledged in time is sent once more.", _FIELDS),
    Declared("abort-counts-as-success", "A mission that exceeds its run limit is taken as done.", _FIELDS),
    Declared("robot-limit-shared", "The run limit of a robot's first mission holds for all its missions.", _FIELDS),
)

BUGS: tuple[Declared, ...] = SUBMISSION_BUGS + DEPENDENCY_BUGS + SENDING_BUGS + MESSAGE_BUGS + REPORT_BUGS + LIMIT_BUGS
