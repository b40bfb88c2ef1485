"""Missions, robots and clocks that have nothing to do with one another do not multiply, and nothing is lost by that."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from typing import Any

import attrs
import pytest
from server_history import SERVER, SETTLED, History
from test_isaac_runtime_profiles import Live

from missionfsm.isaac.runtime.profile import AS_SHIPPED, DOCUMENTED, Profile
from missionfsm.isaac.server import dispatch, effects, elapsing, queues, silent, unseen
from missionfsm.isaac.server import time as passing
from missionfsm.isaac.server.independence import Part, concerned, parts
from missionfsm.isaac.server.indifference import makes_no_difference
from missionfsm.isaac.server.spec import SPEC
from missionfsm.isaac.server.state import Link, Mission, Server, Status
from missionfsm.isaac.shared.drives import Passes
from missionfsm.kernel.focus import DRIVEN, RECEIVED, Focus
from missionfsm.oracle.automaton import Automaton
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.transcript import Head
from missionfsm.tools.check.judge import Judge, check

FULL = attrs.evolve(SERVER, spec=attrs.evolve(SPEC, silent_for=None))
"""The same server, with everything thought of that may have happened before each observation, in whatever order."""


def robots_away(count: int) -> History:
    history = History()
    for number in range(1, count + 1):
        history.submit(number, robot=f"r{number}")
    return history


def fleet(count: int) -> History:
    """So many robots with a mission each, sent by a server that looks about once a second."""
    history = robots_away(count)
    for number in range(1, count + 1):
        history.robot(number, f"r{number}")
    history.settles.waits(1)
    for number in range(count, 0, -1):
        history.sends(number, number)
    return history.settles


ELEVEN = (
    *(("a", ()), ("b", ()), ("c", ())),
    *(("a", (1,)), ("b", (1, 2)), ("c", (2, 3))),
    *(("a", (4, 5)), ("b", (5, 6)), ("c", (4, 6))),
    *(("a", (7, 8, 9)), ("b", (10,))),
)
"""Missions as robot and upstreams, numbered from 1."""


def eleven() -> History:
    """Eleven missions on three robots, each sent at once, reported on, and successful after a while."""
    history, links = History(), {"a": 1, "b": 2, "c": 3}
    for number, (robot, upstream) in enumerate(ELEVEN, 1):
        history.submit(number, robot=robot, config={"n": number}, timeout=30, upstream=list(upstream))
    for robot, link in links.items():
        history.robot(link, robot)
    sent: list[int] = []
    done: list[int] = []
    while len(done) < len(ELEVEN):
        for number, (robot, upstream) in enumerate(ELEVEN, 1):
            busy = any(ELEVEN[other - 1][0] == robot for other in sent if other not in done)
            if number not in sent and not busy and set(upstream) <= set(done):
                history.sends(links[robot], number, f'{{"n":{number}}}')
                sent.append(number)
        under_way = [number for number in sent if number not in done]
        history = history.settles.waits(1.5).settles
        for number in under_way:
            history.reports(links[ELEVEN[number - 1][0]], number, "running")
        history.waits(0.5).settles.reports(links[ELEVEN[under_way[0] - 1][0]], under_way[0], "success")
        done.append(under_way[0])
    return history.settles


def widest(history: History, world: Mapping[str, Any] | None = None) -> int:
    """The most explanations that there are after any of the lines."""
    judge = Judge(SERVER, Head("isaac.server", world or {}, ("connect", "line", "disconnect", "advance")))
    most = 0
    for line in history.lines:
        assert judge.feed(line)
        most = max(most, len(judge.belief.node.explanations))
    return most


def test_independent_missions_do_not_multiply() -> None:
    """A hundred missions wait for a minute, for one robot or for as many: as many explanations as with ten."""
    assert widest(robots_away(100).waits(60).settles) == widest(robots_away(10).waits(60).settles)
    one_robot = History()
    for number in range(1, 101):
        one_robot.submit(number)
    assert widest(one_robot.waits(60).settles) == widest(robots_away(10).waits(60).settles)


def test_independent_robots_do_not_multiply() -> None:
    """Of twelve robots each may have been looked at or not, each mission may have timed out or not."""

    def done(count: int) -> History:
        history = fleet(count).waits(5.5).settles
        half = ["FAILED_TIMEDOUT" if number % 2 else "STARTED" for number in range(count)]
        return history.shows(*half).waits(0.9).settles.shows(*["FAILED_TIMEDOUT"] * count)

    assert widest(done(12)) <= 2 * widest(done(3))


@pytest.mark.long
def test_eleven_missions_whose_times_are_measured_stay_few() -> None:
    """As over TCP, where every time may be off: three robots with eleven missions that wait for one another."""
    assert widest(eleven(), {"tolerance": 0.3}) < 250


def test_parts() -> None:
    """Missions are together that wait for one another, or have a robot that is there; ended ones are nobody's."""

    def mission(robot: str, *waits: int, status: Status = Status.QUEUED) -> Mission:
        return Mission(robot, "mission", None, "{}", None, None, waits=waits, status=status)

    server = Server(
        missions=(
            mission("a", status=Status.SUCCESS),
            mission("a"),
            mission("a"),
            mission("b"),
            mission("c"),
            mission("d", 3),
            mission("c"),
        ),
        links=(Link(0, "c", serves=True), Link(1)),
    )
    separate = (Part((1,), ()), Part((2,), ()), Part((3, 5), ()), Part((4, 6), (0,)), Part((), (1,)))
    assert parts(server) == separate
    assert concerned(server, Focus(RECEIVED, topics=(("link", 0),))) == (separate[3],)
    assert concerned(server, Focus(DRIVEN, Passes(1_000_000))) == ()


