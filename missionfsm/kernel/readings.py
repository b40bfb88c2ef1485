"""Where a document can be read in more than one way, and what an execution has assumed so far.

An `Ambiguity` is a question that the documents leave open; its readings are the answers that a sensible
implementation may give. What an execution has assumed is one integer, a set of bits with one bit for every reading
that is *still possible*: assuming something clears bits, and an execution whose question has no reading left is
impossible. Sets of readings ("b or c") are therefore assumed as cheaply as single ones, and two executions that
differ in one question alone can be merged by ``|``.
"""

from __future__ import annotations

import difflib
import functools
import itertools
from collections.abc import Iterable, Iterator, Mapping
from typing import TypeVar

from attrs import field, frozen

T = TypeVar("T")
_bits = itertools.count()
"""Every reading has a bit of its own; the numbers have no meaning and are never written out."""

MAX_NAMED = 12
"""How many ambiguities are named one by one to somebody who asks for one that does not exist."""


@frozen(eq=False)
class Assumption:
    """That one ambiguity is read in one of some ways.

    `kept` has every bit but those of the readings ruled out; `group` has the bits of the whole ambiguity.
    """

    ambiguity: Ambiguity
    kept: int = field(repr=False)
    group: int = field(repr=False)

    @property
    def letters(self) -> tuple[str, ...]:
        """The readings that are left."""
        return self.ambiguity.possible(self.kept)

    def __str__(self) -> str:
        return f"{self.ambiguity.id}={'|'.join(self.letters)}"


def _letters(letters: Iterable[str]) -> frozenset[str]:
    return frozenset(letters)


@frozen(eq=False)
class Ambiguity:
    """A question that the documents leave open.

    Args:
        id: the entry, such as ``AM-09``; an entry with several questions has one ambiguity for each (``AM-14.paused``).
        question: what is asked, in one line.
        readings: letter to answer, in our own words.
        default: the letter that the reference model follows: the first, where nothing else is said.
        flagged: letters that are accepted, but depart from the letter of the text; a verdict says so. One text of them
            will do: ``"bc"``.
        alike: what parts of one entry have in common that ask the same question, with the same letters, in calls that
            look alike (``AM-01.create`` and ``AM-01.append``); None for a question that is asked once. Whoever reads
            such parts differently is explained, and the verdict says that it is incoherent.
        rule: the rule that is broken by whoever reads the question now so and now otherwise: its id, or the end of it
            where rules of several operations say the same. Needed where no rule of the system is under a reading of it.
        json_only: letters that are about the JSON of a message. Binary protobuf has one form for what they say in
            another, so that nothing that speaks it follows them.
    """

    id: str
    question: str
    readings: Mapping[str, str]
    default: str = field()
    flagged: frozenset[str] = field(default=frozenset(), converter=_letters)
    alike: str | None = None
    rule: str = ""
    json_only: frozenset[str] = field(default=frozenset(), converter=_letters)
    _bit: Mapping[str, int] = field(init=False, repr=False)
    _made: dict[int, Assumption] = field(init=False, repr=False, factory=dict)
    _named: dict[str | tuple[str, ...], Assumption] = field(init=False, repr=False, factory=dict)
    group: int = field(init=False, repr=False)
    """The bits of all its readings."""

    @default.default
    def _first(self) -> str:
        return next(iter(self.readings), "")

    def __attrs_post_init__(self) -> None:
        if not {self.default} | self.flagged | self.json_only <= self.readings.keys():
            msg = f"{self.id}: every letter of it must be one of its readings, {', '.join(self.readings)}"
            raise ValueError(msg)
        object.__setattr__(self, "_bit", {letter: 1 << next(_bits) for letter in self.readings})
        object.__setattr__(self, "group", functools.reduce(int.__or__, self._bit.values()))

    def __getitem__(self, letters: str | tuple[str, ...]) -> Assumption:
        """The assumption that one of these letters is followed: ``AM_09["a"]``, ``AM_09["a", "b"]``.

        Raises:
            ValueError: there is no such letter, or none at all is given.
        """
        named = self._named.get(letters)
        if named is None:
            chosen = self.checked((letters,) if isinstance(letters, str) else letters)
            bits = functools.reduce(int.__or__, (self._bit[letter] for letter in chosen))
            named = self._named[letters] = self.where(bits)
        return named

    def checked(self, letters: Iterable[str]) -> tuple[str, ...]:
        """These letters. Raises ValueError if one of them is no reading, or there is none."""
        chosen = tuple(letters)
        unknown = [letter for letter in chosen if letter not in self.readings]
        if unknown or not chosen:
            msg = f"{self.id} has no reading {unknown[0] if unknown else ''!r}; it has {', '.join(self.readings)}"
            raise ValueError(msg)
        return chosen

    def where(self, bits: int) -> Assumption:
        """The assumption that a reading with one of these bits is followed."""
        made = self._made.get(bits)
        if made is None:
            made = self._made[bits] = Assumption(self, ~(self.group & ~bits), self.group)
        return made

    @property
    def bits(self) -> tuple[int, ...]:
        """The bit of each reading, in the order of the letters."""
        return tuple(self._bit.values())

    def besides(self, *letters: str) -> Assumption:
        """The assumption that none of these letters is followed. Raises ValueError as indexing does."""
        self.checked(letters)
        return self[tuple(letter for letter in self.readings if letter not in letters)]

    def possible(self, assumed: int) -> tuple[str, ...]:
        """The letters that an execution with these assumptions may still follow."""
        return tuple(letter for letter, bit in self._bit.items() if assumed & bit)


