"""Write README.md and subjects.toml from the declarations in the code."""

from __future__ import annotations

import json
from pathlib import Path

from catalogue import Variant
from variants import BUGS, CHOICES, MODULES

HERE = Path(__file__).parent

INTRODUCTION = """# A robot that takes missions

An implementation of the mission API of Bear Robotics, written from the vendor's public page "Mission" alone, to try
conformance testers on. It is a program of the Python 3.11 standard library that speaks the adapter protocol for
`bear.mission` on stdin and stdout:

    python3 robot.py                 # the base: what the page most likely means
    python3 robot.py --choice NAME   # another reading of what the page leaves open
    python3 robot.py --bug NAME      # a fault, against a definite statement of the page

A tester should find that the base and every choice conform, and that every bug violates the page. `subjects.toml` lists
them all.

| file | what it holds |
| --- | --- |
| `robot.py`, `adapter.py` | the command line and the protocol |
| `model.py`, `reader.py`, `missions.py`, `status.py`, `stream.py`, `service.py`, `errors.py` | the base |
| `choices_*.py`, `bugs_*.py` | the variants: each overrides a few methods of the base |
| `catalogue.py`, `variants.py` | the register of the variants |
| `chat.py`, `talks.py`, `talks_more.py`, `smoke.py` | conversations with all subjects, which show that each differs |
| `make_readme.py` | makes this file and `subjects.toml` |

A cancelled, failed or finished mission of the base is followed by the next of the queue; missions that have ended stay
listed until they are cleared; a mission that waits is in the initial state; form is checked before state.

`python3 smoke.py --quick` has one conversation after the other with every subject until one differs from the base, and
says which subjects break, or never differ. Without `--quick` every subject has all of them, which takes long.
"""


def in_order(variants: dict[str, Variant]) -> list[Variant]:
    """Variants in the order of their modules and, within these, of their declarations."""
    places = [module.__name__ for module in MODULES]
    return sorted(variants.values(), key=lambda variant: places.index(variant.robot.__module__))


def table(variants: dict[str, Variant]) -> str:
    """A table of variants."""
    rows = [f"| `{variant.name}` | {variant.sentence} | {variant.place} |" for variant in in_order(variants)]
    return "\n".join(["| name | what differs | place in the page |", "| --- | --- | --- |", *rows])


def subject(name: str, arguments: list[str], verdict: str) -> str:
    """One entry of subjects.toml."""
    command = json.dumps(["python3", "robot.py", *arguments])
    return f'[[subject]]\nname = "{name}"\ncommand = {command}\nverdict = "{verdict}"\n'


def main() -> None:
    """Write both files."""
    parts = [
        INTRODUCTION,
        f"## Choices ({len(CHOICES)})\n\nEach is open in the page at the place that is named.\n",
        table(CHOICES),
        f"\n## Bugs ({len(BUGS)})\n\nEach contradicts the page at the place that is named.\n",
        table(BUGS),
    ]
    (HERE / "README.md").write_text("\n".join(parts) + "\n", encoding="utf-8")
    entries = [subject("base", [], "conforms")]
    entries += [subject(f"choice-{v.name}", ["--choice", v.name], "conforms") for v in in_order(CHOICES)]
    entries += [subject(f"bug-{v.name}", ["--bug", v.name], "violates") for v in in_order(BUGS)]
    (HERE / "subjects.toml").write_text("\n".join(entries), encoding="utf-8")


if __name__ == "__main__":
    main()
