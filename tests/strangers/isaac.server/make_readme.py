"""Writes README.md and subjects.toml from the declarations in the code."""

from __future__ import annotations

from pathlib import Path

from bugs import BUGS
from choices import CHOICES
from declared import Declared

_HERE = Path(__file__).resolve().parent

_HEAD = """# A mission server with variants

A server that hands missions to robots, in plain Python 3.11, behind the adapter protocol of system `isaac.server`. It
follows the public page on Mission Submission of the Isaac SDK, and for names and numbers the facts about its messages;
nothing else about the vendor's server went into it. Time is virtual and every run gives the same output.

- `python3 server.py`: the base, the page as understood here
- `python3 server.py --choice NAME`: the base with another reading of what the page leaves open
- `python3 server.py --bug NAME`: the base with a fault
- `python3 smoke.py [SUBJECT …]`: leads conversations with all subjects, each of which must run through and differ from
  the base
- `python3 make_readme.py`: writes this file and `subjects.toml` from `choices.py` and `bugs.py`

## The base

- A mission is sent when its robot is connected and has said its name, no other mission of that robot is under way and
  all upstreams have succeeded; of several, the one submitted first.
- A failed upstream cancels at once, and a cancelled mission cancels its own downstreams.
- The start limit runs from the sending to the first report, the run limit from the first running report; both strike at
  their very moment. The robot is free again after that.
- A report counts on the connection that the mission was sent on, on its status channel, with its uuid, while the
  mission is under way. A success or failure without a running report before it counts.
- The first name that is not empty stays a connection's name. Of connections with one name the one named last is served;
  a mission under way stays where it was sent.
- A drop fails the mission under way on that connection; queued ones wait for the robot.
- Lines that cannot be read are ignored.
"""


def _table(declared: tuple[Declared, ...]) -> str:
    rows = [f"| `{entry.name}` | {entry.text} | {entry.place} |" for entry in declared]
    return "\n".join(["| name | what differs | place |", "| --- | --- | --- |", *rows, ""])


def _subject(name: str, arguments: list[str], verdict: str) -> str:
    command = ", ".join(f'"{word}"' for word in ["python3", "server.py", *arguments])
    return f'[[subject]]\nname = "{name}"\ncommand = [{command}]\nverdict = "{verdict}"\n'


def main() -> None:
    """Write both files."""
    readme = f"{_HEAD}\n## Choices\n\n{len(CHOICES)}; all of them conform to the page.\n\n{_table(CHOICES)}"
    readme += f"\n## Bugs\n\n{len(BUGS)}; each contradicts the page.\n\n{_table(BUGS)}"
    (_HERE / "README.md").write_text(readme, encoding="utf-8")
    subjects = [_subject("base", [], "conforms")]
    subjects += [_subject(entry.name, ["--choice", entry.name], "conforms") for entry in CHOICES]
    subjects += [_subject(entry.name, ["--bug", entry.name], "violates") for entry in BUGS]
    (_HERE / "subjects.toml").write_text("\n".join(subjects), encoding="utf-8")


if __name__ == "__main__":
    main()
