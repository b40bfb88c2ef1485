"""Judges a history line by line: the verdict, and what is wrong with the first event that nothing explains."""

from __future__ import annotations

from collections import Counter, defaultdict, deque
from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import Any

from attrs import evolve

from missionfsm.kernel.codec import JSON, UnreadableError
from missionfsm.kernel.history import Called, Event, Name, Received, Returned, Settled
from missionfsm.kernel.rules import OK
from missionfsm.kernel.system import System
from missionfsm.kernel.terms import Request
from missionfsm.oracle.automaton import Automaton, Tally
from missionfsm.oracle.belief import Belief
from missionfsm.oracle.parted import Parted
from missionfsm.oracle.successors import EVENT_BUDGET, ExhaustedError
from missionfsm.oracle.transcript import Head, Transcript
from missionfsm.tools.check.basis import Flagged
from missionfsm.tools.check.beginning import Beginning
from missionfsm.tools.check.candidates import AnsweredCall, Circumstances
from missionfsm.tools.check.elapsing import elapsing
from missionfsm.tools.check.eliminations import Eliminations, by_ambiguity
from missionfsm.tools.check.explain import violation
from missionfsm.tools.check.held import Held, HeldEvent, Presumed
from missionfsm.tools.check.phrases import event_words
from missionfsm.tools.check.quiet import Quiet
from missionfsm.tools.check.scope import assumed, flagged, held_to_the_text, unchecked, uncovered, untested
from missionfsm.tools.check.verdict import Outcome, Verdict, Violation

MAX_LINES = 200
"""How many of the last lines before a violation a verdict shows."""

PATIENCE = 300
"""How many explanations an event of a recorded history may cost before it waits for the events after it."""

RECENT = 6
"""How many of the last answered calls are remembered, for the words of a violation."""

_COUNTED = frozenset((Returned, Settled, Called))