def asked_of_each(  # noqa: PLR0913 - every one but the first four has a default
    entry: str,
    question: str,
    readings: Mapping[str, str],
    parts: Mapping[str, str] | Iterable[str],
    flagged: str = "",
    *,
    default: str = "",
    alike: bool = True,
    rule: str = "",
) -> Mapping[str, Ambiguity]:
    """One ambiguity for each part of a question, such as each call: nothing that is written ties one to another.

    Args:
        entry: the id, to which each part adds its name: ``AM-01.CreateMission``.
        question: what is asked, with `{}` for the part.
        readings: as those of an `Ambiguity`.
        parts: the name of each part to the words for it; just the names where these are the words.
        flagged: letters that depart from the letter of the text.
        default: the letter that the reference model follows: the first, where nothing else is said.
        alike: whether different answers to different parts are more often wrong than free.
        rule: the rule that is broken by whoever reads a part now so and now otherwise.
    """
    words = parts if isinstance(parts, Mapping) else {part: part for part in parts}
    return {
        part: Ambiguity(
            f"{entry}.{part}",
            question.format(text),
            readings,
            default or next(iter(readings)),
            flagged,
            alike=entry if alike and len(words) > 1 else None,
            rule=rule,
        )
        for part, text in words.items()
    }


def declared(names: Mapping[str, object], kind: type[T]) -> tuple[T, ...]:
    """The values of a type to which a module gives public names, by themselves or in mappings, in their order.

    ``AMBIGUITIES = declared(globals(), Ambiguity)`` stands behind the ambiguities of a system.
    """
    return tuple(dict.fromkeys(_held([value for name, value in names.items() if not name.startswith("_")], kind)))


def _held(values: Iterable[object], kind: type[T]) -> Iterator[T]:
    for value in values:
        if isinstance(value, kind):
            yield value
        elif isinstance(value, Mapping):
            yield from _held(value.values(), kind)


UNCONSTRAINED = -1
"""What an execution has assumed at its start: every reading of everything is possible."""


def meet(assumed: int, assumptions: Iterable[Assumption]) -> int:
    """What is assumed once these are assumed as well; 0 when that is contradictory."""
    for assumption in assumptions:
        assumed &= assumption.kept
        if not assumed & assumption.group:
            return 0
    return assumed


def choose(ambiguities: Iterable[Ambiguity], choice: Mapping[str, str] | None = None) -> int:
    """One reading of every ambiguity: the defaults, but for those in `choice` (ambiguity id to letter).

    An entry's id speaks for all its parts that have the letter: ``AM-14`` for ``AM-14.paused``. An id that names less
    speaks louder: where both ``AM-14=f`` and ``AM-14.paused=g`` are chosen, g is followed by that part and f by the
    others.

    Raises:
        ValueError: an ambiguity or a letter that does not exist.
    """
    ambiguities = tuple(ambiguities)
    wanted = constrain(ambiguities, choice or {})
    for ambiguity in ambiguities:
        left = ambiguity.possible(wanted)
        wanted = meet(wanted, [ambiguity[ambiguity.default if ambiguity.default in left else left[0]]])
    return wanted


def constrain(ambiguities: Iterable[Ambiguity], choice: Mapping[str, str]) -> int:
    """Only what is in `choice` is decided; the rest stays open. Raises ValueError as `choose` does.

    Several letters in one text leave that question open among them.
    """
    return _constrained(tuple(ambiguities), tuple(choice.items()))


