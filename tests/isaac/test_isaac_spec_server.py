"""The oracle for ``isaac.server``: who passes, who is caught, who is told apart, and what a history comes to."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import attrs
import pytest
from server_history import SERVER, History
from spec_helpers import breaks, explained, needs_node, node, run_of

from missionfsm.adapters.isaac.subjects import ServerSubject
from missionfsm.isaac.runtime.profile import AS_SHIPPED, DOCUMENTED, Profile
from missionfsm.isaac.server.readings import AMBIGUITIES
from missionfsm.kernel.alphabet import Bounds
from missionfsm.kernel.readings import choose
from missionfsm.oracle.automaton import Automaton
from missionfsm.tools.check.verdict import Verdict
from missionfsm.tools.conform.conform import conform
from missionfsm.tools.conform.plan import Plan
from missionfsm.tools.explore.explore import explore
from missionfsm.tools.mutate.teeth import teeth
from missionfsm.tools.reference.subject import ReferenceSubject

AUTOMATON = Automaton(SERVER.spec, tuple(SERVER.spec.drives))
"""Walked by all tests: what one has worked out the next only looks up."""


def readings(verdict: Verdict, *names: str) -> tuple[str, ...]:
    """The letters that are left of some ambiguities, together."""
    return tuple("".join(verdict.readings[name]) for name in names)


# Recorded histories.


def test_a_downstream_waits_for_success() -> None:
    """A mission is sent when its upstream has succeeded, and not when that only runs."""
    begun = (
        History()
        .submit(1)
        .submit(2, robot="s", upstream=[1])
        .robot(1)
        .robot(2, "s")
        .sends(1, 1)
        .reports(1, 1, "running")
    )
    early = History()
    early.lines, early.calls = list(begun.lines), begun.calls
    assert not early.sends(2, 2).judged().conforms
    assert begun.settles.reports(1, 1, "success").sends(2, 2).settles.shows("SUCCESS", "STARTED").judged().conforms


def test_a_downstream_is_not_sent_after_a_failure() -> None:
    """AI-01 b, any end will do, is a violation, whatever the statuses say."""
    begun = History().submit(1).submit(2, upstream=[1]).robot(1).sends(1, 1).reports(1, 1, "failure")
    assert not begun.sends(1, 2).judged().conforms


def test_statuses_tell_names_apart() -> None:
    """AI-02: the names of what was cancelled and aborted tell the reading; names that no reading has are refused."""
    for aborted, letter in (("ABORTED", "a"), ("FAILED", "b"), ("TIMEOUT", "c")):
        for canceled, other in (("CANCELED", "a"), ("FAILED", "b")):
            begun = History().submit(1).submit(2, upstream=[1]).robot(1).sends(1, 1).waits(6).settles
            judged = begun.shows(aborted, canceled).judged(readings={"AI-05": "a"})
            assert readings(judged, "AI-02.aborted", "AI-02.canceled") == (letter, other)


@pytest.mark.parametrize("status", [None, 1, [], "\u017fTARTED", "QUEUE"])
def test_what_is_no_status_is_a_violation(status: Any) -> None:
    """Whatever stands in the place of a status; a long s is no S, though it is one in upper case."""
    assert not History().submit(1).shows(status).judged().conforms


@pytest.mark.parametrize("handles", [("1", "01"), ("9" * 5000,)])
def test_what_is_no_handle_is_a_violation(handles: tuple[str, ...]) -> None:
    """One handle twice, and one with more digits than a number has, are answers that nothing explains."""
    result = {"missions": dict.fromkeys(handles, "QUEUED") | {handles[-1]: None}}
    history = History().submit(1)
    history.lines += [{"call": 9, "method": "statuses", "params": {}}, {"return": 9, "result": result}]
    assert not history.judged().conforms


@pytest.mark.parametrize(
    ("seconds", "statuses"), [(4.9, "STARTED"), (5, "STARTED FAILED_TIMEDOUT"), (5.1, "FAILED_TIMEDOUT")]
)
def test_a_timeout_has_a_moment(seconds: float, statuses: str) -> None:
    """Before its moment a timeout may not strike, after it it must have; at the very moment either is right."""
    seen = [
        status
        for status in ("STARTED", "FAILED_TIMEDOUT")
        if History()
        .submit(1)
        .robot(1)
        .sends(1, 1)
        .settles.waits(seconds)
        .settles.shows(status)
        .judged(readings={"AI-39": "a", "AI-07": "a", "AI-24.whole": "x"})
        .conforms
    ]
    assert seen == statuses.split()


def test_a_server_that_looks_now_and_then_has_a_second() -> None:
    """AI-39 b: nothing is owed at once, and within a second of time that passes it is, whose passes have begun."""
    late = History().submit(1).robot(1).settles.waits(1).sends(1, 1).settles
    assert readings(late.judged(), "AI-39") == ("b",)

    def waits(seconds: float, begun: History) -> bool:
        return begun.submit(1).settles.waits(seconds).settles.judged().conforms

    assert [waits(seconds, History().robot(1).waits(3)) for seconds in (0.9, 1.1)] == [True, False]
    # When the first pass comes is not said, but that passes are a second apart.
    assert [waits(seconds, History().robot(1)) for seconds in (2.9, 3.1)] == [True, False]
    begun = History().submit(1).robot(1).settles.waits(1.3).settles.waits(1.3).settles
    assert (begun.judged().conforms, begun.waits(1.1).settles.judged().conforms) == (True, False)
    named_later = [waits(seconds, History().waits(3).robot(1)) for seconds in (1.9, 2.1)]
    assert named_later == [True, False]


def test_a_pass_sends_before_or_after_it_takes_up_names() -> None:
    """AI-39.order: to a name that was said just now a mission is sent in the next pass, or in the one after it."""
    soon = History().waits(3).submit(1).robot(1).settles.waits(0.9).sends(1, 1).settles
    late = History().waits(3).submit(1).robot(1).settles.waits(1.1).settles.waits(0.8).sends(1, 1).settles
    assert [readings(one.judged(), "AI-39.order") for one in (soon, late)] == [("n",), ("s",)]


def test_a_pass_that_sends_before_it_notices_a_drop() -> None:
    """AI-39.order s: a mission is sent in vain on a connection that dropped, which may be seen there, and is lost."""
    shipped = {**SERVER.profiles["as-shipped"], "AI-25.header": "s"}

    def dropped(*, seen: bool, order: str, second: str) -> bool:
        begun = History().robot(1).waits(6).submit(1).submit(2).drive("disconnect", connection=1).waits(1.5)
        begun = (begun.sends(1, 1) if seen else begun).settles.shows("FAILED_DISCONNECTED", second)
        return begun.judged(readings={**shipped, "AI-39.order": order}).conforms

    assert [dropped(seen=seen, order="s", second="QUEUED") for seen in (False, True)] == [True, True]
    assert [dropped(seen=seen, order="n", second="QUEUED") for seen in (False, True)] == [False, False]
    assert not dropped(seen=False, order="s", second="FAILED_DISCONNECTED")


def test_what_happens_within_one_stretch_of_time() -> None:
    """An abort frees the robot at its moment, so the next mission's time begins there and not later."""
    history = History().submit(1, start_timeout=2).submit(2, start_timeout=3).robot(1).sends(1, 1).settles
    history = history.waits(4).sends(1, 2).settles.shows("FAILED_TIMEDOUT", "STARTED").waits(1.5).settles
    assert history.shows("FAILED_TIMEDOUT", "FAILED_TIMEDOUT").judged(readings={"AI-05": "a"}).conforms


