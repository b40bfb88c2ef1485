"""Conversations about connections, names, drops and reports."""

from __future__ import annotations

from talk import Talk


def early_and_late(talk: Talk) -> None:
    """Missions before the connection and after it, and dependencies on what is over."""
    talk.submit("a")
    talk.submit("a")
    robot = talk.connect()
    talk.expect("qq")
    talk.name(robot, "a")
    talk.report(robot, "success")
    talk.report(robot, "failure")
    talk.expect("+f")
    talk.advance(1)
    talk.submit("a", [0])
    talk.submit("a", [1])
    talk.advance(2)
    talk.expect("+fsu")
    talk.report(robot, "success")
    talk.submit("a")
    talk.submit("b")
    talk.expect("+f+usq")


def repeated_names(talk: Talk) -> None:
    """A robot says its name again and again, and then another."""
    talk.submit("a")
    robot = talk.connect("a")
    talk.name(robot, "a")
    talk.report(robot, "running")
    talk.name(robot, "a")
    talk.expect("r")
    talk.submit("b")
    talk.name(robot, "b")
    talk.report(robot, "success")
    talk.expect("+q")
    talk.name(robot, "b")
    talk.submit("a")


def odd_names(talk: Talk) -> None:
    """Names that are empty, spaced, long, capital, prefixes, or on another channel."""
    for name in ("carter-10", "Carter", "a rather long name", "carter-1", " b", "b"):
        talk.submit(name)
    for name in ("carter-1", "Carter", "a rather long name", " b "):
        talk.connect(name)
    empty = talk.connect("")
    talk.name(empty, "b")
    elsewhere = talk.connect()
    talk.name(elsewhere, "carter-10", channel="names")
    talk.expect("qsssqs")
    talk.advance(70)


def name_channel(talk: Talk) -> None:
    """A world with another name channel, and messages of the wrong type on it."""
    talk.reset("who")
    talk.submit("a")
    robot = talk.connect()
    talk.name(robot, "a", channel="name")
    talk.expect("q")
    talk.name(robot, "a", channel="who", proto="-8059665372481944188")
    talk.expect("q")
    talk.name(robot, "a", channel="who", proto=None)
    talk.expect("s")


def same_name(talk: Talk) -> None:
    """Two connections with one name; the older, then the newer, drops."""
    for first_drop in (0, 1):
        talk.reset()
        talk.submit("a")
        talk.submit("a")
        talk.submit("a")
        pair = [talk.connect("a"), talk.connect("a")]
        talk.report(pair[0], "running")
        talk.report(pair[0], "success")
        talk.expect("+sq")
        talk.report(pair[1], "success")
        talk.name(pair[0], "a")
        talk.submit("a")
        talk.drop(pair[first_drop])
        talk.submit("a")
        talk.advance(1)
        talk.report(pair[1 - first_drop], "success")
        talk.report(pair[1 - first_drop], "success")
        talk.report(pair[1 - first_drop], "success")


def taken_over(talk: Talk) -> None:
    """A robot comes back while its old connection still stands."""
    talk.submit("a")
    talk.submit("a")
    old = talk.connect("a")
    talk.report(old, "running")
    new = talk.connect("a")
    talk.report(new, "success", about=old)
    talk.expect("rq")
    talk.name(old, "a")
    talk.report(old, "success")
    talk.drop(old)
    talk.report(new, "success")
    talk.submit("a")
    talk.expect("++s")


def dropped(talk: Talk) -> None:
    """Connections drop before and after the acknowledgement, and the robot returns."""
    for acknowledged in (False, True):
        for pause in (2, 20):
            talk.reset()
            talk.submit("a", start_timeout=10, timeout=15)
            talk.submit("a", start_timeout=60)
            talk.submit("b")
            other = talk.connect("b")
            talk.report(other, "running")
            robot = talk.connect("a")
            if acknowledged:
                talk.report(robot, "running")
            talk.drop(robot)
            talk.expect("dqr")
            talk.drop(robot)
            talk.advance(pause)
            robot = talk.connect("a")
            talk.expect("dsr")
            talk.report(robot, "running")
            talk.report(robot, "success")
            talk.submit("a")
            talk.report(robot, "success")
            talk.report(other, "success")
            talk.expect("d+++")