class Judge:
    """Judges one conversation as its lines come.

    Args:
        system: the system.
        head: the first line of the history.
        automaton: the belief automaton to walk; None makes one for this judge. Judges that share one are faster.
        readings: the readings to assume, if the judge makes its automaton.
        no_flagged: whether nothing may depart from the letter of the text.
        fingerprint, lost: see `missionfsm.oracle.transcript.Transcript`.
        keep: how many lines are kept to be shown.
        apart: whether exercised rules are counted apart from those of other judges that share the automaton.
        waits: whether an event that costs too much to explain at once may wait for the events after it. Whoever drives
            an implementation cannot wait.
        settled_after: how many seconds (of `at`) after its cause a message is late; None: never.
        past: the names of what was there before, if a reset does not make a fresh instance; None if it does.
        early: how many answers the lines have to calls that were sent before them; None where nobody knows.

    Attributes:
        right: whether everything so far is explained, within the budget.
        exhausted: whether the budget ran out.
        held_back: whether events have waited for those after them. Readings that such events rule out may still be
            reported as possible.
        place: where the line stands that nothing explains, if it was not the last line.
        read, events, succeeded: how many lines and events were taken into account, and how many answers were OK.
        recent: the last calls that were answered.
        answers: for each operation, how often it was answered with each status.
    """

    def __init__(  # noqa: PLR0913 - all but the first two have a default
        self,
        system: System,
        head: Head,
        automaton: Automaton | None = None,
        *,
        readings: Mapping[str, str] | None = None,
        no_flagged: bool = False,
        fingerprint: Callable[[JSON], Hashable] = repr,
        lost: frozenset[int] = frozenset(),
        keep: int = MAX_LINES,
        apart: bool = False,
        waits: bool = True,
        settled_after: float | None = None,
        past: Iterable[Name] | None = None,
        early: int | None = None,
    ) -> None:
        self.system = system
        self.head = head
        unknown = [drive for drive in head.drives if drive not in system.spec.drives]
        if unknown:
            message = f"drives: {system.name} has no {unknown[0]!r}; it has {', '.join(system.spec.drives)}"
            raise UnreadableError(message)
        decided = assumed(system.spec, readings, no_flagged=no_flagged)
        self.automaton = automaton or Automaton(system.spec, head.drives, decided, PATIENCE if waits else EVENT_BUDGET)
        self.automaton.successors.live = not waits
        self._no_flagged = no_flagged
        tally: Tally = defaultdict(int) if apart else self.automaton.tally
        world = system.codec.read_world(head.world)
        self.belief: Belief | Parted = Belief(self.automaton, world, tally, past)
        parting = self.automaton.spec.parting
        if waits and parting and len(parting.parts(world, frozenset(head.drives))) > 1:
            self.belief = Parted(self.automaton.spec, world, head.drives, self.automaton.assumed, EVENT_BUDGET)
        self._standing = self.belief
        self.eliminations = Eliminations(self.belief)
        self._seen = self.eliminations.seen
        self.transcript = Transcript(system.codec, fingerprint, lost, anywhere=head.anywhere)
        self.quiet = None if settled_after is None else Quiet(settled_after)
        undriven = (one for name, one in system.spec.drives.items() if name not in self.automaton.successors.driven)
        self._elapsing = elapsing(tuple(undriven), settled_after)
        self._beginning = Beginning(early) if head.anywhere else None
        self.lines: deque[JSON] = deque(maxlen=keep)
        self.read = 0
        self.events = 0
        self.succeeded = 0
        self.answers: dict[str, Counter[str]] = {name: Counter() for name in system.spec.operations}
        self.right = True
        self.exhausted = False
        self.recent: deque[AnsweredCall] = deque(maxlen=RECENT)
        self._about: dict[Name, tuple[Name, ...]] = {}
        self._lost_a_call = self._unanswered = self._speaks_on = False
        self._unexplained: Event | None = None
        self._undecided: Event | None = None
        self._strictly = False
        self._violation: Violation | None = None
        self._asked: Any = None
        self._patient = waits
        self._held: Held | None = None
        self.held_back = False
        self._presumed: Presumed | None = None
        self.place: int | None = None

    def feed(self, line: JSON, place: int = 0) -> bool:
        """Take a line into account. False once the verdict is known, so that further lines do not matter.

        Args:
            place: where the line stands, kept in `place` if nothing explains it.

        Raises:
            UnreadableError: the line is not of the format.
        """
        open_calls = len(self.transcript.pending) > 0  # before the line is read: things may settle before it
        events = self.transcript.read(line)
        if self.quiet is not None:
            events = self.quiet.settling(line.get("at"), events)
        if self._elapsing is not None:
            self._elapsing.at = line.get("at")
        if self.right:
            self.lines.append(line)
        return self.take(events, place, open_calls=open_calls, at=line.get("at"))

    @property
    def awaits(self) -> bool:
        """Whether a message has yet to come, as far as can be told."""
        try:
            return self.right and self.belief.awaits
        except ExhaustedError:
            return False

    def take(
        self, events: tuple[Event, ...], place: int = 0, *, open_calls: bool | None = None, at: float | None = None
    ) -> bool:
        """Take the events of a line into account that was read elsewhere; see `feed`. The line will not be shown.

        Args:
            place: where the line stands, kept in `place` if nothing explains it.
            open_calls: whether calls had no answer before the line; None: as after it.
            at: when the line was, in seconds; None if it does not say.
        """
        if open_calls is None:
            open_calls = len(self.transcript.pending) > 0
        if not self.right:
            return False
        self.read += 1
        if self.transcript.silenced or self._elapsing is not None:
            events = self._with_what_passes(events)
        if self._held is not None:
            return self._hold(events, place, open_calls=open_calls)
        belief = self.belief
        for position, event in enumerate(events):
            self.events += 1
            before = belief.node
            try:
                explained = belief.observe(event)
            except ExhaustedError:
                return self._put_off(events[position:], place, open_calls=open_calls)
            if belief.presumed is not None:
                self._presume(event, belief.presumed, place, seen=explained and type(event) is Received)
            if not explained:
                self._unexplained, self.right = event, False
                self._asked = self.transcript.answered
                self._blame_what_was_presumed()
                return False
            if belief.node not in self._seen:
                self.eliminations.notice(event, self.transcript.answered, before)
            if type(event) in _COUNTED:
                self._count(event, self.transcript.answered, open_calls=open_calls)
        if self._beginning is not None:
            self._begun(at, events)
        return True

    def _begun(self, at: float | None, events: tuple[Event, ...]) -> None:
        """After a line of a log that begins anywhere: whether nothing from before it is on its way any more."""
        if self._beginning is not None and self._beginning.is_over(at, events, self.transcript.early):
            self._beginning = None
            self.belief.nothing_is_late()

    def _with_what_passes(self, events: tuple[Event, ...]) -> tuple[Event, ...]:
        """The events of a line, after the time that passes before it. Messages on a cancelled stream are noted."""
        silenced = self.transcript.silenced
        if silenced and not self._speaks_on:
            self._speaks_on = any(type(one) is Received and one.channel in silenced for one in events)
        if self._elapsing is None:
            return events
        passed = self._elapsing.before(events)
        self.events -= len(passed)
        return (*passed, *events)

    def _put_off(self, events: tuple[Event, ...], place: int, *, open_calls: bool) -> bool:
        """The first of these events costs too much to explain at once: it waits, or nothing more is judged."""
        if self._patient and isinstance(self.belief, Belief):
            self.events -= 1
            self._held = Held(self.belief)
            return self._hold(events, place, open_calls=open_calls)
        self._undecided = events[0]
        self.exhausted, self.right = True, False
        return False

    def _presume(self, event: Event, before: Belief, place: int, *, seen: bool) -> None:
        """Remember an answer that only a restart explains, until a message shows that there was one.

        Args:
            event: the answer, or an event after it.
            before: the belief before the answer.
            seen: whether the event is such a message.
        """
        if seen:
            self.belief.presumed = self._presumed = None
        elif self._presumed is None:
            line = HeldEvent(event, self.transcript.answered, self.read, place, open_calls=False)
            self._presumed = Presumed(before, line, self.events)

    def _blame_what_was_presumed(self) -> None:
        """Blame the answer that only a restart explains, if no message has shown the restart."""
        presumed, self._presumed = self._presumed, None
        if presumed is None or presumed.belief.observe(presumed.line.event):
            return
        self._blame(presumed.line)
        self._standing, self.events = presumed.belief, presumed.events

    def _blame(self, line: HeldEvent) -> None:
        """Report an event of an earlier line as the one that nothing explains."""
        for _ in range(min(self.read - line.read, len(self.lines))):
            self.lines.pop()
        self._unexplained, self._asked, self.read, self.place = line.event, line.asked, line.read, line.place
        self.right = False

    def _count(self, event: Event, asked: Request | None, *, open_calls: bool) -> None:
        """Count an event that is explained.

        Args:
            event: the event.
            asked: the request, if the event is an answer.
            open_calls: whether calls had no answer before it.
        """
        if type(event) is Returned:
            self.succeeded += event.answer.code == OK
            self.answers[self.system.spec.request_operation(asked)][event.answer.code] += 1
            self.recent.append(AnsweredCall(asked, self._about.pop(event.call, ()), event.answer, event.names))
        elif type(event) is Settled:
            self._unanswered = self._unanswered or self._lost_a_call or open_calls
        elif type(event) is Called:
            if event.names:
                self._about[event.call] = event.names
            self._lost_a_call = self._lost_a_call or event.lost

    def _hold(self, events: tuple[Event, ...], place: int, *, open_calls: bool) -> bool:
        """Hold events back until those after them have come."""
        held = self._held
        assert held is not None, "somebody has begun to hold events back"  # noqa: S101
        self.held_back = True
        for event in events:
            held.add(HeldEvent(event, self.transcript.answered, self.read, place, open_calls))
        return self._decide(held, whole=False) if held.due else True

    def _decide(self, held: Held, *, whole: bool) -> bool:
        """Explain the events that wait. If the search was not exhaustive and more may come, they go on waiting."""
        try:
            explained = held.explain(whole=whole)
        except ExhaustedError:
            self.events += held.reached + 1
            self._undecided, self._strictly = held.lines[held.reached].event, held.strictly
            self.exhausted, self.right = True, False
            return False
        if explained.whole and not (explained.exact or whole):
            held.wait()
            return True
        self._held = None
        known = held.lines if explained.whole else held.lines[: held.unexplained]
        self.events += len(known)
        for line in known:
            self._count(line.event, line.asked, open_calls=line.open_calls)
        self.eliminations.skip()
        if not explained.whole:
            self.events += 1
            self._blame(held.lines[held.unexplained])
            self._blame_what_was_presumed()
        return self.right

    @property
    def violation(self) -> Violation | None:
        """What is wrong with the event that nothing explains. It is computed when it is first asked for."""
        if self._unexplained is not None and self._violation is None:
            about = Circumstances(self._asked, self.eliminations.found, tuple(self.recent))
            found = violation(self._standing.of_last_event, self._unexplained, about)
            if self.quiet is not None and type(self._unexplained) is Settled:
                seen = f"nothing had come of it after {self.quiet.seconds:g} s, or by {found.observed}"
                found = evolve(found, observed=seen)
            elif self.quiet is not None and any(one is self._unexplained for one in self.quiet.broken):
                silence = f"nothing had come for {self.quiet.seconds:g} s before it"
                late = f"{silence}: what happens by itself, such as the start of the next mission, was due by then"
                found = evolve(found, notes=(*found.notes, late))
            self._violation = evolve(found, history=self.history, at=self.read + 1)
        return self._violation

    def _broke_down(self) -> bool:
        """Whether a subscription was answered with a failure that its table allows in any state."""
        operations = self.system.spec.operations
        return any(
            operations[name].streaming and code in operations[name].failures
            for name, codes in self.answers.items()
            for code in codes
            if name in operations
        )

    @property
    def history(self) -> tuple[JSON, ...]:
        """The first line, and the last lines that were read."""
        return (self.head.line, *self.lines)

    def verdict(self) -> Verdict:
        """The judgement of what was fed so far."""
        if self._held is not None and self.right:
            self._decide(self._held, whole=True)
        if self._presumed is not None and self.right and self.head.drives:
            self._blame_what_was_presumed()  # in a test that drives the robot, nothing happens by itself
        outcome, because, exercised = Outcome.CONFORMS, "", self.exercised
        if self._unexplained is not None:
            outcome = Outcome.VIOLATES
        elif self._undecided is not None:
            outcome, because = Outcome.INCONCLUSIVE, self._why_undecided(self._undecided)
        elif not exercised and not self._broke_down():
            outcome, because = Outcome.INCONCLUSIVE, "nothing was exercised"
        spec, readings = self.system.spec, self._standing.readings
        left_out = uncovered(spec, exercised, readings)
        ways = self._standing.ways
        used = (name for name, codes in self.answers.items() if codes)
        verdict = Verdict(
            outcome,
            self.system.name,
            events=self.events,
            readings=readings,
            exercised=exercised,
            uncovered=left_out,
            violation=self.violation,
            because=because,
            flagged=(*flagged(spec, readings, self.eliminations.found, ways), *self.oddities),
            unchecked=unchecked(spec, (*used, *self.head.drives)),
            untested=untested(spec, self.answers, self.head.drives, left_out),
            ruled_out=by_ambiguity(spec.ambiguities, self.eliminations.found, readings),
        )
        return held_to_the_text(verdict) if self._no_flagged else verdict

    def _why_undecided(self, event: Event) -> str:
        """What there was too much of, and what would leave some of it out."""
        spec = self.system.spec
        because = f"event {self.events} ({event_words(spec, event)}) has too many explanations to decide"
        because += "; what follows was not judged"
        if self._strictly and not (spec.anywhere or spec.others):
            because += "; only what a transport does can explain it: --transport strict leaves that out"
        return because

    @property
    def oddities(self) -> tuple[Flagged, ...]:
        """What is explained and belongs to no reading, but is worth a line of the verdict."""
        said = {
            "a call was not answered, or only after everything had settled": self._unanswered,
            "a stream showed more after its cancel was answered": self._speaks_on,
        }
        return tuple(Flagged(says) for says, so in said.items() if so)

    @property
    def exercised(self) -> dict[str, int]:
        """How often each rule was exercised: here, or by all that walk the automaton."""
        return self.belief.exercised


def check(system: System, head: Head, lines: Iterable[JSON], **options: Any) -> Verdict:  # noqa: ANN401 - see Judge
    """Judge a whole history. Raises UnreadableError for a line that is not of the format."""
    judge = Judge(system, head, **options)
    for line in lines:
        if not judge.feed(line):
            break
    return judge.verdict()
