"""Prints what README.md and subjects.toml need from the declarations: `python3 declared.py` rewrites both."""

from __future__ import annotations

from pathlib import Path

from bugs import BUGS
from choices import CHOICES
from variants import Variant

HERE = Path(__file__).resolve().parent
MARK = "<!-- made by declared.py -->\n"
PROGRAM = "fleet.py"


def table(title: str, variants: tuple[Variant, ...]) -> str:
    """A Markdown table of the variants."""
    rows = [f"| `{entry.name}` | {entry.sentence} | {entry.place} |" for entry in variants]
    return "\n".join(
        [f"## {title}: {len(variants)}", "", "| name | what differs | place |", "| --- | --- | --- |", *rows, ""]
    )


def subject(name: str, arguments: list[str], verdict: str) -> str:
    """One table of subjects.toml."""
    command = ", ".join(f'"{word}"' for word in ["python3", PROGRAM, *arguments])
    return f'[[subject]]\nname = "{name}"\ncommand = [{command}]\nverdict = "{verdict}"\n'


def main() -> None:
    """Rewrite README.md below its mark, and subjects.toml."""
    readme = HERE / "README.md"
    head = readme.read_text(encoding="utf-8").split(MARK)[0]
    readme.write_text(head + MARK + "\n" + table("Choices", CHOICES) + "\n" + table("Bugs", BUGS), encoding="utf-8")
    subjects = [subject("base", [], "conforms")]
    subjects += [subject(f"choice-{entry.name}", ["--choice", entry.name], "conforms") for entry in CHOICES]
    subjects += [subject(f"bug-{entry.name}", ["--bug", entry.name], "violates") for entry in BUGS]
    (HERE / "subjects.toml").write_text("\n".join(subjects), encoding="utf-8")


if __name__ == "__main__":
    main()
