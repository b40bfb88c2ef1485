"""The mission server as a state: missions in the order of submission, connections in the order of arrival.

Readings are decided when they matter, and a state remembers which are left (`Server.left`), so that nothing is decided
twice. Times are whole microseconds that are left, as an interval: a clock strikes at the earliest when `lo` is over and
at the latest when `hi` is; they differ only where the server is known to look about once a second (AI-39 b) or where
nothing says when (AI-31 a).
"""

from __future__ import annotations

import enum
from collections.abc import Hashable
from typing import Any

from attrs import evolve

from missionfsm.isaac.server.readings import AI_39_ABORTED, AI_39_FAILED, AI_39_SUCCEEDED
from missionfsm.isaac.shared.line import MICROSECONDS
from missionfsm.kernel.chart import Chart
from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.step import Emission
from missionfsm.kernel.terms import Refs
from missionfsm.kernel.values import value

SYSTEM_NAME = "isaac.server"
PASS_PERIOD = MICROSECONDS
"""How long a server that looks now and then may take to look, in microseconds (AI-39 b)."""

DAY = 86_400
"""Whole seconds are counted within a day where they are (AI-24.whole w)."""

SILENCE = 10 * MICROSECONDS
"""How long RUNNING has to be missing at least before that is a loss (AI-31 a). The tester's choice."""


class Status(enum.Enum):
    """Where a mission stands. The names are those of the shipped server."""

    QUEUED = "QUEUED"
    STARTED = "STARTED"
    RUNNING = "RUNNING"
    SUCCESS = "SUCCESS"
    FAILED = "FAILED"
    LOST = "FAILED_DISCONNECTED"
    ABORTED = "FAILED_TIMEDOUT"
    CANCELED = "FAILED_UPSTREAM"


UNDER_WAY = (Status.STARTED, Status.RUNNING)
FAILURES = (Status.FAILED, Status.LOST, Status.ABORTED, Status.CANCELED)

LIFECYCLE: Chart[Status] = Chart(
    "mission at the server",
    Status.QUEUED,
    (
        ("send", Status.QUEUED, Status.STARTED),
        ("report running", Status.STARTED, Status.RUNNING),
        ("report success", Status.STARTED, Status.SUCCESS),
        ("report success", Status.RUNNING, Status.SUCCESS),
        ("report failure", Status.STARTED, Status.FAILED),
        ("report failure", Status.RUNNING, Status.FAILED),
        ("time out", Status.QUEUED, Status.ABORTED),
        ("time out", Status.STARTED, Status.ABORTED),
        ("time out", Status.RUNNING, Status.ABORTED),
        ("cancel", Status.QUEUED, Status.CANCELED),
        ("lose", Status.STARTED, Status.LOST),
        ("lose", Status.RUNNING, Status.LOST),
        ("send again later", Status.STARTED, Status.QUEUED),
        ("send again later", Status.RUNNING, Status.QUEUED),
    ),
    {
        "time out": "while QUEUED only where AI-05 is not read as a, or AI-06 as c, or start_timeout is 0",
        "lose": "AI-15 c",
        "send again later": "AI-15 b",
    },
)
"""The lifecycle of one mission; being submitted is its start, and AI-09 b and c are no moves but corrections."""

ENDED = frozenset(LIFECYCLE.final)
SENT, HEARD = "sent", "heard"
"""What a robot has said of a mission that was sent: nothing, or something."""
RESTS = {
    Status.SUCCESS: AI_39_SUCCEEDED,
    Status.FAILED: AI_39_FAILED,
    Status.LOST: AI_39_FAILED,
    Status.ABORTED: AI_39_ABORTED,
}
"""For each end of a mission that was under way: whether its robot may rest then before it is sent another."""
WAITS = "send acknowledged"
START_COUNTS_FROM = {"send": "a", "submit": "b", "ready": "c", "connect": "d"}
"""What the time to start counts from (`Clock.since`), with the letter of AI-05."""
START, RUN, SILENT, DROP, DOOM = "start", "run", "silent", "drop", "doom"


@value(cache_hash=True)
class Clock:
    """A clock of a mission that runs.

    Attributes:
        kind: `START`, `RUN`, `SILENT`, or what a scheduling pass has yet to notice: `DROP` (a connection that dropped),
            `DOOM` (an upstream that failed).
        since: from what it counts: ``submit``, ``ready``, ``connect``, ``send``, ``status``, ``drop`` or ``doom``; from
            ``send acknowledged`` it counts as from ``send``, and strikes once there is an acknowledgement (AI-06 d).
        lo: microseconds until it may strike; below 0 where it may have struck so long ago and nothing was seen of it.
        hi: microseconds until it must have struck; None: it never has to.
        whole: whether it counts whole seconds (AI-24.whole w).
    """

    kind: str
    since: str
    lo: int
    hi: int | None
    whole: bool = False


