"""The mission file: checked whole, every problem with its place."""

import json
import math
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from isaac_helpers import uuid

from missionfsm.isaac.runtime.graph import cycles, topological_order
from missionfsm.isaac.runtime.missionfile import FileProblem, MissionEntry, MissionFile, parse, submit_all
from missionfsm.isaac.runtime.missions import Refused
from missionfsm.isaac.runtime.profile import AS_SHIPPED, DOCUMENTED, Profile
from missionfsm.isaac.runtime.server import MissionServerCore


def problems(text: str | bytes, profile: Profile = DOCUMENTED) -> list[str]:
    found = parse(text, profile)
    assert not isinstance(found, MissionFile), found
    return [str(problem) for problem in found]


def of(*missions: object) -> str:
    return json.dumps({"missions": missions})


def test_isaac_file_defaults_are_the_documented_ones() -> None:
    """An entry that names only its robot has every documented default."""
    assert parse(of({"robot": "r"})) == MissionFile(
        (MissionEntry("r", "mission", None, "{}", start_timeout=5.0, timeout=math.inf, upstream=()),)
    )


def test_isaac_file_every_key_is_read() -> None:
    """All documented keys are taken, unknown ones ignored with a warning at both levels, whatever they hold."""
    text = """{"more": [NaN], "missions": [{"robot": "a"}, {"robot": "b", "channel": "c", "status_channel": "s",
        "config": {"n": {"k": {"p": [1, 2.5, "ü"]}}}, "start_timeout": 3, "timeout": Infinity, "upstream": [0, 0],
        "colour": {"x": 1e999}}]}"""
    assert parse(text) == MissionFile(
        (
            MissionEntry("a"),
            MissionEntry("b", "c", "s", '{"n":{"k":{"p":[1,2.5,"\\u00fc"]}}}', 3.0, math.inf, (0,)),
        ),
        (
            FileProblem("more", "is unknown and ignored; known are missions"),
            FileProblem(
                "missions[1].colour",
                "is unknown and ignored; known are "
                "robot, channel, status_channel, config, start_timeout, timeout, upstream",
            ),
        ),
    )


def test_isaac_file_an_unknown_key_is_said_with_the_nearest_known_one() -> None:
    """A slip of the pen is no silence: the warning has the place and what was probably meant."""
    file = parse(of({"robot": "r", "start-timeout": 3, "upstreams": []}))
    assert isinstance(file, MissionFile)
    assert [str(warning) for warning in file.warnings] == [
        'missions[0]["start-timeout"]: is unknown and ignored; did you mean start_timeout?',
        "missions[0].upstreams: is unknown and ignored; did you mean upstream?",
    ]


def test_isaac_file_a_configuration_that_no_line_holds_is_said_with_its_size() -> None:
    """What would be longer than a line may be is refused before anything is sent; one byte less is taken."""
    text = of({"robot": "r", "config": {"n": {"c": {"p": "x" * 1000}}}})
    found = parse(text, line_limit=1300)
    assert [str(one) for one in found if isinstance(found, tuple)] == [
        "missions[0].config: makes a line of 1,336 bytes; the limit is 1,300"
    ]
    assert isinstance(parse(text, line_limit=1336), MissionFile)
    assert isinstance(parse(text, line_limit=1335), tuple)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ["line 1, column 1: not JSON: expecting value"]),
        ('{"missions":\n [1,]}', ["line 2, column 5: not JSON: expecting value"]),
        (b"\xff", ["byte 0: not UTF-8"]),
        ("[]", ['file: wanted an object with the key "missions", found a list']),
        ("{}", ["missions: is missing"]),
        ('{"missions": null}', ["missions: wanted a list, found null"]),
        ('{"missions": [], "missions": []}', ["missions: is given more than once"]),
        (of(1), ["missions[0]: wanted an object, found 1"]),
        (of({}), ["missions[0].robot: is missing: no robot to submit the mission to"]),
        (of({"robot": ""}), ['missions[0].robot: "" is no name that a robot can have']),
        (
            of({"robot": "r"}, {"robot": "r"}, {"robot": "r", "upstream": [-1, 3, 2, True, "0", 1.0]}),
            [
                "missions[2].upstream[0]: there is no mission -1 in a file of 3 missions, counted from 0",
                "missions[2].upstream[1]: there is no mission 3 in a file of 3 missions, counted from 0",
                "missions[2].upstream[2]: the mission waits for itself",
                "missions[2].upstream[3]: wanted the index of a mission, found true",
                'missions[2].upstream[4]: wanted the index of a mission, found "0"',
                "missions[2].upstream[5]: wanted the index of a mission, found 1.0",
            ],
        ),
        (
            '{"missions": [{"robot": 1, "robot": 2, "channel": null, "status_channel": 3, "config": [], '
            '"start_timeout": -1, "timeout": "inf", "upstream": 0}]}',
            [
                "missions[0].robot: is given more than once",
                "missions[0].robot: wanted a string, found 2",
                "missions[0].channel: wanted a string, found null",
                "missions[0].status_channel: wanted a string, found 3",
                "missions[0].config: wanted an object, found a list",
                "missions[0].start_timeout: wanted 0 seconds or more, found -1",
                'missions[0].timeout: wanted a number of seconds, found "inf"',
                "missions[0].upstream: wanted a list of indices, found 0",
            ],
        ),
        (
            '{"missions": [{"robot": "r", "start_timeout": NaN, "timeout": 1' + "0" * 400 + "}]}",
            [
                "missions[0].start_timeout: wanted 0 seconds or more, found NaN",
                "missions[0].timeout: is too large; leave the timeout out for none",
            ],
        ),
        (
            '{"missions": [{"robot": "r", "config": {"a b": {"x": -Infinity, "y": 1, "y": 2, "z": "\\udc00"}}}]}',
            [
                'missions[0].config["a b"].y: is given more than once',
                'missions[0].config["a b"].x: is not a finite number',
                'missions[0].config["a b"].z: holds half of a surrogate pair, which is no Unicode text',
            ],
        ),
        (
            of({"robot": "r", "upstream": [1]}, {"robot": "r", "upstream": [2]}, {"robot": "r", "upstream": [0]}),
            [
                "missions[0].upstream: each waits for the next, in a cycle: "
                "missions[0] -> missions[1] -> missions[2] -> missions[0]"
            ],
        ),
    ],
    ids=range(15),
)
def test_isaac_file_every_problem_is_reported_with_its_place(text: str | bytes, expected: list[str]) -> None:
    """All that is wrong is said at once, each with its path."""
    assert problems(text) == expected