def test_the_names_of_a_mission_belong_together() -> None:
    """A status about the identifier of one mission cannot end the other."""
    history = History().submit(1).submit(2).robot(1).sends(1, 1).reports(1, 1, "success").sends(1, 2).settles
    assert history.shows("SUCCESS", "STARTED").judged().conforms
    wrong = History().submit(1).submit(2).robot(1).sends(1, 1).reports(1, 1, "success").sends(1, 1)
    assert not wrong.judged().conforms


@pytest.mark.parametrize(
    ("mission", "rule"),
    [
        ({"upstream": [-1]}, "an-upstream-is-no-handle"),
        ({"upstream": [7]}, "an-upstream-is-unknown"),
        ({"timeout": -1}, "a-timeout-is-negative"),
        ({"config": [1]}, "the-mission-is-malformed"),
        ({"robot": ""}, "the-robots-name-is-empty"),
    ],
)
def test_a_defective_submission_is_refused(mission: dict[str, Any], rule: str) -> None:
    """What is wrong with a submission is refused, and taking it is against the rule that says so."""
    assert History().submit(1, refused=True, **mission).submit(1).judged().conforms
    violation = History().submit(1, **mission).judged().violation
    assert violation is not None
    assert [one.id for one in violation.rules] == [f"isaac.server/submit/INVALID_ARGUMENT/{rule}"]