@functools.lru_cache(maxsize=1_000)
def _constrained(ambiguities: tuple[Ambiguity, ...], chosen: tuple[tuple[str, str], ...]) -> int:
    choice = dict(chosen)
    decided: dict[Ambiguity, str] = {}
    spoken_for: dict[str, list[Ambiguity]] = {}
    for one in ambiguities:
        for parts in itertools.accumulate(one.id.split("."), "{}.{}".format):
            spoken_for.setdefault(parts, []).append(one)
    for name in sorted(choice, key=lambda name: name.count(".")):
        letters = choice[name]
        named = spoken_for.get(name, [])
        if not named:
            raise ValueError(_unknown(name, [one.id for one in ambiguities]))
        fitting = [one for one in named if one.readings.keys() >= set(letters)]
        if not fitting:
            known = "; ".join(f"{one.id} has {', '.join(one.readings)}" for one in named)
            msg = f"{name} has no reading {letters}: {known}"
            raise ValueError(msg)
        decided.update(dict.fromkeys(fitting, letters))
    return meet(UNCONSTRAINED, (one[tuple(letters)] for one, letters in decided.items()))


def _unknown(name: str, known: list[str]) -> str:
    """That there is no such ambiguity; of many only the one that is meant, or what they are called together."""
    if len(known) > MAX_NAMED:
        known = list(dict.fromkeys(one.partition(".")[0] for one in known))
        near = difflib.get_close_matches(name, known, len(known))
        if near:
            # Of those that are equally near the first in order: 09 for 9, not 59.
            likeness = {one: difflib.SequenceMatcher(None, one, name).ratio() for one in near}
            meant = min(near, key=lambda one: (-likeness[one], one))
            return f"there is no ambiguity {name}; is {meant} meant?"
    return f"there is no ambiguity {name}; there are {', '.join(known)}"


def to_the_letter(ambiguities: Iterable[Ambiguity]) -> dict[str, str]:
    """The choice of readings that departs nowhere from the text: what is flagged is ruled out, the rest stays open."""
    return {
        one.id: "".join(letter for letter in one.readings if letter not in one.flagged)
        for one in ambiguities
        if one.flagged
    }


@functools.cache
def alike(ambiguities: tuple[Ambiguity, ...]) -> tuple[tuple[Ambiguity, Ambiguity], ...]:
    """Every pair of ambiguities that ask the same question in calls that look alike, and share a letter."""
    return tuple(
        (one, other)
        for one, other in itertools.combinations(ambiguities, 2)
        if one.alike is not None and one.alike == other.alike and one.readings.keys() & other.readings.keys()
    )


@functools.lru_cache(maxsize=1_000)  # robots of one make, by the thousand, read everything alike
def clashes(ambiguities: tuple[Ambiguity, ...], assumed: int) -> tuple[tuple[Ambiguity, Ambiguity], ...]:
    """The pairs of alike ambiguities that an execution with these assumptions reads differently."""
    return tuple(
        (one, other)
        for one, other in alike(ambiguities)
        if not set(one.possible(assumed)) & set(other.possible(assumed))
    )


def unflagged(ambiguities: tuple[Ambiguity, ...]) -> int:
    """What is assumed where nothing departs from the letter of the text."""
    return meet(UNCONSTRAINED, _lettered(ambiguities))


def departs(ambiguities: tuple[Ambiguity, ...], assumed: int) -> bool:
    """Whether an execution with these assumptions reads something against the letter of the text."""
    return not meet(assumed, _lettered(ambiguities))


@functools.cache
def _lettered(ambiguities: tuple[Ambiguity, ...]) -> tuple[Assumption, ...]:
    return tuple(one.besides(*one.flagged) for one in ambiguities if one.flagged)


def by_bit(ambiguities: Iterable[Ambiguity]) -> dict[int, int]:
    """The bits of all readings of an ambiguity, by the bit of each of its readings; `merge` takes this."""
    return {bit: one.group for one in ambiguities for bit in one.bits}


def covers(wide: int, narrow: int) -> bool:
    """Whether one set of assumptions leaves open all that another does."""
    return wide | narrow == wide


def merge(first: int, second: int, groups: Mapping[int, int]) -> int | None:
    """One set of assumptions that stands for exactly these two, or None where there is none.

    A set of assumptions is a box: a choice for every question, independently. Two boxes make a box when one holds the
    other or when they differ in a single question.

    Args:
        groups: what `by_bit` makes of the questions.
    """
    union = first | second
    if union in (first, second):
        return union
    differing = first ^ second
    return None if differing & ~groups.get(differing & -differing, 0) else union
