"""Conversations worth having with a mission server, whole: each goes where chance seldom does.

After everything that may have consequences there is a pause of more than a second, for servers that look about once a
second (AI-39 b), and the statuses are asked for.
"""

from __future__ import annotations

from missionfsm.isaac.server.script import MISSION, A, B, Script
from missionfsm.kernel.alphabet import pick, upcoming
from missionfsm.kernel.codec import JSON

_LAPS = {"goals.path": {"FollowPath": {"laps": 2, "tolerance": 0.25}}}

_RICH = {
    "goals.path": {
        "Plan": {"on": False, "laps": 0, "note": "", "goals": [], "deep": {"er": {"still": [0.5, {"x": None}]}}}
    },
    "words": {"Say": {"text": "carter " * 200}},
}

_GRIP = {"arm": {"Grip": {"force": 17, "on": True}}}

_CONFIGS: tuple[JSON, ...] = (3, 0, 0.5, True, False, "", [], [{}], ["carter"])
"""What is no configuration."""

_SCRIPTS = (
    # A diamond over two robots: nothing starts before its upstreams have succeeded, and then everything does.
    Script()
    .submit(A, timeout=60)
    .submit(B, 0, timeout=60)
    .submit(B, 0, 1, timeout=60)
    .robot(0, A)
    .robot(1, B)
    .report(0, 0, "running")
    .report(0, 0, "success")
    .report(1, 1, "running")
    .report(1, 1, "success")
    .report(1, 2, "running")
    .report(1, 2, "success"),
    # A configuration arrives whole, and each mission has its own.
    Script().submit(A, config=_RICH).submit(A, 0, config=_GRIP).robot(0, A).report(0, 0, "success"),
    # A diamond: of two missions after one, each is as good as the other, and what comes after both waits for both.
    Script()
    .submit(A)
    .submit(A, 0)
    .submit(B, 0)
    .submit("carter-03", 1, 2)
    .robot(0, A)
    .robot(1, "carter-03")
    .report(0, 0, "success")
    .robot(2, B)
    .report(2, 2, "success")
    .report(0, 1, "success"),
    # Two missions after one: the failure of one is none of the other.
    Script().submit(A).submit(A, 0).submit(A, 0).robot(0, A).report(0, 0, "success").report(0, 1, "failure"),
    # A failure cancels all of a chain, however long it is.
    Script().submit(A).submit(A, 0).submit(B, 1).submit(A, 2).submit(B, 3).robot(0, A).report(0, 0, "failure").wait(6),
    # Three upstreams, of which the last is the last to succeed; one that is named twice is one.
    Script()
    .submit(A)
    .submit(A)
    .submit(B)
    .submit("carter-03", 0, 1, 2)
    .submit("carter-04", 0, 0)
    .robot(0, A)
    .robot(1, "carter-03")
    .report(0, 0, "success")
    .report(0, 1, "success")
    .robot(2, B)
    .report(2, 2, "success")
    .robot(3, "carter-04"),
    # What had ended before a mission was submitted counts as what ends after.
    Script()
    .submit(A)
    .robot(0, A)
    .report(0, 0, "success")
    .submit(A, 0)
    .wait()
    .report(0, 1, "failure")
    .submit(A, 0)
    .submit(A, 1)
    .wait(),
    # One of two upstreams is not enough; then the other fails.
    Script()
    .submit(A)
    .submit(A)
    .submit(B, 0, 1)
    .robot(0, A)
    .robot(1, B)
    .report(0, 0, "success")
    .report(0, 1, "running")
    .report(0, 1, "failure"),
    # The last of two upstreams succeeds first, and the first of two.
    Script()
    .submit(A)
    .submit(B)
    .submit("carter-03", 0, 1)
    .submit("carter-04", 1, 0)
    .robot(0, A)
    .robot(1, B)
    .robot(2, "carter-03")
    .robot(3, "carter-04")
    .report(1, 1, "success")
    .report(0, 0, "running"),
    # A failure cancels all that depends on it, and nothing else.
    Script()
    .submit(A)
    .submit(A, 0)
    .submit(A, 1)
    .submit(A)
    .submit(B)
    .robot(0, A)
    .report(0, 0, "running")
    .say(0, 0, "failure")
    .look()
    .wait()
    .submit(A, 0)
    .look()
    .wait()
    .robot(1, B)
    .report(0, 1, "success")
    .report(1, 2, "success"),
    # An upstream that is never acknowledged is aborted, which is a failure; what comes too late means nothing.
    Script()
    .submit(A, start_timeout=3)
    .submit(B, 0)
    .submit(B, 1)
    .robot(0, A)
    .robot(1, B)
    .wait(4)
    .report(0, 0, "success")
    .submit(B, 0)
    .wait(),
    # A mission runs out of time; the robot's last word on it is not about the next one.
    Script()
    .submit(A, timeout=4)
    .submit(A)
    .submit(B, 0)
    .robot(0, A)
    .robot(1, B)
    .report(0, 0, "running")
    .wait(0.5)
    .report(0, 0, "running")
    .wait(4)
    .report(0, 1, "running")
    .report(0, 0, "failure")
    .report(0, 1, "success"),
    # What is said of a timeout counts, to a part of a second; where nothing is said there are five seconds to start.
    Script().submit(A, start_timeout=1.9).robot(0, A),
    Script().submit(A, timeout=2.75).robot(0, A).report(0, 0, "running").wait(0.9).wait(2),
    Script().submit(A, start_timeout=3).robot(0, A).wait(5).submit(A).wait(9),
    # RUNNING that is said again and again gives no more time.
    Script()
    .submit(A, timeout=4)
    .robot(0, A)
    .report(0, 0, "running")
    .report(0, 0, "running")
    .report(0, 0, "running")
    .wait(3),
    # Half of a timeout is not enough.
    Script().submit(A, timeout=8).robot(0, A).report(0, 0, "running").wait(5).report(0, 0, "running").wait(5),
    # How long an acknowledgement takes shows from when timeout counts.
    Script()
    .submit(A, start_timeout=8, timeout=8)
    .robot(0, A)
    .wait(5)
    .report(0, 0, "running")
    .wait(5)
    .report(0, 0, "running")
    .wait(5),
    # Once acknowledged, a mission may take its time; once ended, it stays so.
    Script()
    .submit(A, start_timeout=2)
    .robot(0, A)
    .report(0, 0, "running")
    .wait(5)
    .report(0, 0, "running")
    .report(0, 0, "success")
    .report(0, 0, "failure")
    .report(0, 0, "running"),
    # No later word undoes an end, whichever it was.
    Script()
    .submit(A)
    .submit(A)
    .submit(B, 0)
    .robot(0, A)
    .report(0, 0, "failure")
    .report(0, 0, "success")
    .report(0, 1, "success")
    .report(0, 1, "failure"),
    # A robot that reports nothing for long, though it was acknowledged, is still at it.
    Script().submit(A).robot(0, A).report(0, 0, "running").wait(4000).report(0, 0, "success"),
    # What was queued waits for its robot; what is done is not sent again.
    Script()
    .submit(A)
    .submit(A)
    .submit(A)
    .robot(0, A)
    .report(0, 0, "running")
    .report(0, 0, "success")
    .drop(0)
    .wait(2)
    .robot(1, A)
    .report(1, 1, "success")
    .report(1, 2, "running")
    .report(1, 2, "success")
    .drop(1)
    .robot(2, A),
    # A robot drops in the middle of its mission.
    Script()
    .submit(A, timeout=20)
    .submit(A, timeout=20)
    .submit(B, 0)
    .robot(0, A)
    .report(0, 0, "running")
    .drop(0)
    .robot(1, A)
    .report(1, 1, "running")
    .report(1, 1, "success")
    .wait(30),
    # Of two connections with one name one is the robot.
    Script().robot(0, A).robot(1, A).submit(A).wait().drop(1).submit(A).wait().name(0, A).wait(),
    # A mission that comes while its robot is there and free; another waits for its turn.
    Script()
    .robot(0, A)
    .submit(A, config=_LAPS, channel="arm", status_channel="arm_news")
    .wait()
    .submit(A, config=_GRIP)
    .wait()
    .report(0, 0, "success")
    .report(0, 0, "running", "arm_news")
    .report(0, 0, "success", "arm_news")
    .report(0, 1, "failure"),
    # Names: said again, in other letters, on another channel, by nobody; and the statuses of others.
    Script()
    .submit(A)
    .connect()
    .wait()
    .name(0, A, "elsewhere")
    .wait()
    .name(0, A.upper())
    .wait()
    .robot(1, B)
    .robot(2, A)
    .name(2, A)
    .name(2, A)
    .report(1, 0, "running")
    .report(1, 0, "success")
    .report(2, 0, "running")
    .name(2, A)
    .report(2, 0, "success"),
    # Names that begin alike are two.
    Script().submit(A).submit(A[:-1]).robot(0, A[:-1]).wait().robot(1, f"{A}0").wait(),
    # Lines that are no messages are nobody's loss.
    Script()
    .submit(A)
    .submit(B)
    .robot(0, A)
    .robot(1, B)
    .raw(0, "no json")
    .report(1, 1, "running")
    .report(0, 0, "running")
    .report(0, 0, "success")
    .report(1, 1, "success"),
    # Who goes first: one that waits is in front, and of the others there are several.
    Script()
    .submit(B)
    .submit(A, 0)
    .submit(A)
    .submit(A)
    .robot(0, A)
    .report(0, 0, "success")
    .robot(1, B)
    .report(1, 1, "success"),
    # Statuses that name their mission in the payload, in the header, nowhere.
    Script()
    .submit(A)
    .submit(A)
    .submit(A)
    .robot(0, A)
    .report(0, 0, "running", by="")
    .report(0, 0, "running", by="header")
    .report(0, 0, "success", by="payload")
    .report(0, 1, "success", by="header")
    .report(0, 1, "success", by=""),
    # The status channel of a mission that names another channel only.
    Script()
    .submit(A, channel="arm")
    .robot(0, A)
    .report(0, 0, "running", "arm_status")
    .report(0, 0, "success", "mission_status"),
    # A newer connection takes over in the middle of a mission.
    Script()
    .submit(A, timeout=30)
    .submit(A)
    .robot(0, A)
    .report(0, 0, "running")
    .robot(1, A)
    .report(0, 0, "success")
    .report(1, 0, "success")
    .drop(1),
    # An upstream that was sent and not acknowledged when its downstream came.
    Script().submit(A).robot(0, A).submit(A, 0).wait().report(0, 0, "success").report(0, 1, "running"),
    Script().submit(A).robot(0, A).robot(1, B).submit(B, 0).wait().report(0, 0, "success"),
    # Timeouts of 0.
    Script().submit(A, timeout=0).submit(A, start_timeout=0).robot(0, A).report(0, 0, "running").wait().wait(),
    Script().submit(A, start_timeout=0).robot(0, A).wait(3),
    # A timeout of more than a day.
    Script().submit(A, timeout=90_000).robot(0, A).report(0, 0, "running").wait(90_100),
    # Of two connections the one that connected first says the name last.
    Script().connect().connect().name(1, A).wait().name(0, A).wait().submit(A).wait(),
    # A connection that was taken over drops, and the robot may be free with that.
    Script().submit(A).submit(A).robot(0, A).connect().name(1, A).drop(0),
    # What goes on on a connection that was taken over runs out of time, or not.
    Script().submit(A, timeout=4).robot(0, A).report(0, 0, "running").robot(1, A).wait(8),
    # One upstream fails while the other runs.
    Script()
    .submit(A)
    .submit(B)
    .submit(A, 0, 1)
    .robot(0, A)
    .robot(1, B)
    .report(1, 1, "running")
    .report(0, 0, "failure")
    .report(1, 1, "success"),
    # Names with space around them, a second name, a name whose message has numbers for its times, and odd messages.
    Script()
    .submit(A)
    .submit(B)
    .connect()
    .name(0, f" {A} ")
    .wait()
    .connect()
    .name(1, B, pubtime=17, acqtime=17)
    .wait()
    .report(1, 0, "running")
    .robot(2, A)
    .raw(2, '{"header":{"channel":"camera","proto":"TensorProto"},"payload":{}}')
    .report(2, 1, "running")
    .report(2, 0, "running")
    .name(2, B)
    .wait()
    .report(2, 1, "success"),
    # Identifiers of which one half is right, the lower or the upper, are nobody's.
    Script()
    .submit(A)
    .submit(A)
    .robot(0, A)
    .half(0, 0, "running", "lower")
    .half(0, 0, "running", "upper")
    .report(0, 0, "running")
    .half(0, 0, "failure", "lower")
    .half(0, 0, "failure", "upper")
    .wait()
    .report(0, 0, "success")
    .half(0, 1, "success", "lower"),
    # A connection that drops is its own robot's affair: others go on with what is sent, runs, waits or has ended.
    Script()
    .submit(A, timeout=60)
    .submit(A)
    .submit(B, start_timeout=60)
    .submit("carter-03")
    .submit("carter-03", start_timeout=60)
    .robot(0, A)
    .report(0, 0, "running")
    .robot(1, B)
    .robot(2, "carter-03")
    .report(2, 3, "success")
    .connect()
    .drop(3)
    .robot(4, "carter-04")
    .drop(4)
    .drop(2)
    .report(1, 2, "running")
    .report(1, 2, "success")
    .drop(1)
    .report(0, 0, "success")
    .report(0, 1, "success"),
    # What is submitted while a robot is away waits for it, and what came before and after does; so it is a second time.
    Script()
    .submit(A)
    .robot(0, A)
    .report(0, 0, "success")
    .drop(0)
    .submit(A)
    .submit(A)
    .look()
    .robot(1, A)
    .report(1, 1, "success")
    .submit(A)
    .report(1, 2, "failure")
    .report(1, 3, "running")
    .drop(1)
    .submit(A)
    .robot(2, A)
    .report(2, 4, "success"),
    # A mission is cancelled in the queue of a robot that is busy: it is busy still.
    Script()
    .submit(A, timeout=60)
    .submit(B)
    .submit(A, 1)
    .submit(A)
    .robot(0, A)
    .report(0, 0, "running")
    .robot(1, B)
    .report(1, 1, "failure")
    .wait()
    .report(0, 0, "success"),
    # Each mission of a robot has the timeouts that are its own, or none.
    Script()
    .submit(A, start_timeout=2, timeout=4)
    .submit(A, start_timeout=20)
    .submit(A, start_timeout=2, timeout=4)
    .robot(0, A)
    .report(0, 0, "running")
    .report(0, 0, "success")
    .wait(4)
    .report(0, 1, "running")
    .wait(6)
    .report(0, 1, "success")
    .report(0, 2, "running")
    .wait(6),
    # The time that a robot's last mission took is not the next one's.
    Script()
    .submit(A, timeout=8)
    .submit(A, timeout=8)
    .robot(0, A)
    .report(0, 0, "running")
    .wait(5)
    .report(0, 0, "success")
    .report(0, 1, "running")
    .wait(4),
    # What a robot says that acknowledges nothing gives no more time.
    Script()
    .submit(A, start_timeout=5)
    .robot(0, A)
    .name(0, A)
    .wait()
    .say(0, 0, "running", "elsewhere")
    .name(0, A, "elsewhere")
    .wait()
    .name(0, A)
    .wait(2.5),
    # A configuration is an object, or the mission is refused.
    Script().odd(*({"robot": A, "config": config} for config in _CONFIGS)).look(),
    # Upstreams that do not exist, and what is of another type than documented.
    Script()
    .odd(
        {"robot": A, "config": [1]},
        {"robot": A, "config": "{}"},
        {"robot": 7},
        {"robot": A, "channel": 3},
        {"robot": A, "start_timeout": "5"},
        {"robot": A, "timeout": True},
        {"robot": A, "timeout": -0.5},
        {"robot": A, "upstream": "1"},
        {"robot": A, "upstream": [0.5]},
        "carter",
    )
    .look()
    .refused(upcoming("mission"))
    .submit(B)
    .refused(-1)
    .refused(upcoming("mission"))
    .refused(pick("mission", MISSION), 999)
    .robot(0, A),
)

SCRIPTS = tuple(tuple(script.lines) for script in _SCRIPTS)
"""Every script as the tools take it."""
