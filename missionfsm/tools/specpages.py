"""The written specifications in ``specs/``: what they claim to cover, and the parts of them that are computed.

A page is Markdown with two conventions. A *clause* is a paragraph that begins with its number and its place,

    **M-7** (`Mission › CreateMission › Errors`) In our own words … *Checked by* `CreateMission/INVALID_ARGUMENT/…`.

and names rules by their ids without the system, in which ``*`` stands for anything. A *computed part* stands between
two comments, the first of which says what it is:

    <!-- generated: rules CreateMission -->
    <!-- end -->

`regenerate` fills those parts in; what else stands on a page is left alone. Kinds of parts:

- ``operations``: every operation with its codes;
- ``rules NAME``: the rules of an operation or a topic, each with the clauses that name it, and in how many ways it is
  broken on purpose to see whether the oracle notices (`missionfsm.tools.mutate.teeth`);
- ``chart NAME``: the moves of a lifecycle, as a picture and as a table;
- ``picture NAME``: a picture of the explored graph;
- ``readings``: every ambiguity in one line;
- ``entry AM-09``: the ambiguities of an entry with their readings, and what of it is waived;
- ``waived``: everything that is waived.
"""

from __future__ import annotations

import fnmatch
import re
import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping

from attrs import frozen

from missionfsm.kernel.readings import Ambiguity
from missionfsm.kernel.rules import Rule
from missionfsm.kernel.spec import Spec
from missionfsm.kernel.system import System
from missionfsm.tools.draw.diagram import state_name
from missionfsm.tools.draw.gallery import SVG, drawn
from missionfsm.tools.draw.index import path
from missionfsm.tools.draw.tables import markdown
from missionfsm.tools.mutate.mutants import mutants

_PART = re.compile(
    r"(<!-- generated: (?P<kind>\w+)(?: (?P<what>[^\n]*?))? -->\n)(?P<body>.*?)(<!-- end -->)", re.DOTALL
)
_CLAUSE = re.compile(r"^\*\*(?P<number>[A-Z]+-\d+)\*\* \(`(?P<place>[^`]+)`\)")
_RULE = re.compile(r"`([\w*]+(?:/[\w*-]+)+)`")
_ENTRY = re.compile(r"\b[A-Z]{2}-\d\d\b")
_HEADING = re.compile(r"^### ([A-Z]{2}-\d\d)\b.*$", re.MULTILINE)


@frozen
class Clause:
    """A numbered clause: where the sentence stands that it is about, the rules and the entries that it names."""

    number: str
    place: str
    rules: tuple[str, ...]
    entries: tuple[str, ...]
    text: str


def clauses(text: str) -> tuple[Clause, ...]:
    """The clauses of a page, in its order."""
    paragraphs = (" ".join(one.split()) for one in _PART.sub("", text).split("\n\n"))
    found = ((_CLAUSE.match(paragraph), paragraph) for paragraph in paragraphs)
    return tuple(
        Clause(
            match["number"],
            match["place"],
            tuple(_RULE.findall(paragraph)),
            tuple(dict.fromkeys(_ENTRY.findall(paragraph))),
            paragraph[match.end() :].strip(),
        )
        for match, paragraph in found
        if match
    )


def entries(text: str) -> tuple[str, ...]:
    """The entries that have a section of their own, in the order of the page."""
    return tuple(_HEADING.findall(text))


def named(pattern: str, spec: Spec) -> tuple[str, ...]:
    """The ids of the rules that a clause names by one pattern."""
    return tuple(one for one in spec.rules_by_id if fnmatch.fnmatchcase(one, f"{spec.system}/{pattern}"))


def citing(text: str, spec: Spec) -> Mapping[str, tuple[Clause, ...]]:
    """Rule id to the clauses that name it; rules that none names have an empty tuple."""
    found: dict[str, list[Clause]] = {rule: [] for rule in spec.rules_by_id}
    for clause in clauses(text):
        for rule in dict.fromkeys(rule for pattern in clause.rules for rule in named(pattern, spec)):
            found[rule].append(clause)
    return {rule: tuple(some) for rule, some in found.items()}


def regenerate(text: str, system: System, waived: Mapping[str, str] | None = None) -> str:
    """The page with its computed parts as they should be.

    Args:
        text: the page.
        system: what it specifies.
        waived: entry, perhaps with letters (``AM-30 c``), to the reason.

    Raises:
        ValueError: a part is of a kind, or about something, that does not exist.
    """
    spec, waived = system.spec, waived or {}
    by_clause = citing(text, spec)
    broken = Counter(mutant.rule for mutant in mutants(system))
    kinds: Mapping[str, Callable[[str], Iterable[str]]] = {
        "operations": lambda _: _operations(spec),
        "rules": lambda name: _rules(spec, name, by_clause, broken),
        "chart": lambda name: (*_picture(system, name), "", *_chart(spec, name)),
        "picture": lambda name: _picture(system, name),
        "readings": lambda _: _readings(spec.ambiguities),
        "entry": lambda name: _entry(spec.ambiguities, waived, name),
        "waived": lambda _: _waived(waived),
    }

    def computed(match: re.Match[str]) -> str:
        kind, what = match["kind"], match["what"] or ""
        if kind not in kinds:
            message = f"{system.name}: a page has no computed part {kind!r}; there are {', '.join(kinds)}"
            raise ValueError(message)
        lines = list(kinds[kind](what))
        if not lines:
            message = f"{system.name}: there is nothing to say in a computed part {kind} {what!r}"
            raise ValueError(message)
        return match[1] + "\n".join(("", *lines, "", "")) + match[5]

    return _PART.sub(computed, text)


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> Iterator[str]:
    """The lines of a table; none where it has no rows."""
    rows = tuple(rows)
    if rows:
        yield from markdown(head, rows).splitlines()