def told(history: History, system: Any, readings: Mapping[str, str]) -> tuple[bool, str]:
    """Whether a history is explained, and which readings are left."""
    head = Head("isaac.server", {}, ("connect", "line", "disconnect", "advance"))
    verdict = check(system, head, history.lines, readings=readings)
    return verdict.conforms, repr(sorted(verdict.readings.items())) if verdict.conforms else ""


def lived(draw: random.Random, profile: Profile) -> Live:
    """A short life of a server with two robots."""
    it = Live(profile)
    connected: list[str] = []
    for _ in range(draw.randint(5, 9)):
        what = draw.choice(["mission", "mission", "robot", "report", "report", "wait", "wait", "wait"])
        if what == "mission" and it.calls < 5:
            upstream = [1] if it.server._missions and draw.random() < 0.4 else []
            it.mission(draw.choice("rs"), upstream=upstream, start_timeout=draw.choice([1, 2.5]))
        elif what == "robot" and len(connected) < 2:
            connected.append("rs"[len(connected)])
            it.connects().named(len(connected), connected[-1])
        elif what == "report" and it.sent:
            link = draw.randint(1, len(connected))
            it.says_it(link, draw.randrange(len(it.sent)), draw.choice(["running", "success", "failure"]))
        else:
            it.after(draw.choice([0.4, 0.9, 1.3, 2.6]))
    return it.after(0.7)


def spoilt(draw: random.Random, it: History) -> History:
    """The history with one status shown otherwise, or one line left out or moved."""
    lines = list(it.lines)
    shown = [at for at, line in enumerate(lines) if line.get("result", {}).get("missions")]
    sent = [at for at, line in enumerate(lines) if "connection" in line]
    if sent and draw.random() < 0.4:
        lines.pop(draw.choice(sent))
    else:
        at = draw.choice(shown)
        missions = dict(lines[at]["result"]["missions"])
        missions[draw.choice(list(missions))] = draw.choice(["QUEUED", "STARTED", "RUNNING", "FAILED_TIMEDOUT"])
        lines[at] = {**lines[at], "result": {"missions": missions}}
    other = History()
    other.lines = lines
    return other


def compared(seed: int) -> None:
    draw = random.Random(seed)
    profile, readings = draw.choice(
        [(DOCUMENTED, {"AI-39": "a"}), (attrs.evolve(DOCUMENTED, scheduling_period=1.0), {"AI-39": "b"})]
    )
    if draw.random() < 0.3:
        profile, readings = AS_SHIPPED, dict(SERVER.profiles["as-shipped"])
    readings = {"AI-05": "a", "AI-06": "a", "AI-07": "a", "AI-08": "a", "AI-31": "b", **readings}
    it = lived(draw, profile)
    assert told(it, SERVER, readings) == told(it, FULL, readings)
    assert told(it, SERVER, readings)[0]
    if any(line.get("result", {}).get("missions") for line in it.lines):
        other = spoilt(draw, it)
        assert told(other, SERVER, readings) == told(other, FULL, readings)


