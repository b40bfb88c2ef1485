"""The page that shows all pictures: each as an SVG, folded away as Mermaid and as a table, and links to the rest."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from missionfsm.tools.draw import mermaid
from missionfsm.tools.draw.gallery import FORMATS, SVG, Picture

HEAD = """\
# Diagrams

Everything here is computed by `missionfsm diagram -o diagrams`: the lifecycles from the tables that the core moves by,
all else from the explored graph. An arrow that the model does not have cannot be drawn, and a test draws everything
anew and compares.

A picture of a whole system shows it settled, which is when everything that must follow has followed. A node stands for
many states, so the same call can lead to several nodes; what does not leave its node is told below the picture. No
picture has more than ten arrows: what has more is drawn in parts, and what two readings share is left out. The tables
tell everything, refusals (_in italics_) included. Failures that can come at any time are not shown. Where
nothing else is said, the readings are those of the reference; `missionfsm readings` lists them, and
`missionfsm diagram --reading` and `--versus` draw others.
"""


def index(shown: Iterable[Picture]) -> str:
    """The page as Markdown. Its links are to files beside it, named as `path` says."""
    return "\n".join((HEAD, *_sections(tuple(shown))))


def path(picture: Picture, form: str) -> str:
    """Where a picture is written in a format, below the folder."""
    return f"{picture.id}{FORMATS[form].suffix}"


def _sections(shown: tuple[Picture, ...]) -> Iterator[str]:
    for system in dict.fromkeys(one.system for one in shown):
        yield f"## {system}\n"
        for one in shown:
            if one.system == system and not one.whole:
                parts = tuple(part for part in shown if (part.system, part.whole) == (system, one.name))
                yield from _section(one, parts)


def _section(shown: Picture, parts: tuple[Picture, ...]) -> Iterator[str]:
    """A picture, or the parts that it is drawn in; the table and most files are of the whole."""
    yield f"### {shown.diagram.title.partition(': ')[2]}\n"
    drawn = parts or (shown,)
    for one in drawn:
        yield f"![{one.diagram.title}]({path(one, SVG)})\n"
    remarks = "".join(f"\n- {remark}" for remark in shown.diagram.remarks)
    blocks = "\n".join(f"```mermaid\n{mermaid.write(one.diagram)}```\n" for one in drawn)
    yield from _folded("As Mermaid", f"{blocks}{remarks}\n")
    yield from _folded("As a table", shown.table)
    for one in (shown, *parts):
        links = (f"[{form}]({path(one, form)})" for form, made in FORMATS.items() if made.write(one) is not None)
        about = f"Files of {one.name}" if parts else "Files"
        yield f"{about}: {', '.join(links)}\n"


def _folded(title: str, text: str) -> Iterator[str]:
    yield f"<details><summary>{title}</summary>\n\n{text}\n</details>\n"