def test_a_sound_submission_is_not_refused() -> None:
    """A refusal needs a reason."""
    assert not History().submit(1, refused=True).judged().conforms


# Live servers.


@pytest.fixture(scope="module")
def shipped() -> dict[str, Verdict]:
    """The verdicts on the server that ships, under both profiles."""
    profiles = {"documented": DOCUMENTED, "as-shipped": AS_SHIPPED}
    return {
        name: conform(SERVER, ServerSubject(profile), plan=Plan(4, 4, 60, 20, 0), seed=1)
        for name, profile in profiles.items()
    }


@pytest.mark.long
def test_both_profiles_conform(shipped: dict[str, Verdict]) -> None:
    """The server that runs under the sockets conforms as documented and as shipped, and exercises almost every rule."""
    assert {name: verdict.conforms for name, verdict in shipped.items()} == {"documented": True, "as-shipped": True}
    assert [rule for rule in shipped["documented"].uncovered if "/submit/" not in rule] == []


@pytest.mark.long
def test_profiles_are_told_apart(shipped: dict[str, Verdict]) -> None:
    """The readings that are reported tell one profile from the other."""
    names = ("AI-10", "AI-12", "AI-14.status", "AI-22.started", "AI-25.header", "AI-39")
    told = {name: readings(verdict, *names) for name, verdict in shipped.items()}
    assert told == {"documented": ("a", "a", "a", "a", "s", "a"), "as-shipped": ("b", "b", "b", "i", "n", "b")}
    assert shipped["documented"].flagged == ()
    assert [one.split()[0] for one in shipped["as-shipped"].flagged] == [
        "AI-03.when=p",
        "AI-14.status=b",
        "AI-22.started=i",
        "AI-24.whole=w",
        "AI-25.header=n",
    ]


def _difference(profile: Profile) -> str:
    return next(
        f"{field.name}-{getattr(profile, field.name)}"
        for field in attrs.fields(Profile)
        if getattr(profile, field.name) != getattr(DOCUMENTED, field.name)
    )


PROFILES = [
    attrs.evolve(DOCUMENTED, **{field.name: letter}, scheduling_period=float(letter in "pq"))
    for field in attrs.fields(Profile)
    for letter in field.metadata.get("letters", "")
    if letter != getattr(DOCUMENTED, field.name) and (field.name, letter) != ("ai_37", "c")
]


@pytest.mark.long
@pytest.mark.parametrize("profile", PROFILES, ids=_difference)
def test_every_profile_of_the_server_is_explained(profile: Profile) -> None:
    """The server under any single other reading conforms; only names in any case are nobody's reading (AI-37 c)."""
    run = run_of("isaac.server", ServerSubject(profile), AUTOMATON)
    assert explained(run, 1, 20), run.ledger.contradiction or (run.found and run.found.judge.violation)


@pytest.mark.long
@pytest.mark.parametrize(
    ("entry", "letter"), [(one.id, letter) for one in AMBIGUITIES for letter in one.readings if letter != one.default]
)
def test_the_reference_follows_every_reading(entry: str, letter: str) -> None:
    """The reference under a single other reading conforms, and that reading is not ruled out."""
    run = run_of("isaac.server", ReferenceSubject(SERVER, {entry: letter}), AUTOMATON)
    assert (explained(run, 1, 20), letter in run.ledger.readings.get(entry, (letter,))) == (True, True)


@needs_node
def test_an_independent_server_conforms() -> None:
    """The Node.js server, written from the page alone, can be explained."""
    with node("isaac.server") as subject:
        assert explained(run_of("isaac.server", subject, AUTOMATON), 5, 25)


COMMON_BREAKS = (
    "downstream-early",
    "any-upstream-suffices",
    "first-upstream-suffices",
    "name-beginning-suffices",
    "failure-overwritten",
    "timeout-restarts",
    "cancel-missing",
    "wrong-robot",
    "unnamed-served",
    "sent-twice",
    "two-at-once",
    "queue-lost-on-disconnect",
    "config-of-first",
    "terminal-revived",
    "start-timeout-halved",
    "timeout-never",
    "payload-integers-bare",
)
"""One of each kind; the others are tried where there is time."""


ALLOWED = ("uuid-ignored",)
"""What a reading allows by now: AI-10 read as d."""


def uncaught(names: Iterable[str]) -> list[str]:
    """Which breaks of the Node.js server the scripts do not find."""
    survived = []
    for one in names:
        with node("isaac.server", "--break", one) as subject:
            if explained(run_of("isaac.server", subject, AUTOMATON), 0, 0):
                survived.append(one)
    return survived