def test_what_is_left_out_explains_nothing_more() -> None:
    """On lives of two robots, also with something wrong, the verdict is that of the full exploration."""
    for seed in range(20):
        compared(seed)


@pytest.mark.slow
def test_what_is_left_out_explains_nothing_more_often() -> None:
    """So it is on many more."""
    for seed in range(20, 70):
        compared(seed)


def queue_of(count: int, *, start: float = 2.5) -> History:
    """One robot and so many missions: each is sent in a pass and takes a second, those that wait may time out."""
    history = History()
    for number in range(1, count + 1):
        history.submit(number, start_timeout=start, config={"n": number})
        history.lines.append(SETTLED)
    history = history.robot(1).settles
    for number in range(1, count + 1):
        history = history.waits(1).sends(1, number, f'{{"n":{number}}}').settles
        history = history.reports(1, number, "running").settles.waits(1).settles.reports(1, number, "success").settles
    return history


def in_any_order(monkeypatch: pytest.MonkeyPatch, *, whatever: bool) -> None:
    """From here on clocks strike before or after everything else, also (`whatever`) where that makes no difference."""
    effects.advance.cache_clear()
    for module in (passing, elapsing, unseen):
        monkeypatch.setattr(module, "makes_no_difference", (lambda *_: False) if whatever else makes_no_difference)


def test_clocks_of_missions_in_a_queue_do_not_multiply() -> None:
    """Of eight missions that wait for one robot each may have timed out or not, whichever are sent: it is decided."""
    assert queue_of(8, start=5).shows(*["SUCCESS"] * 8).judged().conforms
    assert queue_of(2, start=5).shows("SUCCESS", "QUEUED").judged().violation is not None


@pytest.mark.slow
def test_queues_of_three_robots_are_decided() -> None:
    """Three robots with four missions each that look alike, sent in passes: nothing tells which of them is which."""
    history, robots = History(), (1, 2, 3)
    for number in range(1, 13):
        history.submit(number, robot=f"r{(number - 1) % 3 + 1}")
        history.lines.append(SETTLED)
    for robot in robots:
        history = history.robot(robot, f"r{robot}").settles
    for turn in range(4):
        history.waits(1)
        for robot in robots:
            history.sends(robot, 3 * turn + robot)
        for status in ("running", "success"):
            history.lines.append(SETTLED)
            for robot in robots:
                history.reports(robot, 3 * turn + robot, status)
    assert history.settles.shows(*["SUCCESS"] * 12).judged().conforms


