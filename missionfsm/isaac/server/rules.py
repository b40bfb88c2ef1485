"""What the page says of the mission server: why a mission is refused, and what is promised. ``MissionSubmission``."""

from __future__ import annotations

from missionfsm.isaac.server.inputs import EMPTY, HANDLE, KEY, MALFORMED, NEGATIVE, NO_NAME, NULL, NULL_CONFIG, Ask
from missionfsm.isaac.server.readings import AI_19, AI_20_EMPTY, AI_20_KEYS, AI_20_NULL, AI_20_REPEATED, AI_33_NULL
from missionfsm.isaac.server.state import SYSTEM_NAME, Server
from missionfsm.isaac.shared import promises
from missionfsm.isaac.shared.line import MISSION_SUBMISSION as PAGE
from missionfsm.isaac.shared.promises import CLIENT
from missionfsm.kernel.readings import declared
from missionfsm.kernel.rules import INVALID_ARGUMENT, Citation, Operation, Rule, promise, refusal

KEYS = PAGE["Sample Usage", "Key"]
SERVER = PAGE["MissionServer Class"]
DEPENDENCIES = PAGE["Mission Dependencies"]
NAMES = PAGE["Robot Identification"]


@refusal(INVALID_ARGUMENT, cite=KEYS)
def the_mission_is_malformed(_: Server, ask: Ask) -> bool:
    """The mission is no object, or a field has a wrong type (AI-20 a)."""
    return MALFORMED in ask.submission.defects


@refusal(INVALID_ARGUMENT, cite=PAGE["Sample Usage", "upstream"])
def an_upstream_is_no_handle(_: Server, ask: Ask) -> bool:
    """An upstream is not a non-negative integer.

    AI-20: -1 does not mean the last one.
    """
    return HANDLE in ask.submission.defects


@refusal(INVALID_ARGUMENT, cite=DEPENDENCIES)
def an_upstream_is_unknown(_: Server, ask: Ask) -> bool:
    """An upstream is a mission that was never submitted; the mission itself is one of those.

    AI-21: only so is what is submitted a directed acyclic graph.
    """
    return None in ask.upstream


@refusal(INVALID_ARGUMENT, cite=PAGE["Sample Usage", "upstream"], assumes=AI_20_REPEATED["a"])
def an_upstream_is_named_twice(_: Server, ask: Ask) -> bool:
    """An upstream is named twice, and such a mission is refused (AI-20.repeated)."""
    known = [one for one in ask.upstream if one is not None]
    return len(set(known)) < len(known)


@refusal(INVALID_ARGUMENT, cite=PAGE["Sample Usage", "timeout"])
def a_timeout_is_negative(_: Server, ask: Ask) -> bool:
    """A timeout is less than 0 (AI-24 c)."""
    return NEGATIVE in ask.submission.defects


@refusal(INVALID_ARGUMENT, cite=PAGE["Sample Usage", "robot"])
def the_robots_name_is_empty(_: Server, ask: Ask) -> bool:
    """The robot's name is empty, which no robot can be called (AI-37 d)."""
    return NO_NAME in ask.submission.defects


@refusal(INVALID_ARGUMENT, cite=PAGE["Sample Usage", "robot"], assumes=AI_19["c"])
def the_mission_has_no_robot(_: Server, ask: Ask) -> bool:
    """No robot is named, and such a mission is refused (AI-19)."""
    return ask.submission.robot is None


@refusal(INVALID_ARGUMENT, cite=KEYS, assumes=AI_20_KEYS["a"])
def a_key_is_unknown(_: Server, ask: Ask) -> bool:
    """The mission has a key that is not documented, and such a mission is refused (AI-20.keys)."""
    return KEY in ask.submission.defects


@refusal(INVALID_ARGUMENT, cite=KEYS, assumes=AI_20_NULL["a"])
def a_field_is_null(_: Server, ask: Ask) -> bool:
    """A field that has a type is null, and that is taken for a wrong type (AI-20.null)."""
    return NULL in ask.submission.defects


@refusal(INVALID_ARGUMENT, cite=KEYS, assumes=AI_20_EMPTY["a"])
def a_channel_is_empty(_: Server, ask: Ask) -> bool:
    """A channel's name is empty, and such a mission is refused (AI-20.empty)."""
    return EMPTY in ask.submission.defects


@refusal(INVALID_ARGUMENT, cite=PAGE["Sample Usage", "config"], assumes=AI_33_NULL["b"])
def the_configuration_is_null(_: Server, ask: Ask) -> bool:
    """The configuration is null, and that is taken for a wrong type (AI-33.null)."""
    return NULL_CONFIG in ask.submission.defects


def _promise(topic: str, name: str, says: str, cite: Citation, argues: str = "") -> Rule:
    return promise(name, says, cite=cite, argues=argues).registered(SYSTEM_NAME, topic)