@value(cache_hash=True)
class Mission:
    """A submitted mission.

    Attributes:
        status_channel: None where the submission names none.
        config: canonical JSON.
        start, run: the two timeouts in microseconds; None is infinite.
        waits: the upstreams that have not ended, by their index.
        doomed: how upstreams ended that did not succeed.
        fated: the upstreams that are as good as failed, however they end (AI-22.started j).
        lingers: it was aborted and its robot has not said since how it ended (AI-08 d, e): `SENT` where it has never
            said anything of it, else `HEARD`; empty where it does not linger.
        sent_on: the slot of the connection that it was sent on; None before, and where that is gone.
        sent: whether it was sent.
        was: what it was before its robot reported something that a pass may have yet to look at (AI-39.reports b), for
            how many microseconds that may be, and whether no time has passed; None where there is no such thing.
        depends: whether it has upstreams at all.
        at_once: it was ready when the connection of its robot was named, and has not been sent since (AI-11 d).
        new: it may be that no scheduling pass has looked at it (AI-04.new b): whether no time has passed since its
            submission; None once one has, or where that makes no difference.
        rests: microseconds for which its robot need not be sent another, since it has just ended (`RESTS`).
        overdue: whether it has ended for certain while it was queued, and how is left open: it timed out, or was
            cancelled before. Its clocks say when it may have timed out. Nothing but its status depends on that.
    """

    robot: str | None
    channel: str
    status_channel: str | None
    config: str
    start: int | None
    run: int | None
    waits: tuple[int, ...] = ()
    doomed: tuple[Status, ...] = ()
    status: Status = Status.QUEUED
    clocks: tuple[Clock, ...] = ()
    sent_on: int | None = None
    sent: bool = False
    depends: bool = False
    fated: tuple[int, ...] = ()
    lingers: str = ""
    overdue: bool = False
    was: tuple[Status, int, bool] | None = None
    rests: int = 0
    new: bool | None = None
    at_once: bool = False

    @property
    def ticking(self) -> tuple[Clock, ...]:
        """The clocks that may strike as it stands."""
        if self.status is not Status.STARTED:
            return self.clocks
        return tuple(one for one in self.clocks if one.since != WAITS)

    @property
    def queued(self) -> bool:
        """Whether it may still be sent."""
        return self.status is Status.QUEUED and not self.overdue

    @property
    def ready(self) -> bool:
        """Whether nothing but its robot keeps it from being sent."""
        return self.queued and not self.waits and not self.doomed


NOBODYS = -1
"""The index of no mission: that of an identifier which nobody has."""


@value(cache_hash=True)
class Report:
    """A status message: what it says, where, and which missions its identifiers name.

    `named` and `header` are indices of missions; `NOBODYS` for an identifier that is nobody's; None for none.
    """

    status: str
    channel: str
    named: int | None
    header: int | None


@value(cache_hash=True)
class Link:
    """A connection that is open.

    Attributes:
        slot: tells it from the other open ones.
        name: the robot's name that it said; None before it said one.
        serves: whether the missions of that robot go to it.
        early: statuses that came before the name and are kept (AI-18.early b).
        over: the slot of the connection that it took over from, as long as no pass need have noticed that (AI-39 b).
        fresh: microseconds until a pass must have noticed it.
        held: microseconds until the pass that sends to a name may be the one after that which takes it up, and until
            it is (AI-39.order s).
        pass_since: how many microseconds ago a scheduling pass may have come that sent or cancelled something here, and
            of which nothing was seen yet (AI-39 b); None: none may have; 0: one that has sent nothing.
        closing: whether the server has closed it, which has yet to be seen (AI-08 c); it is nobody's then.
    """

    slot: int
    name: str | None = None
    serves: bool = False
    early: tuple[Report, ...] = ()
    over: int | None = None
    fresh: int = 0
    held: tuple[int, int] = (0, 0)
    pass_since: int | None = None
    closing: bool = False


Left = tuple[tuple[str, str], ...]


@value(cache_hash=True)
class World:
    """What a server is given: the channel for names, and by how much times may be off, in microseconds.

    Attributes:
        unsteady: whether connections may drop with nobody saying so; no adapter says that.
    """

    name_channel: str = "name"
    tolerance: int = 0
    unsteady: bool = False