def compared_in_any_order(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same verdict and readings, with those clocks left open and not."""
    draw = random.Random(seed)
    profile = attrs.evolve(DOCUMENTED, scheduling_period=draw.choice([0.0, 1.0, 1.0]))
    readings = {"AI-06": draw.choice("abc"), "AI-07": "a", "AI-11": "a", "AI-24.whole": "x", "AI-31": "b"}
    readings |= {"AI-05": draw.choice("bcd"), "AI-13": draw.choice("aab"), "AI-39.order": "n"}
    readings |= {"AI-08": draw.choice("ac"), "AI-39.limits": draw.choice("ab")}
    it = Live(profile)
    for _ in range(draw.randint(2, 3)):
        upstream = [draw.randint(1, it.calls)] if it.calls and draw.random() < 0.2 else []
        it.mission("r", upstream=upstream, start_timeout=draw.choice([0.5, 1, 2]), timeout=draw.choice([1, 4]))
    it.connects().named(1)
    for _ in range(draw.randint(2, 4)):
        if draw.random() < 0.5 and it.sent:
            it.says_it(1, -1, draw.choice(["running", "success", "failure"]))
        it.after(draw.choice([0.4, 1, 1.3])) if draw.random() < 0.7 else it.mission("r")
    for history in (it, spoilt(draw, it), spoilt(draw, it)):
        found = []
        for whatever in (False, True):
            in_any_order(monkeypatch, whatever=whatever)
            found.append(told(history, SERVER, readings))
        assert found[0] == found[1]


def test_clocks_that_make_no_difference_explain_nothing_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where they strike before or after everything else, the verdict and what is left of each question are the same."""
    for seed in range(10):
        compared_in_any_order(seed, monkeypatch)


@pytest.mark.slow
def test_clocks_that_make_no_difference_explain_nothing_more_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """So it is on many more."""
    for seed in range(10, 60):
        compared_in_any_order(seed, monkeypatch)


def test_the_full_exploration_is_another_one() -> None:
    """What it is compared with does think of more: twice as many robots, many times as many explanations looked at."""
    spent = {}
    for name, tried in (("focused", SPEC), ("full", FULL.spec)):
        automaton = Automaton(tried, ("connect", "line", "disconnect", "advance"))
        judge = Judge(
            attrs.evolve(SERVER, spec=tried), Head("isaac.server", {}, automaton.successors.driven), automaton
        )
        assert isinstance(judge.belief, Belief)
        costs = []
        for line in fleet(5).waits(5.5).settles.shows(*["FAILED_TIMEDOUT"] * 5).lines:
            judge.feed(line)
            costs.append(automaton.successors.spent)
        spent[name] = max(costs)
    assert spent["full"] > 4 * spent["focused"]


def in_pairs(count: int, *, chain: bool = False, start: float = 5, tick: float = 1) -> History:
    """Missions of one robot, and as many of another that wait for one each; a server that looks once a second."""
    history = History()
    for number in range(1, count + 1):
        history.submit(number, start_timeout=start)
    for number in range(1, count + 1):
        upstream = [number, count + number - 1] if chain and number > 1 else [number]
        history.submit(count + number, robot="q", upstream=upstream, start_timeout=start)
    history = history.robot(1).robot(2, "q").settles
    for number in range(1, count + 2):
        history.waits(tick)
        under_way = [(1, number)] if number <= count else []
        under_way += [(2, count + number - 1)] if number > 1 else []
        for link, mission in under_way:
            history.sends(link, mission)
        for status in ("running", "success"):
            for link, mission in under_way:
                history.reports(link, mission, status)
            history.waits(tick)
    return history.settles


def looked_at(history: History, monkeypatch: pytest.MonkeyPatch) -> int:
    """How many ways are looked at in which times pass, until it is known that a history conforms."""
    count = 0

    def passes(state: Server, time: int) -> Iterator[Any]:
        nonlocal count
        for move in passing.passes(state, time):
            count += 1
            yield move

    effects.advance.cache_clear()
    monkeypatch.setattr(effects, "passes", passes)
    assert history.judged().conforms
    return count


def test_missions_in_pairs_do_not_multiply(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of pairs of missions each may time out or be cancelled at one moment: it is left open which of them do."""
    for options in ({}, {"chain": True}, {"tick": 0.9}, {"start": 4.5}):
        assert looked_at(in_pairs(8, **options), monkeypatch) < 3_000, options


def test_robots_whose_times_are_over_at_one_moment_do_not_multiply(monkeypatch: pytest.MonkeyPatch) -> None:
    """Eight robots with four missions each, whose times to start are over at one moment: one by one, they are few."""
    history, robots = History(), range(1, 9)
    for number in range(32):
        history.submit(number + 1, robot=f"r{number // 4}", start_timeout=5)
    for robot in robots:
        history = history.robot(robot, f"r{robot - 1}")
    history = history.settles
    for turn in range(4):
        history.waits(1)
        for robot in robots:
            history.sends(robot, 4 * robot - 3 + turn)
        for status in ("running", "success"):
            for robot in robots:
                history.reports(robot, 4 * robot - 3 + turn, status)
            history = history.settles.waits(1) if status == "running" else history
    assert looked_at(history.settles, monkeypatch) < 3_000


def alike(count: int, *, shows: bool = True) -> History:
    """So many missions that look alike, and as many of another robot's that wait for one each; all of one are done."""
    history = History()
    for number in range(1, count + 1):
        history.submit(number)
    for number in range(1, count + 1):
        history.submit(count + number, robot="q", upstream=[number])
    history = history.robot(1)
    order = [*range(2, count + 1), 1]
    for turn, number in enumerate(order):
        history.waits(1).sends(1, number)
        history = history.settles
        if turn == 1 and shows:
            history.shows(
                *["STARTED" if one == 3 else "SUCCESS" if one == 2 else "QUEUED" for one in range(1, 2 * count + 1)]
            )
        history.reports(1, number, "running").settles.reports(1, number, "success").lines.append(SETTLED)
    return history.shows(*["SUCCESS"] * count, *["QUEUED"] * count) if shows else history


ANY_ORDER = {"AI-05": "a", "AI-08": "a", "AI-10": "a", "AI-11": "a", "AI-13": "b", "AI-31": "b"}


def widest_in_any_order(history: History) -> int:
    """The most explanations after any line, for a server that sends what is ready in any order."""
    judge = Judge(SERVER, Head("isaac.server", {}, history.drives), readings=ANY_ORDER)
    most = 0
    for line in history.lines:
        assert judge.feed(line), line
        most = max(most, len(judge.belief.node.explanations))
    return most


def test_missions_that_are_alike_do_not_multiply() -> None:
    """Whichever of them goes first, those that go before the others are not told apart until a handle tells."""
    assert widest_in_any_order(alike(8, shows=False)) < 2 * widest_in_any_order(alike(3, shows=False))
    assert widest_in_any_order(alike(8)) < 2 * widest_in_any_order(alike(3))


def test_missions_that_are_alike_are_told_apart_by_their_handles() -> None:
    """A mission that is shown as done is not sent again, whichever it was; the other way round it is a violation."""
    wrong = alike(3)
    wrong.lines[-1]["result"]["missions"]["2"] = "QUEUED"
    assert alike(3).judged(readings=ANY_ORDER).conforms
    assert wrong.judged(readings=ANY_ORDER).violation is not None
    wrong = alike(3, shows=False).shows("SUCCESS", "SUCCESS", "RUNNING", "QUEUED", "QUEUED", "QUEUED")
    assert wrong.judged(readings=ANY_ORDER).violation is not None


def in_whatever_order(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same verdict and readings, where one mission goes for those that are alike and where each is tried."""
    draw = random.Random(seed)
    readings = {**ANY_ORDER, "AI-07": "a", "AI-24.whole": "x", "AI-39.order": "n", "AI-11": draw.choice("aab")}
    it = Live(attrs.evolve(DOCUMENTED, scheduling_period=draw.choice([0.0, 1.0])))
    count = draw.randint(2, 3)
    for _ in range(count):
        it.mission("r")
    for _ in range(draw.randint(0, count)):
        it.mission("s", upstream=[draw.randint(1, count)])
    it.connects().named(1).connects().named(2, "s")
    for _ in range(draw.randint(2, 5)):
        if it.sent and draw.random() < 0.7:
            it.says_it(draw.randint(1, 2), -1, draw.choice(["running", "success", "failure"]))
        it.after(draw.choice([0.4, 1, 1.3]))
        if draw.random() < 0.2:
            it.mission("s", upstream=[draw.randint(1, count)])
    for history in (it, spoilt(draw, it), spoilt(draw, it), spoilt(draw, it)):
        found = []
        for alone in (False, True):
            for cache in (effects.advance, effects.line, silent._silent_in, dispatch._urgent):
                cache.cache_clear()
            with monkeypatch.context() as patch:
                if alone:
                    patch.setattr(queues, "first_of_alike", lambda server, ready: ((one, server) for one in ready))
                found.append(told(history, SERVER, readings))
        assert found[0] == found[1]


def test_one_mission_goes_for_those_that_are_alike(monkeypatch: pytest.MonkeyPatch) -> None:
    """With every order tried, the verdict and what is left of each question are the same."""
    for seed in range(5):
        in_whatever_order(seed, monkeypatch)


@pytest.mark.slow
def test_one_mission_goes_for_those_that_are_alike_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """So it is on many more."""
    for seed in range(5, 40):
        in_whatever_order(seed, monkeypatch)