def returns(talk: Talk) -> None:
    """A robot leaves between missions and comes back for those submitted meanwhile."""
    robot = talk.connect("a")
    talk.submit("a")
    talk.report(robot, "success")
    talk.drop(robot)
    talk.submit("a")
    talk.submit("a")
    talk.advance(1)
    talk.expect("+qq")
    robot = talk.connect("a")
    talk.expect("+sq")
    talk.report(robot, "running")
    talk.report(robot, "success")
    talk.expect("++s")


def channels(talk: Talk) -> None:
    """Channels given and left out, reports on right and wrong ones."""
    robot = talk.connect("a")
    talk.submit("a", channel="work", config={"n": 1})
    talk.report(robot, "running", channel="work_status")
    talk.expect("s")
    talk.report(robot, "success", channel="mission_status")
    talk.expect("+")
    talk.submit("a", channel="work", status_channel="done")
    talk.report(robot, "success", channel="mission_status")
    talk.expect("+s")
    talk.report(robot, "running", channel="done")
    talk.report(robot, "failure", channel="work")
    talk.report(robot, "success", channel="done")
    talk.expect("++")


def reports(talk: Talk) -> None:
    """Reports that are out of order, doubled, of others, or badly written."""
    robot, other = talk.connect("a"), talk.connect("b")
    talk.submit("a")
    talk.submit("b")
    talk.report(other, "running", about=robot)
    talk.report(other, "RUNNING")
    talk.report(robot, "running", uuid={"lower": "5", "upper": "6"})
    talk.report(robot, "running", upper="6")
    talk.report(other, "done")
    talk.expect("ss")
    talk.report(robot, "running", proto="5")
    talk.report(robot, "running", numbers=True)
    talk.report(robot, "running", proto=None)
    talk.report(robot, "success")
    talk.report(robot, "running")
    talk.report(robot, "failure")
    talk.expect("+s")
    talk.report(other, "failure")
    talk.report(other, "running")
    talk.report(other, "success")
    talk.expect("+f")


def typed_reports(talk: Talk) -> None:
    """Halves as signed numbers, wrong type ids alone, no type ids alone."""
    for changes in ({"signed": True}, {"proto": "5"}, {"proto": None}, {"numbers": True}):
        talk.reset()
        robot = talk.connect("a")
        for _ in range(4):
            talk.submit("a")
            talk.report(robot, "success", **changes)
            talk.report(robot, "success")


def rubbish(talk: Talk) -> None:
    """Lines that cannot be read."""
    robot = talk.connect("a")
    talk.submit("a")
    for line in (
        "",
        "{",
        "[]",
        "5",
        "null",
        '{"header":5,"payload":{}}',
        '{"header":{"channel":"x"}}',
        '{"header":{"channel":"mission_status"},"payload":{}}',
        "[" * 5000,
    ):
        talk.line(robot, line)
    talk.connect()
    talk.report(robot, "success")
    talk.expect("+")


def away(talk: Talk) -> None:
    """A robot that is away has a mission whose upstream fails."""
    robot = talk.connect("a")
    talk.submit("a")
    talk.submit("b", [0])
    talk.submit("b", [1])
    talk.submit("b")
    talk.report(robot, "failure")
    talk.expect("fuuq")
    talk.advance(2)
    other = talk.connect("b")
    talk.report(other, "success")
    talk.report(other, "success")
    talk.expect("fuu+")


def many_robots(talk: Talk) -> None:
    """Several robots at once, one of which leaves."""
    robots = [talk.connect(name) for name in "abcd"]
    for name in "abcd":
        talk.submit(name)
    talk.expect("ssss")
    for robot in robots:
        talk.report(robot, "running")
    talk.drop(robots[1])
    talk.expect("rdrr")
    for robot in (robots[0], robots[2], robots[3]):
        talk.report(robot, "success")
    talk.expect("+d++")