@value(cache_hash=True)
class Server:
    """A mission server.

    Attributes:
        left: for the questions that mattered: the letters that are left, by id.
        tolerance: by how much times may be off in either direction, in microseconds.
        slow: microseconds until the first scheduling pass is no more than one period away (AI-39 b).
        gone: connections that dropped, of which no pass need have noticed it (AI-39.order s): what a pass sends on one
            may be seen. Slots below 0 are of those that the server ended itself.
        unsteady: whether connections may drop with nobody saying so.
        over: whether it has ended: nothing happens any more but that its connections are seen to end.
        alike: groups of missions, each with those that wait for it, of which nobody knows which of them is which
            (`missionfsm.isaac.server.alike`).
    """

    name_channel: str = "name"
    missions: tuple[Mission, ...] = ()
    links: tuple[Link, ...] = ()
    left: Left = ()
    tolerance: int = 0
    slow: int = 0
    gone: tuple[Link, ...] = ()
    unsteady: bool = False
    over: bool = False
    alike: tuple[tuple[tuple[int, ...], ...], ...] = ()

    def letters(self, question: Ambiguity) -> str:
        """The readings of a question that are left."""
        for name, letters in self.left:
            if name == question.id:
                return letters
        return "".join(question.readings)

    @property
    def ends(self) -> tuple[Link, ...]:
        """The connections on which something may be seen: those that are open, and those that dropped just now."""
        return (*self.links, *(one for one in self.gone if one.slot >= 0)) if self.gone else self.links

    def link_at(self, slot: int) -> Link | None:
        """The connection in a slot."""
        return next((one for one in self.links if one.slot == slot), None)

    def rests(self, link: Link) -> tuple[Ambiguity, ...]:
        """The questions whether the robot of a connection rests now, since missions of it have just ended."""
        own = (one for one in self.missions if one.rests and one.robot == link.name)
        return tuple(RESTS[one.status] for one in own if one.status in RESTS)

    def lets_rest(self, link: Link) -> bool:
        """Whether nothing is sent on a connection yet, since a mission of its robot has just ended."""
        return any(self.letters(question) == "b" for question in self.rests(link))

    def link_of_topic(self, at: Hashable) -> Link | None:
        """The connection that a topic is about."""
        return next((one for one in self.links if topic(one.slot) == at), None)

    def next_pass(self, since: int) -> int:
        """Until when a scheduling pass has come after a moment, both in microseconds, where times are exact."""
        return max(since, self.slow) + PASS_PERIOD

    def serving(self, robot: str | None) -> Link | None:
        """The connection that the missions of a robot go to."""
        return next((one for one in self.links if one.serves and one.name == robot), None)


@value(cache_hash=True)
class Sends:
    """A MissionProto that is owed: its channel and its configuration."""

    channel: str
    config: str


@value(cache_hash=True)
class Closes:
    """That a connection ends is owed."""


@value(cache_hash=True)
class Move:
    """Where something leads: the state, what was sent on the way, and why.

    `at` is when it happens, as an interval of microseconds since what caused it; clocks that start count from there.
    """

    state: Server
    sent: tuple[tuple[int, int, Sends | Closes], ...] = ()
    rules: tuple[str, ...] = ()
    at: tuple[int, int] = (0, 0)

    def to(self, state: Server, *rules: str) -> Move:
        """The same with another state."""
        return Move(state, self.sent, (*self.rules, *rules), self.at)

    def with_mission(self, index: int, **changes: Any) -> Move:  # noqa: ANN401 - attributes of a mission
        """The same with a mission changed."""
        server = self.state
        missions = list(server.missions)
        missions[index] = evolve(missions[index], **changes)
        after = Server(
            server.name_channel,
            tuple(missions),
            server.links,
            server.left,
            server.tolerance,
            server.slow,
            server.gone,
            server.unsteady,
            server.over,
            server.alike,
        )
        return Move(after, self.sent, self.rules, self.at)

    def with_link(self, slot: int, **changes: Any) -> Move:  # noqa: ANN401 - attributes of a connection
        """The same with a connection changed."""
        links = tuple(evolve(one, **changes) if one.slot == slot else one for one in self.state.links)
        return evolve(self, state=evolve(self.state, links=links))

    def emit(self, slot: int, index: int, view: Sends | Closes) -> Move:
        """The same with something sent to a connection, about a mission or, below 0, about none."""
        return evolve(self, sent=(*self.sent, (slot, index, view)))


# The names of a state: for each mission its handle and its identifier, and after those the connections, in order.


def handle_ref(index: int) -> int:
    """The position of a mission's handle among the names."""
    return 2 * index


def uuid_ref(index: int) -> int:
    """The position of a mission's identifier among the names."""
    return 2 * index + 1


def first_link_ref(server: Server) -> int:
    """The position of the first connection among the names; the missions' names are those before it."""
    return 2 * len(server.missions)


def mission_of_handle(server: Server, ref: int | None) -> int | None:
    """The index of the mission whose handle stands at a position; None where no handle does."""
    return None if ref is None or ref >= first_link_ref(server) or ref % 2 else ref // 2


def mission_of_uuid(server: Server, ref: int | None) -> int:
    """The index of the mission whose identifier stands at a position; `NOBODYS` where no identifier does."""
    return ref // 2 if ref is not None and ref < first_link_ref(server) and ref % 2 else NOBODYS


def missions_of(server: Server, refs: Refs) -> set[int]:
    """The indices of the missions that any of some names belong to."""
    return {ref // 2 for ref in refs if ref is not None and 0 <= ref < first_link_ref(server)}


def topic(slot: int) -> tuple[str, int]:
    """The topic of the connection in a slot."""
    return ("link", slot)


def emissions(move: Move) -> tuple[Emission, ...]:
    """What a move owes to the connections; each gets its lines in order. What is sent in vain may be seen soon."""
    gone = {one.slot for one in move.state.gone}
    return tuple(
        Emission(topic(slot), view, (uuid_ref(index),) if index >= 0 else (), certain=True, fleeting=slot in gone)
        for slot, index, view in sorted(move.sent, key=lambda one: one[0])
    )
