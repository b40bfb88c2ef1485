"""Conversations about submission, dependencies, order, limits and configurations."""

from __future__ import annotations

from talk import Talk


def refusals(talk: Talk) -> None:
    """Acceptable and unacceptable missions."""
    talk.submit("a")
    for mission in (
        None,
        {},
        {"robot": ""},
        {"robot": None},
        {"robot": 3},
        {"robot": "a", "channel": 3},
        {"robot": "a", "status_channel": []},
        {"robot": "a", "config": [1]},
        {"robot": "a", "config": "x"},
        {"robot": "a", "timeout": -1},
        {"robot": "a", "timeout": "5"},
        {"robot": "a", "start_timeout": True},
        {"robot": "a", "timeout": 1e400},
        {"robot": "a", "upstream": [999999]},
        {"robot": "a", "upstream": 1},
        {"robot": "a", "upstream": ["1"]},
        {"robot": "a", "colour": 1},
        {"robot": "a", "channel": ""},
        {"robot": "a", "config": None},
        {"robot": "a", "timeout": None},
        {"robot": "a", "start_timeout": 0.5},
    ):
        talk.submit_raw(mission)
    talk.submit("a", [0, 0])
    talk.submit("b", [0])
    connection = talk.connect("a")
    for _ in range(6):
        talk.report(connection, "success")
    talk.submit("c")
    talk.submit("c")
    talk.submit("d", [4])
    talk.connect("c")
    talk.expect("++qsqq")


def float_upstream(talk: Talk) -> None:
    """An upstream written as 1.0."""
    talk.submit("a")
    talk.submit_raw({"robot": "a", "upstream": [1.0]})


def chain(talk: Talk) -> None:
    """Three missions of two robots one after another, all well."""
    first = talk.connect("a")
    second = talk.connect("b")
    talk.submit("a", config={"n": 1})
    talk.submit("b", [0], config={"n": 2})
    talk.submit("a", [1], config={"n": 3})
    talk.expect("sqq")
    talk.report(first, "running")
    talk.report(first, "running")
    talk.expect("rqq")
    talk.report(first, "success")
    talk.expect("+sq")
    talk.report(second, "running")
    talk.report(second, "success")
    talk.report(first, "running")
    talk.expect("++r")
    talk.report(first, "success")
    talk.advance(100)
    talk.expect("+++")


def broken_chain(talk: Talk) -> None:
    """The first of a chain fails, once in each way; independent missions go on."""
    for way in ("failure", "timeout", "drop"):
        talk.reset()
        first, second = talk.connect("a"), talk.connect("b")
        talk.submit("a", timeout=3)
        talk.submit("b", [0])
        talk.submit("b", [1])
        talk.submit("a", [2])
        talk.submit("a")
        talk.submit("b")
        talk.submit("b")
        talk.report(second, "running")
        talk.report(first, "running")
        if way == "failure":
            talk.report(first, "failure")
            talk.expect("fuuusrq")
        elif way == "timeout":
            talk.advance(3)
            talk.expect("tuuusrq")
            talk.report(first, "success", 0)
            talk.expect("tuuusrq")
        else:
            talk.drop(first)
            talk.expect("duuuqrq")
        talk.report(second, "success")
        talk.submit("b", [0])
        talk.advance(20)


def diamond(talk: Talk) -> None:
    """A diamond over four robots, then one where a branch fails late."""
    for ending in ("success", "failure"):
        talk.reset()
        robots = [talk.connect(name) for name in "abcd"]
        talk.submit("a")
        talk.submit("b", [0])
        talk.submit("c", [0])
        talk.submit("d", [1, 2])
        for robot in (0, 1):
            talk.report(robots[robot], "running")
            talk.report(robots[robot], "success")
        talk.expect("++sq")
        talk.report(robots[2], "running")
        talk.report(robots[2], ending)
        talk.expect("+++s" if ending == "success" else "++fu")


def joins(talk: Talk) -> None:
    """Three upstreams, one of which fails, at every place, before the others end."""
    for place in range(3):
        talk.reset()
        robots = [talk.connect(name) for name in "abc"]
        last = talk.connect("d")
        for name in "abc":
            talk.submit(name)
        talk.submit("d", [0, 1, 2])
        for robot in robots:
            talk.report(robot, "running")
        talk.report(robots[place], "failure")
        talk.advance(0.5)
        for other in range(3):
            if other != place:
                talk.report(robots[other], "success")
        talk.advance(2)
        talk.report(last, "success")
        talk.expect("".join("f" if other == place else "+" for other in range(3)) + "u")
    for order in ((0, 1, 2), (2, 1, 0)):
        talk.reset()
        robots = [talk.connect(name) for name in "abcd"]
        for name in "abc":
            talk.submit(name)
        talk.submit("d", [0, 1, 2])
        for robot in order:
            talk.report(robots[robot], "success")
        talk.expect("+++s")


def one_robot(talk: Talk) -> None:
    """A queue of one robot with dependencies within it."""
    robot = talk.connect("a")
    talk.submit("a")
    talk.submit("a", [0])
    talk.submit("a", timeout=40)
    talk.submit("a", timeout=7)
    talk.submit("a", [3])
    talk.submit("b", [2])
    talk.report(robot, "running")
    talk.advance(1)
    talk.expect("rqqqqq")
    talk.report(robot, "failure")
    for _ in range(5):
        talk.advance(1.5)
        talk.report(robot, "running")
        talk.report(robot, "success")
    talk.advance(1)
    talk.expect("fu+++q")