def _operations(spec: Spec) -> Iterator[str]:
    head = ("operation", "refused with", "may fail with", "answers")
    return _table(
        head,
        (
            (
                f"[{one.name}](#{one.name.lower()})",
                ", ".join(dict.fromkeys(str(rule.code) for rule in one.refusals)),
                ", ".join(one.failures),
                "a stream" if one.streaming else "once",
            )
            for one in spec.operations.values()
        ),
    )


def _rules(
    spec: Spec, name: str, by_clause: Mapping[str, tuple[Clause, ...]], broken: Mapping[str, int]
) -> Iterator[str]:
    rules = [rule for rule in spec.all_rules if rule.id.split("/")[1] == name]
    head = ("answer", "rule", "where", "under", "clauses", "broken in")
    return _table(head, (_rule(rule, by_clause[rule.id], broken[rule.id]) for rule in rules))


def _rule(rule: Rule, named_by: tuple[Clause, ...], ways: int) -> tuple[str, ...]:
    under = str(rule.assumes) if rule.assumes else ""
    numbers = ", ".join(clause.number for clause in named_by)
    tested = f"{ways} way" if ways == 1 else f"{ways} ways"
    return rule.code or "(promise)", f"`{rule.name}`", rule.says, under, numbers, tested


def _picture(system: System, name: str) -> Iterator[str]:
    """The picture as it stands in ``diagrams/``, which are computed as well, or its parts; nothing if there is none."""
    for number, one in enumerate(drawn(system, name.replace(" ", "-"))):
        if number:
            yield ""
        yield f"![{one.diagram.title}](../diagrams/{path(one, SVG)})"


def _chart(spec: Spec, name: str) -> Iterator[str]:
    (chart,) = (one for one in spec.charts if one.name == name)
    notes: Mapping[str, str] = chart.notes
    moves = ((move, state_name(source), state_name(after), notes.get(move, "")) for move, source, after in chart.table)
    return _table(("move", "from", "to", "note"), moves)


def _readings(ambiguities: Iterable[Ambiguity]) -> Iterator[str]:
    head = ("entry", "question", "reference", "also accepted", "accepted, but departs from the text")
    return _table(
        head,
        (
            (
                f"[{one.id}](#{_anchor(one.id)})" + (f" and {len(others)} alike" if others else ""),
                one.question,
                one.default,
                ", ".join(letter for letter in one.readings if letter != one.default and letter not in one.flagged),
                ", ".join(letter for letter in one.readings if letter in one.flagged),
            )
            for one, *others in _folded(ambiguities)
        ),
    )


def _folded(ambiguities: Iterable[Ambiguity]) -> Iterator[tuple[Ambiguity, ...]]:
    """The ambiguities; those that are alike, and whose words differ by the name of the part alone, together."""
    found: dict[object, list[Ambiguity]] = {}
    for one in ambiguities:
        words = one.question.replace(one.id.rpartition(".")[2], "")
        answers = (tuple(one.readings.items()), one.default, one.flagged)
        found.setdefault((one.alike, words, answers) if one.alike else one, []).append(one)
    return map(tuple, found.values())


def _anchor(entry: str) -> str:
    """Sections of entries carry an anchor of their own, so that their titles may change."""
    return base(entry).lower()


def base(entry: str) -> str:
    """The number of the entry that an ambiguity or a waived part belongs to: ``AM-14`` of ``AM-14.paused``."""
    return re.split(r"[. ]", entry, maxsplit=1)[0]


def _entry(ambiguities: Iterable[Ambiguity], waived: Mapping[str, str], entry: str) -> Iterator[str]:
    blocks: list[list[str]] = []
    for ambiguity, *others in _folded(one for one in ambiguities if base(one.id) == entry):
        letters = (f"- {_letter(ambiguity, letter)}: {says}" for letter, says in ambiguity.readings.items())
        blocks.append([*_wrapped(f"**{ambiguity.id}** {ambiguity.question}"), "", *letters])
        if others:
            ids = ", ".join(one.id for one in others)
            blocks[-1] += ["", *_wrapped(f"Asked as well, each by itself: {ids}.")]
    for part, reason in waived.items():
        if base(part) == entry:
            blocks.append([f"{'Waived' if part == entry else f'Not offered, {part}'}: {reason}."])
    for number, block in enumerate(blocks):
        yield from ("", *block) if number else block


def _wrapped(text: str) -> list[str]:
    """The lines of a paragraph."""
    return textwrap.wrap(text, 120, break_long_words=False, break_on_hyphens=False)


def _letter(ambiguity: Ambiguity, letter: str) -> str:
    if letter == ambiguity.default:
        return f"**{letter}** (reference)"
    return f"{letter} (departs from the text)" if letter in ambiguity.flagged else letter


def _waived(waived: Mapping[str, str]) -> Iterator[str]:
    return _table(("entry", "reason"), ((f"[{part}](#{_anchor(part)})", reason) for part, reason in waived.items()))