ACCEPTED = promise("a-mission-is-queued-for-its-robot", "A submitted mission is queued for its robot.", cite=SERVER)
SHOWN = promise(
    "every-mission-is-shown-with-its-status",
    "Every mission is shown with where it stands.",
    cite=PAGE["Sample Usage", "Mission.Status"],
    argues="AI-02, AI-04: of the names only the class counts; the order of the incomplete ones never goes backwards.",
)

SENT = _promise(
    "dispatch",
    "a-ready-mission-is-sent-to-its-robot",
    "A mission whose upstreams have succeeded is sent, once, on the connection of its robot, when that is free.",
    NAMES,
    "AI-11, AI-12, AI-13, AI-39: one at a time, and which one, and when.",
)
CHANNEL = _promise(
    "dispatch",
    "a-mission-goes-to-its-channel",
    "The MissionProto is sent on the mission's channel.",
    PAGE["Sample Usage", "channel"],
)
CONFIG = _promise(
    "dispatch",
    "a-mission-carries-its-configuration",
    "The MissionProto carries the configuration of the mission.",
    PAGE["Sample Usage", "config"],
)
UNNAMED = _promise(
    "dispatch",
    "only-its-robot-gets-a-mission",
    "A mission is sent on a connection that has said its robot's name, and on no other.",
    NAMES,
)
UPSTREAM = _promise(
    "dependencies",
    "a-mission-waits-for-its-upstreams",
    "A mission is not sent before all its upstreams have completed successfully.",
    DEPENDENCIES,
    "AI-01: the sentence that says successfully is the most specific one.",
)
CANCELED = _promise(
    "dependencies",
    "a-failed-upstream-cancels",
    "If an upstream fails, the mission is cancelled.",
    DEPENDENCIES,
    "AI-03, AI-36: cancelled and aborted upstreams count, and others are not waited for.",
)
NAMED = _promise(
    "connection",
    "the-name-makes-the-robot",
    "A text on the name channel says which robot the connection belongs to; said again it has no effect.",
    NAMES,
    "AI-16, AI-17, AI-37.",
)
OTHER = _promise(
    "connection",
    "what-means-nothing-has-no-effect",
    "A line that is no message, or a message that nobody waits for, changes nothing, for its connection or for others.",
    CLIENT,
    "AI-26, AI-38: it may close its own connection.",
)
DROPPED = _promise(
    "connection",
    "queued-missions-wait-for-the-robot",
    "When a connection drops, missions that were not sent wait for the robot to come back.",
    NAMES,
    "AI-15: what was sent goes on, is sent again, or has failed.",
)
RUNNING = _promise(
    "status",
    "running-acknowledges",
    "RUNNING for a mission that was sent means that it runs.",
    PAGE["Mission Codelet", "step 3"],
)
FINAL = _promise(
    "status",
    "a-final-status-ends-the-mission",
    "SUCCESS or FAILURE for a mission that was sent ends it so, whether RUNNING came before or not.",
    PAGE["Mission Codelet", "step 4"],
    "AI-07 a, AI-10.",
)
LATE = _promise(
    "status",
    "an-ended-mission-stays-ended",
    "What is said of a mission that has ended changes nothing.",
    PAGE["Mission Codelet", "step 4"],
    "AI-09: the status is the final one.",
)
ABORTED = _promise(
    "timeout",
    "start-timeout-aborts",
    "A mission that its robot does not acknowledge within start_timeout is aborted.",
    PAGE["Sample Usage", "start_timeout"],
    "AI-05, AI-07, AI-24.",
)
OVERRUN = _promise(
    "timeout",
    "timeout-aborts",
    "A mission that is not completed within timeout is aborted.",
    PAGE["Sample Usage", "timeout"],
    "AI-06, AI-24.",
)
SILENCE = _promise(
    "timeout",
    "silence-is-no-loss",
    "A mission whose robot stops reporting RUNNING goes on.",
    PAGE["Mission Codelet", "step 3"],
    "AI-31: no period is documented.",
)
ENVELOPE = promises.ENVELOPE.registered(SYSTEM_NAME, "line")
INTEGERS = promises.INTEGERS.registered(SYSTEM_NAME, "line")
RULES = tuple(one for one in declared(globals(), Rule) if one.id)

OPERATIONS = {
    one.name: one
    for one in (
        Operation.with_rules(
            "submit",
            SYSTEM_NAME,
            SERVER,
            refusals=(
                the_mission_is_malformed,
                an_upstream_is_no_handle,
                an_upstream_is_unknown,
                an_upstream_is_named_twice,
                a_timeout_is_negative,
                the_robots_name_is_empty,
                the_mission_has_no_robot,
                a_key_is_unknown,
                a_field_is_null,
                a_channel_is_empty,
                the_configuration_is_null,
            ),
            promises=(ACCEPTED,),
        ),
        Operation.with_rules("statuses", SYSTEM_NAME, PAGE["Sample Usage", "Mission.Status"], promises=(SHOWN,)),
    )
}