def test_isaac_file_forward_references_are_a_reading() -> None:
    """An upstream further down is legal as documented, and refused as shipped."""
    text = of({"robot": "r", "upstream": [1]}, {"robot": "r"})
    assert parse(text) == MissionFile((MissionEntry("r", upstream=(1,)), MissionEntry("r")))
    assert problems(text, AS_SHIPPED) == [
        "missions[0].upstream[0]: mission 1 stands further down, which this server does not take"
    ]


def test_isaac_file_a_mission_for_nobody_is_a_reading() -> None:
    """Without a robot a mission is refused, or taken and never sent."""
    assert parse(of({}), DOCUMENTED.choosing("AI-19", "a")) == MissionFile((MissionEntry(None),))


def test_isaac_file_a_blank_name_is_one_unless_names_are_trimmed() -> None:
    """Taken exactly, a blank is a name; trimmed, it is none."""
    assert parse(of({"robot": " "})) == MissionFile((MissionEntry(" "),))
    assert problems(of({"robot": " "}), DOCUMENTED.choosing("AI-37", "b")) == [
        'missions[0].robot: " " is no name that a robot can have'
    ]


def test_isaac_file_a_byte_order_mark_is_no_matter() -> None:
    """Editors that put one there are forgiven."""
    assert parse(b"\xef\xbb\xbf" + of().encode()) == MissionFile(())


def test_isaac_file_long_chains_and_large_files_are_no_matter() -> None:
    """A chain of 20,000 missions backwards through the file is read, and its cycle named when it has one."""
    count = 20_000
    chain = [{"robot": "r", "upstream": [index + 1]} for index in range(count - 1)]
    found = parse(of(*chain, {"robot": "r"}))
    assert isinstance(found, MissionFile)
    ring = problems(of(*chain, {"robot": "r", "upstream": [0]}))
    assert len(ring) == 1
    assert ring[0].startswith("missions[0].upstream: each waits for the next, in a cycle: missions[0] -> missions[1]")


@st.composite
def graphs(draw: st.DrawFn) -> list[list[int]]:
    size = draw(st.integers(0, 8))
    return [draw(st.lists(st.integers(0, size - 1), max_size=3)) for _ in range(size)]


@given(graphs())
def test_isaac_graphs_without_cycles_have_an_order_and_others_a_cycle(upstream: list[list[int]]) -> None:
    """Either all are ordered with upstreams first, or a real cycle is named for every knot."""
    order = topological_order(upstream)
    found = cycles(upstream)
    assert (len(order) == len(upstream)) == (not found)
    for position, index in enumerate(order):
        assert set(upstream[index]) <= set(order[:position])
    for cycle in found:
        assert all(other in upstream[one] for one, other in zip(cycle, (*cycle[1:], cycle[0]), strict=True))
        assert cycle[0] == min(cycle)
    assert len({index for cycle in found for index in cycle}) == sum(len(cycle) for cycle in found)


def test_isaac_file_is_submitted_in_its_order() -> None:
    """Missions are queued in the order of the file, though upstreams further down are created first."""
    file = parse(of({"robot": "r", "upstream": [2]}, {"robot": "r"}, {"robot": "r"}))
    assert isinstance(file, MissionFile)
    core = MissionServerCore()
    effects = submit_all(core, file, [uuid(index) for index in range(3)], 0.0)
    assert not isinstance(effects, Refused)
    assert [effect.mission.lower for effect in effects] == [0, 1, 2]  # type: ignore[union-attr]


@pytest.mark.parametrize("letter", "abc")
def test_isaac_file_is_taken_whole_under_every_reading_of_unsubmitted_upstreams(letter: str) -> None:
    """Whatever a server does with upstreams that were not submitted, a whole file is no problem."""
    random_numbers = random.Random(1)
    entries = []
    for index in range(60):
        later = random_numbers.sample(range(index + 1, 60), k=min(2, 59 - index))
        entries.append({"robot": "r", "upstream": later})
    file = parse(of(*entries))
    assert isinstance(file, MissionFile)
    core = MissionServerCore(DOCUMENTED.choosing("AI-22", letter))
    assert not isinstance(submit_all(core, file, [uuid(index) for index in range(60)], 0.0), Refused)
    assert core.unfinished == 60