@pytest.mark.long
@needs_node
def test_breaks_of_the_independent_server_are_caught() -> None:
    """What the Node.js server does wrong on purpose no reading explains; the scripts suffice to find it."""
    assert set(COMMON_BREAKS) < set(breaks("isaac.server"))
    assert uncaught(COMMON_BREAKS) == []


@needs_node
@pytest.mark.long
def test_every_other_break_of_the_independent_server_is_caught() -> None:
    """So it is with all the others."""
    others = [one for one in breaks("isaac.server") if one not in (*COMMON_BREAKS, *ALLOWED)]
    assert len(others) > 30
    assert uncaught(others) == []


# The specification itself.

UNDER_OTHER_READINGS = (
    "a-key-is-unknown",
    "a-channel-is-empty",
    "the-configuration-is-null",
    "an-upstream-is-named-twice",  # under AI-20.repeated a; by default such an upstream is waited for once
)
"""Reasons to refuse that the default readings do not know."""


@pytest.mark.long
def test_every_state_of_two_missions_and_one_connection() -> None:
    """Under the default readings every status is reached, every invariant holds, and every reason to refuse matters."""
    found = explore(SERVER, Bounds(2), assumed=choose(SERVER.spec.ambiguities))
    assert (found.states, found.holds, found.constant) == (178, True, ())
    others = {f"isaac.server/submit/INVALID_ARGUMENT/{rule}" for rule in UNDER_OTHER_READINGS}
    assert set(found.idle) == others


@pytest.mark.slow
@pytest.mark.parametrize("topic", ["dispatch", "dependencies", "connection", "status", "timeout", "line"])
def test_every_broken_promise_is_noticed(topic: str) -> None:
    """Whichever promise about lines, time and robots the reference breaks, in whichever way, the oracle notices."""
    found = teeth(SERVER, only=f"isaac.server/{topic}/")
    assert len(found.results) > 1
    assert (found.survived, found.allowed, found.untested) == ((), (), ())


WHILE_IT_RUNS = {"AI-29": "d"}


def test_a_connection_that_the_server_ends() -> None:
    """It may end one that says no name, or sends rubbish, under readings that say so, and no other."""
    nameless = History().drive("connect", connection=1).waits(30).closes(1).settles.judged(readings=WHILE_IT_RUNS)
    assert (nameless.conforms, nameless.readings["AI-18.unnamed"]) == (True, ("d",))
    rubbish = (
        History().robot(1).drive("line", connection=1, line="rubbish").closes(1).settles.judged(readings=WHILE_IT_RUNS)
    )
    assert (rubbish.conforms, rubbish.readings["AI-26"]) == (True, ("f",))
    blank = History().robot(1).drive("line", connection=1, line="").closes(1).settles.judged(readings=WHILE_IT_RUNS)
    assert (blank.conforms, blank.readings["AI-26.blank"]) == (True, ("f",))
    served = History().robot(1).waits(30).closes(1).judged(readings=WHILE_IT_RUNS)
    assert served.violation is not None
    assert [one.id for one in served.violation.rules] == ["isaac.server/connection/what-means-nothing-has-no-effect"]
    assert not History().drive("connect", connection=1).closes(2).judged(readings=WHILE_IT_RUNS).conforms


def test_a_connection_ends_once() -> None:
    """What has ended does not end again, whether others have ended in between or not."""
    rubbish = History().robot(1).robot(2, "s").drive("line", connection=1, line="rubbish").closes(1).settles
    assert rubbish.judged().conforms
    again = rubbish.closes(1).judged()
    assert again.violation is not None
    assert [one.id for one in again.violation.rules] == ["isaac.server/dispatch/only-its-robot-gets-a-mission"]
    both = History().robot(1).robot(2, "s").drive("line", connection=1, line="rubbish").closes(1)
    both = both.drive("line", connection=2, line="rubbish").closes(2).settles
    assert (both.judged().conforms, both.closes(1).judged().conforms) == (True, False)


def test_a_status_that_is_taken_for_another_mission() -> None:
    """AI-10 d: a server that does not look at which mission a status names departs from the text."""
    begun = History().submit(1, start_timeout=2).submit(2).robot(1).sends(1, 1).waits(3).sends(1, 2).settles
    late = begun.reports(1, 1, "failure").settles.shows("FAILED_TIMEDOUT", "FAILED").judged()
    assert late.conforms
    assert [line for line in late.flagged if line.startswith("AI-10=d")] != []
