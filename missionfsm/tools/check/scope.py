"""The scope of a verdict: what departs from the text, what is not checked, and what was not put to the test."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from attrs import evolve, frozen

from missionfsm.kernel.readings import UNCONSTRAINED, Ambiguity, Assumption, clashes, constrain, meet, unflagged
from missionfsm.kernel.rules import OK, UNIMPLEMENTED
from missionfsm.kernel.spec import Spec
from missionfsm.tools.check.basis import NEVER_SUCCEEDED, NOT_THERE, NOT_TRIED, Flagged, Untested
from missionfsm.tools.check.eliminations import Elimination
from missionfsm.tools.check.verdict import Outcome, Verdict, Violation

Eliminated = Mapping[tuple[str, str], Elimination]
"""For each ambiguity id and letter that was ruled out, the event that did it."""

Answers = Mapping[str, Mapping[str, int]]
"""For each operation, how often it was answered with each status."""

MAX_CODES = 3
"""How many codes are named of a call that never succeeded, the commonest first."""


def assumed(spec: Spec, readings: Mapping[str, str] | None, *, no_flagged: bool) -> int:
    """The assumptions that hold from the start.

    Args:
        spec: the system.
        readings: the readings that have to be followed.
        no_flagged: whether nothing may depart from the letter of the text.

    Raises:
        ValueError: a reading does not exist, or departs from the text where nothing may.
    """
    wanted = constrain(spec.ambiguities, readings or {})
    if not no_flagged:
        return wanted
    for one in spec.ambiguities:
        if one.flagged.issuperset(one.possible(wanted)):
            msg = f"{one.id}={'|'.join(one.possible(wanted))} departs from the text, and nothing that does is accepted"
            raise ValueError(msg)
    return wanted & unflagged(spec.ambiguities)


def uncovered(spec: Spec, exercised: Mapping[str, int], readings: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    """The ids of the rules that were not exercised, although they hold under the readings that are left."""
    return tuple(
        rule.id
        for rule in spec.all_rules
        if rule.id not in exercised
        and (
            rule.assumes is None
            or set(rule.assumes.letters) & set(readings.get(rule.assumes.ambiguity.id, rule.assumes.letters))
        )
    )


def flagged(
    spec: Spec, readings: Mapping[str, tuple[str, ...]], eliminations: Eliminated, ways: Iterable[int] = ()
) -> tuple[Flagged, ...]:
    """A line for everything that is explained, but departs from the letter of the text or is incoherent.

    Args:
        spec: the system.
        readings: for each ambiguity that mattered, the readings that are left.
        eliminations: what ruled out the others.
        ways: the assumptions of each explanation that is left; the one that departs least is reported.
    """
    left: Mapping[str, tuple[str, ...]] = {
        one.id: readings.get(one.id, tuple(one.readings)) for one in spec.ambiguities
    }
    departing = _departing(spec, left)
    followed = meet(UNCONSTRAINED, (one[left[one.id]] for one in spec.ambiguities if left[one.id]))
    apart = list(clashes(spec.ambiguities, followed))
    least = min((_Way.followed(spec, way) for way in ways), key=_Way.size, default=None)
    if least is not None:
        # Readings that are possible one by one may not be possible together.
        departing += [one for one in least.departing if one not in departing]
        apart += [pair for pair in least.apart if pair not in apart]
        left = least.left
    return (
        *(_departure(one, left[one.id], eliminations) for one in departing),
        *_incoherences(apart, left, eliminations),
    )


def flagged_in_all(
    spec: Spec,
    readings: Mapping[str, tuple[str, ...]],
    eliminations: Eliminated,
    several: Iterable[Iterable[int]],
) -> tuple[Flagged, ...]:
    """The lines of `flagged` for several conversations that follow the same readings, one for each ambiguity.

    Args:
        spec, readings, eliminations: see `flagged`.
        several: for each conversation whose explanations depart, what these assume.
    """
    lines = flagged(spec, readings, eliminations)
    followed = meet(UNCONSTRAINED, (one[readings[one.id]] for one in spec.ambiguities if readings.get(one.id)))
    for ways in several:
        named = {line.about for line in lines}
        left = [way & followed for way in sorted(ways) if meet(way, _decided(spec, followed))]
        lines += tuple(line for line in flagged(spec, readings, eliminations, left) if line.about not in named)
    return lines


def _decided(spec: Spec, assumed: int) -> Iterable[Assumption]:
    return (one.where(assumed & one.group) for one in spec.ambiguities)


@frozen
class _Way:
    """The readings of one explanation.

    Attributes:
        left: for each ambiguity id, the letters that are left.
        departing: the ambiguities of which only letters are left that depart from the text.
        apart: pairs of alike ambiguities that are read differently.
    """

    left: Mapping[str, tuple[str, ...]]
    departing: list[Ambiguity]
    apart: tuple[tuple[Ambiguity, Ambiguity], ...]

    @classmethod
    def followed(cls, spec: Spec, assumed: int) -> _Way:
        """The readings of an explanation with these assumptions."""
        left = {one.id: one.possible(assumed) for one in spec.ambiguities}
        return cls(left, _departing(spec, left), clashes(spec.ambiguities, assumed))

    def size(self) -> int:
        """How many departures it has."""
        return len(self.departing) + len(self.apart)


def _departing(spec: Spec, left: Mapping[str, tuple[str, ...]]) -> list[Ambiguity]:
    """The ambiguities of which only letters are left that depart from the letter of the text."""
    return [one for one in spec.ambiguities if left[one.id] and one.flagged.issuperset(left[one.id])]


def _departure(ambiguity: Ambiguity, letters: tuple[str, ...], eliminations: Eliminated) -> Flagged:
    says = "; or: ".join(ambiguity.readings[letter] for letter in letters)
    event = _event(ambiguity, tuple(one for one in ambiguity.readings if one not in ambiguity.flagged), eliminations)
    where = f" (seen where {event})" if event else ""
    reading = f"{ambiguity.id}={'|'.join(letters)}"
    return Flagged(f"{reading} departs from the text: {ambiguity.question} {says}{where}", reading)


def _incoherences(
    apart: Iterable[tuple[Ambiguity, Ambiguity]],
    left: Mapping[str, tuple[str, ...]],
    eliminations: Eliminated,
) -> Iterable[Flagged]:
    """A line for each pair of alike ambiguities that are read differently, with an event for each side."""
    said: set[str | None] = set()
    for one, other in apart:
        if one.alike in said:
            continue
        said.add(one.alike)
        sides = []
        for side, against in ((one, other), (other, one)):
            event = _event(side, left[against.id], eliminations)
            sides.append(f"{side.id}={'|'.join(left[side.id])}" + (f" (seen where {event})" if event else ""))
        says = f"incoherent, calls that look alike are read differently: {sides[0]}, but {sides[1]}"
        yield Flagged(says, about=f"incoherent: {one.id}")


def _event(ambiguity: Ambiguity, letters: Iterable[str], eliminations: Eliminated) -> str:
    """The event that ruled out the last of some letters, as far as that is known."""
    found = [eliminations[ambiguity.id, letter] for letter in letters if (ambiguity.id, letter) in eliminations]
    return str(max(found, key=lambda elimination: elimination.at)) if found else ""


def unchecked(spec: Spec, used: Iterable[str]) -> tuple[str, ...]:
    """A line for each waived sentence that these calls and drives could have shown.

    Args:
        spec: the system.
        used: the names of the calls and drives that there were.
    """
    used = set(used)
    return tuple(str(one) for one in spec.waived if not one.shown_by or used & set(one.shown_by))


def untested(spec: Spec, answers: Answers, drives: Iterable[str], left_out: Iterable[str]) -> Untested:
    """The calls and rules that nothing can be said about, each with the reason.

    Args:
        spec: the system.
        answers: how calls were answered.
        drives: the drives that were commanded.
        left_out: ids of the rules that were not exercised.
    """
    missing = tuple(name for name in spec.drives if name not in drives)
    calls = {name: why for name in spec.operations if (why := _why_not(answers.get(name, {})))}
    rules = {}
    for rule_id in left_out:
        operation = rule_id.split("/")[1]
        rules[rule_id] = f"{operation} {calls[operation]}" if operation in calls else "never came up"
    shown = any(OK in answers.get(name, {}) for name, operation in spec.operations.items() if operation.streaming)
    return Untested(
        calls,
        rules,
        missing,
        unseen=any(spec.drives[name].by_itself for name in missing),
        operations=len(spec.operations),
        all_drives=len(spec.drives),
        shown=shown,
    )


def _why_not(codes: Mapping[str, int]) -> str:
    """Why nothing is known of a call with these answers; empty if something is known."""
    if not codes:
        return NOT_TRIED
    if codes.keys() == {UNIMPLEMENTED}:
        return f"{NOT_THERE}: UNIMPLEMENTED"
    if OK in codes:
        return ""
    most = ", ".join(
        f"{code} {times} times" if times > 1 else code for code, times in Counter(codes).most_common(MAX_CODES)
    )
    return f"{NEVER_SUCCEEDED}: {most}"


def held_to_the_text(verdict: Verdict) -> Verdict:
    """The verdict; a violation if it conforms and something is flagged."""
    if not verdict.conforms or not verdict.flagged:
        return verdict
    violation = Violation((), f"What was observed departs from the text: {verdict.flagged[0]}", (), verdict.flagged[1:])
    return evolve(verdict, outcome=Outcome.VIOLATES, violation=violation)