def order(talk: Talk) -> None:
    """Blocked and free missions mixed; a later one becomes free before an earlier one."""
    other = talk.connect("b")
    third = talk.connect("c")
    talk.submit("b")
    talk.submit("c")
    talk.submit("a", [0])
    talk.submit("a", [1])
    talk.report(third, "success")
    talk.report(other, "success")
    robot = talk.connect("a")
    talk.submit("a")
    for _ in range(4):
        talk.report(robot, "success")
    talk.expect("+++++")
    talk.submit("b", timeout=9)
    talk.submit("a", [5])
    talk.submit("a")
    talk.expect("+++++sqs")


def start_limit(talk: Talk) -> None:
    """Start limits, default and given, whole and not, struck and kept."""
    robot = talk.connect("a")
    talk.submit("a")
    talk.advance(4.75)
    talk.expect("s")
    talk.name(robot, "a")
    talk.advance(0.25)
    talk.expect("t")
    talk.advance(6)
    talk.submit("a", start_timeout=1.5)
    talk.advance(1.25)
    talk.expect("ts")
    talk.advance(0.25)
    talk.advance(0.5)
    talk.expect("tt")
    talk.report(robot, "success")
    talk.submit("a", start_timeout=2)
    talk.advance(1)
    talk.report(robot, "running")
    talk.advance(30)
    talk.report(robot, "running", 0)
    talk.report(robot, "success", 0)
    talk.expect("ttr")
    talk.report(robot, "success")
    talk.submit("a", start_timeout=0)
    talk.advance(3)
    talk.drop(robot)
    talk.connect("a")
    talk.submit("a")


def run_limit(talk: Talk) -> None:
    """Run limits, with waiting before and reports during the run."""
    talk.submit("a", timeout=6.5, start_timeout=20)
    talk.submit("b", [0])
    talk.submit("a", timeout=30)
    talk.submit("a", timeout=0)
    talk.submit("a", timeout=4)
    talk.advance(3)
    robot = talk.connect("a")
    talk.connect("b")
    talk.advance(2)
    talk.report(robot, "running")
    talk.advance(4)
    talk.report(robot, "running")
    talk.advance(2)
    talk.expect("rqqqq")
    talk.advance(0.5)
    talk.advance(0.5)
    talk.expect("tusqq")
    talk.report(robot, "success", 0)
    talk.report(robot, "running")
    talk.advance(20)
    talk.expect("turqq")
    talk.report(robot, "success")
    talk.expect("tu+sq")
    talk.report(robot, "running")
    talk.expect("tu+ts")
    talk.report(robot, "running")
    talk.report(robot, "success")
    talk.advance(10)
    talk.expect("tu+t+")


def zero_limits(talk: Talk) -> None:
    """A start limit of zero, and what follows it."""
    robot = talk.connect("a")
    talk.submit("a", start_timeout=0)
    talk.expect("t")
    talk.submit("a", [0])
    talk.submit("a")
    talk.advance(0.5)
    talk.report(robot, "success")
    talk.advance(3)


def long_limits(talk: Talk) -> None:
    """More than an hour and more than a day."""
    robot, other = talk.connect("a"), talk.connect("b")
    talk.submit("a")
    talk.submit("b", timeout=100000)
    talk.report(robot, "running")
    talk.report(other, "running")
    talk.advance(99999)
    talk.expect("rr")
    talk.advance(10)
    talk.expect("rt")


def waiting_limits(talk: Talk) -> None:
    """Long waits before the sending spend nobody's limits; two robots' limits run beside each other."""
    talk.submit("a", start_timeout=3, timeout=5)
    talk.submit("b", [0], start_timeout=3, timeout=5)
    talk.advance(10)
    talk.expect("qq")
    first, second = talk.connect("a"), talk.connect("b")
    talk.report(first, "running")
    talk.advance(4)
    talk.report(first, "success")
    talk.expect("+s")
    talk.report(second, "running")
    talk.submit("a", start_timeout=2)
    talk.submit("c", start_timeout=9)
    talk.connect("c")
    talk.advance(2.5)
    talk.expect("+rts")
    talk.advance(2.5)
    talk.expect("+tts")


def configurations(talk: Talk) -> None:
    """Configurations with everything that JSON has."""
    robot = talk.connect("a")
    talk.submit(
        "a",
        config={
            "b": True,
            "a": False,
            "zero": 0,
            "empty": {},
            "nothing": None,
            "text": 'ü "quoted"\n',
            "list": [1.5, -2, [3.25]],
            "large": 12345678901234567890,
            "deep": {"er": {"and": {"deeper": {"still": 1}}}},
        },
    )
    talk.report(robot, "success")
    talk.submit("a")
    talk.report(robot, "success")
    talk.submit("a", [0], config={"other": "x" * 3000})
    talk.report(robot, "success")
    talk.expect("+++")


def twins(talk: Talk) -> None:
    """Equal missions, one of which has ended when the other is reported on."""
    robot = talk.connect("a")
    talk.submit("a", config={"n": 1})
    talk.submit("a", config={"n": 1})
    talk.report(robot, "failure")
    talk.advance(1)
    talk.report(robot, "success")
    talk.expect("f+")


def siblings(talk: Talk) -> None:
    """Missions that share an upstream and a robot; one fails."""
    robots = [talk.connect(name) for name in "abc"]
    talk.submit("a")
    talk.submit("b", [0])
    talk.submit("c")
    talk.submit("c", [0])
    talk.report(robots[0], "success")
    talk.submit("b")
    talk.report(robots[1], "failure")
    talk.expect("+fsqs")
